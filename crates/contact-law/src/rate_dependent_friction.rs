//! Sliding friction that changes with the speed of sliding.
//!
//! # Formula
//!
//! ```text
//! mu(v) = mu_s (1 + change v / (v + v_0))
//! ```
//!
//! with v the speed of sliding in the plane of contact, `change` the relative change at high speed
//! (negative: weakening) and `v_0` the speed of half of it. At rest the friction is the one that a slow bench test
//! gives.
//!
//! # Source
//!
//! That friction changes with the rate, and by how much: `[Marone1998]`; the bounded form is a choice made
//! here, since the logarithm of the source has no value at rest.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::{Error, in_range};

/// The change of friction with the speed of sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateDependentFriction {
    /// Relative change at high speed.
    change: f64,
    /// Speed of half of the change, m/s.
    half_speed: f64,
}

impl RateDependentFriction {
    /// Checks the parameters; `half_speed` in m/s.
    ///
    /// # Errors
    ///
    /// A change outside -0.95 to 10, a speed outside 1e-6 m/s to 100 m/s.
    pub fn new(change: f64, half_speed: f64) -> Result<Self, Error> {
        Ok(Self {
            change: in_range(
                "change of friction with speed",
                change,
                -0.95,
                10.0,
                "-0.95 to 10",
            )?,
            half_speed: in_range(
                "speed of half the change of friction in m/s",
                half_speed,
                1e-6,
                100.0,
                "1e-6 m/s to 100 m/s",
            )?,
        })
    }

    /// Factor of the coefficient of friction at a speed of sliding (m/s).
    #[inline(always)]
    pub fn factor(&self, speed: f64) -> f64 {
        1.0 + self.change * speed / (speed + self.half_speed)
    }
}
