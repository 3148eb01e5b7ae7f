//! The folder of records: look-up, and complete writes.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::run_store::disk::Disk;
use crate::run_store::error::io;
use crate::run_store::folder::Folder;
use crate::run_store::set_aside::set_aside;
use crate::run_store::{Attempt, Error, Record, names, record_file};

/// Number of attempts to read a record that another machine replaces meanwhile.
const READ_ATTEMPTS: usize = 4;

/// A folder of records, safe to share between threads, processes and machines; or records in memory alone.
#[derive(Debug, Clone)]
pub struct Store {
    /// Where the records are.
    place: Place,
}

/// Where records are kept.
#[derive(Debug, Clone)]
enum Place {
    /// One file each in a folder.
    Folder(Arc<Folder>),
    /// In the memory of this process, by key.
    Memory(Arc<Mutex<BTreeMap<String, Record>>>),
}

/// Content of a store under a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Lookup {
    /// The record of the run.
    Found(Record),
    /// No record: the run is still to be done.
    Absent,
    /// A file with this name is not the record of the run: damaged, altered, renamed, of another schema,
    /// or not a file at all. Report it to the user and set it aside ([`Store::set_aside`]); the run is still to be done.
    Damaged {
        /// The file.
        path: PathBuf,
        /// Its fault.
        reason: String,
    },
}

impl Store {
    /// Opens the store in a folder, makes the folder if it is missing, and removes the temporary files of
    /// killed writers.
    ///
    /// A writer holds a lock on its temporary file, so the files of living writers stay. Those of other machines
    /// stay for a day, by the clock of the file system.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be made or read.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_on(folder, Disk::default())
    }

    /// [`Store::open`] on a disk that may have a fault. For tests.
    ///
    /// # Errors
    ///
    /// As [`Store::open`].
    pub fn open_on(folder: impl AsRef<Path>, disk: Disk) -> Result<Self, Error> {
        Ok(Self {
            place: Place::Folder(Arc::new(Folder::open(folder.as_ref(), disk)?)),
        })
    }

    /// Operations of the disk so far; `None` for a store in memory.
    pub fn operations(&self) -> Option<u64> {
        self.shared_folder().map(|folder| folder.disk.operations())
    }

    /// A store in memory: for simulators so cheap that a file would cost more than a run, such as those in closed form.
    pub fn in_memory() -> Self {
        Self {
            place: Place::Memory(Arc::default()),
        }
    }

    /// The folder of the store; `None` for a store in memory.
    pub fn folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Folder(folder) => Some(&folder.path),
            Place::Memory(_) => None,
        }
    }

    /// The folder of the store with its claims; `None` for a store in memory.
    pub(crate) fn shared_folder(&self) -> Option<&Arc<Folder>> {
        match &self.place {
            Place::Folder(folder) => Some(folder),
            Place::Memory(_) => None,
        }
    }

    /// Looks up the record of a key.
    ///
    /// # Errors
    ///
    /// [`Error::BadKey`] if this is not a key; [`Error::Io`] when the system cannot read what is there.
    pub fn get(&self, key: &str) -> Result<Lookup, Error> {
        check_key(key)?;
        let folder = match &self.place {
            Place::Folder(folder) => folder,
            Place::Memory(records) => {
                let found = lock(records).get(key).cloned();
                return Ok(found.map_or(Lookup::Absent, Lookup::Found));
            }
        };
        let path = names::record(&folder.path, key);
        let damaged = |reason| Lookup::Damaged {
            path: path.clone(),
            reason,
        };
        let mut attempt = 1;
        let bytes = loop {
            match read(&folder.disk, &path) {
                Ok(Some(bytes)) => break bytes,
                Ok(None) => return Ok(damaged("it is not a file".to_owned())),
                Err(why) if path.is_symlink() => return Ok(damaged(why.to_string())),
                Err(why) if why.kind() == ErrorKind::NotFound => return Ok(Lookup::Absent),
                Err(why)
                    if why.kind() == ErrorKind::StaleNetworkFileHandle
                        && attempt < READ_ATTEMPTS =>
                {
                    attempt += 1;
                }
                Err(why) => return Err(io("read", &path)(why)),
            }
        };
        Ok(record_file::from_bytes(&bytes, key).map_or_else(damaged, Lookup::Found))
    }

    /// Writes a record to a temporary file, forces it to the disk, then renames it.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the disk refuses; the store then is as before.
    pub fn put(&self, record: &Record) -> Result<(), Error> {
        match &self.place {
            Place::Folder(folder) => folder.write(&record.key, &record_file::to_bytes(record)?),
            Place::Memory(records) => {
                lock(records).insert(record.key.clone(), record.clone());
                Ok(())
            }
        }
    }

    /// Renames a file that is not the record of its name to a name that no reader reads as a record, `KEY.json.damaged`
    /// or the first of `KEY.json.damaged-2`, `-3`, ... that is free. Nothing is overwritten, and a link is renamed, not
    /// followed.
    ///
    /// Returns the new name; `None` if the file is gone, or if another process has replaced it by the record of the
    /// name meanwhile.
    ///
    /// # Errors
    ///
    /// [`Error::Foreign`] when the path is not that of a record of this store; [`Error::Io`] when it cannot be renamed.
    pub fn set_aside(&self, path: &Path) -> Result<Option<PathBuf>, Error> {
        let is_own = self.folder().is_some() && path.parent() == self.folder();
        match names::key_of(path).filter(|_| is_own) {
            Some(key) => set_aside(path, key),
            None => Err(Error::Foreign {
                path: path.to_owned(),
            }),
        }
    }

    /// Tries to claim a run, so that other processes of the folder leave it to this one. The owner renews the claim
    /// several times in its `life`; a claim that was not renewed for this time, or whose process on this machine has ended,
    /// is dead and taken over.
    ///
    /// The new owner looks up the record again: the last owner may have finished just before.
    ///
    /// # Errors
    ///
    /// [`Error::BadKey`] if this is not a key; [`Error::Io`] when the folder takes no claims.
    pub fn claim(&self, key: &str, life: Duration) -> Result<Attempt, Error> {
        check_key(key)?;
        match &self.place {
            Place::Folder(folder) => folder.claim(key, life),
            Place::Memory(_) => Ok(Attempt::NotNeeded),
        }
    }

    /// Leaves a note of why a run gave no record, so that processes that wait for it do not repeat it.
    pub(crate) fn note_failure(&self, key: &str, reason: &str) {
        if let Place::Folder(folder) = &self.place {
            folder.note_failure(key, reason);
        }
    }

    /// Why another process gave up a run since this store was opened; `None` if none did.
    pub(crate) fn failure(&self, key: &str) -> Option<String> {
        match &self.place {
            Place::Folder(folder) => folder.failure(key),
            Place::Memory(_) => None,
        }
    }

    /// Lists the keys of all record files, sorted, without hidden files and those set aside.
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
        for path in folder.paths()? {
            match names::key_of(&path) {
                Some(key) => keys.push(key.to_owned()),
                None if names::is_beside_records(&path) => {}
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

/// Refuses a text without the form of a key.
fn check_key(key: &str) -> Result<(), Error> {
    if names::is_key(key) {
        return Ok(());
    }
    Err(Error::BadKey {
        key: key.to_owned(),
    })
}

/// Reads a file; `None` if the path is something else.
fn read(disk: &Disk, path: &Path) -> std::io::Result<Option<Vec<u8>>> {
    if std::fs::metadata(path)?.is_file() {
        let mut file = std::fs::File::open(path)?;
        return disk.read(&mut file, u64::MAX).map(Some);
    }
    Ok(None)
}
