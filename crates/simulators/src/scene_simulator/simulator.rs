//! Scenes and effects as a simulator that the calibration can ask.

use crate::scene_simulator::binding::present_paths;
use crate::scene_simulator::{Binding, Error, SceneRun};
use campaign::{Cores, PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
use input::quantity::AngularSpeed;
use scene::{Control, FillingLibrary, Override, RunResult, Scene, USUAL_RETRIES, run_retrying};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// Revision of the physics: raised when the same scene and seed give other or further numbers.
const REVISION: u32 = 21;

/// Runs whose frames are kept in memory: some megabytes each for a thousand seeds.
const REMEMBERED: usize = 256;

/// Scenes by name, with parameters, conditions and effects.
///
/// A request's `parameters` are symbols of the bindings; its `condition` may hold `rpm`, `seed_count` and
/// `session`; its `effects` are those of [`crate::effects`].
///
/// ```
/// use campaign::RunRequest;
/// use scene::Scene;
/// use simulators::scene_simulator::{Binding, SceneSimulator};
/// use std::collections::BTreeMap;
/// let file = dev_support::fixture_files::fixture("cotton/drum.toml");
/// let scenes = BTreeMap::from([("drum".to_owned(), Scene::read(&file, &[])?)]);
/// let friction = Binding::of_path("contact.seed-seed.static_friction");
/// let bindings = BTreeMap::from([("B".to_owned(), friction)]);
/// let simulator = SceneSimulator::new(scenes, bindings)?;
/// // The scene that the request would run; `Simulator::run` runs it.
/// let request = RunRequest::new("drum", 1).with_condition("rpm", 20.0).with_parameter("B", 0.4);
/// let scene = simulator.scene_of(&request)?;
/// assert!((scene.apparatus.speed() - 20.0 * std::f64::consts::TAU / 60.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SceneSimulator {
    /// Scenes by the name that requests use.
    models: BTreeMap<String, Model>,
    /// What the symbols of parameters stand for.
    bindings: BTreeMap<String, Binding>,
    /// Symbols of parameters that are amplitudes of effects, with the effect.
    amplitudes: BTreeMap<String, String>,
    /// Symbol of the parameter by which seeds are coarser than those of the scene.
    coarse_graining: Option<String>,
    /// SHA-256 of each file of a shape, in lower-case hexadecimal.
    meshes: BTreeMap<PathBuf, String>,
    /// Bodies made so far.
    fillings: Arc<FillingLibrary>,
    /// The last runs by what moved the seeds: a scene without its camera, and the seed.
    moved: Mutex<VecDeque<(String, Arc<RunResult>)>>,
    /// How often a run that diverges is tried again, each time with half the time step.
    retries: u32,
    /// Raised by someone who wants running runs to end.
    stop: Arc<AtomicBool>,
}

/// A scene that requests can name.
#[derive(Debug)]
struct Model {
    /// The scene as it was read.
    scene: Scene,
    /// Paths of the bindings that it has.
    present: Vec<String>,
}

impl SceneSimulator {
    /// Makes a simulator of named scenes; `bindings` says what the symbols of parameters stand for.
    ///
    /// A parameter leaves scenes alone that have none of its settings.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read; a path of a binding that no scene has, or that takes no such number.
    pub fn new(
        models: BTreeMap<String, Scene>,
        bindings: BTreeMap<String, Binding>,
    ) -> Result<Self, Error> {
        let mut meshes = BTreeMap::new();
        for scene in models.values() {
            for mesh in scene.shape_files() {
                let file = scene.folder.join(mesh);
                let bytes = input::file::read(&file).map_err(|source| Error::Mesh {
                    file: scene.file.clone(),
                    mesh: mesh.to_owned(),
                    source,
                })?;
                meshes.insert(file, sha256(&bytes));
            }
        }
        let files: Vec<String> = models.values().map(|scene| scene.file.clone()).collect();
        let with_paths = models.into_iter().map(|(name, scene)| {
            let present = present_paths(&scene, &bindings)?;
            Ok((name, Model { scene, present }))
        });
        let models: BTreeMap<String, Model> = with_paths.collect::<Result<_, Error>>()?;
        for (symbol, binding) in &bindings {
            for path in &binding.paths {
                if !models.values().any(|model| model.present.contains(path)) {
                    return Err(Error::NoSetting {
                        symbol: symbol.clone(),
                        path: path.clone(),
                        files: files.join(", "),
                    });
                }
            }
        }
        Ok(Self {
            models,
            bindings,
            amplitudes: BTreeMap::new(),
            coarse_graining: None,
            meshes,
            fillings: Arc::default(),
            moved: Mutex::default(),
            retries: USUAL_RETRIES,
            stop: Arc::default(),
        })
    }

    /// Shares the bodies that were made for these scenes before.
    #[must_use]
    pub fn with_fillings(mut self, fillings: &Arc<FillingLibrary>) -> Self {
        self.fillings = Arc::clone(fillings);
        self
    }

    /// Takes parameters for amplitudes of effects: symbols with the names of the effects. They act before the effects of a request,
    /// so that one can be in both.
    #[must_use]
    pub fn with_amplitudes(mut self, amplitudes: BTreeMap<String, String>) -> Self {
        self.amplitudes = amplitudes;
        self
    }

    /// Takes a parameter for the diameter of the seeds over that of the scene: they are coarser, and so many fewer that their mass stays.
    #[must_use]
    pub fn with_coarse_graining(mut self, symbol: &str) -> Self {
        self.coarse_graining = Some(symbol.to_owned());
        self
    }

    /// Sets how often a run that diverges is tried again, each time with half the time step, as [`run_retrying`] does:
    /// [`USUAL_RETRIES`] where it is not set. Its record says what was tried.
    #[must_use]
    pub fn with_retries(mut self, retries: u32) -> Self {
        self.retries = retries;
        self
    }

    /// Honours a flag: once it is true a running run ends soon, without a result.
    #[must_use]
    pub fn with_stop(mut self, stop: &Arc<AtomicBool>) -> Self {
        self.stop = Arc::clone(stop);
        self
    }

    /// Bodies made so far.
    pub fn fillings(&self) -> &FillingLibrary {
        &self.fillings
    }

    /// The scene that a request represents, whole.
    ///
    /// # Errors
    ///
    /// A model, parameter, condition or effect that is invalid.
    pub fn scene_of(&self, request: &RunRequest) -> Result<Scene, SimulatorError> {
        let model = self.models.get(&request.model).ok_or_else(|| {
            refused(format!(
                "unknown model '{}'; expected one of {}",
                request.model,
                names(&self.models)
            ))
        })?;
        let changes = self.changes(model, request)?;
        let mut scene = if changes.is_empty() {
            model.scene.clone()
        } else {
            let changed = model.scene.with(&changes);
            changed.map_err(SimulatorError::other)?
        };
        for (name, value) in &request.condition {
            set_condition(&mut scene, name, *value)?;
        }
        if !request.condition.is_empty() {
            scene.check().map_err(SimulatorError::other)?;
        }
        let of_parameters = request.parameters.iter();
        let of_parameters =
            of_parameters.filter_map(|(symbol, value)| Some((self.amplitudes.get(symbol)?, value)));
        for (name, amplitude) in of_parameters.chain(&request.effects) {
            crate::effects::apply(&mut scene, name, *amplitude, &self.fillings)
                .map_err(SimulatorError::other)?;
        }
        if let Some(factor) = self.factor(request) {
            if !(factor.is_finite() && factor > 0.0) {
                return Err(refused(format!(
                    "seeds cannot be {factor} times as large as those of the scene"
                )));
            }
            scene.coarsen_seeds(factor);
            scene.check().map_err(SimulatorError::other)?;
        }
        Ok(scene)
    }

    /// How many times as large as in the scene the seeds of a request are, if it says so.
    fn factor(&self, request: &RunRequest) -> Option<f64> {
        let symbol = self.coarse_graining.as_ref()?;
        request.parameters.get(symbol).copied()
    }

    /// Builds the scene of a request, ready to be run.
    ///
    /// # Errors
    ///
    /// As [`SceneSimulator::scene_of`].
    pub fn prepare_scene(&self, request: &RunRequest) -> Result<SceneRun<'_>, SimulatorError> {
        Ok(SceneRun {
            simulator: self,
            scene: self.scene_of(request)?.reduced(),
            seed: request.seed,
            coarseness: self.factor(request).unwrap_or(1.0),
        })
    }

    /// The settings that the parameters of a request change in its model.
    ///
    /// # Errors
    ///
    /// A symbol that nobody bound; two that set one path.
    fn changes(
        &self,
        model: &Model,
        request: &RunRequest,
    ) -> Result<Vec<Override>, SimulatorError> {
        let mut all: Vec<Override> = Vec::new();
        let all_of_request = request.parameters.iter();
        let of_settings = |(symbol, _): &(&String, &f64)| {
            !self.amplitudes.contains_key(*symbol) && self.coarse_graining.as_ref() != Some(*symbol)
        };
        for (symbol, value) in all_of_request.filter(of_settings) {
            let binding = self.bindings.get(symbol).ok_or_else(|| {
                refused(format!(
                    "unknown parameter '{symbol}'; expected one of {}",
                    names(&self.bindings)
                ))
            })?;
            for change in binding.changes(|path| model.present.iter().any(|p| p == path), *value) {
                if all.iter().any(|other| other.name == change.name) {
                    return Err(refused(format!(
                        "parameter '{symbol}' sets '{}', which another parameter of the request sets as well",
                        change.name
                    )));
                }
                all.push(change);
            }
        }
        Ok(all)
    }

    /// The scene with the files of its shapes by name and content, `seed.stl sha256:...`, wherever and however their paths are written.
    ///
    /// # Errors
    ///
    /// A file that no scene had at the start.
    pub(super) fn by_content(&self, mut scene: Scene) -> Result<Scene, SimulatorError> {
        let folder = scene.folder.clone();
        let of_seeds = scene.seed.iter_mut();
        let of_seeds = of_seeds.flat_map(|s| s.mesh.iter_mut().chain(s.spheres.iter_mut()));
        for mesh in of_seeds.chain(scene.wall.iter_mut().map(|w| &mut w.mesh)) {
            let Some(digest) = self.meshes.get(&folder.join(&*mesh)) else {
                let told = format!("'{}' was not read at the start", mesh.display());
                return Err(refused(told));
            };
            let name = mesh.file_name().unwrap_or_default().to_string_lossy();
            *mesh = format!("{name} sha256:{digest}").into();
        }
        Ok(scene)
    }

    /// Runs a scene; where the same seeds moved before under another camera, their frames are seen again.
    ///
    /// Returns the run, and whether it was only seen.
    pub(super) fn run_or_see(
        &self,
        scene: &Scene,
        seed: u64,
        cores: &Cores,
    ) -> Result<(Arc<RunResult>, bool), SimulatorError> {
        let mut blind = serde_json::to_value(scene).map_err(SimulatorError::other)?;
        if let Some(settings) = blind.as_object_mut() {
            settings.remove("camera");
        }
        let key = format!("{seed} {} {blind}", scene.folder.display());
        let known = self.moved.lock().ok().and_then(|mut moved| {
            let at = moved.iter().position(|(other, _)| *other == key)?;
            // What was asked for again stays longest.
            let entry = moved.remove(at)?;
            let result = Arc::clone(&entry.1);
            moved.push_back(entry);
            Some(result)
        });
        if let Some(result) = known {
            let seen = result.seen_in(scene).map_err(SimulatorError::other)?;
            return Ok((Arc::new(seen), true));
        }
        let threads = || cores.of_a_run();
        let control = &mut Control {
            stop: &self.stop,
            threads: &threads,
        };
        let (fillings, retries) = (&self.fillings, self.retries);
        let result = run_retrying(scene, fillings, seed, threads(), None, control, retries);
        let result = Arc::new(result.map_err(SimulatorError::other)?);
        if let Ok(mut moved) = self.moved.lock() {
            moved.push_back((key, Arc::clone(&result)));
            if moved.len() > REMEMBERED {
                moved.pop_front();
            }
        }
        Ok((result, false))
    }
}

impl Simulator for SceneSimulator {
    fn version(&self) -> String {
        format!("seedloop {} physics {REVISION}", env!("CARGO_PKG_VERSION"))
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.prepare_scene(request)?.run(&Cores::new(1, 1))
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        Ok(Box::new(self.prepare_scene(request)?))
    }
}

/// Changes a condition of the experiment.
///
/// # Errors
///
/// A condition that is not known, or an invalid value.
fn set_condition(scene: &mut Scene, name: &str, value: f64) -> Result<(), SimulatorError> {
    match name {
        "rpm" => {
            let speed = AngularSpeed::from_si(value * std::f64::consts::TAU / 60.0);
            scene
                .apparatus
                .set_speed(speed.map_err(SimulatorError::other)?);
        }
        "seed_count" if value >= 1.0 && value.fract() == 0.0 && value < 1e7 => {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "checked by the guard"
            )]
            scene.set_seed_count(value as usize);
        }
        "session" if (0.0..=1.0).contains(&value) => {
            scene.protocol.session = Some(value);
        }
        _ => {
            return Err(refused(format!(
                "condition '{name}' = {value}; known are rpm, seed_count (a whole number, 1 or more) and session \
                 (0 at its start, 1 at its end)"
            )));
        }
    }
    Ok(())
}

/// The refusal of a request.
fn refused(reason: String) -> SimulatorError {
    SimulatorError::Refused { reason }
}

/// The names of a map, for a message.
fn names<T>(map: &BTreeMap<String, T>) -> String {
    let names: Vec<_> = map.keys().map(String::as_str).collect();
    names.join(", ")
}

/// SHA-256 of bytes in lower-case hexadecimal.
fn sha256(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(64);
    for byte in Sha256::digest(bytes) {
        write!(text, "{byte:02x}").expect("a string takes all text");
    }
    text
}
