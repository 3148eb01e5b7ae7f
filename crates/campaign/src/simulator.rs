//! The simulator seen from outside.

use serde_json::Value;
use std::collections::BTreeMap;

use crate::error::in_full;
use crate::run_store::{Observation, Record};
use crate::{Cores, RunOutcome, RunRequest};

/// Anything that turns a request into observables; the same request gives the same numbers.
pub trait Simulator: Sync {
    /// Version of the code; runs of another version are not reused.
    fn version(&self) -> String;

    /// Does one run, on the calling thread.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] when the request is invalid, or the run fails.
    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError>;

    /// Checks a request and builds, once, what its key, its cost and its run have in common. By default the request itself is
    /// the key, every run costs the same, and [`Simulator::run`] does it.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] if the request is invalid, before anything is run.
    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        Ok(Box::new(Unprepared {
            simulator: self,
            request: request.clone(),
        }))
    }

    /// What a request reads from the record of its finished run beside the observables that the record keeps, such as numbers about a
    /// measured curve: two requests for one run may read it in different ways. By default nothing.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] if the record does not show what is asked.
    fn read_further(
        &self,
        request: &RunRequest,
        record: &Record,
    ) -> Result<BTreeMap<String, Observation>, SimulatorError> {
        let _ = (request, record);
        Ok(BTreeMap::new())
    }
}

/// A record with what a request reads further from it.
pub(crate) fn with_further(
    simulator: &dyn Simulator,
    request: &RunRequest,
    record: Record,
) -> Result<Record, SimulatorError> {
    let further = simulator.read_further(request, &record)?;
    record
        .with_observables(further)
        .map_err(SimulatorError::other)
}

/// A run that is ready to be done.
pub trait PreparedRun: Send + Sync {
    /// Everything that the result of the run depends on, besides the version and the seed, and nothing
    /// else: two requests with the same inputs and seed are one run. All numbers in it must be finite.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] if the inputs cannot be stated as JSON.
    fn inputs(&self) -> Result<Value, SimulatorError>;

    /// Time that the run will take, relative to the other runs: sets the order (longest first)
    /// and the estimate of the time left. Not positive or not finite counts as 1.
    fn cost(&self) -> f64 {
        1.0
    }

    /// Does the run on as many threads as it has cores at each moment; the result does not depend on their number.
    ///
    /// # Errors
    ///
    /// [`SimulatorError`] if the run fails.
    fn run(&self, cores: &Cores) -> Result<RunOutcome, SimulatorError>;
}

/// A request of a simulator that prepares nothing.
struct Unprepared<'s, S: ?Sized> {
    simulator: &'s S,
    request: RunRequest,
}

impl<S: Simulator + ?Sized> PreparedRun for Unprepared<'_, S> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        Ok(self.request.inputs())
    }

    fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
        self.simulator.run(&self.request)
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
