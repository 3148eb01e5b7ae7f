//! How far a campaign is, kept in its folder for others to read.
//!
//! `progress/state.json` tells the stage and the numbers, `progress/list-N.json` the runs of the Nth list under their keys. Each
//! is written aside and renamed, so that a reader meets it whole. A file that cannot be written is told once and hinders no run.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::fs::{self, File};
use std::io::{ErrorKind, Read as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::{PendingRun, Progress, ProgressState, RunRequest};

/// Name of the folder in that of a campaign.
const FOLDER: &str = "progress";
/// Name of the file of the numbers.
const STATE: &str = "state.json";
/// Least time between two writings of the numbers, so that runs of milliseconds are not held up. Our choice; a reader looks
/// every two seconds.
const LEAST_PAUSE: Duration = Duration::from_millis(250);
/// Most runs of a list that are written, about 40 MB: a list for people to look at should not take longer than its runs.
const MOST_RUNS: usize = 100_000;
/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// What is known of a campaign before its first run; names and texts are for people.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CampaignPlan {
    /// Name of the campaign.
    pub name: String,
    /// The stages in their order; none where it is one list.
    pub stages: Vec<StagePlan>,
    /// What its parameters are, by their name in the requests.
    pub parameters: BTreeMap<String, ParameterName>,
    /// What was measured, in the order in which it is of interest.
    pub measured: Vec<MeasuredMean>,
}

/// A stage of a campaign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StagePlan {
    /// Name.
    pub name: String,
    /// Number of runs that are certain.
    pub runs: usize,
    /// Runs that their results may ask for beyond these, at most.
    pub at_most_further: usize,
}

/// What a parameter is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ParameterName {
    /// In words.
    pub name: String,
    /// Its unit; `1` for a pure number.
    pub unit: String,
}

/// A measured mean to which runs are compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredMean {
    /// The model that stands for what was measured.
    pub model: String,
    /// Name of the observable.
    pub observable: String,
    /// The mean, in the unit of the observable.
    pub mean: f64,
    /// What it serves for, such as `fit`.
    pub role: String,
}

/// How far a campaign is.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CampaignState {
    /// What was known of it before.
    pub plan: CampaignPlan,
    /// Name of the stage that it is in; empty before the first, and where it has none.
    pub stage: String,
    /// What was told within the stage last; empty where nothing was.
    pub remark: String,
    /// Number of lists of runs so far.
    pub lists: usize,
    /// Runs of the present list.
    pub runs: usize,
    /// Those of them that are over.
    pub done: usize,
    /// Those of them that gave no result.
    pub failed: usize,
    /// Runs of earlier lists that gave no result.
    pub failed_before: usize,
    /// Time since the loop began, s.
    pub elapsed_s: f64,
    /// Expected time of the runs to the end of the loop, at least and at most, s; none before the first run is finished.
    pub left_s: Option<[f64; 2]>,
    /// How it ended; none before its end, and where it was killed.
    pub end: Option<String>,
}

/// A list of runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PlannedList {
    /// The stage that asks for it; empty where there is none.
    pub stage: String,
    /// The runs by the key of their record, in the order in which they were asked for.
    pub runs: Vec<PlannedRun>,
}

/// A run of a list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedRun {
    /// Key of its record.
    pub key: String,
    /// What is run.
    pub request: RunRequest,
}

/// What the writer knows.
#[derive(Debug, Default)]
struct Writer {
    /// What it writes.
    state: CampaignState,
    /// When it wrote last.
    last: Option<Instant>,
    /// Set once it was told that nothing can be written.
    told: bool,
}

/// A listener that keeps what it hears in the folder of a campaign, and hands it on.
pub struct ProgressFolder<'a> {
    /// Where the files are.
    folder: PathBuf,
    /// Who hears it as well.
    next: &'a dyn Progress,
    /// What it knows.
    writer: Mutex<Writer>,
}

impl fmt::Debug for ProgressFolder<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ProgressFolder")
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

impl<'a> ProgressFolder<'a> {
    /// Begins to tell of a campaign in its folder, which exists.
    pub fn new(campaign: &Path, plan: CampaignPlan, next: &'a dyn Progress) -> Self {
        let state = CampaignState {
            plan,
            ..CampaignState::default()
        };
        let folder = Self {
            folder: campaign.join(FOLDER),
            next,
            writer: Mutex::new(Writer {
                state,
                ..Writer::default()
            }),
        };
        folder.write_state(&mut folder.lock());
        folder
    }

    /// Tells that a stage begins, or something within it where no stage of the plan has this name.
    pub fn announce(&self, text: &str) {
        let mut writer = self.lock();
        if writer.state.plan.stages.iter().any(|s| s.name == text) {
            text.clone_into(&mut writer.state.stage);
            writer.state.remark.clear();
        } else {
            text.clone_into(&mut writer.state.remark);
        }
        self.write_state(&mut writer);
    }

    /// Tells how the campaign ended.
    pub fn end(&self, how: &str) {
        let mut writer = self.lock();
        writer.state.end = Some(how.to_owned());
        self.write_state(&mut writer);
    }

    /// Locks what it knows, which no panic leaves half done.
    fn lock(&self) -> MutexGuard<'_, Writer> {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the numbers.
    fn write_state(&self, writer: &mut Writer) {
        let written = self.write(STATE, &writer.state);
        writer.last = Some(Instant::now());
        self.tell(writer, written);
    }

    /// Tells once that a file cannot be written.
    fn tell(&self, writer: &mut Writer, written: std::io::Result<()>) {
        if let Err(why) = written
            && !std::mem::replace(&mut writer.told, true)
        {
            self.next.warning(&format!(
                "the progress of the campaign cannot be kept in {} for `watch`: {why}; the runs go on",
                self.folder.display()
            ));
        }
    }

    /// Writes a file, whole or not at all; after a loss of power the next one replaces it.
    fn write(&self, name: &str, content: &impl Serialize) -> std::io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        crate::run_store::write_whole_unsynced(
            &self.folder.join(name),
            &serde_json::to_vec(content)?,
        )
    }
}

impl Progress for ProgressFolder<'_> {
    fn planned(&self, runs: &[PendingRun<'_>]) {
        let mut writer = self.lock();
        let state = &mut writer.state;
        state.failed_before += std::mem::take(&mut state.failed);
        state.lists += 1;
        state.runs = runs.len();
        state.done = 0;
        let run = |run: &PendingRun<'_>| PlannedRun {
            key: run.key.to_owned(),
            request: run.request.clone(),
        };
        let list = PlannedList {
            stage: state.stage.clone(),
            runs: runs.iter().take(MOST_RUNS).map(run).collect(),
        };
        let written = self.write(&list_name(state.lists), &list);
        self.tell(&mut writer, written);
        self.write_state(&mut writer);
        drop(writer);
        self.next.planned(runs);
    }

    fn update(&self, heard: &ProgressState) {
        let mut writer = self.lock();
        let state = &mut writer.state;
        state.runs = heard.total;
        state.done = heard.done;
        state.failed = heard.failed;
        state.elapsed_s = heard.elapsed_s;
        state.left_s = heard.left_s;
        let is_due = |last: Instant| last.elapsed() >= LEAST_PAUSE;
        if heard.done == heard.total || writer.last.is_none_or(is_due) {
            self.write_state(&mut writer);
        }
        drop(writer);
        self.next.update(heard);
    }

    fn warning(&self, text: &str) {
        self.next.warning(text);
    }
}

impl Drop for ProgressFolder<'_> {
    fn drop(&mut self) {
        let is_open = self.lock().state.end.is_none();
        if is_open {
            self.end("ended early");
        }
    }
}

/// Name of the file of a list, from 1.
fn list_name(number: usize) -> String {
    format!("list-{number}.json")
}

impl CampaignState {
    /// Where the state of a campaign is kept in its folder.
    pub fn path(campaign: &Path) -> PathBuf {
        campaign.join(FOLDER).join(STATE)
    }

    /// Reads how far the campaign of a folder is, and for how long nothing was heard; none where it does not tell.
    ///
    /// # Errors
    ///
    /// What is wrong with the file, as the rest of a sentence about it.
    pub fn read(campaign: &Path) -> Result<Option<(Self, Duration)>, String> {
        read(&Self::path(campaign))
    }
}

impl PlannedList {
    /// Where a list, from 1, is kept in the folder of its campaign.
    pub fn path(campaign: &Path, number: usize) -> PathBuf {
        campaign.join(FOLDER).join(list_name(number))
    }

    /// Numbers of the lists that lie in the folder of a campaign, from 1 to `last`, in their order: an earlier campaign in the folder
    /// may have left more, and the state of a damaged file may speak of any number.
    pub fn numbers(campaign: &Path, last: usize) -> Vec<usize> {
        let entries = fs::read_dir(campaign.join(FOLDER)).into_iter().flatten();
        let number = |entry: std::io::Result<fs::DirEntry>| {
            let name = entry.ok()?.file_name();
            let digits = name
                .to_str()?
                .strip_prefix("list-")?
                .strip_suffix(".json")?;
            let number: usize = digits.parse().ok()?;
            (number.to_string() == digits && (1..=last).contains(&number)).then_some(number)
        };
        let mut numbers: Vec<usize> = entries.filter_map(number).collect();
        numbers.sort_unstable();
        numbers
    }

    /// Reads a list of the campaign of a folder, from 1; none where it is missing.
    ///
    /// # Errors
    ///
    /// What is wrong with the file, as the rest of a sentence about it.
    pub fn read(campaign: &Path, number: usize) -> Result<Option<Self>, String> {
        let read = read(&Self::path(campaign, number))?;
        Ok(read.map(|(list, _)| list))
    }
}

/// Reads a file with the time since it was written.
fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<(T, Duration)>, String> {
    let bad = |why: std::io::Error| why.to_string();
    match path.symlink_metadata() {
        Err(why) if why.kind() == ErrorKind::NotFound => return Ok(None),
        Err(why) => return Err(bad(why)),
        // Looked at before it is opened: opening a pipe waits for a writer.
        Ok(data) if !data.is_file() => return Err("it is no plain file".to_owned()),
        Ok(_) => {}
    }
    let file = match File::open(path) {
        Err(why) if why.kind() == ErrorKind::NotFound => return Ok(None),
        file => file.map_err(bad)?,
    };
    let data = file.metadata().map_err(bad)?;
    if data.len() > LARGEST_FILE {
        return Err(format!("it has more than {LARGEST_FILE} bytes"));
    }
    let age = data.modified().ok().and_then(|time| time.elapsed().ok());
    let mut bytes = Vec::new();
    let read = file.take(LARGEST_FILE).read_to_end(&mut bytes);
    read.map_err(bad)?;
    let content = serde_json::from_slice(&bytes).map_err(|why| why.to_string())?;
    Ok(Some((content, age.unwrap_or_default())))
}
