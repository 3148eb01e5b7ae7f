//! One list of runs: watching records, tasks and the batch system until each run is done or failed.

use campaign::run_store::{Lookup, Store};
use campaign::{PendingRun, RunEvent, SimulatorError};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::io;
use crate::files::{TaskFiles, end_of_log, locked, made_folder, write_whole};
use crate::ledger::{Ledger, Loss, OpenTask, Submission};
use crate::task::TaskReport;
use crate::watch::{Judgement, Watch, seconds};
use crate::{BatchRunner, Error, LossReason, TaskId, TaskState};

/// What is known while a list of runs is done.
pub(crate) struct Session<'a> {
    /// The runner.
    pub(crate) runner: &'a BatchRunner,
    /// The list.
    pub(crate) runs: &'a [PendingRun<'a>],
    /// Where records appear.
    store: &'a Store,
    /// Hears of each run.
    tell: &'a mut dyn FnMut(RunEvent),
    /// What was submitted.
    pub(crate) ledger: Ledger,
    /// Folder of the task files, as a whole path.
    pub(crate) tasks: PathBuf,
    /// Runs that are neither done nor failed, by key: places in the list.
    pub(crate) open: BTreeMap<String, usize>,
    /// Runs that were told as begun.
    begun: BTreeSet<usize>,
    /// What is known of the tasks, by name.
    watches: BTreeMap<String, Watch>,
    /// When the batch system is asked next; at once where absent.
    asked: Option<Instant>,
    /// When the batch system answered last.
    answered: Instant,
    /// Whether its last answer was an error, and which.
    pub(crate) trouble: Option<String>,
    /// When a run was done or a task settled last.
    moved: Instant,
    /// When a submission that was not taken is tried again.
    pub(crate) held_since: Option<Instant>,
    /// Held as long as the list is done.
    _lock: File,
}

/// Why a run has no record, in words that need no other before them.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Reason(String);

/// Name of a task: that of its array and its place.
pub(crate) fn task_name(array: &str, index: usize) -> String {
    format!("{array}-{index}")
}

impl<'a> Session<'a> {
    /// Locks the folder and reads the ledger.
    pub(crate) fn begin(
        runner: &'a BatchRunner,
        runs: &'a [PendingRun<'a>],
        store: &'a Store,
        tell: &'a mut dyn FnMut(RunEvent),
    ) -> Result<Self, Error> {
        if store.folder().is_none() {
            return Err(Error::NoFolder);
        }
        let folder = made_folder(&runner.folder)?;
        let lock = locked(&folder.join("lock"))?;
        let ledger = Ledger::open(&folder)?;
        let tasks = made_folder(&folder.join("tasks"))?;
        let now = Instant::now();
        let place = |(i, run): (usize, &PendingRun<'_>)| (run.key.to_owned(), i);
        let session = Self {
            runner,
            runs,
            store,
            tell,
            ledger,
            tasks,
            open: runs.iter().enumerate().map(place).collect(),
            begun: BTreeSet::new(),
            watches: BTreeMap::new(),
            asked: None,
            answered: now,
            trouble: None,
            moved: now,
            held_since: None,
            _lock: lock,
        };
        let attached = session.attached();
        if attached > 0 {
            session.say(&format!(
                "{attached} of {} runs were submitted before; they are waited for",
                runs.len()
            ));
        }
        Ok(session)
    }

    /// Whether every run is done or failed.
    pub(crate) fn is_over(&self) -> bool {
        self.open.is_empty()
    }

    /// Time since a run was done or a task settled, s.
    pub(crate) fn quiet_s(&self) -> f64 {
        seconds(self.moved, Instant::now())
    }

    /// Looks once at everything, and submits what has to be.
    pub(crate) fn step(&mut self) -> Result<(), Error> {
        // The batch system first: what it calls ended has then left its records, as far as files are seen at once.
        self.ask_when_due()?;
        self.look_for_records();
        self.look_at_tasks()?;
        self.submit_open()?;
        self.check_patience()
    }

    /// Tells the listener.
    pub(crate) fn say(&self, text: &str) {
        if let Some(listener) = &self.runner.listener {
            listener(text);
        }
    }

    /// The files of a task.
    pub(crate) fn files(&self, name: &str) -> TaskFiles {
        TaskFiles::new(&self.tasks, name)
    }

    /// Number of open runs that belong to a task of the ledger.
    fn attached(&self) -> usize {
        let tasks = self.ledger.content.arrays.iter().flat_map(|a| &a.tasks);
        let keys: BTreeSet<&String> = tasks.flat_map(|task| &task.keys).collect();
        self.open.keys().filter(|key| keys.contains(key)).count()
    }

    /// Notes that something has moved.
    pub(crate) fn note_move(&mut self) {
        self.moved = Instant::now();
    }

    /// Asks the batch system for the states of all tasks.
    fn ask_when_due(&mut self) -> Result<(), Error> {
        let now = Instant::now();
        let interval_s = self.runner.settings.state_interval_s;
        let is_early = |asked| seconds(asked, now) < interval_s;
        if self.ledger.content.arrays.is_empty() || self.asked.is_some_and(is_early) {
            return Ok(());
        }
        let answer = self.resolve_meant().and_then(|resolved| {
            resolved?;
            Ok(self.runner.system.states(&self.task_ids()))
        })?;
        let now = Instant::now();
        self.asked = Some(now);
        match answer {
            Ok(states) => {
                self.hear(&states, now);
                self.answered = now;
                if self.trouble.take().is_some() {
                    self.say("the batch system answers again");
                }
            }
            Err(error) => {
                let text = error.in_full();
                if self.trouble.is_none() {
                    self.say(&format!("the batch system does not answer: {text}"));
                }
                self.trouble = Some(text);
            }
        }
        Ok(())
    }

    /// The tasks whose arrays have an id.
    fn task_ids(&self) -> Vec<TaskId> {
        let mut ids = Vec::new();
        for array in &self.ledger.content.arrays {
            if let Submission::Known(job) = &array.submission {
                ids.extend(array.tasks.iter().map(|task| TaskId {
                    job: job.clone(),
                    index: task.index,
                }));
            }
        }
        ids
    }

    /// Notes the states of all tasks.
    fn hear(&mut self, states: &BTreeMap<TaskId, TaskState>, now: Instant) {
        for array in &self.ledger.content.arrays {
            for task in &array.tasks {
                let state = match &array.submission {
                    Submission::Known(job) => states.get(&TaskId {
                        job: job.clone(),
                        index: task.index,
                    }),
                    Submission::Meant | Submission::Unnamed => None,
                };
                self.watches
                    .entry(task_name(&array.name, task.index))
                    .or_insert_with(Watch::new)
                    .hear_state(state.copied().unwrap_or(TaskState::Unknown), now);
            }
        }
    }

    /// Finds the runs whose record has come.
    fn look_for_records(&mut self) {
        // Listing the folder is one question in place of many, and makes a shared file system look again.
        let listed = self.store.keys().ok().map(BTreeSet::from_iter);
        let may_be = |key: &String| listed.as_ref().is_none_or(|keys| keys.contains(key));
        let done: Vec<(String, usize)> = self
            .open
            .iter()
            .filter(|(key, _)| may_be(key) && self.has_record(key))
            .map(|(key, i)| (key.clone(), *i))
            .collect();
        for (key, i) in done {
            self.close(&key);
            (self.tell)(RunEvent::Done(i));
        }
    }

    /// Whether the store has the record of a key.
    fn has_record(&self, key: &str) -> bool {
        matches!(self.store.get(key), Ok(Lookup::Found(_)))
    }

    /// Takes a run out of what is open.
    fn close(&mut self, key: &str) {
        self.open.remove(key);
        self.ledger.content.losses.remove(key);
        self.note_move();
    }

    /// Looks at the files of all tasks, and settles those that are over.
    fn look_at_tasks(&mut self) -> Result<(), Error> {
        let present = names_in(&self.tasks)?;
        let arrays = self.ledger.content.arrays.clone();
        let mut changed = false;
        for array in &arrays {
            for task in &array.tasks {
                let name = task_name(&array.name, task.index);
                let verdict = self.judge(&name, &present);
                if present.contains(&format!("{name}.report.json")) {
                    self.read_report(&name, task);
                }
                let is_settled = !task.keys.iter().any(|key| self.open.contains_key(key));
                match verdict {
                    Judgement::Ended | Judgement::Over(_) if is_settled => {}
                    Judgement::Over(reason) => self.lose(&name, task, reason)?,
                    Judgement::Runs => {
                        self.tell_begun(task);
                        continue;
                    }
                    Judgement::Waits | Judgement::Ended => continue,
                }
                self.learn_pace(&name);
                self.ledger.settle(&array.name, task.index);
                self.watches.remove(&name);
                self.note_move();
                changed = true;
            }
        }
        if changed {
            self.ledger.save()?;
        }
        Ok(())
    }

    /// Reads the small files of a task and judges it.
    fn judge(&mut self, name: &str, present: &BTreeSet<String>) -> Judgement {
        let files = self.files(name);
        let now = Instant::now();
        let answers = self.trouble.is_none();
        let watch = self
            .watches
            .entry(name.to_owned())
            .or_insert_with(Watch::new);
        if !watch.has_exit() && present.contains(&format!("{name}.exit")) {
            let text = std::fs::read_to_string(files.exit()).unwrap_or_default();
            if let Ok(code) = text.trim().parse() {
                watch.see_exit(code);
            }
        }
        if watch.needs_beat()
            && present.contains(&format!("{name}.beat"))
            && let Ok(beat) = std::fs::read_to_string(files.beat())
        {
            watch.see_beat(&beat, now);
        }
        watch.judge(&self.runner.settings, answers, now)
    }

    /// Tells the runs that a worker reported as failed.
    fn read_report(&mut self, name: &str, task: &OpenTask) {
        let files = self.files(name);
        if !task.keys.iter().any(|key| self.open.contains_key(key)) {
            return;
        }
        let Some(report) = TaskReport::read(&files.report()) else {
            return;
        };
        for failure in &report.failures {
            if let Some(i) = self.open.get(&failure.key).copied() {
                self.close(&failure.key);
                let reason = format!("{}; log: {}", failure.reason, files.log().display());
                (self.tell)(RunEvent::Failed(i, SimulatorError::other(Reason(reason))));
            }
        }
    }

    /// Adds what a worker measured to the pace.
    fn learn_pace(&mut self, name: &str) {
        if let Some(report) = TaskReport::read(&self.files(name).report())
            && report.cost > 0.0
            && report.time_s > 0.0
        {
            self.ledger.content.measured_cost += report.cost;
            self.ledger.content.measured_s += report.time_s;
        }
    }

    /// Tells the runs of a task in progress as begun: as many as it does at a time, in the order of its list.
    fn tell_begun(&mut self, task: &OpenTask) {
        let open = task.keys.iter().filter_map(|key| self.open.get(key));
        let current: Vec<usize> = open
            .take(self.runner.settings.cpus_per_task)
            .copied()
            .collect();
        for i in current {
            if self.begun.insert(i) {
                (self.tell)(RunEvent::Began(i));
            }
        }
    }

    /// Counts the runs of a lost task that have no record; those that were lost too often have failed.
    fn lose(&mut self, name: &str, task: &OpenTask, reason: LossReason) -> Result<(), Error> {
        let files = self.files(name);
        // Wherever it may still be: it must not begin once its runs are elsewhere.
        write_whole(&files.void(), b"lost\n")?;
        let mut n_open = 0;
        for key in &task.keys {
            let Some(i) = self.open.get(key).copied() else {
                continue;
            };
            n_open += 1;
            let loss = self
                .ledger
                .content
                .losses
                .entry(key.clone())
                .or_insert_with(|| Loss::none(reason));
            loss.add(reason, &files.log());
            if loss.count > self.runner.settings.retries {
                let reason = format!(
                    "lost {} times, the last time because {reason}; log {}: {}",
                    loss.count,
                    files.log().display(),
                    end_of_log(&files.log())
                );
                self.close(key);
                (self.tell)(RunEvent::Failed(i, SimulatorError::other(Reason(reason))));
            }
        }
        self.say(&format!(
            "task {name} is lost with {n_open} of {} runs: {reason}",
            task.keys.len()
        ));
        Ok(())
    }

    /// Gives up when nothing is heard of the batch system for too long.
    fn check_patience(&self) -> Result<(), Error> {
        let now = Instant::now();
        let is_alone = self.ledger.content.arrays.is_empty();
        let last = if is_alone {
            self.moved
        } else {
            self.moved.max(self.answered)
        };
        let limit_s = self.runner.settings.patience_s;
        match &self.trouble {
            Some(trouble) if seconds(last, now) > limit_s => Err(Error::Patience {
                limit_s,
                trouble: trouble.clone(),
            }),
            _ => Ok(()),
        }
    }
}

/// The names of the files in a folder.
fn names_in(folder: &Path) -> Result<BTreeSet<String>, Error> {
    let entries = std::fs::read_dir(folder).map_err(io("list", folder))?;
    Ok(entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect())
}
