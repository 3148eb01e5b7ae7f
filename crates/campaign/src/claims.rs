//! The claims of a campaign: one for each run in progress, all kept alive by one thread.

use crate::run_store::{Attempt, Claim, Holder, Store};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::error::in_full;

/// Number of renewals of a claim in its lifetime: a few may be late or fail.
const RENEWALS_PER_LIFE: u32 = 6;

/// Whether a run may begin.
pub(crate) enum Permit<'k> {
    /// It may; held until it is dropped. `None` if the store needs or takes no claims.
    Go(Option<Hold<'k>>),
    /// Another campaign does it.
    Taken(Holder),
}

/// The right to do a run; dropping it gives it back.
pub(crate) struct Hold<'k> {
    /// Who keeps it alive.
    keeper: &'k Keeper<'k>,
    claim: Arc<Claim>,
}

/// Holds the claims of one list of runs.
pub(crate) struct Keeper<'s> {
    /// Where runs are claimed.
    store: &'s Store,
    /// Time without renewal after which a claim is dead.
    life: Duration,
    /// Shared state of the threads.
    state: Mutex<State>,
    /// Signals the end.
    end: Condvar,
}

/// State that the threads of a keeper share.
#[derive(Default)]
struct State {
    /// The claims by key.
    held: BTreeMap<String, Arc<Claim>>,
    /// Set once the store has refused a claim for lack of support.
    goes_without: bool,
    /// Set at the end.
    is_over: bool,
}

impl Drop for Hold<'_> {
    fn drop(&mut self) {
        self.keeper.lock().held.remove(self.claim.key());
        self.claim.release();
    }
}

impl<'s> Keeper<'s> {
    /// Prepares to hold claims in a store.
    pub(crate) fn new(store: &'s Store, life: Duration) -> Self {
        Self {
            store,
            life,
            state: Mutex::default(),
            end: Condvar::new(),
        }
    }

    /// Asks whether the run of a key may begin. A store that takes no claims does not prevent it; a warning says so once.
    pub(crate) fn ask(&self, key: &str, warn: &dyn Fn(&str)) -> Permit<'_> {
        if self.lock().goes_without {
            return Permit::Go(None);
        }
        match self.store.claim(key, self.life) {
            Ok(Attempt::Won(claim)) => {
                let claim = Arc::new(claim);
                let kept = Arc::clone(&claim);
                self.lock().held.insert(key.to_owned(), kept);
                Permit::Go(Some(Hold {
                    keeper: self,
                    claim,
                }))
            }
            Ok(Attempt::Taken(holder)) => Permit::Taken(holder),
            Ok(Attempt::NotNeeded) => Permit::Go(None),
            Err(why) => {
                let knew = std::mem::replace(&mut self.lock().goes_without, true);
                if !knew {
                    warn(&format!(
                        "runs cannot be claimed, so that another campaign in this folder may do the same ones: {}",
                        in_full(&why)
                    ));
                }
                Permit::Go(None)
            }
        }
    }

    /// Keeps the claims alive until [`Keeper::end`].
    pub(crate) fn renew_until_end(&self) {
        let mut state = self.lock();
        loop {
            let pause = self.life / RENEWALS_PER_LIFE;
            let rung = self.end.wait_timeout_while(state, pause, |s| !s.is_over);
            state = rung.unwrap_or_else(PoisonError::into_inner).0;
            if state.is_over {
                return;
            }
            let claims: Vec<_> = state.held.values().cloned().collect();
            // A slow file system must not keep runs from their begin or end.
            drop(state);
            for claim in claims {
                // One that was lost or cannot be renewed costs a run done twice at most, and no result.
                let _ = claim.renew();
            }
            state = self.lock();
        }
    }

    /// Ends the renewals.
    pub(crate) fn end(&self) {
        self.lock().is_over = true;
        self.end.notify_all();
    }

    /// Locks the state; a panic never leaves it inconsistent.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
