//! The frames of a run as arrays for `NumPy`: `numpy.load` gives those of one file by name.
//!
//! | array | shape | what |
//! |---|---|---|
//! | `time_s` | (frames) | time since the drive started, s |
//! | `kind` | (seeds) | kind of each seed, from 0 in the order of the scene |
//! | `position_m` | (frames, seeds, 3) | centre of mass, m |
//! | `orientation` | (frames, seeds, 4) | rotation of the seed as a quaternion w, x, y, z |
//! | `velocity_m_s` | (frames, seeds, 3) | of the centre of mass, m/s |
//! | `angular_velocity_rad_s` | (frames, seeds, 3) | rad/s |
//! | `spheres_K_m` | (spheres, 4) | x, y, z and radius of the spheres of kind K at the origin, not turned, m |
//! | `picture` | (frames, height, width, 3) | what the camera sees, red, green, blue, 0 to 255, row 0 at the top |
//!
//! A sphere of a seed lies at `position + orientation (x, y, z)`. There is no `picture` if no camera looks at the seeds.
//! The file is a ZIP archive of arrays in the NPY format, version 1.0 (`NumPy` Enhancement Proposal 1).

use crate::exchange::Error;
use image::RgbImage;
use scene::{Frame, Scene, SeedBody, drum_picture};
use std::io::{Cursor, Write};
use std::sync::Arc;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Bytes that the head of an array is filled up to a multiple of.
const ALIGNMENT: usize = 64;

/// The frames of a run of a scene as the bytes of a file.
///
/// # Errors
///
/// A frame that cannot be drawn.
///
/// # Panics
///
/// Never: memory takes every archive that fits into it.
pub fn archive(
    scene: &Scene,
    frames: &[Frame],
    bodies: &[Arc<SeedBody>],
) -> Result<Vec<u8>, Error> {
    let mut arrays = Archive(ZipWriter::new(Cursor::new(Vec::new())));
    let n = frames.len();
    let kinds = frames.first().map_or(&[][..], |frame| &frame.kind);
    arrays.numbers("time_s", &[n], frames.iter().map(|f| f.time));
    let numbers: Vec<u8> = kinds
        .iter()
        .flat_map(|&kind| (kind as u64).to_le_bytes())
        .collect();
    arrays.add("kind", "<u8", &[kinds.len()], &numbers);
    let vectors = [n, kinds.len(), 3];
    let of = |part: fn(&Frame) -> &Vec<nalgebra::Vector3<f64>>| {
        let all = frames.iter().flat_map(move |frame| part(frame).iter());
        all.flat_map(|v| [v.x, v.y, v.z])
    };
    arrays.numbers("position_m", &vectors, of(|f| &f.position));
    let turns = frames.iter().flat_map(|frame| &frame.orientation);
    let turns = turns.flat_map(|q| [q.w, q.i, q.j, q.k]);
    arrays.numbers("orientation", &[n, kinds.len(), 4], turns);
    arrays.numbers("velocity_m_s", &vectors, of(|f| &f.velocity));
    arrays.numbers("angular_velocity_rad_s", &vectors, of(|f| &f.spin));
    for (kind, body) in bodies.iter().enumerate() {
        let spheres = body.clump.spheres();
        let values = spheres
            .iter()
            .flat_map(|s| [s.centre.x, s.centre.y, s.centre.z, s.radius]);
        arrays.numbers(&format!("spheres_{kind}_m"), &[spheres.len(), 4], values);
    }
    if !scene.apparatus.has_phases() && n > 0 {
        let pictures = frames
            .iter()
            .map(|frame| drum_picture(scene, bodies, frame));
        let pictures = pictures.collect::<Result<Vec<_>, _>>()?;
        let (width, height) = pictures[0].dimensions();
        let bytes: Vec<u8> = pictures.into_iter().flat_map(RgbImage::into_raw).collect();
        arrays.add(
            "picture",
            "|u1",
            &[n, height as usize, width as usize, 3],
            &bytes,
        );
    }
    let archive = arrays.0.finish().expect("memory takes every archive");
    Ok(archive.into_inner())
}

/// An archive of arrays that is being written.
struct Archive(ZipWriter<Cursor<Vec<u8>>>);

impl Archive {
    /// Adds an array of numbers.
    fn numbers(&mut self, name: &str, shape: &[usize], values: impl Iterator<Item = f64>) {
        let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
        self.add(name, "<f8", shape, &bytes);
    }

    /// Adds an array of a type as `NumPy` names it, in C order.
    fn add(&mut self, name: &str, kind: &str, shape: &[usize], bytes: &[u8]) {
        // As Python writes a tuple: a comma behind each number, so that one number is one too.
        let shape: Vec<String> = shape.iter().map(|n| format!("{n},")).collect();
        let shape = shape.join(" ");
        let mut head =
            format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
        // Six bytes of magic, two of the version, two of the length of what follows, which ends with a line feed.
        let whole = (10 + head.len() + 1).next_multiple_of(ALIGNMENT);
        head.push_str(&" ".repeat(whole - 11 - head.len()));
        head.push('\n');
        let length = u16::try_from(head.len()).expect("four numbers are short");
        // The date is that of the format's beginning: the same run gives the same bytes.
        let options = SimpleFileOptions::default().large_file(bytes.len() > 1 << 31);
        let file = &mut self.0;
        file.start_file(format!("{name}.npy"), options)
            .expect("names differ");
        let mut write = |bytes: &[u8]| file.write_all(bytes).expect("memory takes every archive");
        write(b"\x93NUMPY\x01\x00");
        write(&length.to_le_bytes());
        write(head.as_bytes());
        write(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::{Archive, Cursor, ZipWriter};
    use std::io::Read as _;

    /// An array is found again by the definition of the format: six bytes of magic, the version, the length of a text that fills
    /// the head up to a multiple of 64 and states type, order and shape, and the numbers follow it.
    #[test]
    fn an_array_is_as_the_format_defines_it() {
        let mut arrays = Archive(ZipWriter::new(Cursor::new(Vec::new())));
        let values = [1.5, -2.0, 1e-300, 4.0, 5.0, 6.0];
        arrays.numbers("some", &[2, 3], values.into_iter());
        let bytes = arrays.0.finish().unwrap().into_inner();
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut file = Vec::new();
        let mut entry = archive.by_name("some.npy").unwrap();
        entry.read_to_end(&mut file).unwrap();
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        let head = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!(head % 64, 0);
        let text = std::str::from_utf8(&file[10..head]).unwrap();
        assert_eq!(
            text.trim_end(),
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3,), }"
        );
        assert!(text.ends_with('\n'));
        let numbers = file[head..].chunks(8);
        let numbers: Vec<f64> = numbers
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(numbers, values);
    }
}
