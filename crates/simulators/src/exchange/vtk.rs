//! Frames for `ParaView`: one VTK file a frame, and a PVD file that lists them with their times.
//!
//! Each sphere of a seed, hidden ones included, is a point with the arrays `radius` (m), `volume` (m³, see
//! [`crate::exchange::fractions`]), `velocity` (m/s, of the sphere's centre), `body` (number of the seed), `kind` (of the seed) and
//! `material` (number of the material); a comment at the top of each file names kinds and materials. In `ParaView`: Glyph,
//! type sphere, scale array `radius`, scale factor 2.

use crate::exchange::fractions::fractions;
use scene::{Frame, Scene, SeedBody};
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
pub fn series(name: &str, scene: &Scene, frames: &[Frame], bodies: &[Arc<SeedBody>]) -> Vec<File> {
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
            text: points(scene, frame, bodies),
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

/// Materials of the seeds, each once, in the order of the scene.
fn materials(scene: &Scene) -> Vec<&str> {
    let mut found: Vec<&str> = Vec::new();
    for seed in &scene.seed {
        if !found.contains(&seed.material.as_str()) {
            found.push(&seed.material);
        }
    }
    found
}

/// One frame as a cloud of points.
fn points(scene: &Scene, frame: &Frame, bodies: &[Arc<SeedBody>]) -> String {
    let materials = materials(scene);
    let of_kind = |kind: usize| {
        let material = scene.seed[kind].material.as_str();
        materials.iter().position(|m| *m == material).unwrap_or(0)
    };
    let told = |names: Vec<String>| names.join(", ").replace("--", "- -");
    let kinds = scene.seed.iter().enumerate();
    let kinds = told(kinds.map(|(k, s)| format!("{k} {}", s.name)).collect());
    let named = materials.iter().enumerate();
    let named = told(named.map(|(k, m)| format!("{k} {m}")).collect());
    let all = fractions(frame, bodies);
    let n = all.len();
    let column = |row: &dyn Fn(usize) -> String| {
        (0..n).fold(String::new(), |mut text, k| {
            text.push_str(&row(k));
            text.push('\n');
            text
        })
    };
    let vector = |v: nalgebra::Vector3<f64>| format!("{:e} {:e} {:e}", v.x, v.y, v.z);
    let array = |name: &str, kind: &str, components: usize, data: String| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"ascii\">\n{data}</DataArray>\n"
        )
    };
    let number = |name: &str, value: &dyn Fn(usize) -> f64| {
        array(name, "Float64", 1, column(&|k| format!("{:e}", value(k))))
    };
    let count = |name: &str, value: &dyn Fn(usize) -> usize| {
        array(name, "Int32", 1, column(&|k| value(k).to_string()))
    };
    format!(
        "<?xml version=\"1.0\"?>\n<!-- time {} s; kind: {kinds}; material: {named} -->\n\
         <VTKFile type=\"PolyData\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<PolyData>\n<Piece NumberOfPoints=\"{n}\" \
         NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n\
         <Points>\n{}</Points>\n<PointData Scalars=\"radius\" Vectors=\"velocity\">\n{}{}{}{}{}{}\
         </PointData>\n<Verts>\n{}{}</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        frame.time,
        array(
            "position",
            "Float64",
            3,
            column(&|k| vector(all[k].sphere.centre))
        ),
        number("radius", &|k| all[k].sphere.radius),
        number("volume", &|k| all[k].volume),
        array(
            "velocity",
            "Float64",
            3,
            column(&|k| vector(all[k].velocity))
        ),
        count("body", &|k| all[k].body),
        count("kind", &|k| all[k].kind),
        count("material", &|k| of_kind(all[k].kind)),
        count("connectivity", &|k| k),
        count("offsets", &|k| k + 1),
    )
}
