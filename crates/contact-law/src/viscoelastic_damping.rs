//! Damping that makes the restitution fall with the speed, as it does for viscoelastic bodies.
//!
//! # Formula
//!
//! ```text
//! c_n' = c_n (1 + share ((d/d_0)^(1/4) - 1))
//! ```
//!
//! with `c_n` the damping of [`crate::hertz_mindlin`], proportional to d^(1/4), whose restitution is the
//! same at every speed; d the overlap and `d_0` that of an elastic collision at the speed at which the
//! restitution was measured. The share runs from 0 (no change) to 1: then `c_n'` is proportional to
//! sqrt(d), the dissipation of viscoelastic spheres, and 1 - e grows as v^(1/5).
//!
//! # Source
//!
//! `[Brilliantov1996]` for share 1; the path from 0 to 1 is a choice made here.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::{Error, in_range};

/// The change of the damping with the overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscoelasticDamping {
    /// Share of the dissipation of a viscoelastic sphere.
    share: f64,
    /// 1 over the overlap at which nothing changes, 1/m.
    inverse_overlap: f64,
}

impl ViscoelasticDamping {
    /// Checks the parameters; `overlap` is `d_0`, m.
    ///
    /// # Errors
    ///
    /// A share outside 0 to 1, an overlap that is not between 1e-15 m and 1 m.
    pub fn new(share: f64, overlap: f64) -> Result<Self, Error> {
        let share = in_range("viscoelastic damping", share, 0.0, 1.0, "0 to 1")?;
        let overlap = in_range(
            "overlap of reference in m",
            overlap,
            1e-15,
            1.0,
            "1e-15 m to 1 m",
        )?;
        Ok(Self {
            share,
            inverse_overlap: 1.0 / overlap,
        })
    }

    /// Factor of the damping at an overlap (m).
    #[inline(always)]
    pub fn factor(&self, overlap: f64) -> f64 {
        let fourth_root = (overlap * self.inverse_overlap).sqrt().sqrt();
        1.0 + self.share * (fourth_root - 1.0)
    }
}
