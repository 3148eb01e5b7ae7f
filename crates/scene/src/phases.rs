//! Runs in phases: the seeds are filled in and settle, then the walls move, phase by phase, and outlets take seeds out.

use crate::build::Built;
use crate::curve::Curve;
use crate::driven_pile::is_driven_by_rolling;
use crate::keeper::Keeper;
use crate::motion::{Progress, Running, SERIES_INTERVAL, advance, rest_energy, settle, snapshot};
use crate::phase_times::Stopwatch;
use crate::{Doubt, Error, Frame, ObservableValues, Scene, SeedBody};
use dem_solver::{Motion, World};
use geometry::clump::Sphere;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Largest difference of the force on a loaded wall from its load, over the load, in a bed that carries it.
pub const LOAD_CARRIED: f64 = 0.02;

/// What an apparatus does to its bed. The first phase fills it and ends when the seeds rest; the others follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The phases, in order.
    pub phases: Vec<Phase>,
    /// Time between two samples, s; 20 ms is a multiple of it.
    pub interval: f64,
}

impl Plan {
    /// Filling, and phases behind it, sampled as often as the series of a drum.
    pub(crate) fn new(phases: Vec<Phase>) -> Self {
        let filling = Phase::named("filling");
        Self {
            phases: std::iter::once(filling).chain(phases).collect(),
            interval: SERIES_INTERVAL,
        }
    }

    pub(crate) fn outlets(&self, phase: usize) -> &[Outlet] {
        self.phases.get(phase).map_or(&[], |phase| &phase.outlets)
    }

    /// Whether seeds may be taken out.
    pub(crate) fn has_outlets(&self) -> bool {
        self.phases.iter().any(|phase| !phase.outlets.is_empty())
    }

    /// Times of the phases that end by themselves, s.
    pub(crate) fn stated_time(&self) -> f64 {
        let stated = self.phases.iter().map(|phase| match phase.end {
            End::After(time) => time,
            _ => 0.0,
        });
        stated.sum()
    }
}

/// A time in which each wall of triangles keeps one motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Name.
    pub name: String,
    /// Motions that begin with the phase, by the name of the wall; other walls keep their motion.
    pub motions: Vec<(String, Motion)>,
    /// Walls that are taken away at its start.
    pub removed: Vec<String>,
    /// Where seeds are taken out during the phase.
    pub outlets: Vec<Outlet>,
    /// When it ends.
    pub end: End,
}

impl Phase {
    /// A phase in which nothing is done, until the seeds rest.
    pub(crate) fn named(name: &str) -> Self {
        Self {
            name: name.into(),
            motions: Vec::new(),
            removed: Vec::new(),
            outlets: Vec::new(),
            end: End::AtRest { after: 0.0 },
        }
    }
}

/// When a phase ends.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// When all seeds rest and all loaded walls are carried, not before a time (s); at the latest after the rotation limit.
    AtRest {
        /// Shortest time, s.
        after: f64,
    },
    /// After a time, s.
    After(f64),
    /// When a wall has gone down by a depth since the bed first pushed it up; at the latest after the rotation limit.
    Pressed {
        /// Name of the wall.
        wall: String,
        /// Depth, m.
        depth: f64,
    },
    /// When the bed pushes a wall along a unit vector with a force (N); at the latest after the rotation limit.
    Pushed {
        /// Name of the wall.
        wall: String,
        /// Direction.
        along: Vector3<f64>,
        /// Force, N.
        force: f64,
    },
    /// When a fraction of the mass that was there at the start of the phase has been taken out; at the latest after the rotation limit.
    Discharged(f64),
}

impl End {
    /// What it is called if the limit comes first; `None` of an end that asks for rest.
    fn doubt(&self) -> Option<Doubt> {
        match self {
            Self::AtRest { .. } | Self::After(_) => None,
            Self::Pressed { .. } => Some(Doubt::DepthNotReached),
            Self::Pushed { .. } => Some(Doubt::ForceNotReached),
            Self::Discharged(_) => Some(Doubt::NotDischarged),
        }
    }
}

/// A plane that takes out the seeds whose centres pass it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlet {
    /// A point of the plane, m.
    pub point: Vector3<f64>,
    /// Unit normal, away from the bed.
    pub normal: Vector3<f64>,
}

impl Outlet {
    /// The plane below a height, m.
    pub(crate) fn below(height: f64) -> Self {
        Self {
            point: Vector3::y() * height,
            normal: -Vector3::y(),
        }
    }

    /// Time since a seed passed, s, if it fell freely from there; `None` of one that has not passed.
    ///
    /// # Formula
    ///
    /// The smaller root of `s = v t - a t²/2`: s the distance behind the plane, v and a the speed and gravity along its normal.
    pub fn passed(
        &self,
        position: &Vector3<f64>,
        velocity: &Vector3<f64>,
        gravity: &Vector3<f64>,
    ) -> Option<f64> {
        let distance = (position - self.point).dot(&self.normal);
        if distance <= 0.0 {
            return None;
        }
        let (speed, pull) = (velocity.dot(&self.normal), gravity.dot(&self.normal));
        if speed <= 0.0 {
            return Some(0.0);
        }
        let square = (speed * speed - 2.0 * pull * distance).max(0.0);
        Some(2.0 * distance / (speed + square.sqrt()))
    }
}

/// The apparatus and its bed at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Number of the phase; 0 is the filling.
    pub phase: usize,
    /// Time since the start of the phase, s.
    pub time: f64,
    /// Force of the bed on each wall, N: analytic walls, then walls of triangles.
    pub forces: Vec<Vector3<f64>>,
    /// Torque of the bed on each wall of triangles about its centre of rotation, N m.
    #[serde(default)]
    pub torques: Vec<Vector3<f64>>,
    /// Displacement of each wall of triangles, m.
    pub displacements: Vec<Vector3<f64>>,
    /// Mass of the bed, kg.
    pub mass: f64,
    /// Height of its centre of mass, m; 0 of an empty bed.
    pub centre: f64,
    /// Mass of the seeds whose centres are below y = 0, kg.
    #[serde(default)]
    pub below: f64,
}

impl Sample {
    /// Of a world in a phase that began at a time, s.
    fn of(world: &World, phase: usize, since: f64) -> Self {
        let (mut mass, mut moment, mut below) = (0.0, 0.0, 0.0);
        let bodies = world.bodies();
        for (position, kind) in bodies.position.iter().zip(&bodies.template) {
            let own = world.templates()[*kind].mass();
            mass += own;
            moment += own * position.y;
            if position.y < 0.0 {
                below += own;
            }
        }
        let on_meshes = world.mesh_loads().map(|(force, _)| force);
        Self {
            phase,
            time: world.time() - since,
            forces: world.wall_load().iter().copied().chain(on_meshes).collect(),
            torques: world.mesh_loads().map(|(_, torque)| torque).collect(),
            displacements: world.mesh_displacements().collect(),
            mass,
            centre: if mass > 0.0 { moment / mass } else { 0.0 },
            below,
        }
    }
}

/// A seed that passed an outlet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Passage {
    /// Number of the phase.
    pub phase: usize,
    /// Time since the start of the phase, s.
    pub time: f64,
    /// Mass, kg.
    pub mass: f64,
}

/// How far the phases have come, and what was seen on the way.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Log {
    /// The phase of now.
    pub(crate) phase: usize,
    /// Time of the world when it began, s.
    pub(crate) since: f64,
    pub(crate) samples: Vec<Sample>,
    /// Seeds that were taken out.
    pub(crate) passages: Vec<Passage>,
}

/// What an apparatus reads its observables from.
pub(crate) struct Seen<'a> {
    pub(crate) scene: &'a Scene,
    plan: &'a Plan,
    /// The seeds at the end.
    pub(crate) frame: &'a Frame,
    pub(crate) bodies: &'a [Arc<SeedBody>],
    log: &'a Log,
    /// Names of analytic walls, then of walls of triangles.
    walls: Vec<String>,
}

impl<'a> Seen<'a> {
    /// What was seen of a run, with the names of its analytic walls and then of its walls of triangles.
    pub(crate) fn new(
        (scene, plan): (&'a Scene, &'a Plan),
        frame: &'a Frame,
        bodies: &'a [Arc<SeedBody>],
        log: &'a Log,
        walls: Vec<String>,
    ) -> Self {
        Self {
            scene,
            plan,
            frame,
            bodies,
            log,
            walls,
        }
    }
}

impl Seen<'_> {
    /// Spheres of the seeds at the end.
    pub(crate) fn spheres(&self) -> Vec<Sphere> {
        self.frame.spheres(self.bodies).map(|(_, s)| s).collect()
    }

    /// Bounding radius of the largest seed, m.
    pub(crate) fn largest_radius(&self) -> f64 {
        let radii = self.bodies.iter().map(|b| b.clump.bounding_radius());
        radii.fold(0.0, f64::max)
    }

    /// Mass of all seeds over their volume, kg/m³.
    pub(crate) fn solid_density(&self) -> f64 {
        let kinds = self.scene.seed.iter().zip(self.bodies);
        let volume = kinds.map(|(seed, body)| self.scene.count_of(seed) as f64 * body.volume);
        self.scene.seed_mass() / volume.sum::<f64>()
    }

    /// Name of the last phase.
    pub(crate) fn last_phase(&self) -> &str {
        self.plan.phases.last().map_or("", |phase| &phase.name)
    }

    /// Samples of a phase, in order of time.
    pub(crate) fn samples<'s>(&'s self, phase: &str) -> Vec<&'s Sample> {
        let of_phase = |sample: &&Sample| self.plan.phases[sample.phase].name == phase;
        self.log.samples.iter().filter(of_phase).collect()
    }

    /// The last sample of a phase; `None` if the run did not come so far.
    pub(crate) fn end_of<'s>(&'s self, phase: &str) -> Option<&'s Sample> {
        self.samples(phase).last().copied()
    }

    /// Times (s) and masses (kg) of the seeds that were taken out in a phase, in order of time.
    pub(crate) fn passages(&self, phase: &str) -> Vec<[f64; 2]> {
        let all = self.log.passages.iter();
        let of_phase = all.filter(|p| self.plan.phases[p.phase].name == phase);
        let mut passages: Vec<_> = of_phase.map(|p| [p.time, p.mass]).collect();
        passages.sort_by(|a, b| a[0].total_cmp(&b[0]));
        passages
    }

    /// Force of the bed on all walls of some names in a sample, N.
    pub(crate) fn force(&self, sample: &Sample, walls: &[&str]) -> Vector3<f64> {
        let all = self.walls.iter().zip(&sample.forces);
        all.filter(|(name, _)| walls.contains(&name.as_str()))
            .map(|(_, force)| force)
            .sum()
    }

    /// Displacement of a wall of triangles in a sample, m.
    pub(crate) fn displacement(&self, sample: &Sample, wall: &str) -> Vector3<f64> {
        self.of_mesh(&sample.displacements, wall)
    }

    /// Torque of the bed on a wall of triangles in a sample, N m.
    pub(crate) fn torque(&self, sample: &Sample, wall: &str) -> Vector3<f64> {
        self.of_mesh(&sample.torques, wall)
    }

    /// The vector of a wall of triangles, of those of all.
    fn of_mesh(&self, all: &[Vector3<f64>], wall: &str) -> Vector3<f64> {
        let meshes = &self.walls[self.walls.len() - all.len()..];
        let at = meshes.iter().position(|name| name == wall);
        at.map_or_else(Vector3::zeros, |at| all[at])
    }
}

/// A run that has come to the end of its phases.
#[derive(Debug, Clone)]
pub(crate) struct PhasesDone {
    /// The world, for the counts.
    pub(crate) built: Built,
    /// The seeds at the end.
    pub(crate) frame: Frame,
    pub(crate) observables: Vec<ObservableValues>,
    /// The curve of the apparatus.
    pub(crate) curve: Option<Curve>,
    /// Why the last phase does not count as ended.
    pub(crate) doubt: Option<Doubt>,
    /// Times by the clock of filling, of the phases and of reading, s.
    pub(crate) laps_s: [f64; 3],
}

/// Runs the phases of a plan from their start, or from where they were left.
pub(crate) fn run_phases(
    scene: &Scene,
    plan: &Plan,
    built: Built,
    left: Option<Progress>,
    keeper: &mut dyn Keeper,
) -> Result<PhasesDone, Error> {
    let mut watch = Stopwatch::start();
    let device = scene.apparatus.device();
    let mut running = Running::new(scene, built, left)?;
    if !running.is_driven() {
        settle(&mut running, keeper)?;
        running.sample();
        running.drive_since = Some(running.built.world.time());
        begin(&mut running, plan, 1)?;
    }
    let filling = watch.lap();
    let doubt = loop {
        let doubt = until_end(&mut running, plan, keeper)?;
        let next = running.log.phase + 1;
        if doubt.is_some() || next >= plan.phases.len() {
            break doubt;
        }
        begin(&mut running, plan, next)?;
    };
    let moving = watch.lap();
    let (built, log) = (running.built, running.log);
    let start = running.drive_since.unwrap_or(0.0);
    let frame = snapshot(&built, built.world.time() - start);
    let analytic = built.world.walls().iter().map(|wall| wall.name.clone());
    let walls = analytic.chain(built.meshes.iter().map(|mesh| mesh.name.clone()));
    let seen = Seen::new((scene, plan), &frame, &built.bodies, &log, walls.collect());
    let observables = device.observe(&seen)?;
    let curve = device.curve().map(|kind| Curve {
        kind,
        rows: device.read_curve(&seen),
    });
    Ok(PhasesDone {
        built,
        frame,
        observables,
        curve,
        doubt,
        laps_s: [filling, moving, watch.lap()],
    })
}

/// Begins a phase. With the first behind the filling, the walls that the user brings begin to move.
fn begin(running: &mut Running<'_>, plan: &Plan, number: usize) -> Result<(), Error> {
    let phase = &plan.phases[number];
    let built = &mut running.built;
    let start = built.world.time();
    if number == 1 {
        let own = running.scene.apparatus.device().mesh_walls().len();
        for mesh in built.meshes.iter().skip(own) {
            built.world.set_mesh_motion(&mesh.name, &mesh.motion)?;
        }
        if let Some(surroundings) = &mut built.surroundings {
            surroundings.start(start);
        }
    }
    for (wall, motion) in &phase.motions {
        built.world.set_mesh_motion(wall, motion)?;
    }
    for wall in &phase.removed {
        built.world.remove_mesh_wall(wall)?;
    }
    (running.log.phase, running.log.since) = (number, start);
    Ok(())
}

/// Runs until the phase of now ends; the reason if it does not end within its limit.
fn until_end(
    running: &mut Running<'_>,
    plan: &Plan,
    keeper: &mut dyn Keeper,
) -> Result<Option<Doubt>, Error> {
    let scene = running.scene;
    let phase = &plan.phases[running.log.phase];
    let limit = scene.protocol.rotation_limit.si();
    let (shortest, limit) = match phase.end {
        // The time of the world is a sum of steps: half of a sample hides its rounding.
        End::After(time) => (time - 0.5 * plan.interval, f64::INFINITY),
        End::AtRest { after } => (after, limit),
        _ => (0.0, limit),
    };
    let rest = rest_energy(scene, &running.built.world);
    loop {
        let time = running.built.world.time() - running.log.since;
        if time >= limit {
            break;
        }
        running.offer(keeper)?;
        advance(scene, &mut running.built, plan.interval)?;
        running.take_out(&phase.outlets)?;
        running.sample();
        let time = running.built.world.time() - running.log.since;
        if time > shortest && running.has_come_to(&phase.end, rest) {
            return Ok(None);
        }
    }
    Ok(Some(if let Some(doubt) = phase.end.doubt() {
        doubt
    } else if is_driven_by_rolling(scene, &running.built) {
        Doubt::DrivenByRolling
    } else if loads_are_carried(&running.built.world) {
        Doubt::NotAtRest
    } else {
        Doubt::LoadNotCarried
    }))
}

/// Whether the bed carries the load of each wall that has one.
fn loads_are_carried(world: &World) -> bool {
    let walls = world.mesh_walls().zip(world.mesh_loads());
    let carried = |(load, force): (dem_solver::AxialLoad, Vector3<f64>)| {
        (force.dot(&load.axis) + load.force).abs() <= LOAD_CARRIED * load.force.abs()
    };
    walls
        .filter_map(|(wall, (force, _))| Some((wall.motion.load?, force)))
        .all(carried)
}

impl Running<'_> {
    /// Adds a sample of now.
    fn sample(&mut self) {
        let Log { phase, since, .. } = self.log;
        let sample = Sample::of(&self.built.world, phase, since);
        self.log.samples.push(sample);
    }

    /// Whether the phase of now has come to an end other than its limit; its bed rests with a kinetic energy (J) of all seeds.
    fn has_come_to(&self, end: &End, rest: f64) -> bool {
        let world = &self.built.world;
        match end {
            End::After(_) => true,
            End::AtRest { .. } => {
                // A bed that has lost seeds rests at less energy.
                let left = if self.log.passages.is_empty() {
                    1.0
                } else {
                    let all = self.scene.seed_count().max(1);
                    world.bodies().len() as f64 / all as f64
                };
                let rests = world.bodies().is_empty() || world.kinetic_energy() < rest * left;
                rests && loads_are_carried(world)
            }
            End::Pressed { wall, depth } => self.pressed(wall) >= *depth,
            End::Pushed { wall, along, force } => {
                let pushed = self.place_of(wall).zip(self.log.samples.last());
                pushed.is_some_and(|(at, sample)| sample.forces[at].dot(along) >= *force)
            }
            End::Discharged(fraction) => {
                let of_phase = |phase: usize| phase == self.log.phase;
                let taken = self.log.passages.iter().filter(|p| of_phase(p.phase));
                let left: f64 = self.log.samples.last().map_or(0.0, |sample| sample.mass);
                let taken = taken.map(|p| p.mass).sum::<f64>();
                taken >= fraction * (taken + left)
            }
        }
    }

    /// Place of a wall among the forces of a sample.
    fn place_of(&self, wall: &str) -> Option<usize> {
        let world = &self.built.world;
        let names = world.walls().iter().map(|wall| wall.name.as_str());
        let mut names = names.chain(world.mesh_walls().map(|mesh| mesh.name.as_str()));
        names.position(|name| name == wall)
    }

    /// How far a wall of triangles has gone down in the phase of now since the bed first pushed it up, m.
    fn pressed(&self, wall: &str) -> f64 {
        let world = &self.built.world;
        let Some(mesh) = world.mesh_walls().position(|mesh| mesh.name == wall) else {
            return 0.0;
        };
        let place = world.walls().len() + mesh;
        let of_phase = |sample: &&Sample| sample.phase == self.log.phase;
        let mut samples = self.log.samples.iter().filter(of_phase);
        let height = |sample: &Sample| sample.displacements[mesh].y;
        let first = samples.find(|sample| sample.forces[place].y > 0.0);
        let last = self.log.samples.last();
        first
            .zip(last)
            .map_or(0.0, |(first, last)| height(first) - height(last))
    }

    /// Takes out the seeds that have passed an outlet.
    pub(crate) fn take_out(&mut self, outlets: &[Outlet]) -> Result<(), Error> {
        let world = &self.built.world;
        let bodies = world.bodies();
        let gravity = world.settings().gravity;
        let mut gone = Vec::new();
        for k in 0..bodies.len() {
            let passed =
                |outlet: &Outlet| outlet.passed(&bodies.position[k], &bodies.velocity[k], &gravity);
            let Some(ago) = outlets.iter().filter_map(passed).reduce(f64::max) else {
                continue;
            };
            gone.push(k);
            self.log.passages.push(Passage {
                phase: self.log.phase,
                time: (world.time() - ago - self.log.since).max(0.0),
                mass: world.templates()[bodies.template[k]].mass(),
            });
        }
        self.built.remove(&gone)
    }
}

#[cfg(test)]
mod tests {
    use super::Outlet;
    use nalgebra::Vector3;

    /// A seed that fell from 20 mm above an outlet is seen 5 mm below it: it passed sqrt(2 h/g) after its start, to rounding. One that
    /// rises back through the plane passed just now, and one above it has not passed.
    #[test]
    fn the_time_of_a_passage_is_that_of_the_fall() {
        let (outlet, gravity) = (Outlet::below(-0.01), Vector3::y() * -9.81);
        let fall = |height: f64| (2.0 * height / 9.81_f64).sqrt();
        let at = |y: f64, v: f64| outlet.passed(&(Vector3::y() * y), &(Vector3::y() * v), &gravity);
        let ago = at(-0.015, -9.81 * fall(0.025)).unwrap();
        assert!((ago - (fall(0.025) - fall(0.02))).abs() < 1e-12, "{ago} s");
        assert_eq!(at(-0.015, 0.1), Some(0.0));
        assert_eq!(at(-0.009, -1.0), None);
    }
}
