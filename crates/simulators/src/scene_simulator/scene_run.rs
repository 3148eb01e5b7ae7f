//! A scene that is ready to be run: its key, its cost and its run.

use crate::scene_simulator::cost::expected_cost;
use crate::scene_simulator::outcome::outcome_of;
use crate::scene_simulator::{Effort, SceneSimulator};
use campaign::{Cores, PreparedRun, RunOutcome, SimulatorError};
use scene::Scene;
use serde_json::{Value, json};
use std::time::Instant;

/// A scene that is ready to be run.
#[derive(Debug)]
pub struct SceneRun<'s> {
    pub(super) simulator: &'s SceneSimulator,
    /// The scene of the request without what its run does not depend on.
    pub(super) scene: Scene,
    pub(super) seed: u64,
    /// How many times as large as in the scene the seeds are.
    pub(super) coarseness: f64,
}

impl SceneRun<'_> {
    /// The scene of the request without what its run does not depend on: what is run, and what the key is made of.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Its scene, for a caller that runs it itself.
    pub fn into_scene(self) -> Scene {
        self.scene
    }
}

impl PreparedRun for SceneRun<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        let scene = self.simulator.by_content(self.scene.clone())?;
        let settings = serde_json::to_value(&scene).map_err(SimulatorError::other)?;
        Ok(json!({ "scene": settings }))
    }

    fn cost(&self) -> f64 {
        // Coarser seeds take fewer steps too: the stable one grows with the diameter.
        expected_cost(&self.scene) / self.coarseness
    }

    fn run(&self, cores: &Cores) -> Result<RunOutcome, SimulatorError> {
        let begin = Instant::now();
        let (result, only_seen) = self.simulator.run_or_see(&self.scene, self.seed, cores)?;
        let effort = Effort {
            wall_s: begin.elapsed().as_secs_f64(),
            only_seen,
            ..Effort::default()
        };
        outcome_of(&self.scene, &result, effort).map_err(SimulatorError::other)
    }
}
