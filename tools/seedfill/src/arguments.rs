//! What the command can be asked.

use crate::sphere_file::format_named;
use clap::Parser;
use geometry::clump::files::Format;
use sphere_fill::Method;
use std::path::PathBuf;
use trimesh::{LengthUnit, Repair};

/// Fills a closed mesh (STL, OBJ, PLY) with spheres
///
/// Bare lengths are in the unit of the mesh; a unit may be written behind them (0.45mm).
/// Exit code: 0 filled; 1 refused (radius does not fit, count, roughness or target not reached; with --shapes some
/// meshes); 2 error.
#[derive(Debug, Parser)]
#[command(
    name = "seedfill",
    version,
    about,
    after_help = "Example:\n  seedfill seed.stl --radius 0.45 --mass 94.5e-6 --out seed.csv --preview seed.png"
)]
pub(crate) struct Arguments {
    /// Mesh to fill: STL, OBJ or PLY, binary or text; several with --shapes; with --voxel a folder of slices, or a TIFF of many
    #[arg(value_name = "MESH.stl", required = true)]
    pub(crate) mesh: Vec<PathBuf>,

    /// Write a table of the shapes of all meshes (CSV, or a workbook .xlsx): volume, area, lengths,
    /// elongation, flatness, sphericity; with --radius also the spheres of each filling
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["spheres", "out", "format", "bonds", "bond_gap", "union", "preview", "html", "mass", "density"])]
    pub(crate) shapes: Option<PathBuf>,

    /// Radius of the spheres (pack, lattice), or of the smallest allowed (all others)
    #[arg(
        long,
        value_name = "LENGTH",
        allow_hyphen_values = true,
        required_unless_present_any = ["spheres", "shapes"]
    )]
    pub(crate) radius: Option<String>,

    /// Place nothing: measure the spheres of a table x,y,z,radius in the frame of the mesh
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["radius", "method", "count", "max_spheres", "target", "roughness", "effort"])]
    pub(crate) spheres: Option<PathBuf>,

    /// Unit of the numbers in that table [default: that of the mesh]
    #[arg(long, value_name = "UNIT", requires = "spheres")]
    pub(crate) spheres_unit: Option<LengthUnit>,

    /// Unit of the numbers in the mesh: mm, cm, m or um
    #[arg(long, default_value = "mm", value_name = "UNIT")]
    pub(crate) unit: LengthUnit,

    /// Edge length of a voxel: the body is what is bright in a stack of slices (PNG, TIFF or BMP, 8 or 16 bits)
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) voxel: Option<String>,

    /// Grey level above which a voxel is bright [default: that which parts the levels best]
    #[arg(long, value_name = "LEVEL", requires = "voxel", value_parser = level)]
    pub(crate) voxel_threshold: Option<f64>,

    /// Of several bodies take the largest with its cavities, leave the others out
    #[arg(long)]
    pub(crate) largest_body: bool,

    /// Close holes up to this width (diagonal of the box round the rim) with flat lids
    /// [default: 3 % of the diagonal of the mesh]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) close_holes: Option<String>,

    /// Join vertices on open edges that lie this near to each other, as along cracks
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) join: Option<String>,

    /// Make the surface again on cubes of this edge length, round all that it encloses more than half: for scans that cross
    /// themselves, noise, cracks and wide holes; details finer than that are lost
    #[arg(long, value_name = "LENGTH")]
    pub(crate) rebuild: Option<String>,

    /// Cut away loose pieces, and triangles at edges of more than two, of together at most this
    /// percentage of the area
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 0.1,
        allow_hyphen_values = true
    )]
    pub(crate) crumbs: f64,

    /// How spheres are placed
    #[arg(long, value_enum, default_value = "pack")]
    pub(crate) method: MethodName,

    /// Place exactly N spheres, spread evenly [default: as many as are found]
    #[arg(long, value_name = "N")]
    pub(crate) count: Option<usize>,

    /// Place at most N spheres
    #[arg(long, value_name = "N", conflicts_with = "count")]
    pub(crate) max_spheres: Option<usize>,

    /// Take the fewest spheres that keep these errors: volume=1%,inertia=2%,surface=0.05mm
    #[arg(long, value_name = "ERRORS")]
    pub(crate) target: Option<String>,

    /// Surface roughness (rms) at which the method smooth stops, or that surface keeps with the
    /// fewest spheres; what ferellec takes for covered [default: radius / 20, surface: any]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) roughness: Option<String>,

    /// Seed of the random choices
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// Search work relative to the default
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_hyphen_values = true
    )]
    pub(crate) effort: f64,

    /// Mass of the seed in kg, for the fraction density
    #[arg(
        long,
        value_name = "KG",
        conflicts_with = "density",
        allow_hyphen_values = true
    )]
    pub(crate) mass: Option<f64>,

    /// Density of the seed in kg/m3, for mass and fraction density
    #[arg(long, value_name = "KG_M3", allow_hyphen_values = true)]
    pub(crate) density: Option<f64>,

    /// Write the spheres to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,

    /// Format of the spheres [default: by the extension of FILE]
    ///
    /// csv, vtk: unit of the mesh; liggghts, yade, lammps, edem, pfc: metres
    #[arg(long, value_name = "FORMAT", value_parser = format_named)]
    pub(crate) format: Option<Format>,

    /// Write the pairs of spheres that bonds join, with distance, gap and radius of the neck; spheres are
    /// numbered from 0 as in --out
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) bonds: Option<PathBuf>,

    /// Largest gap of two spheres that counts as contact and is bonded
    /// [default: 1 % of the smallest radius]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) bond_gap: Option<String>,

    /// Write the surface of the union of the spheres, closed, in the unit and frame of the mesh
    #[arg(long, value_name = "FILE.stl")]
    pub(crate) union: Option<PathBuf>,

    /// Cell of that surface; a quarter of the error in volume at half of it
    /// [default: smallest radius / 6]
    #[arg(
        long,
        value_name = "LENGTH",
        allow_hyphen_values = true,
        requires = "union"
    )]
    pub(crate) union_cell: Option<String>,

    /// Draw spheres and mesh to a picture
    #[arg(long, value_name = "FILE.png")]
    pub(crate) preview: Option<PathBuf>,

    /// Write a report with pictures and the spheres to be turned, one HTML file
    #[arg(long, value_name = "FILE.html")]
    pub(crate) html: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) common: command_line::Common,
}

impl Arguments {
    /// What may be changed in the mesh.
    ///
    /// # Errors
    ///
    /// A value that is not a length, a share that is not a percentage below 50.
    pub(crate) fn repair(&self) -> anyhow::Result<Repair> {
        let length = |flag: &str, text: &Option<String>| {
            let text = text.as_deref();
            text.map(|text| length_in_metres(flag, text, self.unit))
                .transpose()
        };
        anyhow::ensure!(
            (0.0..50.0).contains(&self.crumbs),
            "--crumbs {}: it must be a percentage of the area from 0 to below 50",
            self.crumbs
        );
        Ok(Repair {
            join: length("join", &self.join)?,
            close_holes: length("close-holes", &self.close_holes)?,
            crumbs: self.crumbs / 100.0,
            rebuild: length("rebuild", &self.rebuild)?,
        })
    }

    /// Mass of a seed of a volume (m³), kg, if mass or density are given.
    pub(crate) fn mass_of(&self, volume: f64) -> Option<f64> {
        self.mass.or(self.density.map(|density| density * volume))
    }
}

/// Reads a grey level.
fn level(text: &str) -> Result<f64, String> {
    let level = text.trim().parse().ok();
    let level = level.filter(|level: &f64| (0.0..65_535.0).contains(level));
    level.ok_or_else(|| format!("\"{text}\" must be a grey level from 0 to below 65535"))
}

/// Names of the methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum MethodName {
    /// Equal spheres, dense, without overlap
    Pack,
    /// Equal spheres on the best placed close-packed lattice
    Lattice,
    /// Inscribed overlapping spheres that follow the surface
    Smooth,
    /// Overlapping spheres fitted to the surface, at the volume of the body
    Surface,
    /// Spheres along the longest axis (Favier 1999)
    Favier,
    /// Inscribed spheres at random surface points (Ferellec and `McDowell` 2010)
    Ferellec,
    /// Peaks of the distance to the surface
    DistanceTransform,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Pack => Self::Pack,
            MethodName::Lattice => Self::Lattice,
            MethodName::Smooth => Self::Smooth,
            MethodName::Surface => Self::Surface,
            MethodName::Favier => Self::Favier,
            MethodName::Ferellec => Self::Ferellec,
            MethodName::DistanceTransform => Self::DistanceTransform,
        }
    }
}

/// Reads a length in metres; a bare number is in the unit of the mesh.
///
/// # Errors
///
/// No number, a number that is not positive and finite, or an unknown unit.
pub(crate) fn length_in_metres(flag: &str, text: &str, mesh: LengthUnit) -> anyhow::Result<f64> {
    let text = text.trim();
    let (digits, unit) = if text.parse::<f64>().is_ok() {
        (text, mesh)
    } else {
        // The e of an exponent is followed by digits, so only a unit is cut off here.
        let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let unit = match &text[digits.len()..] {
            "" => mesh,
            symbol => symbol
                .parse()
                .map_err(|error| anyhow::anyhow!("--{flag} {text}: {error}"))?,
        };
        (digits.trim(), unit)
    };
    let value: f64 = digits.parse().map_err(|_| {
        anyhow::anyhow!("--{flag} {text}: expected a length such as 0.45 or 0.45mm")
    })?;
    anyhow::ensure!(
        value.is_finite() && value > 0.0,
        "--{flag} {text}: a length must be a positive number"
    );
    Ok(value * unit.in_metres())
}

#[cfg(test)]
mod tests {
    use super::length_in_metres;
    use trimesh::LengthUnit::{Metre, Millimetre};

    #[test]
    fn a_bare_length_is_in_the_unit_of_the_mesh_and_a_written_unit_wins() {
        let read = |text, unit| length_in_metres("radius", text, unit).unwrap();
        assert!((read("0.45", Millimetre) - 0.45e-3).abs() < 1e-18);
        assert!((read("4.5e-4", Metre) - 0.45e-3).abs() < 1e-18);
        assert!((read("450 um", Metre) - 0.45e-3).abs() < 1e-18);
    }

    #[test]
    fn what_is_no_positive_length_is_refused() {
        for text in [
            "",
            "mm",
            "0",
            "-1",
            "nan",
            "inf",
            "1e999",
            "0.45 inch",
            "0,45",
        ] {
            let refused = length_in_metres("radius", text, Millimetre);
            let message = refused.expect_err(text).to_string();
            assert!(message.contains("--radius"), "{text}: {message}");
        }
    }
}
