//! The runner: an executor of campaigns on a batch system.

use campaign::run_store::Store;
use campaign::{Executor, ExecutorError, PendingRun, RunEvent};
use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::session::Session;
use crate::{BatchSettings, BatchSystem, CommandTemplate, Error, Slurm};

/// Share of the time since something moved last that is waited until the next look: an end is seen so much late.
const PAUSE_SHARE: f64 = 0.05;

/// Hears what the runner does, such as that a job was submitted.
pub(crate) type Listener = Box<dyn Fn(&str) + Send + Sync>;

/// Does the runs of campaigns as tasks of a batch system.
pub struct BatchRunner {
    /// Where ledger and tasks are kept.
    pub(crate) folder: PathBuf,
    /// Command of a worker; the task file is added.
    pub(crate) worker: Vec<String>,
    /// Who runs the tasks.
    pub(crate) system: Box<dyn BatchSystem + Send>,
    /// What the user set.
    pub(crate) settings: BatchSettings,
    /// Hears what happens.
    pub(crate) listener: Option<Listener>,
}

impl fmt::Debug for BatchRunner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BatchRunner")
            .field("folder", &self.folder)
            .field("worker", &self.worker)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

impl BatchRunner {
    /// A runner on any batch system. The folder must be seen by submitting process and tasks under the same path, and
    /// a task is the command `worker` with the path of its task file added.
    ///
    /// # Errors
    ///
    /// [`Error::Setting`] when a setting is invalid.
    pub fn new(
        folder: PathBuf,
        worker: Vec<String>,
        system: Box<dyn BatchSystem + Send>,
        settings: BatchSettings,
    ) -> Result<Self, Error> {
        settings.check()?;
        if worker.is_empty() {
            return Err(Error::Setting {
                name: "worker",
                value: "empty".into(),
                limit: "give the command that does the runs of a task file",
            });
        }
        Ok(Self {
            folder,
            worker,
            system,
            settings,
            listener: None,
        })
    }

    /// A runner on Slurm.
    ///
    /// # Errors
    ///
    /// As [`BatchRunner::new`].
    pub fn slurm(
        folder: PathBuf,
        worker: Vec<String>,
        settings: BatchSettings,
    ) -> Result<Self, Error> {
        let system = Box::new(Slurm::new(&settings));
        Self::new(folder, worker, system, settings)
    }

    /// A runner on the batch system that the command lines of the settings stand for.
    ///
    /// # Errors
    ///
    /// As [`BatchRunner::new`]; also when there are no command lines.
    pub fn command(
        folder: PathBuf,
        worker: Vec<String>,
        settings: BatchSettings,
    ) -> Result<Self, Error> {
        let system = Box::new(CommandTemplate::new(&settings)?);
        Self::new(folder, worker, system, settings)
    }

    /// Has someone hear what the runner does, one line at a time: submissions, losses, a batch system that does not
    /// answer.
    #[must_use]
    pub fn with_listener(mut self, listener: impl Fn(&str) + Send + Sync + 'static) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Does all runs.
    fn do_all(
        &self,
        runs: &[PendingRun<'_>],
        store: &Store,
        stopped: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(RunEvent),
    ) -> Result<(), Error> {
        if runs.is_empty() {
            return Ok(());
        }
        let mut session = Session::begin(self, runs, store, tell)?;
        while !stopped() {
            session.step()?;
            if session.is_over() {
                return session.ledger.save();
            }
            let (least_s, most_s) = (self.settings.poll_s, self.settings.poll_most_s);
            let pause_s = PAUSE_SHARE * session.quiet_s();
            wait(pause_s.min(most_s).max(least_s), stopped);
        }
        if self.settings.cancel_on_stop {
            session.cancel_all()?;
        }
        Ok(())
    }
}

impl Executor for BatchRunner {
    fn execute(
        &self,
        runs: &[PendingRun<'_>],
        store: &Store,
        stopped: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(RunEvent),
    ) -> Result<(), ExecutorError> {
        self.do_all(runs, store, stopped, tell)
            .map_err(|error| ExecutorError {
                reason: error.in_full(),
            })
    }
}

/// Waits, unless it is to stop.
fn wait(time_s: f64, stopped: &dyn Fn() -> bool) {
    /// Longest time until a stop is seen.
    const SLICE: Duration = Duration::from_millis(100);
    let begin = Instant::now();
    while !stopped() {
        let left_s = time_s - begin.elapsed().as_secs_f64();
        if left_s <= 0.0 {
            return;
        }
        std::thread::sleep(SLICE.min(Duration::from_secs_f64(left_s)));
    }
}
