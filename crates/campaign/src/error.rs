//! Errors of a campaign.

use crate::{RunRequest, SimulatorError};

/// Reason for missing records of a campaign.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Invalid requests, of which this is the first. Nothing was run.
    #[error(
        "run '{request}' is refused ({n_refused} of {n_requests} requests in total); nothing was run"
    )]
    Refused {
        /// The first request that is refused.
        request: Box<RunRequest>,
        /// Reason for the refusal.
        source: SimulatorError,
        /// Number of requests that are refused.
        n_refused: usize,
        /// Number of requests.
        n_requests: usize,
    },
    /// Runs failed; this is the first in the order of the requests. All others were done and
    /// stored, so another call repeats only the failed runs.
    #[error("run '{request}' failed ({n_failed} of {n_runs} runs in total)")]
    Run {
        /// The first request that failed.
        request: Box<RunRequest>,
        /// Reason for the failure.
        source: SimulatorError,
        /// Number of runs that failed.
        n_failed: usize,
        /// Number of different runs in the campaign.
        n_runs: usize,
    },
    /// The stop flag was raised; what was finished is stored.
    #[error("stopped after {n_done} of {n_runs} runs; finished runs are stored and will be reused")]
    Stopped {
        /// Number of runs that have a record.
        n_done: usize,
        /// Number of different runs in the campaign.
        n_runs: usize,
    },
    /// A store that cannot be read or written.
    #[error("the record of run '{request}' cannot be stored or found")]
    Store {
        /// The request.
        request: Box<RunRequest>,
        /// The store's reason.
        source: crate::run_store::Error,
    },
    /// The limit of [`crate::Campaign::with_wait`] was reached.
    #[error(
        "waited for {n_left} of {n_runs} runs that other processes do in the same folder; they continue"
    )]
    Waited {
        /// Number of runs that others do.
        n_left: usize,
        /// Number of different runs in the campaign.
        n_runs: usize,
    },
}

/// An error with its causes, as one line, without causes that the text already contains.
pub fn in_full(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(next) = cause {
        let words = next.to_string();
        if !text.contains(&words) {
            text.push_str(": ");
            text.push_str(&words);
        }
        cause = next.source();
    }
    text
}
