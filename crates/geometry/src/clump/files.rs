//! Bodies of spheres written as the files of other programs, and tables of spheres read ([`read_spheres`]).
//!
//! | format | frame | unit | what the file holds |
//! |---|---|---|---|
//! | [`Format::Csv`], [`Format::Vtk`] | of the mesh | of the mesh | centres and radii |
//! | [`Format::Liggghts`], [`Format::Yade`] | of the mesh | m | centres and radii, one sphere a line |
//! | [`Format::Lammps`] | principal axes about the centroid | m, kg | a molecule: spheres, and mass, centre, inertia if the mass is known |
//! | [`Format::Pfc`] | about the centroid | m | a clump template with volume and inertia at unit density |
//! | [`Format::Edem`] | principal axes about the centroid | m | the table of spheres of a multi-sphere particle |
//!
//! ```
//! use geometry::clump::Sphere;
//! use geometry::clump::files::{Body, Format, write};
//! use nalgebra::{Matrix3, Vector3};
//! let spheres = [Sphere { centre: Vector3::new(0.0, 0.0, 2e-3), radius: 1e-3 }];
//! let body = Body {
//!     spheres: &spheres,
//!     name: "seed",
//!     unit: ("mm", 1e-3),
//!     volume: 4.19e-9,
//!     centroid: Vector3::new(0.0, 0.0, 2e-3),
//!     inertia: Matrix3::identity() * 1.7e-15,
//!     mass: None,
//! };
//! assert_eq!(write(Format::Csv, &body), "x,y,z,radius\n0,0,2,1\n");
//! ```

mod edem;
mod lammps;
mod liggghts;
mod pfc;
mod principal;
mod rows;
mod table;
mod vtk;
mod yade;

pub use table::{TableError, read_spheres};

use crate::clump::Sphere;
use nalgebra::{Matrix3, Vector3};

/// Programs whose files are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Table with the header x,y,z,radius in the unit of the mesh.
    Csv,
    /// Legacy VTK points with radii, for `ParaView`.
    Vtk,
    /// LIGGGHTS, `fix particletemplate/multisphere ... spheres file`.
    Liggghts,
    /// YADE, `ymport.text` and `ymport.textClumps`.
    Yade,
    /// LAMMPS, `molecule`.
    Lammps,
    /// EDEM, the table of spheres of a multi-sphere particle.
    Edem,
    /// PFC3D, `program call`.
    Pfc,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 7] = [
        Self::Csv,
        Self::Vtk,
        Self::Liggghts,
        Self::Yade,
        Self::Lammps,
        Self::Edem,
        Self::Pfc,
    ];

    /// Name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Vtk => "vtk",
            Self::Liggghts => "liggghts",
            Self::Yade => "yade",
            Self::Lammps => "lammps",
            Self::Edem => "edem",
            Self::Pfc => "pfc",
        }
    }

    /// Format of an extension (in lower case, without the dot).
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension {
            "csv" => Some(Self::Csv),
            "vtk" => Some(Self::Vtk),
            "multisphere" => Some(Self::Liggghts),
            "molecule" => Some(Self::Lammps),
            "p3dat" => Some(Self::Pfc),
            _ => None,
        }
    }
}

/// A body of spheres and the rigid body that it represents.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    /// Spheres in the frame of the mesh, m.
    pub spheres: &'a [Sphere],
    /// Name of the body; blanks and other signs become `_` where a program needs a plain word.
    pub name: &'a str,
    /// Symbol and length (m) of the unit of the mesh.
    pub unit: (&'a str, f64),
    /// Volume, m³.
    pub volume: f64,
    /// Centroid in the frame of the mesh, m.
    pub centroid: Vector3<f64>,
    /// Inertia tensor about the centroid at unit density, m⁵.
    pub inertia: Matrix3<f64>,
    /// Mass, kg, if known.
    pub mass: Option<f64>,
}

impl Body<'_> {
    /// The name as one word of letters, digits and `_`.
    pub(crate) fn word(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        self.name.chars().map(plain).collect()
    }

    /// The six components xx, yy, zz, xy, xz, yz of the inertia, times a density.
    pub(crate) fn inertia_components(&self, density: f64) -> [f64; 6] {
        [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| self.inertia[at] * density)
    }
}

/// Writes a body as the text of a file.
pub fn write(format: Format, body: &Body<'_>) -> String {
    match format {
        Format::Csv => rows::csv(body),
        Format::Vtk => vtk::text(body),
        Format::Liggghts => liggghts::text(body),
        Format::Yade => yade::text(body),
        Format::Lammps => lammps::text(body),
        Format::Edem => edem::text(body),
        Format::Pfc => pfc::text(body),
    }
}
