//! Errors of a problem.

/// Why a problem cannot be diagnosed at all; a residual that merely cannot be tested is a
/// verdict, not an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A list has the wrong number of entries.
    #[error("{what} has {found} entries, {expected} are needed ({reason})")]
    WrongLength {
        /// Key of the list; for a matrix with the row.
        what: String,
        /// Entries it has.
        found: usize,
        /// Entries it should have.
        expected: usize,
        /// Where that number comes from.
        reason: String,
    },
    /// Something that a problem must have is not there.
    #[error("{what} is missing: {way_out}")]
    Missing {
        /// Key of what is missing.
        what: String,
        /// What to give.
        way_out: String,
    },
    /// A number is NaN, infinite or outside its range.
    #[error("{what} is {value:?}, it must be {range}")]
    OutOfRange {
        /// Key of the number, with its place.
        what: String,
        /// The number.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A covariance block is not positive definite.
    #[error(
        "the covariance of {block} is not positive definite (pivot {pivot:.3e} of observable row {row}): two observables say the same, or a variance is 0"
    )]
    NotPositiveDefinite {
        /// Which block: the condition, or the whole.
        block: String,
        /// Row inside the block where the factorisation breaks off.
        row: usize,
        /// Remainder of its variance, relative to the variance.
        pivot: f64,
    },
    /// A covariance is not symmetric.
    #[error("{what} is not symmetric: entry ({row}, {column}) differs from its mirror entry")]
    NotSymmetric {
        /// Key of the matrix.
        what: String,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
    },
    /// Two things bear one name, or a name is not known.
    #[error("'{name}' in {place} {problem}")]
    BadName {
        /// The name.
        name: String,
        /// Key where it stands.
        place: &'static str,
        /// Its fault.
        problem: &'static str,
    },
}
