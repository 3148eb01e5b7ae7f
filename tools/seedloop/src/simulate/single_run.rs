//! One run of a scene as a record that the store can keep.

use campaign::run_store::Record;
use campaign::{PreparedRun as _, RunRequest, Simulator as _};
use scene::{Keeper, Progress, RunResult, Scene, run_retrying};
use simulators::scene_simulator::{Effort, SceneSimulator, outcome_of};
use std::collections::BTreeMap;
use std::time::Instant;

/// Name of the scene in its simulator.
const MODEL: &str = "scene";

/// A scene with its seed, ready to be run.
#[derive(Debug)]
pub(super) struct SingleRun {
    scene: Scene,
    /// The scene without what its run does not depend on.
    scene_as_run: Scene,
    /// The record without results.
    blank: Record,
    /// Makes the bodies.
    simulator: SceneSimulator,
}

impl SingleRun {
    /// Prepares a run.
    ///
    /// # Errors
    /// A mesh that cannot be read; a scene with a number that is not finite.
    pub(super) fn new(scene: Scene, seed: u64) -> anyhow::Result<Self> {
        let scenes = BTreeMap::from([(MODEL.to_owned(), scene.clone())]);
        let simulator = SceneSimulator::new(scenes, BTreeMap::new())?;
        let run = simulator.prepare_scene(&RunRequest::new(MODEL, seed))?;
        let blank = Record::new(&simulator.version(), run.inputs()?, seed)?;
        let scene_as_run = run.into_scene();
        Ok(Self {
            scene,
            scene_as_run,
            blank,
            simulator,
        })
    }

    /// The scene as it was read.
    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The record without results: its key is made of all that the run depends on.
    pub(super) fn blank_record(&self) -> &Record {
        &self.blank
    }

    /// Runs the scene on at most so many threads, on from where it was left, and again with half the step if it diverges,
    /// at most so often; the time of filling the meshes is kept apart from that of the steps. Gives the record and the run.
    ///
    /// # Errors
    /// A scene that cannot be built, a solver that stops, frames without a surface.
    pub(super) fn run(
        &self,
        (threads, retries): (usize, u32),
        left: Option<Progress>,
        keeper: &mut dyn Keeper,
    ) -> anyhow::Result<(Record, RunResult)> {
        let scene = &self.scene_as_run;
        let library = self.simulator.fillings();
        let begin = Instant::now();
        for seed in &scene.seed {
            library.body(scene, seed)?;
        }
        let filling_s = begin.elapsed().as_secs_f64();
        let (begin, cpu_before) = (Instant::now(), cpu_seconds());
        let continued = left.is_some();
        let seed = self.blank.seed();
        let result = run_retrying(scene, library, seed, threads, left, keeper, retries)?;
        let effort = Effort {
            wall_s: begin.elapsed().as_secs_f64(),
            cpu_s: cpu_seconds()
                .zip(cpu_before)
                .map(|(after, before)| after - before),
            filling_s: Some(filling_s),
            continued,
            only_seen: false,
        };
        let outcome = outcome_of(scene, &result, effort)?;
        let blank = self.blank.clone();
        let record = blank
            .with_observables(outcome.observables)?
            .with_regime(outcome.regime)
            .with_details(outcome.details);
        Ok((record, result))
    }
}

/// Time that all threads of this process have worked, those that have ended included, s; `None` if the system does
/// not tell.
///
/// Linux gives the times outside and inside the kernel in hundredths of a second, behind eleven words after
/// the name of the program, which is in brackets.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, words) = text.rsplit_once(')')?;
    let mut words = words.split_whitespace().skip(11);
    let mut next = || words.next()?.parse::<f64>().ok();
    let hundredths = next()? + next()?;
    Some(hundredths * 1e-2)
}
