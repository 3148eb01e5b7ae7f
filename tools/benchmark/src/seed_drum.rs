//! The drum of the study with more or fewer seeds, its length in proportion.

use crate::arguments::Arguments;
use crate::measure::{Row, measure_world};
use crate::scenes::{BenchmarkScene, SEEDS_OF_STUDY};
use dem_solver::{Bodies, Placement, World};
use input::quantity::Length;
use nalgebra::Vector3;
use probability::random_stream::Stream;
use scene::{
    Apparatus, FillingLibrary, Frame, SORTED_FROM, Scene, SeedBody, running_world, settled_world,
};
use std::sync::Arc;

/// Rotation after which the surface flows: the first avalanche comes after 0.7 s at 10 rpm.
const START_UP_S: f64 = 1.3;

/// Measures the drum with this many seeds.
pub(crate) fn measure(arguments: &Arguments, count: usize) -> anyhow::Result<Row> {
    let flow = Flow::prepare(arguments, count)?;
    let spheres = flow.spheres()?;
    let name = BenchmarkScene::Seeds(count);
    measure_world(
        &name.to_string(),
        &mut as_asked(flow.world()?, arguments)?,
        spheres,
        name.block_steps(),
        (arguments.blocks, arguments.phases),
    )
}

/// A drum in which the seeds flow. One of more than a drum always starts from the positions and velocities of the
/// flow.
pub(crate) fn flowing(arguments: &Arguments, count: usize) -> anyhow::Result<World> {
    Flow::prepare(arguments, count)?.world()
}

/// The same drum at the start, which has not moved yet.
pub(crate) fn start(arguments: &Arguments, count: usize) -> anyhow::Result<SeedDrum> {
    Flow::prepare(arguments, count)?.start()
}

/// The short drum after its start-up, and how often it is repeated.
struct Flow {
    scene: Scene,
    library: FillingLibrary,
    world: World,
    tiles: usize,
}

impl Flow {
    /// Lets a drum of at most 1200 seeds flow.
    fn prepare(arguments: &Arguments, count: usize) -> anyhow::Result<Self> {
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
        Ok(Self {
            scene,
            library,
            world,
            tiles: count.div_ceil(SEEDS_OF_STUDY),
        })
    }

    /// Number of spheres of all seeds.
    fn spheres(&self) -> anyhow::Result<usize> {
        let kinds = seed_bodies(&self.scene, &self.library)?;
        let kinds: Vec<_> = kinds.iter().map(|b| b.clump.spheres().len()).collect();
        Ok(self.tiles * spheres_of(&self.world, &kinds))
    }

    /// Copies of the flow beside each other.
    fn start(mut self) -> anyhow::Result<SeedDrum> {
        let spheres = self.spheres()?;
        let tile = self.scene.apparatus.width();
        set_width(&mut self.scene, tile * self.tiles as f64)?;
        Ok(SeedDrum {
            bodies: seed_bodies(&self.scene, &self.library)?,
            placements: side_by_side(self.world.bodies(), self.tiles, tile),
            spheres,
            scene: self.scene,
            library: self.library,
        })
    }

    /// The world as it has moved, or of the copies.
    fn world(self) -> anyhow::Result<World> {
        if self.tiles > 1 {
            return self.start()?.world();
        }
        Ok(self.world)
    }
}

/// The bodies of the kinds of seeds.
fn seed_bodies(scene: &Scene, library: &FillingLibrary) -> anyhow::Result<Vec<Arc<SeedBody>>> {
    let bodies = scene.seed.iter().map(|seed| library.body(scene, seed));
    Ok(bodies.collect::<Result<_, _>>()?)
}

/// A drum of seeds in motion.
pub(crate) struct SeedDrum {
    /// The drum and its contacts.
    pub(crate) scene: Scene,
    /// Bodies of the kinds of seeds.
    pub(crate) bodies: Vec<Arc<SeedBody>>,
    /// The seeds.
    pub(crate) placements: Vec<Placement>,
    /// Spheres of all seeds, those inside included.
    pub(crate) spheres: usize,
    /// Fillings that were made.
    pub(crate) library: FillingLibrary,
}

impl SeedDrum {
    /// The solver's world.
    pub(crate) fn world(&self) -> anyhow::Result<World> {
        as_in_a_run(running_world(&self.scene, &self.library, &self.placements)?)
    }

    /// The seeds as a frame.
    pub(crate) fn frame(&self) -> Frame {
        let all = &self.placements;
        Frame {
            time: 0.0,
            kind: all.iter().map(|p| p.template).collect(),
            position: all.iter().map(|p| p.position).collect(),
            orientation: all.iter().map(|p| p.orientation).collect(),
            velocity: all.iter().map(|p| p.velocity).collect(),
            spin: all.iter().map(|p| p.spin).collect(),
            walls: Vec::new(),
        }
    }
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

/// A world with its bodies in a random order in memory where that is asked for.
pub(crate) fn as_asked(mut world: World, arguments: &Arguments) -> anyhow::Result<World> {
    if arguments.unsorted {
        let mut order: Vec<usize> = (0..world.bodies().len()).collect();
        Stream::new(arguments.seed, "order in memory").shuffle(&mut order);
        world.reorder(&order)?;
    }
    Ok(world)
}

/// A world with its bodies in the order in memory that a run of a scene keeps.
pub(crate) fn as_in_a_run(mut world: World) -> anyhow::Result<World> {
    if world.bodies().len() >= SORTED_FROM {
        world.sort_bodies()?;
    }
    Ok(world)
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
