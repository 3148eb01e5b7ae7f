//! One run: fill, settle, rotate until steady, take frames, measure.

use crate::apparatus::Apparatus;
use crate::bed_motion::{BedMotion, MotionEvidence, mean};
use crate::bench::run_bench;
use crate::build::{Built, assemble, build, build_filled, seed_bodies};
use crate::driven_pile::is_driven_by_rolling;
use crate::flow::{avalanche_period, fill_level, flowing_layer};
use crate::keeper::{Keeper, NoKeeper};
use crate::motion::{
    Progress, Rotation, Running, SERIES_INTERVAL, rotate, settle, snapshot, start_drive,
};
use crate::obstacles::mesh_walls;
use crate::phase_times::{PhaseTimes, Stopwatch};
use crate::phases::{Plan, run_phases};
use crate::series::SeriesPoint;
use crate::steady::SteadyState;
use crate::{
    Curve, Doubt, DrumCamera, Error, FillingLibrary, Frame, FrameReading, Scene, SeedBody,
    read_frame,
};
use dem_solver::{Census, Placement, World};
use geometry::clump::Sphere;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;
use surface_profile::{DensitySettings, Disc, DrumCircle, measure, profile_from_discs};

/// Gap that ends the group of seeds at the rim of the metering device, in seed lengths.
const GROUP_GAP: f64 = 1.5;

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

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// All repeats of a bench test were done.
    Tested,
    /// All phases came to their end and the seeds to rest before the limit, or why they do not count as at rest.
    Rested(Option<Doubt>),
    /// The drive turned: what is kept of it.
    Turned(SteadyState),
}

impl Ending {
    /// Whether what is kept may be taken for a steady state, or for rest; none for a bench test, which has no such
    /// state.
    pub fn is_steady(&self) -> Option<bool> {
        match self {
            Self::Tested => None,
            Self::Rested(doubt) => Some(doubt.is_none()),
            Self::Turned(state) => Some(state.doubt.is_none()),
        }
    }

    /// Why the bed is neither steady nor at rest; `None` if it is, and in a bench test.
    pub fn doubt(&self) -> Option<Doubt> {
        match self {
            Self::Tested => None,
            Self::Rested(doubt) => *doubt,
            Self::Turned(state) => state.doubt,
        }
    }

    /// Number of values of the series before what is kept.
    pub fn cut(&self) -> usize {
        match self {
            Self::Turned(state) => state.cut,
            _ => 0,
        }
    }
}

/// The values of an observable, whose mean counts.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservableValues {
    /// Name, with the unit at its end.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: &'static str,
    /// Values.
    pub values: Vec<f64>,
}

impl ObservableValues {
    /// Names some values.
    pub(crate) fn new(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        values: Vec<f64>,
    ) -> Self {
        let name = name.into();
        Self { name, unit, values }
    }
}

/// Result of a run.
#[derive(Debug, Clone)]
pub struct RunResult {
    /// The bed over time.
    pub series: Vec<SeriesPoint>,
    /// How the run ended.
    pub ending: Ending,
    /// Frames in the steady state.
    pub frames: Vec<Frame>,
    /// Reading of each frame; none for the metering device, whose surface is not a drum's.
    pub readings: Vec<FrameReading>,
    /// Filling angle by the picture of each frame in which it could be read, rad; metering device only.
    pub filling_angles: Vec<f64>,
    /// Observables beside the angle.
    pub observables: Vec<ObservableValues>,
    /// The curve of an apparatus with phases; `None` of one that gives none.
    pub curve: Option<Curve>,
    /// How the bed moves; none in a bench test, which has no bed.
    pub regime: Option<Regime>,
    /// The form of its motion in a turning drum; none elsewhere.
    pub motion: Option<BedMotion>,
    /// Time step while the seeds settled, s.
    pub settling_time_step: f64,
    /// Time step while the drive ran, s.
    pub time_step: f64,
    /// Steps done.
    pub n_steps: u64,
    /// Threads that the steps were spread over.
    pub n_threads: usize,
    /// Number of bodies.
    pub n_bodies: usize,
    /// Number of spheres, hidden ones included.
    pub n_spheres: usize,
    /// Contact lists at the end.
    pub census: Census,
    /// The bodies of the seeds, by kind.
    pub bodies: Vec<Arc<SeedBody>>,
    /// Why attempts with longer time steps broke off, each with half the step of the one before.
    pub broken_off: Vec<String>,
    /// Where the time went; that of the last attempt.
    pub phases: PhaseTimes,
}

/// Runs a scene with a seed of its randomness.
///
/// # Errors
///
/// A scene that cannot be built, a solver that stops, frames that cannot be drawn.
pub fn run(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<RunResult, Error> {
    run_on(scene, library, seed, 1, None, &mut NoKeeper)
}

/// [`run`] with the steps spread over at most so many threads (one for each 500 bodies) until the keeper gives another number, from
/// where a run of the same scene and seed was left, with its state kept on the way.
///
/// The result is the same to the last bit for any number of threads, and as that of a run that was never left. A bench
/// test always starts from its beginning and keeps no state.
///
/// # Errors
///
/// As [`run`]; threads that cannot be had; a state that is of another scene, or that cannot be kept; a keeper that ends
/// the run.
pub fn run_on(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
    threads: usize,
    left: Option<Progress>,
    keeper: &mut dyn Keeper,
) -> Result<RunResult, Error> {
    let mut watch = Stopwatch::start();
    if let Some(tested) = run_bench(scene, library, seed)? {
        return Ok(tested);
    }
    let mut built = build(scene, library, seed)?;
    built.set_threads(scene, threads)?;
    let mut phases = PhaseTimes {
        building_s: watch.lap(),
        ..PhaseTimes::default()
    };
    if let Some(plan) = scene.apparatus.device().plan(scene) {
        return in_phases(scene, &plan, (built, phases), left, keeper);
    }
    let mut running = Running::new(scene, built, left)?;
    if !running.is_driven() {
        settle(&mut running, keeper)?;
    }
    phases.settling_s = watch.lap();
    let Rotation {
        series,
        frames,
        mut state,
        start_up_s,
    } = rotate(&mut running, keeper)?;
    if is_driven_by_rolling(scene, &running.built) {
        state.doubt = Some(Doubt::DrivenByRolling);
    }
    phases.start_up_s = start_up_s;
    phases.measuring_s = watch.lap() - start_up_s;
    let built = running.built;
    let bodies = &built.bodies;
    let readings = readings_of(scene, bodies, &frames)?;
    let filling_angles = filling_angles(scene, bodies, &frames)?;
    phases.reading_s = watch.lap();
    let steady = &series[state.cut..];
    let evidence = evidence(scene, steady, &readings);
    let motion = BedMotion::of(&evidence);
    let mut observables = bed_observables(scene, bodies, &frames, steady);
    observables.extend(motion_observables(&evidence));
    observables.extend(filling_angle_by_position(scene, bodies, &frames));
    observables.extend(cover_angles(scene, bodies, &frames));
    if let Some(bonds) = &built.bonds {
        let broken = bonds.n_broken() as f64;
        observables.push(ObservableValues::new("broken_bonds", "1", vec![broken]));
    }
    Ok(RunResult {
        series,
        readings,
        filling_angles,
        regime: Some(motion.regime()),
        motion: Some(motion),
        settling_time_step: built.time_steps.settling,
        ..RunResult::of_world(
            scene,
            built,
            (Ending::Turned(state), frames),
            observables,
            phases,
        )
    })
}

/// What the camera of a scene sees in each frame of a drum, and what it reads.
fn readings_of(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
) -> Result<Vec<FrameReading>, Error> {
    if !matches!(scene.apparatus, Apparatus::Drum(_)) {
        return Ok(Vec::new());
    }
    let read = |frame| read_frame(scene, bodies, frame);
    frames.iter().map(read).collect()
}

/// Filling angles that the camera of a scene sees: from the lowest end of the board to the top of the bed at the rim, rad;
/// none elsewhere than in a metering device.
fn filling_angles(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
) -> Result<Vec<f64>, Error> {
    let Apparatus::Metering(device) = &scene.apparatus else {
        return Ok(Vec::new());
    };
    let mut angles = Vec::new();
    for frame in frames {
        let photo = read_frame(scene, bodies, frame)?.photo;
        let board = device.board_angle.si();
        let top = photo.ends().map(|[_, top]| top);
        angles.extend(top.map(|top| (top - board).rem_euclid(TAU)));
    }
    Ok(angles)
}

/// The same from the places of the seeds, deg.
fn filling_angle_by_position(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
) -> Option<ObservableValues> {
    let Apparatus::Metering(device) = &scene.apparatus else {
        return None;
    };
    let radius = scene.apparatus.radius();
    let lengths = bodies.iter().map(|b| b.clump.bounding_radius());
    let gap = GROUP_GAP * 2.0 * lengths.fold(0.0, f64::max) / radius;
    let of_frame = |frame| {
        let at_rim = angles_at_rim(bodies, frame, radius);
        device.filling_angle(&at_rim, gap).to_degrees()
    };
    let name = "filling_angle_by_position_deg";
    Some(ObservableValues::new(
        name,
        "deg",
        frames.iter().map(of_frame).collect(),
    ))
}

impl RunResult {
    /// What each run of a bed has, from where its world ended.
    fn of_world(
        scene: &Scene,
        built: Built,
        (ending, frames): (Ending, Vec<Frame>),
        observables: Vec<ObservableValues>,
        phases: PhaseTimes,
    ) -> Self {
        let Built { world, bodies, .. } = built;
        Self {
            series: Vec::new(),
            ending,
            frames,
            readings: Vec::new(),
            filling_angles: Vec::new(),
            observables,
            curve: None,
            regime: None,
            motion: None,
            settling_time_step: world.settings().time_step,
            time_step: world.settings().time_step,
            n_steps: world.n_steps(),
            n_threads: world.n_threads(),
            n_bodies: world.bodies().len(),
            n_spheres: n_spheres(scene, &bodies),
            census: world.census(),
            bodies,
            broken_off: scene.protocol.broken_off.clone(),
            phases,
        }
    }

    /// The same run seen by the camera of another scene, which differs from the scene of the run in
    /// nothing else.
    ///
    /// # Errors
    ///
    /// Frames that cannot be drawn.
    pub fn seen_in(&self, scene: &Scene) -> Result<Self, Error> {
        let mut watch = Stopwatch::start();
        Ok(Self {
            readings: readings_of(scene, &self.bodies, &self.frames)?,
            filling_angles: filling_angles(scene, &self.bodies, &self.frames)?,
            phases: PhaseTimes {
                reading_s: watch.lap(),
                ..PhaseTimes::default()
            },
            ..self.clone()
        })
    }
}

/// A run in phases.
fn in_phases(
    scene: &Scene,
    plan: &Plan,
    (built, mut phases): (Built, PhaseTimes),
    left: Option<Progress>,
    keeper: &mut dyn Keeper,
) -> Result<RunResult, Error> {
    let result = run_phases(scene, plan, built, left, keeper)?;
    [phases.settling_s, phases.measuring_s, phases.reading_s] = result.laps_s;
    let end = (Ending::Rested(result.doubt), vec![result.frame]);
    Ok(RunResult {
        curve: result.curve,
        regime: Some(Regime::Resting),
        ..RunResult::of_world(scene, result.built, end, result.observables, phases)
    })
}

/// Number of spheres of all seeds, hidden ones included.
fn n_spheres(scene: &Scene, bodies: &[Arc<SeedBody>]) -> usize {
    let kinds = scene.seed.iter().zip(bodies);
    kinds
        .map(|(s, b)| scene.count_of(s) * b.clump.spheres().len())
        .sum()
}

/// Measures that determine the form of the motion of a bed.
fn evidence(scene: &Scene, steady: &[SeriesPoint], readings: &[FrameReading]) -> MotionEvidence {
    let apparatus = &scene.apparatus;
    let shapes = readings.iter().filter_map(|r| r.photo.angle());
    MotionEvidence::of(
        steady,
        apparatus.froude_number(scene.model.gravity_m_s2),
        mean(shapes.map(|a| a.s_shape)),
        |time| apparatus.speed() * apparatus.device().share_of_speed(time).unwrap_or(1.0),
    )
}

/// The same as observables.
fn motion_observables(evidence: &MotionEvidence) -> [ObservableValues; 3] {
    let list = |value: Option<f64>| value.into_iter().collect();
    [
        ObservableValues::new("carried_share", "1", vec![evidence.carried_share]),
        ObservableValues::new("waiting_time_s", "s", list(evidence.waiting_time)),
        ObservableValues::new("airborne_share", "1", list(evidence.airborne_share)),
    ]
}

/// Observables of a drum beside the angles.
fn bed_observables(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
    steady: &[SeriesPoint],
) -> Vec<ObservableValues> {
    let power = steady.iter().map(|p| 1e3 * p.drive_power_w).collect();
    let mut all = vec![ObservableValues::new("drive_power_mw", "mW", power)];
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
    all.push(ObservableValues::new(
        "flowing_layer_depth_mm",
        "mm",
        depths,
    ));
    all.push(ObservableValues::new("surface_speed_mm_s", "mm/s", speeds));
    all.push(ObservableValues::new(
        "fill_level_by_position",
        "1",
        fills.collect(),
    ));
    all.push(ObservableValues::new(
        "avalanche_period_s",
        "s",
        period.into_iter().collect(),
    ));
    all
}

/// Angles of the trace that the bed leaves at the lower cover of a tilted drum, deg: that of the spheres within their diameter
/// of the cover, read by the rule of a whole bed ([`surface_profile::profile_from_discs`]). None in a level drum.
fn cover_angles(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frames: &[Frame],
) -> Option<ObservableValues> {
    let side = scene.apparatus.device().lower_cover()?;
    let cover = 0.5 * side * scene.apparatus.width();
    let drum = DrumCamera::of(scene).circle();
    let of_frame = |frame: &Frame| trace_at(cover, frame.spheres(bodies).map(|(_, s)| s), &drum);
    let angles = frames.iter().filter_map(of_frame);
    let angles = angles.map(f64::to_degrees).collect();
    Some(ObservableValues::new("cover_angle_deg", "deg", angles))
}

/// Angle of the trace of spheres within their diameter of a cover (z, m), rad; none if they show none.
fn trace_at(cover: f64, spheres: impl Iterator<Item = Sphere>, drum: &DrumCircle) -> Option<f64> {
    let near = spheres.filter(|s| (cover - s.centre.z).abs() < 2.0 * s.radius);
    let discs: Vec<Disc> = near
        .map(|s| Disc {
            x: s.centre.x,
            y: s.centre.y,
            radius: s.radius,
        })
        .collect();
    let points = profile_from_discs(&discs, drum, &DensitySettings::for_drum(drum)).ok()?;
    Some(measure(&points, drum).ok()?.line)
}

/// Where the seeds of a scene start, their bodies, and the time step of the solver (s). A bed that is poured starts without seeds.
///
/// # Errors
///
/// A scene that cannot be built.
pub fn starting_frame(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
) -> Result<(Frame, Vec<Arc<SeedBody>>, f64), Error> {
    let built = if scene.apparatus.device().needs_insertion_rate() {
        build(scene, library, seed)?
    } else {
        build_filled(scene, library, seed)?
    };
    let frame = snapshot(&built, 0.0);
    Ok((frame, built.bodies, built.world.settings().time_step))
}

/// The solver's world of a scene, for callers that step it themselves: the drive runs, and the
/// seeds are where `placements` has them; a template of a placement is a kind of seed.
///
/// # Errors
///
/// A scene that cannot be built or has bonded seeds, a seed outside the apparatus.
pub fn running_world(
    scene: &Scene,
    library: &FillingLibrary,
    placements: &[Placement],
) -> Result<World, Error> {
    refuse_bonds(scene)?;
    scene.require_bed()?;
    let bodies = seed_bodies(scene, library)?;
    let mut built = assemble(scene, bodies, mesh_walls(scene)?, placements)?;
    start_drive(scene, &mut built)?;
    Ok(built.world)
}

/// The solver's world of a scene after the seeds have settled, with the drive running.
///
/// # Errors
///
/// A scene that cannot be built or has bonded seeds, a solver that stops.
pub fn settled_world(scene: &Scene, library: &FillingLibrary, seed: u64) -> Result<World, Error> {
    refuse_bonds(scene)?;
    let mut running = Running::new(scene, build(scene, library, seed)?, None)?;
    settle(&mut running, &mut NoKeeper)?;
    let mut built = running.built;
    start_drive(scene, &mut built)?;
    Ok(built.world)
}

/// Refuses bonded seeds, which a world alone does not hold together.
fn refuse_bonds(scene: &Scene) -> Result<(), Error> {
    match scene.model.bonds {
        None => Ok(()),
        Some(_) => Err(Error::BadValue {
            name: "model.bonds".into(),
            value: "stated".into(),
            requirement: "absent where the caller steps the solver itself".into(),
        }),
    }
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

#[cfg(test)]
mod tests {
    use super::trace_at;
    use geometry::clump::Sphere;
    use nalgebra::Vector3;
    use surface_profile::DrumCircle;

    /// Spheres of 1 mm on a lattice of 2 mm in a drum of 50 mm radius, below a line through its axis at an angle, in a layer.
    fn layer(degrees: f64, z: f64) -> Vec<Sphere> {
        let slope = degrees.to_radians().tan();
        let lattice = (-24..=24).flat_map(|i| (-24..=24).map(move |j| (i, j)));
        let places =
            lattice.map(|(i, j)| Vector3::new(2e-3 * f64::from(i), 2e-3 * f64::from(j), z));
        let inside = places.filter(|p| p.x.hypot(p.y) < 0.049 && p.y < slope * p.x);
        inside
            .map(|centre| Sphere {
                centre,
                radius: 1e-3,
            })
            .collect()
    }

    /// A bed that lies at 20 deg before the front and at 40 deg before the back: each cover shows its own. A lattice of 2 mm on a chord
    /// of 100 mm moves the line by a degree at most.
    #[test]
    fn a_cover_shows_the_layer_before_it() {
        let drum = DrumCircle {
            x: 0.0,
            y: 0.0,
            radius: 0.05,
        };
        let bed = || {
            [layer(20.0, 0.009), layer(40.0, -0.009)]
                .concat()
                .into_iter()
        };
        for (cover, angle) in [(0.01, 20.0), (-0.01, 40.0)] {
            let found = trace_at(cover, bed(), &drum).unwrap().to_degrees();
            assert!((found - angle).abs() < 1.0, "{found} for {angle}");
        }
        assert_eq!(
            trace_at(0.0, bed(), &drum),
            None,
            "no sphere touches the middle"
        );
    }
}
