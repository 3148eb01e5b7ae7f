//! Execution of a list of runs, once each, on several threads.

use crate::run_store::{CLAIM_LIFE, Record, Store};
use std::fmt;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::board::{Failure, lock};
use crate::claims::Keeper;
use crate::jobs::{Job, JobList};
use crate::simulator::with_further;
use crate::time_left::end_of_last;
use crate::workers::Hall;
use crate::{Cores, Error, Pace, Progress, RunRequest, Simulator};

/// Runs lists of requests against a store.
#[derive(Clone, Copy)]
pub struct Campaign<'a> {
    /// The store of the records.
    pub(crate) store: &'a Store,
    /// Number of runs at a time.
    pub(crate) threads: usize,
    /// The listener.
    pub(crate) progress: &'a dyn Progress,
    /// Raised to stop: no further run starts.
    pub(crate) stop: Option<&'a AtomicBool>,
    /// Measured and expected work of the lists of one loop; if absent, each list is estimated alone.
    pub(crate) pace: Option<&'a Pace>,
    /// Longest wait for the runs of others; `None` is without limit.
    pub(crate) wait: Option<Duration>,
    /// Time after which a claim without renewal is dead.
    pub(crate) claim_life: Duration,
}

impl fmt::Debug for Campaign<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Campaign")
            .field("store", &self.store)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

impl<'a> Campaign<'a> {
    /// Prepares a campaign of `threads` runs at a time; 0 means one per core.
    pub fn new(store: &'a Store, threads: usize, progress: &'a dyn Progress) -> Self {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            store,
            threads: if threads == 0 { cores() } else { threads },
            progress,
            stop: None,
            pace: None,
            wait: None,
            claim_life: CLAIM_LIFE,
        }
    }

    /// Honours a flag: once it is true no further run begins. Running ones are finished unless the simulator honours the
    /// flag as well; a run that it interrupts counts as not done.
    #[must_use]
    pub fn with_stop(mut self, stop: &'a AtomicBool) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Shares the pace of all lists of one loop, so that a list knows from its start its duration and that of the rest of the
    /// loop.
    #[must_use]
    pub fn with_pace(mut self, pace: &'a Pace) -> Self {
        self.pace = Some(pace);
        self
    }

    /// Sets the plan from here on, if the lists share a pace: the [length](Self::length_of) of all lists of the stage that
    /// begins, and of the following stages, at least and at most. The time left is then that of the whole loop. Each list of the
    /// stage subtracts its own length when it begins.
    pub fn expect(&self, stage: [f64; 2], later: [f64; 2]) {
        if let Some(pace) = self.pace {
            pace.expect(stage, later);
        }
    }

    /// Length of a list of runs with these costs, in the order in which they begin: the costs of the runs that are done behind each
    /// other on the busiest thread.
    pub fn length_of(&self, costs: impl Iterator<Item = f64>) -> f64 {
        end_of_last(vec![0.0; self.threads.max(1)], costs)
    }

    /// Limits the time that this campaign waits, without a run of its own, for runs that others do in the same folder; by
    /// default it waits for their end. With a limit below [`CLAIM_LIFE`] nobody would do the runs of a machine that died.
    #[must_use]
    pub fn with_wait(mut self, wait: Option<Duration>) -> Self {
        self.wait = wait;
        self
    }

    /// Sets the time after which another campaign takes a run over that this one has claimed and, since it was killed
    /// on another machine or lost its file system, does not claim any more. [`CLAIM_LIFE`] where it is not set.
    #[must_use]
    pub fn with_claim_life(mut self, life: Duration) -> Self {
        self.claim_life = life;
        self
    }

    /// Gives the record of every request, in the order of the requests.
    ///
    /// Requests that are the same run (same inputs, as the simulator states them, and seed) are run once. Runs in the
    /// store are not repeated, and runs in progress in another campaign of the folder are left to it.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] if a request is invalid, before anything is run; [`Error::Run`] when runs failed,
    /// after all others were done; [`Error::Stopped`] when the flag was raised before the end; [`Error::Waited`] when the limit
    /// of [`Campaign::with_wait`] was reached; [`Error::Store`] when the store cannot be read or written.
    pub fn run_all(
        &self,
        simulator: &dyn Simulator,
        requests: &[RunRequest],
    ) -> Result<Vec<Record>, Error> {
        let list = JobList::new(simulator, requests);
        let (jobs, job_of_request) = list.all_accepted(requests)?;
        let records = collect(&jobs, self.do_all(&jobs)?)?;
        let read = requests.iter().zip(job_of_request);
        let read = read.filter_map(|(request, job)| Some((request, records.get(job)?.clone())));
        read.map(|(request, record)| {
            with_further(simulator, request, record).map_err(|source| Error::Run {
                request: Box::new(request.clone()),
                source,
                n_failed: 1,
                n_runs: jobs.len(),
            })
        })
        .collect()
    }

    /// The same, but a run that fails or a request that is refused costs its own record only: for each request,
    /// in order, the record or the reason why there is none.
    ///
    /// # Errors
    ///
    /// As [`Campaign::run_all`], without [`Error::Run`] and [`Error::Refused`].
    pub fn run_each(
        &self,
        simulator: &dyn Simulator,
        requests: &[RunRequest],
    ) -> Result<Vec<Result<Record, String>>, Error> {
        let JobList { jobs, of_request } = JobList::new(simulator, requests);
        let results = self.do_all(&jobs)?;
        let n_done = results.iter().flatten().filter(|r| r.is_ok()).count();
        let mut each = Vec::with_capacity(jobs.len());
        for (job, result) in jobs.iter().zip(results) {
            each.push(match result {
                Some(Ok(record)) => Ok(record),
                Some(Err(Failure::Simulator(error))) => Err(error.in_full()),
                Some(Err(Failure::Store(source))) => return Err(job.store_error(source)),
                None => {
                    return Err(Error::Stopped {
                        n_done,
                        n_runs: jobs.len(),
                    });
                }
            });
        }
        let read = |request, record: Record| {
            with_further(simulator, request, record).map_err(|error| error.in_full())
        };
        let jobs_of = requests.iter().zip(of_request);
        Ok(jobs_of
            .filter_map(|(request, job)| match job {
                Ok(job) => Some(each.get(job)?.clone().and_then(|r| read(request, r))),
                Err(refusal) => Some(Err(refusal.in_full())),
            })
            .collect())
    }

    /// Result of every job: from the store, or by running it.
    fn do_all(&self, jobs: &[Job<'_>]) -> Result<Vec<Option<Result<Record, Failure>>>, Error> {
        let own = Pace::new();
        let pace = self.pace.unwrap_or(&own);
        pace.begin_list(self.length_of(jobs.iter().map(|job| job.cost)));
        let board = self.look_up(jobs)?;
        for (job, result) in jobs.iter().zip(&board.results) {
            if let Some(result) = result {
                self.tell_end(job, result);
            }
        }
        let workers = self.threads.min(board.waiting.len());
        let board = Mutex::new(board);
        self.tell(jobs, &lock(&board), pace);
        let keeper = Keeper::new(self.store, self.claim_life);
        let hall = Hall {
            jobs,
            board: &board,
            pace,
            keeper: &keeper,
            cores: Cores::new(self.threads, workers),
        };
        self.work_all(&hall, workers);
        let board = board.into_inner().unwrap_or_else(PoisonError::into_inner);
        if board.has_waited_for(self.wait) {
            return Err(Error::Waited {
                n_left: board.elsewhere.len(),
                n_runs: jobs.len(),
            });
        }
        Ok(board.results)
    }
}

/// Gives the records of all jobs, or the first failure with its request.
fn collect(
    jobs: &[Job<'_>],
    results: Vec<Option<Result<Record, Failure>>>,
) -> Result<Vec<Record>, Error> {
    let n_done = results.iter().flatten().filter(|r| r.is_ok()).count();
    let n_failed = results.iter().flatten().filter(|r| r.is_err()).count();
    let mut records = Vec::with_capacity(jobs.len());
    let mut first_failure = None;
    for (job, result) in jobs.iter().zip(results) {
        match result {
            Some(Ok(record)) => records.push(record),
            Some(Err(Failure::Store(source))) => return Err(job.store_error(source)),
            Some(Err(Failure::Simulator(source))) if first_failure.is_none() => {
                first_failure = Some((job, source));
            }
            Some(Err(Failure::Simulator(_))) | None => {}
        }
    }
    if let Some((job, source)) = first_failure {
        return Err(Error::Run {
            request: Box::new(job.request.clone()),
            source,
            n_failed,
            n_runs: jobs.len(),
        });
    }
    if records.len() < jobs.len() {
        return Err(Error::Stopped {
            n_done,
            n_runs: jobs.len(),
        });
    }
    Ok(records)
}
