//! Looking into a folder of records that others write, without touching it.
//!
//! Nothing is made, locked, renamed or removed: who looks is not seen by who works.

use std::fs::{File, OpenOptions};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::run_store::error::io;
use crate::run_store::folder::open_plain;
use crate::run_store::owner::folder_key;
use crate::run_store::{CLAIM_LIFE, Error, Record, names, record_file};

/// Largest record that is looked at, bytes: a record of a drum has a fifth of a megabyte. Our choice.
const LARGEST_RECORD: u64 = 64 << 20;

/// What lies in a folder of records.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FolderView {
    /// Keys of all record files, sound or not, sorted.
    pub keys: Vec<String>,
    /// Names of the records that were set aside, sorted.
    pub set_aside: Vec<String>,
    /// Keys of the runs that someone does at present, sorted: claims renewed within [`CLAIM_LIFE`] by the clock of this
    /// machine.
    pub claimed: Vec<String>,
    /// Whether someone works in the folder: holds it, or a run in it.
    pub is_used: bool,
}

impl FolderView {
    /// Lists a folder.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when it cannot be listed.
    pub fn of(folder: &Path) -> Result<Self, Error> {
        let problem = io("list", folder);
        let mut view = Self::default();
        for entry in std::fs::read_dir(folder).map_err(&problem)? {
            let path = entry.map_err(&problem)?.path();
            if let Some(key) = names::key_of(&path) {
                view.keys.push(key.to_owned());
            } else if let Some(key) = names::claimed_key_of(&path) {
                if !is_alive(&path) {
                    continue;
                }
                view.is_used = true;
                if key != folder_key() {
                    view.claimed.push(key.to_owned());
                }
            } else if let Some(name) = names::damaged_name(&path) {
                view.set_aside.push(name.to_owned());
            }
        }
        view.keys.sort_unstable();
        view.set_aside.sort_unstable();
        view.claimed.sort_unstable();
        Ok(view)
    }
}

/// The file of the record of a key in a folder; none where this is no key.
pub fn record_path(folder: &Path, key: &str) -> Option<PathBuf> {
    names::is_key(key).then(|| names::record(folder, key))
}

/// Reads the record of a key in a folder.
///
/// # Errors
///
/// Why there is none, as the rest of a sentence about the file: no plain file, too large, damaged, altered or renamed.
pub fn read_record(folder: &Path, key: &str) -> Result<Record, String> {
    let path = record_path(folder, key).ok_or_else(|| "its name is no key".to_owned())?;
    let file = open_plain(&path, OpenOptions::new().read(true)).map_err(|why| why.to_string())?;
    record_file::from_bytes(&read_at_most(file)?, key)
}

/// Reads a file that is not too large.
fn read_at_most(file: File) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let most = LARGEST_RECORD + 1;
    let read = file.take(most).read_to_end(&mut bytes);
    read.map_err(|why| why.to_string())?;
    if bytes.len() as u64 > LARGEST_RECORD {
        return Err(format!("it has more than {LARGEST_RECORD} bytes"));
    }
    Ok(bytes)
}

/// Whether a claim was renewed within its life. One that seems to come from the future is of a file server whose clock is ahead.
fn is_alive(claim: &Path) -> bool {
    let Ok(modified) = claim.symlink_metadata().and_then(|data| data.modified()) else {
        return false;
    };
    modified.elapsed().unwrap_or(Duration::ZERO) < CLAIM_LIFE
}

#[cfg(test)]
mod tests {
    use super::{FolderView, read_record};
    use crate::run_store::{Attempt, CLAIM_LIFE, Entry, Record, Store};
    use std::fs::{self, File};

    /// A claim on a run is told apart from that on the folder; an old one and what was set aside are no runs in progress; and
    /// the folder has the same files with the same times afterwards.
    #[test]
    fn looking_tells_what_is_there_and_changes_nothing() {
        let place = tempfile::tempdir().unwrap();
        let store = Store::open(place.path()).unwrap();
        let record = |seed| Record::new("1", serde_json::json!({"x": 1.5}), seed).unwrap();
        for seed in [1, 2, 3] {
            store.put(&record(seed)).unwrap();
        }
        let file = |seed| place.path().join(format!("{}.json", record(seed).key()));
        fs::write(file(2), "{\"schema\"").unwrap();
        store.set_aside(&file(2)).unwrap();
        fs::write(file(3), "{\"schema\"").unwrap();
        let Entry::Ours(_owner) = store.enter("work").unwrap() else {
            panic!("nobody else is there");
        };
        let (living, dead) = ("4".repeat(64), "5".repeat(64));
        let claims = [&living, &dead].map(|key| store.claim(key, CLAIM_LIFE).unwrap());
        assert!(claims.iter().all(|c| matches!(c, Attempt::Won(_))));
        let old = File::options()
            .write(true)
            .open(place.path().join(format!(".{dead}.claim")))
            .unwrap();
        let time = old.metadata().unwrap().modified().unwrap();
        old.set_modified(time - CLAIM_LIFE).unwrap();
        let all = || {
            let entries = fs::read_dir(place.path()).unwrap().map(|e| e.unwrap());
            let mut all: Vec<_> = entries
                .map(|e| (e.file_name(), e.metadata().unwrap().modified().unwrap()))
                .collect();
            all.sort();
            all
        };
        let before = all();
        let view = FolderView::of(place.path()).unwrap();
        let mut keys = [record(1).key().to_owned(), record(3).key().to_owned()];
        keys.sort();
        assert_eq!(view.keys, keys);
        let aside = format!("{}.json.damaged", record(2).key());
        assert_eq!(view.set_aside, [aside]);
        assert_eq!(view.claimed, [living]);
        assert!(view.is_used);
        assert_eq!(read_record(place.path(), record(1).key()), Ok(record(1)));
        assert!(read_record(place.path(), record(3).key()).is_err());
        assert!(read_record(place.path(), "../../etc/passwd").is_err());
        assert_eq!(all(), before);
    }

    #[test]
    fn a_folder_that_nobody_uses_is_told_from_one_in_use() {
        let place = tempfile::tempdir().unwrap();
        assert_eq!(FolderView::of(place.path()).unwrap(), FolderView::default());
        assert!(FolderView::of(&place.path().join("none")).is_err());
    }
}
