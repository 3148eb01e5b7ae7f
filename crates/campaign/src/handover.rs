//! Runs of a campaign that an executor does.

use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::board::{Board, Failure};
use crate::jobs::Job;
use crate::{Campaign, Error, Executor, Pace, PendingRun, RunEvent};

impl Campaign<'_> {
    /// Has the waiting jobs done elsewhere; their records are then in the store.
    pub(crate) fn have_done(
        &self,
        executor: &dyn Executor,
        jobs: &[Job],
        board: &mut Board,
        pace: &Pace,
    ) -> Result<(), Error> {
        self.tell(jobs, board, pace);
        let numbers: Vec<usize> = board.waiting.drain(..).collect();
        let waiting: Vec<&Job> = numbers.iter().filter_map(|i| jobs.get(*i)).collect();
        let pending: Vec<PendingRun<'_>> = waiting.iter().map(|job| job.pending()).collect();
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
                    let found = self.found(job);
                    self.tell_end(job, &found);
                    board.results[i] = Some(found);
                }
                RunEvent::Failed(_, why) => {
                    let failed = Err(Failure::Simulator(why));
                    self.tell_end(job, &failed);
                    board.results[i] = Some(failed);
                }
            }
            self.tell(jobs, board, pace);
        })?;
        Ok(())
    }
}
