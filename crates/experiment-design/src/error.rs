//! Errors of factors, designs and their tables.

use thiserror::Error;

/// An invalid input.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A symbol cannot serve as a column name and in a model formula.
    #[error(
        "the symbol '{symbol}' cannot be used; a symbol is a letter followed by letters, digits, \
         '_' or '.', is not one of run, cell, replicate, block, and does not end in _natural"
    )]
    BadSymbol {
        /// The symbol as given.
        symbol: String,
    },
    /// Two factors share a symbol.
    #[error("the symbol '{symbol}' is used twice; give each factor its own symbol")]
    DuplicateSymbol {
        /// The repeated symbol.
        symbol: String,
    },
    /// A bound of a factor is NaN or infinite.
    #[error("the {bound} bound of factor '{symbol}' is {value}; it must be a finite number")]
    BoundNotFinite {
        /// Symbol of the factor.
        symbol: String,
        /// `low` or `high`.
        bound: &'static str,
        /// The value, unit of the factor.
        value: f64,
    },
    /// The range of a factor is empty.
    #[error("factor '{symbol}' runs from {low} to {high} {unit}; low must be less than high")]
    EmptyRange {
        /// Symbol of the factor.
        symbol: String,
        /// Lower bound, `unit`.
        low: f64,
        /// Upper bound, `unit`.
        high: f64,
        /// Unit of the factor.
        unit: String,
    },
    /// No factor was given.
    #[error("no factor is given; a design needs at least one")]
    NoFactors,
    /// The design does not exist for this number of factors.
    #[error("a {design} design takes {least} to {most} factors, {given} are given; {way_out}")]
    FactorCount {
        /// Kind of the design.
        design: &'static str,
        /// Number of factors given.
        given: usize,
        /// Least number of factors.
        least: usize,
        /// Greatest number of factors.
        most: usize,
        /// Remedy.
        way_out: &'static str,
    },
    /// The design does not exist with this number of runs.
    #[error("a {design} design of {given} runs is not available; {way_out}")]
    RunCount {
        /// Kind of the design.
        design: &'static str,
        /// Requested number of runs.
        given: usize,
        /// Remedy.
        way_out: &'static str,
    },
    /// The axial distance of a central composite design is invalid.
    #[error("the axial distance is {value}; it must lie above 0 and be 100 half-ranges at most")]
    BadAxialDistance {
        /// The distance given, coded.
        value: f64,
    },
    /// A generator of a fraction or of blocks cannot be used.
    #[error("the generator '{generator}' cannot be used: {reason}")]
    BadGenerator {
        /// The generator as given.
        generator: String,
        /// The fault and the remedy.
        reason: &'static str,
    },
    /// No run can keep all constraints.
    #[error(
        "no point within the ranges and levels was found that keeps all constraints; widen the ranges, or remove a \
         constraint"
    )]
    NoRoom,
    /// Centre runs cannot be divided among blocks.
    #[error(
        "{given} centre runs cannot be divided equally among {blocks} blocks; take a multiple of {blocks}, such as {}",
        given.div_ceil(*blocks).max(1) * blocks
    )]
    UnequalCentres {
        /// Requested number of centre runs.
        given: usize,
        /// Number of blocks.
        blocks: usize,
    },
    /// No candidate of a second stage lies near the contour.
    #[error(
        "no point of the grid of {levels} levels lies near the contour; widen the ranges, or choose another target"
    )]
    NoneNear {
        /// Levels of each factor.
        levels: usize,
    },
    /// No fraction of a factorial has the requested resolution.
    #[error(
        "no fraction of the factorial of {factors} factors has resolution {resolution}: its half has {factors}, and 3 is the \
         least that keeps main effects apart; ask for 3 to {factors}, or take the full factorial"
    )]
    NoFraction {
        /// Number of factors.
        factors: usize,
        /// Requested resolution.
        resolution: usize,
    },
    /// A count is out of its range.
    #[error("the number of {what} is {given}; it must lie in {least} to {most}")]
    CountOutOfRange {
        /// Name of the counted items.
        what: &'static str,
        /// The requested number.
        given: usize,
        /// Least number.
        least: usize,
        /// Greatest number.
        most: usize,
    },
    /// A run has another number of values than the design has columns, or a value is not finite.
    #[error("run {run} must have {columns} finite coded values, one per column, but it does not")]
    BadRun {
        /// Number of the run, from 1.
        run: usize,
        /// Number of columns of the design.
        columns: usize,
    },
    /// A file of bytes that are not text was given as a table.
    #[error("this file is not text; give CSV text or an Excel workbook (.xlsx)")]
    NotText,
    /// The table has no header or no rows.
    #[error("the table has no {what}; it needs a header line and at least one row")]
    EmptyTable {
        /// `header` or `rows`.
        what: &'static str,
    },
    /// The text has too many lines, or a line too many fields.
    #[error(
        "the table has {given} {what}; at most {most} are read, as many as a sheet of a workbook has"
    )]
    TooLarge {
        /// `lines` or `columns`.
        what: &'static str,
        /// Number counted; reading stops soon after the limit.
        given: usize,
        /// Largest number that is read.
        most: usize,
    },
    /// A row of totals or means among the runs.
    #[error(
        "{place}: '{text}' in a column of numbers; delete the row if it holds totals or means, or begin it with #"
    )]
    SummaryRow {
        /// Place of the word, as text.
        place: String,
        /// The word.
        text: String,
    },
    /// A row has another number of fields than the header.
    #[error("line {line} has {given} fields, the header has {expected}")]
    FieldCount {
        /// Line number, from 1.
        line: usize,
        /// Fields in the header.
        expected: usize,
        /// Fields in the line.
        given: usize,
    },
    /// A quoted field is not closed.
    #[error("the quoted field that starts in line {line} is never closed by a quote")]
    OpenQuote {
        /// Line number, from 1.
        line: usize,
    },
    /// A column is missing.
    #[error("there is no column '{column}'; the columns are: {available}")]
    MissingColumn {
        /// Requested name.
        column: String,
        /// Names in the header, comma separated.
        available: String,
    },
    /// A column name fits several columns or appears twice.
    #[error("the column name '{column}' fits several columns: {candidates}; name one in full")]
    AmbiguousColumn {
        /// Requested name.
        column: String,
        /// The columns that fit, comma separated.
        candidates: String,
    },
    /// Two columns have the same name.
    #[error("{count} columns are named '{column}'; give each column its own name")]
    DuplicateColumn {
        /// The name.
        column: String,
        /// Number of times it is in the header.
        count: usize,
    },
    /// A field is not a finite number.
    #[error("{place}: '{text}' is not a finite number; correct it, or leave the row out")]
    BadNumber {
        /// Its place, as text.
        place: String,
        /// The field as read.
        text: String,
    },
    /// Coded and natural values of a factor do not agree.
    #[error(
        "{place}: the coded and the natural value of '{symbol}' do not agree with its range; \
         the natural value should be {expected}, it is {given}"
    )]
    CodingMismatch {
        /// Place of the row, as text.
        place: String,
        /// Symbol of the factor.
        symbol: String,
        /// Natural value that belongs to the coded one, unit of the factor.
        expected: f64,
        /// Natural value read, unit of the factor.
        given: f64,
    },
}
