//! A study whose runs a program of the user does: what it gives and takes, checked without a scene file.

use crate::candidates;
use crate::correlated::correlations_of;
use crate::document::{Document, below};
use crate::file::{
    Choices, CommandEntry, MeasuredEntry, ParameterEntry, SceneEntry, StudyFile, usable_name,
};
use crate::measured::{Known, push, read_photos, words};
use crate::photo_values::shown_fill;
use crate::photos::{PhotoSeries, Shown};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use crate::scenes::model_name;
use inference::{Candidate, Correlation, EffectProbe, Measurement, Model, Role};
use scene::{OBSERVABLES_OF_A_BED, OBSERVABLES_OF_PICTURES};
use simulators::external_simulator::{CommandModel, variable};
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// Names that every run has.
const TAKEN: [&str; 2] = ["scene", "seed"];
/// Name of the place in a command for all values.
const ALL: &str = "arguments";

/// Models and measurements of such a study.
#[derive(Debug, Default)]
pub(crate) struct CommandResolved {
    /// As the calibration knows them.
    pub(crate) models: Vec<Model>,
    /// As the program runs them, by name.
    pub(crate) runs: BTreeMap<String, CommandModel>,
    /// What was measured.
    pub(crate) measurements: Vec<Measurement>,
    /// Which of them are correlated.
    pub(crate) correlations: Vec<Correlation>,
    /// Photos that were read.
    pub(crate) photos: Vec<PhotoSeries>,
    /// What could be measured next.
    pub(crate) candidates: Vec<Candidate>,
}

/// Checks scenes, names and measurements against each other.
pub(crate) struct CommandChecker<'a> {
    /// The study file with its lines.
    pub(crate) document: &'a Document,
    /// Its entries.
    pub(crate) file: &'a StudyFile,
    /// The program.
    pub(crate) entry: &'a CommandEntry,
    /// To which paths refer.
    pub(crate) folder: &'a Path,
}

impl CommandChecker<'_> {
    /// Resolves all measurements.
    pub(crate) fn resolve(&self, problems: &mut Problems) -> CommandResolved {
        self.check_names(problems);
        self.check_template(problems);
        for scene in &self.file.scenes {
            self.check_scene(scene, problems);
        }
        let mut resolved = CommandResolved::default();
        let mut known: Known = Vec::new();
        for entry in &self.file.measured {
            let Some(scene) = self.file.scenes.iter().find(|s| s.name == entry.scene) else {
                let names: Vec<&str> = self.file.scenes.iter().map(|s| s.name.as_str()).collect();
                let problem = format!(
                    "is the name of no [[scene]]; there are {}",
                    names.join(", ")
                );
                let what = format!("[[measured]]: scene = '{}'", entry.scene);
                let path = below(&entry.path, "scene");
                problems.add(self.document.problem(&path, what, problem));
                continue;
            };
            self.add(scene, entry, &mut resolved, &mut known, problems);
        }
        self.add_candidates(&mut resolved, problems);
        resolved
    }

    /// Adds what could be measured next.
    fn add_candidates(&self, resolved: &mut CommandResolved, problems: &mut Problems) {
        let known = candidates::Known {
            document: self.document,
            models: &resolved.models,
            measurements: &resolved.measurements,
        };
        let mut found: Vec<Candidate> = Vec::new();
        let mut runs = BTreeMap::new();
        for offer in candidates::offers(self.file) {
            let Some(scene) = self.file.scenes.iter().find(|s| s.name == offer.scene) else {
                let names: Vec<&str> = self.file.scenes.iter().map(|s| s.name.as_str()).collect();
                let problem = format!("is of no [[scene]]; there are {}", names.join(", "));
                offer.refuse("scene", &problem, self.document, problems);
                continue;
            };
            let (model, run) = self.model_of(scene, &offer.condition);
            if resolved.models.iter().any(|m| m.name == model.name) {
                let problem = "is measured already: raise n there to measure it more often";
                offer.refuse("condition", problem, self.document, problems);
                continue;
            }
            let standard_errors = offer.standard_errors(&self.observables(scene), &known, problems);
            if standard_errors.is_empty() || runs.contains_key(&model.name) {
                continue;
            }
            runs.insert(model.name.clone(), run);
            found.push(Candidate {
                model,
                standard_errors,
                minutes: offer.minutes(),
            });
        }
        resolved.candidates = found;
        resolved.runs.extend(runs);
    }

    /// Observables of a scene: what is read of its bed, and what the file says that the program tells.
    fn observables<'s>(&self, scene: &'s SceneEntry) -> Vec<&'s str> {
        let results = &self.entry.results;
        let read = match (&results.positions, &results.pictures) {
            (Some(_), _) => OBSERVABLES_OF_A_BED,
            (None, Some(_)) => &OBSERVABLES_OF_PICTURES,
            (None, None) => &[],
        };
        let told = scene.observables.iter().flatten().map(String::as_str);
        read.iter().copied().chain(told).collect()
    }

    /// Adds a measurement.
    fn add(
        &self,
        scene: &SceneEntry,
        entry: &MeasuredEntry,
        resolved: &mut CommandResolved,
        known: &mut Known,
        problems: &mut Problems,
    ) {
        let document = self.document;
        let observables = self.observables(scene);
        let mut values = Vec::new();
        for (name, value) in &entry.values {
            if observables.contains(&name.as_str()) {
                values.push((name.clone(), *value));
                continue;
            }
            let what = format!("{}: '{name}'", words(entry));
            let known = if observables.is_empty() {
                "none".to_owned()
            } else {
                observables.join(", ")
            };
            let problem = format!(
                "is neither a key of [[measured]] ({}) nor an observable of this scene, which has {known}: add what the \
                 program tells to [[scene]] observables",
                crate::keys::MEASURED.join(", ")
            );
            problems.add(document.problem(&below(&entry.path, name), what, problem));
        }
        let heap = observables.contains(&"angle_of_repose_deg");
        let shown = Shown {
            heap,
            radius: None,
            observables: &observables,
        };
        let series = read_photos(document, entry, self.folder, shown, problems);
        let taken = series.iter().flat_map(|s| &s.values);
        values.extend(taken.map(|(name, value)| (name.clone(), *value)));
        let model = self.model(scene, entry, resolved);
        let values = values.into_iter().map(|value| (value, entry.role));
        let fill = shown_fill(series.as_ref(), entry).map(|value| (value, Role::Show));
        for ((observable, value), role) in values.chain(fill) {
            let measurement = Measurement {
                model,
                observable,
                role,
                mean: value.mean,
                sd: value.sd,
                n: value.n,
            };
            push(
                document,
                entry,
                measurement,
                (&mut resolved.measurements, known),
                problems,
            );
        }
        let of_model = (model, &resolved.measurements[..]);
        let found = correlations_of(document, entry, series.as_ref(), of_model, problems);
        resolved.correlations.extend(found);
        resolved.photos.extend(series);
    }

    /// Number of the model of a scene under the condition of a measurement.
    fn model(
        &self,
        scene: &SceneEntry,
        entry: &MeasuredEntry,
        resolved: &mut CommandResolved,
    ) -> usize {
        let (model, run) = self.model_of(scene, &entry.condition);
        if let Some(known) = resolved.models.iter().position(|m| m.name == model.name) {
            return known;
        }
        resolved.runs.insert(model.name.clone(), run);
        resolved.models.push(model);
        resolved.models.len() - 1
    }

    /// The model of a scene under a condition, and how the program runs it.
    fn model_of(
        &self,
        scene: &SceneEntry,
        condition: &BTreeMap<String, String>,
    ) -> (Model, CommandModel) {
        let depends = |p: &ParameterEntry| {
            let stated = scene.parameters.as_ref();
            stated.is_none_or(|names| names.contains(&p.symbol))
        };
        let all = self.file.parameters.iter().enumerate();
        let parameters: Vec<usize> = all.filter(|(_, p)| depends(p)).map(|(k, _)| k).collect();
        let symbols = parameters
            .iter()
            .map(|k| self.file.parameters[*k].symbol.clone());
        let run = CommandModel {
            scene: scene.name.clone(),
            condition: condition.clone(),
            parameters: symbols.collect(),
            drum: scene.drum.clone(),
        };
        let model = Model {
            name: model_name(&scene.name, condition),
            scene: scene.name.clone(),
            condition: condition.clone(),
            parameters,
        };
        (model, run)
    }

    /// Refuses names that no command line takes, and names of two things.
    fn check_names(&self, problems: &mut Problems) {
        let file = self.file;
        let parameters = file
            .parameters
            .iter()
            .map(|p| (&p.symbol, &p.path, "symbol"));
        let effects = file.effects.iter().map(|e| (&e.name, &e.path, "name"));
        let measured = file.measured.iter().map(|m| (&m.condition, &m.path));
        let offered = file.candidates.iter().flatten();
        let offered = offered.map(|c| (&c.condition, &c.path));
        let conditions = measured.chain(offered).flat_map(|(condition, path)| {
            let names = condition.keys();
            names.map(move |name| (name, path, "condition"))
        });
        let mut variables: BTreeMap<String, (&str, &str)> =
            TAKEN.map(|name| (variable(name), (name, "run"))).into();
        for (name, path, key) in parameters.chain(effects).chain(conditions) {
            let name = name.as_str();
            let path = below(path, key);
            let mut wrong = |problem: String| {
                let what = format!("{key} '{name}'");
                problems.add(self.document.problem(&path, what, problem));
            };
            let variable = variable(name);
            if !usable_name(name) {
                wrong(
                    "must begin with a letter, and hold letters, digits, '_', '-' and '.'".into(),
                );
            } else if let Some(problem) = wrong_name(name) {
                wrong(problem);
            } else if name == ALL {
                wrong("stands for all values in a command: take another".into());
            } else if TAKEN.contains(&name) {
                wrong(format!(
                    "is a name that every run has: take another than {}",
                    TAKEN.join(", ")
                ));
            } else if let Some((_, other)) = variables
                .get(&variable)
                .filter(|(n, k)| *n == name && *k != key)
            {
                wrong(format!(
                    "is also the name of a {other}: the program could not tell them apart"
                ));
            } else if let Some((other, _)) = variables.get(&variable).filter(|(n, _)| *n != name) {
                wrong(format!(
                    "reaches the program as {variable}, as '{other}' does: take names that differ in more than capitals and signs"
                ));
            }
            variables.entry(variable).or_insert((name, key));
        }
    }

    /// Refuses a template that is no folder.
    fn check_template(&self, problems: &mut Problems) {
        let Some(template) = &self.entry.template else {
            return;
        };
        let folder = self.folder.join(template);
        if !folder.is_dir() {
            let what = format!("[simulator] template = '{}'", template.display());
            let problem = format!("names no folder: there is no {}", folder.display());
            let path = below("simulator", "template");
            problems.add(self.document.problem(&path, what, problem));
            return;
        }
        // The results of the study would become a part of what each run gets.
        let here = self.folder.join(".").canonicalize();
        if let (Ok(here), Ok(whole)) = (here, folder.canonicalize())
            && here.starts_with(whole)
        {
            let what = format!("[simulator] template = '{}'", template.display());
            let problem = "holds the study itself: give the files of a run a folder of their own";
            let path = below("simulator", "template");
            problems.add(self.document.problem(&path, what, problem));
        }
    }

    /// Refuses effects to search that the program does not have.
    pub(crate) fn check_effects(&self, choices: &Choices, problems: &mut Problems) {
        let known: Vec<&str> = self.file.effects.iter().map(|e| e.name.as_str()).collect();
        for name in choices.effects.iter().flatten() {
            if !known.contains(&name.as_str()) {
                let path = below(&below(&choices.path, "effects"), "search");
                let what = format!("[effects]: search: '{name}'");
                let problem = format!(
                    "is the name of no [[effect]] of the program; there are {}",
                    known.join(", ")
                );
                problems.add(self.document.problem(&path, what, problem));
            }
        }
    }

    /// Refuses an invalid drum, and parameters that are not there.
    fn check_scene(&self, scene: &SceneEntry, problems: &mut Problems) {
        let file = self.file;
        let words = format!("[[scene]] '{}':", scene.name);
        // Of one that is wrong elsewhere the symbol is known all the same.
        let parameters = ["parameter", "input"].map(|kind| self.document.table.get(kind));
        let parameters = parameters.into_iter().flatten();
        let parameters = parameters.filter_map(Value::as_array).flatten();
        let symbols = parameters.filter_map(|p| p.get("symbol").and_then(Value::as_str));
        let symbols: Vec<&str> = symbols.collect();
        for name in scene.parameters.iter().flatten() {
            if !symbols.contains(&name.as_str()) {
                let path = below(&scene.path, "parameters");
                let what = format!("{words} parameters: '{name}'");
                let problem = "is the symbol of no [[parameter]] and no [[input]]";
                problems.add(self.document.problem(&path, what, problem));
            }
        }
        if let Some(drum) = &scene.drum {
            let conditions = file.measured.iter().filter(|m| m.scene == scene.name);
            let conditions = conditions.flat_map(|m| m.condition.keys().cloned());
            let parameters = file.parameters.iter().map(|p| p.symbol.clone());
            let names: Vec<String> = conditions.chain(parameters).collect();
            if let Err(problem) = drum.check(&names) {
                let path = below(&scene.path, "drum");
                problems.add(self.document.problem(&path, words, problem));
            }
        }
    }
}

/// Effects that the program has, and of which the study wants to be told.
pub(crate) fn probes(file: &StudyFile, named: Option<&[String]>) -> Vec<EffectProbe> {
    let wanted = |name: &String| named.is_none_or(|names| names.contains(name));
    let all = file.effects.iter().filter(|e| wanted(&e.name));
    all.map(|e| EffectProbe {
        name: e.name.clone(),
        probe: e.probe,
        range: e.range,
        absent: BTreeMap::new(),
    })
    .collect()
}
