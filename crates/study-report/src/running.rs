//! The page of a campaign while it runs, renewed in its folder.

mod page;

use crate::output::PAGE;
use crate::run_details::RunDetails;
use campaign::run_store::{Observation, Record, write_whole_unsynced};
use campaign::{Progress, ProgressState, RunRequest};
use inference::CalibrationProblem;
use report::Tone;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Least time between two writings of the page. Our choice: short runs are not held up, and a reader sees every few seconds
/// what is new.
const PAUSE: Duration = Duration::from_secs(3);
/// Longest time between two writings: the page of a campaign that was killed is older.
const LONGEST_PAUSE: Duration = Duration::from_mins(1);
/// Most failures and warnings that are kept each.
const MOST_MESSAGES: usize = 20;

/// Known data of a campaign before its first run.
#[derive(Debug, Clone, Default)]
pub struct RunningCampaign {
    /// Title of the page.
    pub title: String,
    /// The stages in their order; none if it is one list of runs.
    pub stages: Vec<RunningStage>,
    /// Parameters and measurements; `None` for a list of runs that is compared with nothing.
    pub problem: Option<CalibrationProblem>,
}

/// A stage of a campaign.
#[derive(Debug, Clone)]
pub struct RunningStage {
    /// Name, as it is announced.
    pub name: String,
    /// Number of runs that are certain.
    pub runs: usize,
    /// Largest number of further runs that their results may ask for.
    pub at_most_further: usize,
}

#[derive(Debug)]
struct FinishedRun {
    /// What was asked for.
    request: RunRequest,
    /// What it gave.
    observables: BTreeMap<String, Observation>,
}

/// The last frame of the latest run of a model.
#[derive(Debug)]
struct Frame {
    /// Its run in words.
    run: String,
    /// PNG or JPEG.
    bytes: Vec<u8>,
}

/// How a campaign ended.
#[derive(Debug, Clone, Copy)]
struct End<'e> {
    /// How good that is.
    tone: Tone,
    /// In a few words.
    headline: &'e str,
    /// What follows.
    reason: &'e str,
}

/// What the page shows.
#[derive(Debug)]
struct Seen {
    /// What was known before.
    campaign: RunningCampaign,
    /// Stage that was announced last; empty before the first.
    stage: String,
    /// What was announced within the stage last; empty for nothing.
    remark: String,
    /// What the campaign said last, and when.
    progress: Option<(ProgressState, Instant)>,
    /// Keys of the records so far.
    keys: BTreeSet<String>,
    /// Number of records by the stage that asked for them first.
    done_by_stage: BTreeMap<String, usize>,
    /// The runs behind these records, in the order in which they ended.
    runs: Vec<FinishedRun>,
    /// The latest frame of each model.
    frames: BTreeMap<String, Frame>,
    /// Number of runs without a result.
    failed: usize,
    /// The first of them with their reasons.
    failures: Vec<String>,
    /// The first warnings.
    warnings: Vec<String>,
    /// Whether something is not yet on the page.
    is_new: bool,
    /// Whether the writer is to end.
    is_over: bool,
    /// Why the page could not be written; `None` if it could.
    refusal: Option<String>,
    /// Whether the listener behind knows of it.
    has_warned: bool,
}

/// What the listener and the writer of the page share.
#[derive(Debug)]
struct Shared {
    /// What the page shows.
    seen: Mutex<Seen>,
    /// Told when the writer is to end.
    over: Condvar,
    /// The page.
    file: PathBuf,
}

/// A listener that keeps `report.html` in the folder of a campaign up to date, and hands on what it hears.
///
/// A thread of its own writes the page, whole or not at all, every three seconds at most. A page that cannot be written is warned of
/// once and ends no run. Dropped before [`RunningPage::finish`] or [`RunningPage::replace`], it says that the campaign ended early.
pub struct RunningPage<'a> {
    /// What the page shows.
    shared: Arc<Shared>,
    /// The listener behind this one.
    next: &'a dyn Progress,
    /// The writer; `None` once it has ended.
    writer: Option<JoinHandle<()>>,
    /// Whether the last page is written.
    is_last: bool,
}

impl fmt::Debug for RunningPage<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RunningPage")
            .field("file", &self.shared.file)
            .finish_non_exhaustive()
    }
}

impl<'a> RunningPage<'a> {
    /// Writes the first page into the folder of a campaign, which exists.
    pub fn begin(folder: &Path, campaign: RunningCampaign, next: &'a dyn Progress) -> Self {
        let shared = Arc::new(Shared {
            seen: Mutex::new(Seen::new(campaign)),
            over: Condvar::new(),
            file: folder.join(PAGE),
        });
        shared.write(None);
        let writes = Arc::clone(&shared);
        // Without a thread the first page stays until the last one.
        let writer = std::thread::Builder::new().spawn(move || writes.write_until_over());
        Self {
            shared,
            next,
            writer: writer.ok(),
            is_last: false,
        }
    }

    /// Says that a stage begins, or something within it if no stage has this name.
    pub fn announce(&self, text: &str) {
        let mut seen = self.shared.lock();
        if seen.campaign.stages.iter().any(|stage| stage.name == text) {
            text.clone_into(&mut seen.stage);
            seen.remark.clear();
        } else {
            text.clone_into(&mut seen.remark);
        }
        seen.is_new = true;
    }

    /// Writes the last page, which says how the campaign ended.
    pub fn finish(mut self, tone: Tone, headline: &str, reason: &str) {
        self.write_last(End {
            tone,
            headline,
            reason,
        });
    }

    /// Puts another page in the place of this one.
    ///
    /// # Errors
    /// Those of `write`; this page then says that the campaign ended early.
    pub fn replace<E>(mut self, write: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
        self.stop();
        write()?;
        self.is_last = true;
        Ok(())
    }

    /// Ends the writer.
    fn stop(&mut self) {
        if let Some(writer) = self.writer.take() {
            self.shared.lock().is_over = true;
            self.shared.over.notify_all();
            // A writer that panicked has ended, too.
            let _ = writer.join();
        }
    }

    /// Ends the writer and writes the last page.
    fn write_last(&mut self, end: End<'_>) {
        self.stop();
        self.shared.write(Some(end));
        self.is_last = true;
        self.warn_once();
    }

    /// Reports to the listener behind, once, that the page cannot be written.
    fn warn_once(&self) {
        let mut seen = self.shared.lock();
        if seen.has_warned {
            return;
        }
        let Some(why) = seen.refusal.clone() else {
            return;
        };
        seen.has_warned = true;
        drop(seen);
        self.next.warning(&format!(
            "cannot write {}: {why}; the runs continue",
            self.shared.file.display()
        ));
    }
}

impl Drop for RunningPage<'_> {
    fn drop(&mut self) {
        if !self.is_last {
            self.write_last(End {
                tone: Tone::Caution,
                headline: "Ended early",
                reason: "Finished runs are kept; the same command with --resume continues.",
            });
        }
    }
}

impl Progress for RunningPage<'_> {
    fn ended(&self, request: &RunRequest, result: Result<&Record, &str>) {
        self.shared.lock().take(request, result);
        self.next.ended(request, result);
    }

    fn update(&self, state: &ProgressState) {
        let mut seen = self.shared.lock();
        seen.progress = Some((*state, Instant::now()));
        seen.is_new = true;
        drop(seen);
        self.warn_once();
        self.next.update(state);
    }

    fn warning(&self, text: &str) {
        let mut seen = self.shared.lock();
        if seen.warnings.len() < MOST_MESSAGES {
            seen.warnings.push(text.to_owned());
        }
        drop(seen);
        self.next.warning(text);
    }
}

impl Shared {
    /// Locks what is shown, which no panic leaves half done.
    fn lock(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the writer is to end, for some time at most.
    fn wait(&self, time: Duration) {
        let goes_on = |seen: &mut Seen| !seen.is_over;
        drop(self.over.wait_timeout_while(self.lock(), time, goes_on));
    }

    /// Writes the page when something is new, and each minute, until the campaign is over.
    fn write_until_over(&self) {
        let mut written = Instant::now();
        loop {
            self.wait(PAUSE);
            let seen = self.lock();
            if seen.is_over {
                return;
            }
            let is_due = seen.is_new || written.elapsed() >= LONGEST_PAUSE;
            drop(seen);
            if is_due {
                self.write(None);
                written = Instant::now();
            }
        }
    }

    /// Writes the page.
    fn write(&self, end: Option<End<'_>>) {
        let mut seen = self.lock();
        seen.is_new = false;
        let page = page::page(&seen, end);
        drop(seen);
        let written = page.map_err(|why| why.to_string()).and_then(|page| {
            write_whole_unsynced(&self.file, page.as_bytes()).map_err(|why| why.to_string())
        });
        self.lock().refusal = written.err();
    }
}

impl Seen {
    /// Nothing but what was known before.
    fn new(campaign: RunningCampaign) -> Self {
        Self {
            campaign,
            stage: String::new(),
            remark: String::new(),
            progress: None,
            keys: BTreeSet::new(),
            done_by_stage: BTreeMap::new(),
            runs: Vec::new(),
            frames: BTreeMap::new(),
            failed: 0,
            failures: Vec::new(),
            warnings: Vec::new(),
            is_new: false,
            is_over: false,
            refusal: None,
            has_warned: false,
        }
    }

    /// Takes the result of a run; a record that is known already counts once.
    fn take(&mut self, request: &RunRequest, result: Result<&Record, &str>) {
        self.is_new = true;
        let record = match result {
            Ok(record) if self.keys.insert(record.key().to_owned()) => record,
            Ok(_) => return,
            Err(why) => {
                self.failed += 1;
                if self.failures.len() < MOST_MESSAGES {
                    self.failures
                        .push(format!("{}: {why}", page::run_in_words(request)));
                }
                return;
            }
        };
        *self.done_by_stage.entry(self.stage.clone()).or_default() += 1;
        if let Some(bytes) = RunDetails::last_frame_of(record) {
            let run = page::run_in_words(request);
            self.frames
                .insert(request.model.clone(), Frame { run, bytes });
        }
        self.runs.push(FinishedRun {
            request: request.clone(),
            observables: record.observables().clone(),
        });
    }
}

#[cfg(test)]
mod tests;
