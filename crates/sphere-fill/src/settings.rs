//! What to fill a body with.

use crate::body::MOST_SPHERES;
use crate::{Error, Target};
use serde::{Deserialize, Serialize};

/// Greatest effort: a quarter of an hour for 150 spheres. Our choice.
const MOST_EFFORT: f64 = 1000.0;

/// Most spheres on the axis of a body, each of which is as deep as the body there: some seconds. Our choice.
const MOST_ON_AXIS: usize = 10_000;

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
    /// Fewest spheres for a surface error, at the volume of the body: see [`crate::Surface`].
    Surface,
    /// Spheres along the longest axis: see [`crate::Favier`].
    Favier,
    /// Inscribed spheres at random surface points: see [`crate::Ferellec`].
    Ferellec,
    /// Peaks of the Euclidean distance transform: see [`crate::DistanceTransform`].
    DistanceTransform,
}

/// Settings of a filling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FillSettings {
    /// Radius of the spheres ([`Method::Pack`], [`Method::Lattice`]) or of the smallest allowed
    /// (all others), m.
    pub radius: f64,
    /// How spheres are placed.
    pub method: Method,
    /// Exact number of spheres; none: as many as are found (pack, lattice) or needed (smooth).
    pub count: Option<usize>,
    /// Most spheres; none: 400 for the methods of several radii, no limit for the others.
    pub max_spheres: Option<usize>,
    /// Errors that the filling must keep, with as few spheres as found.
    pub target: Option<Target>,
    /// Roughness at which [`Method::Smooth`] stops adding spheres, m; none: radius / 20. That
    /// which [`Method::Surface`] keeps with as few spheres as found; none: it is not looked at.
    pub roughness: Option<f64>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Search work relative to the default, 1: about half a second for 150 spheres, two for a
    /// lattice.
    pub effort: f64,
}

impl FillSettings {
    /// Dense packing of equal spheres of a radius in m, seed 1, default effort.
    pub fn new(radius: f64) -> Self {
        Self {
            radius,
            method: Method::Pack,
            count: None,
            max_spheres: None,
            target: None,
            roughness: None,
            seed: 1,
            effort: 1.0,
        }
    }

    /// Spheres at most: the count, or else the limit, or else `most`.
    pub(crate) fn count_or(&self, most: usize) -> usize {
        self.count.or(self.max_spheres).unwrap_or(most)
    }

    /// Refuses invalid settings.
    ///
    /// # Errors
    ///
    /// A radius, effort or roughness that is not positive and finite; a count of 0; more effort or spheres than is
    /// done.
    pub fn check(&self) -> Result<(), Error> {
        positive("the sphere radius in m", self.radius)?;
        positive("the effort", self.effort)?;
        at_most("effort", self.effort, MOST_EFFORT)?;
        positive("the roughness in m", self.roughness.unwrap_or(1.0))?;
        let most = match self.method {
            Method::Favier => MOST_ON_AXIS,
            _ => MOST_SPHERES,
        };
        for (what, count) in [("count", self.count), ("max-spheres", self.max_spheres)] {
            at_most(what, count.unwrap_or(1) as f64, most as f64)?;
        }
        self.target.map_or(Ok(()), |target| target.check())?;
        if self.count == Some(0) || self.max_spheres == Some(0) {
            return Err(Error::NoSpheresAsked);
        }
        Ok(())
    }
}

/// Refuses what asks for more than is done.
fn at_most(what: &'static str, value: f64, most: f64) -> Result<(), Error> {
    if value <= most {
        Ok(())
    } else {
        Err(Error::TooMuch { what, value, most })
    }
}

/// Refuses what is not a positive finite number.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::NotPositive { what, value })
    }
}
