//! What the time step does to the study's drum: angle, shell slip, curvature and kinetic energy.
//!
//! `cargo run --release -p study --example time_step -- FOLDER [RUNS]`
//!
//! Runs the drum with RUNS seeds (default 10) at each step and prints means with standard errors over
//! the runs that came to their end. Too long a step throws seeds out, which ends a run: the table counts
//! those runs, and the reasons go to standard error. Finished runs are kept in FOLDER and found again.
//! The shortest step is the reference; each of its runs takes more than a minute of one core.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]
#![expect(
    clippy::print_stderr,
    reason = "why a run ended early is told beside the table"
)]

mod records;

use campaign::{Campaign, RunRequest, Silent};
use records::{folder_and_runs, mean_and_error};
use run_store::Store;
use scene::Scene;
use scene_simulator::{Binding, SceneSimulator};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Time steps, s; the first is the reference.
const STEPS: [f64; 4] = [0.025e-3, 0.1e-3, 0.12e-3, 0.14e-3];

/// What is compared.
const OBSERVABLES: [&str; 5] = [
    "angle_deg",
    "centre_of_mass_deg",
    "curvature",
    "shell_slip",
    "kinetic_energy_mj",
];

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("time_step", 10)?;
    let drum = Path::new("fixtures/cotton/drum.toml");
    let scenes = BTreeMap::from([("drum".to_owned(), Scene::read(drum, &[])?)]);
    let step = Binding {
        unit: Some("s".to_owned()),
        ..Binding::of_path("protocol.time_step")
    };
    let share = Binding::of_path("protocol.step_share");
    let bindings = [("time_step_s", step), ("protocol.step_share", share)];
    let bindings = bindings.map(|(symbol, binding)| (symbol.to_owned(), binding));
    let simulator = SceneSimulator::new(scenes, bindings.into())?;
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let campaign = Campaign::new(&store, threads, &Silent);
    println!(
        "| step, ms | runs that came to their end | {} |",
        OBSERVABLES.join(" | ")
    );
    println!("|---|---|{}", "---|".repeat(OBSERVABLES.len()));
    for step in STEPS {
        let request = |seed| {
            let mut request = RunRequest::new("drum", seed);
            let settings = [("time_step_s", step), ("protocol.step_share", 1.0)];
            request.parameters = settings.map(|(n, v)| (n.to_owned(), v)).into();
            request
        };
        let requests: Vec<_> = (1..=runs).map(request).collect();
        let mut records = Vec::new();
        for (request, result) in requests
            .iter()
            .zip(campaign.run_each(&simulator, &requests)?)
        {
            match result {
                Ok(record) => records.push(record),
                Err(reason) => eprintln!("{:.4} ms, seed {}: {reason}", step * 1e3, request.seed),
            }
        }
        let cells = OBSERVABLES.map(|o| mean_and_error(&records, o, 4));
        let finished = records.len();
        println!(
            "| {:.4} | {finished} of {runs} | {} |",
            step * 1e3,
            cells.join(" | ")
        );
    }
    Ok(())
}
