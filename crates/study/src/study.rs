//! A study that was checked against its scenes: ready to be run.

use crate::candidates;
use crate::command_study;
use crate::compare::resolve;
use crate::curves::MeasuredCurve;
use crate::defaults::{DefaultUsed, Defaults};
use crate::document::{Document, below};
use crate::effects::search;
use crate::file::{Budget, SimulatorKind, StudyFile};
use crate::measured::Resolved;
use crate::parameters::{Resolver, check_all};
use crate::photos::PhotoSeries;
use crate::problem::{Problem, Problems};
use crate::scenes::{Models, Scenes, Setup};
use crate::simulator::StudySimulator;
use crate::{Error, inputs, plausible};
use inference::{CalibrationProblem, CoarseGraining, LoopSettings};
use scene::{FillingLibrary, Scene};
use simulators::external_simulator::{
    CommandModel, CommandSettings, CommandSimulator, PeerSettings, PeerSimulator,
};
use simulators::scene_simulator::SceneSimulator;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Standard error of what a trend with the size of the grains carries, in standard errors of what was measured, if the file states none.
/// Our choice: an interval is then at most 1.4 times as wide as that of runs with real grains.
const USUAL_ERROR: f64 = 1.0;

/// A study that was checked against its scenes.
///
/// ```no_run
/// use study::Study;
/// let study = Study::read("study.toml".as_ref(), None)?;
/// println!("{} parameters, {} measurements", study.problem.parameters.len(), study.problem.measurements.len());
/// # Ok::<(), study::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Study {
    /// The file.
    pub path: PathBuf,
    /// Name of the profile.
    pub profile: Option<String>,
    /// Content of the file, changed by the profile.
    pub file: StudyFile,
    /// Scenes by name, with their changes.
    pub scenes: BTreeMap<String, Scene>,
    /// Scenes by the name of the model, with the condition; those of candidates for the next measurement included.
    pub models: BTreeMap<String, Scene>,
    /// The problem to be solved.
    pub problem: CalibrationProblem,
    /// How the loop is run; the seed is that of the run.
    pub settings: LoopSettings,
    /// Photos that were read.
    pub photos: Vec<PhotoSeries>,
    /// Curves that were read, each with the name of its model.
    pub(crate) curves: Vec<(String, MeasuredCurve)>,
    /// Effects that a measured scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// Entries that the file omits, with the default used.
    pub defaults: Vec<DefaultUsed>,
    /// Scenes under their conditions as a program of the user runs them; empty if the scenes here are run.
    command_models: BTreeMap<String, CommandModel>,
    /// Bodies of the seeds, made by the check.
    pub(crate) fillings: Arc<FillingLibrary>,
    /// SHA-256 of every file that was read: study, scenes, meshes, photos, templates.
    pub inputs: BTreeMap<String, String>,
}

impl Study {
    /// Reads a study and checks all of it: keys, scenes, conditions, observables, photos, parameters, effects.
    ///
    /// A profile lies on top of the optional tables of the file: keys that it does not name stay, and its changes of a
    /// scene come after those of the file.
    ///
    /// # Errors
    ///
    /// [`Error::Read`] for a file that cannot be read, [`Error::Problems`] with everything that is wrong, each with file,
    /// line, key, value and the remedy.
    pub fn read(path: &Path, profile: Option<&str>) -> Result<Self, Error> {
        let text = input::file::read_text(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        let document = Document::parse(&text, &path.display().to_string());
        let problems = Problems::of(document.map_err(|list| Error::Problems { list })?);
        Self::checked(path, profile, problems)
    }

    /// Reads the tables of the file and checks them against the scenes.
    fn checked(path: &Path, profile: Option<&str>, mut problems: Problems) -> Result<Self, Error> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let file = StudyFile::read(profile, &mut problems);
        check_all(&file.parameter, &mut problems);
        if file.is_of_command() {
            command_study::check(&file, folder, &mut problems);
        }
        let scenes = Scenes::read(&file, folder, &mut problems);
        let before = problems.count();
        let mut known = Resolved::all(&scenes, folder, &mut problems);
        let complete = problems.count() == before && scenes.are_known();
        let mut asked = Asked::of(&scenes, &mut known, complete, &mut problems);
        check_whole(&asked.problem, path, &mut problems);
        problems.into_result()?;
        known.models.models.append(&mut asked.offered.models);
        known.models.setups.append(&mut asked.offered.setups);
        let Scenes {
            by_name, fillings, ..
        } = scenes;
        let models: BTreeMap<String, Scene> = known.models.scenes().collect();
        let all = by_name.values().chain(models.values());
        let curves = || known.curves.iter().map(|(_, curve)| curve.file.clone());
        let named = |(model, curve): &(usize, MeasuredCurve)| {
            (known.models.models[*model].name.clone(), curve.clone())
        };
        Ok(Self {
            path: path.to_owned(),
            profile: profile.map(str::to_owned),
            inputs: inputs::of(path, &file, all, &known.photos, curves())?,
            curves: known.curves.iter().map(named).collect(),
            command_models: known.models.commands().collect(),
            settings: asked.settings,
            file,
            scenes: by_name,
            models,
            problem: asked.problem,
            photos: known.photos,
            not_applicable: asked.not_applicable,
            defaults: asked.defaults.list,
            fillings,
        })
    }

    /// The measured curves: model, name, columns, and the points of each repeat.
    pub fn curves(&self) -> impl Iterator<Item = (&str, &str, [&str; 2], Vec<Vec<[f64; 2]>>)> {
        self.curves.iter().map(|(model, curve)| {
            let (name, columns, points) = curve.points();
            (model.as_str(), name, columns, points)
        })
    }

    /// Name of the result folder: that of the study, with that of the profile.
    pub fn folder_name(&self) -> String {
        match &self.profile {
            Some(profile) => format!("{}-{profile}", self.problem.id),
            None => self.problem.id.clone(),
        }
    }

    /// The simulator of the runs; other codes work in the folder `work` of the result folder.
    ///
    /// # Errors
    ///
    /// A mesh or a template that cannot be read, a code that is not there.
    pub fn simulator(&self, folder: &Path) -> Result<StudySimulator, Error> {
        let (work, table) = (folder.join("work"), &self.file.simulator);
        if table.kind == SimulatorKind::Command {
            let folder = self.path.parent().unwrap_or(Path::new(""));
            let settings = CommandSettings {
                command: table.command(),
                template: table.template.as_ref().map(|t| folder.join(t)),
                version: table.version.clone().unwrap_or_default(),
                wall_limit_s: table.wall_limit_s(),
                expected_s: table.expected_s(),
                results: table.results(),
                work,
                keep: table.keep,
            };
            let parameters = self.file.parameter.iter().map(|p| p.symbol.clone());
            let effects = self.file.effect.iter().map(|e| e.name.clone());
            let coarse = self.problem.coarse_graining.iter();
            let coarse = coarse.map(|_| CoarseGraining::SYMBOL.to_owned());
            let names: Vec<String> = parameters.chain(effects).chain(coarse).collect();
            let command = CommandSimulator::new(settings, self.command_models.clone(), &names)?;
            return Ok(StudySimulator::command(command));
        }
        let scenes = self.scene_simulator()?;
        let Some(peer) = table.peer() else {
            let curves = self.curves.iter();
            let curves = curves.map(|(model, curve)| (model.clone(), curve.scores.clone()));
            return Ok(StudySimulator::own(scenes, curves.collect()));
        };
        let settings = PeerSettings {
            peer,
            command: table.command(),
            ranks: table.ranks(),
            environment: table.environment.clone().into_iter().collect(),
            wall_limit_s: table.wall_limit_s(),
            work,
            keep: table.keep,
        };
        Ok(StudySimulator::peer(PeerSimulator::new(scenes, settings)?))
    }

    /// The scenes as a simulator.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read.
    fn scene_simulator(&self) -> Result<SceneSimulator, Error> {
        let entries = || self.file.parameter.iter();
        let amplitudes = entries().filter_map(|e| Some((e.symbol.clone(), e.effect.clone()?)));
        let of_settings = entries().filter(|entry| !entry.sets.is_empty());
        let bindings = of_settings.map(|entry| (entry.symbol.clone(), entry.binding()));
        let mut scenes = SceneSimulator::new(self.models.clone(), bindings.collect())?
            .with_fillings(&self.fillings)
            .with_amplitudes(amplitudes.collect());
        if self.problem.coarse_graining.is_some() {
            scenes = scenes.with_coarse_graining(CoarseGraining::SYMBOL);
        }
        Ok(scenes)
    }
}

/// What a study asks of the loop.
struct Asked {
    problem: CalibrationProblem,
    settings: LoopSettings,
    /// Models of the candidates for the next measurement.
    offered: Models,
    not_applicable: BTreeMap<String, String>,
    defaults: Defaults,
}

impl Asked {
    /// Resolves parameters, candidates and effects against measurements of which `complete` says that none was refused.
    fn of(
        scenes: &Scenes<'_>,
        known: &mut Resolved,
        complete: bool,
        problems: &mut Problems,
    ) -> Self {
        let (file, mut defaults) = (scenes.file, Defaults::default());
        let mut resolver = Resolver::new(scenes, &known.models, complete, &mut defaults, problems);
        let parameters = file.parameter.iter().map(|entry| resolver.resolve(entry));
        let parameters = parameters.collect();
        let settings = settings(file, &mut defaults);
        let search_for = file.effects.search.as_ref();
        // Nobody reads a suggestion that no diagnosis follows.
        let is_named = file.candidate.as_ref().is_some_and(|list| !list.is_empty());
        let (candidates, offered) =
            if complete && (is_named || search_for.is_none_or(|s| !s.is_empty())) {
                candidates::of_scenes(scenes, known, problems)
            } else {
                (Vec::new(), Models::default())
            };
        let searched = search(known, scenes, &offered);
        defaults.tell_searched(file, &candidates, &searched.probes);
        known.models.bind(&file.parameter);
        let coarse_graining =
            coarse_graining(file, &mut known.models, scenes, &mut defaults, problems);
        let problem = CalibrationProblem {
            id: file.name.clone(),
            parameters,
            models: known.models.models.clone(),
            measurements: std::mem::take(&mut known.measurements),
            correlations: std::mem::take(&mut known.correlations),
            effects: searched.probes,
            candidates,
            coarse_graining,
        };
        if complete {
            check_compare(file, &problem, problems);
        }
        Self {
            problem,
            settings,
            offered,
            not_applicable: searched.not_applicable,
            defaults,
        }
    }
}

/// Settings of the loop; each key was checked alone.
fn settings(file: &StudyFile, defaults: &mut Defaults) -> LoopSettings {
    let settings: LoopSettings = file.design.clone().try_into().unwrap_or_default();
    defaults.tell_design(&file.design, &settings);
    if file.budget == Budget::default() {
        defaults.tell("budget", "none", "the loop ends by its own rules");
    }
    LoopSettings {
        most_runs: file.budget.runs,
        ..settings
    }
}

/// The coarse graining of the models of its scenes; refuses scenes of single seeds, and sizes with which a measured scene cannot be built.
/// A program of the user gets the size as a parameter.
fn coarse_graining(
    file: &StudyFile,
    models: &mut Models,
    scenes: &Scenes<'_>,
    defaults: &mut Defaults,
    problems: &mut Problems,
) -> Option<CoarseGraining> {
    let entry = file.coarse_graining.as_ref()?;
    let is_coarse = |k: &usize| entry.scenes.contains(&models.models[*k].scene);
    let coarse: Vec<usize> = (0..models.models.len()).filter(is_coarse).collect();
    for &model in &coarse {
        let name = &models.models[model].name;
        let scene = match &mut models.setups[model] {
            Setup::Command(run) => {
                run.parameters.push(CoarseGraining::SYMBOL.to_owned());
                continue;
            }
            Setup::Scene(scene) => scene,
        };
        if scene.apparatus.is_bench_test() {
            let problem =
                format!("{name} is a test of single seeds, which cannot be coarser: leave it out");
            problems.wrong(&below("coarse_graining", "scenes"), problem);
            continue;
        }
        for factor in &entry.factors {
            let mut scene = scene.clone();
            scene.coarsen_seeds(*factor);
            let checked = scene.check().map_err(|error| error.to_string());
            let unbuilt = || scenes.unbuilt(&Setup::Scene(scene.clone()));
            if let Some(error) = checked.err().or_else(unbuilt) {
                let problem =
                    format!("at {factor} {name} cannot be built: {error}; use finer grains");
                problems.wrong(&below("coarse_graining", "factors"), problem);
            }
        }
    }
    let error = entry.error.unwrap_or_else(|| {
        let why = "what the size adds to an error is at most that of the measurement";
        defaults.tell("coarse_graining: error", &USUAL_ERROR.to_string(), why);
        USUAL_ERROR
    });
    Some(CoarseGraining {
        models: coarse,
        factors: entry.factors.clone(),
        error,
    })
}

/// Refuses published values of results that are not there.
fn check_compare(file: &StudyFile, problem: &CalibrationProblem, problems: &mut Problems) {
    for entry in &file.compare {
        if let Err(reason) = resolve(&entry.result, problem) {
            problems.wrong(&below(&entry.path, "result"), reason);
        }
    }
}

/// Refuses combinations of entries that are valid one by one.
fn check_whole(problem: &CalibrationProblem, path: &Path, problems: &mut Problems) {
    plausible::check(problems);
    if problems.count() > 0 {
        return;
    }
    if let Err(inference::Error::Problem { lines }) = problem.check() {
        for line in lines {
            problems.add(Problem {
                file: path.display().to_string(),
                line: None,
                what: "the study".into(),
                problem: line,
            });
        }
    }
}
