//! Frames for `ParaView`: one VTK file a frame, and a PVD file that lists them.
//!
//! Each sphere at the surface of a seed is a point with the arrays `radius` (m), `velocity` (m/s, of the
//! sphere's centre), `seed` (number of the seed) and `kind`. In `ParaView`: Glyph, type sphere, scale
//! array `radius`, scale factor 2.

use scene::{Frame, SeedBody};
use std::fmt::{Arguments, Write as _};
use std::sync::Arc;

/// A file to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Name.
    pub name: String,
    /// Content.
    pub text: String,
}

/// Appends formatted text.
pub(crate) fn add(text: &mut String, what: Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(what);
}

/// The files of a series: `NAME.pvd` first, then `NAME_0000.vtp` and so on.
pub fn series(name: &str, frames: &[Frame], bodies: &[Arc<SeedBody>]) -> Vec<File> {
    let mut list = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
    );
    let mut files = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let file = format!("{name}_{k:04}.vtp");
        let entry = format_args!("<DataSet timestep=\"{}\" file=\"{file}\"/>\n", frame.time);
        add(&mut list, entry);
        files.push(File {
            name: file,
            text: points(frame, bodies),
        });
    }
    list.push_str("</Collection>\n</VTKFile>\n");
    files.insert(
        0,
        File {
            name: format!("{name}.pvd"),
            text: list,
        },
    );
    files
}

/// One frame as a cloud of points.
fn points(frame: &Frame, bodies: &[Arc<SeedBody>]) -> String {
    let (mut at, mut radius, mut velocity) = (String::new(), String::new(), String::new());
    let (mut seed, mut kind, mut n) = (String::new(), String::new(), 0_usize);
    for i in 0..frame.position.len() {
        for sphere in bodies[frame.kind[i]].outer.spheres() {
            let arm = frame.orientation[i] * sphere.centre;
            let c = frame.position[i] + arm;
            let v = frame.velocity[i] + frame.spin[i].cross(&arm);
            add(&mut at, format_args!("{:e} {:e} {:e}\n", c.x, c.y, c.z));
            add(
                &mut velocity,
                format_args!("{:e} {:e} {:e}\n", v.x, v.y, v.z),
            );
            add(&mut radius, format_args!("{:e}\n", sphere.radius));
            add(&mut seed, format_args!("{i}\n"));
            add(&mut kind, format_args!("{}\n", frame.kind[i]));
            n += 1;
        }
    }
    let vertices = (0..n).fold(String::new(), |mut text, k| {
        add(&mut text, format_args!("{k}\n"));
        text
    });
    let offsets = (1..=n).fold(String::new(), |mut text, k| {
        add(&mut text, format_args!("{k}\n"));
        text
    });
    let array = |name: &str, kind: &str, components: usize, data: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"ascii\">\n{data}</DataArray>\n"
        )
    };
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<PolyData>\n<Piece NumberOfPoints=\"{n}\" \
         NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n\
         <Points>\n{}</Points>\n<PointData Scalars=\"radius\" Vectors=\"velocity\">\n{}{}{}{}\
         </PointData>\n<Verts>\n{}{}</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        array("position", "Float64", 3, &at),
        array("radius", "Float64", 1, &radius),
        array("velocity", "Float64", 3, &velocity),
        array("seed", "Int32", 1, &seed),
        array("kind", "Int32", 1, &kind),
        array("connectivity", "Int32", 1, &vertices),
        array("offsets", "Int32", 1, &offsets),
    )
}
