//! Who does the runs of a study, and what becomes of those that fail.
//!
//! A setting at a condition is a cell, and its mean is one over replicates. A run that fails is left out of its cell as long
//! as two others remain, which give a mean and a scatter.

use super::ResidualPlan;
use crate::Error;
use campaign::run_store::Record;
use campaign::{Campaign, RunRequest, Simulator};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Replicates that a cell needs: fewer have no scatter.
const LEAST: usize = 2;

/// What a run gave: its record, or why there is none.
pub(super) type Ran = Result<Record, String>;

/// A cell that failed runs leave without a mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Short {
    /// Its number in the list.
    pub(super) cell: usize,
    /// Runs of it that gave a result.
    left: usize,
    /// Why the first of the others failed.
    pub(super) reason: String,
}

/// Who does the runs. A run that failed is not tried again in this study.
pub(super) struct Worker<'a> {
    campaign: &'a Campaign<'a>,
    simulator: &'a dyn Simulator,
    /// Why runs failed, by their requests.
    failed: RefCell<BTreeMap<String, String>>,
    /// Runs that were left out of the means of their cells, one sentence each.
    left_out: RefCell<Vec<String>>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(campaign: &'a Campaign<'a>, simulator: &'a dyn Simulator) -> Self {
        Self {
            campaign,
            simulator,
            failed: RefCell::default(),
            left_out: RefCell::default(),
        }
    }

    /// Result of each request, in their order.
    ///
    /// # Errors
    ///
    /// A campaign that was stopped, or whose store cannot be used.
    pub(super) fn each(&self, requests: &[RunRequest]) -> Result<Vec<Ran>, Error> {
        let known: Vec<Option<String>> = {
            let failed = self.failed.borrow();
            let why = |request| failed.get(&name(request)).cloned();
            requests.iter().map(why).collect()
        };
        let open = requests.iter().zip(&known).filter(|(_, why)| why.is_none());
        let open: Vec<RunRequest> = open.map(|(request, _)| request.clone()).collect();
        let mut done = self.campaign.run_each(self.simulator, &open)?.into_iter();
        let mut results = Vec::with_capacity(requests.len());
        for (request, why) in requests.iter().zip(known) {
            let result = why.map_or_else(|| done.next(), |why| Some(Err(why)));
            if let Some(Err(why)) = &result {
                let mut failed = self.failed.borrow_mut();
                failed.insert(name(request), why.clone());
            }
            results.extend(result);
        }
        Ok(results)
    }

    /// The records of cells of `r` replicates, none for a run that is left out; or the first cell that keeps fewer than two.
    pub(super) fn borne<'r>(
        &self,
        requests: &[RunRequest],
        results: &'r [Ran],
        r: usize,
    ) -> Result<Vec<Option<&'r Record>>, Short> {
        if let Some(short) = first_short(results, r) {
            return Err(short);
        }
        for (request, result) in requests.iter().zip(results) {
            if let Err(why) = result {
                let text = format!("a run is left out of its mean: {request}: {why}");
                let mut left_out = self.left_out.borrow_mut();
                if !left_out.contains(&text) {
                    left_out.push(text);
                }
            }
        }
        Ok(results.iter().map(|result| result.as_ref().ok()).collect())
    }

    /// Runs that were left out of the means of their cells, one sentence each.
    pub(super) fn left_out(&self) -> Vec<String> {
        self.left_out.borrow().clone()
    }
}

/// The first cell of `r` replicates that keeps fewer than two.
fn first_short(results: &[Ran], r: usize) -> Option<Short> {
    let mut cells = results.chunks(r.max(1)).enumerate();
    cells.find_map(|(cell, runs)| {
        let left = runs.iter().filter(|run| run.is_ok()).count();
        let reason = runs.iter().find_map(|run| run.as_ref().err())?;
        (left < LEAST).then(|| Short {
            cell,
            left,
            reason: reason.clone(),
        })
    })
}

impl Short {
    /// As an error, for cells at the conditions of these numbers.
    pub(super) fn error(self, plan: &ResidualPlan, conditions: &[usize]) -> Error {
        let condition = conditions[self.cell % conditions.len().max(1)];
        Error::Cell {
            name: plan.conditions[condition].name(&plan.base.model),
            condition,
            left: self.left,
            of: plan.replicates,
            reason: self.reason,
        }
    }
}

fn name(request: &RunRequest) -> String {
    // Values of one name each: maps of text and numbers have a form in JSON.
    serde_json::to_string(request).unwrap_or_else(|_| request.to_string())
}
