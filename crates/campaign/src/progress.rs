//! Progress of a campaign, and its reports.

use std::fmt;
use std::io::Write;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::RunRequest;
use crate::run_store::Record;

/// Progress of a list of runs, and of its loop.
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
    /// Expected time of the runs to the end of the loop, later lists included, at least and at most, s: later runs depend on earlier
    /// results. `None` before the first run of the loop is finished.
    pub left_s: Option<[f64; 2]>,
}

impl ProgressState {
    /// The time to the end of the loop, as text.
    fn left(&self) -> String {
        match self.left_s {
            Some(left) => format!("{} of runs left", range_in_words(left)),
            None => "time left unknown".to_owned(),
        }
    }

    /// The state as a short text, which fits beside a bar in a line of 80 characters.
    fn short(&self) -> String {
        let Self {
            done,
            total,
            running,
            ..
        } = self;
        format!(
            "{done}/{total} runs, {running} running; loop: {}",
            self.left()
        )
    }
}

impl fmt::Display for ProgressState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = self.left();
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
    /// Receives the result of a run of a list: its record, which may have been in the store, or the reason for its absence.
    fn ended(&self, request: &RunRequest, result: Result<&Record, &str>) {
        let _ = (request, result);
    }

    /// Receives the progress of the campaign: once at the start and after each run.
    fn update(&self, state: &ProgressState);

    /// Receives a warning that does not stop the campaign.
    fn warning(&self, text: &str) {
        let _ = text;
    }
}

/// A listener that reports nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn update(&self, _state: &ProgressState) {}
}

/// Shortest time between two lines of a list in a file, except its first and last. Our choice: a campaign of a day writes some
/// hundreds.
const LEAST_PAUSE: Duration = Duration::from_mins(5);

/// Marks of the bar.
const BAR: usize = 20;

/// A listener that reports the progress of a campaign in lines.
pub struct LineProgress {
    /// Text written so far, and its destination.
    output: Mutex<Output>,
}

/// Destination of lines.
struct Output {
    /// Such as standard error.
    to: Box<dyn Write + Send>,
    /// Whether one line with a bar is redrawn, which needs a terminal.
    redraws: bool,
    /// When the last line of the list was written, and whether it had an estimate of the time left; none before its first.
    last: Option<(Instant, bool)>,
}

impl LineProgress {
    /// Writes its lines to `output`, such as a file: the first and the last of each list, the first with an estimate of the
    /// time left, and one in five minutes between. A failed write is ignored, because the runs matter more.
    pub fn new(output: impl Write + Send + 'static) -> Self {
        Self::with(output, false)
    }

    /// Draws one line with a bar on a terminal and redraws it for each run.
    pub fn on_terminal(terminal: impl Write + Send + 'static) -> Self {
        Self::with(terminal, true)
    }

    /// Writes its lines to `output`.
    fn with(output: impl Write + Send + 'static, redraws: bool) -> Self {
        Self {
            output: Mutex::new(Output {
                to: Box::new(output),
                redraws,
                last: None,
            }),
        }
    }

    /// State of the output; a panic never leaves a line half written.
    fn lock(&self) -> MutexGuard<'_, Output> {
        self.output.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Output {
    /// Writes at once.
    fn write(&mut self, text: fmt::Arguments<'_>) {
        let _ = self.to.write_fmt(text).and_then(|()| self.to.flush());
    }
}

impl fmt::Debug for LineProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LineProgress").finish_non_exhaustive()
    }
}

/// Goes to the start of the line and clears it, as terminals understand it.
const CLEAR: &str = "\r\u{1b}[2K";

impl Progress for LineProgress {
    fn update(&self, state: &ProgressState) {
        let mut output = self.lock();
        let ends = state.done == state.total;
        if output.redraws {
            let end = if ends { "\n" } else { "\r" };
            let marks = (BAR * state.done).checked_div(state.total).unwrap_or(BAR);
            let bar = format!("{}{}", "#".repeat(marks), "-".repeat(BAR - marks));
            output.write(format_args!("{CLEAR}[{bar}] {}{end}", state.short()));
            return;
        }
        let estimated = state.left_s.is_some();
        let is_due =
            |(last, had): (Instant, bool)| last.elapsed() >= LEAST_PAUSE || estimated != had;
        if ends || output.last.is_none_or(is_due) {
            // The next line is the first of the next list.
            output.last = (!ends).then(|| (Instant::now(), estimated));
            output.write(format_args!("{state}\n"));
        }
    }

    fn warning(&self, text: &str) {
        let mut output = self.lock();
        let clear = if output.redraws { CLEAR } else { "" };
        output.write(format_args!("{clear}warning: {text}\n"));
    }
}

/// A range of times, s, as text; a single time if both ends have the same text.
pub fn range_in_words([least, most]: [f64; 2]) -> String {
    let [least, most] = [least, most].map(time_in_words);
    if least == most {
        format!("about {least}")
    } else {
        format!("{least} to {most}")
    }
}

/// A time, s, in a readable unit; negative times are 0.
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
    use super::{LineProgress, Progress, ProgressState, time_in_words};
    use std::io::Write;
    use std::sync::{Arc, Mutex};

    /// Written text, for the test to read.
    #[derive(Clone, Default)]
    struct Kept(Arc<Mutex<Vec<u8>>>);

    impl Write for Kept {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    /// Output of a listener for a complete list of four runs, with a warning in its middle.
    fn written(listener: impl Fn(Kept) -> LineProgress) -> String {
        let kept = Kept::default();
        let lines = listener(kept.clone());
        for done in 0..=4 {
            lines.update(&ProgressState {
                done,
                failed: 0,
                reused: 0,
                total: 4,
                running: 2,
                elapsed_s: 60.0,
                left_s: (done > 0).then_some([30.0, 1080.0]),
            });
            if done == 2 {
                lines.warning("a disk is slow");
            }
        }
        let bytes = kept.0.lock().unwrap().clone();
        String::from_utf8(bytes).unwrap()
    }

    /// Runs that follow each other within the pause do not fill a file: it gets the first and the last line, the first with the time left, and every warning. No
    /// control characters go into a file.
    #[test]
    fn a_file_gets_the_first_and_the_last_line_of_a_list() {
        let text = written(LineProgress::new);
        let starts: Vec<&str> = text.lines().map(|line| &line[..4]).collect();
        assert_eq!(starts, ["0/4 ", "1/4 ", "warn", "4/4 "]);
        assert!(!text.contains(['\r', '\u{1b}']));
    }

    /// On a terminal one line is redrawn for each run, no longer than 80 characters, and stays when the list ends; a warning
    /// takes its place.
    #[test]
    fn a_terminal_shows_one_line_with_a_bar() {
        let text = written(LineProgress::on_terminal);
        assert_eq!(
            text.matches('\n').count(),
            2,
            "the warning and the end: {text:?}"
        );
        let half =
            "[##########----------] 2/4 runs, 2 running; loop: 30 s to 18 min of runs left\r";
        assert!(text.contains(half) && half.len() <= 80, "{text:?}");
        assert!(text.ends_with(
            "[####################] 4/4 runs, 2 running; loop: 30 s to 18 min of runs left\n"
        ));
    }

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
            "3/9 runs of this list (1 reused, 2 running); whole loop: 75 s elapsed, time left unknown"
        );
        state.left_s = Some([7200.0; 2]);
        let told = state.to_string();
        assert!(told.ends_with("about 2.0 h of runs left"), "{told}");
        state.left_s = Some([60.0, 7200.0]);
        let told = state.to_string();
        assert!(told.ends_with("60 s to 2.0 h of runs left"), "{told}");
    }
}
