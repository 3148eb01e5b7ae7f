//! From requests to runs: which requests are the same run, and which are refused.

use crate::run_store::Record;
use std::collections::BTreeMap;

use crate::{Error, RunRequest, Simulator, SimulatorError};

/// A run of the campaign, whatever the number of its requests.
#[derive(Debug)]
pub(crate) struct Job {
    /// The first request for it, without effects of amplitude 0.
    pub(crate) request: RunRequest,
    /// The record without results.
    pub(crate) blank: Record,
    /// Relative time that it will take.
    pub(crate) cost: f64,
}

/// Requests sorted into runs.
#[derive(Debug)]
pub(crate) struct JobList {
    /// The different runs, in the order of their first requests.
    pub(crate) jobs: Vec<Job>,
    /// For each request its run, or the reason for its refusal.
    pub(crate) of_request: Vec<Result<usize, SimulatorError>>,
}

impl Job {
    /// Names the request in an error of the store.
    pub(crate) fn store_error(&self, source: crate::run_store::Error) -> Error {
        Error::Store {
            request: Box::new(self.request.clone()),
            source,
        }
    }
}

impl JobList {
    /// Sorts requests into runs by the key of their inputs: two requests with the same inputs and seed are one
    /// run, whatever they call their model.
    pub(crate) fn new(simulator: &dyn Simulator, requests: &[RunRequest]) -> Self {
        let version = simulator.version();
        let mut jobs: Vec<Job> = Vec::new();
        let mut by_key: BTreeMap<String, usize> = BTreeMap::new();
        let mut of_request = Vec::with_capacity(requests.len());
        for request in requests {
            let request = request.normalised();
            of_request.push(blank(simulator, &version, &request).map(|blank| {
                let i = *by_key.entry(blank.key().to_owned()).or_insert(jobs.len());
                if i == jobs.len() {
                    let cost = usable(simulator.expected_cost(&request));
                    jobs.push(Job {
                        request,
                        blank,
                        cost,
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
    ) -> Result<(Vec<Job>, Vec<usize>), Error> {
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

/// The record of a request before it is run.
fn blank(
    simulator: &dyn Simulator,
    version: &str,
    request: &RunRequest,
) -> Result<Record, SimulatorError> {
    let inputs = simulator.inputs(request)?;
    Record::new(version, inputs, request.seed).map_err(SimulatorError::other)
}

/// A cost that can be ordered and summed.
fn usable(cost: f64) -> f64 {
    if cost.is_finite() && cost > 0.0 {
        cost
    } else {
        1.0
    }
}
