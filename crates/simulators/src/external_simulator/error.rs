//! Errors before a run.

use std::path::PathBuf;

/// Why another code is not a simulator.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The program does not answer as it should.
    #[error("{reason}")]
    Program {
        /// What happened, and the remedy.
        reason: String,
    },
    /// A file of the template cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A setting is invalid.
    #[error("{what}: {problem}")]
    Setting {
        /// The setting, with its value.
        what: String,
        /// Its fault, and the remedy.
        problem: String,
    },
}
