//! Runs of a campaign as jobs of a cluster.
//!
//! A [`BatchRunner`] is a [`campaign::Executor`]: it packs the runs of a list into tasks, submits them as arrays to a
//! [`BatchSystem`] ([`Slurm`], or [`CommandTemplate`] for any other), and watches the batch system, the store and the
//! signs of life of its tasks. On the other side [`run_task`] does the runs of a task.
//!
//! All is kept in one folder that submitting process and workers share:
//!
//! | file | what it is | who writes it |
//! |---|---|---|
//! | `ledger.json` | arrays with unsettled tasks, losses of runs, the measured pace | submitting process |
//! | `lock` | held by the submitting process as long as it lives | submitting process |
//! | `tasks/ARRAY.sh` | script of an array | submitting process |
//! | `tasks/ARRAY-0.json` | runs of a task | submitting process |
//! | `tasks/ARRAY-0.void` | tells the task not to begin, or to end | submitting process |
//! | `tasks/ARRAY-0.beat` | changes as long as the worker lives | task |
//! | `tasks/ARRAY-0.log` | output of the worker | task |
//! | `tasks/ARRAY-0.report.json` | failed runs and the measured pace | [`run_task`] |
//! | `tasks/ARRAY-0.exit` | code of the worker | task |
//!
//! Invariants:
//! - the records are those that threads of this process would give, for workers do the same runs under the same keys;
//! - what is submitted stands in the ledger before, so that a process that is killed at any moment and called again
//!   submits no run of a living task a second time;
//! - a task that was given up is void: it does not begin later;
//! - a lost run is submitted again, but no more than `retries` times.

mod command_template;
mod error;
mod files;
mod ledger;
mod packing;
mod program;
mod runner;
mod script;
mod session;
mod settings;
mod slurm;
mod submission;
mod system;
mod task;
mod watch;
mod worker;

pub use command_template::CommandTemplate;
pub use error::Error;
pub use packing::{Packing, pack};
pub use runner::BatchRunner;
pub use settings::{BatchSettings, CommandLines, SlurmPrograms};
pub use slurm::Slurm;
pub use system::{BatchSystem, JobId, LossReason, TaskArray, TaskId, TaskState};
pub use task::{RunFailure, Task, TaskReport, TaskRun};
pub use worker::run_task;
