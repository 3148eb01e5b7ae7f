//! What it costs to keep runs: `record_cost FOLDER [RUNS]`.
//!
//! A campaign of RUNS (1000) runs that compute nothing, each with as much to keep as a run of a drum, with a folder and
//! without one, in turn, three times. What the folder adds is claims on runs, digests, files written whole, and their way
//! to the disk. Prints the time of a run by the clock, ms, of one thread.

#![expect(clippy::print_stdout, reason = "the result is the purpose")]

use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Bytes of the details of a run of the study's drum, whose last picture makes up the most of them.
const DETAILS: usize = 60_000;

/// Computes nothing.
struct Nothing;

impl Simulator for Nothing {
    fn version(&self) -> String {
        "nothing 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let y = Observation {
            mean: request.parameter("x")?,
            sd: Some(1.0),
            n: 20,
            unit: "1".into(),
        };
        Ok(RunOutcome {
            details: "x".repeat(DETAILS).into(),
            ..RunOutcome::default().with_observable("y", y)
        })
    }
}

/// Time of a run, ms.
fn time_of(store: &Store, requests: &[RunRequest]) -> Result<f64, Box<dyn Error>> {
    let begin = Instant::now();
    Campaign::new(store, 1, &Silent).run_all(&Nothing, requests)?;
    Ok(1e3 * begin.elapsed().as_secs_f64() / requests.len() as f64)
}

fn main() -> Result<(), Box<dyn Error>> {
    let usage = "usage: record_cost FOLDER [RUNS]";
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or(usage)?;
    let runs: u32 = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    println!("round  in memory, ms  first time, ms  found again, ms");
    for round in 1..=3 {
        let request = |k| RunRequest::new("nothing", 1).with_parameter("x", f64::from(k));
        let requests: Vec<RunRequest> = (0..runs).map(request).collect();
        let memory = time_of(&Store::in_memory(), &requests)?;
        let place = Path::new(&folder).join(format!("round-{round}"));
        let kept = time_of(&Store::open(&place)?, &requests)?;
        let found = time_of(&Store::open(&place)?, &requests)?;
        println!("{round:<7}{memory:<15.3}{kept:<16.3}{found:.3}");
    }
    Ok(())
}
