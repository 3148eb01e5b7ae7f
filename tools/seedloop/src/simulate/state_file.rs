//! The states of a run on its way, as two files beside its record that are written in turn, and the line that shows how far it is.
//!
//! Each has a digest. A newest one that is damaged costs the time since the one before, and no result.

use super::run_line::RunLine;
use anyhow::Context as _;
use campaign::run_store::{seal_text, set_file_aside, unseal_text};
use command_line::{Common, Overwrite, write_new};
use scene::{Keeper, Progress, RunStage};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Ends of the names of the two files, behind the key of the run.
const ENDS: [&str; 2] = [".state.json", ".state-2.json"];

/// The files, when one was written last, and whether the run is to end.
pub(super) struct StateFile<'a> {
    /// Where warnings go.
    common: &'a Common,
    /// Key of the run.
    key: String,
    /// The files; `None` if the run keeps no record either.
    paths: Option<[PathBuf; 2]>,
    /// The one that is written next.
    next: usize,
    /// Time between two writings.
    every: Duration,
    /// When the state was written last.
    last: Instant,
    /// Raised when the run is to end.
    stop: Arc<AtomicBool>,
    /// Where the progress of the run is reported.
    line: RunLine,
}

/// The state that a run has left behind.
#[derive(Debug, Default)]
pub(super) struct Left {
    /// The newest one that can be believed.
    pub(super) progress: Option<Progress>,
    /// What was wrong with others, and where they are now.
    pub(super) warnings: Vec<String>,
}

/// The two files of a run of a key in a folder.
pub(super) fn state_files(folder: &Path, key: &str) -> [PathBuf; 2] {
    ENDS.map(|end| folder.join(format!("{key}{end}")))
}

impl<'a> StateFile<'a> {
    /// The files of a run, one of which is written once in so many seconds.
    pub(super) fn new(
        folder: Option<&Path>,
        key: &str,
        every_s: f64,
        stop: &Arc<AtomicBool>,
        common: &'a Common,
    ) -> Self {
        Self {
            common,
            key: key.to_owned(),
            paths: folder.map(|folder| state_files(folder, key)),
            next: 0,
            every: Duration::try_from_secs_f64(every_s).unwrap_or(Duration::MAX),
            last: Instant::now(),
            stop: Arc::clone(stop),
            line: RunLine::new(common),
        }
    }

    /// The files that are there.
    fn present(&self) -> Vec<(usize, &PathBuf)> {
        let all = self.paths.iter().flatten().enumerate();
        all.filter(|(_, path)| path.symlink_metadata().is_ok())
            .collect()
    }

    /// The names of the files that are there, for messages.
    pub(super) fn name(&self) -> String {
        let present = self.present().into_iter();
        let names: Vec<String> = present
            .map(|(_, path)| path.display().to_string())
            .collect();
        names.join(" and ")
    }

    /// Whether a run has left a state behind.
    pub(super) fn exists(&self) -> bool {
        !self.present().is_empty()
    }

    /// The state that a run has left behind, if it has. A file that is not as it was written is set aside.
    ///
    /// # Errors
    /// A file that cannot be read or set aside.
    pub(super) fn left(&mut self) -> anyhow::Result<Left> {
        let mut left = Left::default();
        let mut newest = None;
        for (number, path) in self.present() {
            let bytes = input::file::read(path).with_context(|| {
                format!("{} (remove it to start the run again)", path.display())
            })?;
            let read = unseal_text(&self.key, &bytes).and_then(|json| {
                serde_json::from_slice::<Progress>(json).map_err(|why| why.to_string())
            });
            match read {
                Ok(progress) => {
                    let known = left.progress.as_ref().map_or(-1.0, Progress::time);
                    if progress.time() > known {
                        left.progress = Some(progress);
                        newest = Some(number);
                    }
                }
                Err(reason) => {
                    let away = set_file_aside(path)?;
                    left.warnings.push(format!(
                        "{} is not the state that was kept: {reason}; it is set aside as {}",
                        path.display(),
                        away.file_name().unwrap_or(away.as_os_str()).display()
                    ));
                }
            }
        }
        // The newest one stays until a newer one is whole.
        self.next = newest.map_or(0, |number| 1 - number);
        Ok(left)
    }

    /// Removes the files of a run that has ended.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(super) fn remove(&self) -> anyhow::Result<()> {
        for (_, path) in self.present() {
            std::fs::remove_file(path)
                .with_context(|| format!("cannot remove {}", path.display()))?;
        }
        Ok(())
    }
}

impl Keeper for StateFile<'_> {
    fn is_due(&mut self) -> bool {
        self.paths.is_some() && self.last.elapsed() >= self.every
    }

    fn hear(&mut self, stage: &RunStage) {
        self.line.draw(stage);
    }

    fn begin_anew(&mut self, why: &str) -> Result<(), String> {
        self.line.clear();
        self.common
            .log(|| format!("warning: {why}; the run begins again with half the time step"));
        self.remove().map_err(|e| format!("{e:#}"))
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        let Some(paths) = &self.paths else {
            return Ok(());
        };
        let json = serde_json::to_vec(progress).map_err(|e| e.to_string())?;
        let bytes = seal_text(&self.key, &json);
        write_new(&paths[self.next], &bytes, Overwrite::Allow).map_err(|e| format!("{e:#}"))?;
        self.next = 1 - self.next;
        self.last = Instant::now();
        Ok(())
    }
}
