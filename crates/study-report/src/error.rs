//! Errors while a report is written.

use std::path::PathBuf;

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder cannot be written.
    #[error("cannot write {path}: {source}; give another folder or free this one")]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A seed has no body.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A chart or the page cannot be made.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// A picture cannot be drawn or read.
    #[error("picture '{name}': {reason}")]
    Picture {
        /// Name of the picture.
        name: String,
        /// Why.
        reason: String,
    },
}
