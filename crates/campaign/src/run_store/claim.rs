//! Claims: which process does which run, so that the processes of a folder do each run once.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::OpenOptions;
use std::hash::{BuildHasher as _, RandomState};
use std::io::{ErrorKind, Seek as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::run_store::canonical::hexadecimal;
use crate::run_store::disk::Disk;
use crate::run_store::error::io;
use crate::run_store::folder::{Folder, Lock, modified, open_plain, try_lock};
use crate::run_store::machine::has_ended;
use crate::run_store::{Error, names};

/// Time without renewal after which a claim is dead: long against the pauses of a busy file server, short against a
/// run. Our choice; with twice this time others wait twice as long for the runs of a machine that died.
pub const CLAIM_LIFE: Duration = Duration::from_mins(1);

/// Longest accepted lifetime of another claim.
const LONGEST_LIFE_S: f64 = 86_400.0;
/// Largest number of bytes of a claim that are read.
const LONGEST_CLAIM: u64 = 4096;
/// Number of attempts to claim a run while others claim and release it.
const ATTEMPTS: usize = 8;
/// How often, and how far apart, a late owner tries to lock its claim before it leaves it to die.
const LATE_ATTEMPTS: usize = 20;
/// Pause between two of them.
const LATE_PAUSE: Duration = Duration::from_millis(5);

/// Result of trying to claim a run.
#[derive(Debug)]
pub enum Attempt {
    /// This process may do the run.
    Won(Claim),
    /// Another process does it.
    Taken(Holder),
    /// A store in memory needs no claims.
    NotNeeded,
}

/// Owner of a claim, as far as the claim contains it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// Host and number of the process; `None` if the claim does not contain them.
    process: Option<(String, u32)>,
    /// Its work, and for how long; `None` if the claim does not contain it.
    work: Option<(String, Duration)>,
}

impl Holder {
    /// Whether it works on this.
    pub(crate) fn does(&self, work: &str) -> bool {
        let name = name_of_work(work);
        self.work.as_ref().is_some_and(|(known, _)| *known == name)
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.process {
            Some((host, process)) => write!(f, "process {process} on {host}"),
            None => write!(f, "an unknown process"),
        }?;
        match &self.work {
            Some((_, time)) => write!(f, ", for {} min", time.as_secs() / 60),
            None => Ok(()),
        }
    }
}

/// Content of a claim file.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Owner {
    /// Name of the host.
    host: String,
    /// Space in which the process number is unique.
    process_space: String,
    /// Number of the process.
    process: u32,
    /// Distinguishes this claim from all others.
    token: String,
    /// Time without renewal after which it is dead, s.
    life_s: f64,
    /// Its work; `None` for a single run of a list.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    work: Option<Work>,
}

/// Work of the owner of a claim.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Work {
    /// Digest of the work.
    name: String,
    /// When it began by the clock of the file system, s since 1970.
    since_s: u64,
}

/// Digest that represents some work in a claim: the text of the work grows with its inputs, and a claim is read up to a limit.
fn name_of_work(work: &str) -> String {
    hexadecimal(work.as_bytes())
}

/// A claim file as it was found.
#[derive(Debug, PartialEq, Eq)]
struct Seen {
    /// Its content.
    bytes: Vec<u8>,
    /// Its last change, since 1970.
    modified: Duration,
}

impl Seen {
    /// Its owner, if it can be read.
    fn owner(&self) -> Option<Owner> {
        serde_json::from_slice(&self.bytes).ok()
    }

    /// Its owner at a time since 1970, as text.
    fn holder(&self, now: Duration) -> Holder {
        let owner = self.owner();
        let time = |work: Work| {
            let since = Duration::from_secs(work.since_s);
            (work.name, now.saturating_sub(since))
        };
        Holder {
            work: owner
                .as_ref()
                .and_then(|owner| owner.work.clone().map(time)),
            process: owner.map(|owner| (owner.host, owner.process)),
        }
    }
}

/// A run that this process has claimed. It must be renewed several times in its life; dropping it releases it.
#[derive(Debug)]
pub struct Claim {
    /// Where it is.
    folder: Arc<Folder>,
    /// Key of the run.
    key: String,
    /// Content of its file, which no other claim has.
    bytes: Vec<u8>,
    /// Time without renewal after which it is dead.
    life: Duration,
    /// When it was renewed last.
    renewed: Mutex<Instant>,
    /// Set once it was released.
    released: AtomicBool,
}

impl Claim {
    /// Key of the run.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Says that the owner is alive. Whether the claim is still its own: one that was not renewed for its life may
    /// have been taken over.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the file cannot be read or written.
    pub fn renew(&self) -> Result<bool, Error> {
        if self.released.load(Ordering::SeqCst) {
            return Ok(false);
        }
        let now = Instant::now();
        let path = names::claim(&self.folder.path, &self.key);
        let mut file = match open_plain(&path, OpenOptions::new().read(true).write(true)) {
            Ok(file) => file,
            Err(why) if why.kind() == ErrorKind::NotFound => return Ok(false),
            Err(why) => return Err(io("open", &path)(why)),
        };
        let disk = &self.folder.disk;
        let known = disk.read(&mut file, LONGEST_CLAIM);
        if known.map_err(io("read", &path))? != self.bytes {
            return Ok(false);
        }
        // The same bytes once more: readers see no change, and the file system sets the time by its own clock.
        file.rewind()
            .and_then(|()| disk.write(&mut file, &self.bytes))
            .map_err(io("write", &path))?;
        *self.renewed.lock().unwrap_or_else(PoisonError::into_inner) = now;
        Ok(true)
    }

    /// Releases the run: after its record is stored, or when it has failed.
    pub fn release(&self) {
        if self.released.swap(true, Ordering::SeqCst) {
            return;
        }
        let path = names::claim(&self.folder.path, &self.key);
        let renewed = *self.renewed.lock().unwrap_or_else(PoisonError::into_inner);
        if renewed.elapsed() < self.life / 2 {
            // Nobody takes it for dead: what has our content now has it until we remove it.
            self.remove(&path);
            return;
        }
        let Ok(file) = open_plain(&path, OpenOptions::new().read(true).write(true)) else {
            return;
        };
        for _ in 0..LATE_ATTEMPTS {
            if try_lock(&file) != Lock::Busy {
                self.remove(&path);
                return;
            }
            std::thread::sleep(LATE_PAUSE);
        }
    }

    /// Removes the file if it is still that of this claim.
    fn remove(&self, path: &Path) {
        let disk = &self.folder.disk;
        if matches!(look(disk, path), Ok(Some(seen)) if seen.bytes == self.bytes) {
            // A claim that stays is dead in its time.
            let _ = disk.remove(path);
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.release();
    }
}

impl Folder {
    /// Tries to claim a run; `life` is that of the new claim.
    pub(crate) fn claim(self: &Arc<Self>, key: &str, life: Duration) -> Result<Attempt, Error> {
        self.try_claim(key, life, None)
    }

    /// The same, with what is worked on.
    pub(crate) fn claim_for(
        self: &Arc<Self>,
        key: &str,
        life: Duration,
        work: &str,
    ) -> Result<Attempt, Error> {
        self.try_claim(key, life, Some(work))
    }

    /// Tries to claim a run.
    fn try_claim(
        self: &Arc<Self>,
        key: &str,
        life: Duration,
        work: Option<&str>,
    ) -> Result<Attempt, Error> {
        let path = names::claim(&self.path, key);
        let work = work.map(name_of_work);
        let mut holder = Holder {
            process: None,
            work: None,
        };
        for _ in 0..ATTEMPTS {
            if let Some(seen) = look(&self.disk, &path)? {
                holder = seen.holder(self.now()?);
                if !self.is_dead(&seen, life)? || !self.bury(key, &seen)? {
                    return Ok(Attempt::Taken(holder));
                }
            }
            if let Some(claim) = self.make_claim(key, life, work.as_deref())? {
                return Ok(Attempt::Won(claim));
            }
        }
        Ok(Attempt::Taken(holder))
    }

    /// Removes a claim whose process is no more, or that was not renewed for `age`, longer than any claim lives.
    pub(crate) fn sweep_claim(&self, key: &str, age: Duration) -> Result<(), Error> {
        if let Some(seen) = look(&self.disk, &names::claim(&self.path, key))?
            && (self.has_lost_its_process(&seen) || self.is_older(&seen, age)?)
        {
            self.bury(key, &seen)?;
        }
        Ok(())
    }

    /// Whether nobody keeps a claim alive; `life` is used if the claim does not contain its own.
    fn is_dead(&self, seen: &Seen, life: Duration) -> Result<bool, Error> {
        if self.has_lost_its_process(seen) {
            return Ok(true);
        }
        let told = seen.owner().map(|owner| owner.life_s);
        let believed = told.filter(|life_s| *life_s > 0.0 && *life_s <= LONGEST_LIFE_S);
        self.is_older(seen, believed.map_or(life, Duration::from_secs_f64))
    }

    /// Whether the process of a claim ran on this machine and is no more.
    fn has_lost_its_process(&self, seen: &Seen) -> bool {
        seen.owner().is_some_and(|owner| {
            owner.host == self.machine.host
                && owner.process_space == self.machine.process_space
                && has_ended(owner.process)
        })
    }

    /// Whether a claim was not renewed for a time. One that is dated ahead by as much was not either: the clock was
    /// set back since.
    fn is_older(&self, seen: &Seen, life: Duration) -> Result<bool, Error> {
        Ok(self.now()?.abs_diff(seen.modified) > life)
    }

    /// Removes a dead claim. Says no when another removes it, or it is not the dead one any more.
    ///
    /// The lock on the dead file lets one remover through where the file system has locks; where it has none, the file
    /// is looked at once more under a name that nobody else knows, and put back if it was a living one.
    fn bury(&self, key: &str, dead: &Seen) -> Result<bool, Error> {
        let path = names::claim(&self.path, key);
        let mut options = OpenOptions::new();
        let file = match open_plain(&path, options.read(true).write(true)) {
            // The claim of another user may not be open to us, and its folder be all the same.
            Err(why) if why.kind() == ErrorKind::PermissionDenied => {
                open_plain(&path, OpenOptions::new().read(true))
            }
            opened => opened,
        };
        let file = match file {
            Ok(file) => file,
            Err(why) if why.kind() == ErrorKind::NotFound => return Ok(true),
            Err(why) => return Err(io("open", &path)(why)),
        };
        if try_lock(&file) == Lock::Busy {
            return Ok(false);
        }
        match look(&self.disk, &path)? {
            None => return Ok(true),
            Some(now) if now != *dead => return Ok(false),
            Some(_) => {}
        }
        let grave = self.aside(key);
        match self.disk.rename(&path, &grave) {
            Err(why) if why.kind() == ErrorKind::NotFound => return Ok(true),
            renamed => renamed.map_err(io("rename", &path))?,
        }
        let buried = matches!(look(&self.disk, &grave), Ok(Some(moved)) if moved == *dead);
        if !buried {
            let _ = self.disk.link(&grave, &path);
        }
        // The name is open no more when it goes: a shared folder would keep it under another one.
        drop(file);
        let _ = self.disk.remove(&grave);
        Ok(buried)
    }

    /// Makes a claim: written aside, then linked to its name, which fails if there is one. `None`
    /// if another process was faster, or if it must be tried again.
    fn make_claim(
        self: &Arc<Self>,
        key: &str,
        life: Duration,
        work: Option<&str>,
    ) -> Result<Option<Claim>, Error> {
        let path = names::claim(&self.path, key);
        let aside = self.aside(key);
        let work = match work {
            Some(name) => Some(Work {
                name: name.to_owned(),
                since_s: self.now()?.as_secs(),
            }),
            None => None,
        };
        let owner = Owner {
            host: self.machine.host.clone(),
            process_space: self.machine.process_space.clone(),
            process: std::process::id(),
            // The name of the aside file is used once; the random part tells two that share it all the same.
            token: format!("{:016x}", RandomState::new().hash_one(&aside)),
            life_s: life.as_secs_f64(),
            work,
        };
        let bytes = serde_json::to_vec(&owner).map_err(|source| Error::Unwritable {
            key: key.to_owned(),
            source,
        })?;
        let now = Instant::now();
        write_new(&self.disk, &aside, &bytes).map_err(io("create", &aside))?;
        let linked = self.disk.link(&aside, &path);
        let _ = self.disk.remove(&aside);
        let made = match linked {
            Ok(()) => true,
            // An answer that got lost on its way from a file server is asked for again, and then the link exists.
            Err(why) if why.kind() == ErrorKind::AlreadyExists => {
                matches!(look(&self.disk, &path), Ok(Some(seen)) if seen.bytes == bytes)
            }
            // Another process that opened the store has swept the aside file.
            Err(why) if why.kind() == ErrorKind::NotFound => false,
            // A file system without links.
            Err(_) => match write_new(&self.disk, &path, &bytes) {
                Ok(()) => true,
                Err(why) if why.kind() == ErrorKind::AlreadyExists => false,
                Err(why) => return Err(io("create", &path)(why)),
            },
        };
        Ok(made.then(|| Claim {
            folder: Arc::clone(self),
            key: key.to_owned(),
            bytes,
            life,
            renewed: Mutex::new(now),
            released: AtomicBool::new(false),
        }))
    }
}

/// Writes a file that does not exist yet.
fn write_new(disk: &Disk, path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = disk.create(path)?;
    let written = disk.write(&mut file, bytes);
    if written.is_err() {
        let _ = disk.remove(path);
    }
    written
}

/// Reads a claim file; `None` if there is none.
fn look(disk: &Disk, path: &Path) -> Result<Option<Seen>, Error> {
    let mut file = match open_plain(path, OpenOptions::new().read(true)) {
        Ok(file) => file,
        Err(why) if why.kind() == ErrorKind::NotFound => return Ok(None),
        Err(why) => return Err(io("open", path)(why)),
    };
    let bytes = (disk.read(&mut file, LONGEST_CLAIM)).map_err(io("read", path))?;
    let modified = modified(&file).map_err(io("read the time of", path))?;
    Ok(Some(Seen { bytes, modified }))
}
