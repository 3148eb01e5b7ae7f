//! Physics of the solver: what the world does against what mechanics says.
//!
//! One topic a file; [`scene`] builds the worlds.

mod bridge;
mod cohesion;
mod drum;
mod energy;
mod free_rotation;
mod grazing;
mod health;
mod incline;
mod momentum;
mod oracle;
mod rebound;
mod refusal;
mod reproducibility;
mod rolling;
mod scene;
