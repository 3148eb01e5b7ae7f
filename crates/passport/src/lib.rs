//! Parameters with their conventions, and a self-test that finds the convention in which another code differs.
//!
//! Contact parameters belong to the conventions with which they were calibrated: one rolling coefficient gives torques that
//! differ by factors of two between codes. [`Model`] holds the parameters and conventions of a scene, [`expected()`] the numbers of
//! small cases with their bands, and [`check()`] compares the numbers of another code with them: the conventions are rival
//! effects of [`inference::diagnosis`], so that one is named only if the numbers exclude the others.

mod advice;
mod bench;
mod case;
mod check;
mod codes;
mod convention;
mod expected;
mod folder;
mod known_readings;
mod model;
mod packing;
mod reading;
mod readme;
mod reference;
mod reference_law;
mod resting;
mod results;
mod search;
mod small_cases;
mod solver;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_files;
mod variant;

pub use advice::Difference;
pub use case::{Case, Component, Quantity, Shape, Start};
pub use check::{Checked, Row, check};
pub use codes::{CODES, Code, Known, known_of};
pub use expected::{Expected, expected, of_small_cases};
pub use folder::{Calibrated, File, Grain, PASSPORT, Passport, Validity, covariance, files};
pub use model::{Contact, Model};
pub use packing::Packing;
pub use reading::read_passport;
pub use results::read_results;
pub use small_cases::cases;

/// Why a passport cannot be written or checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The model has a law that the self-test does not cover.
    #[error(
        "{file}: the self-test does not cover {law}: remove it, and calibrate again without it"
    )]
    Law {
        /// The setting.
        law: &'static str,
        /// The scene.
        file: String,
    },
    /// The wall is unknown.
    #[error("the grains have no contact with a wall '{wanted}'; the walls are: {walls}")]
    NoWall {
        /// The wall that was asked for.
        wanted: String,
        /// The walls of the scene.
        walls: String,
    },
    /// A contact is missing.
    #[error("the scene has no contact '{0}': add [contact.{0}]")]
    NoContact(String),
    /// A line of the results is wrong.
    #[error("{file}: line {line}: {what}")]
    Results {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// Fault, and the text to write instead.
        what: String,
    },
    /// Rows of the results are missing.
    #[error("{file}: missing rows: {rows}; add them with their values")]
    Missing {
        /// The file.
        file: String,
        /// Cases and quantities.
        rows: String,
    },
    /// A convention that cannot be accepted.
    #[error("'{name}' cannot be accepted; expected one of {known}")]
    Accepted {
        /// Its name.
        name: String,
        /// Those that can.
        known: String,
    },
    /// A code whose conventions are not known.
    #[error(
        "the conventions of the code '{name}' are not known beforehand; expected one of {known}, or state each convention with --accept"
    )]
    Code {
        /// Its name.
        name: String,
        /// Those that are known.
        known: String,
    },
    /// The expected numbers are those of another version.
    #[error(
        "the expected numbers are not those of this version's cases: write the passport again with this version"
    )]
    OtherVersion,
    /// A passport that cannot be written or read.
    #[error("this is not a passport of this version: {0}; write it again with `seedloop passport`")]
    Json(String),
    /// The scene.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A contact parameter.
    #[error(transparent)]
    Contact(#[from] contact_law::Error),
    /// The solver.
    #[error(transparent)]
    Solver(#[from] dem_solver::Error),
    /// A body.
    #[error(transparent)]
    Body(#[from] geometry::clump::Error),
    /// The diagnosis.
    #[error(transparent)]
    Diagnosis(#[from] inference::diagnosis::Error),
}
