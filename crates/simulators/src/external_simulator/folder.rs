//! The folder of a run: made fresh, removed after success, kept after failure.

use crate::external_simulator::process::Failure;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Which folders of runs are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Keep {
    /// Those of runs that failed.
    #[default]
    Failed,
    /// All.
    All,
}

/// Digits of a key that name a folder.
const DIGITS: usize = 16;

/// The folder of one attempt at a run.
#[derive(Debug)]
pub(crate) struct RunFolder {
    /// The folder.
    pub(crate) path: PathBuf,
    /// Whether it stays after success.
    keep: Keep,
}

impl RunFolder {
    /// Makes the folder of the next attempt: `KEY-1`, `KEY-2` and so on, with the first digits of the key. What an earlier
    /// attempt left stays.
    pub(crate) fn make(work: &Path, key: &str, keep: Keep) -> Result<Self, Failure> {
        let told = |path: &Path, error: std::io::Error| {
            format!("cannot make the folder {}: {error}", path.display())
        };
        fs::create_dir_all(work).map_err(|error| told(work, error))?;
        // Commands run elsewhere than here: their folder must be found from there.
        let work = work.canonicalize().map_err(|error| told(work, error))?;
        let short = key.get(..DIGITS).unwrap_or(key);
        for attempt in 1.. {
            let path = work.join(format!("{short}-{attempt}"));
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path, keep }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(told(&path, error)),
            }
        }
        Err("no folder is free".into())
    }

    /// The run succeeded: removes the folder unless it is to stay.
    pub(crate) fn succeeded(self) {
        if self.keep == Keep::Failed {
            // A folder that cannot be removed does not cost its run.
            let _ = fs::remove_dir_all(&self.path);
        }
    }

    /// The run was stopped: nothing in its folder is of use.
    pub(crate) fn stopped(self) {
        let _ = fs::remove_dir_all(&self.path);
    }

    /// A failure with the folder in which its log and files are.
    pub(crate) fn failed(&self, failure: &str) -> Failure {
        format!(
            "{failure}\n(the files of the run are in {})",
            self.path.display()
        )
    }
}
