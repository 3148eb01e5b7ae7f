//! Frames for `ParaView`: one VTK file a frame, and a PVD file that lists them with their times; beside it the same for the walls
//! of triangles where they stand, each triangle with the array `wall` (its number among those named in the comment at the top).
//!
//! Each sphere of a seed, hidden ones included, is a point with the arrays `radius` (m), `volume` (m³, see
//! [`crate::exchange::fractions`]), `velocity` (m/s, of the sphere's centre), `body` (number of the seed), `kind` (of the seed) and
//! `material` (number of the material); a comment at the top of each file names kinds and materials. In `ParaView`: Glyph,
//! type sphere, scale array `radius`, scale factor 2.

use crate::exchange::fractions::fractions;
use scene::{Frame, PlacedWall, Scene, SeedBody, walls_in_frame};
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

/// The files of a series: `NAME.pvd` first, then `NAME_0000.vtp` and so on; if the scene has walls of triangles, `NAME_walls.pvd`
/// and its files follow.
///
/// # Errors
///
/// A mesh of a wall that is refused.
pub fn series(
    name: &str,
    scene: &Scene,
    frames: &[Frame],
    bodies: &[Arc<SeedBody>],
) -> Result<Vec<File>, scene::Error> {
    let of_seeds = frames.iter().map(|frame| points(scene, frame, bodies));
    let mut files = listed(name, frames, of_seeds.collect());
    let placed = frames.iter().map(|frame| walls_in_frame(scene, frame));
    let placed = placed.collect::<Result<Vec<_>, _>>()?;
    if placed.iter().any(|walls| !walls.is_empty()) {
        let of_walls = placed.iter().map(|walls| triangles(walls));
        files.extend(listed(&format!("{name}_walls"), frames, of_walls.collect()));
    }
    Ok(files)
}

/// The texts of frames as files, behind their list.
fn listed(name: &str, frames: &[Frame], texts: Vec<String>) -> Vec<File> {
    let mut list = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
    );
    let mut files = Vec::new();
    for ((k, frame), text) in frames.iter().enumerate().zip(texts) {
        let file = format!("{name}_{k:04}.vtp");
        let entry = format_args!("<DataSet timestep=\"{}\" file=\"{file}\"/>\n", frame.time);
        add(&mut list, entry);
        files.push(File { name: file, text });
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

/// Names with their numbers, as a comment can have them.
fn numbered(names: impl Iterator<Item = impl std::fmt::Display>) -> String {
    let all: Vec<_> = names.enumerate().map(|(k, n)| format!("{k} {n}")).collect();
    all.join(", ").replace("--", "- -")
}

/// An array of numbers, a row of `components` a line.
fn array(name: &str, kind: &str, components: usize, data: &str) -> String {
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"ascii\">\n{data}</DataArray>\n"
    )
}

/// Lines of an array.
fn column(n: usize, row: &dyn Fn(usize) -> String) -> String {
    (0..n).fold(String::new(), |mut text, k| {
        text.push_str(&row(k));
        text.push('\n');
        text
    })
}

/// A vector as a line.
fn vector(v: nalgebra::Vector3<f64>) -> String {
    format!("{:e} {:e} {:e}", v.x, v.y, v.z)
}

/// The walls of one frame.
fn triangles(walls: &[PlacedWall]) -> String {
    let numbered = numbered(walls.iter().map(|wall| &wall.name));
    let all: Vec<_> = (0_usize..)
        .zip(walls)
        .flat_map(|(number, wall)| wall.triangles.iter().map(move |t| (number, t)))
        .collect();
    let corners: Vec<_> = all.iter().flat_map(|(_, corners)| **corners).collect();
    let n = all.len();
    format!(
        "<?xml version=\"1.0\"?>\n<!-- wall: {numbered} -->\n<VTKFile type=\"PolyData\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" \
         NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{n}\">\n<Points>\n{}</Points>\n\
         <CellData Scalars=\"wall\">\n{}</CellData>\n<Polys>\n{}{}</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        corners.len(),
        array(
            "position",
            "Float64",
            3,
            &column(corners.len(), &|k| vector(corners[k]))
        ),
        array("wall", "Int32", 1, &column(n, &|k| all[k].0.to_string())),
        array(
            "connectivity",
            "Int32",
            1,
            &column(3 * n, &|k| k.to_string())
        ),
        array(
            "offsets",
            "Int32",
            1,
            &column(n, &|k| (3 * k + 3).to_string())
        ),
    )
}

/// One frame as a cloud of points.
fn points(scene: &Scene, frame: &Frame, bodies: &[Arc<SeedBody>]) -> String {
    let materials = materials(scene);
    let of_kind = |kind: usize| {
        let material = scene.seed[kind].material.as_str();
        materials.iter().position(|m| *m == material).unwrap_or(0)
    };
    let kinds = numbered(scene.seed.iter().map(|seed| &seed.name));
    let named = numbered(materials.iter());
    let all = fractions(frame, bodies);
    let n = all.len();
    let number = |name: &str, value: &dyn Fn(usize) -> f64| {
        array(
            name,
            "Float64",
            1,
            &column(n, &|k| format!("{:e}", value(k))),
        )
    };
    let count = |name: &str, value: &dyn Fn(usize) -> usize| {
        array(name, "Int32", 1, &column(n, &|k| value(k).to_string()))
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
            &column(n, &|k| vector(all[k].sphere.centre))
        ),
        number("radius", &|k| all[k].sphere.radius),
        number("volume", &|k| all[k].volume),
        array(
            "velocity",
            "Float64",
            3,
            &column(n, &|k| vector(all[k].velocity))
        ),
        count("body", &|k| all[k].body),
        count("kind", &|k| all[k].kind),
        count("material", &|k| of_kind(all[k].kind)),
        count("connectivity", &|k| k),
        count("offsets", &|k| k + 1),
    )
}

#[cfg(test)]
mod tests {
    use super::series;
    use dem_solver::MeshPose;
    use dev_support::fixture_files::fixture;
    use nalgebra::{UnitQuaternion, Vector3};
    use scene::{FillingLibrary, Frame, Scene};

    /// A plate of a machine with a corner at (-20, 90, 0) mm that was turned by 90 degrees about the y axis and lowered by 30 mm has
    /// this corner at (0, 60, 20) mm, to rounding; the cup that was taken away is not written, and floors that are planes have no triangles.
    #[test]
    fn walls_are_written_where_they_stand() {
        let scene = Scene::read(&fixture("benches/machine.toml"), &[]).unwrap();
        let body = FillingLibrary::default()
            .body(&scene, &scene.seed[0])
            .unwrap();
        let cup = MeshPose {
            about: Vector3::zeros(),
            displacement: Vector3::zeros(),
            turn: UnitQuaternion::identity(),
            removed: true,
        };
        let paddle = MeshPose {
            displacement: Vector3::y() * -0.03,
            turn: UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2),
            removed: false,
            ..cup
        };
        let frame = Frame {
            time: 0.5,
            kind: vec![0],
            position: vec![Vector3::zeros()],
            orientation: vec![UnitQuaternion::identity()],
            velocity: vec![Vector3::zeros()],
            spin: vec![Vector3::zeros()],
            walls: vec![cup, paddle],
        };
        let files = series("bed", &scene, &[frame], &[body]).unwrap();
        let names: Vec<_> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "bed.pvd",
                "bed_0000.vtp",
                "bed_walls.pvd",
                "bed_walls_0000.vtp"
            ]
        );
        let text = &files[3].text;
        assert!(text.contains("wall: 0 paddle"), "{text}");
        let (_, after) = text.split_once("format=\"ascii\">\n").unwrap();
        let first = after.lines().next().unwrap();
        let corner: Vec<f64> = first.split(' ').map(|c| c.parse().unwrap()).collect();
        let off = Vector3::from_column_slice(&corner) - Vector3::new(0.0, 0.06, 0.02);
        assert!(off.norm() < 1e-12, "{first}");
    }
}
