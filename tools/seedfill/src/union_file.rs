//! The surface of the spheres as an STL file.

use crate::arguments::{Arguments, length_in_metres};
use anyhow::Context as _;
use command_line::significant;
use nalgebra::Vector3;
use serde::Serialize;
use sphere_fill::{Filling, union_surface};
use trimesh::{CheckedMesh, parse_mesh};

/// Cells in the radius of the smallest sphere if no cell is given: the volume is then within 1 % of the
/// union's (single balls lack up to 0.8 %, cells that bridge touching ones add), and 132 equal spheres take
/// 25 MB. Our choice.
const CELLS: f64 = 6.0;

/// What `--json` tells of the file; lengths and volumes are in the unit of the mesh.
#[derive(Debug, Serialize)]
pub(crate) struct UnionFile {
    cell: f64,
    triangles: usize,
    /// Closed surfaces in the file.
    shells: usize,
    /// Volume as a reader of the file finds it.
    volume: f64,
    /// Of that volume against the union of the spheres.
    volume_error_percent: f64,
    #[serde(skip)]
    pub(crate) bytes: Vec<u8>,
}

impl UnionFile {
    /// Makes the file where it is asked for, and reads it back.
    ///
    /// # Errors
    ///
    /// An invalid cell or too small; a surface that single precision cannot hold.
    pub(crate) fn new(arguments: &Arguments, filling: &Filling) -> anyhow::Result<Option<Self>> {
        let Some(file) = &arguments.union else {
            return Ok(None);
        };
        let (unit, metre) = (arguments.unit, arguments.unit.in_metres());
        let cell = match cell_of(arguments)? {
            Some(cell) => cell,
            None => {
                filling
                    .spheres
                    .iter()
                    .map(|s| s.radius)
                    .fold(f64::INFINITY, f64::min)
                    / CELLS
            }
        };
        let soup = union_surface(&filling.spheres, cell)?;
        let name = file.display().to_string();
        let bytes = binary_stl(&soup, metre)?;
        let read = parse_mesh(bytes.clone(), unit, &name);
        let volume = read.ok().filter(|read| is_as_written(read, soup.len()));
        let (shells, volume) = volume
            .and_then(|read| Some((read.report.shells, read.report.volume?)))
            .with_context(|| {
                format!(
                    "{name}: an STL file holds seven digits, too few for cells of {} {unit} this far from the \
                     origin: take larger cells (--union-cell) or move the mesh to the origin",
                    significant(cell / metre, 3)
                )
            })?;
        Ok(Some(Self {
            cell: cell / metre,
            triangles: soup.len(),
            shells,
            volume: volume / metre.powi(3),
            volume_error_percent: 100.0 * (volume / filling.union_moments.volume - 1.0),
            bytes,
        }))
    }

    /// Name and value for people.
    pub(crate) fn line(&self) -> (&'static str, String) {
        let text = format!(
            "{} triangles, {} closed, volume {:+.2} % of the union's",
            self.triangles,
            if self.shells == 1 {
                "1 surface".to_owned()
            } else {
                format!("{} surfaces", self.shells)
            },
            self.volume_error_percent
        );
        ("surface of the spheres", text)
    }
}

/// The cell as the user gives it, m.
///
/// # Errors
///
/// No length; a cell without a file.
pub(crate) fn cell_of(arguments: &Arguments) -> anyhow::Result<Option<f64>> {
    let text = arguments.union_cell.as_deref();
    text.map(|text| length_in_metres("union-cell", text, arguments.unit))
        .transpose()
}

/// Whether a reader finds all triangles, and each edge closed.
fn is_as_written(read: &CheckedMesh, triangles: usize) -> bool {
    read.report.triangles == triangles
        && read.report.watertight
        && read.report.triangles_turned == 0
}

/// Triangles (m) as a binary STL whose numbers are in a unit of some metres.
fn binary_stl(soup: &[[Vector3<f64>; 3]], metre: f64) -> anyhow::Result<Vec<u8>> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "STL holds single precision"
    )]
    let single = |vector: Vector3<f64>| vector.map(|value| value as f32).into();
    let triangles = soup.iter().map(|[a, b, c]| {
        let normal = (b - a).cross(&(c - a)).normalize();
        stl_io::Triangle {
            normal: stl_io::Vector(single(normal)),
            vertices: [a, b, c].map(|corner| stl_io::Vector(single(corner / metre))),
        }
    });
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles).context("the surface has no form as STL")?;
    Ok(bytes)
}
