//! Errors of charts and reports.

/// Why a chart or a report cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that is not finite; nothing of the kind is ever written into a picture.
    #[error(
        "{chart}: {field} {index} is {value}; every number of a chart must be finite, so leave the \
         entry out or give what was measured"
    )]
    NonFinite {
        /// Kind of chart.
        chart: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Position in the field, from 0.
        index: usize,
        /// The value, in the unit of the field.
        value: f64,
    },
    /// A list without entries where at least some are needed.
    #[error("{chart}: {field} has {count} entries; at least {least} are needed")]
    TooFew {
        /// Kind of chart or part of a report.
        chart: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Number of entries.
        count: usize,
        /// Number needed.
        least: usize,
    },
    /// Two lists that belong together and differ in length.
    #[error("{chart}: {field} has {count} entries, but {expected} are needed, one for each {each}")]
    Length {
        /// Kind of chart or part of a report.
        chart: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Number of entries.
        count: usize,
        /// Number needed.
        expected: usize,
        /// What one entry belongs to.
        each: &'static str,
    },
    /// A number outside of what it can mean.
    #[error("{chart}: {field} {index} is {value}; it must be {requirement}")]
    OutOfRange {
        /// Kind of chart.
        chart: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Position in the field, from 0.
        index: usize,
        /// The value, in the unit of the field.
        value: f64,
        /// What is needed.
        requirement: &'static str,
    },
}
