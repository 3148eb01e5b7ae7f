//! Factors, coded and natural variables, and designs of experiments.
//!
//! A [`Factor`] maps its natural range low..high onto the coded range -1..+1. A [`Design`] is a
//! list of runs in coded variables: Plackett-Burman for screening, Box-Behnken and central
//! composite for a response surface, definitive screening between the two, factorials and their
//! fractions, the Latin hypercube, and designs that are optimal for a model within a [`Region`]. [`table`] writes and reads them as CSV text; this crate touches no files.
//!
//! ```
//! use experiment_design::{Factor, box_behnken};
//! let factors = [
//!     Factor::new("B", "static friction seed-resin", "1", 0.30, 0.42)?,
//!     Factor::new("E", "restitution seed-seed", "1", 0.01, 0.18)?,
//!     Factor::new("F", "static friction seed-seed", "1", 0.0, 0.10)?,
//! ];
//! let design = box_behnken(&factors, 5)?;
//! assert_eq!(design.runs().len(), 17);
//! assert_eq!(design.natural(0), vec![0.30, 0.01, 0.05]);
//! # Ok::<(), experiment_design::Error>(())
//! ```
//!
//! Invariants: every range is finite and not empty; symbols are unique; every run has one coded
//! value per column; the same arguments (and seed) give the same design.

mod box_behnken;
mod central_composite;
mod conference;
mod definitive_screening;
mod design;
mod error;
mod factor;
mod fraction_generators;
mod fractional_factorial;
mod full_factorial;
mod hadamard;
mod latin_hypercube;
mod optimal;
mod plackett_burman;
mod region;
mod second_stage;
pub mod table;

pub use box_behnken::{box_behnken, box_behnken_in_blocks};
pub use central_composite::{AxialDistance, central_composite, central_composite_in_blocks};
pub use definitive_screening::definitive_screening;
pub use design::{Design, DesignKind, Run};
pub use error::Error;
pub use factor::{Factor, check_factors};
pub use fraction_generators::{fraction_with_generators, in_blocks};
pub use fractional_factorial::{Fraction, fraction_of_resolution, fractional_factorial};
pub use full_factorial::{full_factorial, mixed_factorial};
pub use latin_hypercube::latin_hypercube;
pub use optimal::{Criterion, optimal_design, optimal_rows};
pub use plackett_burman::{plackett_burman, plackett_burman_with_runs};
pub use region::{Constraint, Coordinate, Region};
pub use second_stage::augmented_near;
