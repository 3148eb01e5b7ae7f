//! Rigid agglomerates against bonded ones in a slice of the study's drum: the angle of the bed, and the
//! cost.
//!
//! `cargo run --release -p scene --example rigid_or_bonded -- [SECONDS]` lets 70 coarse seeds (20 and 16
//! spheres of 0.8 mm) settle in a drum of 70 mm, takes the bed over into both models, turns each for SECONDS
//! (default 2) and prints a Markdown table. The angle is the direction of the centre of mass over the second
//! half, with a standard error from blocks of 0.2 s.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

use bonded_body::{Bonds, agglomerate};
use contact_law::bond::{Bond, BondSettings};
use dem_solver::{Placement, World};
use nalgebra::Vector3;
use scene::{FillingLibrary, Override, Scene, running_world, settled_world, world_of_spheres};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// A result that can cross threads.
type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Stiffness of the bonds per area, N/m³: shear two fifths of it.
const STIFFNESSES: [f64; 2] = [3e8, 3e9];
/// Largest gap of spheres that are bonded, m: bonds take the place of the touch of packed spheres.
const GAP: f64 = 0.25e-3;
/// Radius of the bonds, m.
const BOND_RADIUS: f64 = 0.8e-3;
/// Bonds that a sphere has at most, for the time step.
const MOST_BONDS: usize = 10;
/// Time between two values of the angle, s.
const INTERVAL: f64 = 0.02;
/// Values in a block.
const BLOCK: usize = 10;

/// The slice.
fn drum() -> Outcome<Scene> {
    let changes = [
        ("apparatus.inner_diameter", "70 mm"),
        ("apparatus.width", "14 mm"),
        ("seed.0.count", "62"),
        ("seed.1.count", "8"),
        ("seed.0.filling.sphere_radius", "0.8 mm"),
        ("seed.0.filling.sphere_count", "20"),
        ("seed.1.filling.sphere_radius", "0.8 mm"),
        ("seed.1.filling.sphere_count", "16"),
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

/// Direction of the centre of mass from straight down, deg.
fn direction(world: &World) -> f64 {
    let bodies = world.bodies();
    let mut moment = Vector3::zeros();
    for (position, &template) in bodies.position.iter().zip(&bodies.template) {
        moment += position * world.templates()[template].mass();
    }
    moment.x.atan2(-moment.y).to_degrees()
}

/// Mean of the second half and its standard error, deg.
fn mean(series: &[f64]) -> (f64, f64) {
    let late = &series[series.len() / 2..];
    let blocks: Vec<f64> = late
        .chunks_exact(BLOCK)
        .map(|block| block.iter().sum::<f64>() / BLOCK as f64)
        .collect();
    let n = blocks.len() as f64;
    let mean = blocks.iter().sum::<f64>() / n;
    let square: f64 = blocks.iter().map(|b| (b - mean).powi(2)).sum();
    (mean, (square / (n - 1.0) / n).sqrt())
}

/// Turns a world for a time (s) by steps of its own; a row of the table.
fn row(
    name: &str,
    world: &mut World,
    seconds: f64,
    mut step: impl FnMut(&mut World) -> Outcome<()>,
) -> Outcome<String> {
    let begin = Instant::now();
    let (start, mut series) = (world.time(), Vec::new());
    while world.time() - start < seconds {
        let end = world.time() + INTERVAL;
        while world.time() < end {
            step(world)?;
        }
        series.push(direction(world));
    }
    let cost = begin.elapsed().as_secs_f64() / seconds;
    let (angle, error) = mean(&series);
    Ok(format!(
        "| {name} | {:.2} | {angle:.2} +- {error:.2} | {cost:.1} |",
        world.settings().time_step * 1e6
    ))
}

/// Bonded agglomerates in the places of the rigid ones.
fn bonded(
    scene: &Scene,
    library: &FillingLibrary,
    starts: &[Placement],
    stiffness: f64,
    seconds: f64,
) -> Outcome<String> {
    let kinds = scene
        .seed
        .iter()
        .map(|seed| library.body(scene, seed))
        .collect::<Result<Vec<_>, _>>()?;
    let first = [0, kinds[0].clump.spheres().len()];
    let (mut placements, mut pairs) = (Vec::new(), Vec::new());
    for start in starts {
        let clump = &kinds[start.template].clump;
        let parts = agglomerate(clump, start, first[start.template], placements.len(), GAP)?;
        placements.extend(parts.placements);
        pairs.extend(parts.pairs);
    }
    let law = Bond::new(&BondSettings {
        normal_stiffness: stiffness,
        shear_stiffness: 0.4 * stiffness,
        radius: BOND_RADIUS,
        damping_ratio: 0.3,
        strength: None,
    })?;
    let coarse = world_of_spheres(scene, library, &placements, 1e-6)?;
    let step = Bonds::new(&coarse, &pairs, law)?.longest_time_step(MOST_BONDS);
    let mut world = world_of_spheres(scene, library, &placements, step)?;
    let mut bonds = Bonds::new(&world, &pairs, law)?;
    let name = format!("bonded, {stiffness:.0e} N/m3");
    row(&name, &mut world, seconds, |world| Ok(bonds.step(world)?))
}

fn main() -> Outcome<()> {
    let seconds = std::env::args()
        .nth(1)
        .map_or(Ok(2.0), |text| text.parse())?;
    let (scene, library) = (drum()?, FillingLibrary::default());
    let settled = settled_world(&scene, &library, 1)?;
    let bodies = settled.bodies();
    let starts: Vec<Placement> = (0..bodies.len())
        .map(|k| Placement {
            template: bodies.template[k],
            position: bodies.position[k],
            orientation: bodies.orientation[k],
            velocity: bodies.velocity[k],
            spin: bodies.spin[k],
        })
        .collect();
    println!("| model | time step, us | centre of mass, deg | s of one core per simulated s |");
    println!("|---|--:|--:|--:|");
    let mut world = running_world(&scene, &library, &starts)?;
    println!(
        "{}",
        row("rigid", &mut world, seconds, |world| Ok(world.step()?))?
    );
    let rows = std::thread::scope(|scope| {
        let runs = STIFFNESSES.map(|stiffness| {
            let (scene, library, starts) = (&scene, &library, &starts);
            scope.spawn(move || bonded(scene, library, starts, stiffness, seconds))
        });
        runs.map(std::thread::ScopedJoinHandle::join)
    });
    for row in rows {
        println!("{}", row.map_err(|_| "a run stopped")??);
    }
    Ok(())
}
