//! A body type, prepared for the contact search.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use clump::Clump;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use wide::f32x8;

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
    /// The same spheres in single precision.
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

/// Copy of the spheres in single precision for the vectorised search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Packed {
    /// Spheres in their order, padded to whole groups by spheres of radius minus infinity.
    pub(crate) groups: Vec<Group>,
    /// Lower corner of the box that holds all spheres, m.
    pub(crate) low: [f32; 3],
    /// Upper corner, m.
    pub(crate) high: [f32; 3],
}

/// Eight spheres side by side.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Group {
    /// x of the centres, m.
    pub(crate) x: [f32; LANES],
    /// y of the centres, m.
    pub(crate) y: [f32; LANES],
    /// z of the centres, m.
    pub(crate) z: [f32; LANES],
    /// Radii, m.
    pub(crate) radius: [f32; LANES],
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
    /// Copies centres and radii.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding to single precision is meant"
    )]
    fn new(centres: &[Vector3<f64>], radii: &[f64]) -> Self {
        let bound = |axis: usize, sign: f64| {
            let reaches = centres.iter().zip(radii).map(|(c, r)| sign * c[axis] + r);
            (sign * reaches.fold(f64::NEG_INFINITY, f64::max)) as f32
        };
        let group = |(centres, radii): (&[Vector3<f64>], &[f64])| {
            let mut group = Group {
                radius: [f32::NEG_INFINITY; LANES],
                ..Group::default()
            };
            for (l, (centre, &radius)) in centres.iter().zip(radii).enumerate() {
                (group.x[l], group.y[l]) = (centre.x as f32, centre.y as f32);
                (group.z[l], group.radius[l]) = (centre.z as f32, radius as f32);
            }
            group
        };
        Self {
            groups: centres
                .chunks(LANES)
                .zip(radii.chunks(LANES))
                .map(group)
                .collect(),
            low: [bound(0, -1.0), bound(1, -1.0), bound(2, -1.0)],
            high: [bound(0, 1.0), bound(1, 1.0), bound(2, 1.0)],
        }
    }
}

impl Group {
    /// Centres in registers, m.
    #[inline(always)]
    pub(crate) fn centres(&self) -> [f32x8; 3] {
        [self.x, self.y, self.z].map(f32x8::from)
    }
}
