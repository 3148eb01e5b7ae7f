//! What to fill a body with.

use crate::Error;
use serde::{Deserialize, Serialize};

/// How spheres are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Equal spheres, dense, without overlap: see [`crate::Pack`].
    #[default]
    Pack,
    /// Equal spheres on the best placed close-packed lattice: see [`crate::Lattice`].
    Lattice,
    /// Overlapping spheres of several radii that follow the surface: see [`crate::Smooth`].
    Smooth,
}

/// What to fill a body with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FillSettings {
    /// Radius of the spheres (for [`Method::Smooth`] of the smallest allowed), m.
    pub radius: f64,
    /// How spheres are placed.
    pub method: Method,
    /// Exact number of spheres; none: as many as are found (pack, lattice) or needed (smooth).
    pub count: Option<usize>,
    /// Roughness at which [`Method::Smooth`] stops adding spheres, m; none: radius / 20.
    pub roughness: Option<f64>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Search work relative to the default, 1: about a second for 150 spheres.
    pub effort: f64,
}

impl FillSettings {
    /// Dense packing of equal spheres of a radius in m, seed 1, default effort.
    pub fn new(radius: f64) -> Self {
        Self {
            radius,
            method: Method::Pack,
            count: None,
            roughness: None,
            seed: 1,
            effort: 1.0,
        }
    }

    /// Refuses settings that cannot be meant.
    ///
    /// # Errors
    ///
    /// A radius, effort or roughness that is not positive and finite; a count of 0.
    pub fn check(&self) -> Result<(), Error> {
        let positive = |what: &'static str, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(Error::NotPositive { what, value })
            }
        };
        positive("the sphere radius in m", self.radius)?;
        positive("the effort", self.effort)?;
        positive("the roughness in m", self.roughness.unwrap_or(1.0))?;
        if self.count == Some(0) {
            return Err(Error::NoSpheresAsked);
        }
        Ok(())
    }
}
