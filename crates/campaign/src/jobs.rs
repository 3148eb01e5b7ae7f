//! From requests to runs: which requests are the same run, and which are refused.

use crate::run_store::Record;
use std::collections::BTreeMap;

use crate::{Error, PreparedRun, RunRequest, Simulator, SimulatorError};

/// A run of the campaign, whatever the number of its requests.
pub(crate) struct Job<'s> {
    /// The first request for it, without effects of amplitude 0.
    pub(crate) request: RunRequest,
    /// The record without results.
    pub(crate) blank: Record,
    /// The run, ready to be done.
    pub(crate) prepared: Box<dyn PreparedRun + 's>,
    /// Relative time that it will take.
    pub(crate) cost: f64,
}

/// Requests sorted into runs.
pub(crate) struct JobList<'s> {
    /// The different runs, in the order of their first requests.
    pub(crate) jobs: Vec<Job<'s>>,
    /// For each request its run, or the reason for its refusal.
    pub(crate) of_request: Vec<Result<usize, SimulatorError>>,
}

impl Job<'_> {
    /// Names the request in an error of the store.
    pub(crate) fn store_error(&self, source: crate::run_store::Error) -> Error {
        Error::Store {
            request: Box::new(self.request.clone()),
            source,
        }
    }
}

impl<'s> JobList<'s> {
    /// Sorts requests into runs by the key of their inputs: two requests with the same inputs and seed are one
    /// run, whatever they call their model.
    pub(crate) fn new(simulator: &'s dyn Simulator, requests: &[RunRequest]) -> Self {
        let version = simulator.version();
        let mut jobs: Vec<Job<'s>> = Vec::new();
        let mut by_key: BTreeMap<String, usize> = BTreeMap::new();
        let mut of_request = Vec::with_capacity(requests.len());
        for request in requests {
            let request = request.normalised();
            let prepared = simulator.prepare(&request);
            let with_blank = prepared.and_then(|prepared| {
                let blank = Record::new(&version, prepared.inputs()?, request.seed);
                Ok((prepared, blank.map_err(SimulatorError::other)?))
            });
            of_request.push(with_blank.map(|(prepared, blank)| {
                let i = *by_key.entry(blank.key().to_owned()).or_insert(jobs.len());
                if i == jobs.len() {
                    jobs.push(Job {
                        request,
                        blank,
                        cost: usable(prepared.cost()),
                        prepared,
                    });
                }
                i
            }));
        }
        Self { jobs, of_request }
    }

    /// The run of every request.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] with the first refused request.
    pub(crate) fn all_accepted(
        self,
        requests: &[RunRequest],
    ) -> Result<(Vec<Job<'s>>, Vec<usize>), Error> {
        let n_refused = self.of_request.iter().filter(|job| job.is_err()).count();
        let n_requests = requests.len();
        let mut of_request = Vec::with_capacity(n_requests);
        for (request, job) in requests.iter().zip(self.of_request) {
            of_request.push(job.map_err(|source| Error::Refused {
                request: Box::new(request.clone()),
                source,
                n_refused,
                n_requests,
            })?);
        }
        Ok((self.jobs, of_request))
    }
}

/// A cost that can be ordered and summed.
fn usable(cost: f64) -> f64 {
    if cost.is_finite() && cost > 0.0 {
        cost
    } else {
        1.0
    }
}
