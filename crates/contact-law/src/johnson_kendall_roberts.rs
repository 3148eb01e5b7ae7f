//! Dry adhesion of elastic spheres by Johnson, Kendall and Roberts (JKR).
//!
//! # Formula
//!
//! With the radius of contact a, reduced radius R*, effective modulus E*, work of adhesion W:
//!
//! ```text
//! F = 4 E* a^3 / (3 R*) - sqrt(8 pi W E* a^3)
//! d = a^2 / R* - sqrt(2 pi W a / E*)
//! ```
//!
//! The pull-off force is `3/2 pi W R*`, reached at `a^3 = 9 pi W R*^2 / (8 E*)`; the contact breaks
//! when the overlap d falls below `-(3/4) (pi^2 W^2 R* / E*^2)^(1/3)`. A contact forms at d = 0 and
//! lives on until then: the law has a memory of one bit.
//!
//! # Source
//!
//! `[JohnsonKendallRoberts1971]`. The study excludes adhesion, since its seeds are
//! coated; the law is an effect that a model may lack.

use crate::{Error, in_range};
use std::f64::consts::PI;

/// The law for one pair of surfaces and one reduced radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JohnsonKendallRoberts {
    /// E*, Pa.
    young: f64,
    /// Work of adhesion W, J/m².
    work: f64,
}

impl JohnsonKendallRoberts {
    /// Checks the parameters: effective Young's modulus (Pa) and work of adhesion (J/m²).
    ///
    /// # Errors
    ///
    /// A modulus that is not positive, a work outside 0 to 1000 J/m².
    pub fn new(young: f64, work_of_adhesion: f64) -> Result<Self, Error> {
        Ok(Self {
            young: in_range(
                "effective Young's modulus in Pa",
                young,
                0.01,
                1e14,
                "0.01 Pa to 1e14 Pa",
            )?,
            work: in_range(
                "work of adhesion in J/m²",
                work_of_adhesion,
                0.0,
                1e3,
                "0 J/m² to 1000 J/m²",
            )?,
        })
    }

    /// Largest pull that the contact carries, `3/2 pi W R*`, N.
    pub fn pull_off_force(&self, reduced_radius: f64) -> f64 {
        1.5 * PI * self.work * reduced_radius
    }

    /// Overlap (negative) at which a contact breaks when it is pulled apart, m.
    pub fn breaking_overlap(&self, reduced_radius: f64) -> f64 {
        let cube = (PI * self.work / self.young).powi(2) * reduced_radius;
        -0.75 * cube.cbrt()
    }

    /// Normal force at an overlap (m), positive when it pushes, N; 0 where there is no contact.
    ///
    /// `touched` tells whether the spheres were in contact in the step before.
    pub fn force(&self, overlap: f64, reduced_radius: f64, touched: bool) -> f64 {
        let end = if touched {
            self.breaking_overlap(reduced_radius)
        } else {
            0.0
        };
        if overlap < end {
            return 0.0;
        }
        let a = self.contact_radius(overlap, reduced_radius);
        let cube = a.powi(3);
        4.0 * self.young * cube / (3.0 * reduced_radius)
            - (8.0 * PI * self.work * self.young * cube).sqrt()
    }

    /// Radius of the contact at an overlap (m) on the stable branch, m.
    ///
    /// Newton's method from above; d(a) rises there without a turning point, so that each step
    /// stays above the root. At most 60 steps.
    fn contact_radius(&self, overlap: f64, reduced_radius: f64) -> f64 {
        let pull = 2.0 * PI * self.work / self.young;
        // Above the root: the two terms of a²/R* = d + sqrt(pull a) taken at their larger share.
        let mut a = (2.0 * overlap.max(0.0) * reduced_radius).sqrt()
            + 2.0 * (pull * reduced_radius * reduced_radius).cbrt();
        for _ in 0..60 {
            let error = a * a / reduced_radius - (pull * a).sqrt() - overlap;
            let slope = 2.0 * a / reduced_radius - 0.5 * (pull / a).sqrt();
            let step = error / slope;
            if !step.is_finite() || step <= 1e-15 * a {
                break;
            }
            a -= step;
        }
        a
    }
}

#[cfg(test)]
mod tests {
    use super::JohnsonKendallRoberts;
    use std::f64::consts::PI;

    const RADIUS: f64 = 1e-3;

    fn law() -> JohnsonKendallRoberts {
        JohnsonKendallRoberts::new(4e6, 0.05).unwrap()
    }

    /// The deepest pull over all overlaps is `3/2 pi W R*`; 2000 places resolve the flat minimum to
    /// 1e-6.
    #[test]
    fn deepest_pull_is_the_pull_off_force() {
        let (law, end) = (law(), law().breaking_overlap(RADIUS));
        let deepest = (0..2000)
            .map(|k| law.force(end * (1.0 - f64::from(k) / 1000.0), RADIUS, true))
            .fold(f64::INFINITY, f64::min);
        let expected = -1.5 * PI * 0.05 * RADIUS;
        assert!((deepest / expected - 1.0).abs() < 1e-5, "{deepest}");
    }

    /// At zero overlap the force is `-4/3 pi W R*`, a closed form of the two equations.
    #[test]
    fn force_at_first_touch_is_eight_ninths_of_the_pull_off() {
        let expected = -4.0 / 3.0 * PI * 0.05 * RADIUS;
        let got = law().force(0.0, RADIUS, false);
        assert!((got / expected - 1.0).abs() < 1e-12, "{got}");
    }

    /// Without adhesion the law is Hertz's.
    #[test]
    fn without_adhesion_the_law_is_that_of_hertz() {
        let law = JohnsonKendallRoberts::new(4e6, 0.0).unwrap();
        let overlap: f64 = 1e-5;
        let hertz = 4.0 / 3.0 * 4e6 * (RADIUS * overlap).sqrt() * overlap;
        let got = law.force(overlap, RADIUS, true);
        assert!((got / hertz - 1.0).abs() < 1e-12, "{got} against {hertz}");
    }

    /// Spheres that come near do not feel the pull before they touch; those that part do.
    #[test]
    fn contact_forms_at_touch_and_breaks_later() {
        let half = 0.5 * law().breaking_overlap(RADIUS);
        assert_eq!(law().force(half, RADIUS, false), 0.0);
        assert!(law().force(half, RADIUS, true) < 0.0, "still pulls");
        assert_eq!(law().force(2.1 * half, RADIUS, true), 0.0);
    }
}
