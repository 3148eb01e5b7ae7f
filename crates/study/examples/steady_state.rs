//! Does the error that a run states of its own mean hold: the scatter of the means of many runs beside it, by
//! friction and speed.
//!
//! `cargo run --release -p study --example steady_state -- FOLDER [RUNS]`
//!
//! RUNS runs (default 20) of a small drum of the study's seeds (100 mm, 320 seeds) at each of four frictions and three
//! speeds; prints the page. Finished runs are kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod records;
mod small_drum;

use campaign::run_store::{Record, Store};
use campaign::{Campaign, LineProgress, RunRequest};
use records::{folder_and_runs, mean_and_error};
use simulators::scene_simulator::{Binding, NOT_STEADY, RunDetails, SceneSimulator};
use small_drum::small_drum;
use std::collections::BTreeMap;
use std::error::Error;

/// Friction between seeds.
const FRICTIONS: [f64; 4] = [0.0, 0.1, 0.33, 0.56];
/// Speeds, rpm.
const SPEEDS: [f64; 3] = [10.0, 20.0, 40.0];
/// The path of the friction.
const FRICTION: &str = "contact.seed-seed.static_friction";

/// What a steady run says of its angle.
struct Run {
    /// Mean, deg.
    mean: f64,
    /// Standard error that it states, deg.
    error: f64,
    /// Start-up, s.
    start_up: f64,
    /// Time of rotation in all, s.
    turned: f64,
    /// Mean direction of the centre of mass in the first half of what is kept less that in the second, deg.
    fall: f64,
}

/// Reads a record; none of a run that is not steady.
fn run_of(record: &Record) -> Result<Option<Run>, Box<dyn Error>> {
    if record.regime() == Some(NOT_STEADY) {
        return Ok(None);
    }
    let details = RunDetails::of(record)?;
    let mean = record.observables().get("angle_deg").map(|o| o.mean);
    let turned = details.series.time_s.last().copied();
    let parts = (
        mean,
        details.frames.standard_error_deg,
        details.start_up_s,
        turned,
    );
    Ok(match parts {
        (Some(mean), Some(error), Some(start_up), Some(turned)) => Some(Run {
            mean,
            error,
            start_up,
            turned,
            fall: fall(&details, start_up),
        }),
        _ => None,
    })
}

/// First half less second half of the kept series of a run, deg.
fn fall(details: &RunDetails, start_up: f64) -> f64 {
    let series = &details.series;
    let pairs = series.time_s.iter().zip(&series.centre_of_mass_deg);
    let kept: Vec<f64> = pairs
        .filter(|(t, _)| **t >= start_up)
        .map(|(_, a)| *a)
        .collect();
    let (early, late) = kept.split_at(kept.len() / 2);
    mean(early.iter().copied()) - mean(late.iter().copied())
}

/// Mean of numbers; NaN of none.
fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("steady_state", 20)?;
    let drum = small_drum("fixtures/cotton/drum.toml", &[])?;
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let campaign = Campaign::new(&store, threads, &progress);
    let simulator = SceneSimulator::new(
        BTreeMap::from([("drum".to_owned(), drum)]),
        BTreeMap::from([(FRICTION.to_owned(), Binding::of_path(FRICTION))]),
    )?;
    let cells: Vec<(f64, f64)> = FRICTIONS
        .iter()
        .flat_map(|&friction| SPEEDS.iter().map(move |&rpm| (friction, rpm)))
        .collect();
    let requests: Vec<RunRequest> = cells
        .iter()
        .flat_map(|&(friction, rpm)| {
            (1..=runs).map(move |seed| {
                RunRequest::new("drum", seed)
                    .with_parameter(FRICTION, friction)
                    .with_condition("rpm", rpm)
            })
        })
        .collect();
    let records = campaign.run_all(&simulator, &requests)?;
    println!(
        "| friction | rpm | runs | steady | start-up, s | turned, s | angle, deg | scatter of runs, deg | error stated, deg | ratio | first half less second, deg |"
    );
    println!("|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let (mut scatter_of_all, mut stated_of_all) = (0.0, 0.0);
    for (&(friction, rpm), records) in cells.iter().zip(records.chunks(usize::try_from(runs)?)) {
        let steady: Vec<Run> = records
            .iter()
            .map(run_of)
            .collect::<Result<Vec<_>, _>>()?
            .into_iter()
            .flatten()
            .collect();
        let n = steady.len() as f64;
        let angle = mean(steady.iter().map(|r| r.mean));
        let told = mean_and_error(records, "angle_deg", 2);
        let scatter = steady.iter().map(|r| (r.mean - angle).powi(2)).sum::<f64>() / (n - 1.0);
        let stated = mean(steady.iter().map(|r| r.error.powi(2)));
        let fall = mean(steady.iter().map(|r| r.fall));
        let squares: f64 = steady.iter().map(|r| (r.fall - fall).powi(2)).sum();
        scatter_of_all += scatter;
        stated_of_all += stated;
        println!(
            "| {friction} | {rpm} | {runs} | {} | {:.2} | {:.2} | {told} | {:.3} | {:.3} | {:.2} | {fall:.2} +- {:.2} |",
            steady.len(),
            mean(steady.iter().map(|r| r.start_up)),
            mean(steady.iter().map(|r| r.turned)),
            scatter.sqrt(),
            stated.sqrt(),
            (stated / scatter).sqrt(),
            (squares / (n - 1.0) / n).sqrt(),
        );
    }
    println!(
        "\nStated over scatter, all cells together: {:.2}.",
        (stated_of_all / scatter_of_all).sqrt()
    );
    Ok(())
}
