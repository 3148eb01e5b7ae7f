//! Runs that are done elsewhere than on the threads of this process.

use crate::run_store::Store;

use crate::{RunRequest, SimulatorError};

/// A run of a list, as an executor is to do it or a listener hears of it.
#[derive(Debug, Clone, Copy)]
pub struct PendingRun<'a> {
    /// What is asked for.
    pub request: &'a RunRequest,
    /// The key under which its record will be found.
    pub key: &'a str,
    /// Relative time that it will take, above 0: [`crate::Simulator::expected_cost`].
    pub cost: f64,
}

/// What becomes of a run; numbers are places in the list that was given.
#[derive(Debug)]
pub enum RunEvent {
    /// It began.
    Began(usize),
    /// Its record is in the store.
    Done(usize),
    /// It ended without a record.
    Failed(usize, SimulatorError),
}

/// Does the runs of a campaign in place of its own threads, such as jobs of a cluster do.
pub trait Executor: Sync {
    /// Does all runs, and tells each as it begins and ends. Returns when each has ended, or soon after `stopped` turns
    /// true: runs that have begun may then go on elsewhere and are found in the store later.
    ///
    /// # Errors
    ///
    /// [`ExecutorError`] when no run can be begun or watched any more; finished runs are in the store.
    fn execute(
        &self,
        runs: &[PendingRun<'_>],
        store: &Store,
        stopped: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(RunEvent),
    ) -> Result<(), ExecutorError>;
}

/// Why runs can no longer be done elsewhere.
#[derive(Debug, thiserror::Error)]
#[error("{reason}")]
pub struct ExecutorError {
    /// What happened, and the way out.
    pub reason: String,
}
