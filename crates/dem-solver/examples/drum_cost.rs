//! Cost of a step of the study's drum: 1200 seeds between shell and covers at 10 rpm.
//!
//! `cargo run --release -p dem-solver --example drum_cost -- [TIME_STEP_S] [SECONDS] [SKIN_M] [MARGIN_M]`
//!
//! The seed is a plain lattice filling of an ellipsoid, so that this example needs no mesh.

#![expect(clippy::print_stdout, reason = "the figures are the purpose")]

use clump::{Clump, MassProperties, Sphere};
use contact_law::{Material, NormalForceEnd, PairParameters};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, Placement, Settings, Shape, Template, Wall,
    World,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use random_stream::Stream;

const HALF_AXES: [f64; 3] = [4.595e-3, 2.54e-3, 2.225e-3];
const MASS: f64 = 94.5e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |default: f64| arguments.next().map_or(Ok(default), |a| a.parse::<f64>());
    let (time_step, seconds) = (next(8e-5)?, next(1.0)?);
    let (skin, margin) = (next(0.2e-3)?, next(2e-3)?);
    let mut world = drum(time_step, skin, margin)?;
    run(&mut world, 0.4, "fall")?;
    let spin = 10.0 / 60.0 * std::f64::consts::TAU;
    world.set_wall_spin("shell", spin);
    world.set_wall_spin("cover", spin);
    run(&mut world, 1.5, "start")?;
    let (steps, start) = (world.n_steps(), processor_seconds()?);
    let before = world.census();
    let mut blocks = Vec::new();
    let end = world.time() + seconds;
    while world.time() < end {
        let start = processor_seconds()?;
        for _ in 0..200 {
            world.step()?;
        }
        blocks.push((processor_seconds()? - start) / 200.0 * 1e6);
    }
    blocks.sort_unstable_by(f64::total_cmp);
    run(&mut world, 0.0, "steady")?;
    println!(
        "fastest tenth of blocks: {:.0} us/step, median {:.0}",
        blocks[blocks.len() / 10],
        blocks[blocks.len() / 2]
    );
    let n = (world.n_steps() - steps) as f64;
    let elapsed = processor_seconds()? - start;
    let census = world.census();
    println!("{census:?} wall contacts {}", world.n_wall_contacts());
    println!(
        "{:.0} us/step, {:.2} CPU-s per drum second, {:.1} rebuilds and {:.1} checks a step",
        elapsed / n * 1e6,
        elapsed / seconds,
        (census.rebuilds - before.rebuilds) as f64 / n,
        (census.checks - before.checks) as f64 / n,
    );
    Ok(())
}

/// Time that this process has had a processor, s: other work on the machine does not count.
fn processor_seconds() -> Result<f64, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string("/proc/self/schedstat")?;
    let nanoseconds: f64 = text.split(' ').next().unwrap_or_default().parse()?;
    Ok(nanoseconds * 1e-9)
}

fn run(world: &mut World, seconds: f64, what: &str) -> Result<(), dem_solver::Error> {
    let end = world.time() + seconds;
    while world.time() < end {
        world.step()?;
    }
    let mut moment = Vector3::zeros();
    for p in &world.bodies().position {
        moment += p;
    }
    println!(
        "{what}: centre of mass at {:.2} deg from straight down, kinetic energy {:.17e} J",
        moment.x.atan2(-moment.y).to_degrees(),
        world.kinetic_energy()
    );
    Ok(())
}

fn drum(time_step: f64, skin: f64, margin: f64) -> Result<World, Box<dyn std::error::Error>> {
    let (radius, width) = (0.070, 0.046);
    let seed = Material::new(0.14, 4.01e6)?;
    let resin = Material::new(0.42, 1.04e9)?;
    let interaction = |a, b, restitution, static_friction| {
        Interaction::new(&InteractionSettings {
            materials: [a, b],
            parameters: PairParameters {
                restitution,
                static_friction,
                rolling_friction: 0.0,
            },
            attraction: 0.0,
            end: NormalForceEnd::Clipped,
        })
    };
    let (own, shell) = (
        interaction(seed, seed, 0.06, 0.10)?,
        interaction(seed, resin, 0.13, 0.33)?,
    );
    let cover = interaction(seed, resin, 0.12, 0.29)?;
    let interactions = vec![own, shell, cover, shell, shell, shell, cover, cover, cover];
    let plane = |sign: f64| Wall {
        name: "cover".into(),
        shape: Shape::Plane {
            point: Vector3::new(0.0, 0.0, sign * width / 2.0),
            normal: Vector3::new(0.0, 0.0, -sign),
        },
        material: 2,
        spin: 0.0,
    };
    let shell = Wall {
        name: "shell".into(),
        shape: Shape::Cylinder { radius },
        material: 1,
        spin: 0.0,
    };
    let placements = lattice(radius, width);
    println!(
        "{} seeds of {} spheres",
        placements.len(),
        filling()?.spheres().len()
    );
    let template = Template::new(&filling()?, 0, DashpotMass::Sphere);
    println!("{} spheres reachable", template.n_outer_spheres());
    let settings = Settings {
        time_step,
        gravity: Vector3::new(0.0, -9.81, 0.0),
        skin,
        margin,
    };
    let walls = vec![shell, plane(1.0), plane(-1.0)];
    Ok(World::new(
        settings,
        vec![template],
        interactions,
        walls,
        &placements,
    )?)
}

/// Starts of 1200 seeds in layers from the bottom, long axes along x, turned at random about them.
fn lattice(radius: f64, width: f64) -> Vec<Placement> {
    let mut stream = Stream::new(1, "placement");
    let spacing = HALF_AXES.map(|a| 2.02 * a.max(HALF_AXES[1]));
    let halves = [radius, radius, 0.5 * width - HALF_AXES[1]];
    let mut placements = Vec::new();
    let steps = |axis: usize| {
        let n = (halves[axis] / spacing[axis]).floor();
        (0..)
            .map(f64::from)
            .map(move |k| k - n)
            .take_while(move |k| *k <= n)
    };
    for y in steps(1) {
        for x in steps(0) {
            for z in steps(2) {
                let position = Vector3::new(x * spacing[0], y * spacing[1], z * spacing[2]);
                if position.xy().norm() < radius - HALF_AXES[0] && placements.len() < 1200 {
                    let angle = stream.between(0.0, std::f64::consts::TAU);
                    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
                    placements.push(Placement::at_rest(0, position, turn));
                }
            }
        }
    }
    placements
}

/// Hexagonal lattice of touching spheres inside an ellipsoid.
fn filling() -> Result<Clump, clump::Error> {
    let r = 0.45e-3;
    let mut spheres = Vec::new();
    for k in -8..=8 {
        for j in -8..=8 {
            for i in -12..=12 {
                let (i, j, k) = (f64::from(i), f64::from(j), f64::from(k));
                let odd = k.rem_euclid(2.0);
                let centre = Vector3::new(
                    2.0 * i + (j + odd).rem_euclid(2.0),
                    3.0_f64.sqrt() * (j + odd / 3.0),
                    (8.0_f64 / 3.0).sqrt() * k,
                ) * r;
                let inside = (0..3)
                    .map(|a| (centre[a] / (HALF_AXES[a] - r)).powi(2))
                    .sum::<f64>();
                if inside <= 1.0 {
                    spheres.push(Sphere { centre, radius: r });
                }
            }
        }
    }
    let square = HALF_AXES.map(|a| a * a);
    let total: f64 = square.iter().sum();
    let inertia =
        Matrix3::from_diagonal(&Vector3::from_fn(|a, _| 0.2 * MASS * (total - square[a])));
    Clump::new(
        &spheres,
        &MassProperties {
            mass: MASS,
            centre: Vector3::zeros(),
            inertia,
        },
    )
}
