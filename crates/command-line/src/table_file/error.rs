//! Errors of a table file.

use std::path::PathBuf;

/// A table that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The text is not a table.
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        source: experiment_design::Error,
    },
    /// The workbook cannot be read or written.
    #[error("{}: {what}", path.display())]
    Workbook {
        /// The file.
        path: PathBuf,
        /// The reason and the remedy.
        what: String,
    },
}
