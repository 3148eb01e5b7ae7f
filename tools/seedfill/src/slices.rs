//! A stack of slices, as a tomograph gives them: a folder of grey pictures, or one TIFF file of many.

use crate::arguments::{Arguments, length_in_metres};
use anyhow::{Context as _, bail, ensure};
use image::{DynamicImage, ImageFormat};
use input::file::files_in;
use photo_profile::{decode_photo, otsu_threshold};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use tiff::decoder::{Decoder, DecodingResult};
use trimesh::{CheckedMesh, Repair, VoxelStack};

/// Most voxels: two bytes each, and one for being inside.
const MOST_VOXELS: usize = 400_000_000;
/// Name endings of slices.
const ENDINGS: [&str; 4] = ["png", "tif", "tiff", "bmp"];
/// Voxels that the threshold is found from.
const SAMPLE: usize = 1_000_000;

/// Whether the body is given as a stack of slices.
pub(crate) fn is_stack(arguments: &Arguments) -> bool {
    arguments.voxel.is_some()
}

/// The files that a stack is read from: the slices of a folder in the order of the numbers in their names, or one file.
///
/// # Errors
///
/// A folder that cannot be listed or holds no slice.
pub(crate) fn files(place: &Path) -> anyhow::Result<Vec<PathBuf>> {
    if !place.is_dir() {
        return Ok(vec![place.to_owned()]);
    }
    let name = place.display();
    let (found, _) = files_in(place, &ENDINGS).with_context(|| format!("cannot read {name}"))?;
    ensure!(
        !found.is_empty(),
        "{name} holds no slice ({})",
        ENDINGS.join(", ")
    );
    Ok(found)
}

/// Reads a stack and makes the mesh of its bright body; also the threshold that parts it from the dark, as stated or found.
///
/// # Errors
///
/// Slices that cannot be read or differ in size, more voxels than are handled, a threshold or an edge length that is invalid,
/// no body.
pub(crate) fn read(
    arguments: &Arguments,
    place: &Path,
    repair: &Repair,
) -> anyhow::Result<(CheckedMesh, f64)> {
    let text = arguments.voxel.as_deref().unwrap_or_default();
    let edge = length_in_metres("voxel", text, arguments.unit)?;
    let mut stack = VoxelStack {
        values: Vec::new(),
        counts: [0; 3],
        spacing: [edge; 3],
    };
    for file in files(place)? {
        let slices = slices_in(&file).with_context(|| format!("cannot read {}", file.display()))?;
        for (size, values) in slices {
            let before = [stack.counts[0], stack.counts[1]];
            ensure!(
                stack.counts[2] == 0 || size == before,
                "{}: a slice of {} by {} px behind slices of {} by {} px",
                file.display(),
                size[0],
                size[1],
                before[0],
                before[1]
            );
            ensure!(
                stack.values.len() + values.len() <= MOST_VOXELS,
                "{}: more than {MOST_VOXELS} voxels: scale the slices down, or leave out what is empty",
                place.display()
            );
            stack.counts = [size[0], size[1], stack.counts[2] + 1];
            stack.values.extend(values);
        }
    }
    ensure!(
        stack.counts[2] > 1,
        "{} is one slice; a body needs a stack of them",
        place.display()
    );
    let threshold = match arguments.voxel_threshold {
        Some(level) => level,
        None => found_threshold(&stack.values),
    };
    let read = stack.surface(threshold, &place.display().to_string(), repair);
    let read =
        read.with_context(|| format!("with the threshold {threshold:.1} (--voxel-threshold)"))?;
    Ok((read, threshold))
}

/// Size and grey values of a slice, 0 to 65535; those of 8 bits 0 to 255.
type Slice = ([usize; 2], Vec<u16>);

fn slices_in(file: &Path) -> anyhow::Result<Vec<Slice>> {
    let bytes = input::file::read(file)?;
    if image::guess_format(&bytes).is_ok_and(|format| format == ImageFormat::Tiff) {
        return tiff_slices(&bytes);
    }
    let picture = decode_photo(file, &bytes)?;
    let size = [picture.width() as usize, picture.height() as usize];
    let values = match picture {
        DynamicImage::ImageLuma16(grey) => grey.into_raw(),
        other => other
            .into_luma8()
            .into_raw()
            .into_iter()
            .map(u16::from)
            .collect(),
    };
    Ok(vec![(size, values)])
}

/// All pictures of a TIFF file.
fn tiff_slices(bytes: &[u8]) -> anyhow::Result<Vec<Slice>> {
    let mut decoder = Decoder::new(Cursor::new(bytes))?;
    let mut slices = Vec::new();
    loop {
        let (width, height) = decoder.dimensions()?;
        let size = [width as usize, height as usize];
        let values = match decoder.read_image()? {
            DecodingResult::U8(grey) => grey.into_iter().map(u16::from).collect(),
            DecodingResult::U16(grey) => grey,
            _ => bail!("its values are not whole numbers of 8 or 16 bits: convert it"),
        };
        ensure!(
            values.len() == size[0] * size[1],
            "it has more than one channel: convert it to grey"
        );
        slices.push((size, values));
        if !decoder.more_images() {
            return Ok(slices);
        }
        decoder.next_image()?;
    }
}

/// The threshold that parts bright from dark voxels best, in 256 steps of the brightest.
fn found_threshold(values: &[u16]) -> f64 {
    let brightest = f64::from(values.iter().copied().max().unwrap_or(0).max(1));
    let mut histogram = [0; 256];
    for value in values.iter().step_by(values.len() / SAMPLE + 1) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most 255"
        )]
        let level = (255.0 * f64::from(*value) / brightest).round() as usize;
        histogram[level] += 1;
    }
    // Slices of one level have no other side; the reading of the surface refuses them.
    otsu_threshold(&histogram).unwrap_or(0.5) / 255.0 * brightest
}
