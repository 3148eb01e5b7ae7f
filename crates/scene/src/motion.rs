//! The time of a run: settling, the drive, the series that tells when the bed is steady, frames.

use crate::bonded::BondedSeeds;
use crate::build::Built;
use crate::factory::Factory;
use crate::health::fall_height;
use crate::keeper::{Keeper, RunStage};
use crate::memory_order::placements_in_order;
use crate::phase_times::Stopwatch;
use crate::phases::Log;
use crate::series::{SeriesPoint, series_point};
use crate::start_slope::start_slope;
use crate::steady::{SteadyRule, SteadyState, swing_time};
use crate::{Error, Frame, Scene};
use dem_solver::{Motion, Snapshot, Template, World};
use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

/// Time between the values of the series that decide whether the run is steady, s.
pub(crate) const SERIES_INTERVAL: f64 = 0.02;
/// Kinetic energy of a seed at rest over the energy of a fall by its own size.
const AT_REST: f64 = 1e-4;

/// The state of a run between two steps: all that it needs to continue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    world: Snapshot,
    /// Its time when the drive started, s; none while the seeds settle.
    drive_since: Option<f64>,
    /// Time of one swing of the bed as it lay then, s.
    swing: Option<f64>,
    /// The bed over time since then.
    series: Vec<SeriesPoint>,
    /// Frames, each with the number of values of the series before it.
    frames: Vec<(usize, Frame)>,
    /// Numbers of the bonds that have broken; empty if the seeds are rigid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    broken: Vec<usize>,
    /// Numbers of the seeds by their places in the world, where it was sorted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    numbers: Vec<usize>,
    /// How far the phases are, and what was seen on the way.
    #[serde(default)]
    log: Log,
    /// Why attempts with longer steps broke off before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    broken_off: Vec<String>,
}

impl Progress {
    /// Time of the world, s.
    pub fn time(&self) -> f64 {
        self.world.time()
    }

    /// Why attempts with longer steps broke off before.
    pub(crate) fn broken_off(&self) -> &[String] {
        &self.broken_off
    }
}

/// A run between its start and its end.
pub(crate) struct Running<'a> {
    pub(crate) scene: &'a Scene,
    /// The world and what belongs to it.
    pub(crate) built: Built,
    /// Time of the world when the drive started, or the wall began to rise, s.
    pub(crate) drive_since: Option<f64>,
    /// Time of one swing of the bed as it lay then, s.
    swing: Option<f64>,
    /// The bed since then.
    series: Vec<SeriesPoint>,
    /// Frames since then.
    frames: Vec<(usize, Frame)>,
    /// How far the phases are, and what was seen on the way.
    pub(crate) log: Log,
}

impl<'a> Running<'a> {
    /// At the start, or where a run was left.
    pub(crate) fn new(
        scene: &'a Scene,
        mut built: Built,
        left: Option<Progress>,
    ) -> Result<Self, Error> {
        let Some(left) = left else {
            return Ok(Self {
                scene,
                built,
                drive_since: None,
                swing: None,
                series: Vec::new(),
                frames: Vec::new(),
                log: Log::default(),
            });
        };
        let others = || Error::NotKept {
            file: scene.file.clone(),
            reason: "its seeds are others".into(),
        };
        if let Some(factory) = &built.factory {
            let inside = placements_in_order(&left.world, &left.numbers);
            let kinds: Vec<_> = inside.iter().map(|p| p.template).collect();
            let known = factory.made(&left.numbers, kinds.len());
            if known.is_none_or(|known| known != kinds) {
                return Err(others());
            }
            built.world.insert(&inside)?;
        } else if !left.log.passages.is_empty() {
            let gone = built.places_without(&left.numbers);
            built.world.remove(&gone)?;
        }
        let kinds = match &built.bonds {
            Some(bonds) => &bonds.kinds(),
            None => &built.world.bodies().template,
        };
        if left.frames.iter().any(|(_, frame)| !frame.is_of(kinds)) {
            return Err(Error::NotKept {
                file: scene.file.clone(),
                reason: "its frames are of other seeds".into(),
            });
        }
        built.put_in_order(&left.numbers)?;
        built.world.resume(left.world)?;
        if let Some(bonds) = &mut built.bonds {
            let known = bonds.set_broken(&left.broken);
            known.map_err(|reason| Error::NotKept {
                file: scene.file.clone(),
                reason,
            })?;
        }
        if let (Some(since), Some(surroundings)) = (left.drive_since, &mut built.surroundings) {
            surroundings.start(since);
        }
        Ok(Self {
            scene,
            built,
            drive_since: left.drive_since,
            swing: left.swing,
            series: left.series,
            frames: left.frames,
            log: left.log,
        })
    }

    /// Whether the drive runs already, or the wall is on its way.
    pub(crate) fn is_driven(&self) -> bool {
        self.drive_since.is_some()
    }

    /// How far the run is.
    fn stage(&self) -> RunStage {
        let protocol = &self.scene.protocol;
        let made = self.built.factory.as_ref().map_or(0.0, Factory::duration);
        let limit_s = if self.is_driven() {
            protocol.rotation_limit.si()
        } else {
            made + protocol.settle_limit.si()
        };
        RunStage {
            driven: self.is_driven(),
            time_s: self.built.world.time() - self.drive_since.unwrap_or(0.0),
            limit_s,
            frames: [self.frames.len(), protocol.frames],
        }
    }

    /// Lets a keeper have the state, if it wants it, give the number of threads, and end the run.
    pub(crate) fn offer(&mut self, keeper: &mut dyn Keeper) -> Result<(), Error> {
        keeper.hear(&self.stage());
        if let Some(threads) = keeper.threads() {
            self.built.set_threads(self.scene, threads)?;
        }
        let stopped = keeper.is_stopped();
        if !keeper.is_due() && !stopped {
            return Ok(());
        }
        let progress = Progress {
            world: self.built.world.snapshot(),
            drive_since: self.drive_since,
            swing: self.swing,
            series: self.series.clone(),
            frames: self.frames.clone(),
            broken: (self.built.bonds.as_ref()).map_or_else(Vec::new, BondedSeeds::broken),
            numbers: self.built.numbers.clone(),
            log: self.log.clone(),
            broken_off: self.scene.protocol.broken_off.clone(),
        };
        keeper.keep(&progress).map_err(|reason| Error::NotKept {
            file: self.scene.file.clone(),
            reason,
        })?;
        if stopped {
            return Err(Error::Stopped {
                file: self.scene.file.clone(),
                time: self.built.world.time(),
            });
        }
        Ok(())
    }
}

/// Sets all walls in motion, and the time step for it.
pub(crate) fn start_drive(scene: &Scene, built: &mut Built) -> Result<(), Error> {
    if let Some(surroundings) = &mut built.surroundings {
        surroundings.start(built.world.time());
    }
    built.world.set_time_step(built.time_steps.flow)?;
    for wall in scene.apparatus.device().walls() {
        built.world.set_wall_spin(&wall.name, wall.spin)?;
    }
    for mesh in &built.meshes {
        built.world.set_mesh_motion(&mesh.name, &mesh.motion)?;
    }
    Ok(())
}

/// Runs until the seeds rest, or the limit is reached; a start slope is there when it ends.
pub(crate) fn settle(running: &mut Running<'_>, keeper: &mut dyn Keeper) -> Result<(), Error> {
    let scene = running.scene;
    let gravity = scene.apparatus.device().gravity(scene.model.gravity_m_s2);
    let slope = start_slope(scene, &running.built.bodies) * scene.apparatus.speed().signum();
    let turn = Rotation3::new(Vector3::z() * slope);
    running.built.world.set_gravity(turn * gravity)?;
    wait_for_rest(running, keeper)?;
    running.built.world.set_gravity(gravity)?;
    Ok(())
}

/// Runs until the seeds rest, or the limit is reached.
fn wait_for_rest(running: &mut Running<'_>, keeper: &mut dyn Keeper) -> Result<(), Error> {
    let scene = running.scene;
    let rest = rest_energy(scene, &running.built.world);
    let made = running.built.factory.as_ref();
    let made = made.map_or(0.0, Factory::duration);
    let [shortest, limit] = filling_times(scene, made);
    let plan = scene.apparatus.device().plan(scene);
    loop {
        let gone = running.log.passages.len();
        if let Some(factory) = &running.built.factory {
            let new = factory.next(&scene.apparatus, &running.built, (gone, SERIES_INTERVAL));
            running.built.insert(&new, gone)?;
        }
        advance(scene, &mut running.built, SERIES_INTERVAL)?;
        if let Some(plan) = &plan {
            running.take_out(plan.outlets(0))?;
        }
        let world = &running.built.world;
        let rested = world.time() > shortest && world.kinetic_energy() < rest;
        if rested || world.time() >= limit {
            let factory = running.built.factory.as_ref();
            let made = world.bodies().len() + running.log.passages.len();
            return factory.map_or(Ok(()), |f| f.check_all_in(made));
        }
        running.offer(keeper)?;
    }
}

/// Shortest and longest time of a filling whose last seed appears at a time (s), s.
pub(crate) fn filling_times(scene: &Scene, made: f64) -> [f64; 2] {
    // Free fall across the apparatus comes first: at the very start nothing moves.
    let fall = (2.0 * fall_height(scene) / scene.model.gravity_m_s2).sqrt();
    [made + fall, made + scene.protocol.settle_limit.si()]
}

/// Kinetic energy below which all seeds rest, J.
pub(crate) fn rest_energy(scene: &Scene, world: &World) -> f64 {
    let sizes = world.templates().iter().map(Template::smallest_radius);
    rest_energy_of(scene, sizes.fold(f64::INFINITY, f64::min))
}

/// The same for seeds whose smallest sphere has a radius (m).
pub(crate) fn rest_energy_of(scene: &Scene, smallest_radius: f64) -> f64 {
    AT_REST * scene.seed_mass() * scene.model.gravity_m_s2 * 10.0 * smallest_radius
}

/// Moves the world by a time (s), and looks whether it can still be believed.
pub(crate) fn advance(scene: &Scene, built: &mut Built, time: f64) -> Result<(), Error> {
    let world = &mut built.world;
    let before = world.time();
    let end = before + time - 0.5 * world.settings().time_step;
    while world.time() < end {
        match (&mut built.bonds, &built.surroundings) {
            (Some(bonds), _) => bonds.step(world)?,
            (None, None) => world.steps_until(end)?,
            (None, Some(surroundings)) => {
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
        })?;
    if built.is_to_be_sorted([before, built.world.time()]) {
        built.sort()?;
    }
    Ok(())
}

/// What is kept of the rotation.
pub(crate) struct Rotation {
    /// The bed over time.
    pub(crate) series: Vec<SeriesPoint>,
    /// Frames behind the start-up.
    pub(crate) frames: Vec<Frame>,
    /// What is kept, and whether it is steady.
    pub(crate) state: SteadyState,
    /// Time by the clock before the bed was steady, s; that of this process.
    pub(crate) start_up_s: f64,
}

/// Values of the series from one frame to the next.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small ratio"
)]
fn values_in_a_frame(scene: &Scene) -> usize {
    let ratio = scene.protocol.frame_interval.si() / SERIES_INTERVAL;
    ratio.round().max(1.0) as usize
}

/// Turns the drive until the bed is steady and the wanted number of frames lies behind the start-up, or the limit is
/// reached; starts it where it does not turn yet. All frames behind the start-up are kept.
pub(crate) fn rotate(
    running: &mut Running<'_>,
    keeper: &mut dyn Keeper,
) -> Result<Rotation, Error> {
    let scene = running.scene;
    let protocol = &scene.protocol;
    let every = values_in_a_frame(scene);
    let start = if let Some(since) = running.drive_since {
        since
    } else {
        start_drive(scene, &mut running.built)?;
        running.built.world.time()
    };
    running.drive_since = Some(start);
    // That of the bed at the start, also in a run that goes on from where it was left.
    let swing = running
        .swing
        .unwrap_or_else(|| swing_of(scene, &running.built));
    running.swing = Some(swing);
    let rule = steady_rule(scene, swing);
    // What the clock showed after each value of the series that this process adds.
    let mut watch = Stopwatch::start();
    let (before, mut laps) = (running.series.len(), Vec::new());
    loop {
        running.offer(keeper)?;
        let Running {
            built,
            series,
            frames,
            ..
        } = running;
        let device = scene.apparatus.device();
        let share = device.share_of_speed(built.world.time() - start);
        if let Some(share) = share {
            set_share_of_speed(scene, built, share)?;
        }
        advance(scene, built, SERIES_INTERVAL)?;
        let time = built.world.time() - start;
        let now = snapshot(built, time);
        series.push(series_point(scene, built, &now, share.unwrap_or(1.0)));
        laps.push(watch.lap());
        let over = time >= protocol.rotation_limit.si();
        if series.len().is_multiple_of(every) {
            frames.push((series.len(), now));
        }
        let asked = rule.asks_at(series.len());
        if !over && !asked {
            continue;
        }
        let angles: Vec<f64> = series.iter().map(|p| p.centre_of_mass_deg).collect();
        let rolls: Vec<bool> = series.iter().map(SeriesPoint::rolls).collect();
        let state = rule.judge(&angles, &rolls);
        let after = frames.iter().filter(|(at, _)| *at > state.cut).count();
        if over || (state.doubt.is_none() && after >= protocol.frames) {
            let keep = after.max(2).min(frames.len());
            let last = frames.split_off(frames.len() - keep);
            return Ok(Rotation {
                series: std::mem::take(series),
                frames: last.into_iter().map(|f| f.1).collect(),
                state,
                start_up_s: laps.iter().take(state.cut.saturating_sub(before)).sum(),
            });
        }
    }
}

/// Time of one swing of the bed as it lies, s.
fn swing_of(scene: &Scene, built: &Built) -> f64 {
    let (radius, gravity) = (scene.apparatus.radius(), scene.model.gravity_m_s2);
    let bodies = built.world.bodies();
    let (mut mass, mut square, mut centre) = (0.0, 0.0, Vector3::zeros());
    for (position, kind) in bodies.position.iter().zip(&bodies.template) {
        let m = built.world.templates()[*kind].mass();
        mass += m;
        square += m * position.xy().norm_squared();
        centre += m * position;
    }
    let arm = (centre / mass).xy().norm();
    swing_time(square / mass, arm, radius, gravity)
}

/// What a rotation must show, for a bed that swings in a time (s).
fn steady_rule(scene: &Scene, swing: f64) -> SteadyRule {
    let protocol = &scene.protocol;
    SteadyRule::for_bed(
        swing,
        scene.start_up(swing),
        protocol.rotation_limit.si(),
        SERIES_INTERVAL,
        protocol.angle_error.map(|e| e.si().to_degrees()),
    )
}

/// Turns everything that turns with the drive at a share of its speed.
fn set_share_of_speed(scene: &Scene, built: &mut Built, share: f64) -> Result<(), Error> {
    for wall in scene.apparatus.device().walls() {
        built.world.set_wall_spin(&wall.name, wall.spin * share)?;
    }
    for mesh in scene.apparatus.device().mesh_walls() {
        let motion = Motion {
            spin: mesh.motion.spin * share,
            ..mesh.motion
        };
        built.world.set_mesh_motion(&mesh.name, &motion)?;
    }
    Ok(())
}

/// Poses of all seeds and walls.
pub(crate) fn snapshot(built: &Built, time: f64) -> Frame {
    let seeds = match &built.bonds {
        Some(bonds) => bonds.frame(built, time),
        None => built.seeds_in_order(time),
    };
    Frame {
        walls: built.world.mesh_poses().collect(),
        ..seeds
    }
}
