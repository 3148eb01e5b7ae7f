//! Rolling resistance of type C: an elastic-plastic spring with a dashpot.
//!
//! # Formula
//!
//! ```text
//! M_k += -k_r w_t dt             shortened so that |M_k| <= mu_r F_n R*
//! M_d  = -c_r w_t                where |M_k| is below its limit, f c_r w_t where it is at it
//! k_r  = x_r k_t R*^2            c_r = eta_r 2 sqrt(I_r k_r)
//! T_i  = M_k + M_d               T_j = -T_i
//! ```
//!
//! `w_t` is the part of the relative spin in the plane of contact (rolling; twisting about the normal
//! is left out), R* the reduced radius, `1/I_r = 1/(I_i + m_i r_i^2) + 1/(I_j + m_j r_j^2)` the
//! moments about the point of contact (a wall has none), `eta_r` the damping ratio of rolling, f the
//! part of the damping that stays at the limit (0 here, as is usual), `x_r` = 2.25 for discs in the
//! source; for spheres it is an input. Unlike type A the torque vanishes at rest, and a heap comes
//! to rest.
//!
//! # Source
//!
//! `[Ai2011, type C]`; the coefficient multiplies the reduced radius of the spheres,
//! which for two equal spheres is half of the radius. For agglomerates the solver takes the reduced
//! lever arm L of [`crate::rolling_lever`] for R*, which for spheres is the same, so that a coefficient
//! means the same in both types.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::{Error, in_range};
use nalgebra::Vector3;

/// Damping ratio of rolling if nothing else is said; the source shows 0 to 0.3 and more.
pub const DAMPING_RATIO: f64 = 0.3;

/// Stiffness over `k_t R*²` if nothing else is said; the source's value for discs.
pub const STIFFNESS_RATIO: f64 = 2.25;

/// The law for one pair of surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingSpringDashpot {
    /// Coefficient of rolling friction `mu_r`.
    coefficient: f64,
    /// Damping ratio of rolling `eta_r`.
    damping_ratio: f64,
    /// Rolling stiffness over `k_t R*²`.
    stiffness_ratio: f64,
}

/// State of a contact as the law needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingContact {
    /// Normal force, N.
    pub normal_force: f64,
    /// Reduced radius R*, m.
    pub reduced_radius: f64,
    /// Tangential stiffness of the contact, N/m.
    pub tangential_stiffness: f64,
    /// Reduced moment of inertia about the point of contact `I_r`, kg m².
    pub reduced_inertia: f64,
    /// Unit normal of the contact.
    pub normal: Vector3<f64>,
    /// Angular velocity of i less that of j, rad/s.
    pub relative_spin: Vector3<f64>,
}

/// Torque of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingTorque {
    /// Torque on body i, N m.
    pub torque: Vector3<f64>,
    /// Spring torque to remember, N m.
    pub spring: Vector3<f64>,
}

impl RollingSpringDashpot {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// A coefficient outside 0 to 10, a damping ratio outside 0 to 2, a stiffness ratio outside 0 to
    /// 100.
    pub fn new(coefficient: f64, damping_ratio: f64, stiffness_ratio: f64) -> Result<Self, Error> {
        Ok(Self {
            coefficient: in_range("rolling friction", coefficient, 0.0, 10.0, "0 to 10")?,
            damping_ratio: in_range(
                "damping ratio of rolling",
                damping_ratio,
                0.0,
                2.0,
                "0 to 2",
            )?,
            stiffness_ratio: in_range(
                "ratio of the rolling stiffness",
                stiffness_ratio,
                0.0,
                100.0,
                "0 to 100",
            )?,
        })
    }

    /// Rolling stiffness `k_r`, N m/rad.
    #[inline(always)]
    pub fn stiffness(&self, contact: &RollingContact) -> f64 {
        let radius = contact.reduced_radius;
        self.stiffness_ratio * contact.tangential_stiffness * radius * radius
    }

    /// Torque for one step of `time_step` (s); `spring` is the spring torque of the step before.
    #[inline(always)]
    pub fn torque(
        &self,
        contact: &RollingContact,
        spring: Vector3<f64>,
        time_step: f64,
    ) -> RollingTorque {
        let in_plane = |v: Vector3<f64>| v - contact.normal * v.dot(&contact.normal);
        let rolling = in_plane(contact.relative_spin);
        let stiffness = self.stiffness(contact);
        let wanted = in_plane(spring) - rolling * (stiffness * time_step);
        let limit = self.coefficient * contact.normal_force.max(0.0) * contact.reduced_radius;
        let size = wanted.norm();
        let yields = size > limit;
        let spring = wanted * if yields { limit / size } else { 1.0 };
        let damping = 2.0 * self.damping_ratio * (contact.reduced_inertia * stiffness).sqrt();
        let damping = if yields { 0.0 } else { damping };
        RollingTorque {
            torque: spring - rolling * damping,
            spring,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{RollingContact, RollingSpringDashpot};
    use nalgebra::Vector3;

    fn contact(spin: f64) -> RollingContact {
        RollingContact {
            normal_force: 2.0,
            reduced_radius: 1e-3,
            tangential_stiffness: 1e4,
            reduced_inertia: 1e-9,
            normal: Vector3::y(),
            relative_spin: Vector3::z() * spin,
        }
    }

    /// A spinning wheel on its contact is a damped oscillator once it has slowed down: the spring
    /// takes its torque to 0, and so it rests for good, unlike with type A. The wheel turns back
    /// and forth within the elastic range `mu_r F_n R* / k_r`; explicit steps of a hundredth of the
    /// period keep its decay to first order.
    #[test]
    fn a_wheel_comes_to_rest_with_a_vanishing_torque() {
        let law = RollingSpringDashpot::new(0.1, 0.3, 2.25).unwrap();
        let inertia = 1e-9;
        let stiffness = law.stiffness(&contact(0.0));
        let step = 0.01 * (inertia / stiffness).sqrt();
        let (mut spin, mut spring) = (5.0, Vector3::zeros());
        let mut last = 0.0;
        for _ in 0..20_000 {
            let got = law.torque(&contact(spin), spring, step);
            (spring, last) = (got.spring, got.torque.z);
            spin += got.torque.z / inertia * step;
        }
        let limit = 0.1 * 2.0 * 1e-3;
        assert!(spin.abs() < 1e-6, "still turns with {spin} rad/s");
        assert!(last.abs() < 1e-6 * limit, "torque {last} N m is left");
    }

    /// In steady rolling the spring yields: the torque is `mu_r F_n R*` against the spin.
    #[test]
    fn steady_rolling_feels_the_full_torque() {
        let law = RollingSpringDashpot::new(0.1, 0.3, 2.25).unwrap();
        let mut spring = Vector3::zeros();
        for _ in 0..1000 {
            spring = law.torque(&contact(3.0), spring, 1e-3).spring;
        }
        let expected = -0.1 * 2.0 * 1e-3;
        assert!((spring.z / expected - 1.0).abs() < 1e-12, "{spring}");
    }

    /// A spin about the normal is twisting, not rolling.
    #[test]
    fn twisting_feels_nothing() {
        let law = RollingSpringDashpot::new(0.1, 0.3, 2.25).unwrap();
        let twisting = RollingContact {
            relative_spin: Vector3::y() * 9.0,
            ..contact(0.0)
        };
        let got = law.torque(&twisting, Vector3::zeros(), 1e-3);
        assert_eq!(got.torque, Vector3::zeros());
        assert!(
            RollingSpringDashpot::new(-0.1, 0.3, 1.0).is_err(),
            "negative"
        );
    }
}
