//! What lies in the folder of a campaign, read again and again without touching it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use campaign::run_store::{FolderView, Observation, Record, read_record, record_path};
use campaign::{CampaignState, PlannedList, RunRequest};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, UNIX_EPOCH};

use crate::Error;

/// Time in which records are read before the page is made from what is there by then: a folder of thousands comes in parts. Our
/// choice; half of the time between two looks of the page.
const READING_TIME: Duration = Duration::from_secs(1);
/// Number of frames that are kept, the latest.
const MOST_FRAMES: usize = 6;
/// Largest frame that is kept, bytes.
const LARGEST_FRAME: usize = 8 << 20;
/// First bytes of a PNG file.
const PNG: [u8; 8] = [0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a];

/// The folder of a campaign, and what was read of it so far.
#[derive(Debug)]
pub struct CampaignFolder {
    /// Where it is.
    path: PathBuf,
    /// Lists of runs by number, with what their file was when it was read.
    lists: BTreeMap<usize, (Option<Stamp>, PlannedList)>,
    /// Place of each run in the lists, by key: runs whose files are of one time ended in this order. A clock of files
    /// that ticks every few milliseconds, or every second, cannot tell them apart.
    places: BTreeMap<String, usize>,
    /// Records by key.
    records: BTreeMap<String, Seen>,
    /// Frames of the latest runs, PNG, by key.
    frames: BTreeMap<String, Vec<u8>>,
}

/// Tells a file from the one that had its name before: its time since 1970 and its length.
type Stamp = (Duration, u64);

/// What was read of a record.
#[derive(Debug)]
enum Seen {
    /// A sound one.
    Run(Run),
    /// One that is damaged, and why; read again once its file is another.
    Damaged(Stamp, String),
}

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    /// When its record was written, since 1970.
    pub(crate) finished: Duration,
    /// Its seed.
    pub(crate) seed: u64,
    /// What it gave.
    pub(crate) observables: BTreeMap<String, Observation>,
    /// How it ended up.
    pub(crate) regime: Option<String>,
}

/// A finished run with what was asked for.
#[derive(Debug)]
pub(crate) struct AskedRun<'a> {
    /// Key of its record.
    pub(crate) key: &'a str,
    /// What was asked for; none where no list has it.
    pub(crate) request: Option<&'a RunRequest>,
    /// What came of it.
    pub(crate) run: &'a Run,
}

/// How far the runs of a list are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Counts {
    /// Runs of the list.
    pub(crate) all: usize,
    /// With a record.
    pub(crate) done: usize,
    /// Someone does at present.
    pub(crate) running: usize,
    /// Without a result.
    pub(crate) failed: usize,
}

/// What a folder shows at a moment.
#[derive(Debug)]
pub(crate) struct Snapshot<'a> {
    /// The folder.
    pub(crate) path: &'a Path,
    /// How far the campaign says to be, and the time since; none where it does not tell.
    pub(crate) state: Option<(CampaignState, Duration)>,
    /// Whether someone works in the folder.
    pub(crate) is_used: bool,
    /// The present list.
    pub(crate) list: Counts,
    /// Runs with a record by stage, over all lists.
    pub(crate) done_by_stage: BTreeMap<&'a str, usize>,
    /// Number of record files.
    pub(crate) records: usize,
    /// Number of record files not read yet.
    pub(crate) unread: usize,
    /// Finished runs in the order of their end.
    pub(crate) runs: Vec<AskedRun<'a>>,
    /// Keys of the runs with a frame, the latest first.
    pub(crate) frames: Vec<&'a str>,
    /// What is damaged, in words.
    pub(crate) problems: Vec<String>,
}

impl CampaignFolder {
    /// Takes a folder that holds what a campaign writes; reads nothing yet.
    ///
    /// # Errors
    ///
    /// [`Error::NoFolder`], [`Error::NoCampaign`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        if !path.is_dir() {
            return Err(Error::NoFolder {
                path: path.to_owned(),
            });
        }
        let is_campaign = |path: &Path| {
            path.join("runs").is_dir() || CampaignState::path(path).symlink_metadata().is_ok()
        };
        if !is_campaign(path) {
            let above = path.canonicalize().ok();
            let above = above.as_deref().and_then(Path::parent).unwrap_or(path);
            let way_out = if is_campaign(above) {
                format!("give {}", above.display())
            } else {
                "give the --out of calibrate, diagnose or run, once it has begun".to_owned()
            };
            return Err(Error::NoCampaign {
                path: path.to_owned(),
                way_out,
            });
        }
        Ok(Self {
            path: path.to_owned(),
            lists: BTreeMap::new(),
            places: BTreeMap::new(),
            records: BTreeMap::new(),
            frames: BTreeMap::new(),
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The frame of a run, PNG.
    pub(crate) fn frame(&self, key: &str) -> Option<&[u8]> {
        self.frames.get(key).map(Vec::as_slice)
    }

    /// Looks again.
    pub(crate) fn look(&mut self) -> Snapshot<'_> {
        let mut problems = Vec::new();
        let state = CampaignState::read(&self.path).unwrap_or_else(|why| {
            let path = CampaignState::path(&self.path);
            problems.push(format!("{}: {why}", path.display()));
            None
        });
        self.read_lists(
            state.as_ref().map_or(0, |(state, _)| state.lists),
            &mut problems,
        );
        let view = FolderView::of(&self.path.join("runs")).unwrap_or_else(|why| {
            problems.push(why.to_string());
            FolderView::default()
        });
        let unread = self.read_records(&view);
        for name in &view.set_aside {
            problems.push(format!(
                "{name}: set aside by the campaign, which does the run again"
            ));
        }
        for (key, seen) in &self.records {
            if let Seen::Damaged(_, why) = seen {
                problems.push(format!("{key}.json is left out: {why}"));
            }
        }
        self.snapshot(state, &view, unread, problems)
    }

    /// Reads the lists whose files are new or other than before.
    fn read_lists(&mut self, last: usize, problems: &mut Vec<String>) {
        let numbers = PlannedList::numbers(&self.path, last);
        self.lists.retain(|i, _| numbers.binary_search(i).is_ok());
        for i in numbers {
            let path = PlannedList::path(&self.path, i);
            let stamp = stamp_of(&path);
            let known = self.lists.get(&i).map(|(stamp, _)| *stamp);
            if known.is_some_and(|known| known.is_some() && known == stamp) {
                continue;
            }
            match PlannedList::read(&self.path, i) {
                Ok(list) => drop(self.lists.insert(i, (stamp, list.unwrap_or_default()))),
                Err(why) => problems.push(format!("{}: {why}", path.display())),
            }
        }
        self.places.clear();
        let planned = self.lists.values().flat_map(|(_, list)| &list.runs);
        for (place, run) in planned.enumerate() {
            self.places.entry(run.key.clone()).or_insert(place);
        }
    }

    /// What runs are sorted by: when one ended, then its place in the lists, then its key.
    fn end<'a>(&self, key: &'a str, run: &Run) -> (Duration, Option<usize>, &'a str) {
        (run.finished, self.places.get(key).copied(), key)
    }

    /// Reads records that are new, the latest first; gives the number of those that are left for the next look.
    fn read_records(&mut self, view: &FolderView) -> usize {
        let begin = Instant::now();
        let present: BTreeSet<&String> = view.keys.iter().collect();
        self.records.retain(|key, _| present.contains(key));
        self.frames.retain(|key, _| present.contains(key));
        let folder = self.path.join("runs");
        let mut new: Vec<(Stamp, &String)> = Vec::new();
        for key in &view.keys {
            let known = self.records.get(key);
            if matches!(known, Some(Seen::Run(_))) {
                continue;
            }
            let Some(stamp) = record_path(&folder, key).and_then(|path| stamp_of(&path)) else {
                continue;
            };
            if !matches!(known, Some(Seen::Damaged(before, _)) if *before == stamp) {
                new.push((stamp, key));
            }
        }
        new.sort_unstable_by(|a, b| b.cmp(a));
        let mut left = new.len();
        for (stamp, key) in new {
            if begin.elapsed() > READING_TIME {
                break;
            }
            left -= 1;
            let seen = match read_record(&folder, key) {
                Ok(record) => {
                    if let Some(frame) = frame_of(&record) {
                        self.frames.insert(key.clone(), frame);
                    }
                    Seen::Run(Run {
                        finished: stamp.0,
                        seed: record.seed(),
                        observables: record.observables().clone(),
                        regime: record.regime().map(str::to_owned),
                    })
                }
                Err(why) => Seen::Damaged(stamp, why),
            };
            self.records.insert(key.clone(), seen);
            self.drop_old_frames();
        }
        left
    }

    /// Keeps the latest frames.
    fn drop_old_frames(&mut self) {
        let latest: BTreeSet<String> = self
            .latest_frames()
            .into_iter()
            .map(str::to_owned)
            .collect();
        self.frames.retain(|key, _| latest.contains(key));
    }

    /// Keys of the latest runs with a frame, the latest first.
    fn latest_frames(&self) -> Vec<&str> {
        let end = |key: &String| match self.records.get_key_value(key) {
            Some((key, Seen::Run(run))) => Some(self.end(key, run)),
            _ => None,
        };
        let mut ends: Vec<_> = self.frames.keys().filter_map(end).collect();
        ends.sort_unstable_by(|a, b| b.cmp(a));
        let latest = ends.into_iter().take(MOST_FRAMES);
        latest.map(|(.., key)| key).collect()
    }

    /// Puts together what was read.
    fn snapshot(
        &self,
        state: Option<(CampaignState, Duration)>,
        view: &FolderView,
        unread: usize,
        problems: Vec<String>,
    ) -> Snapshot<'_> {
        let mut requests: BTreeMap<&str, &RunRequest> = BTreeMap::new();
        let mut done_by_stage: BTreeMap<&str, usize> = BTreeMap::new();
        let mut counted: BTreeSet<&str> = BTreeSet::new();
        let is_there = |key: &String| view.keys.binary_search(key).is_ok();
        for (_, list) in self.lists.values() {
            for planned in &list.runs {
                requests.insert(&planned.key, &planned.request);
                if is_there(&planned.key) && counted.insert(&planned.key) {
                    *done_by_stage.entry(&list.stage).or_default() += 1;
                }
            }
        }
        let told = state.as_ref().map(|(state, _)| state);
        let list = told.and_then(|told| self.lists.get(&told.lists));
        let keys = || {
            list.iter()
                .flat_map(|(_, list)| &list.runs)
                .map(|run| &run.key)
        };
        let is_claimed = |key: &&String| view.claimed.binary_search(key).is_ok() && !is_there(key);
        let mut runs: Vec<AskedRun<'_>> = self
            .records
            .iter()
            .filter_map(|(key, seen)| match seen {
                Seen::Run(run) => Some(AskedRun {
                    key,
                    request: requests.get(key.as_str()).copied(),
                    run,
                }),
                Seen::Damaged(..) => None,
            })
            .collect();
        runs.sort_by_key(|asked| self.end(asked.key, asked.run));
        Snapshot {
            path: &self.path,
            is_used: view.is_used,
            list: Counts {
                all: told.map_or(0, |told| told.runs),
                done: keys().filter(|key| is_there(key)).count(),
                running: keys().filter(is_claimed).count(),
                failed: told.map_or(0, |told| told.failed),
            },
            state,
            done_by_stage,
            records: view.keys.len(),
            unread,
            runs,
            frames: self.latest_frames(),
            problems,
        }
    }
}

/// The time and the length of a file; none where it is gone.
fn stamp_of(path: &Path) -> Option<Stamp> {
    let data = path.symlink_metadata().ok()?;
    let time = data.modified().ok()?.duration_since(UNIX_EPOCH);
    Some((time.unwrap_or_default(), data.len()))
}

/// The last frame of a run, where it is a PNG file of a plausible size.
fn frame_of(record: &Record) -> Option<Vec<u8>> {
    let text = record.details().get("last_frame_png_base64")?.as_str()?;
    let bytes = STANDARD.decode(text).ok()?;
    (bytes.starts_with(&PNG) && bytes.len() <= LARGEST_FRAME).then_some(bytes)
}
