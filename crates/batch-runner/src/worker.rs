//! Doing the runs of a task, on the machine that the batch system chose.

use campaign::run_store::{Lookup, Record, Store};
use campaign::{Campaign, Pace, Progress, Simulator};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::Error;
use crate::files::{TaskFiles, write_json};
use crate::task::{RunFailure, Task, TaskReport, TaskRun};

/// Does the runs of a task file, and leaves a report beside it; `threads` at a time, or as many as the task says where
/// it is 0.
///
/// Runs that have a record are found. A run that fails is part of the report. Once `stop` is true no further run begins, and no
/// report is left: the task is then one that was lost.
///
/// # Errors
///
/// [`Error::OtherKey`] or [`Error::Refused`] when this program would not do the runs that were asked for: all of them
/// are then reported as failed; [`Error::TaskDamaged`], [`Error::Campaign`] or [`Error::Io`] when the task cannot be
/// read, the store not be used, or the report not be written.
pub fn run_task(
    task_file: &Path,
    simulator: &dyn Simulator,
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
    stop: Option<&AtomicBool>,
) -> Result<TaskReport, Error> {
    let task = Task::read(task_file)?;
    let report_file = TaskFiles::of(task_file).report();
    if let Err(error) = check_keys(task_file, simulator, &task.runs) {
        // Another try would end the same way.
        let reason = error.in_full();
        let failure = |run: &TaskRun| RunFailure {
            key: run.key.clone(),
            reason: reason.clone(),
        };
        let report = TaskReport {
            failures: task.runs.iter().map(failure).collect(),
            ..TaskReport::default()
        };
        write_json(&report_file, &report)?;
        return Err(error);
    }
    let threads = if threads == 0 {
        task.threads.max(1)
    } else {
        threads
    };
    let is_missing = |run: &&TaskRun| !matches!(store.get(&run.key), Ok(Lookup::Found(_)));
    let cost = task
        .runs
        .iter()
        .filter(is_missing)
        .map(|run| run.cost)
        .sum();
    let requests: Vec<_> = task.runs.iter().map(|run| run.request.clone()).collect();
    let pace = Pace::new();
    let campaign = Campaign::new(store, threads, progress).with_pace(&pace);
    let campaign = match stop {
        Some(stop) => campaign.with_stop(stop),
        None => campaign,
    };
    let results = campaign
        .run_each(simulator, &requests)
        .map_err(|source| Error::Campaign {
            path: task_file.to_owned(),
            source,
        })?;
    let failures: Vec<RunFailure> = task
        .runs
        .iter()
        .zip(&results)
        .filter_map(|(run, result)| {
            let reason = result.as_ref().err()?.clone();
            let key = run.key.clone();
            Some(RunFailure { key, reason })
        })
        .collect();
    let report = TaskReport {
        done: results.len() - failures.len(),
        failures,
        cost,
        time_s: pace.seconds_per_cost().unwrap_or(0.0) * cost,
    };
    write_json(&report_file, &report)?;
    Ok(report)
}

/// Checks that this program means the same runs as the one that submitted them.
fn check_keys(path: &Path, simulator: &dyn Simulator, runs: &[TaskRun]) -> Result<(), Error> {
    let version = simulator.version();
    for run in runs {
        let refused = |source| Error::Refused {
            path: path.to_owned(),
            request: run.request.to_string(),
            source,
        };
        let inputs = simulator.inputs(&run.request).map_err(refused)?;
        let record = Record::new(&version, inputs, run.request.seed)
            .map_err(|error| refused(campaign::SimulatorError::other(error)))?;
        if record.key() != run.key {
            return Err(Error::OtherKey {
                path: path.to_owned(),
                request: run.request.to_string(),
                expected: run.key.clone(),
                found: record.key().to_owned(),
            });
        }
    }
    Ok(())
}
