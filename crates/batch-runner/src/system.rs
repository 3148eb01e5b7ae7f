//! A batch system as the runner sees it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use crate::Error;

/// Id that the batch system gave to an array.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct JobId(pub String);

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// One task of an array: the place from 0 on.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct TaskId {
    /// The array.
    pub job: JobId,
    /// Place in the array.
    pub index: usize,
}

/// An array of tasks to be submitted: one script that is run once for each place.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskArray {
    /// Name of the job, like no other of the user.
    pub name: String,
    /// The script; it reads its place from `SLURM_ARRAY_TASK_ID`, and is at place 0 without it.
    pub script: PathBuf,
    /// Log of each task.
    pub logs: Vec<PathBuf>,
    /// Time limit of a task, s; that of the partition where absent.
    pub time_limit_s: Option<u64>,
    /// Memory of a task, MB; that of the partition where absent.
    pub memory_mb: Option<u64>,
}

/// What the batch system says of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskState {
    /// Not begun yet.
    Waiting,
    /// In progress.
    Running,
    /// Over, by itself.
    Ended {
        /// Whether its script ended with 0.
        ok: bool,
    },
    /// Over, by something else.
    Lost {
        /// What it was.
        reason: LossReason,
    },
    /// The system does not know it, or does not say.
    Unknown,
}

/// Why a task ended before its runs were done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LossReason {
    /// Its node failed.
    NodeFailure,
    /// It met its time limit.
    TimeOut,
    /// Another job took its place.
    Preempted,
    /// It wanted more memory than it had.
    OutOfMemory,
    /// Someone cancelled it.
    Cancelled,
    /// Its worker was killed or broke off.
    Killed,
    /// The batch system knows it no longer, and it gives no sign of life.
    Vanished,
}

impl fmt::Display for LossReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NodeFailure => "its node failed",
            Self::TimeOut => "it met its time limit",
            Self::Preempted => "it was preempted",
            Self::OutOfMemory => "it ran out of memory",
            Self::Cancelled => "it was cancelled",
            Self::Killed => "its worker was killed or broke off",
            Self::Vanished => "it vanished without a trace",
        })
    }
}

/// A batch system: takes arrays of tasks, tells what became of them, cancels them.
pub trait BatchSystem: Sync {
    /// Most tasks that one array may have.
    fn most_tasks(&self) -> usize;

    /// Submits an array.
    ///
    /// # Errors
    ///
    /// [`Error`] when it was not taken, or when that is not known: [`BatchSystem::find`] tells.
    fn submit(&self, array: &TaskArray) -> Result<JobId, Error>;

    /// Finds the array of a name: for a submission that was cut off before its id was noted.
    ///
    /// # Errors
    ///
    /// [`Error`] when the system does not answer.
    fn find(&self, name: &str) -> Result<Option<JobId>, Error>;

    /// Tells the states of these tasks, and of others at will; a task that is absent is unknown.
    ///
    /// # Errors
    ///
    /// [`Error`] when the system does not answer.
    fn states(&self, tasks: &[TaskId]) -> Result<BTreeMap<TaskId, TaskState>, Error>;

    /// Cancels all tasks of these arrays; those that are over already do not matter.
    ///
    /// # Errors
    ///
    /// [`Error`] when the system does not answer.
    fn cancel(&self, jobs: &[JobId]) -> Result<(), Error>;

    /// Whether a submission that failed this way may be taken later.
    fn may_be_taken_later(&self, error: &Error) -> bool;
}
