//! How far a campaign is, and telling it.

use std::fmt;
use std::io::Write;
use std::sync::{Mutex, PoisonError};

use crate::PendingRun;

/// How far a list of runs is, and the loop that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProgressState {
    /// Runs of the list that are over: reused, finished or failed.
    pub done: usize,
    /// Runs of the list that gave no result.
    pub failed: usize,
    /// Runs of the list whose record was in the store, or came there from another campaign.
    pub reused: usize,
    /// Different runs of the list.
    pub total: usize,
    /// Runs of the list in progress.
    pub running: usize,
    /// Time since the loop began, s.
    pub elapsed_s: f64,
    /// Expected time to the end of the loop, later lists included, s; none before the first run of the loop is
    /// finished.
    pub left_s: Option<f64>,
}

impl fmt::Display for ProgressState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = match self.left_s {
            Some(left) => format!("about {} left", time_in_words(left)),
            None => "time left not known yet".to_owned(),
        };
        write!(
            f,
            "{}/{} runs of this list ({} reused, {} running); whole loop: {} elapsed, {left}",
            self.done,
            self.total,
            self.reused,
            self.running,
            time_in_words(self.elapsed_s)
        )
    }
}

/// A listener; called by one thread at a time.
pub trait Progress: Sync {
    /// Hears which different runs a list has, before its first update.
    fn planned(&self, runs: &[PendingRun<'_>]) {
        let _ = runs;
    }

    /// Hears how far the campaign is: once at the start and after each run.
    fn update(&self, state: &ProgressState);

    /// Hears of something odd that does not stop the campaign.
    fn warning(&self, text: &str) {
        let _ = text;
    }
}

/// A listener that says nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn update(&self, _state: &ProgressState) {}
}

/// A listener that writes one line per finished run.
pub struct LineProgress {
    /// Where the lines go, such as standard error.
    output: Mutex<Box<dyn Write + Send>>,
}

impl LineProgress {
    /// Writes its lines to `output`; a failure to write is ignored, the runs matter more.
    pub fn new(output: impl Write + Send + 'static) -> Self {
        Self {
            output: Mutex::new(Box::new(output)),
        }
    }

    /// Writes one line.
    fn line(&self, text: fmt::Arguments<'_>) {
        let mut output = self.output.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = writeln!(output, "{text}").and_then(|()| output.flush());
    }
}

impl fmt::Debug for LineProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LineProgress").finish_non_exhaustive()
    }
}

impl Progress for LineProgress {
    fn update(&self, state: &ProgressState) {
        self.line(format_args!("{state}"));
    }

    fn warning(&self, text: &str) {
        self.line(format_args!("warning: {text}"));
    }
}

/// A time, s, in the unit that reads best; one below 0 is 0.
pub fn time_in_words(seconds: f64) -> String {
    let seconds = seconds.max(0.0);
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{ProgressState, time_in_words};

    #[test]
    fn times_have_the_unit_that_reads_best() {
        let told = [89.0, 90.0, 5399.0, 7200.0, -1.0].map(time_in_words);
        assert_eq!(told, ["89 s", "2 min", "90 min", "2.0 h", "0 s"]);
    }

    #[test]
    fn line_says_how_far_and_how_long_in_readable_units() {
        let mut state = ProgressState {
            done: 3,
            failed: 0,
            reused: 1,
            total: 9,
            running: 2,
            elapsed_s: 75.0,
            left_s: None,
        };
        assert_eq!(
            state.to_string(),
            "3/9 runs of this list (1 reused, 2 running); whole loop: 75 s elapsed, time left not known yet"
        );
        state.left_s = Some(7200.0);
        assert!(state.to_string().ends_with("about 2.0 h left"), "{state}");
    }
}
