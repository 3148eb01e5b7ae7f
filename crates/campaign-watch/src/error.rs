//! Why nothing is served.

use std::path::PathBuf;

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no such folder.
    #[error("{} is no folder: give the result folder of a campaign, its --out", path.display())]
    NoFolder {
        /// What was given.
        path: PathBuf,
    },
    /// A folder without runs and without progress.
    #[error(
        "{} is no folder of a campaign, it has neither runs/ nor progress/: {way_out}",
        path.display()
    )]
    NoCampaign {
        /// The folder.
        path: PathBuf,
        /// What to give in its place.
        way_out: String,
    },
    /// The port cannot be had.
    #[error("cannot listen on 127.0.0.1:{port}: give another --port, or none for a free one")]
    Port {
        /// The port.
        port: u16,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The system gives no random bytes.
    #[error("this system gives no random bytes for the address: {reason}")]
    Randomness {
        /// The system's reason.
        reason: String,
    },
}
