//! From a scene to the solver's world: bodies, walls, interactions, time step.

use crate::apparatus::NamedMesh;
use crate::bonded::{BondedSeeds, Parts};
use crate::factory::Factory;
use crate::health::limits;
use crate::interactions::interactions;
use crate::obstacles::mesh_walls;
use crate::periodic_sides;
use crate::placement::{Room, place};
use crate::surroundings::Surroundings;
use crate::time_step::TimeSteps;
use crate::{Error, FillingLibrary, Scene, SeedBody};
use dem_solver::{HealthLimits, MeshWall, Motion, Placement, Settings, Template, Wall, World};
use geometry::clump::{Clump, volume_of_sphere};
use std::sync::Arc;

/// A world with what belongs to it.
#[derive(Debug, Clone)]
pub(crate) struct Built {
    pub(crate) world: World,
    /// The bodies of the seeds, by kind.
    pub(crate) bodies: Vec<Arc<SeedBody>>,
    /// Walls of triangles with their motion.
    pub(crate) meshes: Vec<NamedMesh>,
    /// Forces on the seeds besides gravity and contacts.
    pub(crate) surroundings: Option<Surroundings>,
    /// What a believable world keeps to.
    pub(crate) limits: HealthLimits,
    /// Time steps of its phases.
    pub(crate) time_steps: TimeSteps,
    /// What makes the seeds; `None` if all are there from the start.
    pub(crate) factory: Option<Factory>,
    /// What holds the spheres of the seeds together; `None` if the seeds are rigid.
    pub(crate) bonds: Option<BondedSeeds>,
    /// Numbers of the seeds by their places in the world, once it was sorted; empty if each has its own.
    pub(crate) numbers: Vec<usize>,
}

/// Fewest bodies for each thread of a run: with fewer the threads wait for each other.
const BODIES_OF_THREAD: usize = 500;

impl Built {
    /// Spreads the steps from now on over at most so many threads.
    pub(crate) fn set_threads(&mut self, scene: &Scene, most: usize) -> Result<(), Error> {
        // A factory makes the seeds later; a bonded seed is many bodies.
        let seeds = scene.seed_count();
        let bodies = seeds.max(self.world.bodies().len());
        let threads = most.min(bodies / BODIES_OF_THREAD).max(1);
        if threads != self.world.n_threads() {
            self.world.set_threads(threads)?;
        }
        Ok(())
    }
}

/// Builds the world with the seeds in their starting places, or without seeds where a factory makes them,
/// and the drive at rest.
pub(crate) fn build(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<Built, Error> {
    scene.require_bed()?;
    let Some(factory) = Factory::of(scene, seed) else {
        return build_filled(scene, library, seed);
    };
    let bodies = seed_bodies(scene, library)?;
    let built = assemble(scene, bodies, mesh_walls(scene)?, &[])?;
    Ok(Built {
        factory: Some(factory),
        ..built
    })
}

/// Builds the world with all seeds in their starting places and the drive at rest.
pub(crate) fn build_filled(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
) -> Result<Built, Error> {
    scene.require_bed()?;
    let bodies = seed_bodies(scene, library)?;
    let meshes = mesh_walls(scene)?;
    let kinds: Vec<_> = bodies
        .iter()
        .zip(&scene.seed)
        .map(|(b, s)| (&b.clump, scene.count_of(s)))
        .collect();
    let obstacles: Vec<_> = meshes.iter().flat_map(|m| m.triangles.clone()).collect();
    let room = Room {
        apparatus: &scene.apparatus,
        obstacles: &obstacles,
    };
    let placements = place(room, &kinds, seed)?;
    assemble(scene, bodies, meshes, &placements)
}

/// Puts seeds in given places into the apparatus at rest.
pub(crate) fn assemble(
    scene: &Scene,
    bodies: Vec<Arc<SeedBody>>,
    meshes: Vec<NamedMesh>,
    placements: &[Placement],
) -> Result<Built, Error> {
    let check = scene.apparatus.device().check_seeds(scene, &bodies);
    check.map_err(|error| error.in_file(&scene.file))?;
    let mut time_steps = TimeSteps::of(scene, &bodies)?;
    let names = material_names(scene, &meshes);
    let settings = scene.model.bonds.as_ref();
    let parts = settings.map(|bonds| Parts::of(scene, bonds, &bodies, placements));
    let parts = parts
        .transpose()
        .map_err(|error| error.in_file(&scene.file))?;
    let templates = match &parts {
        None => whole_seeds(scene, &bodies, &names),
        Some(_) => single_spheres(scene, &bodies, &names)?,
    };
    let starts = parts.as_ref().map_or(placements, |p| &p.placements);
    let step = time_steps.settling;
    let mut world = empty_drive(scene, &bodies, &names, templates, starts, step)?;
    if let Some(sides) = scene.apparatus.device().periodic_sides() {
        let closed = periodic_sides::between(world, &sides, scene, &meshes);
        world = closed.map_err(|error| error.in_file(&scene.file))?;
    }
    for mesh in &meshes {
        let about = mesh.motion.about;
        world.add_mesh_wall(MeshWall {
            name: mesh.name.clone(),
            triangles: mesh.triangles.clone(),
            material: index_of(&names, &mesh.material),
            motion: Motion {
                about,
                ..Motion::default()
            },
        })?;
    }
    let bonds = match (parts, settings) {
        (Some(parts), Some(settings)) => {
            let (bonds, longest) = parts.bond((settings, &scene.file), &world)?;
            time_steps = time_steps.at_most(scene, longest)?;
            world.set_time_step(time_steps.settling)?;
            Some(bonds)
        }
        _ => None,
    };
    let limits = limits(scene, &bodies);
    let surroundings = Surroundings::of(scene, &bodies);
    Ok(Built {
        world,
        bodies,
        meshes,
        surroundings,
        limits,
        time_steps,
        factory: None,
        bonds,
        numbers: Vec::new(),
    })
}

/// The seeds as body types, one a kind.
fn whole_seeds(scene: &Scene, bodies: &[Arc<SeedBody>], names: &[&str]) -> Vec<Template> {
    let kinds = scene.seed.iter().zip(bodies);
    let templates = kinds.map(|(s, b)| {
        let material = index_of(names, &s.material);
        let template = scene.model.template(&b.clump, material);
        template.with_liquid(content(scene) * volume_of_sphere(b.volume_radius()))
    });
    templates.collect()
}

/// Volume of liquid over that of the seeds.
fn content(scene: &Scene) -> f64 {
    scene.model.liquid.map_or(0.0, |liquid| liquid.content)
}

/// Bodies of the seeds, by kind.
pub(crate) fn seed_bodies(
    scene: &Scene,
    library: &FillingLibrary,
) -> Result<Vec<Arc<SeedBody>>, Error> {
    let kinds = scene.seed.iter();
    kinds.map(|s| library.body(scene, s)).collect()
}

/// Names of all materials that take part, in alphabetical order.
fn material_names<'a>(scene: &'a Scene, meshes: &'a [NamedMesh]) -> Vec<&'a str> {
    let seeds = scene.seed.iter().map(|s| s.material.as_str());
    let walls = scene.wall_materials();
    let meshes = meshes.iter().map(|m| m.material.as_str());
    let mut names: Vec<&str> = seeds.chain(walls).chain(meshes).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Place of a name in a list.
fn index_of(names: &[&str], name: &str) -> usize {
    names.iter().position(|n| *n == name).unwrap_or(0)
}

/// The spheres of the seeds as body types: those of each kind in order, behind those of the kinds before.
///
/// # Errors
///
/// A sphere that cannot be a body.
fn single_spheres(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: &[&str],
) -> Result<Vec<Template>, Error> {
    let mut templates = Vec::new();
    for (seed, body) in scene.seed.iter().zip(bodies) {
        for (k, sphere) in body.clump.spheres().iter().enumerate() {
            let density = body.clump.fraction_mass(k) / volume_of_sphere(sphere.radius);
            let single = Clump::sphere(sphere.radius, density).map_err(|source| Error::Body {
                seed: seed.name.clone(),
                source,
            })?;
            let material = index_of(names, &seed.material);
            let template = scene.model.template(&single, material);
            templates.push(template.with_liquid(content(scene) * volume_of_sphere(sphere.radius)));
        }
    }
    Ok(templates)
}

/// The world without its walls of triangles.
fn empty_drive(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: &[&str],
    templates: Vec<Template>,
    placements: &[Placement],
    time_step: f64,
) -> Result<World, Error> {
    let walls = scene.apparatus.device().walls();
    let still = walls.iter().map(|w| Wall {
        name: w.name.clone(),
        shape: w.shape,
        material: index_of(names, &w.material),
        spin: 0.0,
    });
    let gravity = scene.apparatus.device().gravity(scene.model.gravity_m_s2);
    let settings = Settings::for_templates(time_step, gravity, &templates);
    let interactions = interactions(scene, bodies, names)?;
    Ok(World::new(
        settings,
        templates,
        interactions,
        still.collect(),
        placements,
    )?)
}
