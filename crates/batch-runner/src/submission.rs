//! Submitting the runs that no task has, finding what was submitted, and cancelling.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

use crate::error::io;
use crate::files::{made_folder, write_json, write_whole};
use crate::ledger::{Array, OpenTask, Submission};
use crate::packing::{Packing, pack};
use crate::script::Script;
use crate::session::{Session, task_name};
use crate::task::{Task, TaskRun};
use crate::watch::seconds;
use crate::{Error, JobId, TaskArray};

/// Number of losses from which on a run has a task of its own: it may be the one that takes the others with it.
const ALONE_FROM: u32 = 2;

/// What tells one submission from another: the factors of time limit and memory, and whether each run is alone.
type Kind = (u64, u64, bool);

impl Session<'_> {
    /// Submits all open runs that belong to no task.
    pub(crate) fn submit_open(&mut self) -> Result<(), Error> {
        let interval_s = self.runner.settings.state_interval_s;
        let is_early = |since| seconds(since, Instant::now()) < interval_s;
        if self.held_since.is_some_and(is_early) {
            return Ok(());
        }
        for ((time_factor, memory_factor, is_alone), runs) in self.unassigned() {
            let mut packing = Packing::new(&self.runner.settings, self.ledger.seconds_per_cost());
            let cost = |i: &usize| self.runs.get(*i).map_or(1.0, |run| run.cost);
            let costs: Vec<f64> = runs.iter().map(cost).collect();
            if is_alone {
                packing.seconds_per_cost = None;
                packing.most_tasks = usize::MAX;
            }
            let tasks: Vec<Vec<usize>> = pack(&costs, &packing)
                .into_iter()
                .map(|task| {
                    task.into_iter()
                        .filter_map(|i| runs.get(i).copied())
                        .collect()
                })
                .collect();
            let most = self.runner.system.most_tasks().max(1);
            for tasks in tasks.chunks(most) {
                if !self.submit(tasks, time_factor, memory_factor)? {
                    self.held_since = Some(Instant::now());
                    return Ok(());
                }
            }
        }
        self.held_since = None;
        Ok(())
    }

    /// Places of the open runs that belong to no task, by the kind of their submission, longest first.
    fn unassigned(&self) -> BTreeMap<Kind, Vec<usize>> {
        let content = &self.ledger.content;
        let tasks = content.arrays.iter().flat_map(|array| &array.tasks);
        let assigned: BTreeSet<&str> = tasks
            .flat_map(|task| task.keys.iter().map(String::as_str))
            .collect();
        let mut kinds: BTreeMap<Kind, Vec<usize>> = BTreeMap::new();
        for (i, run) in self.runs.iter().enumerate() {
            if self.open.contains_key(run.key) && !assigned.contains(run.key) {
                let kind = content.losses.get(run.key).map_or((1, 1, false), |loss| {
                    let is_alone = loss.count >= ALONE_FROM;
                    (loss.time_factor, loss.memory_factor, is_alone)
                });
                kinds.entry(kind).or_default().push(i);
            }
        }
        kinds
    }

    /// Submits one array; tells whether it was taken.
    fn submit(
        &mut self,
        tasks: &[Vec<usize>],
        time_factor: u64,
        memory_factor: u64,
    ) -> Result<bool, Error> {
        let settings = &self.runner.settings;
        let name = self.ledger.next_name();
        let times = |value: Option<u64>, factor| value.map(|v: u64| v.saturating_mul(factor));
        let array = TaskArray {
            script: self.tasks.join(format!("{name}.sh")),
            logs: (0..tasks.len())
                .map(|index| self.files(&task_name(&name, index)).log())
                .collect(),
            time_limit_s: times(settings.time_limit_s, time_factor),
            memory_mb: times(settings.memory_mb, memory_factor),
            name,
        };
        self.write_files(&array, tasks)?;
        let keys = |task: &Vec<usize>| -> Vec<String> {
            let runs = task.iter().filter_map(|i| self.runs.get(*i));
            runs.map(|run| run.key.to_owned()).collect()
        };
        let open = tasks.iter().enumerate().map(|(index, task)| OpenTask {
            index,
            keys: keys(task),
        });
        let open = open.collect();
        self.ledger.content.arrays.push(Array {
            name: array.name.clone(),
            submission: Submission::Meant,
            tasks: open,
        });
        self.ledger.save()?;
        match self.runner.system.submit(&array) {
            Ok(job) => {
                let n_runs: usize = tasks.iter().map(Vec::len).sum();
                self.say(&format!(
                    "{n_runs} runs are submitted in {} tasks as job {job} ({})",
                    tasks.len(),
                    array.name
                ));
                self.name_last(&array.name, &Submission::Known(job))?;
                self.trouble = None;
                Ok(true)
            }
            Err(error) => self.not_taken(&array.name, error),
        }
    }

    /// Writes the script of an array and what its tasks are to do.
    fn write_files(&self, array: &TaskArray, tasks: &[Vec<usize>]) -> Result<(), Error> {
        let settings = &self.runner.settings;
        for (index, task) in tasks.iter().enumerate() {
            let runs = task.iter().filter_map(|i| self.runs.get(*i));
            let content = Task {
                threads: settings.cpus_per_task,
                runs: runs
                    .map(|run| TaskRun {
                        key: run.key.to_owned(),
                        request: run.request.clone(),
                        cost: run.cost,
                    })
                    .collect(),
            };
            write_json(&self.files(&task_name(&array.name, index)).task(), &content)?;
        }
        let script = Script {
            folder: &self.tasks,
            name: &array.name,
            start: &made_folder(".".as_ref())?,
            worker: &self.runner.worker,
            extra_lines: &settings.extra_lines,
            heartbeat_s: settings.heartbeat_s,
            writes_log: self.runner.system.most_tasks() == 1,
        };
        write_whole(&array.script, script.text().as_bytes())
    }

    /// Deals with a submission that failed: it may have taken place all the same, or be taken later.
    fn not_taken(&mut self, name: &str, error: Error) -> Result<bool, Error> {
        if matches!(error, Error::NoProgram { .. }) {
            self.drop_array(name)?;
            return Err(error);
        }
        match self.runner.system.find(name) {
            Ok(Some(job)) => {
                self.name_last(name, &Submission::Known(job))?;
                return Ok(true);
            }
            Ok(None) => {}
            // The tasks are void, so that nothing is done twice should it have been taken.
            Err(_) if self.runner.system.may_be_taken_later(&error) => {}
            Err(_) => {
                self.drop_array(name)?;
                return Err(error);
            }
        }
        self.drop_array(name)?;
        if !self.runner.system.may_be_taken_later(&error) {
            return Err(error);
        }
        let text = error.in_full();
        if self.trouble.is_none() {
            self.say(&format!(
                "a submission was not taken, it is tried again: {text}"
            ));
        }
        self.trouble = Some(text);
        Ok(false)
    }

    /// Notes how far the submission of an array came.
    fn name_last(&mut self, name: &str, submission: &Submission) -> Result<(), Error> {
        for array in &mut self.ledger.content.arrays {
            if array.name == name {
                array.submission = submission.clone();
            }
        }
        self.ledger.save()
    }

    /// Makes all tasks of an array void and forgets it.
    fn drop_array(&mut self, name: &str) -> Result<(), Error> {
        let arrays = std::mem::take(&mut self.ledger.content.arrays);
        let (dropped, kept) = arrays.into_iter().partition(|array| array.name == name);
        self.ledger.content.arrays = kept;
        let dropped: Vec<Array> = dropped;
        for array in &dropped {
            self.make_void(array)?;
        }
        self.ledger.save()
    }

    /// Keeps the tasks of an array from beginning, and ends those that have begun.
    fn make_void(&self, array: &Array) -> Result<(), Error> {
        for task in &array.tasks {
            let void = self.files(&task_name(&array.name, task.index)).void();
            std::fs::write(&void, "given up\n").map_err(io("write", &void))?;
        }
        Ok(())
    }

    /// Finds out whether submissions took place that an earlier process had no time to note. The inner result is that
    /// of the batch system.
    pub(crate) fn resolve_meant(&mut self) -> Result<Result<(), Error>, Error> {
        let is_meant = |array: &&Array| array.submission == Submission::Meant;
        let arrays = self.ledger.content.arrays.iter();
        let meant: Vec<Array> = arrays.filter(is_meant).cloned().collect();
        for array in meant {
            match self.runner.system.find(&array.name) {
                Ok(Some(job)) => {
                    self.say(&format!("job {job} ({}) is found again", array.name));
                    self.name_last(&array.name, &Submission::Known(job))?;
                }
                Ok(None) => {
                    let has_begun = |task: &OpenTask| {
                        self.files(&task_name(&array.name, task.index))
                            .beat()
                            .exists()
                    };
                    if array.tasks.iter().any(has_begun) {
                        self.name_last(&array.name, &Submission::Unnamed)?;
                    } else {
                        self.drop_array(&array.name)?;
                    }
                }
                Err(error) => return Ok(Err(error)),
            }
        }
        Ok(Ok(()))
    }

    /// Cancels all tasks of this folder.
    pub(crate) fn cancel_all(&mut self) -> Result<(), Error> {
        self.resolve_meant()?.ok();
        let arrays = std::mem::take(&mut self.ledger.content.arrays);
        let mut jobs: Vec<JobId> = Vec::new();
        for array in &arrays {
            self.make_void(array)?;
            if let Submission::Known(job) = &array.submission {
                jobs.push(job.clone());
            }
        }
        let n_tasks: usize = arrays.iter().map(|array| array.tasks.len()).sum();
        match self.runner.system.cancel(&jobs) {
            Ok(()) => self.say(&format!("{n_tasks} tasks are cancelled")),
            Err(error) => self.say(&format!(
                "the batch system did not take the order to cancel, {n_tasks} tasks end by themselves at their next sign of life: {}",
                error.in_full()
            )),
        }
        self.ledger.save()
    }
}
