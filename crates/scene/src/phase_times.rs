//! Where the time of a run goes.

use serde::{Deserialize, Serialize};
use std::ops::AddAssign;
use std::time::Instant;

/// Where the time of a run went, s by the clock; that of its last part where it went on from a kept state.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseTimes {
    /// Shapes filled with spheres, seeds put in their places.
    pub building_s: f64,
    /// Seeds fell into place.
    pub settling_s: f64,
    /// The drive turned, and the bed was not steady yet or not for long enough.
    pub start_up_s: f64,
    /// What is measured moved: a steady bed, a bed that runs out, the seeds of a bench test.
    pub measuring_s: f64,
    /// Pictures were drawn and read.
    pub reading_s: f64,
}

impl PhaseTimes {
    /// Sum of all, s.
    pub fn total_s(&self) -> f64 {
        self.named().iter().map(|(_, time)| time).sum()
    }

    /// The phases in their order, by the names that people read, s.
    pub fn named(&self) -> [(&'static str, f64); 5] {
        [
            ("building", self.building_s),
            ("settling", self.settling_s),
            ("start-up", self.start_up_s),
            ("measuring", self.measuring_s),
            ("reading pictures", self.reading_s),
        ]
    }
}

impl AddAssign for PhaseTimes {
    fn add_assign(&mut self, other: Self) {
        self.building_s += other.building_s;
        self.settling_s += other.settling_s;
        self.start_up_s += other.start_up_s;
        self.measuring_s += other.measuring_s;
        self.reading_s += other.reading_s;
    }
}

/// Cost of the runs in a folder and of a call that asks for them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeSpent {
    /// Time of one core that all runs took whose records are in the folder, s.
    pub core_s: f64,
    /// Where that time went, by the clock of each run.
    pub phases: PhaseTimes,
    /// Time of the call by the clock, s; small where records were found again.
    pub wall_s: f64,
    /// Time of the call in which its threads computed no run, s: they waited for the last of a stage, and surfaces were
    /// fitted. `None` if a batch system does the runs.
    pub waiting_s: Option<f64>,
}

/// Takes the time from one phase to the next.
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the last lap, s.
    pub(crate) fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let lap = now - std::mem::replace(&mut self.0, now);
        lap.as_secs_f64()
    }
}
