//! Files of spheres for other programs.

use clump::Sphere;
use std::fmt::Write as _;
use std::path::Path;
use trimesh::LengthUnit;

/// File formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// Table with the header x,y,z,radius in the unit of the mesh
    Csv,
    /// Points with radii for `ParaView` (legacy VTK), in the unit of the mesh
    Vtk,
    /// Multisphere template: x y z r a line, in metres
    Liggghts,
    /// Sphere list: x y z r a line, in metres
    Yade,
    /// Not supported yet
    Lammps,
    /// Not supported yet
    Edem,
    /// Not supported yet
    Pfc,
}

/// Format that was asked for, or that belongs to the extension of a file.
///
/// # Errors
///
/// A format that cannot be written, or an extension that names none.
pub(crate) fn choose_format(asked: Option<Format>, file: &Path) -> anyhow::Result<Format> {
    const SUPPORTED: &str = "supported are csv, vtk, liggghts and yade";
    let extension = file
        .extension()
        .map(|end| end.to_string_lossy().to_lowercase());
    let format = match (asked, extension.as_deref()) {
        (Some(format), _) => format,
        (None, Some("csv")) => Format::Csv,
        (None, Some("vtk")) => Format::Vtk,
        _ => anyhow::bail!(
            "the name {} does not tell the format: say --format; {SUPPORTED}",
            file.display()
        ),
    };
    match format {
        Format::Lammps | Format::Edem | Format::Pfc => {
            let name = format!("{format:?}").to_lowercase();
            anyhow::bail!("--format {name} is not supported yet; {SUPPORTED}")
        }
        _ => Ok(format),
    }
}

/// Writes spheres (m) as text of a format.
pub(crate) fn sphere_text(format: Format, spheres: &[Sphere], unit: LengthUnit) -> String {
    match format {
        Format::Vtk => vtk(spheres, unit),
        Format::Liggghts | Format::Yade | Format::Lammps | Format::Edem | Format::Pfc => {
            let head = "# x y z radius, m\n".to_owned();
            rows(head, spheres, LengthUnit::Metre, ' ')
        }
        Format::Csv => rows("x,y,z,radius\n".to_owned(), spheres, unit, ','),
    }
}

/// One line a sphere.
fn rows(mut text: String, spheres: &[Sphere], unit: LengthUnit, between: char) -> String {
    for [x, y, z, r] in spheres.iter().map(|sphere| in_unit(sphere, unit)) {
        writeln!(text, "{x}{between}{y}{between}{z}{between}{r}").expect("a string takes all text");
    }
    text
}

/// Centre and radius in a unit.
pub(crate) fn in_unit(sphere: &Sphere, unit: LengthUnit) -> [f64; 4] {
    let c = sphere.centre;
    [c.x, c.y, c.z, sphere.radius].map(|length| length / unit.in_metres())
}

/// Legacy VTK polydata: points, one vertex each, radius as point data.
fn vtk(spheres: &[Sphere], unit: LengthUnit) -> String {
    let n = spheres.len();
    let mut text = format!(
        "# vtk DataFile Version 3.0\nspheres of a seed, lengths in {unit}\nASCII\n\
         DATASET POLYDATA\nPOINTS {n} double\n"
    );
    let mut cells = format!("VERTICES {n} {}\n", 2 * n);
    let mut radii = format!("POINT_DATA {n}\nSCALARS radius double 1\nLOOKUP_TABLE default\n");
    for (i, sphere) in spheres.iter().enumerate() {
        let [x, y, z, r] = in_unit(sphere, unit);
        writeln!(text, "{x} {y} {z}").expect("a string takes all text");
        writeln!(cells, "1 {i}").expect("a string takes all text");
        writeln!(radii, "{r}").expect("a string takes all text");
    }
    text + &cells + &radii
}
