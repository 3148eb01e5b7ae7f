//! The pretests of the study (its section 2.4.3): how the bed moves with the measured parameters, and with one of them
//! far off, here beside there.
//!
//! `cargo run --release -p study --example pretests -- FOLDER [RUNS]`
//!
//! RUNS runs (default 3) of each row of `fixtures/cotton/pretests.csv` in the study's drum; prints the table. Where a row
//! draws parameters at random, each run has its own. Finished runs are kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod motions;
mod records;

use campaign::run_store::Store;
use campaign::{Campaign, LineProgress, RunRequest};
use motions::forms;
use probability::random_stream::Stream;
use records::{folder_and_runs, mean_and_error};
use scene::Scene;
use simulators::scene_simulator::{Binding, SceneSimulator};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// The pretests: case, parameter, pair, value, rolling friction, regime, angle and remark.
const PRETESTS: &str = include_str!("../../../fixtures/cotton/pretests.csv");

/// The bench measurements: parameter, pair, least, most, mean and so on.
const BENCH: &str = include_str!("../../../fixtures/cotton/contact_measurements.csv");

/// A contact parameter as it was measured.
struct Measured {
    /// Its path in a scene.
    path: String,
    /// Whether it is a rolling friction.
    rolls: bool,
    /// Least, greatest and mean value.
    range: [f64; 3],
}

/// A row of the pretests.
struct Pretest<'a> {
    /// What is changed, as the file tells it.
    told: String,
    /// The regime there, and the angle, deg, where it is stated.
    there: [&'a str; 2],
    /// The parameters that are set at a value.
    set: Vec<(String, f64)>,
    /// Whether each run draws its parameters from the measured ranges.
    draws: bool,
    /// Whether rolling friction is as measured; otherwise there is none.
    rolls: bool,
    /// The range of the friction between seeds, where it is another than the measured one.
    friction: Option<[f64; 2]>,
}

/// Path of the friction between seeds.
const FRICTION: &str = "contact.seed-seed.static_friction";

/// What the bench measured.
fn bench() -> Result<Vec<Measured>, Box<dyn Error>> {
    let rows = BENCH.lines().skip(1);
    rows.map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let [parameter, pair, least, most, mean, ..] = cells[..] else {
            return Err(format!("too few cells in '{row}'").into());
        };
        Ok(Measured {
            path: format!("contact.{pair}.{parameter}"),
            rolls: parameter == "rolling_friction",
            range: [least.parse()?, most.parse()?, mean.parse()?],
        })
    })
    .collect()
}

/// The pretests of the file.
fn pretests() -> Result<Vec<Pretest<'static>>, Box<dyn Error>> {
    let rows = PRETESTS.lines().skip(1);
    rows.map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let [case, parameter, pair, value, rolling, regime, angle, ..] = cells[..] else {
            return Err(format!("too few cells in '{row}'").into());
        };
        let path = format!("contact.{pair}.{parameter}");
        let range = value.split_once("..");
        let range =
            range.map(|(a, b)| Ok::<_, std::num::ParseFloatError>([a.parse()?, b.parse()?]));
        let single = case == "single";
        Ok(Pretest {
            told: match case {
                "single" | "range_scan" => {
                    format!("{} {pair} {value}", parameter.replace('_', " "))
                }
                _ => case.replace('_', " "),
            },
            there: [regime, angle],
            set: if single {
                vec![(path, value.parse()?)]
            } else {
                Vec::new()
            },
            draws: !single && !case.contains("means"),
            rolls: rolling == "measured means",
            friction: range.transpose()?,
        })
    })
    .collect()
}

/// The run of a pretest with a seed.
fn request(test: &Pretest<'_>, bench: &[Measured], seed: u64) -> RunRequest {
    let mut stream = Stream::new(seed, &test.told);
    let mut request = RunRequest::new("drum", seed);
    for measured in bench {
        let [least, most, mean] = measured.range;
        let [least, most] = match test.friction {
            Some(range) if measured.path == FRICTION => range,
            _ => [least, most],
        };
        let drawn = stream.between(least, most);
        let value = match (measured.rolls, test.draws) {
            (true, _) if !test.rolls => 0.0,
            (false, true) => drawn,
            _ => mean,
        };
        request = request.with_parameter(&measured.path, value);
    }
    for (path, value) in &test.set {
        request = request.with_parameter(path, *value);
    }
    request
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("pretests", 3)?;
    let bench = bench()?;
    let tests = pretests()?;
    let drum = Scene::read(Path::new("fixtures/cotton/drum.toml"), &[])?;
    let bindings = bench
        .iter()
        .map(|m| (m.path.clone(), Binding::of_path(&m.path)));
    let simulator = SceneSimulator::new(
        BTreeMap::from([("drum".to_owned(), drum)]),
        bindings.collect(),
    )?;
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let campaign = Campaign::new(&store, threads, &progress);
    let requests: Vec<RunRequest> = tests
        .iter()
        .flat_map(|test| (1..=runs).map(|seed| request(test, &bench, seed)))
        .collect();
    let records = campaign.run_all(&simulator, &requests)?;
    println!(
        "| pretest | in the study | here: runs of each form | angle, deg | slip at the shell |"
    );
    println!("|---|---|---|--:|--:|");
    for (test, records) in tests.iter().zip(records.chunks(usize::try_from(runs)?)) {
        let [regime, angle] = test.there;
        let stated = if angle.is_empty() {
            String::new()
        } else {
            format!(", {angle} deg")
        };
        println!(
            "| {} | {regime}{stated} | {} | {} | {} |",
            test.told,
            forms(records)?,
            mean_and_error(records, "angle_deg", 2),
            mean_and_error(records, "shell_slip", 2),
        );
    }
    Ok(())
}
