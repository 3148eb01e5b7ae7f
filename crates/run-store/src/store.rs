//! The folder of records: looking up, and writing whole or not at all.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::{Error, Record, SCHEMA, run_key};

/// Ending of a record file.
const RECORD_ENDING: &str = ".json";
/// Ending of a file that is being written.
const ASIDE_ENDING: &str = ".aside";
/// How often a write starts again after its aside file was swept away under it.
const WRITE_ATTEMPTS: usize = 8;

/// Numbers the aside files of this process.
static ASIDE_NUMBER: AtomicU64 = AtomicU64::new(0);

/// A folder of records, safe to share between threads and processes; or records in memory alone.
#[derive(Debug, Clone)]
pub struct Store {
    /// Where the records are.
    place: Place,
}

/// Where records are kept.
#[derive(Debug, Clone)]
enum Place {
    /// One file each in a folder.
    Folder(PathBuf),
    /// In this process, by key; gone with it.
    Memory(Arc<Mutex<BTreeMap<String, Record>>>),
}

/// What a store has under a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Lookup {
    /// The record of the run.
    Found(Record),
    /// No record: the run is still to be done.
    Absent,
    /// A file is there, but its content has another key (renamed or edited): do the run again,
    /// its record will replace the file. A warning for the user.
    Mismatch {
        /// The file.
        path: PathBuf,
        /// Key that its content has.
        content_key: String,
    },
}

impl Store {
    /// Opens the store in a folder, makes the folder where it is missing, and sweeps away what
    /// killed writers left.
    ///
    /// A writer holds a lock on its aside file, so that the aside files of living writers stay.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be made or read.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, Error> {
        let folder = folder.as_ref().to_owned();
        std::fs::create_dir_all(&folder).map_err(io("make folder", &folder))?;
        for path in paths(&folder)? {
            if is_aside(&path) {
                sweep(&path);
            }
        }
        Ok(Self {
            place: Place::Folder(folder),
        })
    }

    /// A store in memory: for simulators so cheap that a file would cost more than a run, such as those in closed form.
    pub fn in_memory() -> Self {
        Self {
            place: Place::Memory(Arc::default()),
        }
    }

    /// The folder of the store; none of one in memory.
    pub fn folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Folder(folder) => Some(folder),
            Place::Memory(_) => None,
        }
    }

    /// Looks up the record of a key.
    ///
    /// # Errors
    ///
    /// [`Error::BadKey`] when this is no key; [`Error::Damaged`] or [`Error::OtherSchema`], with
    /// the file, when the file under the key is no record; [`Error::Io`] when it cannot be read.
    pub fn get(&self, key: &str) -> Result<Lookup, Error> {
        if !is_key(key) {
            return Err(Error::BadKey {
                key: key.to_owned(),
            });
        }
        let folder = match &self.place {
            Place::Folder(folder) => folder,
            Place::Memory(records) => {
                let found = lock(records).get(key).cloned();
                return Ok(found.map_or(Lookup::Absent, Lookup::Found));
            }
        };
        let path = path_of(folder, key);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Lookup::Absent),
            Err(error) => return Err(io("read", &path)(error)),
        };
        let record = parse(&bytes, &path)?;
        let content_key = run_key(&record.version, &record.inputs, record.seed).map_err(|why| {
            Error::Damaged {
                path: path.clone(),
                reason: why.to_string(),
            }
        })?;
        if content_key == key && record.key == key {
            Ok(Lookup::Found(record))
        } else {
            Ok(Lookup::Mismatch { path, content_key })
        }
    }

    /// Writes a record: aside, forced to the disk, then renamed over its name.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the disk refuses; the store then is as before.
    pub fn put(&self, record: &Record) -> Result<(), Error> {
        let folder = match &self.place {
            Place::Folder(folder) => folder,
            Place::Memory(records) => {
                lock(records).insert(record.key.clone(), record.clone());
                return Ok(());
            }
        };
        let mut bytes = serde_json::to_vec_pretty(record).map_err(|source| Error::Unwritable {
            key: record.key.clone(),
            source,
        })?;
        bytes.push(b'\n');
        let target = path_of(folder, &record.key);
        let mut attempt = 1;
        loop {
            match write_once(folder, &record.key, &bytes, &target) {
                // Another process that opened the store met the aside file before its lock.
                Err(Error::Io { source, .. })
                    if source.kind() == ErrorKind::NotFound && attempt < WRITE_ATTEMPTS =>
                {
                    attempt += 1;
                }
                outcome => return outcome,
            }
        }
    }

    /// Lists the keys of all records, sorted.
    ///
    /// # Errors
    ///
    /// [`Error::Foreign`] when the folder holds a file that no store wrote; [`Error::Io`] when it
    /// cannot be read.
    pub fn keys(&self) -> Result<Vec<String>, Error> {
        let folder = match &self.place {
            Place::Folder(folder) => folder,
            Place::Memory(records) => return Ok(lock(records).keys().cloned().collect()),
        };
        let mut keys = Vec::new();
        for path in paths(folder)? {
            if is_aside(&path) {
                continue;
            }
            match key_of(&path) {
                Some(key) => keys.push(key),
                None => return Err(Error::Foreign { path }),
            }
        }
        keys.sort_unstable();
        Ok(keys)
    }
}

/// The records of a store in memory; a thread that panicked left them whole.
fn lock(records: &Mutex<BTreeMap<String, Record>>) -> MutexGuard<'_, BTreeMap<String, Record>> {
    records.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The file of a key.
fn path_of(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("{key}{RECORD_ENDING}"))
}

/// All entries of a folder.
fn paths(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let problem = io("list", folder);
    let entries = std::fs::read_dir(folder).map_err(&problem)?;
    entries
        .map(|entry| entry.map(|e| e.path()).map_err(&problem))
        .collect()
}

/// Writes aside and renames, once.
fn write_once(folder: &Path, key: &str, bytes: &[u8], target: &Path) -> Result<(), Error> {
    let number = ASIDE_NUMBER.fetch_add(1, Ordering::Relaxed);
    let process = std::process::id();
    let aside = folder.join(format!(".{key}.{process}.{number}{ASIDE_ENDING}"));
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&aside)
        .map_err(io("create", &aside))?;
    // Where locks are not supported nobody can sweep the file either.
    let _ = file.lock();
    let written = file
        .write_all(bytes)
        .and_then(|()| file.sync_all())
        .map_err(io("write", &aside))
        .and_then(|()| std::fs::rename(&aside, target).map_err(io("rename", &aside)));
    if written.is_err() {
        let _ = std::fs::remove_file(&aside);
        return written;
    }
    // The name is safe once the folder is on the disk; some systems cannot force a folder.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Reads the bytes of a record file.
fn parse(bytes: &[u8], path: &Path) -> Result<Record, Error> {
    let damaged = |reason: serde_json::Error| Error::Damaged {
        path: path.to_owned(),
        reason: reason.to_string(),
    };
    let value: serde_json::Value = serde_json::from_slice(bytes).map_err(damaged)?;
    match value.get("schema").and_then(serde_json::Value::as_u64) {
        Some(found) if found != u64::from(SCHEMA) => Err(Error::OtherSchema {
            path: path.to_owned(),
            found: u32::try_from(found).unwrap_or(u32::MAX),
            expected: SCHEMA,
        }),
        _ => serde_json::from_value(value).map_err(damaged),
    }
}

/// Removes the aside file of a writer that lives no more.
fn sweep(path: &Path) {
    let Ok(file) = OpenOptions::new().write(true).open(path) else {
        return;
    };
    match file.try_lock() {
        // A failure leaves a hidden file behind, which no reader minds.
        Ok(()) => drop(std::fs::remove_file(path)),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
    }
}

/// Whether the file is one that a writer works on.
fn is_aside(path: &Path) -> bool {
    path.file_name()
        .and_then(|name| name.to_str())
        .is_some_and(|name| name.starts_with('.') && name.ends_with(ASIDE_ENDING))
}

/// The key in the name of a record file.
fn key_of(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let key = name.strip_suffix(RECORD_ENDING)?;
    is_key(key).then(|| key.to_owned())
}

/// Whether a text has the form of a key.
fn is_key(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

/// Makes an error of a failed operation on a path.
fn io(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Io {
        action,
        path: path.clone(),
        source,
    }
}
