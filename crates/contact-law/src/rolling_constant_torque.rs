//! Rolling resistance of type A: a torque of constant size against the relative rotation.
//!
//! # Formula
//!
//! ```text
//! T_i = -mu_r F_n L w/|w|     T_j = -T_i     w = omega_i - omega_j     1/L = 1/l_i + 1/l_j
//! ```
//!
//! with w the relative angular velocity and L the reduced lever arm (a wall has l = infinity), whose l is that of
//! [`crate::rolling_lever`]. Below `SMALL_SPIN` the torque falls to 0 in proportion to |w|, so that a
//! body at rest does not tremble.
//!
//! # Source
//!
//! `[CottonStudy, eq. 6]`, `[Ai2011, type A]`. The study takes the spin of one body; the relative
//! one is used here so that a bed that turns as a whole feels nothing and angular momentum is kept.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use nalgebra::Vector3;

/// Relative spin below which the torque fades, rad/s.
///
/// A drum at 10 rpm turns its bed at 1 rad/s; twice the value changes nothing visible there,
/// a tenth of it makes resting seeds tremble at steps near 1e-4 s.
pub const SMALL_SPIN: f64 = 0.5;

/// Torque on body i, N m.
///
/// `lever_arm` is L (m), `normal_force` the normal force (N), `relative_spin` w (rad/s).
#[inline(always)]
pub fn torque(
    rolling_friction: f64,
    normal_force: f64,
    lever_arm: f64,
    relative_spin: Vector3<f64>,
) -> Vector3<f64> {
    let spin = relative_spin.norm();
    relative_spin * (-rolling_friction * normal_force * lever_arm / spin.max(SMALL_SPIN))
}

#[cfg(test)]
mod tests {
    use super::{SMALL_SPIN, torque};
    use nalgebra::Vector3;

    /// Size `mu_r F_n L`, direction against the spin; rounding only.
    #[test]
    fn torque_has_the_size_of_the_law_and_opposes_the_spin() {
        let got = torque(0.1, 2.0, 0.5, Vector3::new(0.0, 0.0, 7.0));
        assert!((got - Vector3::new(0.0, 0.0, -0.1)).norm() < 1e-15, "{got}");
    }

    #[test]
    fn torque_fades_towards_rest() {
        let full = torque(0.1, 2.0, 0.5, Vector3::new(SMALL_SPIN, 0.0, 0.0)).norm();
        let half = torque(0.1, 2.0, 0.5, Vector3::new(SMALL_SPIN / 2.0, 0.0, 0.0)).norm();
        assert!((half / full - 0.5).abs() < 1e-15, "{half} of {full}");
        assert_eq!(torque(0.1, 2.0, 0.5, Vector3::zeros()), Vector3::zeros());
    }
}
