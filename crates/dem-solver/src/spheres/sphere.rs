//! All of a sphere that a contact needs, side by side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::contact::Mover;
use crate::template::OuterSphere;
use nalgebra::Vector3;

/// Three coordinates and a fourth number that goes along, so that they are read and written together.
pub(crate) type Row = [f64; 4];

/// All of a sphere that a contact needs, in two lines of the cache; a copy of what stands in the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(crate) struct Sphere {
    /// Centre and radius, m.
    pub(super) position: Row,
    /// Velocity, m/s, and mass in a dashpot, kg.
    pub(super) velocity: Row,
    /// Angular velocity, rad/s.
    pub(super) spin: Row,
}

impl Sphere {
    /// A sphere of this size and mass that moves so.
    pub(crate) fn new(shape: &OuterSphere, mover: &Mover) -> Self {
        Self {
            position: row(&mover.position, shape.radius),
            velocity: row(&mover.velocity, shape.dashpot_mass),
            spin: row(&mover.spin, 0.0),
        }
    }

    /// Where it is and how it moves.
    #[inline(always)]
    pub(crate) fn mover(&self) -> Mover {
        Mover {
            position: vector(&self.position),
            velocity: vector(&self.velocity),
            spin: vector(&self.spin),
        }
    }

    /// Its size and mass.
    #[inline(always)]
    pub(crate) fn shape(&self) -> OuterSphere {
        OuterSphere {
            centre: Vector3::zeros(),
            radius: self.position[3],
            dashpot_mass: self.velocity[3],
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
        self.position = row(position, self.position[3]);
        self.velocity = row(velocity, self.velocity[3]);
        self.spin = row(spin, 0.0);
    }
}

/// A vector and a number beside it.
#[inline(always)]
pub(crate) fn row(vector: &Vector3<f64>, beside: f64) -> Row {
    [vector.x, vector.y, vector.z, beside]
}

/// The vector of a row.
#[inline(always)]
pub(crate) fn vector(row: &Row) -> Vector3<f64> {
    Vector3::new(row[0], row[1], row[2])
}
