//! What the runs of a design table would cost.

use super::DesignTable;
use crate::file::Budget;
use crate::{Error, price};
use campaign::run_store::{Lookup, Record, Store};
use campaign::{RunRequest, Simulator};
use inference::{PlannedStage, RunList};
use serde::Serialize;

/// Cost of the runs of a design table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignPlan {
    /// Rows of the table.
    pub rows: usize,
    /// Runs of all rows.
    pub runs: usize,
    /// Runs whose records are in the folder already.
    pub kept: usize,
    /// Time of one core of the others, s.
    pub core_s: f64,
    /// Whether the time follows from the runs that are kept, and not from a guess.
    pub measured: bool,
}

impl DesignTable {
    /// Cost of the runs, by the pace of those that a store has, or by a guess.
    ///
    /// # Errors
    ///
    /// A record that cannot be read.
    pub fn plan(
        &self,
        simulator: &dyn Simulator,
        store: Option<&Store>,
    ) -> Result<DesignPlan, Error> {
        let (mut kept, mut open) = (Vec::new(), Vec::new());
        for request in self.requests() {
            if is_kept(simulator, &request, store)? {
                kept.push(request);
            } else {
                open.push(request);
            }
        }
        let n_kept = kept.len();
        let stage = |name: &str, requests| PlannedStage {
            stage: name.to_owned(),
            certain: vec![RunList::once(requests)],
            further: Vec::new(),
        };
        let stages = [stage("kept", kept), stage("open", open)];
        let price = price::of(simulator, &stages, Budget::default(), store)?;
        Ok(DesignPlan {
            rows: self.n_rows(),
            runs: price.runs,
            kept: n_kept,
            core_s: price.stages.last().map_or(0.0, |stage| stage.core_s),
            measured: price.measured,
        })
    }
}

/// Whether a store has the record of a run.
pub(super) fn is_kept(
    simulator: &dyn Simulator,
    request: &RunRequest,
    store: Option<&Store>,
) -> Result<bool, Error> {
    let inputs = simulator.prepare(request).and_then(|run| run.inputs());
    let (Some(store), Ok(inputs)) = (store, inputs) else {
        return Ok(false);
    };
    let blank = Record::new(&simulator.version(), inputs, request.seed)?;
    Ok(matches!(store.get(blank.key())?, Lookup::Found(_)))
}
