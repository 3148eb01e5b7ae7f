//! An impact integrated without the solver.
//!
//! Two bodies that meet are one equation for the overlap and one for the sliding of the contact
//! point: `m* d'' = -F_n`, `m_t v_t' = F_t`. The law is written down again here from its formulas,
//! shares no code with the solver or `contact-law`, and is integrated with a step a hundred times
//! finer than the solver's. Geometry is that of small overlaps: the arm is the radius.

use std::f64::consts::PI;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Impact {
    /// Reduced radius R*, m.
    pub(crate) radius: f64,
    /// Reduced mass m*, kg.
    pub(crate) mass: f64,
    /// Mass that the contact feels across its normal, kg (2/7 m* for solid spheres).
    pub(crate) tangential_mass: f64,
    /// E*, Pa.
    pub(crate) young: f64,
    /// G*, Pa.
    pub(crate) shear: f64,
    /// Restitution put into the dashpot.
    pub(crate) restitution: f64,
    /// Static friction.
    pub(crate) friction: f64,
    /// Whether the dashpot may pull.
    pub(crate) pulls: bool,
    /// Speed of approach, m/s.
    pub(crate) approach: f64,
    /// Sliding velocity of the contact point, m/s.
    pub(crate) sliding: f64,
}

/// How it ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    /// Speed of separation, m/s.
    pub(crate) separation: f64,
    /// Sliding velocity of the contact point, m/s.
    pub(crate) sliding: f64,
    /// Integral of the tangential force, N s.
    pub(crate) impulse: f64,
}

impl Impact {
    /// Duration of the elastic contact by Hertz, s `[Hertz1881]`.
    pub(crate) fn hertz_duration(&self) -> f64 {
        let base = 15.0 * self.mass / (16.0 * self.young * self.radius.sqrt());
        2.9432 * base.powf(0.4) * self.approach.powf(-0.2)
    }

    /// Largest overlap of the elastic contact, m.
    pub(crate) fn hertz_overlap(&self) -> f64 {
        let base =
            15.0 * self.mass * self.approach.powi(2) / (16.0 * self.young * self.radius.sqrt());
        base.powf(0.4)
    }

    /// Largest force of the elastic contact, N.
    pub(crate) fn hertz_force(&self) -> f64 {
        4.0 / 3.0 * self.young * self.radius.sqrt() * self.hertz_overlap().powf(1.5)
    }

    /// Integrates the impact.
    pub(crate) fn integrate(&self) -> Outcome {
        let ratio = if self.restitution < 1.0 {
            let log = self.restitution.ln();
            -log / (log * log + PI * PI).sqrt()
        } else {
            0.0
        };
        let damping = 2.0 * (5.0_f64 / 6.0).sqrt() * ratio;
        let step = self.hertz_duration() / 400_000.0;
        let (mut overlap, mut approach) = (0.0, self.approach);
        let (mut sliding, mut spring, mut impulse) = (self.sliding, 0.0_f64, 0.0);
        overlap += approach * step;
        while overlap > 0.0 {
            let a = (self.radius * overlap).sqrt();
            let tangent = 2.0 * self.young * a;
            let across = 8.0 * self.shear * a;
            let elastic = 2.0 / 3.0 * tangent * overlap;
            let mut normal = elastic + damping * (tangent * self.mass).sqrt() * approach;
            if !self.pulls {
                normal = normal.max(0.0);
            }
            let limit = self.friction * normal.max(0.0);
            spring += sliding * step;
            if across * spring.abs() > limit {
                spring = limit.copysign(spring) / across;
            }
            let free = -across * spring - damping * (across * self.mass).sqrt() * sliding;
            let tangential = free.clamp(-limit, limit);
            approach -= normal / self.mass * step;
            sliding += tangential / self.tangential_mass * step;
            impulse += tangential * step;
            overlap += approach * step;
        }
        Outcome {
            separation: -approach,
            sliding,
            impulse,
        }
    }
}
