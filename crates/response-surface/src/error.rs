//! Errors of a model, the data or a question to the fit.

use thiserror::Error;

/// An invalid input, or a question the data cannot answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A factor or a table of a design is wrong.
    #[error(transparent)]
    Design(#[from] experiment_design::Error),
    /// A part of a model formula cannot be read.
    #[error(
        "'{part}' in the model formula cannot be read; terms are 1, B, B:E or B^2 with the factors {symbols} and \
         powers up to {most_power}, joined by '+' or crossed as in B*E and (B + E)^2"
    )]
    BadTerm {
        /// The part as given.
        part: String,
        /// The known symbols, comma separated.
        symbols: String,
        /// Greatest power of a factor.
        most_power: u8,
    },
    /// A term is given twice.
    #[error("the term '{term}' is given twice in the model formula; give it once")]
    DuplicateTerm {
        /// Name of the term.
        term: String,
    },
    /// A formula has too many terms.
    #[error("the model formula '{formula}' has more than {most} terms; cross fewer factors")]
    TooManyTerms {
        /// The formula as given.
        formula: String,
        /// Most terms that it may have.
        most: usize,
    },
    /// A model without intercept is asked for where it makes no sense.
    #[error("{what}; leave the 0 out of the formula")]
    NoIntercept {
        /// The fault.
        what: &'static str,
    },
    /// The brackets of a formula are nested too deeply.
    #[error(
        "the model formula has more than {most} brackets within each other; write it with fewer"
    )]
    DeepFormula {
        /// Deepest brackets that are read.
        most: usize,
    },
    /// A formula is too long.
    #[error("the model formula has {bytes} bytes; at most {most} are read")]
    LongFormula {
        /// Its bytes.
        bytes: usize,
        /// Most bytes.
        most: usize,
    },
    /// The model has terms only for other factors than the given ones.
    #[error("the model is for the factors {model}, but the factors given are {given}")]
    FactorMismatch {
        /// Symbols of the model, comma separated.
        model: String,
        /// Symbols of the factors given, comma separated.
        given: String,
    },
    /// The powers of a factor in its unit overflow.
    #[error(
        "the factor '{symbol}' runs from {low:e} to {high:e}: its power {power} in the model is beyond the numbers \
         that can be squared; give it in another unit"
    )]
    FactorScale {
        /// Symbol of the factor.
        symbol: String,
        /// Low end of its range.
        low: f64,
        /// High end of its range.
        high: f64,
        /// Its greatest power in the model.
        power: u8,
    },
    /// There are fewer observations than terms.
    #[error("{observations} observations cannot estimate {terms} terms; drop terms or add runs")]
    TooFewObservations {
        /// Number of observations (rows).
        observations: usize,
        /// Number of terms with the intercept and blocks.
        terms: usize,
    },
    /// Some terms are combinations of others over these runs.
    #[error(
        "the runs cannot separate these terms: {}; drop them from the model or add runs",
        relations.join("; ")
    )]
    AliasedTerms {
        /// Names of the aliased terms.
        terms: Vec<String>,
        /// The relation of each to the terms before it, such as `E2 = 1 - B2`.
        relations: Vec<String>,
    },
    /// An observation has a value that is not finite, or a wrong number of coded values.
    #[error("observation {row}: {what} is {value}; {way_out}")]
    BadObservation {
        /// Number of the observation, from 1.
        row: usize,
        /// Which value.
        what: &'static str,
        /// The value.
        value: f64,
        /// What it should be.
        way_out: &'static str,
    },
    /// Two lists that belong together differ in length.
    #[error("{what}: {expected} are needed, {given} are given")]
    Length {
        /// What is counted.
        what: &'static str,
        /// The number needed.
        expected: usize,
        /// The number given.
        given: usize,
    },
    /// A method needs a two-level design with orthogonal columns and as many runs as terms.
    #[error(
        "the saturated analysis needs a two-level design whose {columns} columns are orthogonal \
         and use all but one of its {runs} runs; fit a linear model instead"
    )]
    NotSaturated {
        /// Number of runs.
        runs: usize,
        /// Number of columns.
        columns: usize,
    },
    /// Solutions are found for polynomials of degree two at most.
    #[error(
        "solutions need a model of degree two at most, this one has degree {degree}; fit a \
         quadratic or reduced model"
    )]
    DegreeTooHigh {
        /// Degree of the model.
        degree: usize,
    },
    /// The bounds of a goal do not ascend.
    #[error(
        "the bounds of a goal must ascend, LOW below HIGH and a value between them, and these do not: {}",
        bounds.iter().map(ToString::to_string).collect::<Vec<_>>().join(":")
    )]
    GoalOrder {
        /// The bounds as given.
        bounds: Vec<f64>,
    },
    /// A setting of a request is out of its range.
    #[error("{what} is {value}; it must be {range}")]
    SettingOutOfRange {
        /// Which setting.
        what: &'static str,
        /// The value given.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The error variance asked for is undefined for these data.
    #[error("the {source_of_error} error has no degrees of freedom here; {way_out}")]
    NoErrorVariance {
        /// Which error.
        source_of_error: &'static str,
        /// What to do instead.
        way_out: &'static str,
    },
}
