//! Drums run by LAMMPS and LIGGGHTS, with start-up, steady state and surface by the rules here.

use crate::exchange::{lammps, liggghts};
use crate::external_simulator::bed::{Bed, Drive, Took};
use crate::external_simulator::deck::Deck;
use crate::external_simulator::folder::{Keep, RunFolder};
use crate::external_simulator::guard::Guard;
use crate::external_simulator::process::{Failure, Limits};
use crate::external_simulator::session::{Session, version_line};
use crate::scene_simulator::{SceneRun, SceneSimulator};
use campaign::run_store::Record;
use campaign::{Cores, PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
use input::quantity::Time;
use scene::{DrumCamera, FillingLibrary, Scene, SteadyRule, SteadyState};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Revision of what is done around the decks: raised when the same scene and seed give other numbers.
const REVISION: u32 = 3;
/// How much longer another code takes than the solver here, for each sphere of a seed: four times as many steps, and each
/// sphere is a body of its own in its neighbour lists. Of the order; nothing but the estimate of a price depends on it.
const SLOWER: f64 = 4.0;

/// A code that runs the exported decks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Peer {
    /// LAMMPS.
    Lammps,
    /// LIGGGHTS.
    Liggghts,
}

impl Peer {
    /// Its name as it writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lammps => "LAMMPS",
            Self::Liggghts => "LIGGGHTS",
        }
    }

    /// The usual name of its program.
    pub fn program(self) -> &'static str {
        match self {
            Self::Lammps => "lmp",
            Self::Liggghts => "liggghts",
        }
    }

    /// Refuses scenes that the code would run otherwise, or not at all.
    ///
    /// # Errors
    ///
    /// What the code does not have, by name, with the remedy.
    pub fn check(self, scene: &Scene) -> Result<(), crate::exchange::Error> {
        match self {
            Self::Lammps => lammps::check(scene),
            Self::Liggghts => liggghts::check(scene),
        }
    }
}

/// How a code is run.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerSettings {
    /// The code.
    pub peer: Peer,
    /// The command line that starts it, such as `mpirun -np 4 lmp`.
    pub command: Vec<String>,
    /// Number of its processes, for the record.
    pub ranks: usize,
    /// Environment variables for it.
    pub environment: Vec<(String, String)>,
    /// Time by the clock after which a run is ended, s.
    pub wall_limit_s: f64,
    /// Folder in which runs have their folders.
    pub work: PathBuf,
    /// Which folders are kept.
    pub keep: Keep,
}

/// Scenes as a simulator that lets another code do the mechanics.
#[derive(Debug)]
pub struct PeerSimulator {
    /// The scenes, with parameters and effects.
    scenes: SceneSimulator,
    /// How the code is run.
    settings: PeerSettings,
    /// What the code says of itself.
    code: String,
    /// Raised by someone who wants running runs to end.
    stop: Arc<AtomicBool>,
    /// Ends running programs if this process cannot.
    guard: Arc<Guard>,
}

impl PeerSimulator {
    /// Asks the code for its version, so that one that is not there is reported before any run.
    ///
    /// # Errors
    ///
    /// A code that cannot be started, or is another.
    pub fn new(
        scenes: SceneSimulator,
        settings: PeerSettings,
    ) -> Result<Self, crate::external_simulator::Error> {
        let refused = |reason: String| crate::external_simulator::Error::Program { reason };
        let folder = tempfile::tempdir();
        let folder = folder.map_err(|error| refused(format!("no temporary folder: {error}")))?;
        let (command, environment) = (&settings.command, &settings.environment);
        let name = settings.peer.name();
        let code = version_line(command, environment, folder.path(), name).map_err(refused)?;
        Ok(Self {
            scenes,
            settings,
            code,
            stop: Arc::default(),
            guard: Arc::default(),
        })
    }

    /// Honours a flag: once it is true a running code is ended soon, and its run has no result.
    #[must_use]
    pub fn with_stop(mut self, stop: &Arc<AtomicBool>) -> Self {
        self.stop = Arc::clone(stop);
        self
    }

    /// The scenes.
    pub fn scenes(&self) -> &SceneSimulator {
        &self.scenes
    }

    /// Runs a deck in a folder until the bed is steady or the limit is reached.
    fn run_in(&self, folder: &RunFolder, scene: &Scene, deck: &Deck) -> Result<Done, Failure> {
        let begin = Instant::now();
        for file in deck.further_files() {
            let path = folder.path.join(&file.name);
            fs::write(&path, &file.text)
                .map_err(|error| format!("cannot write {}: {error}", path.display()))?;
        }
        let settings = &self.settings;
        let limits = Limits {
            wall: Duration::from_secs_f64(settings.wall_limit_s),
            stop: Arc::clone(&self.stop),
            guard: Arc::clone(&self.guard),
        };
        let (command, environment) = (&settings.command, &settings.environment);
        let mut session = Session::start(command, environment, &folder.path, &limits)?;
        session.run(&deck.start())?;
        let mut bed = Bed::new(Drive {
            camera: DrumCamera::of(scene),
            spin: scene.apparatus.speed(),
            gravity: scene.model.gravity_m_s2,
            interval: deck.interval,
        });
        deck.add(&mut bed, session.run(&deck.turn())?)?;
        let protocol = &scene.protocol;
        let most = protocol.rotation_limit.si();
        let rule = SteadyRule::for_bed(
            bed.swing(),
            protocol.start_up.map(Time::si),
            most,
            deck.interval,
            protocol.angle_error.map(|e| e.si().to_degrees()),
        );
        loop {
            let state = bed.judge(&rule);
            let frames = bed.len().saturating_sub(state.cut) / deck.frame_every;
            let over = bed.len() as f64 * deck.interval >= most;
            if over || (state.doubt.is_none() && frames >= protocol.frames) {
                session.finish()?;
                let took = Took {
                    wall_s: begin.elapsed().as_secs_f64(),
                    time_step: deck.time_step,
                    steps: deck.steps_of(bed.len()),
                    bodies: scene.seed_count(),
                    threads: settings.ranks,
                };
                return Ok(Done { bed, state, took });
            }
            let mut more = 1;
            while !rule.asks_at(bed.len() + more) && more < rule.start_up.max(rule.swing) {
                more += 1;
            }
            deck.add(&mut bed, session.run(&deck.go_on(more))?)?;
        }
    }
}

/// A run that came to its end.
struct Done {
    bed: Bed,
    /// What is kept of it.
    state: SteadyState,
    /// What it took.
    took: Took,
}

impl Simulator for PeerSimulator {
    fn version(&self) -> String {
        format!(
            "{} by seedloop {} revision {REVISION}",
            self.code,
            env!("CARGO_PKG_VERSION")
        )
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.prepare(request)?.run(&Cores::new(1, 1))
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        let prepared = self.scenes.prepare_scene(request)?;
        let refused = |error: crate::exchange::Error| SimulatorError::Refused {
            reason: error.to_string(),
        };
        let peer = self.settings.peer;
        peer.check(prepared.scene()).map_err(refused)?;
        Ok(Box::new(PeerRun {
            simulator: self,
            prepared,
            seed: request.seed,
        }))
    }
}

/// A scene that is ready to be run by another code.
struct PeerRun<'s> {
    simulator: &'s PeerSimulator,
    prepared: SceneRun<'s>,
    seed: u64,
}

impl PreparedRun for PeerRun<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        // The number of ranks decides the order of sums.
        let command = &self.simulator.settings.command;
        Ok(json!({ "of": self.prepared.inputs()?, "command": command }))
    }

    fn cost(&self) -> f64 {
        let fillings = self.simulator.scenes.fillings();
        let spheres = spheres_of_a_seed(self.prepared.scene(), fillings);
        SLOWER * spheres.unwrap_or(1.0) * self.prepared.cost()
    }

    fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
        let failed = |reason: String| SimulatorError::Failed { reason };
        let simulator = self.simulator;
        let scene = self.prepared.scene();
        let record = Record::new(&simulator.version(), self.inputs()?, self.seed);
        let record = record.map_err(SimulatorError::other)?;
        let settings = &simulator.settings;
        let folder = RunFolder::make(&settings.work, record.key(), settings.keep);
        let folder = folder.map_err(failed)?;
        let fillings = simulator.scenes.fillings();
        let deck = Deck::of(scene, settings.peer, fillings, self.seed)?;
        let done = simulator.run_in(&folder, scene, &deck);
        if done.is_err() && simulator.stop.load(Ordering::SeqCst) {
            folder.stopped();
            return Err(failed("the run was stopped".into()));
        }
        let Done { bed, state, took } = done.map_err(|failure| failed(folder.failed(&failure)))?;
        let outcome = bed.outcome(state, deck.frame_every, took, Vec::new());
        if outcome.is_ok() {
            folder.succeeded();
        }
        outcome
    }
}

/// Mean number of spheres at the surface of a seed; `None` if a body cannot be made.
fn spheres_of_a_seed(scene: &Scene, fillings: &FillingLibrary) -> Option<f64> {
    let mut all = 0;
    for seed in &scene.seed {
        let body = fillings.body(scene, seed).ok()?;
        all += scene.count_of(seed) * body.outer.spheres().len();
    }
    Some(all as f64 / scene.seed_count().max(1) as f64)
}
