//! What can go wrong in a study.

use std::path::PathBuf;

/// Why a study gave no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read or written.
    #[error("cannot {what} {path}: {source}")]
    File {
        /// Read or write.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The study file is not what one looks like.
    #[error("{file}: {message}")]
    Text {
        /// The file.
        file: String,
        /// Line, what is wrong and what is expected.
        message: String,
    },
    /// A name or number of the study file cannot be meant.
    #[error("{file}: {what} {problem}")]
    Meaning {
        /// The file.
        file: String,
        /// Which entry.
        what: String,
        /// What is wrong with it, and the way out.
        problem: String,
    },
    /// A scene is refused.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A stage of the calibration failed.
    #[error(transparent)]
    Calibration(#[from] calibration::Error),
    /// The runs were not all done.
    #[error(transparent)]
    Campaign(#[from] campaign::Error),
    /// An effect is refused.
    #[error(transparent)]
    Effect(#[from] effect_library::Error),
    /// A factor is refused.
    #[error(transparent)]
    Design(#[from] experiment_design::Error),
    /// The surface cannot be analysed.
    #[error(transparent)]
    Surface(#[from] response_surface::Error),
    /// The run store cannot be used.
    #[error(transparent)]
    Store(#[from] run_store::Error),
}
