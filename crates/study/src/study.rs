//! A study that was checked against its scenes: ready to be run.

use crate::candidates::{self, Known};
use crate::command_study::{CommandChecker, probes};
use crate::compare::resolve;
use crate::defaults::{DefaultUsed, Defaults};
use crate::document::{Document, below};
use crate::effects::{Searched, search};
use crate::file::{
    Budget, Choices, CommandEntry, CompareEntry, ParameterEntry, SimulatorEntry, StudyFile,
    USUAL_ERROR,
};
use crate::measured::Resolved;
use crate::parameters::{Resolver, check_all, tables};
use crate::photos::PhotoSeries;
use crate::problem::{Problem, Problems};
use crate::scenes::{Models, Scenes};
use crate::simulator::StudySimulator;
use crate::{Error, inputs, plausible};
use inference::{
    CalibrationProblem, Candidate, CoarseGraining, EffectProbe, LoopSettings, Model, Parameter,
};
use scene::Scene;
use simulators::external_simulator::{
    CommandModel, CommandSettings, CommandSimulator, PeerSettings, PeerSimulator,
};
use simulators::scene_simulator::{Binding, SceneSimulator};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A study that was checked against its scenes.
#[derive(Debug, Clone)]
pub struct Study {
    /// The file.
    pub path: PathBuf,
    /// Name of the profile; none for the file as it stands.
    pub profile: Option<String>,
    /// What the file says.
    pub file: StudyFile,
    /// Scenes by name, with their changes.
    pub scenes: BTreeMap<String, Scene>,
    /// Scenes by the name of the model, with the condition; those of candidates for the next measurement included.
    pub models: BTreeMap<String, Scene>,
    /// What is asked.
    pub problem: CalibrationProblem,
    /// How the loop is run; the seed is that of the run.
    pub settings: LoopSettings,
    /// How much may be run.
    pub budget: Budget,
    /// Published values.
    pub compare: Vec<CompareEntry>,
    /// Photos that were read.
    pub photos: Vec<PhotoSeries>,
    /// Effects that a measured scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// What the file left out, and what stands in its place.
    pub defaults: Vec<DefaultUsed>,
    /// Who does the runs.
    pub runs_by: SimulatorEntry,
    /// Scenes under their conditions as a program of the user runs them; empty where the scenes here are run.
    pub command_models: BTreeMap<String, CommandModel>,
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
    /// line where it is known, key, value and the way out.
    pub fn read(path: &Path, profile: Option<&str>) -> Result<Self, Error> {
        let text = input::file::read_text(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        let mut problems = Problems::default();
        let document = Document::parse(&text, &path.display().to_string(), &mut problems);
        let Some(document) = document else {
            return Err(problems
                .into_result()
                .err()
                .unwrap_or(Error::Problems { list: Vec::new() }));
        };
        let file = StudyFile::of(&document, &mut problems);
        let checker = Checker {
            document: &document,
            folder: path.parent().unwrap_or(Path::new("")),
            file: &file,
            problems,
        };
        let checked = checker.check(profile)?;
        Ok(Self {
            path: path.to_owned(),
            profile: profile.map(str::to_owned),
            inputs: inputs::of(path, &file, &checked)?,
            runs_by: checked.choices.simulator.unwrap_or(file.simulator.clone()),
            file,
            scenes: checked.scenes,
            models: checked.models,
            problem: checked.problem,
            settings: checked.settings,
            budget: checked.choices.budget.unwrap_or_default(),
            compare: checked.choices.compare.unwrap_or_default(),
            photos: checked.photos,
            not_applicable: checked.not_applicable,
            defaults: checked.defaults,
            command_models: checked.command_models,
        })
    }

    /// Name of the result folder: that of the study, with that of the profile.
    pub fn folder_name(&self) -> String {
        match &self.profile {
            Some(profile) => format!("{}-{profile}", self.problem.id),
            None => self.problem.id.clone(),
        }
    }

    /// What does the runs; other codes work in the folder `work` of the result folder.
    ///
    /// # Errors
    ///
    /// A mesh or a template that cannot be read, a code that is not there.
    pub fn simulator(&self, folder: &Path) -> Result<StudySimulator, Error> {
        let work = folder.join("work");
        match &self.runs_by {
            SimulatorEntry::Own => Ok(StudySimulator::Own(self.scene_simulator()?)),
            SimulatorEntry::Peer(entry) => {
                let settings = PeerSettings {
                    peer: entry.peer,
                    command: entry.command.clone(),
                    ranks: entry.ranks,
                    environment: entry.environment.clone().into_iter().collect(),
                    wall_limit_s: entry.wall_limit_s,
                    work,
                    keep: entry.keep,
                };
                let peer = PeerSimulator::new(self.scene_simulator()?, settings)?;
                Ok(StudySimulator::Peer(peer))
            }
            SimulatorEntry::Command(entry) => {
                let folder = self.path.parent().unwrap_or(Path::new(""));
                let settings = CommandSettings {
                    command: entry.command.clone(),
                    template: entry.template.as_ref().map(|t| folder.join(t)),
                    version: entry.version.clone(),
                    wall_limit_s: entry.wall_limit_s,
                    expected_s: entry.expected_s,
                    results: entry.results.clone(),
                    work,
                    keep: entry.keep,
                };
                let parameters = self.file.parameters.iter().map(|p| p.symbol.clone());
                let effects = self.file.effects.iter().map(|e| e.name.clone());
                let coarse = self.problem.coarse_graining.iter();
                let coarse = coarse.map(|_| CoarseGraining::SYMBOL.to_owned());
                let names: Vec<String> = parameters.chain(effects).chain(coarse).collect();
                let models = self.command_models.clone();
                let command = CommandSimulator::new(settings, models, &names)?;
                Ok(StudySimulator::Command(command))
            }
        }
    }

    /// The scenes as a simulator.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read.
    fn scene_simulator(&self) -> Result<SceneSimulator, Error> {
        let binding = |p: &Parameter| {
            let binding = Binding {
                paths: p.sets.clone(),
                unit: (p.unit != "1").then(|| p.unit.clone()),
            };
            (p.symbol.clone(), binding)
        };
        let entries = self.file.parameters.iter();
        let amplitudes = entries.filter_map(|e| Some((e.symbol.clone(), e.effect.clone()?)));
        let of_settings = self
            .problem
            .parameters
            .iter()
            .filter(|p| !p.sets.is_empty());
        let bindings = of_settings.map(binding).collect();
        let mut scenes = SceneSimulator::new(self.models.clone(), bindings)?;
        if self.problem.coarse_graining.is_some() {
            scenes = scenes.with_coarse_graining(CoarseGraining::SYMBOL);
        }
        Ok(scenes.with_amplitudes(amplitudes.collect()))
    }
}

/// What the check gives.
pub(crate) struct Checked {
    /// Scenes by name.
    pub(crate) scenes: BTreeMap<String, Scene>,
    /// Scenes by model.
    pub(crate) models: BTreeMap<String, Scene>,
    /// Photos.
    pub(crate) photos: Vec<PhotoSeries>,
    /// What is asked.
    problem: CalibrationProblem,
    /// Settings of the loop.
    settings: LoopSettings,
    /// Optional tables, with those of the profile.
    choices: Choices,
    /// Effects left out.
    not_applicable: BTreeMap<String, String>,
    /// What was filled in.
    defaults: Vec<DefaultUsed>,
    /// Scenes as a program of the user runs them.
    command_models: BTreeMap<String, CommandModel>,
}

/// Tells what is searched where the file does not say it: candidates for the next measurement, and effects.
fn tell_searched(
    file: &StudyFile,
    choices: &Choices,
    (candidates, probes): (&[Candidate], &[EffectProbe]),
    defaults: &mut Defaults,
) {
    if file.candidates.is_none() && !candidates.is_empty() {
        let names: Vec<&str> = candidates.iter().map(|c| c.model.name.as_str()).collect();
        let why = "what could be measured next: levels between and beyond the measured ones, scenes not measured";
        defaults.tell("candidate", &names.join("; "), why);
    }
    if choices.effects.is_none() {
        let why = "all effects of the library that a measured scene can carry";
        defaults.tell("effects.search", &probes.len().to_string(), why);
    }
}

/// The scene of each model, by its name.
fn scenes_by_model(all: &[&Models]) -> BTreeMap<String, Scene> {
    let each = all.iter().flat_map(|models| {
        let names = models.models.iter().map(|m| m.name.clone());
        names.zip(models.scenes.iter().cloned())
    });
    each.collect()
}

/// Notes on which parameters each model depends.
fn bind(models: &mut Models, file: &StudyFile) {
    for k in 0..models.models.len() {
        let all = file.parameters.iter().enumerate();
        let of_model = all.filter_map(|(j, p)| models.depends_on(k, p).then_some(j));
        models.models[k].parameters = of_model.collect();
    }
}

/// The coarse graining of the models of its scenes; an error that the file leaves out is told.
fn coarse_graining(
    file: &StudyFile,
    models: &[Model],
    defaults: &mut Defaults,
) -> Option<CoarseGraining> {
    let entry = file.coarse_graining.as_ref()?;
    let is_coarse = |k: &usize| entry.scenes.contains(&models[*k].scene);
    let error = entry.error.unwrap_or_else(|| {
        let why = "what the size adds to an error is at most that of the measurement";
        defaults.tell("coarse_graining: error", &USUAL_ERROR.to_string(), why);
        USUAL_ERROR
    });
    Some(CoarseGraining {
        models: (0..models.len()).filter(is_coarse).collect(),
        factors: entry.factors.clone(),
        error,
    })
}

/// A file that is being checked.
struct Checker<'a> {
    /// With lines.
    document: &'a Document,
    /// To which its paths refer.
    folder: &'a Path,
    /// Its entries.
    file: &'a StudyFile,
    /// What is wrong so far.
    problems: Problems,
}

impl Checker<'_> {
    /// Checks everything.
    fn check(mut self, profile: Option<&str>) -> Result<Checked, Error> {
        let (file, document) = (self.file, self.document);
        let choices = self.choices(profile);
        check_all(document, &file.parameters, &mut self.problems);
        if let SimulatorEntry::Command(entry) = &file.simulator {
            return self.check_command(choices, entry);
        }
        let scenes = Scenes::read(document, file, &choices, self.folder, &mut self.problems);
        let names: Vec<&str> = file.scenes.iter().map(|s| s.name.as_str()).collect();
        let before = self.problems.count();
        let resolved = Resolved::all(
            &scenes,
            &file.measured,
            self.folder,
            &names,
            &mut self.problems,
        );
        let scenes_known = scenes.by_name.len() == names.len();
        let measured_well = self.problems.count() == before && scenes_known;
        let mut defaults = Defaults::default();
        let parameters = self.parameters(&scenes, &resolved, measured_well, &mut defaults);
        let settings = Self::settings(&choices, &mut defaults);
        let known = Known {
            document,
            models: &resolved.models.models,
            measurements: &resolved.measurements,
        };
        let problems = &mut self.problems;
        let searches = choices.effects.as_ref().is_none_or(|e| !e.is_empty());
        let (candidates, offered) = if measured_well && searches {
            candidates::of_scenes(&scenes, file, &known, &resolved.models, problems)
        } else {
            <(Vec<Candidate>, Models)>::default()
        };
        let Searched {
            probes,
            not_applicable,
        } = search(
            choices.effects.as_deref(),
            &resolved.models,
            &resolved.measurements,
            &scenes,
            &offered,
        );
        tell_searched(file, &choices, (&candidates, &probes), &mut defaults);
        let Resolved {
            measurements,
            correlations,
            mut models,
            photos,
            ..
        } = resolved;
        bind(&mut models, file);
        let coarse_graining = self.coarse_graining(&models, &scenes, &mut defaults);
        let by_model = scenes_by_model(&[&models, &offered]);
        let problem = CalibrationProblem {
            id: file.name.clone(),
            parameters,
            models: models.models,
            measurements,
            correlations,
            effects: probes,
            candidates,
            coarse_graining,
        };
        if measured_well {
            self.check_compare(&choices, &problem);
        }
        self.check_whole(&problem);
        self.problems.into_result()?;
        Ok(Checked {
            scenes: scenes.by_name,
            models: by_model,
            photos,
            problem,
            settings,
            choices,
            not_applicable,
            defaults: defaults.list,
            command_models: BTreeMap::new(),
        })
    }

    /// Checks a study whose runs a program of the user does.
    fn check_command(mut self, choices: Choices, entry: &CommandEntry) -> Result<Checked, Error> {
        let (file, document) = (self.file, self.document);
        let checker = CommandChecker {
            document,
            file,
            entry,
            folder: self.folder,
        };
        let mut resolved = checker.resolve(&mut self.problems);
        checker.check_effects(&choices, &mut self.problems);
        let mut defaults = Defaults::default();
        let resolver = Resolver {
            document,
            models: &Models::default(),
            scenes_known: false,
            complete: false,
            tables: &[],
            fillings: None,
            peer: None,
        };
        let all = file.parameters.iter();
        let parameters = all
            .map(|entry| resolver.resolve(entry, &mut defaults, &mut self.problems))
            .collect();
        let settings = Self::settings(&choices, &mut defaults);
        let coarse_graining = coarse_graining(file, &resolved.models, &mut defaults);
        for &model in coarse_graining.iter().flat_map(|coarse| &coarse.models) {
            if let Some(run) = resolved.runs.get_mut(&resolved.models[model].name) {
                run.parameters.push(CoarseGraining::SYMBOL.to_owned());
            }
        }
        let problem = CalibrationProblem {
            id: file.name.clone(),
            parameters,
            models: resolved.models,
            measurements: resolved.measurements,
            correlations: resolved.correlations,
            effects: probes(file, choices.effects.as_deref()),
            candidates: resolved.candidates,
            coarse_graining,
        };
        self.check_compare(&choices, &problem);
        self.check_whole(&problem);
        self.problems.into_result()?;
        Ok(Checked {
            scenes: BTreeMap::new(),
            models: BTreeMap::new(),
            photos: resolved.photos,
            problem,
            settings,
            choices,
            not_applicable: BTreeMap::new(),
            defaults: defaults.list,
            command_models: resolved.runs,
        })
    }

    /// The optional tables with those of the profile on top; refuses profiles that are not there, and changes of
    /// scenes that are not there in any profile.
    fn choices(&mut self, profile: Option<&str>) -> Choices {
        let (file, document) = (self.file, self.document);
        let known: Vec<&str> = file.scenes.iter().map(|s| s.name.as_str()).collect();
        for (name, choices) in &file.profiles {
            for scene in choices.changes.keys() {
                if !known.contains(&scene.as_str()) {
                    let path = below(&below(&choices.path, "scene"), scene);
                    let what = format!("[profile.{name}]: scene.{scene}");
                    let problem = format!("changes no [[scene]]; there are {}", known.join(", "));
                    self.problems.add(document.problem(&path, what, problem));
                }
            }
        }
        let base = file.choices.clone();
        let Some(name) = profile else { return base };
        if let Some(profile) = file.profiles.get(name) {
            return base.under(profile);
        }
        let known: Vec<&str> = file.profiles.keys().map(String::as_str).collect();
        let known = match known.as_slice() {
            [] => "the file has no profile: leave it out".to_owned(),
            _ => format!("there are {}", known.join(", ")),
        };
        let what = format!("profile '{name}'");
        let problem = format!("is not defined; {known}");
        self.problems
            .add(document.problem("profile", what, problem));
        base
    }

    /// The parameters against the scenes.
    fn parameters(
        &mut self,
        scenes: &Scenes<'_>,
        resolved: &Resolved,
        measured_well: bool,
        defaults: &mut Defaults,
    ) -> Vec<Parameter> {
        // In the order of the file: a start that is left out is that of the first scene.
        let order = |name: &str| self.file.scenes.iter().position(|s| s.name == name);
        let mut names: Vec<&String> = scenes.by_name.keys().collect();
        names.sort_by_key(|name| order(name));
        let tables = tables(names.iter().map(|name| &scenes.by_name[*name]));
        let resolver = Resolver {
            document: self.document,
            models: &resolved.models,
            scenes_known: scenes.by_name.len() == self.file.scenes.len(),
            complete: measured_well,
            tables: &tables,
            fillings: measured_well.then_some(&scenes.fillings),
            peer: scenes.peer.filter(|_| measured_well),
        };
        let problems = &mut self.problems;
        let all = self.file.parameters.iter();
        all.map(|entry: &ParameterEntry| resolver.resolve(entry, defaults, problems))
            .collect()
    }

    /// Settings of the loop.
    fn settings(choices: &Choices, defaults: &mut Defaults) -> LoopSettings {
        // Each key was checked alone, and keys that could not be read were told.
        let settings: LoopSettings = choices.design.clone().try_into().unwrap_or_default();
        defaults.tell_design(&choices.design, &settings);
        let budget = choices.budget.unwrap_or_default();
        if budget == Budget::default() {
            defaults.tell("budget", "none", "the loop ends by its own rules");
        }
        LoopSettings {
            most_runs: budget.runs,
            ..settings
        }
    }

    /// The coarse graining of the scenes here; refuses scenes of single seeds, and sizes with which a measured scene cannot be built.
    fn coarse_graining(
        &mut self,
        models: &Models,
        scenes: &Scenes<'_>,
        defaults: &mut Defaults,
    ) -> Option<CoarseGraining> {
        let entry = self.file.coarse_graining.as_ref()?;
        let coarse = coarse_graining(self.file, &models.models, defaults)?;
        for &model in &coarse.models {
            let name = &models.models[model].name;
            let mut refuse = |key: &str, problem: String| {
                let at = below(&entry.path, key);
                let what = format!("[coarse_graining]: {key}:");
                let document = self.document;
                self.problems.add(document.problem(&at, what, problem));
            };
            if models.scenes[model].apparatus.is_bench_test() {
                refuse(
                    "scenes",
                    format!(
                        "{name} is a test of single seeds, which no coarser ones stand for: leave it out"
                    ),
                );
                continue;
            }
            for factor in &coarse.factors {
                let mut scene = models.scenes[model].clone();
                scene.coarsen_seeds(*factor);
                let built = scene.check();
                let built = built.and_then(|()| scene.build_check(&scenes.fillings));
                if let Err(error) = built {
                    refuse(
                        "factors",
                        format!(
                            "{factor} is where {name} cannot be built: {error}; take finer grains"
                        ),
                    );
                }
            }
        }
        Some(coarse)
    }

    /// Refuses published values of results that are not there.
    fn check_compare(&mut self, choices: &Choices, problem: &CalibrationProblem) {
        for entry in choices.compare.iter().flatten() {
            if let Err(reason) = resolve(&entry.result, problem) {
                let path = below(&entry.path, "result");
                let what = format!("[[compare]]: result = '{}'", entry.result);
                self.problems
                    .add(self.document.problem(&path, what, reason));
            }
        }
    }

    /// Refuses what only shows in the whole, where the parts are right.
    fn check_whole(&mut self, problem: &CalibrationProblem) {
        plausible::check(self.document, &mut self.problems);
        if self.problems.count() > 0 {
            return;
        }
        if let Err(inference::Error::Problem { lines }) = problem.check() {
            for line in lines {
                self.problems.add(Problem {
                    file: self.document.file.clone(),
                    line: None,
                    what: "the study:".into(),
                    problem: line,
                });
            }
        }
    }
}
