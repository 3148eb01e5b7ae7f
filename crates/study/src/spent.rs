//! What the runs of a study and a call cost.

use crate::Error;
use crate::price::of_core;
use campaign::run_store::{Lookup, Store};
use scene::{PhaseTimes, TimeSpent};
use simulators::scene_simulator::RunDetails;
use std::time::Instant;

/// Takes the cost of a call.
pub(crate) struct Spending<'a> {
    store: &'a Store,
    begin: Instant,
    before: f64,
}

impl<'a> Spending<'a> {
    /// Begins with the runs that a store has.
    pub(crate) fn begin(store: &'a Store) -> Result<Self, Error> {
        Ok(Self {
            store,
            begin: Instant::now(),
            before: core_seconds(store)?.0,
        })
    }

    /// Cost up to now with this number of threads. The runs of other processes in the folder count as own.
    pub(crate) fn end(&self, threads: usize) -> Result<TimeSpent, Error> {
        let wall_s = self.begin.elapsed().as_secs_f64();
        let (core_s, phases) = core_seconds(self.store)?;
        let idle = threads as f64 * wall_s - (core_s - self.before);
        Ok(TimeSpent {
            core_s,
            phases,
            wall_s,
            waiting_s: Some(idle.max(0.0)),
        })
    }
}

/// Time of one core that the runs in a store took, s, and where it went. Other files are left out, and runs of other
/// programs have no phases.
pub(crate) fn core_seconds(store: &Store) -> Result<(f64, PhaseTimes), Error> {
    let (mut sum, mut phases) = (0.0, PhaseTimes::default());
    for key in store.keys()? {
        let Lookup::Found(record) = store.get(&key)? else {
            continue;
        };
        if let Ok(details) = RunDetails::of(&record) {
            sum += of_core(&details.timing);
            phases += details.timing.phases.unwrap_or_default();
        }
    }
    Ok((sum, phases))
}
