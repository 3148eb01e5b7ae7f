//! A body type, prepared for the contact search.

use clump::Clump;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Number of sphere pairs handled together.
pub(crate) const LANES: usize = 8;

/// Which mass enters the dashpots of a contact between two agglomerates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DashpotMass {
    /// The mass of the touching sphere, as in a bonded agglomerate, where each sphere is a
    /// particle of its own (the study's model).
    Sphere,
    /// The mass of the whole body, so that the rebound of a body follows the coefficient.
    Body,
}

/// A body type.
#[derive(Debug, Clone)]
pub struct Template {
    /// Reachable spheres: centres in the principal frame, m.
    pub(crate) centres: Vec<Vector3<f64>>,
    /// Radii of the same spheres, m.
    pub(crate) radii: Vec<f64>,
    /// Mass that each sphere brings into a dashpot, kg.
    pub(crate) dashpot_masses: Vec<f64>,
    /// Coordinates in single precision, padded to whole lanes by copies of sphere 0.
    pub(crate) packed: Packed,
    /// Mass, kg.
    pub(crate) mass: f64,
    /// Principal moments of inertia, kg m².
    pub(crate) inertia: Vector3<f64>,
    /// Inverse of the mass, 1/kg.
    pub(crate) inverse_mass: f64,
    /// Inverses of the moments, 1/(kg m²).
    pub(crate) inverse_inertia: Vector3<f64>,
    /// Radius of the bounding sphere about the centre of mass, m.
    pub(crate) bounding_radius: f64,
    /// Index of the material in the world's table.
    pub(crate) material: usize,
}

/// Structure-of-arrays copy of the spheres for the vectorised search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Packed {
    /// x of the centres, m.
    pub(crate) x: Vec<f32>,
    /// y of the centres, m.
    pub(crate) y: Vec<f32>,
    /// z of the centres, m.
    pub(crate) z: Vec<f32>,
    /// Radii, m.
    pub(crate) radius: Vec<f32>,
    /// Number of real spheres (the rest is padding).
    pub(crate) n: usize,
    /// Lower corner of the box that holds all spheres, m.
    pub(crate) low: [f32; 3],
    /// Upper corner, m.
    pub(crate) high: [f32; 3],
}

impl Template {
    /// Prepares a body type of material number `material`.
    ///
    /// Spheres that nothing outside can touch are left out of the contact search; mass and
    /// inertia keep them.
    pub fn new(clump: &Clump, material: usize, dashpot_mass: DashpotMass) -> Self {
        let smallest = clump
            .spheres()
            .iter()
            .map(|s| s.radius)
            .fold(f64::INFINITY, f64::min);
        let outer = clump.without_hidden_spheres(0.5 * smallest);
        let total: f64 = clump.spheres().iter().map(|s| s.radius.powi(3)).sum();
        let dashpot = |radius: f64| match dashpot_mass {
            DashpotMass::Sphere => clump.mass() * radius.powi(3) / total,
            DashpotMass::Body => clump.mass(),
        };
        let centres: Vec<_> = outer.spheres().iter().map(|s| s.centre).collect();
        let radii: Vec<_> = outer.spheres().iter().map(|s| s.radius).collect();
        Self {
            packed: Packed::new(&centres, &radii),
            dashpot_masses: radii.iter().map(|&r| dashpot(r)).collect(),
            centres,
            radii,
            mass: clump.mass(),
            inertia: clump.inertia(),
            inverse_mass: 1.0 / clump.mass(),
            inverse_inertia: clump.inertia().map(|moment| 1.0 / moment),
            bounding_radius: clump.bounding_radius(),
            material,
        }
    }

    /// Mass, kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Number of spheres that take part in the contact search.
    pub fn n_outer_spheres(&self) -> usize {
        self.centres.len()
    }

    /// Radius of the bounding sphere about the centre of mass, m.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// Smallest radius of the spheres that take part in the contact search, m.
    pub fn smallest_radius(&self) -> f64 {
        self.radii.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

impl Packed {
    /// Copies centres and radii into padded single-precision arrays.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding to single precision is meant"
    )]
    fn new(centres: &[Vector3<f64>], radii: &[f64]) -> Self {
        let n = centres.len();
        let padded = n.div_ceil(LANES) * LANES;
        let source = |i: usize| if i < n { i } else { 0 };
        let column = |axis: usize| {
            (0..padded)
                .map(|i| centres[source(i)][axis] as f32)
                .collect()
        };
        let bound = |axis: usize, sign: f64| {
            let reach = |i: usize| sign * centres[i][axis] + radii[i];
            (sign * (0..n).map(reach).fold(f64::NEG_INFINITY, f64::max)) as f32
        };
        Self {
            x: column(0),
            y: column(1),
            z: column(2),
            radius: (0..padded).map(|i| radii[source(i)] as f32).collect(),
            n,
            low: [bound(0, -1.0), bound(1, -1.0), bound(2, -1.0)],
            high: [bound(0, 1.0), bound(1, 1.0), bound(2, 1.0)],
        }
    }
}
