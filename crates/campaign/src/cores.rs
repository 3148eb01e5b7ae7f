//! Cores of a campaign, shared among its runs.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Cores that the runs in progress share. As long as each core has a run of its own, each run has one; the last runs of a list share
/// those that are free.
#[derive(Debug)]
pub struct Cores {
    all: usize,
    /// Workers that do runs or may still begin one.
    workers: AtomicUsize,
}

impl Cores {
    /// Cores for so many runs at a time.
    pub fn new(all: usize, runs: usize) -> Self {
        Self {
            all,
            workers: AtomicUsize::new(runs),
        }
    }

    /// Cores for one run at this moment, rounded down, at least 1.
    pub fn of_a_run(&self) -> usize {
        let runs = self.workers.load(Ordering::Relaxed).max(1);
        (self.all / runs).max(1)
    }

    /// One worker fewer: no run is left for it.
    pub(crate) fn release(&self) {
        self.workers.fetch_sub(1, Ordering::Relaxed);
    }
}
