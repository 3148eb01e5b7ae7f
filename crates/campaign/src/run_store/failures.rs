//! Notes of runs that gave no record. Without them each process that shares a folder would repeat a run that fails.

use std::fs::OpenOptions;
use std::path::Path;
use std::sync::PoisonError;
use std::time::Duration;

use crate::run_store::folder::{Folder, modified, open_plain};
use crate::run_store::names;

/// Most bytes of a note that are read.
const LONGEST_NOTE: u64 = 4096;

impl Folder {
    /// Remembers a note that an earlier campaign left: its run may be tried again. Removes it if the run has a record since.
    pub(crate) fn know_failure(&self, key: &str) {
        let path = names::failure(&self.path, key);
        if names::record(&self.path, key).exists() {
            let _ = self.disk.remove(&path);
        } else if let Some((_, time)) = read(&path) {
            self.remember(key, time);
        }
    }

    /// Leaves a note of why a run gave no record. A note that cannot be written costs others a run, and no result.
    pub(crate) fn note_failure(&self, key: &str, reason: &str) {
        let path = names::failure(&self.path, key);
        let _ = self.disk.remove(&path);
        let host = &self.machine.host;
        let text = format!("process {} on {host}: {reason}", std::process::id());
        if let Ok(mut file) = self.disk.create(&path)
            && self.disk.write(&mut file, text.as_bytes()).is_ok()
            && let Ok(time) = modified(&file)
        {
            self.remember(key, time);
        }
    }

    /// The note on a run that another process has left since this store was opened.
    pub(crate) fn failure(&self, key: &str) -> Option<String> {
        let (text, time) = read(&names::failure(&self.path, key))?;
        let known = self.failures.lock().unwrap_or_else(PoisonError::into_inner);
        (known.get(key) != Some(&time)).then_some(text)
    }

    /// Remembers a note that is already known.
    fn remember(&self, key: &str, time: Duration) {
        let mut known = self.failures.lock().unwrap_or_else(PoisonError::into_inner);
        known.insert(key.to_owned(), time);
    }
}

/// Text and time of a note; `None` without a readable one.
fn read(path: &Path) -> Option<(String, Duration)> {
    use std::io::Read as _;

    let file = open_plain(path, OpenOptions::new().read(true)).ok()?;
    let time = modified(&file).ok()?;
    let mut bytes = Vec::new();
    file.take(LONGEST_NOTE).read_to_end(&mut bytes).ok()?;
    Some((String::from_utf8_lossy(&bytes).into_owned(), time))
}
