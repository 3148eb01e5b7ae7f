//! How many pairs of spheres are nearly in touch in a bed of a filling: a small drum of it, turned for a moment.

use anyhow::Context as _;
use clump::Clump;
use contact_law::Material;
use contact_law::hertz_mindlin::{NormalForceEnd, PairParameters};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, Placement, Settings, Shape, Template, Wall,
    World,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use random_stream::Stream;

/// Seeds along each side of the block that falls into the drum.
const SIDE: usize = 4;
/// Their distance, sizes of a seed (the diameter of the sphere round it).
const APART: f64 = 1.02;
/// Inner radius and width of the drum, sizes of a seed.
const DRUM: [f64; 2] = [3.8, 4.2];
/// Turning, rad/s: 10 rpm.
const SPIN: f64 = 1.047;
/// Time in which the seeds fall and begin to move, and in which they are counted, s.
const TIMES: [f64; 2] = [0.25, 0.1];
/// Counts in that time.
const COUNTS: usize = 20;

/// Groups of eight pairs of spheres within the skin that a seed of a bed has on average: a small drum of such seeds turns with a time
/// step, s. Materials of the seed and of the walls.
///
/// # Errors
///
/// What the solver refuses.
pub(crate) fn near_groups(
    seed: &Clump,
    materials: [Material; 2],
    time_step: f64,
) -> anyhow::Result<f64> {
    let template = Template::new(seed, 0, DashpotMass::Sphere);
    let size = 2.0 * template.bounding_radius();
    let templates = vec![template];
    let gravity = Vector3::new(0.0, -9.81, 0.0);
    let settings = Settings::for_templates(time_step, gravity, &templates);
    let [seed_material, wall_material] = materials;
    let between = |other| {
        Interaction::new(&InteractionSettings {
            materials: [seed_material, other],
            parameters: PairParameters {
                restitution: 0.1,
                static_friction: 0.3,
                rolling_friction: 0.0,
            },
            attraction: 0.0,
            end: NormalForceEnd::Clipped,
        })
    };
    let (same, wall) = (between(seed_material)?, between(wall_material)?);
    let interactions = vec![same, wall, wall, wall];
    let mut world = World::new(settings, templates, interactions, walls(size), &block(size))?;
    run(&mut world, TIMES[0])?;
    let mut groups = 0;
    for _ in 0..COUNTS {
        run(&mut world, TIMES[1] / COUNTS as f64)?;
        groups += world.census().chunks;
    }
    Ok(groups as f64 / (COUNTS * SIDE.pow(3)) as f64)
}

/// Moves a world by a time, s.
fn run(world: &mut World, seconds: f64) -> anyhow::Result<()> {
    let end = world.time() + seconds;
    while world.time() < end {
        world
            .step()
            .context("a bed of this filling, from which its cost is told")?;
    }
    Ok(())
}

/// The drum for seeds of a size, m.
fn walls(size: f64) -> Vec<Wall> {
    let half = 0.5 * DRUM[1] * size;
    let cover = |sign: f64| Wall {
        name: "cover".into(),
        shape: Shape::Plane {
            point: Vector3::new(0.0, 0.0, sign * half),
            normal: Vector3::new(0.0, 0.0, -sign),
        },
        material: 1,
        spin: 0.0,
    };
    let shell = Wall {
        name: "shell".into(),
        shape: Shape::Cylinder {
            radius: DRUM[0] * size,
        },
        material: 1,
        spin: SPIN,
    };
    vec![shell, cover(1.0), cover(-1.0)]
}

/// Seeds of a size (m) in a block about the axis, each turned at random.
fn block(size: f64) -> Vec<Placement> {
    let mut random = Stream::new(1, "trial bed");
    let at = |k: usize| (k as f64 - 0.5 * (SIDE - 1) as f64) * APART * size;
    let mut placements = Vec::new();
    for x in 0..SIDE {
        for y in 0..SIDE {
            for z in 0..SIDE {
                let [i, j, k, w] = random.rotation();
                let turned = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
                let place = Vector3::new(at(x), at(y), at(z));
                placements.push(Placement::at_rest(0, place, turned));
            }
        }
    }
    placements
}
