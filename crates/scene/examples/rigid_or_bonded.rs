//! Rigid agglomerates against bonded ones in a slice of the study's drum: the angle of the bed, and the
//! cost.
//!
//! `cargo run --release -p scene --example rigid_or_bonded -- [SECONDS] [RUNS]` turns a drum of 70 mm with 70 coarse
//! seeds (20 and 16 spheres of 0.8 mm) for SECONDS (default 2), RUNS times (default 3, other places of the seeds
//! each time), with rigid seeds and with bonds of two stiffnesses, two runs at a time, and prints a Markdown table.
//! The angle is the direction of the centre of mass over the second half; its standard error comes from the runs.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

use scene::{BondedSettings, FillingLibrary, Override, Scene, run};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// A result that can cross threads.
type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Stiffness of the bonds per area, N/m³: shear two fifths of it.
const STIFFNESSES: [f64; 2] = [1e8, 1e9];

/// The slice.
fn drum(seconds: f64) -> Outcome<Scene> {
    let seconds = format!("{seconds} s");
    let changes = [
        ("apparatus.inner_diameter", "70 mm"),
        ("apparatus.width", "14 mm"),
        ("seed.0.count", "62"),
        ("seed.1.count", "8"),
        ("seed.0.filling.sphere_radius", "0.8 mm"),
        ("seed.0.filling.sphere_count", "20"),
        ("seed.1.filling.sphere_radius", "0.8 mm"),
        ("seed.1.filling.sphere_count", "16"),
        ("protocol.rotation_limit", &seconds),
        // More than there will be: the run ends with its time.
        ("protocol.frames", "1000"),
    ];
    let changes = changes.map(|(name, value)| Override {
        name: name.into(),
        value: value.into(),
    });
    Ok(Scene::read(
        Path::new("fixtures/cotton/drum.toml"),
        &changes,
    )?)
}

/// Bonds that take the place of the touch of packed spheres.
fn bonds(stiffness: f64) -> Outcome<BondedSettings> {
    Ok(BondedSettings {
        normal_stiffness_n_m3: stiffness,
        shear_stiffness_n_m3: 0.4 * stiffness,
        radius: "0.8 mm".parse()?,
        largest_gap: "0.25 mm".parse()?,
        damping_ratio: 0.3,
        strength: None,
    })
}

/// What one run gives.
struct Turned {
    /// Direction of the centre of mass over the second half, deg.
    angle: f64,
    /// Time step, s.
    step: f64,
    /// Time of the run over the time simulated, settling included.
    cost: f64,
}

/// Runs a scene once.
fn turn(scene: &Scene, library: &FillingLibrary, seed: u64) -> Outcome<Turned> {
    let begin = Instant::now();
    let result = run(scene, library, seed)?;
    let late = &result.series[result.series.len() / 2..];
    let sum: f64 = late.iter().map(|p| p.centre_of_mass_deg).sum();
    Ok(Turned {
        angle: sum / late.len() as f64,
        step: result.time_step,
        cost: begin.elapsed().as_secs_f64() / (result.n_steps as f64 * result.time_step),
    })
}

/// Runs a scene with each seed, two at a time.
fn all(scene: &Scene, library: &FillingLibrary, runs: u64) -> Outcome<Vec<Turned>> {
    let mut turned = Vec::new();
    for first in (1..=runs).step_by(2) {
        let seeds = first..=runs.min(first + 1);
        let pair = std::thread::scope(|scope| {
            let started: Vec<_> = seeds
                .map(|seed| scope.spawn(move || turn(scene, library, seed)))
                .collect();
            started
                .into_iter()
                .map(std::thread::ScopedJoinHandle::join)
                .collect::<Vec<_>>()
        });
        for one in pair {
            turned.push(one.map_err(|_| "a run stopped")??);
        }
    }
    Ok(turned)
}

fn main() -> Outcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let seconds = words.first().map_or(Ok(2.0), |text| text.parse())?;
    let runs = words.get(1).map_or(Ok(3), |text| text.parse())?;
    let library = FillingLibrary::default();
    let rigid = drum(seconds)?;
    let mut rows = vec![("rigid".to_owned(), rigid.clone())];
    for stiffness in STIFFNESSES {
        let mut bonded = rigid.clone();
        bonded.model.bonds = Some(bonds(stiffness)?);
        rows.push((format!("bonded, {stiffness:.0e} N/m3"), bonded));
    }
    println!("| model | time step, us | centre of mass, deg | s of one core per simulated s |");
    println!("|---|--:|--:|--:|");
    for (name, scene) in rows {
        let turned = all(&scene, &library, runs)?;
        let n = turned.len() as f64;
        let mean = turned.iter().map(|t| t.angle).sum::<f64>() / n;
        let square: f64 = turned.iter().map(|t| (t.angle - mean).powi(2)).sum();
        let error = (square / (n - 1.0) / n).sqrt();
        let cost = turned.iter().map(|t| t.cost).sum::<f64>() / n;
        println!(
            "| {name} | {:.2} | {mean:.2} +- {error:.2} | {cost:.1} |",
            1e6 * turned[0].step
        );
    }
    Ok(())
}
