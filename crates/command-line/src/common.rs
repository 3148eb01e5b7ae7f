//! The flags that every command has.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::Serialize;

use crate::write::{Overwrite, try_new, write_new};

/// Largest number of threads; a larger number is a typing error.
const MOST_THREADS: usize = 1024;

/// The flags that every command has.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Common {
    /// Write the results as JSON to FILE; without FILE to standard output, and nothing else there
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub json: Option<PathBuf>,

    /// Say nothing on standard error but errors
    #[arg(long)]
    pub quiet: bool,

    /// Work with N threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<NonZeroUsize>,

    /// Overwrite files that exist
    #[arg(long)]
    pub force: bool,
}

/// Reads a number of threads.
fn thread_count(text: &str) -> Result<NonZeroUsize, String> {
    text.parse()
        .ok()
        .filter(|count: &NonZeroUsize| count.get() <= MOST_THREADS)
        .ok_or_else(|| format!("the number of threads must be from 1 to {MOST_THREADS}"))
}

impl Common {
    /// Returns the number of threads to work with: as given, or one for each core.
    pub fn threads(&self) -> usize {
        self.threads
            .or_else(|| std::thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get)
    }

    /// Returns whether files that exist may be overwritten.
    pub fn overwrite(&self) -> Overwrite {
        if self.force {
            Overwrite::Allow
        } else {
            Overwrite::Refuse
        }
    }

    /// Returns whether standard output is reserved for JSON.
    pub fn json_on_stdout(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }

    /// Writes the results as JSON if `--json` is given.
    ///
    /// Numbers keep their full precision; values that are not finite become `null`.
    ///
    /// # Errors
    /// Results that cannot be written as JSON, a file that exists or cannot be written, a standard
    /// output that cannot be written.
    pub fn emit_json(&self, results: &impl Serialize) -> anyhow::Result<()> {
        let Some(file) = &self.json else {
            return Ok(());
        };
        let mut text =
            serde_json::to_string_pretty(results).context("results have no form in JSON")?;
        text.push('\n');
        if self.json_on_stdout() {
            return write_stdout(&text);
        }
        self.protect_input(file)?;
        write_new(file, text.as_bytes(), self.overwrite())
    }

    /// Tests whether the results can be written: these files and that of [`Self::emit_json`]. Call it before long work.
    ///
    /// # Errors
    /// A folder that is missing, a file that exists and may not be overwritten or that cannot be written, two results in one
    /// file.
    pub fn try_outputs<'f>(
        &'f self,
        files: impl IntoIterator<Item = &'f PathBuf>,
    ) -> anyhow::Result<()> {
        let json = self.json.as_ref().filter(|_| !self.json_on_stdout());
        if let Some(file) = json {
            self.protect_input(file)?;
        }
        let mut tried = BTreeSet::new();
        for file in files.into_iter().chain(json) {
            anyhow::ensure!(
                tried.insert(file),
                "{} is to take two results: give each a file of its own",
                file.display()
            );
            try_new(file, self.overwrite())?;
        }
        Ok(())
    }

    /// [`Self::try_outputs`] of a command that reads `inputs`.
    ///
    /// # Errors
    /// As there; a result with the name of an input, which `--force` would replace.
    pub fn try_outputs_beside<'f>(
        &'f self,
        inputs: impl IntoIterator<Item = &'f PathBuf>,
        files: impl IntoIterator<Item = &'f PathBuf>,
    ) -> anyhow::Result<()> {
        let real = |file: &PathBuf| file.canonicalize().ok();
        let inputs: BTreeSet<PathBuf> = inputs.into_iter().filter_map(real).collect();
        let files: Vec<&PathBuf> = files.into_iter().collect();
        for file in files.iter().copied().chain(&self.json) {
            anyhow::ensure!(
                !real(file).is_some_and(|file| inputs.contains(&file)),
                "{} is read by this command and is not replaced by results: give another name",
                file.display()
            );
        }
        self.try_outputs(files)
    }

    /// Refuses to replace a file without the extension of JSON by JSON: with `--json photo.jpg
    /// --force` the photo was probably meant as input.
    fn protect_input(&self, file: &Path) -> anyhow::Result<()> {
        let is_json = file
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("json"));
        anyhow::ensure!(
            is_json || !self.force || !file.exists(),
            "{} exists and does not end in .json, so it is not replaced by JSON: give another \
             name, or put --json last to get standard output",
            file.display()
        );
        Ok(())
    }

    /// Reports progress on standard error, unless `--quiet`.
    pub fn log(&self, text: impl FnOnce() -> String) {
        if !self.quiet {
            // A closed standard error is no reason to stop the work.
            let _ = writeln!(std::io::stderr(), "{}", text());
        }
    }

    /// Writes a line of results on standard output, unless JSON goes there or nobody reads it any more.
    ///
    /// # Errors
    /// A standard output that cannot be written, such as a file on a full disk.
    pub fn print(&self, text: impl Display) -> anyhow::Result<()> {
        if self.json_on_stdout() {
            return Ok(());
        }
        write_stdout(&format!("{text}\n"))
    }
}

/// Writes to standard output at once. A reader that has closed it, such as `head`, has what it wanted.
fn write_stdout(text: &str) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    let outcome = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    match outcome {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome.context("cannot write to standard output"),
    }
}
