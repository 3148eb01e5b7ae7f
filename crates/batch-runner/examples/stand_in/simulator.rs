//! A simulator that sleeps in place of computing, and notes each of its runs.

use campaign::run_store::{Observation, Record};
use campaign::{RunOutcome, RunRequest, Simulator, SimulatorError};
use std::io::Write as _;
use std::path::PathBuf;
use std::time::Duration;

/// y = 2 x + seed after `sleep_s`; x = 13 fails, and x = 666 takes the whole process with it.
pub(crate) struct StandIn {
    /// File to which each run adds a line at its begin and at its end; none is written where absent.
    pub(crate) notes: Option<PathBuf>,
    /// Folder of the records: a run that begins though its record is there is noted as needless; not looked at where
    /// absent.
    pub(crate) records: Option<PathBuf>,
    /// Version, part of the keys.
    pub(crate) version: String,
}

impl StandIn {
    /// Notes that a run begins, and whether it need not.
    fn note_begin(&self, request: &RunRequest) -> Result<(), SimulatorError> {
        let file = format!("{}.json", self.key(request)?);
        if self
            .records
            .as_ref()
            .is_some_and(|folder| folder.join(file).exists())
        {
            self.note("needless", request)?;
        }
        self.note("began", request)
    }

    /// The key of a run.
    fn key(&self, request: &RunRequest) -> Result<String, SimulatorError> {
        let record = Record::new(&self.version, request.inputs(), request.seed);
        Ok(record.map_err(SimulatorError::other)?.key().to_owned())
    }

    /// Adds a line about a run: the word, its key, and the process.
    fn note(&self, word: &str, request: &RunRequest) -> Result<(), SimulatorError> {
        let Some(path) = &self.notes else {
            return Ok(());
        };
        // One call, so that lines of several processes do not mix.
        let line = format!("{word} {} {}\n", self.key(request)?, std::process::id());
        let mut file = std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .map_err(SimulatorError::other)?;
        file.write_all(line.as_bytes())
            .map_err(SimulatorError::other)
    }
}

impl Simulator for StandIn {
    fn version(&self) -> String {
        self.version.clone()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.note_begin(request)?;
        let x = request.parameter("x")?;
        std::thread::sleep(Duration::from_secs_f64(request.condition("sleep_s")?));
        if x == 13.0 {
            let reason = "x is 13".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        if x == 666.0 {
            std::process::abort();
        }
        let y = Observation {
            mean: 2.0 * x + request.seed as f64,
            sd: None,
            n: 1,
            unit: "1".into(),
        };
        self.note("ended", request)?;
        Ok(RunOutcome::default().with_observable("y", y))
    }

    fn expected_cost(&self, request: &RunRequest) -> f64 {
        request.condition("sleep_s").unwrap_or(1.0)
    }
}

/// Requests for x = 1000, 1001 and so on, each of which takes a time, s.
pub(crate) fn requests(n_runs: u32, sleep_s: f64) -> Vec<RunRequest> {
    let request = |x: u32| {
        RunRequest::new("stand-in", 1)
            .with_parameter("x", f64::from(1000 + x))
            .with_condition("sleep_s", sleep_s)
    };
    (0..n_runs).map(request).collect()
}
