//! Force and torque on a body.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// Force and torque about the centre of mass, side by side in one line of the cache, so that they are read, added to and
/// written together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[repr(align(64))]
pub struct Load {
    /// Force, N, a zero, torque, N m, and a zero.
    pub(crate) row: [f64; 8],
}

impl Load {
    /// A force (N) and a torque about the centre of mass (N m).
    #[inline(always)]
    pub fn new(force: &Vector3<f64>, torque: &Vector3<f64>) -> Self {
        let (f, t) = (force, torque);
        Self {
            row: [f.x, f.y, f.z, 0.0, t.x, t.y, t.z, 0.0],
        }
    }

    /// A force and a torque, each with a zero behind it.
    #[inline(always)]
    pub(crate) fn of_rows<S: Simd>(force: f64x4<S>, torque: f64x4<S>) -> Self {
        Self {
            row: force.combine(torque).into(),
        }
    }

    /// A force through the centre of mass, N.
    pub fn of_force(force: &Vector3<f64>) -> Self {
        Self::new(force, &Vector3::zeros())
    }

    /// The force, N.
    #[inline(always)]
    pub fn force(&self) -> Vector3<f64> {
        Vector3::new(self.row[0], self.row[1], self.row[2])
    }

    /// The torque about the centre of mass, N m.
    #[inline(always)]
    pub fn torque(&self) -> Vector3<f64> {
        Vector3::new(self.row[4], self.row[5], self.row[6])
    }
}

impl AddAssign for Load {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        for (sum, x) in self.row.iter_mut().zip(&other.row) {
            *sum += x;
        }
    }
}
