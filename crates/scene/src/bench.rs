//! Bench tests of one kind of seed: what they take from a scene, and what their run gives.
//!
//! Three tests as the study did them `[CottonStudy, section 2.2]`: a drop on a plate (restitution from
//! heights), a sled of glued seeds (static friction), a tilted plate (rolling friction as the tangent
//! of the angle at which a seed starts to roll). What a whole agglomerate shows is held against what was
//! put into its spheres.

mod drop;
mod plate;
mod slider;
mod tilt;

use crate::apparatus::{Apparatus, BenchTest};
use crate::interactions::interactions;
use crate::phase_times::{PhaseTimes, Stopwatch};
use crate::run::{Ending, RunResult};
use crate::time_step::TimeSteps;
use crate::{Error, FillingLibrary, ObservableValues, Scene, SeedBody, SeedSettings};
use dem_solver::{Census, Interaction, Settings, Template, World};
use geometry::clump::Sphere;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// A seed, and how it meets its like and a plate.
#[derive(Debug)]
struct BenchParts {
    /// Name of the kind of seed.
    name: String,
    body: Arc<SeedBody>,
    /// The seed as a body type of material 0.
    template: Template,
    /// Its bounding radius, m.
    radius: f64,
    /// Interactions of the materials seed (0) and plate (1), row by row.
    interactions: Vec<Interaction>,
    /// Time step that resolves the contacts, s.
    time_step: f64,
    /// Gravity, m/s².
    gravity: f64,
    /// Whether the plate is covered with seeds.
    on_seeds: bool,
    /// Mass of the seed over that of a plate of seeds that gives way; 0 for a rigid one.
    plate_give: f64,
}

impl BenchParts {
    /// What a test takes from its scene. A plate with the material of the seeds is a plate of seeds.
    ///
    /// # Errors
    ///
    /// A seed that the scene does not define or that cannot be made, contacts out of range.
    fn new(scene: &Scene, library: &FillingLibrary, test: BenchTest<'_>) -> Result<Self, Error> {
        let kind = scene.tested_seed(test)?;
        let body = library.body(scene, kind)?;
        let single = Scene {
            seed: vec![kind.clone()],
            ..scene.clone()
        };
        let bodies = std::slice::from_ref(&body);
        let steps = TimeSteps::of(&single, bodies)?;
        Ok(Self {
            name: kind.name.clone(),
            template: scene.model.template(&body.clump, 0),
            interactions: interactions(&single, bodies, &[&kind.material, test.plate])?,
            radius: body.clump.bounding_radius(),
            body,
            time_step: steps.settling / scene.apparatus.finer(),
            gravity: scene.model.gravity_m_s2,
            on_seeds: test.plate == kind.material,
            plate_give: match &scene.apparatus {
                Apparatus::Drop(test) => test.plate_give,
                _ => 0.0,
            },
        })
    }

    /// Settings of the solver: no gravity, which each test adds as the weight of its body.
    fn solver_settings(&self) -> Settings {
        let spheres = self.body.clump.spheres().iter();
        let radius = spheres.map(|s| s.radius).fold(f64::INFINITY, f64::min);
        Settings {
            time_step: self.time_step,
            gravity: Vector3::zeros(),
            skin: 0.45 * radius,
            margin: 4.5 * radius,
        }
    }

    /// Weight of the seed, N.
    fn weight(&self) -> f64 {
        self.body.clump.mass() * self.gravity
    }

    /// Spheres at the surface of the seed about its centre of mass, turned.
    fn turned(&self, turn: &UnitQuaternion<f64>) -> Vec<Sphere> {
        let spheres = self.body.outer.spheres().iter();
        spheres
            .map(|s| Sphere {
                centre: turn * s.centre,
                radius: s.radius,
            })
            .collect()
    }

    /// Whether body 0, the seed, has too little energy to rise by a hundredth of its size; a plate of seeds has
    /// next to none.
    fn is_at_rest(&self, world: &World) -> bool {
        world.kinetic_energy() < 0.01 * self.weight() * self.radius
    }

    /// Lowest point of body 0, the seed, m.
    fn lowest(&self, world: &World) -> f64 {
        let bodies = world.bodies();
        let spheres = self.body.outer.spheres().iter();
        spheres
            .map(|s| (bodies.position[0] + bodies.orientation[0] * s.centre).y - s.radius)
            .fold(f64::INFINITY, f64::min)
    }
}

/// One repeat of a test.
#[derive(Debug, Clone, Copy)]
struct Repeat {
    /// The coefficient that it shows.
    shown: f64,
    /// Whether the seed slid instead of rolling; tilt only.
    slid: bool,
    /// Seeds before it that did not start at all; tilt only.
    n_held: usize,
    /// Steps done.
    n_steps: u64,
    /// Number of bodies.
    n_bodies: usize,
    /// Number of spheres that can touch.
    n_spheres: usize,
    /// Contact lists at the end.
    census: Census,
}

impl Repeat {
    /// What a repeat showed in its world.
    fn new(shown: f64, slid: bool, world: &World) -> Self {
        let templates = world.bodies().template.iter();
        Self {
            shown,
            slid,
            n_held: 0,
            n_steps: world.n_steps(),
            n_bodies: world.bodies().len(),
            n_spheres: templates
                .map(|&t| world.templates()[t].n_outer_spheres())
                .sum(),
            census: world.census(),
        }
    }
}

/// Runs the bench test of a scene; `None` if its apparatus is not a bench test.
///
/// # Errors
///
/// A scene that cannot be built, a solver that stops, a repeat that does not come to its end.
pub(crate) fn run_bench(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
) -> Result<Option<RunResult>, Error> {
    let Some(test) = scene.apparatus.device().bench_test() else {
        return Ok(None);
    };
    let mut watch = Stopwatch::start();
    let parts = BenchParts::new(scene, library, test)?;
    let building_s = watch.lap();
    let (name, repeats) = match &scene.apparatus {
        Apparatus::Drop(test) => (
            "shown_restitution",
            drop::drop(&parts, test.height.si(), test.repeats, seed)?,
        ),
        Apparatus::Tilt(test) => (
            "shown_rolling_friction",
            tilt::tilt(&parts, test.repeats, seed)?,
        ),
        _ => (
            "shown_static_friction",
            slider::slider(&parts, test.repeats, seed)?,
        ),
    };
    let shown = repeats.iter().map(|r| r.shown).collect();
    let mut observables = vec![ObservableValues::new(name, "1", shown)];
    if matches!(scene.apparatus, Apparatus::Tilt(_)) {
        let slid = repeats.iter().map(|r| f64::from(u8::from(r.slid)));
        observables.push(ObservableValues::new("slid_share", "1", slid.collect()));
        let held = repeats.iter().flat_map(|r| {
            let before = std::iter::repeat_n(1.0, r.n_held);
            before.chain([0.0])
        });
        observables.push(ObservableValues::new("held_share", "1", held.collect()));
    }
    let last = repeats.last();
    Ok(Some(RunResult {
        series: Vec::new(),
        ending: Ending::Tested,
        frames: Vec::new(),
        readings: Vec::new(),
        filling_angles: Vec::new(),
        observables,
        curve: None,
        regime: None,
        motion: None,
        settling_time_step: parts.time_step,
        time_step: parts.time_step,
        n_steps: repeats.iter().map(|r| r.n_steps).sum(),
        n_threads: 1,
        n_bodies: last.map_or(0, |r| r.n_bodies),
        n_spheres: last.map_or(0, |r| r.n_spheres),
        census: last.map_or_else(Census::default, |r| r.census),
        bodies: vec![parts.body],
        broken_off: scene.protocol.broken_off.clone(),
        phases: PhaseTimes {
            building_s,
            measuring_s: watch.lap(),
            ..PhaseTimes::default()
        },
    }))
}

impl Apparatus {
    /// How much finer than its seeds in a bed a bench test is stepped; 1 for a bed. Why so much, each test says
    /// (docs/time-step.md).
    pub fn finer(&self) -> f64 {
        match self {
            Self::Drop(_) => drop::FINER,
            Self::Slider(_) => slider::FINER,
            Self::Tilt(_) => tilt::FINER,
            _ => 1.0,
        }
    }
}

impl Scene {
    /// Makes everything that a run begins with, and runs nothing: the bodies of the seeds, their places in the
    /// apparatus (with seed 1), laws and time step, or the parts of a bench test.
    ///
    /// # Errors
    ///
    /// Seeds that cannot be made or are too many for the room, walls that cannot be read, a time step that
    /// does not resolve a contact.
    pub fn build_check(&self, library: &FillingLibrary) -> Result<(), Error> {
        match self.apparatus.device().bench_test() {
            Some(test) => BenchParts::new(self, library, test).map(|_| ()),
            // Where a factory makes the seeds, there is room when each comes, or the run says so.
            None => crate::build::build(self, library, 1).map(|_| ()),
        }
    }

    /// The kind of seed of a bench test: the first if the apparatus names none.
    ///
    /// # Errors
    ///
    /// A name that no kind has.
    pub(crate) fn tested_seed(&self, test: BenchTest<'_>) -> Result<&SeedSettings, Error> {
        let names = || self.seed.iter().map(|s| s.name.as_str());
        let mut kinds = self.seed.iter();
        let found = kinds.find(|s| test.seed.is_none_or(|name| s.name == name));
        found.ok_or_else(|| Error::Undefined {
            file: self.file.clone(),
            what: "seed",
            name: test.seed.unwrap_or("the first of [[seed]]").into(),
            known: names().collect::<Vec<_>>().join(", "),
        })
    }

    /// Refuses what only a bed of seeds can be asked for.
    pub(crate) fn require_bed(&self) -> Result<(), Error> {
        if self.apparatus.device().bench_test().is_none() {
            return Ok(());
        }
        Err(Error::BadValue {
            name: format!("{}: apparatus.kind", self.file),
            value: "a bench test".into(),
            requirement:
                "a drum, a metering device, a heap or a box: a bench test holds no bed of seeds"
                    .into(),
        })
    }
}
