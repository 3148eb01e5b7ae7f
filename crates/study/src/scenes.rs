//! From the entries of a study file to scenes, and to the models that a calibration knows.

use crate::document::below;
use crate::file::{ParameterEntry, SceneEntry, StudyFile};
use crate::photos::Shown;
use crate::problem::Problems;
use crate::setting::{leaf, table_of};
use inference::Model;
use scene::{
    Apparatus, FillingLibrary, OBSERVABLES_OF_A_BED, OBSERVABLES_OF_PICTURES, Override, Scene,
};
use simulators::external_simulator::{CommandModel, Peer};
use simulators::scene_simulator::Binding;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// What a model runs: a scene, or what a program of the user does under the name of one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Setup {
    Scene(Box<Scene>),
    Command(Box<CommandModel>),
}

/// The scenes of a study, each read once with its changes.
pub(crate) struct Scenes<'a> {
    pub(crate) file: &'a StudyFile,
    /// Scenes by name; empty if a program of the user knows them.
    pub(crate) by_name: BTreeMap<String, Scene>,
    /// Bodies of the seeds, made once for the check, the runs and the decks.
    pub(crate) fillings: Arc<FillingLibrary>,
}

/// Changes `name = value`; texts without an equals sign were refused before.
fn overrides(changes: &[String]) -> impl Iterator<Item = Override> {
    let split = changes.iter().filter_map(|text| text.split_once('='));
    split.map(|(name, value)| Override::new(name.trim(), value.trim()))
}

impl<'a> Scenes<'a> {
    /// Reads all scene files, with the changes of the study.
    pub(crate) fn read(file: &'a StudyFile, folder: &Path, problems: &mut Problems) -> Self {
        let mut this = Self {
            file,
            by_name: BTreeMap::new(),
            fillings: Arc::default(),
        };
        let mut told = BTreeSet::new();
        for entry in &file.scene {
            // A program of the user knows scenes by name alone.
            let Some(of_file) = entry.file.as_ref().filter(|_| !file.is_of_command()) else {
                continue;
            };
            let of_file = folder.join(of_file);
            let read = Scene::read_all(&of_file, &[]).map_err(|reasons| {
                // Scenes of one file have its mistakes in common.
                let is_new = told.insert(of_file);
                let reasons = reasons.iter().map(ToString::to_string);
                reasons.filter(|_| is_new).collect::<Vec<_>>()
            });
            let measured = file.measured.iter().any(|m| m.scene == entry.name);
            let built = read.and_then(|scene| changed(scene, entry)).map(|scene| {
                // A scene that is measured is built under each of its conditions instead.
                let built = if measured {
                    Ok(())
                } else {
                    scene.build_check(&this.fillings)
                };
                this.by_name.insert(entry.name.clone(), scene);
                built
            });
            let reasons = match built {
                Ok(built) => built
                    .err()
                    .map(|error| error.to_string())
                    .into_iter()
                    .collect(),
                Err(reasons) => reasons,
            };
            for reason in reasons {
                problems.wrong(&entry.path, reason);
            }
        }
        this
    }

    /// Whether all scenes could be read; a program of the user knows its own.
    pub(crate) fn are_known(&self) -> bool {
        self.file.is_of_command() || self.by_name.len() == self.file.scene.len()
    }

    /// The other code that runs the scenes.
    pub(crate) fn peer(&self) -> Option<Peer> {
        self.file.simulator.peer()
    }

    /// What a scene under a condition runs.
    ///
    /// # Errors
    ///
    /// The key that is wrong and its fault; nothing if the scene itself was refused.
    pub(crate) fn setup(
        &self,
        name: &str,
        condition: &BTreeMap<String, String>,
    ) -> Result<Setup, Option<(&'static str, String)>> {
        let Some(entry) = self.file.scene.iter().find(|s| s.name == name) else {
            let names = self.file.scene_names();
            return Err(Some((
                "scene",
                format!("not a [[scene]]; the scenes are {names}"),
            )));
        };
        if self.file.is_of_command() {
            let stated = entry.parameters.as_ref();
            let all = self.file.parameter.iter().map(|p| p.symbol.clone());
            let depends = |symbol: &String| stated.is_none_or(|names| names.contains(symbol));
            return Ok(Setup::Command(Box::new(CommandModel {
                scene: name.to_owned(),
                condition: condition.clone(),
                parameters: all.filter(depends).collect(),
                drum: entry.drum.clone(),
            })));
        }
        let scene = self.by_name.get(name).ok_or(None)?;
        let changes = condition
            .iter()
            .map(|(name, value)| Override::new(name, value));
        let changed = scene.with(&changes.collect::<Vec<_>>());
        let scene = changed.map_err(|error| Some(("condition", error.to_string())))?;
        Ok(Setup::Scene(Box::new(scene)))
    }

    /// What runs of a setup give.
    pub(crate) fn observables<'s>(&self, setup: &'s Setup) -> Vec<&'s str>
    where
        'a: 's,
    {
        match setup {
            Setup::Scene(scene) => {
                let mut all = scene.observables();
                if self.peer().is_some() {
                    all.retain(|name| OBSERVABLES_OF_A_BED.contains(name));
                }
                all
            }
            Setup::Command(run) => {
                let results = self.file.simulator.results();
                let read = match (&results.positions, &results.pictures) {
                    (Some(_), _) => OBSERVABLES_OF_A_BED,
                    (None, Some(_)) => &OBSERVABLES_OF_PICTURES,
                    (None, None) => &[],
                };
                let entry = self.file.scene.iter().find(|s| s.name == run.scene);
                let own = entry.into_iter().flat_map(|s| &s.observables);
                read.iter()
                    .copied()
                    .chain(own.map(String::as_str))
                    .collect()
            }
        }
    }

    /// Why a setup cannot be run.
    pub(crate) fn refusal(&self, setup: &Setup) -> Option<String> {
        let not_taken = || Some(self.peer()?.check(setup.scene()?).err()?.to_string());
        self.unbuilt(setup).or_else(not_taken)
    }

    /// Why the world of a setup cannot be built.
    pub(crate) fn unbuilt(&self, setup: &Setup) -> Option<String> {
        Some(
            setup
                .scene()?
                .build_check(&self.fillings)
                .err()?
                .to_string(),
        )
    }
}

impl Setup {
    /// The scene; `None` of a program of the user.
    pub(crate) fn scene(&self) -> Option<&Scene> {
        match self {
            Self::Scene(scene) => Some(scene),
            Self::Command(_) => None,
        }
    }

    /// What photos of it show.
    pub(crate) fn shown<'o>(&self, observables: &'o [&'o str]) -> Shown<'o> {
        let scene = self.scene();
        let heap = scene.map(|scene| scene.apparatus.shows_a_heap());
        Shown {
            heap: heap.unwrap_or_else(|| observables.contains(&"angle_of_repose_deg")),
            radius: scene.map(|scene| scene.apparatus.radius()),
            observables,
        }
    }
}

/// The scene of a file as an entry changes it, or all that is wrong with that.
fn changed(mut scene: Scene, entry: &SceneEntry) -> Result<Scene, Vec<String>> {
    let told = |error: scene::Error| vec![error.to_string()];
    if let Some(apparatus) = &entry.apparatus {
        let apparatus = apparatus.clone().try_into::<Apparatus>();
        let apparatus =
            apparatus.map_err(|e| vec![format!("invalid apparatus: {}", e.message())])?;
        scene = scene.in_apparatus(apparatus).map_err(told)?;
    }
    // One after the other, so that all that are wrong are reported.
    let mut wrong = Vec::new();
    for change in overrides(&entry.changes) {
        match scene.with(std::slice::from_ref(&change)) {
            Ok(changed) => scene = changed,
            Err(error) => {
                let Override { name, value } = change;
                wrong.push(format!("change '{name} = {value}': {error}"));
            }
        }
    }
    if wrong.is_empty() {
        Ok(scene)
    } else {
        Err(wrong)
    }
}

/// The models of a study.
#[derive(Debug, Default)]
pub(crate) struct Models {
    /// As the calibration knows them.
    pub(crate) models: Vec<Model>,
    /// What they run, in the same order.
    pub(crate) setups: Vec<Setup>,
}

impl Models {
    /// Number of the model of a scene under a condition, and whether it is new; the same scene under another name of
    /// the condition is the same model.
    pub(crate) fn number_of(
        &mut self,
        name: &str,
        condition: &BTreeMap<String, String>,
        setup: Setup,
    ) -> (usize, bool) {
        let full_name = model_name(name, condition);
        // A program of the user knows a scene under a condition by its name alone.
        let is_same = |(m, s): (&Model, &Setup)| {
            m.name == full_name || (s.scene().is_some() && m.scene == name && *s == setup)
        };
        let mut all = self.models.iter().zip(&self.setups);
        if let Some(known) = all.position(is_same) {
            return (known, false);
        }
        self.models.push(Model {
            name: full_name,
            scene: name.to_owned(),
            condition: condition.clone(),
            parameters: Vec::new(),
        });
        self.setups.push(setup);
        (self.models.len() - 1, true)
    }

    /// Notes on which parameters each model depends.
    pub(crate) fn bind(&mut self, parameters: &[ParameterEntry]) {
        for model in 0..self.models.len() {
            let all = parameters.iter().enumerate();
            let of_model = all.filter_map(|(j, p)| self.depends_on(model, p).then_some(j));
            self.models[model].parameters = of_model.collect();
        }
    }

    /// Whether a run of a model depends on a parameter: at its two ends of the range the scene differs in what can
    /// matter.
    pub(crate) fn depends_on(&self, model: usize, entry: &ParameterEntry) -> bool {
        if let Setup::Command(run) = &self.setups[model] {
            return run.parameters.contains(&entry.symbol);
        }
        let at = |value| {
            let scene = self.at(model, entry, value)?;
            // A value that the scene refuses is reported elsewhere.
            Some(scene.ok().map(|scene| scene.reduced()))
        };
        at(entry.low) != at(entry.high)
    }

    /// The scene of a model at a value of a parameter; `None` if it has none of its settings.
    pub(crate) fn at(
        &self,
        model: usize,
        entry: &ParameterEntry,
        value: f64,
    ) -> Option<Result<Scene, scene::Error>> {
        let scene = self.setups[model].scene()?;
        let name = &self.models[model].scene;
        if entry
            .scenes
            .as_ref()
            .is_some_and(|names| !names.contains(name))
        {
            return None;
        }
        if let Some(effect) = &entry.effect {
            let mut scene = scene.clone();
            // A scene that cannot carry an effect does not have it.
            simulators::effects::apply(&mut scene, effect, value, &FillingLibrary::default())
                .ok()?;
            return Some(Ok(scene));
        }
        let table = table_of(scene);
        let changes = entry
            .binding()
            .changes(|path| leaf(&table, path).is_some(), value);
        (!changes.is_empty()).then(|| scene.with(&changes))
    }

    /// Each scene by the name of its model.
    pub(crate) fn scenes(&self) -> impl Iterator<Item = (String, Scene)> {
        let all = self.models.iter().zip(&self.setups);
        all.filter_map(|(model, setup)| Some((model.name.clone(), setup.scene()?.clone())))
    }

    /// Each scene as a program of the user runs it, by the name of its model.
    pub(crate) fn commands(&self) -> impl Iterator<Item = (String, CommandModel)> {
        let all = self.models.iter().zip(&self.setups);
        all.filter_map(|(model, setup)| match setup {
            Setup::Command(run) => Some((model.name.clone(), CommandModel::clone(run))),
            Setup::Scene(_) => None,
        })
    }
}

impl ParameterEntry {
    /// The settings that it sets.
    pub(crate) fn binding(&self) -> Binding {
        Binding {
            paths: self.sets.clone(),
            unit: self
                .unit
                .clone()
                .filter(|unit| unit != "1" && !unit.is_empty()),
        }
    }

    /// A path of its table in the file.
    pub(crate) fn at(&self, key: &str) -> String {
        below(&self.path, key)
    }
}

/// The name of a model: `drum`, or `drum @ apparatus.speed = 15 rpm`.
pub(crate) fn model_name(scene: &str, condition: &BTreeMap<String, String>) -> String {
    if condition.is_empty() {
        scene.to_owned()
    } else {
        let one = |(name, value): (&String, &String)| format!("{name} = {value}");
        let condition: Vec<String> = condition.iter().map(one).collect();
        format!("{scene} @ {}", condition.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::{Path, Problems, Scenes, StudyFile};
    use crate::document::Document;

    /// The drum of the example holds 1200 seeds, its slice under the conditions 320: as it is it would not fit, and to try
    /// takes seconds. Nothing is made of it.
    #[test]
    fn a_scene_measured_under_conditions_is_not_built_without_one() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton");
        let text = std::fs::read_to_string(folder.join("blind.toml")).unwrap();
        let mut problems = Problems::of(Document::parse(&text, "blind.toml").unwrap());
        let file = StudyFile::read(None, &mut problems);
        let scenes = Scenes::read(&file, &folder, &mut problems);
        problems.into_result().unwrap();
        assert!(scenes.by_name.contains_key("drum"));
        assert!(scenes.fillings.is_empty());
    }
}
