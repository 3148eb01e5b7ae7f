//! The simulator seen from outside.

use serde_json::Value;

use crate::error::in_full;
use crate::{Cores, RunOutcome, RunRequest};

/// Anything that turns a request into observables; the same request gives the same numbers.
pub trait Simulator: Sync {
    /// Version of the code; runs of another version are not reused.
    fn version(&self) -> String;

    /// Everything that the result of the request depends on, besides the version and the seed, and nothing
    /// else: two requests with the same inputs and seed are one run. All numbers in it must be
    /// finite. By default the request itself.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] if the request is invalid, before anything is run.
    fn inputs(&self, request: &RunRequest) -> Result<Value, SimulatorError> {
        Ok(request.inputs())
    }

    /// Does one run, on the calling thread.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] when the request is invalid, or the run fails.
    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError>;

    /// Does one run on as many threads as it has cores at each moment, with the same result. By default on the calling thread.
    ///
    /// # Errors
    ///
    /// As [`Simulator::run`].
    fn run_on(&self, request: &RunRequest, cores: &Cores) -> Result<RunOutcome, SimulatorError> {
        let _ = cores;
        self.run(request)
    }

    /// Time that the run will take, relative to the other runs: sets the order (longest first)
    /// and the estimate of the time left. Not positive or not finite counts as 1.
    fn expected_cost(&self, request: &RunRequest) -> f64 {
        let _ = request;
        1.0
    }
}

/// Reason for the missing result of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// The request cannot be run as it is.
    #[error("the request is refused: {reason}")]
    Refused {
        /// The fault and the remedy.
        reason: String,
    },
    /// The run began and failed.
    #[error("the run failed: {reason}")]
    Failed {
        /// The reason.
        reason: String,
    },
    /// The run failed in another process that shares the folder.
    #[error("{reason}")]
    FailedElsewhere {
        /// The process and its reason.
        reason: String,
    },
    /// The simulator panicked, which is a bug in it.
    #[error("the simulator panicked: {message}")]
    Panicked {
        /// Its message.
        message: String,
    },
    /// An error of the simulator's own kind.
    #[error(transparent)]
    Other(#[from] Box<dyn std::error::Error + Send + Sync>),
}

impl SimulatorError {
    /// Wraps the simulator's own error.
    pub fn other(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Other(Box::new(error))
    }

    /// The error with its causes, as one line.
    pub fn in_full(&self) -> String {
        in_full(self)
    }
}
