//! The folder of a store: its files, its clock, and the temporary files of dead writers.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, UNIX_EPOCH};

use crate::run_store::disk::Disk;
use crate::run_store::error::io;
use crate::run_store::machine::{Machine, has_ended};
use crate::run_store::{Error, names};

/// Number of new attempts of a write whose temporary file was removed.
const WRITE_ATTEMPTS: usize = 8;
/// Time for which the last reading of the file system's clock is used.
const CLOCK_LIFE: Duration = Duration::from_secs(1);
/// Age from which on files left by another machine are removed; chosen far above the time of any write.
const FOREIGN_AGE: Duration = Duration::from_hours(24);

/// Counter of the temporary files of this process.
static ASIDE_NUMBER: AtomicU64 = AtomicU64::new(0);

/// A folder that many processes on many machines may share.
#[derive(Debug)]
pub(crate) struct Folder {
    /// Where it is.
    pub(crate) path: PathBuf,
    pub(crate) machine: Machine,
    /// The disk that writes its files.
    pub(crate) disk: Disk,
    /// Known notes on failed runs, by key: the time of those found at the opening, and of own ones.
    pub(crate) failures: Mutex<BTreeMap<String, Duration>>,
    /// Last look at the clock of the file system: its time, and when the look was.
    clock: Mutex<Option<(Duration, Instant)>>,
}

impl Folder {
    /// Makes the folder if it is missing, and removes the temporary files of dead writers.
    pub(crate) fn open(path: &Path, disk: Disk) -> Result<Self, Error> {
        std::fs::create_dir_all(path).map_err(io("make folder", path))?;
        let folder = Self {
            path: path.to_owned(),
            disk,
            machine: Machine::this(),
            failures: Mutex::default(),
            clock: Mutex::default(),
        };
        for path in folder.paths()? {
            if names::is_aside(&path) {
                folder.sweep(&path);
            } else if let Some(key) = names::claimed_key_of(&path) {
                // What is left here is in nobody's way: who wants the run finds the claim dead.
                let _ = folder.sweep_claim(key, FOREIGN_AGE);
            } else if let Some(key) = names::failed_key_of(&path) {
                folder.know_failure(key);
            }
        }
        Ok(folder)
    }

    /// All entries.
    pub(crate) fn paths(&self) -> Result<Vec<PathBuf>, Error> {
        let problem = io("list", &self.path);
        let entries = std::fs::read_dir(&self.path).map_err(&problem)?;
        entries
            .map(|entry| entry.map(|e| e.path()).map_err(&problem))
            .collect()
    }

    /// A unique name for a file.
    pub(crate) fn aside(&self, stem: &str) -> PathBuf {
        let number = ASIDE_NUMBER.fetch_add(1, Ordering::Relaxed);
        let machine = self.machine.label();
        names::aside(&self.path, stem, &machine, std::process::id(), number)
    }

    /// Writes the file of a key, whole or not at all: aside, forced to the disk, renamed over its name.
    pub(crate) fn write(&self, key: &str, bytes: &[u8]) -> Result<(), Error> {
        let mut attempt = 1;
        loop {
            match self.write_once(key, bytes) {
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

    /// Writes aside and renames, once.
    fn write_once(&self, key: &str, bytes: &[u8]) -> Result<(), Error> {
        let aside = self.aside(key);
        let mut file = self.disk.create(&aside).map_err(io("create", &aside))?;
        // Where locks are not supported nobody can sweep the file either.
        let _ = file.lock();
        let target = names::record(&self.path, key);
        let disk = &self.disk;
        let written = disk
            .write(&mut file, bytes)
            .and_then(|()| disk.sync(&file))
            .map_err(io("write", &aside))
            .and_then(|()| disk.rename(&aside, &target).map_err(io("rename", &aside)));
        if written.is_err() {
            let _ = disk.remove(&aside);
            return written;
        }
        // The name is safe once the folder is on the disk; some systems cannot force a folder.
        if let Ok(folder) = File::open(&self.path) {
            let _ = disk.sync(&folder);
        }
        Ok(())
    }

    /// Time of the file system, since 1970: the time stamp of a file that is written now. The clock of this machine
    /// may differ from that of a file server.
    pub(crate) fn now(&self) -> Result<Duration, Error> {
        let mut last = self.clock.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((time, look)) = *last
            && look.elapsed() < CLOCK_LIFE
        {
            return Ok(time + look.elapsed());
        }
        let path = self.aside("clock");
        let file = self.disk.create(&path).map_err(io("create", &path))?;
        let time = modified(&file).map_err(io("read the time of", &path));
        let _ = self.disk.remove(&path);
        let time = time?;
        // Taken late rather than early: a claim then seems younger than it is, never older.
        *last = Some((time, Instant::now()));
        Ok(time)
    }

    /// Removes a temporary file whose writer has ended.
    fn sweep(&self, path: &Path) {
        let Ok(file) = open_plain(path, OpenOptions::new().write(true)) else {
            return;
        };
        let ours = names::writer_of(path).filter(|(machine, _)| *machine == self.machine.label());
        let dead = match ours {
            Some((_, process)) => has_ended(process) || try_lock(&file) == Lock::Held,
            // A lock says nothing there: it may not reach from machine to machine.
            None => modified(&file)
                .ok()
                .zip(self.now().ok())
                .is_some_and(|(then, now)| now.saturating_sub(then) > FOREIGN_AGE),
        };
        if dead {
            // A failure leaves a hidden file behind, which no reader minds.
            let _ = self.disk.remove(path);
        }
    }
}

/// Result of trying to lock a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lock {
    /// This process has the lock until the file is closed.
    Held,
    /// Another process has it.
    Busy,
    /// This file system has no locks.
    Unsupported,
}

/// Locks a file, without waiting.
pub(crate) fn try_lock(file: &File) -> Lock {
    match file.try_lock() {
        Ok(()) => Lock::Held,
        Err(TryLockError::WouldBlock) => Lock::Busy,
        Err(TryLockError::Error(_)) => Lock::Unsupported,
    }
}

/// Time of the last change of a file, since 1970.
pub(crate) fn modified(file: &File) -> std::io::Result<Duration> {
    let time = file.metadata()?.modified()?;
    Ok(time.duration_since(UNIX_EPOCH).unwrap_or_default())
}

/// Opens a plain file; a link, a folder or a pipe of this name is refused.
pub(crate) fn open_plain(path: &Path, options: &OpenOptions) -> std::io::Result<File> {
    let mut options = options.clone();
    without_links(&mut options);
    let file = options.open(path)?;
    if file.metadata()?.is_file() && !path.symlink_metadata()?.is_symlink() {
        return Ok(file);
    }
    Err(std::io::Error::new(
        ErrorKind::InvalidInput,
        "it is not a plain file",
    ))
}

/// Makes an opening refuse links, and not wait for the other end of a pipe.
#[cfg(unix)]
fn without_links(options: &mut OpenOptions) {
    use rustix::fs::OFlags;
    use std::os::unix::fs::OpenOptionsExt as _;

    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    options.custom_flags(i32::try_from(flags.bits()).unwrap_or(0));
}

/// This system has no such flags; the check after the opening replaces them.
#[cfg(not(unix))]
fn without_links(_options: &mut OpenOptions) {}

#[cfg(test)]
mod tests {
    use super::{Disk, FOREIGN_AGE, Folder, modified};
    use std::fs::File;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    /// Leaves half a record of a writer, last changed this long ago.
    fn leave(path: &Path, ago: Duration) -> File {
        std::fs::write(path, "{\"schema\": 3, \"ke").unwrap();
        let file = File::options().write(true).open(path).unwrap();
        let time = file.metadata().unwrap().modified().unwrap();
        file.set_modified(time - ago).unwrap();
        file
    }

    /// Files left by a writer on this machine are removed once it has ended or has no lock; files of another machine or of
    /// an unknown writer are removed after a day.
    #[test]
    fn opening_sweeps_what_dead_writers_left_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path(), Disk::default()).unwrap();
        let of = |machine: &str, process: u32, number: u64| {
            crate::run_store::names::aside(place.path(), "key", machine, process, number)
        };
        let ours = folder.machine.label();
        let now = Duration::ZERO;
        let (living, locked, unlocked) = (std::process::id(), of(&ours, 0, 1), of(&ours, 0, 2));
        leave(&unlocked, now);
        let (writing, abroad) = (of(&ours, living, 3), of("abroad-0a1b2c3d", living, 4));
        let (old, nobody) = (of("abroad-0a1b2c3d", 1, 5), place.path().join(".x.aside"));
        let held = [leave(&locked, FOREIGN_AGE * 2), leave(&writing, now)];
        for file in &held {
            file.lock().unwrap();
        }
        leave(&abroad, FOREIGN_AGE.mul_f64(0.999));
        leave(&old, FOREIGN_AGE.mul_f64(1.001));
        leave(&nobody, now);
        Folder::open(place.path(), Disk::default()).unwrap();
        let left = |paths: &[&PathBuf]| paths.iter().map(|p| p.exists()).collect::<Vec<_>>();
        assert_eq!(left(&[&locked, &writing, &abroad, &nobody]), [true; 4]);
        assert_eq!(left(&[&unlocked, &old]), [false; 2]);
    }

    /// The lock of a dead writer may outlast it in a child that it had; the writer counts.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_lock_does_not_keep_the_file_of_a_dead_writer() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path(), Disk::default()).unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        let machine = folder.machine.label();
        let path = crate::run_store::names::aside(place.path(), "key", &machine, child.id(), 0);
        leave(&path, Duration::ZERO).lock().unwrap();
        let file = File::open(&path).unwrap();
        file.lock().unwrap();
        Folder::open(place.path(), Disk::default()).unwrap();
        assert!(!path.exists(), "it is still there");
    }

    /// Seen from a file written just before and one just after, the time of the file system lies between, but for the
    /// ticks of its clock, a hundredth of a second at most; also while the last look at it counts.
    #[test]
    fn the_clock_is_that_of_the_file_system() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path(), Disk::default()).unwrap();
        let written = || modified(&File::create(place.path().join("file")).unwrap()).unwrap();
        for _ in 0..3 {
            let before = written();
            let now = folder.now().unwrap();
            let after = written();
            let tick = Duration::from_millis(20);
            assert!(now + tick >= before && now <= after + tick, "{now:?}");
            std::thread::sleep(Duration::from_millis(30));
        }
        assert_eq!(folder.paths().unwrap().len(), 1, "nothing is left");
    }
}
