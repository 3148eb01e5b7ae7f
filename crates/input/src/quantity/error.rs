//! Errors of a value, with the remedy.

use crate::quantity::unit::Kind;

/// A value that was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The text does not start with a number.
    #[error(
        "\"{text}\" is not {expected}: write a number with a decimal point and a unit, such as \
         \"{}\" (accepted units: {})", expected.example(), expected.accepted()
    )]
    NoNumber {
        /// The text as given.
        text: String,
        /// The kind of quantity that was expected.
        expected: Kind,
    },

    /// A number without a unit.
    #[error(
        "{text} has no unit, but {expected} is expected: write \"{text} {}\" or another of the \
         accepted units: {}", expected.example_unit(), expected.accepted()
    )]
    NoUnit {
        /// The number as given.
        text: String,
        /// The kind of quantity that was expected.
        expected: Kind,
    },

    /// The unit is known, but belongs to another kind of quantity.
    #[error(
        "\"{text}\" is {found}, but {expected} is expected (accepted units: {})",
        expected.accepted()
    )]
    WrongKind {
        /// The text as given.
        text: String,
        /// The kind that the unit belongs to.
        found: Kind,
        /// The kind of quantity that was expected.
        expected: Kind,
    },

    /// The unit is not known.
    #[error(
        "unknown unit \"{unit}\" in \"{text}\": accepted units for {expected} are {}",
        expected.accepted()
    )]
    UnknownUnit {
        /// The text as given.
        text: String,
        /// The unit as given.
        unit: String,
        /// The kind of quantity that was expected.
        expected: Kind,
    },

    /// The value is not a number or too large for one.
    #[error("{what} must be finite, not {value}: check the number and its exponent")]
    NotFinite {
        /// Name of the quantity.
        what: &'static str,
        /// The value as given.
        value: f64,
    },

    /// The value lies outside its possible range.
    #[error("{what} must be {limit}, not {value}: {way_out}")]
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// The value as given, with its unit if it has one.
        value: String,
        /// The accepted range in words.
        limit: &'static str,
        /// Remedy.
        way_out: &'static str,
    },
}
