//! Periodic sides: two planes normal to the z axis, through which bodies pass and come in at the other side.
//!
//! The state of a body is not changed when it passes: its z coordinate continues beyond the sides, so that no bit of a run depends on
//! when lists are made. Two bodies meet in the image in which they are nearest, and walls see a body between the sides.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::contact::Mover;
use crate::error::Error;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;
use nalgebra::Vector3;

/// The period along z; of a world without periodic sides by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Period {
    /// Lower side, m.
    low: f64,
    /// Distance of the sides, m; 0 without them.
    length: f64,
    /// Its reciprocal, 1/m; 0 without sides.
    inverse: f64,
}

impl Period {
    /// Of sides at two places (m), for bodies that meet in one image at a time if the sides are `least` apart (m).
    pub(crate) fn between(low: f64, high: f64, least: f64) -> Result<Self, Error> {
        let length = high - low;
        if !(length.is_finite() && length >= least) {
            return Err(Error::PeriodicSides { length, least });
        }
        let inverse = length.recip();
        Ok(Self {
            low,
            length,
            inverse,
        })
    }

    /// Whether there are sides.
    #[inline(always)]
    pub(crate) fn is_some(&self) -> bool {
        self.length > 0.0
    }

    /// The way from one centre to the nearest image of another (m), from the way between the two.
    #[inline(always)]
    pub(crate) fn nearest(&self, mut between: Vector3<f64>) -> Vector3<f64> {
        if self.is_some() {
            between.z -= self.length * (between.z * self.inverse).round_ties_even();
        }
        between
    }

    /// The same of the z components of eight ways, m.
    #[inline(always)]
    pub(crate) fn nearest_of_eight<S: Simd>(&self, z: f64x8<S>) -> f64x8<S> {
        if self.is_some() {
            z - (z * self.inverse).round_ties_even() * self.length
        } else {
            z
        }
    }

    /// The image of a point between the sides, m.
    #[inline(always)]
    pub(crate) fn inside(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let mut inside = *point;
        if self.is_some() {
            inside.z -= self.length * ((point.z - self.low) * self.inverse).floor();
        }
        inside
    }

    /// How a body moves, as walls see it: between the sides.
    #[inline(always)]
    pub(crate) fn at_walls(&self, mover: Mover) -> Mover {
        Mover {
            position: self.inside(&mover.position),
            ..mover
        }
    }

    /// The images of a point between the sides that may come between them before it has moved by `reach` (m): itself, and its
    /// image beyond the other side where it is near one.
    pub(crate) fn images(
        &self,
        inside: Vector3<f64>,
        reach: f64,
    ) -> impl Iterator<Item = Vector3<f64>> {
        let above_low = inside.z - self.low;
        let is_near = |way: f64| self.is_some() && way <= reach;
        let up = is_near(above_low).then_some(self.length);
        let down = is_near(self.length - above_low).then_some(-self.length);
        let shifts = std::iter::once(0.0).chain(up).chain(down);
        shifts.map(move |shift| inside + Vector3::z() * shift)
    }
}
