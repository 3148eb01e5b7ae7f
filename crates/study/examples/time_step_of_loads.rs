//! What the time step does where something else than weight loads the contacts: attraction, liquid, dashpots of whole bodies, and
//! large bodies that meet fast.
//!
//! `cargo run --release -p study --example time_step_of_loads -- FOLDER [RUNS]`
//!
//! Runs each scene with RUNS seeds (default 4) at the step that the rule gives, half and a quarter of it, and prints means with
//! standard errors, and how many runs were left where some diverged. Drums are cut short: they show the direction of the centre of
//! mass after half a second, not a steady state. Finished runs are kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]
#![expect(
    clippy::print_stderr,
    reason = "why a run ended early is told beside the table"
)]

mod records;
mod small_drum;

use campaign::run_store::Store;
use campaign::{Campaign, RunRequest, Silent};
use input::quantity::Angle;
use records::{folder_and_runs, mean_and_error, mean_and_error_of_all};
use scene::{LiquidSettings, Override, Scene};
use simulators::scene_simulator::{Binding, SceneSimulator};
use small_drum::small_drum;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Shares of the step that the rule gives.
const PARTS: [f64; 3] = [1.0, 0.5, 0.25];

/// Path of the share, while seeds settle and while the drum turns.
const STEPS: [&str; 2] = ["protocol.step_share", "protocol.flow_step_share"];

/// Attractions of a pair of peas, N: 0, 1 and 4.9 weights. From some ten weights on the peas stand as they were in the cylinder.
const ATTRACTIONS: [(&str, &str); 3] = [
    ("attraction 0", "0"),
    ("attraction 1 weight", "0.00041"),
    ("attraction 4.9 weights", "0.002"),
];

/// A heap of peas.
const PEAS: &str = r#"
    [apparatus]
    kind = "heap"
    inner_diameter = "40 mm"
    height = "80 mm"
    lift_speed = "50 mm/s"
    floor = "wall"
    cylinder = "wall"
    [[seed]]
    name = "pea"
    sphere = "4 mm"
    density = "1250 kg/m3"
    count = 600
    material = "pea"
    [material]
    pea = { poisson_ratio = 0.3, shear_modulus = "2 MPa" }
    wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
    [contact]
    pea-pea = { restitution = 0.3, static_friction = 0.6, rolling_friction = 0.3 }
    pea-wall = { restitution = 0.3, static_friction = 0.2, rolling_friction = 0.1 }
    [protocol]
    rotation_limit = "4 s"
"#;

/// Stones in a drum, of overlapping spheres, that meet at up to 4 m/s.
const STONES: &str = r#"
    [apparatus]
    kind = "drum"
    inner_diameter = "800 mm"
    width = "300 mm"
    speed = "10 rpm"
    shell = "steel"
    cover = "steel"
    [[seed]]
    name = "stone"
    ellipsoid = ["80 mm", "56 mm", "48 mm"]
    density = "2600 kg/m3"
    count = 250
    material = "stone"
    filling = { method = "surface", sphere_count = 60, sphere_radius = "1 mm", seed = 1 }
    [material]
    stone = { poisson_ratio = 0.25, shear_modulus = "10 MPa" }
    steel = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
    [contact]
    stone-stone = { restitution = 0.3, static_friction = 0.6 }
    stone-steel = { restitution = 0.3, static_friction = 0.5 }
    [protocol]
    frames = 2
    rotation_limit = "0.4 s"
"#;

/// What makes the small drum a thin one, which is cut short.
const SHORT: [(&str, &str); 5] = [
    ("apparatus.width", "12 mm"),
    ("seed.0.count", "141"),
    ("seed.1.count", "19"),
    ("protocol.rotation_limit", "0.4 s"),
    ("protocol.frames", "2"),
];

/// Seeds whose dashpots know the mass of the body: filling, file and mass.
const DASHPOTS: [[&str; 3]; 3] = [
    ["packed", "drum", "shared"],
    ["packed", "drum", "body"],
    ["smooth", "measured", "body"],
];

/// A scene from text, with changes.
fn of_text(text: &str, changes: &[(&str, &str)]) -> Result<Scene, scene::Error> {
    let set = |(name, value): &(&str, &str)| Override {
        name: (*name).to_owned(),
        value: (*value).to_owned(),
    };
    let changes: Vec<Override> = changes.iter().map(set).collect();
    Scene::from_text(text, "scene of the example", Path::new("."), &changes)
}

/// All scenes by name, those that cost least first.
fn scenes() -> Result<Vec<(String, Scene)>, Box<dyn Error>> {
    let mut scenes = vec![("drum of stones".to_owned(), of_text(STONES, &[])?)];
    for [filling, file, mass] in DASHPOTS {
        let changes = [&SHORT[..], &[("model.dashpot_mass", mass)]].concat();
        let drum = small_drum(&format!("fixtures/cotton/{file}.toml"), &changes)?;
        scenes.push((format!("drum of {filling} seeds, dashpots {mass}"), drum));
    }
    let heap = |attraction| of_text(PEAS, &[("contact.pea-pea.attraction_n", attraction)]);
    let mut wet = of_text(PEAS, &[])?;
    wet.model.liquid = Some(LiquidSettings::new(0.02, 0.07, Angle::from_si(0.0)?));
    for (name, attraction) in ATTRACTIONS {
        scenes.push((format!("heap, {name}"), heap(attraction)?));
    }
    scenes.push(("heap, liquid of 2 %".to_owned(), wet));
    Ok(scenes)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("time_step_of_loads", 4)?;
    let scenes = scenes()?;
    let models: BTreeMap<_, _> = scenes.iter().cloned().collect();
    let bindings = STEPS.map(|path| (path.to_owned(), Binding::of_path(path)));
    // A run that is tried again with half its step would stand in the wrong column.
    let simulator = SceneSimulator::new(models, bindings.into())?.with_retries(0);
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let campaign = Campaign::new(&store, threads, &Silent);
    let parts = PARTS.map(|part| part.to_string());
    println!(
        "| scene | shown | {} |\n|---|---|{}",
        parts.join(" | "),
        "--:|".repeat(PARTS.len())
    );
    for (name, scene) in &scenes {
        let shown: &[&str] = if scene.apparatus.is_release() {
            &["angle_of_repose_deg", "base_radius_mm", "height_mm"]
        } else {
            &["centre_of_mass_deg"]
        };
        let mut columns = Vec::new();
        for part in PARTS {
            let request = |seed| {
                let begun = RunRequest::new(name, seed);
                let share = part * scene.protocol.step_share;
                let paths = STEPS.iter();
                paths.fold(begun, |request, path| request.with_parameter(path, share))
            };
            let requests: Vec<_> = (1..=runs).map(request).collect();
            let results = campaign.run_each(&simulator, &requests)?;
            let mut records = Vec::new();
            for (seed, result) in (1..=runs).zip(results) {
                match result {
                    Ok(record) => records.push(record),
                    Err(reason) => eprintln!("{name}, {part}, seed {seed}: {reason}"),
                }
            }
            columns.push(records);
        }
        for observable in shown {
            let cells: Vec<String> = columns
                .iter()
                .map(|records| {
                    let mean = if scene.apparatus.is_release() {
                        mean_and_error(records, observable, 1)
                    } else {
                        mean_and_error_of_all(records, observable, 1)
                    };
                    if u64::try_from(records.len()) == Ok(runs) {
                        mean
                    } else {
                        format!("{mean} ({} of {runs})", records.len())
                    }
                })
                .collect();
            println!("| {name} | `{observable}` | {} |", cells.join(" | "));
        }
    }
    Ok(())
}
