//! How a bed moves: form, angle and what tells them apart, by speed in a small drum, and by friction and filling in the
//! study's drum, with what restitution and friction at the shell do there.
//!
//! `cargo run --release -p study --example bed_motion -- FOLDER [RUNS]`
//!
//! RUNS runs (default 4) of each row; prints the tables. Finished runs are kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the tables are the purpose")]

mod motions;
mod records;
mod small_drum;

use campaign::run_store::{Record, Store};
use campaign::{Campaign, LineProgress, RunRequest};
use motions::forms;
use records::{folder_and_runs, mean_and_error};
use scene::Scene;
use simulators::scene_simulator::{Binding, SceneSimulator};
use small_drum::small_drum;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Speed (rpm), friction between seeds, and that at the shell and the covers.
const SPEEDS: [[f64; 3]; 10] = [
    [1.0, 0.1, 0.33],
    [2.0, 0.1, 0.33],
    [5.0, 0.1, 0.33],
    [10.0, 0.1, 0.33],
    [40.0, 0.1, 0.33],
    [60.0, 0.1, 0.33],
    [110.0, 0.1, 0.33],
    [2.0, 0.56, 0.33],
    [10.0, 0.56, 0.33],
    [10.0, 0.1, 0.02],
];

/// Friction between seeds.
const FRICTIONS: [f64; 5] = [0.0, 0.05, 0.1, 0.33, 0.56];

/// Scenes of the study's drum: packed and smooth seeds.
const FILLINGS: [(&str, &str); 2] = [
    ("packed", "fixtures/cotton/drum.toml"),
    ("smooth", "fixtures/cotton/measured.toml"),
];

/// Paths of what is varied.
const SEED_SEED: &str = "contact.seed-seed.static_friction";
const SEED_SHELL: &str = "contact.seed-tough_resin.static_friction";
const SEED_COVER: &str = "contact.seed-clear_resin.static_friction";
const REBOUND: &str = "contact.seed-seed.restitution";

/// The rest of the study's optimum: friction at the shell, restitution between seeds.
const OPTIMUM: [f64; 2] = [0.33, 0.06];

/// The effects of the study: symbol, where it is looked at (friction between seeds), and its two levels of friction
/// between seeds, friction at the shell and restitution between seeds. Levels as in its table 2; those of F are as far
/// apart.
const EFFECTS: [(&str, f64, [[f64; 3]; 2]); 6] = [
    ("B", 0.05, [[0.05, 0.30, 0.06], [0.05, 0.42, 0.06]]),
    ("E", 0.05, [[0.05, 0.33, 0.01], [0.05, 0.33, 0.18]]),
    ("F", 0.05, [[0.0, 0.33, 0.06], [0.1, 0.33, 0.06]]),
    ("B", 0.33, [[0.33, 0.30, 0.06], [0.33, 0.42, 0.06]]),
    ("E", 0.33, [[0.33, 0.33, 0.01], [0.33, 0.33, 0.18]]),
    ("F", 0.33, [[0.28, 0.33, 0.06], [0.38, 0.33, 0.06]]),
];

/// The run of a scene with friction between seeds and at the shell and restitution between seeds.
fn request(scene: &str, [seeds, shell, rebound]: [f64; 3], seed: u64) -> RunRequest {
    RunRequest::new(scene, seed)
        .with_parameter(SEED_SEED, seeds)
        .with_parameter(SEED_SHELL, shell)
        .with_parameter(REBOUND, rebound)
}

/// Mean of the angles of runs (deg) and the variance of that mean.
fn mean_and_variance(records: &[Record]) -> (f64, f64) {
    let angles: Vec<f64> = records
        .iter()
        .filter_map(|r| r.observable("angle_deg"))
        .map(|o| o.mean)
        .collect();
    let n = angles.len() as f64;
    let mean = angles.iter().sum::<f64>() / n;
    let square: f64 = angles.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, square / (n - 1.0) / n)
}

/// Runs points with several seeds each.
struct Runner<'a> {
    /// Where runs are kept.
    campaign: Campaign<'a>,
    /// What runs them.
    simulator: SceneSimulator,
    /// Runs of a point.
    runs: u64,
}

impl Runner<'_> {
    /// The records of all points, point by point.
    fn records(&self, points: &[RunRequest]) -> Result<Vec<Vec<Record>>, Box<dyn Error>> {
        let with_seed = |point: &RunRequest, seed| RunRequest {
            seed,
            ..point.clone()
        };
        let each = points.iter();
        let requests: Vec<RunRequest> = each
            .flat_map(|p| (1..=self.runs).map(move |seed| with_seed(p, seed)))
            .collect();
        let records = self.campaign.run_all(&self.simulator, &requests)?;
        let of_point = records.chunks(usize::try_from(self.runs)?);
        Ok(of_point.map(<[Record]>::to_vec).collect())
    }
}

/// The small drum by speed.
fn by_speed(runner: &Runner<'_>) -> Result<(), Box<dyn Error>> {
    let points = SPEEDS.map(|[rpm, seeds, wall]| {
        request("small", [seeds, wall, OPTIMUM[1]], 1)
            .with_parameter(SEED_COVER, wall)
            .with_condition("rpm", rpm)
    });
    let records = runner.records(&points)?;
    println!(
        "| rpm | friction of seeds, of walls | runs of each form | slip | carried share | waiting, s | airborne share | S shape |"
    );
    println!("|--:|--:|---|--:|--:|--:|--:|--:|");
    for ([rpm, seeds, wall], records) in SPEEDS.iter().zip(&records) {
        let of = |name| mean_and_error(records, name, 2);
        println!(
            "| {rpm} | {seeds}, {wall} | {} | {} | {} | {} | {} | {} |",
            forms(records)?,
            of("shell_slip"),
            of("carried_share"),
            of("waiting_time_s"),
            of("airborne_share"),
            of("s_shape"),
        );
    }
    Ok(())
}

/// The study's drum by filling and friction.
fn by_friction(runner: &Runner<'_>) -> Result<(), Box<dyn Error>> {
    println!(
        "\n| filling | friction of seeds | runs of each form | angle, deg | fluctuation, deg |"
    );
    println!("|---|--:|---|--:|--:|");
    for (filling, _) in FILLINGS {
        let points = FRICTIONS.map(|f| request(filling, [f, OPTIMUM[0], OPTIMUM[1]], 1));
        for (friction, records) in FRICTIONS.iter().zip(&runner.records(&points)?) {
            println!(
                "| {filling} | {friction} | {} | {} | {} |",
                forms(records)?,
                mean_and_error(records, "angle_deg", 2),
                mean_and_error(records, "fluctuation_deg", 2),
            );
        }
    }
    Ok(())
}

/// The study's effects at two frictions.
fn effects(runner: &Runner<'_>) -> Result<(), Box<dyn Error>> {
    println!("\n| effect | at a friction of seeds of | high less low, deg |");
    println!("|---|--:|--:|");
    for (symbol, at, levels) in EFFECTS {
        let records = runner.records(&levels.map(|level| request("packed", level, 1)))?;
        let ((low, v_low), (high, v_high)) = (
            mean_and_variance(&records[0]),
            mean_and_variance(&records[1]),
        );
        println!(
            "| {symbol} | {at} | {:.2} +- {:.2} |",
            high - low,
            (v_low + v_high).sqrt()
        );
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("bed_motion", 4)?;
    // A turn of the slowest drum is a minute; its avalanches are seconds apart.
    let small = small_drum(FILLINGS[0].1, &[("protocol.rotation_limit", "20 s")])?;
    let mut scenes = BTreeMap::from([("small".to_owned(), small)]);
    for (name, file) in FILLINGS {
        scenes.insert(name.to_owned(), Scene::read(Path::new(file), &[])?);
    }
    let paths = [SEED_SEED, SEED_SHELL, SEED_COVER, REBOUND];
    let bindings = paths.map(|path| (path.to_owned(), Binding::of_path(path)));
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let runner = Runner {
        campaign: Campaign::new(&store, threads, &progress),
        simulator: SceneSimulator::new(scenes, bindings.into())?,
        runs,
    };
    by_speed(&runner)?;
    by_friction(&runner)?;
    effects(&runner)
}
