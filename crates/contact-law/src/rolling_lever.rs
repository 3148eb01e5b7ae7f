//! The lever arm on which rolling resistance acts.
//!
//! # Formula
//!
//! ```text
//! L = l_i l_j / (l_i + l_j)      at a wall L = l_i
//! centre:  l = distance from the contact to the centre of mass of the body
//! sphere:  l = distance from the contact to the centre of the touching sphere, R - d/2
//! ```
//!
//! d is the overlap. For single spheres both are the same. In an agglomerate a touching sphere lies away from the
//! centre of the body, so that the same coefficient gives a smaller torque with `sphere`: for a seed of cotton
//! filled with spheres of 0.45 mm some 6 times (mean over its surface).
//!
//! # Source
//!
//! `sphere` is the arm of `[CottonStudy, eq. 6]`, whose particles are the fractions of a seed, and of codes that
//! know the sphere only (LAMMPS, LIGGGHTS, EDEM); `[Ai2011]` state the reduced radius of two spheres.
//! `[CottonStudy, eq. 6]` gives each of two bodies its whole radius, which for two equal
//! spheres is twice the L used here: a coefficient of that equation between two seeds counts double here, at a wall it
//! counts as it is.

use serde::{Deserialize, Serialize};

/// From where the lever arm of rolling resistance is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RollingLever {
    /// From the centre of mass of the body.
    #[default]
    Centre,
    /// From the centre of the touching sphere.
    Sphere,
}

impl RollingLever {
    /// The arm of one body (m): that of its centre, or that of its sphere.
    #[inline]
    pub fn of(self, centre: f64, sphere: f64) -> f64 {
        match self {
            Self::Centre => centre,
            Self::Sphere => sphere,
        }
    }
}
