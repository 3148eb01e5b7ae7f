//! A run is claimed by one at a time, and a claim that nobody keeps alive is taken over by one.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failed step fails its test"
)]

use crate::common::{RUNS, record, work_through};
use campaign::run_store::{Attempt, CLAIM_LIFE, Claim, Error, Lookup, Store};
use std::fs;
use std::path::PathBuf;
use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// A folder, a key, and the file of its claim.
struct Place {
    folder: tempfile::TempDir,
    store: Store,
    key: String,
    file: PathBuf,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let key = record(1).key().to_owned();
        Self {
            store: Store::open(folder.path()).unwrap(),
            file: folder.path().join(format!(".{key}.claim")),
            key,
            folder,
        }
    }

    fn attempt(&self, life: Duration) -> Attempt {
        self.store.claim(&self.key, life).unwrap()
    }

    fn won(&self) -> Option<Claim> {
        match self.attempt(CLAIM_LIFE) {
            Attempt::Won(claim) => Some(claim),
            Attempt::Taken(_) => None,
            Attempt::NotNeeded => panic!("a folder needs claims"),
        }
    }

    /// Makes the claim look like that of another machine.
    fn abroad(&self) {
        let text = fs::read_to_string(&self.file).unwrap();
        let (before, after) = text.split_once("\"host\":\"").unwrap();
        let (_, after) = after.split_once('"').unwrap();
        fs::write(&self.file, format!("{before}\"host\":\"abroad\"{after}")).unwrap();
    }

    /// Dates the last renewal of the claim back, or ahead.
    fn age(&self, seconds: f64) {
        let file = fs::OpenOptions::new().write(true).open(&self.file).unwrap();
        let time = file.metadata().unwrap().modified().unwrap();
        let span = Duration::from_secs_f64(seconds.abs());
        let time = if seconds < 0.0 {
            time + span
        } else {
            time - span
        };
        file.set_modified(time).unwrap();
    }

    /// Names of all files.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

#[test]
fn a_run_is_claimed_by_one_until_it_is_given_back() {
    let place = Place::new();
    let claim = place.won().unwrap();
    let Attempt::Taken(holder) = place.attempt(CLAIM_LIFE) else {
        panic!("two have it");
    };
    let process = std::process::id();
    let told = holder.to_string();
    assert!(
        told.starts_with(&format!("process {process} on ")),
        "{told}"
    );
    assert!(
        place.store.keys().unwrap().is_empty(),
        "a claim is not a record"
    );
    Store::open(place.folder.path()).unwrap();
    assert!(claim.renew().unwrap(), "opening leaves it alone");
    claim.release();
    assert!(!claim.renew().unwrap(), "it was given back");
    drop(place.won().unwrap());
    assert!(place.names().is_empty(), "{:?}", place.names());
    assert!(matches!(
        Store::in_memory().claim(&place.key, CLAIM_LIFE),
        Ok(Attempt::NotNeeded)
    ));
    let no_key = place.store.claim("../x", CLAIM_LIFE);
    assert!(matches!(no_key, Err(Error::BadKey { .. })));
}

/// Of 64 that try at once one wins: a fresh claim, one of a machine that died, and one that its owner finds lost.
#[test]
fn one_of_many_wins() {
    let place = Place::new();
    for round in 0..40 {
        let before = (round % 2 == 1).then(|| {
            let claim = place.won().unwrap();
            place.abroad();
            place.age(61.0);
            claim
        });
        let (start, winners) = (Barrier::new(64), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..64 {
                scope.spawn(|| {
                    start.wait();
                    let claim = place.won();
                    winners.fetch_add(usize::from(claim.is_some()), Ordering::SeqCst);
                    start.wait();
                });
            }
        });
        assert_eq!(winners.into_inner(), 1, "round {round}");
        drop(before);
        assert!(place.names().is_empty(), "{:?}", place.names());
    }
}

/// A claim of another machine counts as long as it is renewed; one of this machine, as long as its process lives too.
/// A clock that was set back does not keep a claim alive for ever.
#[test]
fn a_claim_that_is_not_renewed_is_dead_after_its_life() {
    let place = Place::new();
    let first = place.won().unwrap();
    place.age(58.0);
    assert!(place.won().is_none(), "it has two seconds left");
    assert!(first.renew().unwrap());
    place.age(58.0);
    assert!(place.won().is_none(), "it was renewed");
    place.age(3.0);
    let second = place.won().expect("the first is dead");
    assert!(!first.renew().unwrap(), "the first has lost it");
    first.release();
    assert!(
        second.renew().unwrap(),
        "who lost a claim takes none from another"
    );
    place.age(-3600.0);
    drop(
        place
            .won()
            .expect("no owner dates a claim ahead by an hour"),
    );
    assert!(place.names().is_empty(), "{:?}", place.names());
}

/// The life that counts is that which the owner promised.
#[test]
fn the_life_of_a_claim_is_its_owners() {
    let place = Place::new();
    let long = place.attempt(Duration::from_mins(10));
    place.age(120.0);
    assert!(matches!(
        place.attempt(Duration::from_secs(1)),
        Attempt::Taken(_)
    ));
    place.age(500.0);
    assert!(matches!(
        place.attempt(Duration::from_secs(1)),
        Attempt::Won(_)
    ));
    drop(long);
}

/// A claim that was cut off while it was written belongs to an unknown owner, who has a life all the same.
#[test]
fn a_claim_that_cannot_be_read_lives_as_long_as_others() {
    let place = Place::new();
    for content in ["", "{\"host\":", "null"] {
        fs::write(&place.file, content).unwrap();
        let Attempt::Taken(holder) = place.attempt(CLAIM_LIFE) else {
            panic!("{content:?} is young");
        };
        assert_eq!(holder.to_string(), "an unknown process");
        place.age(61.0);
        drop(place.won().expect("it is old"));
    }
}

/// Opening removes what is over for certain, not what may only be late.
#[test]
fn opening_sweeps_claims_that_are_a_day_old() {
    let place = Place::new();
    let claim = place.won().unwrap();
    place.abroad();
    place.age(86_000.0);
    Store::open(place.folder.path()).unwrap();
    assert_eq!(place.names().len(), 1, "not yet a day");
    place.age(800.0);
    Store::open(place.folder.path()).unwrap();
    assert!(place.names().is_empty(), "{:?}", place.names());
    drop(claim);
}

/// A file in the place of a claim is reported, and left alone.
#[test]
fn a_folder_that_takes_no_claim_says_so() {
    let place = Place::new();
    fs::create_dir(&place.file).unwrap();
    let error = place.store.claim(&place.key, CLAIM_LIFE).unwrap_err();
    assert!(error.to_string().contains(".claim"), "{error}");
    #[cfg(unix)]
    {
        fs::remove_dir(&place.file).unwrap();
        let precious = place.folder.path().join(".precious");
        fs::write(&precious, "mine").unwrap();
        std::os::unix::fs::symlink(&precious, &place.file).unwrap();
        assert!(place.store.claim(&place.key, CLAIM_LIFE).is_err());
        assert_eq!(fs::read_to_string(precious).unwrap(), "mine");
    }
}

/// 64 workers go through the same runs in different orders: each run is done once and its record is whole.
#[test]
fn many_workers_do_each_run_once() {
    let folder = tempfile::tempdir().unwrap();
    let done = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for worker in 0..64 {
            let (folder, done) = (folder.path(), &done);
            scope.spawn(move || {
                let n = work_through(folder, worker);
                done.fetch_add(n, Ordering::SeqCst);
            });
        }
    });
    assert_eq!(done.into_inner(), RUNS);
    let store = Store::open(folder.path()).unwrap();
    for seed in 0..RUNS as u64 {
        let written = record(seed);
        let found = store.get(written.key()).unwrap();
        assert_eq!(found, Lookup::Found(written));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), RUNS);
}
