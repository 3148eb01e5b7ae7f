//! Pace of the runs of a loop, and the remaining work.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The pace of all lists of one loop: measured time of the finished runs over their expected cost, when the loop began, and the
/// length of the lists ahead.
///
/// A list that shares it can estimate the time of its runs from the start, once a run of any earlier list
/// is finished.
#[derive(Debug)]
pub struct Pace {
    /// When the loop began.
    begin: Instant,
    /// Measurements so far.
    measured: Mutex<Measured>,
    /// Expected work.
    ahead: Mutex<Ahead>,
}

/// Length of the lists ahead, at least and at most, in costs of runs behind each other.
#[derive(Debug, Clone, Copy, Default)]
struct Ahead {
    /// Lists of the present stage.
    stage: [f64; 2],
    /// Lists of the following stages.
    later: [f64; 2],
}

/// Sums over the finished runs.
#[derive(Debug, Clone, Copy, Default)]
struct Measured {
    /// Expected costs, in the unit of the simulator.
    cost: f64,
    /// Times that the runs took, s.
    time_s: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self::new()
    }
}

impl Pace {
    /// Begins a loop now, with nothing measured.
    pub fn new() -> Self {
        Self {
            begin: Instant::now(),
            measured: Mutex::default(),
            ahead: Mutex::default(),
        }
    }

    /// Mean time of a run of cost 1 so far, s: the sum of the times over the sum of the costs; `None` before a
    /// run is finished.
    pub fn seconds_per_cost(&self) -> Option<f64> {
        let sums = *self.measured.lock().unwrap_or_else(PoisonError::into_inner);
        (sums.cost > 0.0).then(|| sums.time_s / sums.cost)
    }

    /// Time since the loop began, s.
    pub fn elapsed_s(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// Sets the lists ahead: those of the stage that begins, and of the following stages.
    pub(crate) fn expect(&self, stage: [f64; 2], later: [f64; 2]) {
        *self.ahead.lock().unwrap_or_else(PoisonError::into_inner) = Ahead { stage, later };
    }

    /// Removes a list that begins from the lists ahead.
    pub(crate) fn begin_list(&self, length: f64) {
        let mut ahead = self.ahead.lock().unwrap_or_else(PoisonError::into_inner);
        ahead.stage = ahead.stage.map(|stage| (stage - length).max(0.0));
    }

    /// Length of all lists ahead, at least and at most.
    pub(crate) fn ahead(&self) -> [f64; 2] {
        let ahead = *self.ahead.lock().unwrap_or_else(PoisonError::into_inner);
        [0, 1].map(|end| ahead.stage[end] + ahead.later[end])
    }

    /// Adds a finished run: its expected cost, and the time that it took, s.
    pub(crate) fn add(&self, cost: f64, time_s: f64) {
        let mut sums = self.measured.lock().unwrap_or_else(PoisonError::into_inner);
        sums.cost += cost;
        sums.time_s += time_s;
    }
}
