//! What larger spheres in place of the real ones do to the drum of microcrystalline cellulose.
//!
//! `cargo run --release -p study --example sphere_size -- FOLDER [RUNS]`
//!
//! The bed of `fixtures/mcc/drum.toml` made of spheres of three diameters, the volume of all the same, at the two
//! speeds of the photographs: RUNS runs (default 2) of each; prints means with standard errors. Finished runs are
//! kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod records;

use campaign::run_store::Store;
use campaign::{Campaign, LineProgress, RunRequest};
use records::{folder_and_runs, mean_and_error};
use scene::{Override, Scene};
use simulators::scene_simulator::SceneSimulator;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Diameters, mm: that of the scene file first.
const DIAMETERS: [f64; 3] = [3.0, 2.4, 2.0];

/// Speeds of the photographs, rpm.
const SPEEDS: [f64; 2] = [15.0, 45.0];

/// What is compared.
const OBSERVABLES: [&str; 3] = ["angle_deg", "curvature", "s_shape"];

/// The drum with spheres of a diameter (mm) and the volume of bed of the file.
fn drum(diameter: f64) -> Result<Scene, Box<dyn Error>> {
    let path = Path::new("fixtures/mcc/drum.toml");
    let file = Scene::read(path, &[])?;
    let sphere = file.seed.first().ok_or("no seed in the scene")?;
    let ratio = diameter / DIAMETERS[0];
    let count = (file.count_of(sphere) as f64 / ratio.powi(3)).round();
    let setting = |name: &str, value: String| Override {
        name: format!("seed.0.{name}"),
        value,
    };
    let changes = [
        setting("sphere", format!("{diameter} mm")),
        setting("count", format!("{count}")),
    ];
    Ok(Scene::read(path, &changes)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("sphere_size", 2)?;
    let mut scenes = BTreeMap::new();
    for diameter in DIAMETERS {
        scenes.insert(diameter.to_string(), drum(diameter)?);
    }
    let counts: Vec<_> = DIAMETERS
        .map(|d| scenes[&d.to_string()].seed_count())
        .into();
    let simulator = SceneSimulator::new(scenes, BTreeMap::new())?;
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let campaign = Campaign::new(&store, threads, &progress);
    let mut requests = Vec::new();
    for diameter in DIAMETERS {
        for speed in SPEEDS {
            let request =
                |seed| RunRequest::new(&diameter.to_string(), seed).with_condition("rpm", speed);
            requests.extend((1..=runs).map(request));
        }
    }
    let records = campaign.run_all(&simulator, &requests)?;
    println!(
        "| diameter, mm | spheres | rpm | runs | {} |",
        OBSERVABLES.join(" | ")
    );
    println!("|--:|--:|--:|--:|{}", "--:|".repeat(OBSERVABLES.len()));
    let mut of_points = records.chunks(usize::try_from(runs)?);
    for (diameter, count) in DIAMETERS.iter().zip(counts) {
        for (speed, of_point) in SPEEDS.iter().zip(&mut of_points) {
            let cells = OBSERVABLES.map(|o| mean_and_error(of_point, o, 3));
            println!(
                "| {diameter} | {count} | {speed} | {runs} | {} |",
                cells.join(" | ")
            );
        }
    }
    Ok(())
}
