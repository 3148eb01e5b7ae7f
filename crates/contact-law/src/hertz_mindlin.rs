//! Hertz-Mindlin contact without partial slip, with viscous damping and sliding friction.
//!
//! # Formula
//!
//! With overlap d, reduced radius R*, reduced mass m*, radius of the contact a:
//!
//! ```text
//! a   = sqrt(R* d)
//! F_n = (4/3) E* a d + c_n v_n     c_n = 2 sqrt(5/6) b sqrt(2 E* a m*)
//! F_t = -(k_t s + c_t v_t)         c_t = 2 sqrt(5/6) b sqrt(k_t m*)     k_t = 8 G* a
//! b   = -ln e / sqrt(ln² e + pi²)
//! ```
//!
//! The limit of sliding holds twice: the slip s is shortened until the spring alone keeps to it,
//! `k_t |s| <= mu F_n`, and spring and dashpot together keep to it, `|F_t| <= mu F_n`. The slip
//! is never shortened below 0: a spring that took up what the limit cuts from the dashpot would
//! point backwards while the load of a sliding contact grows, and would push the sliding on.
//!
//! # Source
//!
//! `[CottonStudy, eqs. 2 to 5]` in their corrected form: the exponent 3/2 in eq. 2, the overlap
//! under the inner root in eq. 3, the velocity outside the root and the friction limit on
//! magnitudes in eq. 4. `[Tsuji1992]` gives the damping.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::material::EffectiveModuli;
use crate::rate_dependent_friction::RateDependentFriction;
use crate::viscoelastic_damping::ViscoelasticDamping;
use crate::{Error, in_range};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Treatment of a normal force that would pull at the end of a contact.
///
/// The choice changes the rebound: with restitution 0.06 put in, the attractive end returns
/// 0.06 and the clipped one 0.22 (measured by this file's tests).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalForceEnd {
    /// The normal force never pulls: `max(F_n, 0)` takes the place of `F_n`.
    Clipped,
    /// The dashpot may pull until the bodies part, as the damping formula assumes.
    Attractive,
}

/// The parameters of a pair of surfaces that a user states.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairParameters {
    /// Coefficient of restitution e, 0 to 1.
    pub restitution: f64,
    /// Coefficient of static (sliding) friction mu, 0 or more.
    pub static_friction: f64,
    /// Coefficient of rolling friction `mu_r`, 0 or more.
    pub rolling_friction: f64,
}

impl PairParameters {
    /// Checks the three coefficients.
    ///
    /// # Errors
    ///
    /// Restitution outside 0 to 1, a friction coefficient below 0 or above 10.
    pub fn check(&self) -> Result<(), Error> {
        in_range("restitution", self.restitution, 0.0, 1.0, "0 to 1")?;
        in_range(
            "static friction",
            self.static_friction,
            0.0,
            10.0,
            "0 to 10",
        )?;
        in_range(
            "rolling friction",
            self.rolling_friction,
            0.0,
            10.0,
            "0 to 10",
        )?;
        Ok(())
    }
}

/// The law between two materials, with everything that does not change during a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzMindlin {
    /// Effective moduli, Pa.
    moduli: EffectiveModuli,
    /// 2 sqrt(5/6) b sqrt(2 E*), Pa^(1/2).
    normal_damping: f64,
    /// 2 sqrt(5/6) b sqrt(8 G*), Pa^(1/2).
    tangential_damping: f64,
    /// Coefficient of static friction.
    static_friction: f64,
    /// Share of a pull of the dashpot that is kept: 0 for a clipped end, 1 for an attractive one.
    pull: f64,
    /// Change of the damping with the overlap.
    viscoelastic: Option<ViscoelasticDamping>,
    /// Change of the friction with the speed of sliding.
    rate: Option<RateDependentFriction>,
}

/// Size and mass of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGeometry {
    /// Overlap d, above 0, m.
    pub overlap: f64,
    /// Reduced radius R*, m.
    pub reduced_radius: f64,
    /// Reduced mass m* that enters the dashpots, kg.
    pub reduced_mass: f64,
}

/// Force of a contact on body i and the slip to remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Normal force, positive when it pushes the bodies apart, N.
    pub normal: f64,
    /// Tangential force on body i, N.
    pub tangential: Vector3<f64>,
    /// Tangential displacement s of i against j after this step, m.
    pub slip: Vector3<f64>,
}

impl HertzMindlin {
    /// Prepares the law.
    ///
    /// # Errors
    ///
    /// Parameters outside their range ([`PairParameters::check`]), moduli that are not positive.
    pub fn new(
        moduli: EffectiveModuli,
        parameters: &PairParameters,
        end: NormalForceEnd,
    ) -> Result<Self, Error> {
        parameters.check()?;
        in_range(
            "effective Young's modulus in Pa",
            moduli.young,
            0.01,
            1e14,
            "0.01 Pa to 1e14 Pa",
        )?;
        in_range(
            "effective shear modulus in Pa",
            moduli.shear,
            0.01,
            1e14,
            "0.01 Pa to 1e14 Pa",
        )?;
        let damping = damping_factor(parameters.restitution);
        Ok(Self {
            moduli,
            normal_damping: damping * (2.0 * moduli.young).sqrt(),
            tangential_damping: damping * (8.0 * moduli.shear).sqrt(),
            static_friction: parameters.static_friction,
            pull: match end {
                NormalForceEnd::Clipped => 0.0,
                NormalForceEnd::Attractive => 1.0,
            },
            viscoelastic: None,
            rate: None,
        })
    }

    /// The law in which a share of the pull of the dashpot is kept, 0 to 1, if the end would keep less.
    #[must_use]
    #[inline]
    pub fn with_pull(self, share: f64) -> Self {
        Self {
            pull: self.pull.max(share),
            ..self
        }
    }

    /// The law with a damping that depends on the overlap.
    #[must_use]
    #[inline]
    pub fn with_viscoelastic_damping(self, damping: Option<ViscoelasticDamping>) -> Self {
        Self {
            viscoelastic: damping,
            ..self
        }
    }

    /// The law with a friction that depends on the speed of sliding.
    #[must_use]
    #[inline]
    pub fn with_rate_dependent_friction(self, friction: Option<RateDependentFriction>) -> Self {
        Self {
            rate: friction,
            ..self
        }
    }

    /// Force for one step.
    ///
    /// `normal_velocity` is the speed of approach (m/s), `tangential_velocity` the velocity of
    /// i against j in the contact plane (m/s), `slip` the displacement kept from the step before
    /// and already turned into the contact plane (m), `time_step` in s.
    #[inline(always)]
    pub fn force(
        &self,
        geometry: &ContactGeometry,
        normal_velocity: f64,
        tangential_velocity: Vector3<f64>,
        slip: Vector3<f64>,
        time_step: f64,
    ) -> ContactForce {
        let contact_radius = (geometry.reduced_radius * geometry.overlap).sqrt();
        let tangential_stiffness = 8.0 * self.moduli.shear * contact_radius;
        let root = (contact_radius * geometry.reduced_mass).sqrt();
        let tangential_damping = self.tangential_damping * root;

        let elastic = 4.0 / 3.0 * self.moduli.young * contact_radius * geometry.overlap;
        let damping = match &self.viscoelastic {
            None => self.normal_damping,
            Some(change) => self.normal_damping * change.factor(geometry.overlap),
        };
        let normal = elastic + damping * root * normal_velocity;
        let normal = normal.max(self.pull * normal);

        let friction = match &self.rate {
            None => self.static_friction,
            Some(change) => self.static_friction * change.factor(tangential_velocity.norm()),
        };
        let limit = friction * normal.max(0.0);
        let stretched = slip + tangential_velocity * time_step;
        let slip = stretched * within(limit, &(stretched * tangential_stiffness));
        let dashpot = tangential_velocity * tangential_damping;
        let free = -(slip * tangential_stiffness + dashpot);
        let tangential = free * within(limit, &free);
        ContactForce {
            normal,
            tangential,
            slip,
        }
    }

    /// Tangential stiffness at an overlap, `8 G* sqrt(R* d)`, N/m.
    pub fn tangential_stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        8.0 * self.moduli.shear * (reduced_radius * overlap).sqrt()
    }

    /// Energy of the normal spring at an overlap, `8/15 E* sqrt(R*) d^(5/2)`, J.
    pub fn elastic_energy(&self, overlap: f64, reduced_radius: f64) -> f64 {
        8.0 / 15.0 * self.moduli.young * (reduced_radius * overlap).sqrt() * overlap * overlap
    }

    /// Normal stiffness at an overlap, `d F_n / d d = 2 E* sqrt(R* d)`, N/m.
    pub fn normal_stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        2.0 * self.moduli.young * (reduced_radius * overlap).sqrt()
    }
}

/// The factor, at most 1, that shortens a force to the limit (both in N).
#[inline(always)]
fn within(limit: f64, force: &Vector3<f64>) -> f64 {
    let square = force.norm_squared();
    if square > limit * limit {
        limit / square.sqrt()
    } else {
        1.0
    }
}

/// Damping ratio `b = -ln e / sqrt(ln² e + pi²)`, from 0 (e = 1) to 1 (e = 0).
pub fn damping_ratio(restitution: f64) -> f64 {
    if restitution <= 0.0 {
        return 1.0;
    }
    let log = restitution.ln();
    -log / log.hypot(std::f64::consts::PI)
}

/// Restitution of a damping ratio, the inverse of [`damping_ratio`]: `exp(-pi b / sqrt(1 - b²))`, 0 from 1 on.
pub fn restitution(damping_ratio: f64) -> f64 {
    if damping_ratio < 1.0 {
        (-std::f64::consts::PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp()
    } else {
        0.0
    }
}

/// Dashpot of a contact over the root of stiffness times mass, `2 sqrt(5/6) b`.
pub(crate) fn damping_factor(restitution: f64) -> f64 {
    2.0 * (5.0_f64 / 6.0).sqrt() * damping_ratio(restitution)
}

#[cfg(test)]
mod tests;
