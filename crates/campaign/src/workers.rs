//! The threads of a campaign: each takes the next unclaimed run.

use crate::run_store::{Holder, Record};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use crate::board::{Board, Elsewhere, Failure, lock};
use crate::claims::{Keeper, Permit};
use crate::jobs::Job;
use crate::{Campaign, Cores, Pace, ProgressState, SimulatorError};

/// Pause of a worker while another asks for the last run; short against any run.
const SHORT_PAUSE: Duration = Duration::from_millis(5);

/// Next action of a worker.
enum Next {
    /// Begins a job, if no other campaign does it; one that another campaign did when it was met last.
    Ask(usize, Option<Elsewhere>),
    /// Waits for the runs of others.
    Wait(Duration),
    /// Ends.
    End,
}

/// Result of beginning a job.
enum Outcome {
    /// The store already had its record.
    Found(Record),
    /// Another campaign does it.
    Elsewhere(Holder),
    /// It failed in another campaign.
    Failed(Failure),
    /// It was run; the time in seconds.
    Ran(Result<Record, Failure>, f64),
    /// The store could not be read.
    Unreadable(crate::run_store::Error),
}

/// State that all workers of a list read.
pub(crate) struct Hall<'h> {
    /// The jobs of the list.
    pub(crate) jobs: &'h [Job<'h>],
    /// Progress of each.
    pub(crate) board: &'h Mutex<Board>,
    /// Their pace.
    pub(crate) pace: &'h Pace,
    /// Claims them.
    pub(crate) keeper: &'h Keeper<'h>,
    /// Cores that they share.
    pub(crate) cores: Cores,
}

impl Campaign<'_> {
    /// Does all jobs with some workers.
    pub(crate) fn work_all(&self, hall: &Hall<'_>, workers: usize) {
        std::thread::scope(|scope| {
            if workers > 0 && self.store.folder().is_some() {
                scope.spawn(|| hall.keeper.renew_until_end());
            }
            let threads: Vec<_> = (0..workers)
                .map(|_| scope.spawn(|| self.work(hall)))
                .collect();
            let ends: Vec<_> = threads.into_iter().map(ScopedJoinHandle::join).collect();
            hall.keeper.end();
            if let Some(panic) = ends.into_iter().find_map(Result::err) {
                resume_unwind(panic);
            }
        });
    }

    /// Takes jobs until none is left or the campaign is to stop.
    fn work(&self, hall: &Hall<'_>) {
        loop {
            match self.next(hall) {
                Next::Ask(i, before) => self.do_job(hall, i, before),
                Next::Wait(pause) => std::thread::sleep(pause),
                Next::End => return hall.cores.release(),
            }
        }
    }

    /// Decides what a worker does next.
    fn next(&self, hall: &Hall<'_>) -> Next {
        let mut board = lock(hall.board);
        board.note_waiting();
        if self.must_stop(&board) || board.has_waited_for(self.wait) {
            return Next::End;
        }
        if let Some(i) = board.waiting.pop_front() {
            board.asking.insert(i);
            return Next::Ask(i, None);
        }
        if let Some(other) = board.take_due() {
            board.asking.insert(other.job);
            return Next::Ask(other.job, Some(other));
        }
        if !board.is_undecided() {
            return Next::End;
        }
        Next::Wait(if board.asking.is_empty() {
            board.until_due()
        } else {
            SHORT_PAUSE
        })
    }

    /// Whether no further run may begin.
    fn must_stop(&self, board: &Board) -> bool {
        board.broken || self.is_stopped()
    }

    /// Whether the campaign should end.
    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|flag| flag.load(Ordering::SeqCst))
    }

    /// Does a job, unless another campaign does it.
    fn do_job(&self, hall: &Hall<'_>, i: usize, before: Option<Elsewhere>) {
        let Some(job) = hall.jobs.get(i) else {
            return;
        };
        let outcome = self.attempt(hall, job, &|| {
            let mut board = lock(hall.board);
            board.asking.remove(&i);
            board.running.insert(i, Instant::now());
        });
        let mut board = lock(hall.board);
        board.asking.remove(&i);
        board.running.remove(&i);
        let result = match outcome {
            Outcome::Elsewhere(holder) => {
                board.elsewhere.push(Elsewhere::met(i, before));
                if board.waits_for_others() && board.asking.is_empty() && !board.told_of_others {
                    board.told_of_others = true;
                    self.progress.warning(&format!(
                        "waiting for {} runs that others do in this folder, such as {holder}",
                        board.elsewhere.len()
                    ));
                }
                return;
            }
            Outcome::Found(record) => {
                board.reused += 1;
                Ok(record)
            }
            Outcome::Failed(failure) => Err(failure),
            // Broken off by the flag: not done, and no failure of its own.
            Outcome::Ran(Err(Failure::Simulator(_)), _) if self.is_stopped() => return,
            Outcome::Ran(result, time_s) => {
                hall.pace.add(job.cost, time_s);
                result
            }
            Outcome::Unreadable(why) => Err(Failure::Store(why)),
        };
        board.broken |= matches!(result, Err(Failure::Store(_)));
        self.tell_end(job, &result);
        if let Some(place) = board.results.get_mut(i) {
            *place = Some(result);
        }
        // Under the lock, so that the listener hears one thread at a time and in order.
        self.tell(hall.jobs, &board, hall.pace);
    }

    /// Runs a job, if the store has no record of it and no other campaign does it.
    fn attempt(&self, hall: &Hall<'_>, job: &Job<'_>, begin: &dyn Fn()) -> Outcome {
        let warn = |text: &str| {
            let _one_at_a_time = lock(hall.board);
            self.progress.warning(text);
        };
        match self.stored(job, &warn) {
            Ok(Some(record)) => return Outcome::Found(record),
            Ok(None) => {}
            Err(why) => return Outcome::Unreadable(why),
        }
        let hold = match hall.keeper.ask(job.blank.key(), &warn) {
            Permit::Go(hold) => hold,
            Permit::Taken(holder) => return Outcome::Elsewhere(holder),
        };
        if hold.is_some() {
            // Its last owner may have finished just before.
            match self.stored(job, &warn) {
                Ok(Some(record)) => return Outcome::Found(record),
                Ok(None) => {}
                Err(why) => return Outcome::Unreadable(why),
            }
            // Or have failed: the same inputs fail again.
            if let Some(reason) = self.store.failure(job.blank.key()) {
                let failure = SimulatorError::FailedElsewhere { reason };
                return Outcome::Failed(Failure::Simulator(failure));
            }
        }
        begin();
        let start = Instant::now();
        let result = self.run_and_store(hall, job);
        if let Err(Failure::Simulator(error)) = &result
            && !self.is_stopped()
        {
            self.store.note_failure(job.blank.key(), &error.in_full());
        }
        Outcome::Ran(result, start.elapsed().as_secs_f64())
    }

    /// Does one run and keeps its record.
    fn run_and_store(&self, hall: &Hall<'_>, job: &Job<'_>) -> Result<Record, Failure> {
        // A run that panics must not take the others with it; its state dies with it.
        let run = || job.prepared.run(&hall.cores);
        let outcome = catch_unwind(AssertUnwindSafe(run))
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

    /// Reports the result of a job to the listener.
    pub(crate) fn tell_end(&self, job: &Job<'_>, result: &Result<Record, Failure>) {
        match result {
            Ok(record) => self.progress.ended(&job.request, Ok(record)),
            Err(Failure::Simulator(why)) => self.progress.ended(&job.request, Err(&why.in_full())),
            Err(Failure::Store(why)) => self.progress.ended(&job.request, Err(&why.to_string())),
        }
    }

    /// Reports the progress to the listener.
    pub(crate) fn tell(&self, jobs: &[Job<'_>], board: &Board, pace: &Pace) {
        let workload = board.workload(jobs, pace, self.threads);
        self.progress.update(&ProgressState {
            done: board.results.iter().flatten().count(),
            failed: board
                .results
                .iter()
                .flatten()
                .filter(|r| r.is_err())
                .count(),
            reused: board.reused,
            total: jobs.len(),
            running: board.running.len(),
            elapsed_s: pace.elapsed_s(),
            left_s: workload.time_left_s(),
        });
    }
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
