//! Owner of a folder: one kind of work at a time, shared by all processes that do the same.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::run_store::canonical::hexadecimal;
use crate::run_store::folder::Folder;
use crate::run_store::{Attempt, CLAIM_LIFE, Claim, Error, Holder, Store};

/// Number of renewals of a claim in its lifetime.
const RENEWALS: u32 = 6;

/// Name of the folder itself among the claims.
const FOLDER: &[u8] = b"the folder of the store";

/// The key under which the folder itself is claimed.
pub(crate) fn folder_key() -> String {
    hexadecimal(FOLDER)
}

/// Result of a request for a folder, or for one run in it, for longer.
#[derive(Debug)]
pub enum Entry {
    /// This process owns it until the keeper is dropped; also in a store in memory, or if the file system takes no claims.
    Ours(ClaimKeeper),
    /// Another does the same work in the folder: the runs are shared by their claims. The folder is ours when the other has
    /// ended.
    Shared(ClaimKeeper, Holder),
    /// Another process does other work in the folder, or the same run.
    Taken(Holder),
}

/// Keeps a claim alive until it is dropped.
#[derive(Debug)]
pub struct ClaimKeeper {
    /// Ends the thread when it is dropped.
    end: Option<Sender<()>>,
    /// Renews the claim.
    thread: Option<JoinHandle<()>>,
    /// The claim, once it is ours.
    claim: Arc<Mutex<Option<Claim>>>,
}

impl Store {
    /// Requests the whole folder for some work, such as the digest of a campaign. Processes that do the same work
    /// share it. It is released when the keeper is dropped, and taken over when the process has ended.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be read.
    pub fn enter(&self, work: &str) -> Result<Entry, Error> {
        self.ask(&folder_key(), work, true)
    }

    /// Requests one run, so that no other process does it meanwhile.
    ///
    /// # Errors
    ///
    /// [`Error::BadKey`] if this is not a key; [`Error::Io`] when the folder cannot be read.
    pub fn keep_run(&self, key: &str) -> Result<Entry, Error> {
        self.ask(key, key, false)
    }

    /// Requests a claim and keeps it.
    fn ask(&self, key: &str, work: &str, may_share: bool) -> Result<Entry, Error> {
        if !crate::run_store::names::is_key(key) {
            return Err(Error::BadKey {
                key: key.to_owned(),
            });
        }
        let Some(folder) = self.shared_folder() else {
            return Ok(Entry::Ours(ClaimKeeper::idle()));
        };
        match folder.claim_for(key, CLAIM_LIFE, work) {
            Ok(Attempt::Taken(holder)) if may_share && holder.does(work) => {
                let keeper = ClaimKeeper::start(None, Arc::clone(folder), key, work);
                Ok(Entry::Shared(keeper, holder))
            }
            Ok(Attempt::Taken(holder)) => Ok(Entry::Taken(holder)),
            Ok(Attempt::Won(claim)) => {
                let keeper = ClaimKeeper::start(Some(claim), Arc::clone(folder), key, work);
                Ok(Entry::Ours(keeper))
            }
            // A file system that takes no claims hinders no work.
            Ok(Attempt::NotNeeded) | Err(_) => Ok(Entry::Ours(ClaimKeeper::idle())),
        }
    }
}

impl ClaimKeeper {
    /// Keeps nothing.
    fn idle() -> Self {
        Self {
            end: None,
            thread: None,
            claim: Arc::default(),
        }
    }

    /// Renews a claim several times in its life; tries for it as often where it is not ours yet, or was lost.
    fn start(claim: Option<Claim>, folder: Arc<Folder>, key: &str, work: &str) -> Self {
        let claim = Arc::new(Mutex::new(claim));
        let (end, ended) = channel::<()>();
        let (kept, key, work) = (Arc::clone(&claim), key.to_owned(), work.to_owned());
        let thread = std::thread::spawn(move || {
            let pause = CLAIM_LIFE / RENEWALS;
            // The end of the sender ends the wait at once.
            while ended.recv_timeout(pause) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                keep(&kept, &folder, &key, &work, CLAIM_LIFE);
            }
        });
        Self {
            end: Some(end),
            thread: Some(thread),
            claim,
        }
    }
}

/// Renews a claim, or tries for it where it is another's. If the folder fails, the protection is lost but no result.
fn keep(claim: &Mutex<Option<Claim>>, folder: &Arc<Folder>, key: &str, work: &str, life: Duration) {
    let mut claim = claim.lock().unwrap_or_else(PoisonError::into_inner);
    let is_ours = claim.as_ref().is_some_and(|c| c.renew().unwrap_or(true));
    if !is_ours {
        *claim = match folder.claim_for(key, life, work) {
            Ok(Attempt::Won(won)) => Some(won),
            _ => None,
        };
    }
}

impl Drop for ClaimKeeper {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            // A thread that panicked renews nothing any more.
            let _ = thread.join();
        }
        let mut claim = self.claim.lock().unwrap_or_else(PoisonError::into_inner);
        drop(claim.take());
    }
}

#[cfg(test)]
mod tests {
    use super::{Entry, keep};
    use crate::run_store::{Attempt, CLAIM_LIFE, Store};
    use std::sync::Mutex;

    /// The same work is shared, other work is refused with who and for how long, and a folder that was left is free. A claim
    /// that names a process that has ended is taken over at once.
    #[test]
    fn a_folder_has_one_kind_of_work_at_a_time() {
        let place = tempfile::tempdir().unwrap();
        let [one, two] = [0, 1].map(|_| Store::open(place.path()).unwrap());
        let Entry::Ours(owner) = one.enter("study a").unwrap() else {
            panic!("nobody else is there");
        };
        let Entry::Shared(sharer, holder) = two.enter("study a").unwrap() else {
            panic!("the same work");
        };
        let here = format!("process {}", std::process::id());
        assert!(holder.to_string().contains(&here), "{holder}");
        let Entry::Taken(holder) = two.enter("study b").unwrap() else {
            panic!("other work");
        };
        let told = holder.to_string();
        assert!(told.contains(&here) && told.contains("for 0 min"), "{told}");
        drop((owner, sharer));
        assert!(matches!(two.enter("study b").unwrap(), Entry::Ours(_)));
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    }

    /// Work with a text longer than the part of a claim that is read: the owner is still known, shared with and renewed, and the folder
    /// is free once it has left.
    #[test]
    fn work_of_any_length_is_known_again() {
        let place = tempfile::tempdir().unwrap();
        let [one, two] = [0, 1].map(|_| Store::open(place.path()).unwrap());
        let work = "d".repeat(100_000);
        let first = one.enter(&work).unwrap();
        let Entry::Shared(_, holder) = two.enter(&work).unwrap() else {
            panic!("the same work");
        };
        let here = format!("process {}", std::process::id());
        assert!(holder.to_string().contains(&here), "{holder}");
        let Entry::Ours(keeper) = &first else {
            panic!("nobody else was there");
        };
        let claim = keeper.claim.lock().unwrap();
        assert!(claim.as_ref().unwrap().renew().unwrap());
        drop(claim);
        drop(first);
        assert!(matches!(two.enter("other").unwrap(), Entry::Ours(_)));
    }

    #[test]
    fn a_run_is_kept_by_one_process_at_a_time() {
        let place = tempfile::tempdir().unwrap();
        let store = Store::open(place.path()).unwrap();
        let key = "0".repeat(64);
        let first = store.keep_run(&key).unwrap();
        assert!(matches!(first, Entry::Ours(_)));
        assert!(matches!(store.keep_run(&key).unwrap(), Entry::Taken(_)));
        drop(first);
        assert!(matches!(store.keep_run(&key).unwrap(), Entry::Ours(_)));
        assert!(store.keep_run("no key").is_err());
    }

    /// Who shares a folder owns it once the other has gone: a third with other work is then refused.
    #[test]
    fn a_sharer_takes_over() {
        let place = tempfile::tempdir().unwrap();
        let store = Store::open(place.path()).unwrap();
        let folder = store.shared_folder().unwrap();
        let key = "1".repeat(64);
        let Attempt::Won(claim) = folder.claim_for(&key, CLAIM_LIFE, "a").unwrap() else {
            panic!("nobody else is there");
        };
        let mine = Mutex::new(None);
        keep(&mine, folder, &key, "a", CLAIM_LIFE);
        assert!(mine.lock().unwrap().is_none(), "the other lives");
        claim.release();
        keep(&mine, folder, &key, "a", CLAIM_LIFE);
        assert!(mine.lock().unwrap().is_some());
        let taken = folder.claim_for(&key, CLAIM_LIFE, "b").unwrap();
        assert!(matches!(taken, Attempt::Taken(_)));
    }
}
