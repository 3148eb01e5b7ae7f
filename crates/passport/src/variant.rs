//! How another code may read the same parameters.

use crate::model::{Contact, Model};
use contact_law::{NormalForceEnd, RollingLever};
use dem_solver::DashpotMass;
use scene::RollingLaw;

/// Memory of the tangential spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum History {
    /// A displacement: the force follows the stiffness of the moment, `F_t = k_t(d) s`.
    Displacement,
    /// A force: `F_t` grows by `k_t(d) ds`, and unloading leaves it as it is.
    Force,
    /// A displacement that shrinks with the radius of the contact on unloading.
    Rescaled,
    /// None: the dashpot alone.
    Off,
}

/// What the limit of sliding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SlidingLimit {
    /// The spring, and then the sum of spring and dashpot.
    SpringThenSum,
    /// The spring; the dashpot acts only while the spring is below its limit, and may exceed it.
    Spring,
    /// The sum; the spring continues to stretch.
    Sum,
    /// The sum; the spring takes up what the limit cuts from the dashpot, and may point backwards.
    SumMovesSpring,
}

/// A reading of the parameters: factors of 1 and the model's own conventions are the reading of this solver.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variant {
    /// Conventions and values, some of them changed.
    pub(crate) model: Model,
    /// Factor of the rolling torque: between grains, at the wall.
    pub(crate) rolling: [f64; 2],
    /// Factor of the normal and tangential dashpots: between grains, at the wall.
    pub(crate) damping: [f64; 2],
    /// Factor of both moduli: between grains, at the wall.
    pub(crate) stiffness: [f64; 2],
    /// Factor of the tangential stiffness; the tangential dashpot follows it.
    pub(crate) tangential_stiffness: f64,
    /// Factor of the tangential dashpot.
    pub(crate) tangential_damping: f64,
    /// Whether rolling resistance takes the elastic part of the normal force alone.
    pub(crate) rolling_by_spring: bool,
    /// Whether rolling resistance acts against the rolling alone, not against a spin about the normal.
    pub(crate) rolling_without_twist: bool,
    /// Memory of the tangential spring.
    pub(crate) history: History,
    /// What the limit of sliding holds.
    pub(crate) limit: SlidingLimit,
    /// Whether the limit takes the size of the normal force, also while this pulls.
    pub(crate) limit_by_size: bool,
}

impl Variant {
    /// The reading of this solver.
    pub(crate) fn nominal(model: &Model) -> Self {
        Self {
            model: model.clone(),
            rolling: [1.0; 2],
            damping: [1.0; 2],
            stiffness: [1.0; 2],
            tangential_stiffness: 1.0,
            tangential_damping: 1.0,
            rolling_by_spring: false,
            rolling_without_twist: false,
            history: History::Displacement,
            limit: SlidingLimit::SpringThenSum,
            limit_by_size: false,
        }
    }

    /// Multiplies the static friction of one of the two contacts.
    pub(crate) fn scale_friction(&mut self, contact: usize, factor: f64) {
        self.model.contacts[contact].static_friction *= factor;
    }

    /// Multiplies the attraction of both contacts.
    pub(crate) fn scale_attraction(&mut self, factor: f64) {
        for Contact {
            attraction_n,
            cohesion_energy_density_j_m3,
            ..
        } in &mut self.model.contacts
        {
            *attraction_n *= factor;
            *cohesion_energy_density_j_m3 *= factor;
        }
    }

    /// Takes the other end of the normal force.
    pub(crate) fn flip_end(&mut self) {
        self.model.normal_force_end = match self.model.normal_force_end {
            NormalForceEnd::Clipped => NormalForceEnd::Attractive,
            NormalForceEnd::Attractive => NormalForceEnd::Clipped,
        };
    }

    /// Takes the other mass in the dashpots of clumps.
    pub(crate) fn flip_mass(&mut self) {
        self.model.dashpot_mass = match self.model.dashpot_mass {
            DashpotMass::Sphere => DashpotMass::Body,
            DashpotMass::Body | DashpotMass::Shared => DashpotMass::Sphere,
        };
    }

    /// Takes the other lever arm of clumps.
    pub(crate) fn flip_lever(&mut self) {
        self.model.rolling_lever = match self.model.rolling_lever {
            RollingLever::Centre => RollingLever::Sphere,
            RollingLever::Sphere => RollingLever::Centre,
        };
    }

    /// Takes the other law of rolling resistance.
    pub(crate) fn flip_law(&mut self) {
        self.model.rolling_law = match self.model.rolling_law {
            RollingLaw::ConstantTorque => RollingLaw::SpringDashpot,
            RollingLaw::SpringDashpot => RollingLaw::ConstantTorque,
        };
    }
}
