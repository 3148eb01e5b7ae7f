//! One run: fill, settle, rotate until steady, take frames, measure.

use crate::apparatus::{Apparatus, NamedMesh};
use crate::flow::{avalanche_period, fill_level, flowing_layer};
use crate::health::limits;
use crate::obstacles::mesh_walls;
use crate::placement::place;
use crate::steady::{Truncation, marginal_standard_error_rule};
use crate::surroundings::Surroundings;
use crate::{Error, FillingLibrary, Frame, FrameReading, Scene, SeedBody, read_frame};
use contact_law::material::effective_moduli;
use contact_law::{Material, PairParameters, constant_attraction, hard_contact};
use dem_solver::{
    Census, HealthLimits, Interaction, InteractionSettings, MeshWall, Motion, Placement, Settings,
    Template, Wall, World,
};
use nalgebra::{Rotation3, Vector3};
use quantity::Angle;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Time between the values of the series that decide whether the run is steady, s.
pub(crate) const SERIES_INTERVAL: f64 = 0.02;
/// Values in one batch of the rule that finds the end of the start-up.
const BATCH: usize = 5;
/// Kinetic energy of a seed at rest over the energy of a fall by its own size.
const AT_REST: f64 = 1e-4;
/// Share of the shell's speed that the bed must keep to count as rolling; below, it slides.
const SLIDING_BELOW: f64 = 0.5;
/// Gap that ends the group of seeds at the rim of the metering device, in seed lengths.
const GROUP_GAP: f64 = 1.5;

/// Seeds at the shell count for the slip within this angle of the centre of mass, rad.
const MIDDLE_OF_BED: f64 = PI / 6.0;

/// How the bed moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Regime {
    /// The bed turns with the shell and a layer flows over it.
    Rolling,
    /// The bed slides on the shell.
    Sliding,
    /// The seeds were let go and came to rest, or were to.
    Resting,
}

/// State of the bed at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// Time since the drive started, s.
    pub time_s: f64,
    /// Direction of the centre of mass from straight down, counter-clockwise positive, deg.
    pub centre_of_mass_deg: f64,
    /// 1 minus the speed of the seeds at the shell over the speed of the shell, within 30 deg of
    /// the centre of mass: at the edges of the bed seeds come to rest or turn back.
    pub shell_slip: f64,
    /// Power of the moving walls on the seeds, W. Over a time in which the bed is steady, its
    /// mean is what friction and dashpots take.
    pub drive_power_w: f64,
    /// Kinetic energy of all seeds, J.
    pub kinetic_energy_j: f64,
}

/// A further observable: values whose mean counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Further {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Values.
    pub values: Vec<f64>,
}

impl Further {
    /// Names some values.
    pub(crate) fn new(name: &'static str, unit: &'static str, values: Vec<f64>) -> Self {
        Self { name, unit, values }
    }
}

/// What a run gives.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// The bed over time.
    pub series: Vec<SeriesPoint>,
    /// Where the start-up ends.
    pub truncation: Option<Truncation>,
    /// Frames in the steady state, at least one correlation time apart.
    pub frames: Vec<Frame>,
    /// Reading of each frame; none for the metering device, whose surface is not a drum's.
    pub readings: Vec<FrameReading>,
    /// Filling angle in each frame, rad; metering device only.
    pub filling_angles: Vec<f64>,
    /// Further observables.
    pub further: Vec<Further>,
    /// How the bed moves.
    pub regime: Regime,
    /// Time step used: that of the protocol, or less where the seeds demand it, s.
    pub time_step: f64,
    /// Steps done.
    pub n_steps: u64,
    /// Number of bodies.
    pub n_bodies: usize,
    /// Number of spheres, hidden ones included.
    pub n_spheres: usize,
    /// Contact lists at the end.
    pub census: Census,
    /// The bodies of the seeds, by kind.
    pub bodies: Vec<Arc<SeedBody>>,
}

/// Runs a scene with a seed of its randomness.
///
/// # Errors
///
/// A scene that cannot be built, a solver that stops, frames that cannot be drawn.
pub fn run(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<RunResult, Error> {
    if scene.apparatus.is_release() {
        return released(scene, library, seed);
    }
    let mut built = build(scene, library, seed)?;
    settle(scene, &mut built)?;
    start_drive(scene, &mut built);
    let Rotation {
        series,
        frames,
        truncation,
    } = rotate(scene, &mut built)?;
    let Built { world, bodies, .. } = built;
    let mut readings = Vec::new();
    let mut filling_angles = Vec::new();
    for frame in &frames {
        match &scene.apparatus {
            Apparatus::Drum(_) => readings.push(read_frame(scene, &bodies, frame)?),
            Apparatus::Metering(device) => {
                let at_rim = angles_at_rim(&bodies, frame, scene.apparatus.radius());
                let length = bodies
                    .iter()
                    .map(|b| b.clump.bounding_radius())
                    .fold(0.0, f64::max);
                let gap = GROUP_GAP * 2.0 * length / scene.apparatus.radius();
                filling_angles.push(device.filling_angle(&at_rim, gap));
            }
            Apparatus::Heap(_) | Apparatus::BoxCollapse(_) => {}
        }
    }
    let start = truncation.map_or(0, |t| t.cut);
    let slips: Vec<f64> = series[start..].iter().map(|p| p.shell_slip).collect();
    let slip = slips.iter().sum::<f64>() / slips.len().max(1) as f64;
    let further = further(scene, &bodies, &frames, &series[start..]);
    Ok(RunResult {
        further,
        series,
        truncation,
        frames,
        readings,
        filling_angles,
        regime: if slip > SLIDING_BELOW {
            Regime::Sliding
        } else {
            Regime::Rolling
        },
        time_step: world.settings().time_step,
        n_steps: world.n_steps(),
        n_bodies: world.bodies().len(),
        n_spheres: world
            .bodies()
            .template
            .iter()
            .map(|&t| bodies[t].clump.spheres().len())
            .sum(),
        census: world.census(),
        bodies,
    })
}

/// The result of a release in the form of a run.
fn released(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<RunResult, Error> {
    let result = crate::release::release(scene, library, seed)?;
    let Built { world, bodies, .. } = result.built;
    let kinds = &world.bodies().template;
    Ok(RunResult {
        series: Vec::new(),
        truncation: result.rested.then_some(Truncation {
            cut: 0,
            standard_error: 0.0,
            steady: true,
        }),
        frames: vec![result.frame],
        readings: Vec::new(),
        filling_angles: Vec::new(),
        further: result.further,
        regime: Regime::Resting,
        time_step: world.settings().time_step,
        n_steps: world.n_steps(),
        n_bodies: kinds.len(),
        n_spheres: kinds.iter().map(|&t| bodies[t].clump.spheres().len()).sum(),
        census: world.census(),
        bodies,
    })
}

/// Observables of a drum beside the angles.
fn further(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
    steady: &[SeriesPoint],
) -> Vec<Further> {
    let power = steady.iter().map(|p| 1e3 * p.drive_power_w).collect();
    let mut all = vec![Further::new("drive_power_mw", "mW", power)];
    if !matches!(scene.apparatus, Apparatus::Drum(_)) {
        return all;
    }
    let radius = scene.apparatus.radius();
    let mass: Vec<f64> = steady.iter().map(|p| p.centre_of_mass_deg).collect();
    let direction = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    let layers: Vec<_> = frames
        .iter()
        .filter_map(|f| flowing_layer(f, bodies, direction.to_radians(), radius))
        .collect();
    let depths = layers.iter().map(|l| 1e3 * l.depth).collect();
    let speeds = layers.iter().map(|l| 1e3 * l.surface_speed).collect();
    let fills = frames.iter().filter_map(|f| fill_level(f, bodies, radius));
    let period = avalanche_period(&mass, SERIES_INTERVAL);
    all.push(Further::new("flowing_layer_depth_mm", "mm", depths));
    all.push(Further::new("surface_speed_mm_s", "mm/s", speeds));
    all.push(Further::new("fill_level", "1", fills.collect()));
    all.push(Further::new(
        "avalanche_period_s",
        "s",
        period.into_iter().collect(),
    ));
    all
}

/// A world with what belongs to it.
#[derive(Debug, Clone)]
pub(crate) struct Built {
    /// The world.
    pub(crate) world: World,
    /// The bodies of the seeds, by kind.
    pub(crate) bodies: Vec<Arc<SeedBody>>,
    /// Walls of triangles with their motion.
    pub(crate) meshes: Vec<NamedMesh>,
    /// What acts on the seeds beside gravity and contacts.
    pub(crate) surroundings: Option<Surroundings>,
    /// What a believable world keeps to.
    limits: HealthLimits,
}

/// Builds the world with the seeds in their starting places and the drive at rest.
pub(crate) fn build(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<Built, Error> {
    let bodies = seed_bodies(scene, library)?;
    let meshes = mesh_walls(scene)?;
    let kinds: Vec<_> = bodies
        .iter()
        .zip(&scene.seed)
        .map(|(b, s)| (&b.clump, s.count))
        .collect();
    let obstacles: Vec<_> = meshes.iter().flat_map(|m| m.triangles.clone()).collect();
    let placements = place(&scene.apparatus, &obstacles, &kinds, seed)?;
    assemble(scene, bodies, meshes, &placements)
}

/// Puts seeds in given places into the apparatus at rest.
fn assemble(
    scene: &Scene,
    bodies: Vec<Arc<SeedBody>>,
    meshes: Vec<NamedMesh>,
    placements: &[Placement],
) -> Result<Built, Error> {
    let mut world = empty_drive(scene, &bodies, &meshes, placements)?;
    let names = material_names(scene, &meshes);
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
    let limits = limits(scene, &bodies);
    let surroundings = Surroundings::of(scene, &bodies);
    Ok(Built {
        world,
        bodies,
        meshes,
        surroundings,
        limits,
    })
}

/// Where the seeds of a scene start, their bodies, and the time step of the solver (s).
///
/// # Errors
///
/// A scene that cannot be built.
pub fn starting_frame(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
) -> Result<(Frame, Vec<Arc<SeedBody>>, f64), Error> {
    let built = build(scene, library, seed)?;
    let frame = snapshot(&built.world, 0.0);
    Ok((frame, built.bodies, built.world.settings().time_step))
}

/// The solver's world of a scene, for callers that step it themselves: the drive runs, and the
/// seeds are where `placements` has them; a template of a placement is a kind of seed.
///
/// # Errors
///
/// A scene that cannot be built, a seed outside the apparatus.
pub fn running_world(
    scene: &Scene,
    library: &FillingLibrary,
    placements: &[Placement],
) -> Result<World, Error> {
    let bodies = seed_bodies(scene, library)?;
    let mut built = assemble(scene, bodies, mesh_walls(scene)?, placements)?;
    start_drive(scene, &mut built);
    Ok(built.world)
}

/// The solver's world of a scene after the seeds have settled, with the drive running.
///
/// # Errors
///
/// A scene that cannot be built, a solver that stops.
pub fn settled_world(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<World, Error> {
    let mut built = build(scene, library, seed)?;
    settle(scene, &mut built)?;
    start_drive(scene, &mut built);
    Ok(built.world)
}

/// Bodies of the seeds, by kind.
fn seed_bodies(scene: &Scene, library: &FillingLibrary) -> Result<Vec<Arc<SeedBody>>, Error> {
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

/// Sets all walls in motion.
fn start_drive(scene: &Scene, built: &mut Built) {
    if let Some(surroundings) = &mut built.surroundings {
        surroundings.start(built.world.time());
    }
    for wall in scene.apparatus.walls() {
        built.world.set_wall_spin(wall.name, wall.spin);
    }
    for mesh in &built.meshes {
        built.world.set_mesh_motion(&mesh.name, &mesh.motion);
    }
}

/// The world without its walls of triangles.
fn empty_drive(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    meshes: &[NamedMesh],
    placements: &[Placement],
) -> Result<World, Error> {
    let walls = scene.apparatus.walls();
    let names = material_names(scene, meshes);
    let index = |name: &str| index_of(&names, name);
    let templates: Vec<Template> = scene
        .seed
        .iter()
        .zip(bodies)
        .map(|(s, b)| Template::new(&b.clump, index(&s.material), scene.model.dashpot_mass))
        .collect();
    let radius = templates
        .iter()
        .map(Template::smallest_radius)
        .fold(f64::INFINITY, f64::min);
    let still = walls.iter().map(|w| Wall {
        name: w.name.into(),
        shape: w.shape,
        material: index(&w.material),
        spin: 0.0,
    });
    let settings = Settings {
        time_step: scene
            .protocol
            .time_step
            .si()
            .min(longest_time_step(scene, bodies)?),
        gravity: scene.apparatus.gravity(scene.model.gravity_m_s2),
        skin: 0.45 * radius,
        margin: 4.5 * radius,
    };
    let interactions = interactions(scene, &names)?;
    Ok(World::new(
        settings,
        templates,
        interactions,
        still.collect(),
        placements,
    )?)
}

/// Longest time step that resolves a hard contact of every seed with every material, s.
///
/// # Formula
///
/// `dt = share t_c`, with `t_c` the [duration](hard_contact::duration) of a collision of the largest
/// sphere at the surface with the [mass felt at the tip](clump::Clump::mass_felt_at_tip).
pub(crate) fn longest_time_step(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<f64, Error> {
    let mut longest = f64::INFINITY;
    for (seed, body) in scene.seed.iter().zip(bodies) {
        let clump = &body.clump;
        let largest = body
            .outer
            .spheres()
            .iter()
            .map(|s| s.radius)
            .fold(0.0, f64::max);
        let mut stiffest = 0.0_f64;
        let seeds = scene.seed.iter().map(|s| s.material.as_str());
        for name in scene.wall_materials().into_iter().chain(seeds) {
            let pair = format!("{}-{name}", seed.material);
            let moduli = effective_moduli(
                &material_of(scene, &seed.material, &pair)?,
                &material_of(scene, name, &pair)?,
            );
            stiffest = stiffest.max(moduli.young);
        }
        let duration = hard_contact::duration(clump.mass_felt_at_tip(), largest, stiffest);
        longest = longest.min(scene.protocol.step_share * duration);
    }
    Ok(longest)
}

/// Elastic constants of a named material; `pair` is named in the message.
fn material_of(scene: &Scene, name: &str, pair: &str) -> Result<Material, Error> {
    let m = &scene.material[name];
    let refused = |source| Error::Contact {
        pair: pair.to_owned(),
        source,
    };
    Material::new(m.poisson_ratio.get(), m.shear_modulus.si()).map_err(refused)
}

/// Interactions of all pairs of materials, row by row.
pub(crate) fn interactions(scene: &Scene, names: &[&str]) -> Result<Vec<Interaction>, Error> {
    let heaviest = scene.seed.iter().map(|s| s.mass.si()).fold(0.0, f64::max);
    let model = &scene.model;
    let pull = constant_attraction::attraction(model.bond_number, heaviest, model.gravity_m_s2);
    let mut table = Vec::new();
    for a in names {
        for b in names {
            let pair = format!("{a}-{b}");
            let refused = |source| Error::Contact {
                pair: pair.clone(),
                source,
            };
            // Two walls never meet: their entry is filled with an inert law.
            let contact = scene.contact_of(a, b);
            let parameters = PairParameters {
                restitution: contact.map_or(1.0, |c| c.restitution.get()),
                static_friction: contact.map_or(0.0, |c| c.static_friction.get()),
                rolling_friction: contact.map_or(0.0, |c| c.rolling_friction.get()),
            };
            let settings = InteractionSettings {
                materials: [material_of(scene, a, &pair)?, material_of(scene, b, &pair)?],
                parameters,
                attraction: pull + contact.and_then(|c| c.attraction_n).unwrap_or(0.0),
                end: model.normal_force_end,
            };
            table.push(Interaction::new(&settings).map_err(refused)?);
        }
    }
    Ok(table)
}

/// Runs until the seeds rest, or the limit is reached; a start slope is there when it ends.
pub(crate) fn settle(scene: &Scene, built: &mut Built) -> Result<(), Error> {
    let gravity = scene.apparatus.gravity(scene.model.gravity_m_s2);
    let slope = scene.protocol.start_slope.map_or(0.0, Angle::si);
    let turn = Rotation3::new(Vector3::z() * slope * scene.apparatus.speed().signum());
    built.world.set_gravity(turn * gravity);
    let settled = wait_for_rest(scene, built);
    built.world.set_gravity(gravity);
    settled
}

/// Runs until the seeds rest, or the limit is reached.
fn wait_for_rest(scene: &Scene, built: &mut Built) -> Result<(), Error> {
    let rest = rest_energy(scene, &built.world);
    let limit = scene.protocol.settle_limit.si();
    // Free fall across the apparatus comes first: at the very start nothing moves.
    let [low, high] = scene.apparatus.room();
    let fall = (2.0 * (high.y - low.y) / scene.model.gravity_m_s2).sqrt();
    loop {
        advance(scene, built, SERIES_INTERVAL)?;
        let world = &built.world;
        let rested = world.time() > fall && world.kinetic_energy() < rest;
        if rested || world.time() >= limit {
            return Ok(());
        }
    }
}

/// Kinetic energy below which all seeds rest, J.
pub(crate) fn rest_energy(scene: &Scene, world: &World) -> f64 {
    let size = world
        .templates()
        .iter()
        .map(Template::smallest_radius)
        .fold(f64::INFINITY, f64::min);
    let masses = scene.seed.iter().map(|s| s.mass.si() * s.count as f64);
    AT_REST * masses.sum::<f64>() * scene.model.gravity_m_s2 * 10.0 * size
}

/// Moves the world by a time (s), and looks whether it can still be believed.
pub(crate) fn advance(scene: &Scene, built: &mut Built, time: f64) -> Result<(), Error> {
    let world = &mut built.world;
    let end = world.time() + time - 0.5 * world.settings().time_step;
    while world.time() < end {
        match &built.surroundings {
            None => world.step()?,
            Some(surroundings) => {
                let now = world.time();
                world.step_with(|bodies| surroundings.add_forces(now, bodies))?;
            }
        }
    }
    world
        .check_health(&built.limits)
        .map_err(|source| Error::Unhealthy {
            file: scene.file.clone(),
            source,
        })
}

/// What is kept of the rotation.
struct Rotation {
    /// The bed over time.
    series: Vec<SeriesPoint>,
    /// Frames behind the start-up.
    frames: Vec<Frame>,
    /// Where the start-up ends.
    truncation: Option<Truncation>,
}

/// Turns the drive until the wanted number of frames lies behind the start-up.
fn rotate(scene: &Scene, built: &mut Built) -> Result<Rotation, Error> {
    let protocol = &scene.protocol;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small ratio"
    )]
    let every = (protocol.frame_interval.si() / SERIES_INTERVAL)
        .round()
        .max(1.0) as usize;
    let mut series: Vec<SeriesPoint> = Vec::new();
    let mut frames: Vec<(usize, Frame)> = Vec::new();
    let start = built.world.time();
    loop {
        let share = scene.apparatus.share_of_speed(built.world.time() - start);
        if let Some(share) = share {
            set_share_of_speed(scene, built, share);
        }
        advance(scene, built, SERIES_INTERVAL)?;
        let world = &built.world;
        let time = world.time() - start;
        series.push(series_point(scene, world, time, share.unwrap_or(1.0)));
        let over = time >= protocol.rotation_limit.si();
        if series.len().is_multiple_of(every) {
            frames.push((series.len(), snapshot(world, time)));
        }
        if !over && !series.len().is_multiple_of(every) {
            continue;
        }
        let angles: Vec<f64> = series.iter().map(|p| p.centre_of_mass_deg).collect();
        let truncation = marginal_standard_error_rule(&angles, BATCH);
        let cut = truncation.map_or(usize::MAX, |t| if t.steady { t.cut } else { usize::MAX });
        let after = frames.iter().filter(|(at, _)| *at > cut).count();
        if after >= protocol.frames || over {
            let keep = after
                .clamp(2.min(frames.len()), protocol.frames)
                .min(frames.len());
            let last = frames.split_off(frames.len() - keep);
            let frames = last.into_iter().map(|f| f.1).collect();
            return Ok(Rotation {
                series,
                frames,
                truncation,
            });
        }
    }
}

/// Turns everything that turns with the drive at a share of its speed.
fn set_share_of_speed(scene: &Scene, built: &mut Built, share: f64) {
    for wall in scene.apparatus.walls() {
        built.world.set_wall_spin(wall.name, wall.spin * share);
    }
    for mesh in scene.apparatus.mesh_walls() {
        let motion = Motion {
            spin: mesh.motion.spin * share,
            ..mesh.motion
        };
        built.world.set_mesh_motion(&mesh.name, &motion);
    }
}

/// Poses of all bodies.
pub(crate) fn snapshot(world: &World, time: f64) -> Frame {
    let bodies = world.bodies();
    Frame {
        time,
        kind: bodies.template.clone(),
        position: bodies.position.clone(),
        orientation: bodies.orientation.clone(),
        velocity: bodies.velocity.clone(),
        spin: bodies.spin.clone(),
    }
}

/// Direction of the centre of mass and slip at the shell.
fn series_point(scene: &Scene, world: &World, time: f64, share: f64) -> SeriesPoint {
    let (bodies, templates) = (world.bodies(), world.templates());
    let (radius, spin) = (scene.apparatus.radius(), scene.apparatus.speed());
    let mut centre = Vector3::zeros();
    for p in &bodies.position {
        centre += p;
    }
    let lowest = centre.x.atan2(-centre.y);
    let (mut speed, mut n) = (0.0, 0_usize);
    for (i, p) in bodies.position.iter().enumerate() {
        let from_axis = p.xy().norm();
        let aside = (p.x.atan2(-p.y) - lowest + PI).rem_euclid(TAU) - PI;
        let at_shell = from_axis > radius - templates[bodies.template[i]].bounding_radius();
        if at_shell && aside.abs() < MIDDLE_OF_BED {
            let v = bodies.velocity[i];
            speed += (p.x * v.y - p.y * v.x) / from_axis;
            n += 1;
        }
    }
    let surface_speed = spin * share * radius;
    let slip = if n > 0 && surface_speed != 0.0 {
        1.0 - speed / n as f64 / surface_speed
    } else {
        0.0
    };
    SeriesPoint {
        time_s: time,
        centre_of_mass_deg: lowest.to_degrees(),
        shell_slip: slip,
        drive_power_w: drive_power(world),
        kinetic_energy_j: world.kinetic_energy(),
    }
}

/// Power of the moving walls on the seeds in the last step, W; vibrations are left out.
fn drive_power(world: &World) -> f64 {
    let torques = world.wall_torque().iter();
    let turning = world.walls().iter().zip(torques);
    let meshes = world.mesh_walls().zip(world.mesh_loads());
    turning
        .map(|(wall, torque)| -torque * wall.spin)
        .sum::<f64>()
        - meshes
            .map(|(wall, (force, torque))| {
                force.dot(&wall.motion.velocity) + torque.dot(&wall.motion.spin)
            })
            .sum::<f64>()
}

/// Angles from straight down (counter-clockwise positive, rad) of the seeds at the rim.
fn angles_at_rim(bodies: &[Arc<SeedBody>], frame: &Frame, radius: f64) -> Vec<f64> {
    frame
        .position
        .iter()
        .zip(&frame.kind)
        .filter(|(p, kind)| p.xy().norm() > radius - bodies[**kind].clump.bounding_radius())
        .map(|(p, _)| p.x.atan2(-p.y))
        .collect()
}
