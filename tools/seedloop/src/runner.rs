//! Where runs are done: on the threads of this process, or as jobs of a batch system.

use crate::work::Job;
use anyhow::Context as _;
use batch_runner::{BatchRunner, BatchSettings};
use clap::ValueEnum;
use command_line::Common;
use scene::USUAL_RETRIES;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Who does the runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum Runner {
    /// Threads of this process
    #[default]
    Local,
    /// Job arrays of Slurm
    Slurm,
    /// Jobs of another batch system, by the command lines of `[runner.command]`
    Command,
}

/// How often a run is tried again.
#[derive(clap::Args, Debug, Clone, Copy)]
pub(crate) struct Retries {
    /// How often a run that diverges is tried again, each time with half the time step; its record says so
    #[arg(long = "retries", value_name = "N", default_value_t = USUAL_RETRIES,
        value_parser = clap::value_parser!(u32).range(..=6))]
    pub(crate) number: u32,
}

/// Name of the folder of the jobs in a result folder.
const FOLDER: &str = "batch";
/// Name of the file that tells the workers what they work on.
const JOB: &str = "job.json";

impl Runner {
    /// The executor of a batch system for a job, none for the threads of this process.
    ///
    /// # Errors
    ///
    /// A folder that cannot be made, invalid settings.
    pub(crate) fn executor(
        self,
        job: impl FnOnce(&Path) -> anyhow::Result<Job>,
        folder: &Path,
        settings: &BatchSettings,
        common: &Common,
    ) -> anyhow::Result<Option<BatchRunner>> {
        if self == Self::Local {
            return Ok(None);
        }
        let batch = folder.join(FOLDER);
        let made = || format!("cannot make the folder {}", batch.display());
        fs::create_dir_all(&batch).with_context(made)?;
        // Jobs begin elsewhere: all paths are whole.
        let batch = batch.canonicalize().with_context(made)?;
        let whole = folder.canonicalize().with_context(made)?;
        let file = batch.join(JOB);
        job(&whole)?.write(&file)?;
        let program = std::env::current_exe().context("cannot find this program")?;
        let program = text(&program)?;
        let worker = vec![program, "work".to_owned(), text(&file)?];
        let settings = settings.clone();
        let runner = match self {
            Self::Command => BatchRunner::command(batch, worker, settings),
            _ => BatchRunner::slurm(batch, worker, settings),
        };
        let quiet = common.quiet;
        Ok(Some(runner?.with_listener(move |line| {
            if !quiet {
                // A closed standard error is no reason to stop.
                let _ = writeln!(std::io::stderr(), "{line}");
            }
        })))
    }
}

/// A path as text.
fn text(path: &Path) -> anyhow::Result<String> {
    let text = path.to_str().map(str::to_owned);
    text.with_context(|| format!("{} is no text that a job script can hold", path.display()))
}

/// The settings of jobs in the table `[runner]` of a file; the usual ones without a file.
///
/// # Errors
///
/// A file that cannot be read, or has no such table; invalid settings.
pub(crate) fn runner_settings(file: Option<&Path>) -> anyhow::Result<BatchSettings> {
    #[derive(serde::Deserialize)]
    struct WithRunner {
        runner: BatchSettings,
    }
    let Some(file) = file else {
        return Ok(BatchSettings::default());
    };
    let text =
        input::file::read_text(file).with_context(|| format!("cannot read {}", file.display()))?;
    let with = || format!("{}: [runner]", file.display());
    let WithRunner { runner } = toml::from_str(&text).with_context(with)?;
    runner.check().with_context(with)?;
    Ok(runner)
}

/// A path from the root, so that it is found from elsewhere.
///
/// # Errors
///
/// A file that is not there.
pub(crate) fn whole(path: &Path) -> anyhow::Result<PathBuf> {
    path.canonicalize()
        .with_context(|| format!("cannot find {}", path.display()))
}
