//! Doing a list of runs, once each, on several threads.

use run_store::{Lookup, Record, Store};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::time_left::Workload;
use crate::{Error, Progress, ProgressState, RunRequest, Simulator, SimulatorError};

/// Runs lists of requests against a store.
#[derive(Clone, Copy)]
pub struct Campaign<'a> {
    /// Where records are looked up and kept.
    store: &'a Store,
    /// Number of runs at a time.
    threads: usize,
    /// Who hears of it.
    progress: &'a dyn Progress,
    /// Raised by someone who wants no further run to start.
    stop: Option<&'a AtomicBool>,
    /// Runs of later lists, for workers that have nothing left to do.
    meanwhile: &'a [RunRequest],
}

impl fmt::Debug for Campaign<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Campaign")
            .field("store", &self.store)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// A run that the campaign asks for, whoever asked and how often.
struct Job {
    /// The request, effects of amplitude 0 left out.
    request: RunRequest,
    /// The record without results.
    blank: Record,
    /// Relative time that it will take.
    cost: f64,
}

/// What the workers share.
struct Board {
    /// Jobs not yet begun, in the order in which they begin.
    waiting: VecDeque<usize>,
    /// Jobs of later lists not yet begun.
    later: VecDeque<Job>,
    /// Jobs in progress with the time of their begin.
    running: BTreeMap<usize, Instant>,
    /// What came of each job; none before its end.
    results: Vec<Option<Result<Record, Failure>>>,
    /// Number of jobs found in the store.
    reused: usize,
    /// Summed costs of the jobs finished in this campaign.
    cost_finished: f64,
    /// Summed times of those, s.
    time_finished_s: f64,
    /// Set when the store fails: a further run would be lost.
    broken: bool,
}

/// Why a job has no record.
enum Failure {
    /// The simulator gave none.
    Simulator(SimulatorError),
    /// The store did not take it.
    Store(run_store::Error),
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
            meanwhile: &[],
        }
    }

    /// Honours a flag: once it is true no further run begins, running ones are finished.
    #[must_use]
    pub fn with_stop(mut self, stop: &'a AtomicBool) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Names runs that later lists will ask for: while the last runs of a list keep it from its end, a
    /// worker that has nothing left to do begins one of these, if it can be about done by then. Their
    /// records wait in the store; one that fails is left to the list that asks for it.
    #[must_use]
    pub fn with_meanwhile(mut self, requests: &'a [RunRequest]) -> Self {
        self.meanwhile = requests;
        self
    }

    /// Gives the record of every request, in the order of the requests.
    ///
    /// Requests that are the same run (same model, parameters, condition, effects that are on,
    /// and seed) are run once. What the store has is not run again.
    ///
    /// # Errors
    ///
    /// [`Error::Run`] when runs failed, after all others were done; [`Error::Stopped`] when the
    /// flag was raised before the end; [`Error::Store`] when a request holds a number that is not
    /// finite, or the store cannot be read or written.
    pub fn run_all(
        &self,
        simulator: &dyn Simulator,
        requests: &[RunRequest],
    ) -> Result<Vec<Record>, Error> {
        let (jobs, job_of_request) = distinct_jobs(simulator, requests)?;
        let records = collect(&jobs, self.do_all(simulator, &jobs)?)?;
        Ok(job_of_request
            .into_iter()
            .filter_map(|job| records.get(job).cloned())
            .collect())
    }

    /// The same, but a run that fails costs its own record only: for each request, in order, the
    /// record or the reason of the failure.
    ///
    /// # Errors
    ///
    /// As [`Campaign::run_all`], without [`Error::Run`].
    pub fn run_each(
        &self,
        simulator: &dyn Simulator,
        requests: &[RunRequest],
    ) -> Result<Vec<Result<Record, String>>, Error> {
        let (jobs, job_of_request) = distinct_jobs(simulator, requests)?;
        let results = self.do_all(simulator, &jobs)?;
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
        Ok(job_of_request
            .into_iter()
            .filter_map(|job| each.get(job).cloned())
            .collect())
    }

    /// What comes of every job: from the store, or by running it.
    fn do_all(
        &self,
        simulator: &dyn Simulator,
        jobs: &[Job],
    ) -> Result<Vec<Option<Result<Record, Failure>>>, Error> {
        let begin = Instant::now();
        let mut board = self.look_up(jobs)?;
        if !board.waiting.is_empty() {
            board.later = self.later(simulator, jobs)?;
        }
        let workers = self.threads.min(board.waiting.len() + board.later.len());
        let board = Mutex::new(board);
        self.tell(jobs, &lock(&board), begin);
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(|| self.work(simulator, jobs, &board, begin));
            }
        });
        let board = board.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(board.results)
    }

    /// The jobs of later lists that are neither in this one nor in the store.
    fn later(&self, simulator: &dyn Simulator, jobs: &[Job]) -> Result<VecDeque<Job>, Error> {
        let (mut later, _) = distinct_jobs(simulator, self.meanwhile)?;
        let listed: BTreeSet<_> = jobs.iter().map(|job| job.blank.key()).collect();
        later.retain(|job| {
            let key = job.blank.key();
            !listed.contains(key) && matches!(self.store.get(key), Ok(Lookup::Absent))
        });
        Ok(later.into())
    }

    /// Finds what the store has, and orders the rest, longest first.
    fn look_up(&self, jobs: &[Job]) -> Result<Board, Error> {
        let mut results = Vec::with_capacity(jobs.len());
        for job in jobs {
            let found = self
                .store
                .get(job.blank.key())
                .map_err(|source| job.store_error(source))?;
            results.push(match found {
                Lookup::Found(record) => Some(Ok(record)),
                Lookup::Absent => None,
                Lookup::Mismatch { path, .. } => {
                    self.progress.warning(&format!(
                        "{} does not hold the run of its name; the run is done again",
                        path.display()
                    ));
                    None
                }
            });
        }
        let missing = |i: &usize| matches!(results.get(*i), Some(None));
        let mut waiting: Vec<usize> = (0..jobs.len()).filter(missing).collect();
        let cost = |i: &usize| jobs.get(*i).map_or(0.0, |job| job.cost);
        // A stable sort: equal costs stay in the order of the requests.
        waiting.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
        Ok(Board {
            reused: jobs.len() - waiting.len(),
            waiting: waiting.into(),
            later: VecDeque::new(),
            running: BTreeMap::new(),
            results,
            cost_finished: 0.0,
            time_finished_s: 0.0,
            broken: false,
        })
    }

    /// Takes jobs until none is left or the campaign is to stop.
    fn work(&self, simulator: &dyn Simulator, jobs: &[Job], board: &Mutex<Board>, begin: Instant) {
        while let Some((i, job)) = self.take(jobs, board) {
            let start = Instant::now();
            let result = self.run_and_store(simulator, job);
            let mut board = lock(board);
            board.running.remove(&i);
            board.cost_finished += job.cost;
            board.time_finished_s += start.elapsed().as_secs_f64();
            board.broken |= matches!(result, Err(Failure::Store(_)));
            if let Some(place) = board.results.get_mut(i) {
                *place = Some(result);
            }
            // Under the lock, so that the listener hears one thread at a time and in order.
            self.tell(jobs, &board, begin);
        }
        while let Some(job) = self.take_later(jobs, board) {
            // The list that asks for the run reports what is wrong with it.
            let _ = self.run_and_store(simulator, &job);
        }
    }

    /// Takes a job of a later list while jobs of this one run for at least half of its time, unless the
    /// campaign is to stop.
    fn take_later(&self, jobs: &[Job], board: &Mutex<Board>) -> Option<Job> {
        let mut board = lock(board);
        if self.must_stop(&board) {
            return None;
        }
        let workload = self.workload(jobs, &board);
        let needed = 0.5 * board.later.front()?.cost * workload.pace()?;
        if board.running.is_empty() || workload.time_left_s()? < needed {
            return None;
        }
        board.later.pop_front()
    }

    /// Whether no further run may begin.
    fn must_stop(&self, board: &Board) -> bool {
        board.broken || self.stop.is_some_and(|flag| flag.load(Ordering::SeqCst))
    }

    /// Takes the next job, or none when the campaign is over or to stop.
    fn take<'j>(&self, jobs: &'j [Job], board: &Mutex<Board>) -> Option<(usize, &'j Job)> {
        let mut board = lock(board);
        if self.must_stop(&board) {
            return None;
        }
        let i = board.waiting.pop_front()?;
        board.running.insert(i, Instant::now());
        jobs.get(i).map(|job| (i, job))
    }

    /// Does one run and keeps its record.
    fn run_and_store(&self, simulator: &dyn Simulator, job: &Job) -> Result<Record, Failure> {
        // A run that panics must not take the others with it; its state dies with it.
        let outcome = catch_unwind(AssertUnwindSafe(|| simulator.run(&job.request)))
            .unwrap_or_else(|panic| Err(panicked(panic.as_ref())))
            .map_err(Failure::Simulator)?;
        let record = job
            .blank
            .clone()
            .with_observables(outcome.observables)
            .map_err(|error| Failure::Simulator(SimulatorError::other(error)))?
            .with_details(outcome.details);
        self.store.put(&record).map_err(Failure::Store)?;
        Ok(record)
    }

    /// What is done of the list and what is left.
    fn workload(&self, jobs: &[Job], board: &Board) -> Workload {
        let cost = |i: &usize| jobs.get(*i).map_or(0.0, |job| job.cost);
        Workload {
            cost_finished: board.cost_finished,
            time_finished_s: board.time_finished_s,
            cost_running: board.running.keys().map(cost).collect(),
            time_running_s: board
                .running
                .values()
                .map(|start| start.elapsed().as_secs_f64())
                .collect(),
            cost_waiting: board.waiting.iter().map(cost).collect(),
            workers: self.threads,
        }
    }

    /// Tells the listener how far it is.
    fn tell(&self, jobs: &[Job], board: &Board, begin: Instant) {
        self.progress.update(&ProgressState {
            done: board.results.iter().flatten().count(),
            reused: board.reused,
            total: jobs.len(),
            running: board.running.len(),
            elapsed_s: begin.elapsed().as_secs_f64(),
            left_s: self.workload(jobs, board).time_left_s(),
        });
    }
}

impl Job {
    /// Names the request in an error of the store.
    fn store_error(&self, source: run_store::Error) -> Error {
        Error::Store {
            request: Box::new(self.request.clone()),
            source,
        }
    }
}

/// Finds the different runs among the requests, and for each request its run.
fn distinct_jobs(
    simulator: &dyn Simulator,
    requests: &[RunRequest],
) -> Result<(Vec<Job>, Vec<usize>), Error> {
    let version = simulator.version();
    let mut jobs: Vec<Job> = Vec::new();
    let mut by_key: BTreeMap<String, usize> = BTreeMap::new();
    let mut job_of_request = Vec::with_capacity(requests.len());
    for request in requests {
        let request = request.normalised();
        let blank = Record::new(&version, request.inputs(), request.seed).map_err(|source| {
            Error::Store {
                request: Box::new(request.clone()),
                source,
            }
        })?;
        let i = *by_key.entry(blank.key().to_owned()).or_insert(jobs.len());
        job_of_request.push(i);
        if i == jobs.len() {
            let cost = simulator.expected_cost(&request);
            jobs.push(Job {
                request,
                blank,
                cost: if cost.is_finite() && cost > 0.0 {
                    cost
                } else {
                    1.0
                },
            });
        }
    }
    Ok((jobs, job_of_request))
}

/// Gives the records of all jobs, or the first failure with its request.
fn collect(
    jobs: &[Job],
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

/// Puts a panic of the simulator into an error.
fn panicked(panic: &(dyn std::any::Any + Send)) -> SimulatorError {
    let message = panic
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned());
    SimulatorError::Panicked { message }
}

/// Locks the board; a listener that panicked leaves it whole.
fn lock(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}
