//! The solver against mechanics, one row a check, and against its plain form.
//!
//! One topic a file; [`scene`] builds the worlds.

mod bridge;
mod energy;
mod grazing;
mod health;
mod momentum;
mod oracle;
mod periodic;
mod refusal;
mod reproducibility;
mod rows;
mod scene;
mod walls;
