//! Checks of the solver against mechanics, one row a check.
//!
//! [`run`] does the checks of the [`suite`] and gives their [`Row`]s; [`page`] writes them as the page
//! `docs/verification.md`. A row compares one number that the solver gives with one that does not
//! come from the solver, within a tolerance whose reason is stated. [`Kind`] says what the expected
//! number rests on.

mod agglomerate;
mod bond_beam;
mod chung_ooi;
mod cohesion;
mod determinism;
mod energy_ledger;
mod free_rotation;
mod impact_reference;
mod laws;
mod liquid;
mod maw;
mod page;
mod restitution;
mod rolling;
mod row;
mod size_ratio;
mod spinning_wall;
mod suite;
mod walls;
mod whole_seed;
pub mod worlds;

pub use page::page;
pub use row::{Kind, Row, Tolerance};
pub use suite::{Check, run, suite};

/// Why a check could not be done at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A world could not be built or stopped.
    #[error("check '{check}': {source}")]
    Solver {
        /// Name of the check.
        check: &'static str,
        /// Why.
        source: CheckError,
    },
    /// No check has the name.
    #[error("unknown check '{name}'; expected one of {known}")]
    NoSuchCheck {
        /// The name given.
        name: String,
        /// The names that exist.
        known: String,
    },
}

/// Errors inside a check.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The solver.
    #[error(transparent)]
    Solver(#[from] dem_solver::Error),
    /// A material or contact parameter.
    #[error(transparent)]
    Contact(#[from] contact_law::Error),
    /// A body.
    #[error(transparent)]
    Body(#[from] geometry::clump::Error),
    /// Bonds.
    #[error(transparent)]
    Bond(#[from] dem_solver::bonds::Error),
    /// An event that the check waits for did not come.
    #[error("{0} did not happen")]
    NoEvent(&'static str),
}
