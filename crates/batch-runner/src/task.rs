//! What a task is told, and what it tells.

use campaign::RunRequest;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

use crate::Error;

/// What a worker is to do: the content of a task file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Runs at a time, for a worker that is not told otherwise.
    pub threads: usize,
    /// The runs, longest first.
    pub runs: Vec<TaskRun>,
}

/// One run of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskRun {
    /// Key under which its record will be looked for.
    pub key: String,
    /// What is asked for.
    pub request: RunRequest,
    /// Relative time that it will take.
    pub cost: f64,
}

/// What a worker says at the end of its task.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskReport {
    /// Runs that gave no record, with the reason.
    pub failures: Vec<RunFailure>,
    /// Number of runs that have a record.
    pub done: usize,
    /// Cost of the runs that were done here, not found.
    pub cost: f64,
    /// Time that those took, summed over the threads, s.
    pub time_s: f64,
}

/// A run without a record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunFailure {
    /// Its key.
    pub key: String,
    /// Why there is none.
    pub reason: String,
}

impl Task {
    /// Reads a task file.
    ///
    /// # Errors
    ///
    /// [`Error::TaskDamaged`] when it cannot be read.
    pub fn read(path: &Path) -> Result<Self, Error> {
        read_json(path).map_err(|reason| Error::TaskDamaged {
            path: path.to_owned(),
            reason,
        })
    }
}

impl TaskReport {
    /// Reads the report of a task; none where there is none yet, or only half of one.
    pub(crate) fn read(path: &Path) -> Option<Self> {
        read_json(path).ok()
    }
}

/// Reads a file of JSON, or tells in words why not.
fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    serde_json::from_slice(&bytes).map_err(|error| error.to_string())
}
