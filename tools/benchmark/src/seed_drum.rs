//! The drum of the study with more or fewer seeds, its length in proportion.

use crate::arguments::Arguments;
use crate::measure::{Row, measure_world};
use crate::scenes::{BenchmarkScene, SEEDS_OF_STUDY};
use dem_solver::{Bodies, Placement, World};
use nalgebra::Vector3;
use quantity::Length;
use scene::{Apparatus, FillingLibrary, Scene, running_world, settled_world};

/// Rotation after which the surface flows: the first avalanche comes after 0.7 s at 10 rpm.
const START_UP_S: f64 = 1.3;

/// Measures the drum with this many seeds.
pub(crate) fn measure(arguments: &Arguments, count: usize) -> anyhow::Result<Row> {
    let (mut world, spheres) = flowing(arguments, count, false)?;
    let name = BenchmarkScene::Seeds(count);
    measure_world(
        &name.to_string(),
        &mut world,
        spheres,
        name.block_steps(),
        arguments.blocks,
    )
}

/// A drum in which the seeds flow, and its number of spheres. A `fresh` world starts from the
/// positions and velocities of the flow and has not moved yet; one of more than a drum always does.
pub(crate) fn flowing(
    arguments: &Arguments,
    count: usize,
    fresh: bool,
) -> anyhow::Result<(World, usize)> {
    let library = FillingLibrary::default();
    let mut scene = Scene::read(&arguments.drum, &[])?;
    let study = scene.apparatus.width();
    scene.set_seed_count(count.min(SEEDS_OF_STUDY));
    let tile = study * scene.seed_count() as f64 / SEEDS_OF_STUDY as f64;
    set_width(&mut scene, tile)?;
    let mut world = settled_world(&scene, &library, arguments.seed)?;
    let end = world.time() + START_UP_S;
    while world.time() < end {
        world.step()?;
    }
    let tiles = count.div_ceil(SEEDS_OF_STUDY);
    if fresh || tiles > 1 {
        set_width(&mut scene, tile * tiles as f64)?;
        let placements = side_by_side(world.bodies(), tiles, tile);
        world = running_world(&scene, &library, &placements)?;
    }
    let kinds = scene
        .seed
        .iter()
        .map(|seed| Ok(library.body(&scene, seed)?.clump.spheres().len()))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let spheres = spheres_of(&world, &kinds);
    Ok((world, spheres))
}

/// Number of spheres of all bodies; `kinds` holds the number of each kind.
fn spheres_of(world: &World, kinds: &[usize]) -> usize {
    world
        .bodies()
        .template
        .iter()
        .map(|&kind| kinds[kind])
        .sum()
}

/// Sets the length of the drum, m.
fn set_width(scene: &mut Scene, width: f64) -> anyhow::Result<()> {
    let Apparatus::Drum(drum) = &mut scene.apparatus else {
        anyhow::bail!("{}: the benchmark needs a drum", scene.file);
    };
    drum.width = Length::from_si(width)?;
    Ok(())
}

/// Copies of a moving bed beside each other along the axis, each `width` (m) long.
pub(crate) fn side_by_side(bodies: &Bodies, tiles: usize, width: f64) -> Vec<Placement> {
    let first = -0.5 * width * (tiles as f64 - 1.0);
    let shifts = (0..tiles).map(|tile| Vector3::z() * (first + width * tile as f64));
    shifts
        .flat_map(|shift| {
            (0..bodies.len()).map(move |i| Placement {
                template: bodies.template[i],
                position: bodies.position[i] + shift,
                orientation: bodies.orientation[i],
                velocity: bodies.velocity[i],
                spin: bodies.spin[i],
            })
        })
        .collect()
}
