//! The ledger: what was submitted, so that another process finds it again.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::path::{Path, PathBuf};

use crate::files::write_json;
use crate::{Error, JobId, LossReason};

/// How the names of all jobs begin.
pub(crate) const NAME_PREFIX: &str = "seedloop-";

/// Version of the form of the ledger.
const SCHEMA: u32 = 1;

/// What was submitted from a folder and is not settled yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Content {
    /// Form of the ledger.
    schema: u32,
    /// Word by which the names of its jobs differ from those of other folders.
    pub(crate) word: String,
    /// Number of the next array.
    pub(crate) next: u64,
    /// Arrays with tasks that are not settled.
    pub(crate) arrays: Vec<Array>,
    /// Runs that were lost and have no record yet, by key.
    pub(crate) losses: BTreeMap<String, Loss>,
    /// Cost of the runs that workers measured.
    pub(crate) measured_cost: f64,
    /// Time that those took, s.
    pub(crate) measured_s: f64,
}

/// An array of tasks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Array {
    /// Name of its job.
    pub(crate) name: String,
    /// How far its submission came.
    pub(crate) submission: Submission,
    /// Its tasks that are not settled.
    pub(crate) tasks: Vec<OpenTask>,
}

/// How far a submission came.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Submission {
    /// It is meant; whether it took place is not known.
    Meant,
    /// It took place, and the system gave this id.
    Known(JobId),
    /// It took place, as signs of life show; its id was lost.
    Unnamed,
}

/// A task that may still run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpenTask {
    /// Place in its array.
    pub(crate) index: usize,
    /// Keys of its runs, in the order in which they are done.
    pub(crate) keys: Vec<String>,
}

/// How often a run was lost.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Loss {
    /// Number of times.
    pub(crate) count: u32,
    /// Why, the last time.
    pub(crate) reason: LossReason,
    /// By what the time limit is multiplied at the next try.
    pub(crate) time_factor: u64,
    /// By what the memory is multiplied at the next try.
    pub(crate) memory_factor: u64,
    /// Log of the last try.
    pub(crate) log: PathBuf,
}

/// The ledger and its file.
#[derive(Debug)]
pub(crate) struct Ledger {
    /// The file.
    path: PathBuf,
    /// What it holds.
    pub(crate) content: Content,
}

impl Ledger {
    /// Reads the ledger of a folder, or begins one.
    ///
    /// # Errors
    ///
    /// [`Error::LedgerDamaged`], [`Error::OtherSchema`] or [`Error::Io`] when it is there and cannot be used.
    pub(crate) fn open(folder: &Path) -> Result<Self, Error> {
        let path = folder.join("ledger.json");
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let content = Content {
                    schema: SCHEMA,
                    word: fresh_word(),
                    next: 0,
                    arrays: Vec::new(),
                    losses: BTreeMap::new(),
                    measured_cost: 0.0,
                    measured_s: 0.0,
                };
                return Ok(Self { path, content });
            }
            Err(error) => return Err(crate::error::io("read", &path)(error)),
        };
        let damaged = |reason: serde_json::Error| Error::LedgerDamaged {
            path: path.clone(),
            reason: reason.to_string(),
            prefix: NAME_PREFIX,
        };
        let value: serde_json::Value = serde_json::from_slice(&bytes).map_err(damaged)?;
        match value.get("schema").and_then(serde_json::Value::as_u64) {
            Some(found) if found != u64::from(SCHEMA) => Err(Error::OtherSchema {
                path: path.clone(),
                found: u32::try_from(found).unwrap_or(u32::MAX),
                expected: SCHEMA,
            }),
            _ => {
                let content = serde_json::from_value(value).map_err(damaged)?;
                Ok(Self { path, content })
            }
        }
    }

    /// Puts the ledger on the disk.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the disk refuses; the file then is as before.
    pub(crate) fn save(&self) -> Result<(), Error> {
        write_json(&self.path, &self.content)
    }

    /// A name that no array has had.
    pub(crate) fn next_name(&mut self) -> String {
        let number = self.content.next;
        self.content.next += 1;
        format!("{NAME_PREFIX}{}-{number}", self.content.word)
    }

    /// Takes a task out, and its array with the last of them.
    pub(crate) fn settle(&mut self, array: &str, index: usize) {
        for other in &mut self.content.arrays {
            if other.name == array {
                other.tasks.retain(|task| task.index != index);
            }
        }
        self.content.arrays.retain(|array| !array.tasks.is_empty());
    }

    /// Mean time of a run of cost 1 that workers measured, s.
    pub(crate) fn seconds_per_cost(&self) -> Option<f64> {
        let pace = self.content.measured_s / self.content.measured_cost;
        (pace.is_finite() && pace > 0.0).then_some(pace)
    }
}

impl Loss {
    /// A run that was never lost.
    pub(crate) fn none(reason: LossReason) -> Self {
        Self {
            count: 0,
            reason,
            time_factor: 1,
            memory_factor: 1,
            log: PathBuf::new(),
        }
    }

    /// Counts a loss, and gives the next try more of what was short.
    pub(crate) fn add(&mut self, reason: LossReason, log: &Path) {
        self.count += 1;
        self.reason = reason;
        log.clone_into(&mut self.log);
        match reason {
            LossReason::TimeOut => self.time_factor = self.time_factor.saturating_mul(2),
            LossReason::OutOfMemory => self.memory_factor = self.memory_factor.saturating_mul(2),
            _ => {}
        }
    }
}

/// A word that no other folder has: names must differ, and no result depends on them.
fn fresh_word() -> String {
    format!("{:08x}", RandomState::new().build_hasher().finish() >> 32)
}

#[cfg(test)]
mod tests {
    use super::{Array, Ledger, OpenTask, Submission};
    use crate::{Error, JobId};

    #[test]
    fn a_ledger_is_read_as_it_was_written_and_names_are_never_given_twice() {
        let folder = tempfile::tempdir().unwrap();
        let mut ledger = Ledger::open(folder.path()).unwrap();
        let name = ledger.next_name();
        ledger.content.arrays.push(Array {
            name: name.clone(),
            submission: Submission::Known(JobId("7".into())),
            tasks: vec![OpenTask {
                index: 3,
                keys: vec!["k".into()],
            }],
        });
        ledger.save().unwrap();
        let mut again = Ledger::open(folder.path()).unwrap();
        assert_eq!(again.content, ledger.content);
        assert_ne!(again.next_name(), name);
        again.settle(&name, 3);
        assert!(again.content.arrays.is_empty());
        let other = tempfile::tempdir().unwrap();
        let other = Ledger::open(other.path()).unwrap();
        assert_ne!(other.content.word, again.content.word);
    }

    #[test]
    fn a_damaged_ledger_is_told_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ledger.json");
        for text in ["{\"schema\": 1, \"word\": \"ab", "{}", ""] {
            std::fs::write(&path, text).unwrap();
            let error = Ledger::open(folder.path()).unwrap_err().to_string();
            assert!(error.contains("ledger.json"), "{error}");
            assert!(error.contains("delete the file"), "{error}");
        }
        std::fs::write(&path, "{\"schema\": 99}").unwrap();
        let error = Ledger::open(folder.path()).unwrap_err();
        assert!(
            matches!(error, Error::OtherSchema { found: 99, .. }),
            "{error}"
        );
    }
}
