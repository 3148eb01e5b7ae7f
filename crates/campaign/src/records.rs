//! Records of a campaign that the store already has.

use crate::run_store::{Lookup, Record};
use std::collections::{BTreeMap, BTreeSet};

use crate::board::Board;
use crate::jobs::Job;
use crate::{Campaign, Error};

/// Number of attempts to read a record that others replace meanwhile.
const LOOKS: usize = 4;

impl Campaign<'_> {
    /// The record of a job, if the store has it. Any other file of its name is reported and set aside.
    pub(crate) fn stored(
        &self,
        job: &Job<'_>,
        warn: &dyn Fn(&str),
    ) -> Result<Option<Record>, crate::run_store::Error> {
        for _ in 0..LOOKS {
            let (path, reason) = match self.store.get(job.blank.key())? {
                Lookup::Found(record) => return Ok(Some(record)),
                Lookup::Absent => return Ok(None),
                Lookup::Damaged { path, reason } => (path, reason),
            };
            if let Some(away) = self.store.set_aside(&path)? {
                let name = away.file_name().unwrap_or(away.as_os_str());
                warn(&format!(
                    "{} is not the record of its run: {reason}; it is set aside as {}, and the run is done again",
                    path.display(),
                    name.display()
                ));
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// Finds the records of the store, and orders the other jobs, longest first.
    pub(crate) fn look_up(&self, jobs: &[Job<'_>]) -> Result<Board, Error> {
        let mut results = Vec::with_capacity(jobs.len());
        let warn = |text: &str| self.progress.warning(text);
        for job in jobs {
            let found = self.stored(job, &warn);
            let found = found.map_err(|source| job.store_error(source))?;
            results.push(found.map(Ok));
        }
        let missing = |i: &usize| matches!(results.get(*i), Some(None));
        let mut waiting: Vec<usize> = (0..jobs.len()).filter(missing).collect();
        let cost = |i: &usize| jobs.get(*i).map_or(0.0, |job| job.cost);
        // A stable sort: equal costs stay in the order of the requests.
        waiting.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
        Ok(Board {
            reused: jobs.len() - waiting.len(),
            waiting: waiting.into(),
            asking: BTreeSet::new(),
            elsewhere: Vec::new(),
            running: BTreeMap::new(),
            results,
            broken: false,
            told_of_others: false,
            waiting_since: None,
        })
    }
}
