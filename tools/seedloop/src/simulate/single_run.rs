//! One run of a scene as a record that the store can keep.

use command_line::file_sha256;
use run_store::Record;
use scene::{Keeper, Progress, Scene};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Instant;
use study::{SceneSimulator, outcome_of};

/// A scene with its seed, ready to be run.
#[derive(Debug)]
pub(super) struct SingleRun {
    /// The scene.
    scene: Scene,
    /// Seed of its randomness.
    seed: u64,
    /// Bodies, and the version of code, scene and meshes.
    simulator: SceneSimulator,
}

impl SingleRun {
    /// Prepares a run.
    ///
    /// # Errors
    /// A mesh that cannot be read.
    pub(super) fn new(scene: Scene, seed: u64) -> anyhow::Result<Self> {
        let scenes = BTreeMap::from([("scene".to_owned(), scene.clone())]);
        Ok(Self {
            scene,
            seed,
            simulator: SceneSimulator::new(scenes)?,
        })
    }

    /// The scene as it is run.
    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The record without results: its key is made of all that the run depends on.
    ///
    /// # Errors
    /// A scene with a number that is not finite, a mesh that cannot be read.
    pub(super) fn blank_record(&self) -> anyhow::Result<Record> {
        let mut meshes = BTreeMap::new();
        for mesh in self.scene.mesh_files() {
            let digest = file_sha256(&self.scene.folder.join(mesh))?;
            meshes.insert(mesh.display().to_string(), digest);
        }
        let inputs = json!({ "scene": self.scene, "meshes": meshes });
        let version = campaign::Simulator::version(&self.simulator);
        Ok(Record::new(&version, inputs, self.seed)?)
    }

    /// Runs the scene on at most so many threads, on from where it was left; the time of filling the
    /// meshes is kept apart from that of the steps.
    ///
    /// # Errors
    /// A scene that cannot be built, a solver that stops, frames without a surface.
    pub(super) fn run(
        &self,
        blank: Record,
        threads: usize,
        left: Option<Progress>,
        keeper: &mut dyn Keeper,
    ) -> anyhow::Result<Record> {
        let (scene, library) = (&self.scene, self.simulator.fillings());
        let begin = Instant::now();
        for seed in &scene.seed {
            library.body(scene, seed)?;
        }
        let filling_s = begin.elapsed().as_secs_f64();
        let (begin, cpu_before) = (Instant::now(), cpu_seconds());
        let continued = left.is_some();
        let result = scene::run_on(scene, library, self.seed, threads, left, keeper)?;
        let wall_s = begin.elapsed().as_secs_f64();
        let cpu_s = cpu_seconds()
            .zip(cpu_before)
            .map(|(after, before)| after - before);
        let mut outcome = outcome_of(scene, &result, wall_s)?;
        if let Some(timing) = outcome
            .details
            .get_mut("timing")
            .and_then(Value::as_object_mut)
        {
            if continued {
                // The times are those of the last part alone: they tell no cost of a step.
                for rate in ["us_per_step", "sphere_steps_per_s"] {
                    timing.insert(rate.to_owned(), Value::Null);
                }
                timing.insert("continued".to_owned(), json!(true));
            }
            timing.insert("threads".to_owned(), json!(result.n_threads));
            timing.insert("cpu_s".to_owned(), json!(cpu_s));
            timing.insert("filling_s".to_owned(), json!(filling_s));
        }
        Ok(blank
            .with_observables(outcome.observables)?
            .with_details(outcome.details))
    }
}

/// Time that all threads of this process have worked, those that have ended included, s; none where the system does
/// not tell.
///
/// Linux gives the times outside and inside the kernel in hundredths of a second, behind eleven words after
/// the name of the program, which stands in brackets.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, words) = text.rsplit_once(')')?;
    let mut words = words.split_whitespace().skip(11);
    let mut next = || words.next()?.parse::<f64>().ok();
    let hundredths = next()? + next()?;
    Some(hundredths * 1e-2)
}
