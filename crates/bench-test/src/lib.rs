//! Tables of bench measurements of contact parameters, and their summary.
//!
//! Three tests as the study did them `[CottonStudy, section 2.2]`: a drop on a plate (restitution from
//! heights), a sled of glued seeds (static friction), a tilted plate (rolling friction as the tangent
//! of the angle at which a seed starts to roll). [`measured`] turns tables of such measurements into
//! coefficients, [`summarise`] gives their mean with its interval. The same tests, simulated, are
//! apparatus of a scene.

pub mod measured;
mod summary;

pub use summary::{Summary, summarise};

/// Why a table gives no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A column is missing.
    #[error("no column '{column}'; the columns of this test are {known}")]
    NoColumn {
        /// The column.
        column: &'static str,
        /// What the test reads.
        known: &'static str,
    },
    /// A cell holds no valid number.
    #[error("{place}: '{text}' must be {requirement}")]
    Cell {
        /// Where it stands, in words.
        place: String,
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
}
