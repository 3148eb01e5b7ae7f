//! `seedloop work JOB.json TASK.json`: the runs of one task of a batch system.

use crate::stop::Stop;
use anyhow::Context as _;
use batch_runner::run_task;
use campaign::Simulator;
use campaign::run_store::Store;
use command_line::{Common, DONE, NOT_MET, Overwrite, write_new};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use study::{DesignChoices, DesignTable, Study};

/// Does the runs of one task that --runner has submitted; batch systems call it
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// What the task belongs to, as the submitting command wrote it
    #[arg(value_name = "JOB.json")]
    job: PathBuf,

    /// The runs
    #[arg(value_name = "TASK.json")]
    task: PathBuf,

    #[command(flatten)]
    common: Common,
}

/// What tasks belong to: all that their simulator is made of. Paths are whole.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Job {
    /// A study.
    Study {
        /// How often a run that diverges is tried again.
        retries: u32,
        /// The study file.
        study: PathBuf,
        /// Its profile.
        profile: Option<String>,
        /// The result folder.
        folder: PathBuf,
    },
    /// A design table.
    Design {
        /// How often a run that diverges is tried again.
        retries: u32,
        /// All that its runs follow from.
        choices: DesignChoices,
        /// The result folder.
        folder: PathBuf,
    },
}

impl Job {
    /// Writes the job for its workers.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub(crate) fn write(&self, file: &Path) -> anyhow::Result<()> {
        let text = serde_json::to_vec_pretty(self)?;
        write_new(file, &text, Overwrite::Allow)
    }
}

/// Does the runs; exit code 1 where some gave no record.
///
/// # Errors
///
/// A job or task that cannot be read, a program of another version than the one that submitted.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    let name = arguments.job.display();
    let text =
        input::file::read_text(&arguments.job).with_context(|| format!("cannot read {name}"))?;
    let job: Job =
        serde_json::from_str(&text).with_context(|| format!("{name} is no job of --runner"))?;
    let kept = "finished runs are kept; the command that submitted the task does the others";
    let stop = Stop::new(move || kept.to_owned())?;
    let (simulator, folder): (Box<dyn Simulator>, PathBuf) = match job {
        Job::Study {
            retries,
            study,
            profile,
            folder,
        } => {
            let study = Study::read(&study, profile.as_deref())?;
            let simulator = study.simulator(&folder)?.with_retries(retries);
            let simulator = simulator.with_stop(stop.flag());
            (Box::new(simulator), folder)
        }
        Job::Design {
            retries,
            choices,
            folder,
        } => {
            let table = DesignTable::read(&choices)?;
            let simulator = table.simulator()?.with_retries(retries);
            (Box::new(simulator.with_stop(stop.flag())), folder)
        }
    };
    let store = Store::open(folder.join("runs"))?;
    let progress = crate::calibrate::progress_lines(common);
    let report = run_task(
        &arguments.task,
        &*simulator,
        &store,
        0,
        &progress,
        Some(stop.flag()),
    );
    let report = match stop.result(report)? {
        Ok(report) => report,
        Err(code) => return Ok(code),
    };
    for failure in &report.failures {
        common.log(|| format!("failed: {}", failure.reason));
    }
    Ok(if report.failures.is_empty() {
        DONE
    } else {
        NOT_MET
    })
}
