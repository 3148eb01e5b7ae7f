//! All of a sphere that a contact needs, side by side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::contact::Mover;
use crate::template::OuterSphere;
use crate::transpose::{Row, row};
use nalgebra::Vector3;

/// All of a sphere that a contact needs, in two lines of the cache; a copy of what is in the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(crate) struct Sphere {
    /// Centre and radius, m; velocity, m/s, and the radius again: a difference of two spheres is one of rows, and the
    /// radii of both have a place beside it.
    pub(super) motion: [f64; 8],
    /// Angular velocity, rad/s, and mass in a dashpot, kg.
    pub(super) spin: Row,
}

impl Sphere {
    /// A sphere of this size and mass that moves so.
    pub(crate) fn new(shape: &OuterSphere, mover: &Mover) -> Self {
        let (radius, mass) = (shape.radius, shape.dashpot_mass);
        Self {
            motion: rows(&mover.position, &mover.velocity, radius),
            spin: row(&mover.spin, mass),
        }
    }

    /// Where it is and how it moves.
    #[inline(always)]
    pub(crate) fn mover(&self) -> Mover {
        let m = &self.motion;
        Mover {
            position: self.position(),
            velocity: Vector3::new(m[4], m[5], m[6]),
            spin: Vector3::new(self.spin[0], self.spin[1], self.spin[2]),
        }
    }

    /// Its centre, m.
    #[inline(always)]
    pub(super) fn position(&self) -> Vector3<f64> {
        Vector3::new(self.motion[0], self.motion[1], self.motion[2])
    }

    /// Its radius, m.
    #[inline(always)]
    pub(super) fn radius(&self) -> f64 {
        self.motion[3]
    }

    /// Its size and mass.
    #[inline(always)]
    pub(crate) fn shape(&self) -> OuterSphere {
        OuterSphere {
            centre: Vector3::zeros(),
            radius: self.radius(),
            dashpot_mass: self.spin[3],
        }
    }

    /// Moves it.
    #[inline(always)]
    pub(crate) fn put(
        &mut self,
        position: &Vector3<f64>,
        velocity: &Vector3<f64>,
        spin: &Vector3<f64>,
    ) {
        self.motion = rows(position, velocity, self.radius());
        self.spin = row(spin, self.spin[3]);
    }
}

/// Two vectors with a number behind each.
#[inline(always)]
fn rows(first: &Vector3<f64>, second: &Vector3<f64>, behind: f64) -> [f64; 8] {
    let (a, b) = (first, second);
    [a.x, a.y, a.z, behind, b.x, b.y, b.z, behind]
}
