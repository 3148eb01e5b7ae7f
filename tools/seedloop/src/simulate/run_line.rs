//! One line on a terminal that shows the progress of a run.

use command_line::Common;
use scene::RunStage;
use std::io::{IsTerminal as _, Write};
use std::time::{Duration, Instant};

/// Least time between two lines.
const PAUSE: Duration = Duration::from_millis(200);

/// Redraws the line as the run continues; draws nothing if standard error is not a terminal, or the log is quiet. It is gone
/// when the run is over.
pub(super) struct RunLine {
    /// The terminal; `None` if nothing is drawn.
    to: Option<Box<dyn Write>>,
    /// When it was drawn last.
    last: Option<Instant>,
}

impl RunLine {
    /// A line on standard error.
    pub(super) fn new(common: &Common) -> Self {
        let errors = std::io::stderr();
        let drawn = !common.quiet && errors.is_terminal();
        Self {
            to: drawn.then(|| Box::new(errors) as Box<dyn Write>),
            last: None,
        }
    }

    /// Shows the progress of the run, if an update is due. A failure to write is ignored, the run matters more.
    pub(super) fn draw(&mut self, stage: &RunStage) {
        let Some(to) = &mut self.to else {
            return;
        };
        if self.last.is_none_or(|last| last.elapsed() >= PAUSE) {
            let _ = write!(to, "\r\x1b[K{}", words(stage)).and_then(|()| to.flush());
            self.last = Some(Instant::now());
        }
    }

    /// Makes room for other lines.
    pub(super) fn clear(&mut self) {
        if let (Some(to), Some(_)) = (&mut self.to, self.last.take()) {
            let _ = write!(to, "\r\x1b[K").and_then(|()| to.flush());
        }
    }
}

impl Drop for RunLine {
    fn drop(&mut self) {
        self.clear();
    }
}

/// How far a run is, in at most 80 characters.
fn words(stage: &RunStage) -> String {
    let RunStage {
        driven,
        time_s,
        limit_s,
        frames: [done, wanted],
    } = stage;
    let what = if *driven { "running" } else { "settling" };
    let frames = if *done > 0 {
        format!(", {done} of {wanted} frames")
    } else {
        String::new()
    };
    format!("{what}: {time_s:.2} s of at most {limit_s:.2} s{frames}")
}

#[cfg(test)]
mod tests {
    use super::{RunLine, words};
    use scene::RunStage;
    use std::io::Write;
    use std::sync::{Arc, Mutex};

    /// Where a line is drawn, for the test to look at.
    #[derive(Clone, Default)]
    struct Paper(Arc<Mutex<Vec<u8>>>);

    impl Write for Paper {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    const TURNING: RunStage = RunStage {
        driven: true,
        time_s: 3.456,
        limit_s: 12.0,
        frames: [5, 20],
    };

    #[test]
    fn a_line_tells_time_limit_and_frames() {
        assert_eq!(
            words(&TURNING),
            "running: 3.46 s of at most 12.00 s, 5 of 20 frames"
        );
        let settling = RunStage {
            driven: false,
            time_s: 0.1,
            limit_s: 0.8,
            frames: [0, 20],
        };
        assert_eq!(words(&settling), "settling: 0.10 s of at most 0.80 s");
    }

    /// A second line so soon is left out, and the end of the run leaves an empty line.
    #[test]
    fn the_line_is_drawn_now_and_then_and_gone_at_the_end() {
        let paper = Paper::default();
        let mut line = RunLine {
            to: Some(Box::new(paper.clone())),
            last: None,
        };
        line.draw(&TURNING);
        line.draw(&TURNING);
        drop(line);
        let text = String::from_utf8(paper.0.lock().unwrap().clone()).unwrap();
        let parts: Vec<&str> = text.split("\r\x1b[K").collect();
        assert_eq!(parts, ["", words(&TURNING).as_str(), ""]);
    }
}
