//! Judging whether a task lives, has ended or is lost.

use std::time::Instant;

use crate::{BatchSettings, LossReason, TaskState};

/// Signs of life that may stay away before a task counts as silent.
const MISSED_BEATS: f64 = 3.0;

/// Code of a script that found its task void.
const VOID_CODE: i32 = 99;

/// What is known of one task.
#[derive(Debug)]
pub(crate) struct Watch {
    /// Last word of the batch system; none before the first.
    state: Option<TaskState>,
    /// Since when the batch system has not known it.
    unknown_since: Option<Instant>,
    /// Code of its worker.
    exit: Option<i32>,
    /// Last sign of life, and since when it has not changed.
    beat: Option<(String, Instant)>,
    /// Since when it has been over.
    ended_at: Option<Instant>,
    /// Whether the batch system was asked since.
    asked_since_end: bool,
}

/// What is to be done with a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Judgement {
    /// It has not begun.
    Waits,
    /// It is in progress.
    Runs,
    /// It is over; its last files may not be seen yet.
    Ended,
    /// It is over, and no file will come any more.
    Over(LossReason),
}

impl Watch {
    /// Nothing is known yet.
    pub(crate) fn new() -> Self {
        Self {
            state: None,
            unknown_since: None,
            exit: None,
            beat: None,
            ended_at: None,
            asked_since_end: false,
        }
    }

    /// Hears the batch system.
    pub(crate) fn hear_state(&mut self, state: TaskState, now: Instant) {
        self.state = Some(state);
        if state == TaskState::Unknown {
            self.unknown_since.get_or_insert(now);
        } else {
            self.unknown_since = None;
        }
        self.asked_since_end |= self.ended_at.is_some();
    }

    /// Whether a sign of life would tell more than the batch system does.
    pub(crate) fn needs_beat(&self) -> bool {
        self.exit.is_none()
            && matches!(
                self.state,
                None | Some(TaskState::Unknown | TaskState::Waiting)
            )
    }

    /// Sees its sign of life.
    pub(crate) fn see_beat(&mut self, beat: &str, now: Instant) {
        match &self.beat {
            Some((last, _)) if last == beat => {}
            _ => self.beat = Some((beat.to_owned(), now)),
        }
    }

    /// Sees the code of its worker.
    pub(crate) fn see_exit(&mut self, code: i32) {
        self.exit = Some(code);
    }

    /// Whether the code of its worker was seen.
    pub(crate) fn has_exit(&self) -> bool {
        self.exit.is_some()
    }

    /// Judges. `answers` tells whether the batch system answers at present.
    pub(crate) fn judge(
        &mut self,
        settings: &BatchSettings,
        answers: bool,
        now: Instant,
    ) -> Judgement {
        let Some(reason) = self.end(settings, now) else {
            self.ended_at = None;
            let begun = self.state == Some(TaskState::Running) || self.beat.is_some();
            return if begun {
                Judgement::Runs
            } else {
                Judgement::Waits
            };
        };
        let ended_at = *self.ended_at.get_or_insert(now);
        let waited = seconds(ended_at, now) >= settings.file_latency_s;
        // The batch system knows better why a worker was killed.
        if waited && (self.asked_since_end || !answers) {
            Judgement::Over(reason)
        } else {
            Judgement::Ended
        }
    }

    /// Why it is over, if it is.
    fn end(&self, settings: &BatchSettings, now: Instant) -> Option<LossReason> {
        if let Some(TaskState::Lost { reason }) = self.state {
            return Some(reason);
        }
        if let Some(code) = self.exit {
            return Some(if code == VOID_CODE {
                LossReason::Cancelled
            } else {
                LossReason::Killed
            });
        }
        match self.state {
            Some(TaskState::Ended { .. }) => Some(LossReason::Killed),
            Some(TaskState::Running) => None,
            _ => self
                .is_silent(settings, now)
                .then_some(LossReason::Vanished),
        }
    }

    /// Whether a task that the batch system does not vouch for gives no sign of life any more.
    fn is_silent(&self, settings: &BatchSettings, now: Instant) -> bool {
        let longest_s = MISSED_BEATS * settings.heartbeat_s + settings.file_latency_s;
        match (&self.beat, self.unknown_since) {
            (Some((_, last)), _) => seconds(*last, now) > longest_s,
            // Not begun: an empty answer may mean that the batch system is in trouble.
            (None, Some(since)) => seconds(since, now) > settings.patience_s,
            (None, None) => false,
        }
    }
}

/// Time between two moments, s.
pub(crate) fn seconds(from: Instant, to: Instant) -> f64 {
    to.saturating_duration_since(from).as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::{Judgement, Watch};
    use crate::{BatchSettings, LossReason, TaskState};
    use std::time::{Duration, Instant};

    /// A task that the system does not know is alive as long as it beats, and over when it is silent for three beats
    /// (90 s) and the time that files take (30 s), twice: once for the last beat, once for the last records.
    #[test]
    fn a_task_that_the_system_does_not_know_lives_as_long_as_it_beats() {
        let settings = BatchSettings::default();
        let begin = Instant::now();
        let at = |s: u64| begin + Duration::from_secs(s);
        let mut watch = Watch::new();
        watch.see_beat("1", at(0));
        watch.hear_state(TaskState::Unknown, at(0));
        assert_eq!(watch.judge(&settings, true, at(119)), Judgement::Runs);
        watch.see_beat("2", at(119));
        assert_eq!(watch.judge(&settings, true, at(200)), Judgement::Runs);
        assert_eq!(watch.judge(&settings, true, at(240)), Judgement::Ended);
        watch.hear_state(TaskState::Unknown, at(250));
        let over = Judgement::Over(LossReason::Vanished);
        assert_eq!(watch.judge(&settings, true, at(270)), over);
    }

    /// A queue may be long: a task that waits is never over; one that is not known is, after the patience (600 s).
    #[test]
    fn a_waiting_task_is_waited_for_and_a_forgotten_one_is_not() {
        let settings = BatchSettings::default();
        let begin = Instant::now();
        let at = |s: u64| begin + Duration::from_secs(s);
        let mut watch = Watch::new();
        watch.hear_state(TaskState::Waiting, at(0));
        assert_eq!(watch.judge(&settings, true, at(100_000)), Judgement::Waits);
        watch.hear_state(TaskState::Unknown, at(100_000));
        assert_eq!(watch.judge(&settings, true, at(100_600)), Judgement::Waits);
        assert_eq!(watch.judge(&settings, true, at(100_601)), Judgement::Ended);
    }

    /// The file says that the worker was killed, the batch system says why: it is asked before the task is given up,
    /// unless it does not answer.
    #[test]
    fn the_batch_system_is_asked_why_a_worker_was_killed() {
        let settings = BatchSettings::default();
        let begin = Instant::now();
        let at = |s: u64| begin + Duration::from_secs(s);
        let killed = || {
            let mut watch = Watch::new();
            watch.hear_state(TaskState::Running, at(0));
            watch.see_exit(143);
            assert_eq!(watch.judge(&settings, true, at(0)), Judgement::Ended);
            watch
        };
        let mut watch = killed();
        assert_eq!(watch.judge(&settings, true, at(31)), Judgement::Ended);
        let reason = LossReason::TimeOut;
        watch.hear_state(TaskState::Lost { reason }, at(32));
        assert_eq!(
            watch.judge(&settings, true, at(32)),
            Judgement::Over(reason)
        );
        let mut alone = killed();
        let over = Judgement::Over(LossReason::Killed);
        assert_eq!(alone.judge(&settings, false, at(31)), over);
    }
}
