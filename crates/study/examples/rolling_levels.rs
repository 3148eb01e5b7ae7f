//! The single-factor tests of the rolling friction in the study's drum: the angle at three levels of each
//! pair of surfaces, everything else at the published optimum.
//!
//! `cargo run --release -p study --example rolling_levels -- FOLDER [RUNS]`
//!
//! RUNS runs (default 5, as in the study) at each level and at no rolling friction; prints means with standard
//! errors. Finished runs are kept in FOLDER and found again.
//!
//! The study's torque is `mu_r F_n R_i` on each of two seeds, with the radius of the touching sphere. Here the arm of two
//! equal spheres is half of it (`contact_law::rolling_lever`), so that a level between seeds is set as twice its value.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod records;

use campaign::run_store::Store;
use campaign::{Campaign, LineProgress, RunRequest};
use records::{folder_and_runs, mean_and_error};
use scene::Scene;
use simulators::scene_simulator::{Binding, SceneSimulator};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// The levels: pair, low, middle, high, repetitions, speed in rpm.
const LEVELS: &str = include_str!("../../../fixtures/cotton/rolling_levels.csv");

/// What the study reports.
const OBSERVABLE: &str = "angle_deg";

/// Contacts of two seeds, whose coefficient counts double here.
const TWO_SEEDS: &str = "seed-seed";

/// A pair of surfaces and its levels.
type Levels = (&'static str, Vec<f64>);

/// The rows of the file.
fn levels() -> Result<Vec<Levels>, Box<dyn Error>> {
    let rows = LEVELS.lines().skip(1);
    rows.map(|row| {
        let mut cells = row.split(',');
        let pair = cells.next().ok_or("a row without a pair")?;
        let levels = cells.take(3).map(str::parse).collect::<Result<_, _>>()?;
        Ok((pair, levels))
    })
    .collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("rolling_levels", 5)?;
    // The drum of the fixtures stands at the published optimum, without rolling friction.
    let drum = Scene::read(Path::new("fixtures/cotton/drum.toml"), &[])?;
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let campaign = Campaign::new(&store, threads, &progress);
    let levels = levels()?;
    let paths = levels
        .iter()
        .map(|(pair, _)| format!("contact.{pair}.rolling_friction"));
    let bindings = paths.map(|path| (path.clone(), Binding::of_path(&path)));
    let simulator = SceneSimulator::new(
        BTreeMap::from([("drum".to_owned(), drum)]),
        bindings.collect(),
    )?;
    let mut points = vec![("none".to_owned(), 0.0, TWO_SEEDS)];
    for (pair, values) in &levels {
        points.extend(values.iter().map(|v| ((*pair).to_owned(), *v, *pair)));
    }
    let set = |pair: &str, level: f64| {
        if pair == TWO_SEEDS {
            2.0 * level
        } else {
            level
        }
    };
    let of_point = |(_, level, pair): &(String, f64, &str)| -> Vec<RunRequest> {
        let name = format!("contact.{pair}.rolling_friction");
        let value = set(pair, *level);
        let request = |seed| RunRequest::new("drum", seed).with_parameter(&name, value);
        (1..=runs).map(request).collect()
    };
    let requests: Vec<RunRequest> = points.iter().flat_map(of_point).collect();
    let records = campaign.run_all(&simulator, &requests)?;
    println!("| rolling friction of | level of the study | set here | runs | angle, deg |");
    println!("|---|--:|--:|--:|--:|");
    let runs = usize::try_from(runs)?;
    for ((name, level, pair), of_point) in points.iter().zip(records.chunks(runs)) {
        let angle = mean_and_error(of_point, OBSERVABLE, 2);
        let value = set(pair, *level);
        println!("| {name} | {level} | {value} | {runs} | {angle} |");
    }
    Ok(())
}
