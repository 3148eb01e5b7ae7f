//! Why a body cannot be filled.

use crate::Method;
use input::quantity::significant;

/// Why a filling is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh does not bound one body.
    #[error(transparent)]
    Mesh(#[from] trimesh::Error),
    /// The spheres make no rigid body.
    #[error(transparent)]
    Clump(#[from] geometry::clump::Error),
    /// A setting is not a positive finite number.
    #[error("{what} is {value}; it must be a positive finite number")]
    NotPositive {
        /// Which setting, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// No sphere was asked for.
    #[error("0 spheres were asked for; at least 1 is needed")]
    NoSpheresAsked,
    /// Not even one sphere fits.
    #[error(
        "a sphere of radius {} mm does not fit into {mesh}: the largest that does has about {} mm; \
         take a smaller radius or check the unit of the mesh",
        significant(*radius_mm, 4),
        significant(*largest_mm, 4)
    )]
    RadiusTooLarge {
        /// Mesh.
        mesh: String,
        /// Radius asked for, mm.
        radius_mm: f64,
        /// Radius of the largest inscribed sphere, mm.
        largest_mm: f64,
    },
    /// The radius is so small that the filling would take too many spheres.
    #[error(
        "a radius of {} mm would take about {estimate:.2e} spheres in {mesh}, more \
         than {limit}; take a larger radius or check the unit of the mesh",
        significant(*radius_mm, 4)
    )]
    TooManySpheres {
        /// Mesh.
        mesh: String,
        /// Radius asked for, mm.
        radius_mm: f64,
        /// Expected number of spheres.
        estimate: f64,
        /// Largest number allowed.
        limit: usize,
    },
    /// The cells of the surface of the union are too many.
    #[error(
        "cells of {} mm are too many for the surface of the union: take at least {} mm (seedfill: --union-cell)",
        significant(*cell_mm, 4),
        significant(*least_mm, 4)
    )]
    CellTooSmall {
        /// Edge length of a cell, mm.
        cell_mm: f64,
        /// Least edge length, mm.
        least_mm: f64,
    },
    /// More was asked for than is done.
    #[error("{what} {value:e} is asked for; the most is {most}")]
    TooMuch {
        /// What.
        what: &'static str,
        /// The value.
        value: f64,
        /// The most.
        most: f64,
    },
    /// The number of spheres asked for was not reached.
    #[error(
        "{asked} spheres of radius {} mm were asked for in {mesh}, {reached} were placed; {}take fewer or smaller spheres",
        significant(*radius_mm, 4),
        if method.follows_count() { "" } else { "raise the effort, or " }
    )]
    CountNotReached {
        /// Mesh.
        mesh: String,
        /// Spheres asked for.
        asked: usize,
        /// Spheres placed.
        reached: usize,
        /// Radius, mm.
        radius_mm: f64,
        /// How they were placed: only the search of equal spheres finds more with more effort.
        method: Method,
    },
    /// The smoothness asked for was not reached.
    #[error(
        "a surface roughness of {} mm was asked for in {mesh}; {spheres} spheres reach {} mm; allow \
         more or smaller spheres",
        significant(*asked_mm, 4),
        significant(*reached_mm, 4)
    )]
    RoughnessNotReached {
        /// Mesh.
        mesh: String,
        /// Roughness asked for, mm.
        asked_mm: f64,
        /// Roughness reached, mm.
        reached_mm: f64,
        /// Spheres used.
        spheres: usize,
    },
    /// The errors asked for were not reached.
    #[error(
        "the target of {mesh} was not reached: {spheres} spheres give {reached}; allow more or \
         smaller spheres, another method, or a wider target ({asked})"
    )]
    TargetNotReached {
        /// Mesh.
        mesh: String,
        /// Errors asked for.
        asked: String,
        /// Errors reached.
        reached: String,
        /// Spheres used.
        spheres: usize,
    },
}
