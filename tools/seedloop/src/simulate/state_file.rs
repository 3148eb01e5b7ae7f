//! The state of a run on its way, as a file beside its record.

use anyhow::Context as _;
use command_line::{Overwrite, write_new};
use scene::{Keeper, Progress};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The file, and when it was written last.
#[derive(Debug)]
pub(super) struct StateFile {
    /// The file; none where the run keeps no record either.
    path: Option<PathBuf>,
    /// Time between two writings.
    every: Duration,
    /// When the state was written last.
    last: Instant,
}

impl StateFile {
    /// The file of a run, which is written once in so many seconds.
    pub(super) fn new(path: Option<PathBuf>, every_s: f64) -> Self {
        Self {
            path,
            every: Duration::try_from_secs_f64(every_s).unwrap_or(Duration::MAX),
            last: Instant::now(),
        }
    }

    /// The name of the file, for messages.
    pub(super) fn name(&self) -> String {
        self.path
            .as_ref()
            .map_or_else(String::new, |p| p.display().to_string())
    }

    /// Whether a run has left a state behind.
    pub(super) fn exists(&self) -> bool {
        self.path.as_ref().is_some_and(|path| path.exists())
    }

    /// The state that a run has left behind, if it has.
    ///
    /// # Errors
    /// A file that cannot be read or is no state.
    pub(super) fn left(&self) -> anyhow::Result<Option<Progress>> {
        let Some(path) = self.path.as_ref().filter(|path| path.exists()) else {
            return Ok(None);
        };
        let place = || format!("{} (remove it to start the run anew)", path.display());
        let text = std::fs::read_to_string(path).with_context(place)?;
        let progress = serde_json::from_str(&text).with_context(place)?;
        Ok(Some(progress))
    }

    /// Removes the file of a run that has ended.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(super) fn remove(&self) -> anyhow::Result<()> {
        match self.path.as_ref().filter(|path| path.exists()) {
            Some(path) => std::fs::remove_file(path)
                .with_context(|| format!("cannot remove {}", path.display())),
            None => Ok(()),
        }
    }
}

impl Keeper for StateFile {
    fn is_due(&mut self) -> bool {
        self.path.is_some() && self.last.elapsed() >= self.every
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let text = serde_json::to_vec(progress).map_err(|e| e.to_string())?;
        write_new(path, &text, Overwrite::Allow).map_err(|e| format!("{e:#}"))?;
        self.last = Instant::now();
        Ok(())
    }
}
