//! The bench tests of contact parameters: measured ones read, and the same ones simulated.
//!
//! Three tests as the study did them `[CottonStudy, section 2.2]`: a drop on a plate (restitution from
//! heights), a sled of glued seeds (static friction), a tilted plate (rolling friction as the tangent
//! of the angle at which a seed starts to roll). [`measured`] turns tables of such measurements into
//! a coefficient with its interval; [`mod@drop`], [`slider`] and [`tilt`] do the tests with the solver, so
//! that what a whole agglomerate shows can be held against what was put into its spheres.

pub mod drop;
pub mod measured;
pub mod slider;
mod summary;
pub mod tilt;

pub use summary::{Summary, summarise};

use dem_solver::{Settings, Template, World};
use nalgebra::Vector3;
use scene::BenchParts;

/// Why a bench test gives no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A column is missing.
    #[error("{file}: no column '{column}'; the columns of this test are {known}")]
    NoColumn {
        /// The file.
        file: String,
        /// The column.
        column: &'static str,
        /// What the test reads.
        known: &'static str,
    },
    /// A cell holds no number that can be meant.
    #[error("{file}: line {line}, column '{column}': '{text}' must be {requirement}")]
    Cell {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
        /// The text.
        text: String,
        /// What it must be.
        requirement: &'static str,
    },
    /// Too few values.
    #[error("{count} values are too few for a mean with an interval; at least 2 are needed")]
    TooFew {
        /// Their number.
        count: usize,
    },
    /// A test was asked for with a setting that cannot be meant.
    #[error("{name} is {value}; it must be {requirement}")]
    Setting {
        /// Name of the setting, with its unit.
        name: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// A simulated test did not come to its end.
    #[error("repeat {repeat}: {what} within {limit} s of simulated time")]
    NoEvent {
        /// Number of the repeat, from 1.
        repeat: usize,
        /// What did not happen.
        what: &'static str,
        /// The limit, s.
        limit: f64,
    },
    /// The solver stopped.
    #[error(transparent)]
    Solver(#[from] dem_solver::Error),
    /// A body could not be made.
    #[error(transparent)]
    Body(#[from] clump::Error),
}

/// Settings of the solver for a test; gravity in m/s².
fn settings(parts: &BenchParts, gravity: Vector3<f64>) -> Settings {
    let radius = parts
        .body
        .clump
        .spheres()
        .iter()
        .map(|s| s.radius)
        .fold(f64::INFINITY, f64::min);
    Settings {
        time_step: parts.time_step,
        gravity,
        skin: 0.45 * radius,
        margin: 4.5 * radius,
    }
}

/// The seed as a body type of material 0.
fn template(parts: &BenchParts) -> Template {
    Template::new(&parts.body.clump, 0, parts.dashpot_mass)
}

/// Lowest point of body 0, m.
fn lowest(world: &World, parts: &BenchParts) -> f64 {
    let bodies = world.bodies();
    let spheres = parts.body.outer.spheres().iter();
    spheres
        .map(|s| (bodies.position[0] + bodies.orientation[0] * s.centre).y - s.radius)
        .fold(f64::INFINITY, f64::min)
}

/// Refuses a number outside a range.
fn in_range(
    name: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    requirement: &'static str,
) -> Result<(), Error> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::Setting {
        name,
        value,
        requirement,
    })
}
