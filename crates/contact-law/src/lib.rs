//! Contact laws as pure functions with explicit history.
//!
//! One law, one file. In the force loop of the solver: [`hertz_mindlin`] (elastic and damping forces,
//! sliding friction) with [`viscoelastic_damping`] and [`rate_dependent_friction`],
//! [`rolling_constant_torque`] and [`rolling_spring_dashpot`] (rolling resistance, types A and C) with the arm of
//! [`rolling_lever`],
//! [`constant_attraction`] and [`linear_cohesion`] (cohesion), [`capillary_bridge`] and [`viscous_bridge`] (liquid bridges). With forces added to a
//! step: [`bond`] (bonded agglomerates). [`material`] holds the elastic constants of the two sides,
//! [`hard_contact`] the time step that they allow.
//! Nothing here knows bodies, lists or time stepping.
//!
//! ```
//! use contact_law::{HertzMindlin, Material, NormalForceEnd, PairParameters, material};
//! let soft = Material::new(0.25, 4e6)?;
//! let moduli = material::effective_moduli(&soft, &soft);
//! let parameters = PairParameters {
//!     restitution: 0.5,
//!     static_friction: 0.3,
//!     rolling_friction: 0.0,
//! };
//! let law = HertzMindlin::new(moduli, &parameters, NormalForceEnd::Clipped)?;
//! // Hertz: the stiffness grows with the root of the overlap.
//! let [thin, thick] = [1e-6, 4e-6].map(|overlap| law.normal_stiffness(overlap, 1e-3));
//! assert!((thick / thin - 2.0).abs() < 1e-12);
//! # Ok::<(), contact_law::Error>(())
//! ```

pub mod bond;
pub mod capillary_bridge;
pub mod constant_attraction;
pub mod hard_contact;
pub mod hertz_mindlin;
pub mod linear_cohesion;
pub mod material;
pub mod rate_dependent_friction;
pub mod rolling_constant_torque;
pub mod rolling_lever;
pub mod rolling_spring_dashpot;
pub mod viscoelastic_damping;
pub mod viscous_bridge;

pub use capillary_bridge::{BridgeForce, CapillaryBridge};
pub use hertz_mindlin::{
    ContactForce, ContactGeometry, HertzMindlin, NormalForceEnd, PairParameters,
};
pub use linear_cohesion::LinearCohesion;
pub use material::{EffectiveModuli, Material};
pub use rate_dependent_friction::RateDependentFriction;
pub use rolling_lever::RollingLever;
pub use rolling_spring_dashpot::RollingSpringDashpot;
pub use viscoelastic_damping::ViscoelasticDamping;
pub use viscous_bridge::{ViscousBridge, ViscousForce};

/// Fault of a material or a contact parameter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value lies outside what it can physically be.
    #[error("{name} is {value}; it must lie in {range}")]
    OutOfRange {
        /// Name of the quantity, with its unit.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The range allowed, in words.
        range: &'static str,
    },
}

/// Refuses a value outside `low..=high`, and NaN.
fn in_range(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    range: &'static str,
) -> Result<f64, Error> {
    if value.is_finite() && value >= low && value <= high {
        Ok(value)
    } else {
        Err(Error::OutOfRange { name, value, range })
    }
}
