//! Where the time of the steps goes.

use std::time::Instant;

/// Time by the clock that the phases of the steps took, s: sums over all steps since counting began.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepPhases {
    /// The search for pairs of bodies, in the steps that make it.
    pub search: f64,
    /// Contacts of bodies with each other and with walls that are not triangles.
    pub contacts: f64,
    /// Contacts with walls of triangles, and liquid.
    pub triangles: f64,
    /// Further forces, such as those of bonds.
    pub further: f64,
    /// Motion of the bodies.
    pub motion: f64,
}

impl StepPhases {
    /// Adds the phases of a step, in the order of the fields, s.
    pub(crate) fn add(&mut self, [search, contacts, triangles, further, motion]: [f64; 5]) {
        self.search += search;
        self.contacts += contacts;
        self.triangles += triangles;
        self.further += further;
        self.motion += motion;
    }

    /// Their sum, s.
    pub fn total(&self) -> f64 {
        self.search + self.contacts + self.triangles + self.further + self.motion
    }
}

/// A clock that is read only where it is asked for.
#[derive(Debug)]
pub(crate) struct Clock(Option<Instant>);

impl Clock {
    /// Starts it where `runs`.
    pub(crate) fn start(runs: bool) -> Self {
        Self(runs.then(Instant::now))
    }

    /// Time since the last reading, s; 0 of one that does not run.
    pub(crate) fn lap(&mut self) -> f64 {
        self.0.as_mut().map_or(0.0, |before| {
            let now = Instant::now();
            let lap = now.duration_since(*before).as_secs_f64();
            *before = now;
            lap
        })
    }
}
