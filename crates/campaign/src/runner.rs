//! Doing a list of runs, once each, on several threads.

use run_store::{Lookup, Record, Store};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::jobs::{Job, JobList};
use crate::time_left::Workload;
use crate::{
    Error, Executor, Pace, PendingRun, Progress, ProgressState, RunEvent, RunRequest, Simulator,
    SimulatorError,
};

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
    /// Expected cost of all runs that later lists will ask for.
    ahead: f64,
    /// What the lists of one loop measured so far; each list measures alone where absent.
    pace: Option<&'a Pace>,
    /// Does the runs in place of the threads of this process.
    executor: Option<&'a dyn Executor>,
}

impl fmt::Debug for Campaign<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Campaign")
            .field("store", &self.store)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
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
    /// Expected cost of what later lists will ask for and was not done meanwhile.
    cost_ahead: f64,
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
            ahead: 0.0,
            pace: None,
            executor: None,
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

    /// Says what is planned behind this list: the expected cost, in the unit of [`Simulator::expected_cost`], of
    /// all runs that later lists will ask for, those of [`Campaign::with_meanwhile`] included. The time left
    /// is then that of the whole loop.
    #[must_use]
    pub fn with_ahead(mut self, cost: f64) -> Self {
        self.ahead = if cost.is_finite() { cost.max(0.0) } else { 0.0 };
        self
    }

    /// Shares the pace of all lists of one loop, so that a list knows from its first moment how long it takes.
    #[must_use]
    pub fn with_pace(mut self, pace: &'a Pace) -> Self {
        self.pace = Some(pace);
        self
    }

    /// Has the runs done elsewhere than on the threads of this process. Runs of later lists are then not begun early.
    #[must_use]
    pub fn with_executor(mut self, executor: &'a dyn Executor) -> Self {
        self.executor = Some(executor);
        self
    }

    /// Gives the record of every request, in the order of the requests.
    ///
    /// Requests that are the same run (same inputs, as the simulator states them, and seed) are run once. What the
    /// store has is not run again.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] when a request stands for no run, before anything is run; [`Error::Run`] when runs failed,
    /// after all others were done; [`Error::Stopped`] when the flag was raised before the end; [`Error::Store`] when
    /// the store cannot be read or written.
    pub fn run_all(
        &self,
        simulator: &dyn Simulator,
        requests: &[RunRequest],
    ) -> Result<Vec<Record>, Error> {
        let list = JobList::new(simulator, requests);
        let (jobs, job_of_request) = list.all_accepted(requests)?;
        let records = collect(&jobs, self.do_all(simulator, &jobs)?)?;
        Ok(job_of_request
            .into_iter()
            .filter_map(|job| records.get(job).cloned())
            .collect())
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
        Ok(of_request
            .into_iter()
            .filter_map(|job| match job {
                Ok(job) => each.get(job).cloned(),
                Err(refusal) => Some(Err(refusal.in_full())),
            })
            .collect())
    }

    /// What comes of every job: from the store, or by running it.
    fn do_all(
        &self,
        simulator: &dyn Simulator,
        jobs: &[Job],
    ) -> Result<Vec<Option<Result<Record, Failure>>>, Error> {
        let own = Pace::new();
        let pace = self.pace.unwrap_or(&own);
        let mut board = self.look_up(jobs)?;
        if let Some(executor) = self.executor {
            self.have_done(executor, jobs, &mut board, pace)?;
            return Ok(board.results);
        }
        if !board.waiting.is_empty() {
            board.later = self.later(simulator, jobs);
        }
        let workers = self.threads.min(board.waiting.len() + board.later.len());
        let board = Mutex::new(board);
        self.tell(jobs, &lock(&board), pace);
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(|| self.work(simulator, jobs, &board, pace));
            }
        });
        let board = board.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(board.results)
    }

    /// Has the waiting jobs done elsewhere; their records are then in the store.
    fn have_done(
        &self,
        executor: &dyn Executor,
        jobs: &[Job],
        board: &mut Board,
        pace: &Pace,
    ) -> Result<(), Error> {
        self.tell(jobs, board, pace);
        let numbers: Vec<usize> = board.waiting.drain(..).collect();
        let waiting: Vec<&Job> = numbers.iter().filter_map(|i| jobs.get(*i)).collect();
        let pending: Vec<PendingRun<'_>> = waiting
            .iter()
            .map(|job| PendingRun {
                request: &job.request,
                key: job.blank.key(),
                cost: job.cost,
            })
            .collect();
        board.waiting.extend(&numbers);
        let stopped = || self.stop.is_some_and(|flag| flag.load(Ordering::SeqCst));
        executor.execute(&pending, self.store, &stopped, &mut |event| {
            let (RunEvent::Began(k) | RunEvent::Done(k) | RunEvent::Failed(k, _)) = &event;
            let (Some(&i), Some(&job)) = (numbers.get(*k), waiting.get(*k)) else {
                return;
            };
            board.waiting.retain(|other| *other != i);
            let begin = board.running.remove(&i);
            match event {
                RunEvent::Began(_) => drop(board.running.insert(i, Instant::now())),
                RunEvent::Done(_) => {
                    if let Some(begin) = begin {
                        pace.add(job.cost, begin.elapsed().as_secs_f64());
                    }
                    board.results[i] = Some(self.found(job));
                }
                RunEvent::Failed(_, why) => {
                    board.results[i] = Some(Err(Failure::Simulator(why)));
                }
            }
            self.tell(jobs, board, pace);
        })?;
        Ok(())
    }

    /// The record of a job that was done elsewhere.
    fn found(&self, job: &Job) -> Result<Record, Failure> {
        match self.store.get(job.blank.key()).map_err(Failure::Store)? {
            Lookup::Found(record) => Ok(record),
            Lookup::Absent | Lookup::Mismatch { .. } => {
                let reason = "it was told as done, and the store has no record of it".to_owned();
                Err(Failure::Simulator(SimulatorError::Failed { reason }))
            }
        }
    }

    /// The jobs of later lists that are neither in this one nor in the store. A request that is refused is left
    /// to the list that asks for it.
    fn later(&self, simulator: &dyn Simulator, jobs: &[Job]) -> VecDeque<Job> {
        let mut later = JobList::new(simulator, self.meanwhile).jobs;
        let listed: BTreeSet<_> = jobs.iter().map(|job| job.blank.key()).collect();
        later.retain(|job| {
            let key = job.blank.key();
            !listed.contains(key) && matches!(self.store.get(key), Ok(Lookup::Absent))
        });
        later.into()
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
            cost_ahead: self.ahead,
            broken: false,
        })
    }

    /// Takes jobs until none is left or the campaign is to stop.
    fn work(&self, simulator: &dyn Simulator, jobs: &[Job], board: &Mutex<Board>, pace: &Pace) {
        while let Some((i, job)) = self.take(jobs, board) {
            let start = Instant::now();
            let result = self.run_and_store(simulator, job);
            pace.add(job.cost, start.elapsed().as_secs_f64());
            let mut board = lock(board);
            board.running.remove(&i);
            board.broken |= matches!(result, Err(Failure::Store(_)));
            if let Some(place) = board.results.get_mut(i) {
                *place = Some(result);
            }
            // Under the lock, so that the listener hears one thread at a time and in order.
            self.tell(jobs, &board, pace);
        }
        while let Some(job) = self.take_later(jobs, board, pace) {
            let start = Instant::now();
            // The list that asks for the run reports what is wrong with it.
            let _ = self.run_and_store(simulator, &job);
            pace.add(job.cost, start.elapsed().as_secs_f64());
            lock(board).cost_ahead -= job.cost;
        }
    }

    /// Takes a job of a later list while jobs of this one run for at least half of its time, unless the
    /// campaign is to stop.
    fn take_later(&self, jobs: &[Job], board: &Mutex<Board>, pace: &Pace) -> Option<Job> {
        let mut board = lock(board);
        if self.must_stop(&board) {
            return None;
        }
        let workload = self.workload(jobs, &board, pace);
        let needed = 0.5 * board.later.front()?.cost * workload.pace_s?;
        if board.running.is_empty() || workload.list_left_s()? < needed {
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
            .with_regime(outcome.regime)
            .with_details(outcome.details);
        self.store.put(&record).map_err(Failure::Store)?;
        Ok(record)
    }

    /// What is left of the list and of the loop.
    fn workload(&self, jobs: &[Job], board: &Board, pace: &Pace) -> Workload {
        let cost = |i: &usize| jobs.get(*i).map_or(0.0, |job| job.cost);
        Workload {
            pace_s: pace.seconds_per_cost(),
            cost_running: board.running.keys().map(cost).collect(),
            time_running_s: board
                .running
                .values()
                .map(|start| start.elapsed().as_secs_f64())
                .collect(),
            cost_waiting: board.waiting.iter().map(cost).collect(),
            cost_ahead: board.cost_ahead,
            workers: self.threads,
        }
    }

    /// Tells the listener how far it is.
    fn tell(&self, jobs: &[Job], board: &Board, pace: &Pace) {
        self.progress.update(&ProgressState {
            done: board.results.iter().flatten().count(),
            reused: board.reused,
            total: jobs.len(),
            running: board.running.len(),
            elapsed_s: pace.elapsed_s(),
            left_s: self.workload(jobs, board, pace).time_left_s(),
        });
    }
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
