//! State that the workers of a campaign share.

use crate::run_store::Record;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::jobs::Job;
use crate::time_left::Workload;
use crate::{Pace, SimulatorError};

/// Pause before the first look at a run that another campaign does.
const FIRST_PAUSE: Duration = Duration::from_millis(200);
/// Longest pause between two looks.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);
/// Factor from one pause to the next.
const PAUSE_GROWTH: f64 = 1.5;

/// Progress of each job.
#[derive(Debug)]
pub(crate) struct Board {
    /// Jobs not yet begun, in the order in which they begin.
    pub(crate) waiting: VecDeque<usize>,
    /// Jobs that a worker is about to begin, if no other campaign does them.
    pub(crate) asking: BTreeSet<usize>,
    /// Jobs that another campaign does.
    pub(crate) elsewhere: Vec<Elsewhere>,
    /// Jobs in progress with their start time.
    pub(crate) running: BTreeMap<usize, Instant>,
    /// Result of each job; `None` before its end.
    pub(crate) results: Vec<Option<Result<Record, Failure>>>,
    /// Number of jobs found in the store, at the start or later.
    pub(crate) reused: usize,
    /// Set when the store fails: a further run would be lost.
    pub(crate) broken: bool,
    /// Set once the listener knows that the campaign waits for another.
    pub(crate) told_of_others: bool,
    /// Time since which other campaigns do all remaining jobs.
    pub(crate) waiting_since: Option<Instant>,
}

/// A job that another campaign has claimed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Elsewhere {
    /// Its number.
    pub(crate) job: usize,
    /// When the claim was first found.
    since: Instant,
    /// When to look again.
    due: Instant,
    /// Pause until then.
    pause: Duration,
}

/// Why a job has no record.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The simulator gave none.
    Simulator(SimulatorError),
    /// The store could not write it.
    Store(crate::run_store::Error),
}

impl Elsewhere {
    /// A job whose claim is found for the first time, or again.
    pub(crate) fn met(job: usize, before: Option<Self>) -> Self {
        let now = Instant::now();
        let pause = before.map_or(FIRST_PAUSE, |before| {
            before.pause.mul_f64(PAUSE_GROWTH).min(LONGEST_PAUSE)
        });
        Self {
            job,
            since: before.map_or(now, |before| before.since),
            due: now + pause,
            pause,
        }
    }
}

impl Board {
    /// Takes a job of another campaign that is due for another look.
    pub(crate) fn take_due(&mut self) -> Option<Elsewhere> {
        let now = Instant::now();
        let due = self.elsewhere.iter().position(|other| other.due <= now)?;
        Some(self.elsewhere.remove(due))
    }

    /// Time until the next job of another campaign is due for a look; at most the first pause.
    pub(crate) fn until_due(&self) -> Duration {
        let now = Instant::now();
        let waits = self
            .elsewhere
            .iter()
            .map(|other| other.due.saturating_duration_since(now));
        waits.fold(FIRST_PAUSE, Duration::min)
    }

    /// Whether a worker without a job may still get one of this list.
    pub(crate) fn is_undecided(&self) -> bool {
        !(self.elsewhere.is_empty() && self.asking.is_empty())
    }

    /// Whether other campaigns do all remaining jobs.
    pub(crate) fn waits_for_others(&self) -> bool {
        self.waiting.is_empty() && self.running.is_empty()
    }

    /// Keeps the time since which other campaigns do all remaining jobs.
    pub(crate) fn note_waiting(&mut self) {
        self.waiting_since = self
            .waits_for_others()
            .then(|| self.waiting_since.unwrap_or_else(Instant::now));
    }

    /// Whether other campaigns have done all remaining jobs for longer than the limit.
    pub(crate) fn has_waited_for(&self, limit: Option<Duration>) -> bool {
        let since = self.waiting_since.filter(|_| !self.elsewhere.is_empty());
        since
            .zip(limit)
            .is_some_and(|(since, limit)| since.elapsed() >= limit)
    }

    /// Remaining work of the list and of the loop. Runs that other campaigns do count as running.
    pub(crate) fn workload(&self, jobs: &[Job<'_>], pace: &Pace, workers: usize) -> Workload {
        let cost = |i: &usize| jobs.get(*i).map_or(0.0, |job| job.cost);
        let elsewhere = self
            .elsewhere
            .iter()
            .map(|other| (&other.job, &other.since));
        let (cost_running, time_running_s) = self
            .running
            .iter()
            .chain(elsewhere)
            .map(|(i, begin)| (cost(i), begin.elapsed().as_secs_f64()))
            .unzip();
        Workload {
            pace_s: pace.seconds_per_cost(),
            cost_running,
            time_running_s,
            cost_waiting: self.asking.iter().chain(&self.waiting).map(cost).collect(),
            ahead: pace.ahead(),
            workers,
        }
    }
}

/// Locks the board; a listener that panicked leaves it whole.
pub(crate) fn lock(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::Elsewhere;

    /// 0.2 s, 1.5 times as long each time, at most 2 s.
    #[test]
    fn looks_at_the_run_of_another_become_rarer() {
        let mut met = Elsewhere::met(3, None);
        let first = met;
        let mut pauses_s = Vec::new();
        for _ in 0..8 {
            pauses_s.push((met.pause.as_secs_f64() * 1000.0).round() / 1000.0);
            met = Elsewhere::met(3, Some(met));
        }
        assert_eq!(
            pauses_s,
            [0.2, 0.3, 0.45, 0.675, 1.013, 1.519, 2.0, 2.0],
            "s"
        );
        assert_eq!((met.job, met.since), (first.job, first.since));
    }
}
