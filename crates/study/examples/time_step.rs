//! What the time step does to the angle of a drum, by friction and filling, to that of soft beads, and to bench tests.
//!
//! `cargo run --release -p study --example time_step -- FOLDER [RUNS]`
//!
//! Runs the study's drum, cut to 100 mm and 320 seeds, with RUNS seeds (default 4) at each friction, filling and step and prints
//! means with standard errors over the runs that came to their end. Too long a step throws seeds out, which ends a run: the
//! table says how many were left, and the reasons go to standard error. Before it stand a table of bench tests, which are
//! stepped finer, and one of soft beads, whose step follows from their bed at rest, both with 2 RUNS seeds. Finished runs are kept
//! in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]
#![expect(
    clippy::print_stderr,
    reason = "why a run ended early is told beside the table"
)]

mod records;
mod small_drum;

use campaign::run_store::{Record, Store};
use campaign::{Campaign, RunRequest, Silent};
use records::{folder_and_runs, mean_and_error};
use scene::{Apparatus, Drop, Scene, Slider, Tilt};
use simulators::scene_simulator::{Binding, RunDetails, SceneSimulator};
use small_drum::{scene_with, small_drum};
use std::collections::BTreeMap;
use std::error::Error;

/// Time steps as shares of a hard contact; the first is the reference.
const SHARES: [f64; 5] = [0.09, 0.30, 0.36, 0.42, 0.50];

/// Friction between seeds.
const FRICTIONS: [f64; 3] = [0.1, 0.33, 0.56];

/// Fillings: name, scene, spheres of a seed where they are not those of the scene, and whether the reference is run.
const FILLINGS: [(&str, &str, Option<&str>, bool); 4] = [
    ("packed", "fixtures/cotton/drum.toml", None, true),
    ("50 spheres", "fixtures/cotton/drum.toml", Some("50"), false),
    (
        "100 spheres",
        "fixtures/cotton/drum.toml",
        Some("100"),
        false,
    ),
    ("smooth", "fixtures/cotton/measured.toml", None, true),
];

/// Shares of soft beads; the first is the reference.
const SHARES_OF_BEADS: [f64; 3] = [0.12, DEFAULT_SHARE, 0.72];

/// Soft beads: shear modulus and rolling friction, of type A.
const BEADS: [[&str; 2]; 4] = [
    ["0.25 MPa", "0.1"],
    ["0.25 MPa", "0"],
    ["0.02 MPa", "0.1"],
    ["0.02 MPa", "0"],
];

/// Shares of bench tests: a quarter of the default, the default, and the longest.
const SHARES_OF_TESTS: [f64; 3] = [0.09, DEFAULT_SHARE, 1.0];

/// Plates of bench tests: smooth, and covered with seeds.
const PLATES: [&str; 2] = ["tough_resin", "seed"];

/// Changes of the study's scene: with rolling friction that a tilted seed has to overcome.
const ROLLING: [(&str, &str); 2] = [
    ("contact.seed-tough_resin.rolling_friction", "0.1"),
    ("contact.seed-seed.rolling_friction", "0.1"),
];

/// Spheres of a seed.
const SPHERES: [&str; 2] = ["seed.0.filling.sphere_count", "seed.1.filling.sphere_count"];

/// Paths of the friction and of the time steps.
const FRICTION: &str = "contact.seed-seed.static_friction";
const STEPS: [&str; 2] = ["protocol.step_share", "protocol.flow_step_share"];

/// Share at which the step and the slip are told: the default.
const DEFAULT_SHARE: f64 = 0.36;

/// The small drum with a filling.
fn scene(file: &str, spheres: Option<&str>) -> Result<Scene, scene::Error> {
    let filled = SPHERES.iter().filter_map(|path| Some((*path, spheres?)));
    small_drum(file, &filled.collect::<Vec<_>>())
}

/// The time step of a finished run, ms.
fn step_of(records: &[Record]) -> Result<String, Box<dyn Error>> {
    let Some(record) = records.first() else {
        return Ok("-".into());
    };
    let step = RunDetails::of(record)?.timing.time_step_s;
    Ok(format!("{:.3}", 1e3 * step))
}

/// The bench tests of the study's seeds on a plate.
fn tests(plate: &str) -> Result<[Apparatus; 3], Box<dyn Error>> {
    let (plate, seed) = (plate.to_owned(), None);
    let sled = Slider {
        plate: plate.clone(),
        seed: seed.clone(),
        repeats: 5,
    };
    let tilt = Tilt {
        plate: plate.clone(),
        seed: seed.clone(),
        repeats: 15,
    };
    let drop = Drop {
        plate,
        seed,
        repeats: 40,
        plate_give: 0.0,
        height: "200 mm".parse()?,
    };
    Ok([
        Apparatus::Slider(sled),
        Apparatus::Tilt(tilt),
        Apparatus::Drop(drop),
    ])
}

/// What a bench test shows.
fn shown(test: &Apparatus) -> &'static str {
    match test {
        Apparatus::Slider(_) => "shown_static_friction",
        Apparatus::Tilt(_) => "shown_rolling_friction",
        _ => "shown_restitution",
    }
}

/// Scenes of all bench tests, by what they show and the plate.
fn test_scenes() -> Result<BTreeMap<String, Scene>, Box<dyn Error>> {
    let seeds = scene_with("fixtures/cotton/measured.toml", &ROLLING)?;
    let mut scenes = BTreeMap::new();
    for plate in PLATES {
        for apparatus in tests(plate)? {
            let name = format!("{} on {plate}", shown(&apparatus));
            let scene = Scene {
                apparatus,
                ..seeds.clone()
            };
            scenes.insert(name, scene);
        }
    }
    Ok(scenes)
}

/// A drum of soft beads.
fn beads([modulus, rolling]: [&str; 2]) -> Result<Scene, scene::Error> {
    let changes = [
        ("model.rolling_law", "constant-torque"),
        ("material.bead.shear_modulus", modulus),
        ("material.wall.shear_modulus", modulus),
        ("contact.bead-bead.rolling_friction", rolling),
        ("contact.bead-wall.rolling_friction", rolling),
    ];
    scene_with("fixtures/other-code/drum.toml", &changes)
}

/// The records of so many seeds of a model with these parameters; why a run is missing goes to standard error.
fn records_of(
    campaign: &Campaign<'_>,
    simulator: &SceneSimulator,
    model: &str,
    parameters: &[(&str, f64)],
    runs: u64,
) -> Result<Vec<Record>, Box<dyn Error>> {
    let request = |seed| {
        let begun = RunRequest::new(model, seed);
        let all = parameters.iter();
        all.fold(begun, |request, (path, value)| {
            request.with_parameter(path, *value)
        })
    };
    let requests: Vec<_> = (1..=runs).map(request).collect();
    let results = campaign.run_each(simulator, &requests)?;
    let mut records = Vec::new();
    for (seed, result) in (1..=runs).zip(results) {
        match result {
            Ok(record) => records.push(record),
            Err(reason) => eprintln!("{model}, {parameters:?}, seed {seed}: {reason}"),
        }
    }
    Ok(records)
}

/// An angle with its error, and how many runs were left where some are missing.
fn angle(records: &[Record], runs: u64) -> Result<String, Box<dyn Error>> {
    let angle = mean_and_error(records, "angle_deg", 2);
    let left = records.len();
    Ok(if u64::try_from(left)? == runs {
        angle
    } else {
        format!("{angle} ({left} of {runs})")
    })
}

/// The table of seeds by filling and friction.
fn table_of_seeds(
    campaign: &Campaign<'_>,
    simulator: &SceneSimulator,
    runs: u64,
) -> Result<(), Box<dyn Error>> {
    let shares = SHARES.map(|share| format!("{share:.2}"));
    println!(
        "| filling | friction | step at {DEFAULT_SHARE}, ms | {} | shell slip at {DEFAULT_SHARE} |",
        shares.join(" | ")
    );
    println!("|---|--:|--:|{}--:|", "--:|".repeat(SHARES.len()));
    for (filling, _, _, with_reference) in FILLINGS {
        for friction in FRICTIONS {
            let (mut cells, mut step, mut slip) = (Vec::new(), String::new(), String::new());
            for share in SHARES {
                if share == SHARES[0] && !with_reference {
                    cells.push("not run".to_owned());
                    continue;
                }
                let parameters = [(FRICTION, friction), (STEPS[0], share), (STEPS[1], share)];
                let records = records_of(campaign, simulator, filling, &parameters, runs)?;
                cells.push(angle(&records, runs)?);
                if share == DEFAULT_SHARE {
                    step = step_of(&records)?;
                    slip = mean_and_error(&records, "shell_slip", 2);
                }
            }
            println!(
                "| {filling} | {friction} | {step} | {} | {slip} |",
                cells.join(" | ")
            );
        }
    }
    Ok(())
}

/// The table of bench tests.
fn table_of_tests(campaign: &Campaign<'_>, runs: u64) -> Result<(), Box<dyn Error>> {
    let scenes = test_scenes()?;
    let share = (STEPS[0].to_owned(), Binding::of_path(STEPS[0]));
    let simulator = SceneSimulator::new(scenes.clone(), [share].into())?.with_retries(0);
    let shares = SHARES_OF_TESTS.map(|share| format!("{share:.2}"));
    println!("| bench test | {} |", shares.join(" | "));
    println!("|---|{}", "--:|".repeat(SHARES_OF_TESTS.len()));
    for (model, scene) in &scenes {
        let mut cells = Vec::new();
        for share in SHARES_OF_TESTS {
            let records = records_of(campaign, &simulator, model, &[(STEPS[0], share)], runs)?;
            cells.push(mean_and_error(&records, shown(&scene.apparatus), 4));
        }
        println!("| {model} | {} |", cells.join(" | "));
    }
    Ok(())
}

/// The table of soft beads.
fn table_of_beads(
    campaign: &Campaign<'_>,
    simulator: &SceneSimulator,
    runs: u64,
) -> Result<(), Box<dyn Error>> {
    let shares = SHARES_OF_BEADS.map(|share| format!("{share:.2}"));
    println!(
        "| shear modulus, rolling friction | {} |",
        shares.join(" | ")
    );
    println!("|---|{}", "--:|".repeat(SHARES_OF_BEADS.len()));
    for bead in BEADS {
        let model = bead.join(", ");
        let mut cells = Vec::new();
        for share in SHARES_OF_BEADS {
            let records = records_of(campaign, simulator, &model, &[(STEPS[0], share)], runs)?;
            cells.push(angle(&records, runs)?);
        }
        println!("| {model} | {} |", cells.join(" | "));
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("time_step", 4)?;
    let mut scenes = BTreeMap::new();
    for (name, file, spheres, _) in FILLINGS {
        scenes.insert(name.to_owned(), scene(file, spheres)?);
    }
    let paths = [FRICTION, STEPS[0], STEPS[1]];
    let bindings = paths.map(|path| (path.to_owned(), Binding::of_path(path)));
    // A run that is tried again with half its step would stand in the wrong column.
    let seeds = SceneSimulator::new(scenes, bindings.into())?.with_retries(0);
    let mut scenes = BTreeMap::new();
    for bead in BEADS {
        scenes.insert(bead.join(", "), beads(bead)?);
    }
    let share = (STEPS[0].to_owned(), Binding::of_path(STEPS[0]));
    let soft = SceneSimulator::new(scenes, [share].into())?.with_retries(0);
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let campaign = Campaign::new(&store, threads, &Silent);
    table_of_tests(&campaign, 2 * runs)?;
    println!();
    table_of_beads(&campaign, &soft, 2 * runs)?;
    println!();
    table_of_seeds(&campaign, &seeds, runs)
}
