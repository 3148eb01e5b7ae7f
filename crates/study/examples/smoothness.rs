//! How rough a filling is, and what angle the drum of the study then shows with the parameters that were measured
//! at the bench: can they predict the measured angle without any calibration?
//!
//! `cargo run --release -p study --example smoothness -- FOLDER [RUNS]`
//!
//! RUNS runs (default 4) of the drum of `fixtures/cotton/study.toml` with the packed filling and with fillings whose
//! surface follows the mesh ever more closely; prints means with standard errors, the angle carried on to no
//! roughness by a line and by a parabola through the fillings that follow the mesh, with 95 % confidence, and the
//! error against the measured angle. Finished runs are kept in FOLDER and found again.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod records;

use campaign::run_store::Store;
use campaign::{Campaign, LineProgress, RunRequest};
use experiment_design::Factor;
use inference::Role;
use probability::t_two_sided_quantile;
use records::{folder_and_runs, mean_and_error};
use response_surface::{Model, Observations, fit};
use scene::Scene;
use simulators::scene_simulator::{Binding, SceneSimulator};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use study::Study;

/// Shares of the roughness taken away. At 0 the seeds are packed with separate spheres that touch the mesh from
/// inside; all others are overlapping spheres, so that the line does not see the change of method.
const SMOOTHNESS: [f64; 5] = [0.0, 0.15, 0.3, 0.45, 0.6];

/// The effect that takes it away.
const EFFECT: &str = "filling-smoothness";

/// The bench measurements: parameter, pair, least, most, mean and so on.
const BENCH: &str = include_str!("../../../fixtures/cotton/contact_measurements.csv");

/// What is compared.
const OBSERVABLE: &str = "angle_deg";

fn main() -> Result<(), Box<dyn Error>> {
    let (folder, runs) = folder_and_runs("smoothness", 4)?;
    let study = Study::read(Path::new("fixtures/cotton/study.toml"), None)?;
    let measured = study.problem.measurements.iter();
    let mut measured = measured
        .filter(|m| m.role == Role::Check && m.observable == OBSERVABLE)
        .map(|m| m.mean);
    let measured = measured.next().ok_or("the study checks no angle")?;
    let bench = bench()?;
    let drum = Scene::read(Path::new("fixtures/cotton/drum.toml"), &[])?;
    let bindings = bench
        .iter()
        .map(|(path, _)| (path.clone(), Binding::of_path(path)));
    let simulator = SceneSimulator::new(
        BTreeMap::from([("drum".to_owned(), drum)]),
        bindings.collect(),
    )?;
    let request = |smoothness: f64, seed: u64| {
        let mut request = RunRequest::new("drum", seed).with_effect(EFFECT, smoothness);
        for (path, mean) in &bench {
            request = request.with_parameter(path, *mean);
        }
        request
    };
    let store = Store::open(folder)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let campaign = Campaign::new(&store, threads, &progress);
    let of_level = |&level: &f64| (1..=runs).map(move |seed| (level, seed));
    let requests: Vec<RunRequest> = SMOOTHNESS
        .iter()
        .flat_map(of_level)
        .map(|(level, seed)| request(level, seed))
        .collect();
    let records = campaign.run_all(&simulator, &requests)?;
    println!("| smoothness | spheres a seed | roughness, um | runs | angle, deg |");
    println!("|--:|--:|--:|--:|--:|");
    let mut roughness_of_runs = Vec::new();
    let mut angles = Vec::new();
    let per_level = usize::try_from(runs)?;
    for (level, of_level) in SMOOTHNESS.iter().zip(records.chunks(per_level)) {
        let (spheres, roughness) = filling(&simulator, &request(*level, 1))?;
        let angle = mean_and_error(of_level, OBSERVABLE, 2);
        println!("| {level} | {spheres:.0} | {roughness:.0} | {runs} | {angle} |");
        if *level > 0.0 {
            let found = of_level.iter().filter_map(|r| r.observable(OBSERVABLE));
            angles.extend(found.map(|o| o.mean));
            roughness_of_runs.resize(angles.len(), roughness);
        }
    }
    println!();
    for (name, formula) in [("line", "R"), ("parabola", "R + R^2")] {
        let (angle, half_width) = at_no_roughness(formula, &roughness_of_runs, &angles)?;
        println!(
            "- A {name} to no roughness: {angle:.2} +- {half_width:.2} deg (95 %), {:+.2} deg off the measured {}.",
            angle - measured,
            measured
        );
    }
    Ok(())
}

/// Path and measured mean of restitution and static friction of each pair; the measured rolling of whole seeds is that of
/// their shape, and is not put into their spheres.
fn bench() -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let rows = BENCH
        .lines()
        .skip(1)
        .filter(|row| !row.starts_with("rolling"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let [parameter, pair, _, _, mean, ..] = cells[..] else {
            return Err(format!("too few cells in '{row}'").into());
        };
        Ok((format!("contact.{pair}.{parameter}"), mean.parse()?))
    })
    .collect()
}

/// Spheres of a seed and root mean square roughness (um) of a filling, means over the seeds of the drum.
fn filling(simulator: &SceneSimulator, request: &RunRequest) -> Result<(f64, f64), Box<dyn Error>> {
    let scene = simulator.scene_of(request)?;
    let (mut count, mut spheres, mut roughness) = (0.0, 0.0, 0.0);
    for seed in &scene.seed {
        let body = simulator.fillings().body(&scene, seed)?;
        let weight = scene.count_of(seed) as f64;
        count += weight;
        spheres += weight * body.spheres.len() as f64;
        // The seeds of the study are meshes that are filled.
        let shape = body.shape.as_ref().ok_or("a seed is not filled")?;
        roughness += weight * shape.report.roughness_rms * 1e6;
    }
    Ok((spheres / count, roughness / count))
}

/// The angle (deg) of seeds without roughness by a polynomial in it, and half its 95 % confidence interval.
fn at_no_roughness(
    formula: &str,
    roughness: &[f64],
    angles: &[f64],
) -> Result<(f64, f64), Box<dyn Error>> {
    let low = roughness.iter().copied().fold(f64::INFINITY, f64::min);
    let high = roughness.iter().copied().fold(0.0, f64::max);
    let factors = [Factor::new("R", "roughness", "um", low, high)?];
    let model = Model::parse(formula, &factors)?;
    let coded: Vec<Vec<f64>> = roughness
        .iter()
        .map(|r| vec![factors[0].coded(*r)])
        .collect();
    let fit = fit(&factors, &model, &Observations::from_runs(&coded, angles)?)?;
    let smooth = fit.coded(&[0.0]);
    let variance = fit.mse.ok_or("too few runs for a scatter")? * fit.leverage(&smooth);
    let limit = t_two_sided_quantile(0.05, fit.df_resid as f64).ok_or("too few runs")?;
    Ok((fit.value(&smooth), limit * variance.sqrt()))
}
