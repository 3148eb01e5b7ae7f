//! Any program as a simulator: it gets values, and leaves observables, positions of spheres, or pictures.

use crate::external_simulator::bed::{Bed, Drive, Took, timing};
use crate::external_simulator::command_line::{arguments, places, variable};
use crate::external_simulator::drum::{DrumDescription, DrumOfRun};
use crate::external_simulator::file_pattern::matching;
use crate::external_simulator::folder::{Keep, RunFolder};
use crate::external_simulator::guard::Guard;
use crate::external_simulator::left_moments::LeftMoments;
use crate::external_simulator::process::{Failure, LOG, Limits, Process, end_of_log};
use crate::external_simulator::template::Template;
use crate::external_simulator::{Error, results};
use crate::scene_simulator::{
    FrameDetails, RunDetails, SECONDS_PER_COST, SeriesDetails, SurfaceReadings, no_surface,
};
use campaign::run_store::Record;
use campaign::{Cores, PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError, in_full};
use photo_profile::{Settings, measure_photo, read_frames};
use scene::{FrameReading, SteadyRule};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Revision of what is done around the command: raised when the same files give other numbers.
const REVISION: u32 = 3;
/// Name of the file with all values.
const REQUEST: &str = "request.json";

/// Where a command leaves what it found; paths from the folder of the run.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ResultFiles {
    /// JSON of observables.
    pub observables: Option<PathBuf>,
    /// Files of sphere positions; the last part may hold `*`.
    pub positions: Option<PathBuf>,
    /// Pictures of the drum, or a folder of them; the last part may hold `*`.
    pub pictures: Option<PathBuf>,
}

/// How a command is run.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandSettings {
    /// Program and arguments; `{name}` takes the value of a parameter, condition or effect, `{arguments}` all of them as
    /// `name=value`. Without any such place, all are added at the end.
    pub command: Vec<String>,
    /// Folder whose files are copied into the folder of each run.
    pub template: Option<PathBuf>,
    /// The user's word for the version of his code: another word, other runs.
    pub version: String,
    /// Time by the clock after which a run is ended, s.
    pub wall_limit_s: f64,
    /// Time that a run takes, s, for the estimate of the price.
    pub expected_s: f64,
    /// Files that it leaves.
    pub results: ResultFiles,
    /// Folder in which runs have their folders.
    pub work: PathBuf,
    /// Which folders are kept.
    pub keep: Keep,
}

/// A scene of a command under one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandModel {
    /// Name of the scene.
    pub scene: String,
    /// The condition by name.
    pub condition: BTreeMap<String, String>,
    /// Names of the parameters on which its runs depend; the program does not receive others.
    pub parameters: Vec<String>,
    /// The drum that positions and pictures show; `None` if the command gives observables alone.
    pub drum: Option<DrumDescription>,
}

impl CommandModel {
    /// The parameters of a request on which runs of this model depend.
    fn of_it(&self, request: &RunRequest) -> BTreeMap<String, f64> {
        let all = request.parameters.iter();
        all.filter(|(name, _)| self.parameters.contains(name))
            .map(|(name, value)| (name.clone(), *value))
            .collect()
    }
}

/// A command as a simulator.
#[derive(Debug)]
pub struct CommandSimulator {
    /// How it is run.
    settings: CommandSettings,
    /// The files that each run gets.
    template: Template,
    /// Scenes under their conditions, by the name of the model.
    models: BTreeMap<String, CommandModel>,
    /// Raised by someone who wants running runs to end.
    stop: Arc<AtomicBool>,
    /// Ends running programs if this process cannot.
    guard: Arc<Guard>,
}

impl CommandSimulator {
    /// Reads the template and checks all places for values; `parameters` are the names of parameters and effects.
    ///
    /// # Errors
    ///
    /// A template that cannot be read, a place that nothing fills, a command without a program, no file of results.
    pub fn new(
        settings: CommandSettings,
        models: BTreeMap<String, CommandModel>,
        parameters: &[String],
    ) -> Result<Self, Error> {
        let wrong = |what: &str, problem: String| Error::Setting {
            what: what.to_owned(),
            problem,
        };
        let conditions = models.values().flat_map(|m| m.condition.keys().cloned());
        let mut names: Vec<String> = parameters.iter().cloned().chain(conditions).collect();
        names.extend(["scene".to_owned(), "seed".to_owned()]);
        names.sort();
        names.dedup();
        if settings.command.is_empty() {
            let problem = "names no program: write command = [\"python3\", \"run.py\"]".into();
            return Err(wrong("[simulator] command", problem));
        }
        for entry in &settings.command {
            for place in places(entry) {
                if place != "arguments" && !names.iter().any(|name| name == place) {
                    let problem = format!(
                        "is not a parameter, condition or effect; expected one of {}",
                        names.join(", ")
                    );
                    return Err(wrong(&format!("[simulator] command: {{{place}}}"), problem));
                }
            }
        }
        let ResultFiles {
            observables,
            positions,
            pictures,
        } = &settings.results;
        if observables.is_none() && positions.is_none() && pictures.is_none() {
            let problem = "names no file: add observables, positions or pictures".into();
            return Err(wrong("[simulator.results]", problem));
        }
        for model in models.values() {
            if let (Some(_), None) = (positions, &model.drum) {
                let problem = "has no drum: positions are read in one; add [scene.drum]".into();
                return Err(wrong(&format!("[[scene]] {}", model.scene), problem));
            }
        }
        let template = match &settings.template {
            Some(folder) => Template::read(folder, &names)?,
            None => Template::default(),
        };
        Ok(Self {
            settings,
            template,
            models,
            stop: Arc::default(),
            guard: Arc::default(),
        })
    }

    /// Honours a flag: once it is true a running program is ended soon, with all that it started, and its run has no result.
    #[must_use]
    pub fn with_stop(mut self, stop: &Arc<AtomicBool>) -> Self {
        self.stop = Arc::clone(stop);
        self
    }

    /// The model of a request and all values by name, as text.
    fn values(
        &self,
        request: &RunRequest,
    ) -> Result<(&CommandModel, BTreeMap<String, String>), SimulatorError> {
        let model = self.models.get(&request.model).ok_or_else(|| {
            let known: Vec<&str> = self.models.keys().map(String::as_str).collect();
            SimulatorError::Refused {
                reason: format!(
                    "unknown model '{}'; expected one of {}",
                    request.model,
                    known.join(", ")
                ),
            }
        })?;
        let mut values = model.condition.clone();
        let parameters = model.of_it(request);
        let numbers = parameters.iter().chain(&request.condition);
        for (name, value) in numbers.chain(&request.effects) {
            values.insert(name.clone(), value.to_string());
        }
        values.insert("scene".into(), model.scene.clone());
        values.insert("seed".into(), request.seed.to_string());
        Ok((model, values))
    }

    /// Runs the command in a folder and reads what it left.
    fn run_in(
        &self,
        folder: &Path,
        request: &RunRequest,
        model: &CommandModel,
        values: &BTreeMap<String, String>,
    ) -> Result<RunOutcome, Failure> {
        let settings = &self.settings;
        self.template.write(folder, values)?;
        let text = serde_json::to_string_pretty(&json!({
            "scene": model.scene,
            "condition": model.condition,
            "parameters": model.of_it(request),
            "effects": request.effects,
            "seed": request.seed,
        }));
        let text = text.map_err(|error| error.to_string())?;
        let file = folder.join(REQUEST);
        fs::write(&file, text).map_err(|e| format!("cannot write {}: {e}", file.display()))?;
        let environment: Vec<(String, String)> = values
            .iter()
            .map(|(name, value)| (variable(name), value.clone()))
            .collect();
        let limits = Limits {
            wall: Duration::from_secs_f64(settings.wall_limit_s),
            stop: Arc::clone(&self.stop),
            guard: Arc::clone(&self.guard),
        };
        let begin = Instant::now();
        let arguments = arguments(&settings.command, values);
        let (process, _) = Process::start(&arguments, &environment, folder, &limits, false)?;
        process.wait()?;
        let took = Took {
            wall_s: begin.elapsed().as_secs_f64(),
            threads: 1,
            ..Took::default()
        };
        let outcome = self.read(folder, model, values, took);
        // What the program printed often says why its results are not what they should be.
        outcome.map_err(|reason| format!("{reason}{}", end_of_log(&folder.join(LOG))))
    }

    /// Reads what the command left.
    fn read(
        &self,
        folder: &Path,
        model: &CommandModel,
        values: &BTreeMap<String, String>,
        took: Took,
    ) -> Result<RunOutcome, Failure> {
        let files = &self.settings.results;
        let drum = model.drum.as_ref().map(|d| d.at(values)).transpose()?;
        let mut outcome = match (&files.positions, drum) {
            (Some(pattern), Some(drum)) => read_bed(folder, pattern, &drum, took)?,
            _ => RunOutcome {
                details: details(&[], &SurfaceReadings::default(), took)?,
                ..RunOutcome::default()
            },
        };
        if let Some(pattern) = &files.pictures {
            let seen = read_pictures(folder, pattern, took)?;
            add(&mut outcome, seen, "pictures")?;
        }
        if let Some(file) = &files.observables {
            let told = results::read(&folder.join(file))?;
            let told = RunOutcome {
                observables: told.observables,
                regime: told.regime,
                details: Value::Null,
            };
            add(&mut outcome, told, &file.display().to_string())?;
        }
        // What needs no picture stands though no picture shows a surface.
        match outcome.details["no_surface"].as_str() {
            Some(reason) if outcome.observables.is_empty() => Err(reason.to_owned()),
            _ => Ok(outcome),
        }
    }
}

impl Simulator for CommandSimulator {
    fn version(&self) -> String {
        format!(
            "command '{}' by seedloop {} revision {REVISION}",
            self.settings.version,
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
        let (model, values) = self.values(request)?;
        Ok(Box::new(CommandRun {
            simulator: self,
            request: request.clone(),
            model,
            values,
        }))
    }
}

/// A request with the values that the program receives.
struct CommandRun<'s> {
    simulator: &'s CommandSimulator,
    request: RunRequest,
    model: &'s CommandModel,
    /// Texts by the names of their places in the template and the command.
    values: BTreeMap<String, String>,
}

impl PreparedRun for CommandRun<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        let (model, settings) = (self.model, &self.simulator.settings);
        let files = &settings.results;
        let name = |file: &Option<PathBuf>| file.as_ref().map(|f| f.display().to_string());
        let mut inputs = json!({
            "command": settings.command,
            "template": self.simulator.template.digests(),
            "scene": model.scene,
            "condition": model.condition,
            "parameters": model.of_it(&self.request),
            "effects": self.request.effects,
        });
        let optional = [
            ("observables", name(&files.observables)),
            ("positions", name(&files.positions)),
            ("pictures", name(&files.pictures)),
            ("drum", model.drum.as_ref().map(DrumDescription::text)),
        ];
        for (key, value) in optional {
            if let Some(value) = value {
                inputs[key] = value.into();
            }
        }
        Ok(inputs)
    }

    fn cost(&self) -> f64 {
        self.simulator.settings.expected_s / SECONDS_PER_COST
    }

    fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
        let failed = |reason: String| SimulatorError::Failed { reason };
        let simulator = self.simulator;
        let record = Record::new(&simulator.version(), self.inputs()?, self.request.seed);
        let record = record.map_err(SimulatorError::other)?;
        let settings = &simulator.settings;
        let folder = RunFolder::make(&settings.work, record.key(), settings.keep);
        let folder = folder.map_err(failed)?;
        let outcome = simulator.run_in(&folder.path, &self.request, self.model, &self.values);
        if outcome.is_err() && simulator.stop.load(Ordering::SeqCst) {
            folder.stopped();
            return Err(failed("the run was stopped".into()));
        }
        let outcome = outcome.map_err(|failure| failed(folder.failed(&failure)))?;
        folder.succeeded();
        Ok(outcome)
    }
}

/// Adds observables to an outcome; one that is there already is a contradiction.
fn add(outcome: &mut RunOutcome, more: RunOutcome, of: &str) -> Result<(), Failure> {
    for (name, value) in more.observables {
        if outcome.observables.insert(name.clone(), value).is_some() {
            return Err(format!(
                "{of} gives {name}, which was read from the positions or pictures too: leave it out"
            ));
        }
    }
    outcome.regime = more.regime.or(outcome.regime.take());
    if !more.details.is_null() && outcome.details["last_frame_png_base64"].is_null() {
        outcome.details = more.details;
    }
    Ok(())
}

/// A bed from files of positions.
fn read_bed(
    folder: &Path,
    pattern: &Path,
    drum: &DrumOfRun,
    took: Took,
) -> Result<RunOutcome, Failure> {
    let LeftMoments { moments, remarks } = LeftMoments::read(folder, pattern)?;
    let interval = drum.interval(&moments)?;
    let mut bed = Bed::new(Drive {
        camera: drum.camera,
        spin: drum.spin,
        gravity: drum.gravity,
        interval,
    });
    for moment in moments {
        bed.push(drum.turned(moment));
    }
    let whole = bed.len() as f64 * interval;
    let rule = SteadyRule::for_bed(bed.swing(), drum.start_up, whole, interval, None);
    let state = bed.judge(&rule);
    bed.outcome(state, 1, took, remarks)
        .map_err(|error| error.in_full())
}

/// The surface in pictures.
fn read_pictures(folder: &Path, pattern: &Path, took: Took) -> Result<RunOutcome, Failure> {
    let mut readings = Vec::new();
    for file in matching(folder, pattern)? {
        for picture in read_frames(&file).map_err(|error| in_full(&error))? {
            let picture = picture.map_err(|error| in_full(&error))?;
            let pixels = photo_profile::PhotoPixels::from_picture(&picture);
            let photo = measure_photo(&pixels, &Settings::default());
            let photo = photo.map_err(|error| format!("{}: {error}", file.display()))?;
            readings.push(FrameReading {
                photo,
                position: None,
                surface_speed: None,
            });
        }
    }
    let surface = SurfaceReadings::of(&readings, None);
    Ok(RunOutcome {
        observables: surface.observables(),
        regime: None,
        details: details(&readings, &surface, took)?,
    })
}

/// What a record keeps of a run whose bed was not seen over time.
fn details(
    readings: &[FrameReading],
    surface: &SurfaceReadings,
    took: Took,
) -> Result<Value, Failure> {
    let details = RunDetails {
        steady: None,
        doubt: None,
        start_up_s: None,
        swing_s: None,
        motion: None,
        froude_number: None,
        no_surface: no_surface(readings),
        remarks: Vec::new(),
        frames: FrameDetails {
            times_s: Vec::new(),
            angles_deg: surface.image.clone(),
            angles_by_position_deg: surface.position.clone(),
            filling_angles_deg: Vec::new(),
            refused: readings.len() - surface.image.len(),
            no_surface_speed: None,
            standard_error_deg: None,
            effective_number: None,
        },
        curve: None,
        series: SeriesDetails {
            time_s: Vec::new(),
            centre_of_mass_deg: Vec::new(),
        },
        timing: timing(took, 0),
        last_frame_png_base64: None,
        last_bodies: None,
    };
    serde_json::to_value(details).map_err(|error| error.to_string())
}
