//! From the entries of a study file to scenes, and to the models that a calibration knows.

use crate::document::Document;
use crate::file::{Choices, ParameterEntry, SceneEntry, SimulatorEntry, StudyFile};
use crate::problem::{Problem, Problems};
use crate::setting::{change, leaf, table_of};
use inference::Model;
use scene::{Apparatus, FillingLibrary, Override, Scene};
use simulators::external_simulator::Peer;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The scenes of a study, each read once with its changes.
pub(crate) struct Scenes<'a> {
    /// The study file.
    pub(crate) document: &'a Document,
    /// Scenes by name.
    pub(crate) by_name: BTreeMap<String, Scene>,
    /// Another code that runs them.
    pub(crate) peer: Option<Peer>,
    /// Bodies made for the check.
    pub(crate) fillings: FillingLibrary,
}

/// Changes `name = value`; texts without an equals sign were refused before.
fn overrides(changes: &[String]) -> Vec<Override> {
    let split = |text: &String| {
        let (name, value) = text.split_once('=')?;
        Some(Override {
            name: name.trim().into(),
            value: value.trim().into(),
        })
    };
    changes.iter().filter_map(split).collect()
}

impl<'a> Scenes<'a> {
    /// Reads all scenes, with the changes of the file and then those of the choices.
    pub(crate) fn read(
        document: &'a Document,
        file: &StudyFile,
        choices: &Choices,
        folder: &Path,
        problems: &mut Problems,
    ) -> Self {
        let mut by_name = BTreeMap::new();
        let fillings = FillingLibrary::default();
        let mut told = BTreeSet::new();
        for entry in &file.scenes {
            let further = choices.changes.get(&entry.name);
            let further = further.map_or(&[][..], Vec::as_slice);
            let at = |reason: String| scene_problem(document, entry, reason);
            let of_file = folder.join(entry.file.clone().unwrap_or_default());
            let scene = match Scene::read_all(&of_file, &[]) {
                Ok(scene) => scene,
                Err(reasons) => {
                    // Scenes of one file have its mistakes in common.
                    if told.insert(of_file) {
                        let reasons = reasons.iter().map(ToString::to_string);
                        reasons.for_each(|reason| problems.add(at(reason)));
                    }
                    continue;
                }
            };
            match changed(scene, entry, further) {
                Ok(scene) => {
                    // A scene that is measured is built under each of its conditions instead.
                    let measured = file.measured.iter().any(|m| m.scene == entry.name);
                    if !measured && let Err(error) = scene.build_check(&fillings) {
                        problems.add(at(error.to_string()));
                    }
                    by_name.insert(entry.name.clone(), scene);
                }
                Err(reasons) => reasons.into_iter().for_each(|r| problems.add(at(r))),
            }
        }
        let peer = match choices.simulator.as_ref().unwrap_or(&file.simulator) {
            SimulatorEntry::Peer(entry) => Some(entry.peer),
            _ => None,
        };
        Self {
            document,
            by_name,
            peer,
            fillings,
        }
    }

    /// The scene under a condition.
    pub(crate) fn under(
        &self,
        name: &str,
        condition: &BTreeMap<String, String>,
    ) -> Option<Result<Scene, scene::Error>> {
        let scene = self.by_name.get(name)?;
        let changes: Vec<Override> = condition
            .iter()
            .map(|(name, value)| Override {
                name: name.clone(),
                value: value.clone(),
            })
            .collect();
        Some(scene.with(&changes))
    }
}

/// A problem of a scene.
fn scene_problem(document: &Document, entry: &SceneEntry, reason: String) -> Problem {
    let what = format!("[[scene]] '{}':", entry.name);
    document.problem(&entry.path, what, reason)
}

/// The scene of a file as an entry changes it, or all that is wrong with that.
fn changed(mut scene: Scene, entry: &SceneEntry, further: &[String]) -> Result<Scene, Vec<String>> {
    let told = |error: scene::Error| vec![error.to_string()];
    if let Some(apparatus) = &entry.apparatus {
        let apparatus: Apparatus = apparatus
            .clone()
            .try_into()
            .map_err(|e: toml::de::Error| vec![format!("apparatus is invalid: {}", e.message())])?;
        scene = scene.in_apparatus(apparatus).map_err(told)?;
    }
    // One after the other, so that all that are wrong are told.
    let mut wrong = Vec::new();
    for change in overrides(&entry.changes)
        .into_iter()
        .chain(overrides(further))
    {
        match scene.with(std::slice::from_ref(&change)) {
            Ok(changed) => scene = changed,
            Err(error) => wrong.push(format!(
                "change '{} = {}': {error}",
                change.name, change.value
            )),
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
    /// As the calibration knows them; their parameters are found later.
    pub(crate) models: Vec<Model>,
    /// The scenes that they run, in the same order.
    pub(crate) scenes: Vec<Scene>,
}

impl Models {
    /// Number of the model of a scene under a condition, and whether it is new; the same scene under another name of
    /// the condition is the same model.
    pub(crate) fn number_of(
        &mut self,
        name: &str,
        condition: &BTreeMap<String, String>,
        scene: Scene,
    ) -> (usize, bool) {
        let mut all = self.models.iter().zip(&self.scenes);
        if let Some(known) = all.position(|(m, s)| m.scene == name && *s == scene) {
            return (known, false);
        }
        self.models.push(Model {
            name: model_name(name, condition),
            scene: name.to_owned(),
            condition: condition.clone(),
            parameters: Vec::new(),
        });
        self.scenes.push(scene);
        (self.models.len() - 1, true)
    }

    /// Whether a run of a model depends on a parameter: at its two ends of the range the scene differs in what can
    /// matter.
    pub(crate) fn depends_on(&self, model: usize, entry: &ParameterEntry) -> bool {
        let at = |value| {
            let scene = self.at(model, entry, value)?;
            // A value that the scene refuses is told elsewhere.
            Some(scene.ok().map(|scene| scene.reduced()))
        };
        at(entry.low) != at(entry.high)
    }

    /// Whether a model can be built at a value of a parameter; none where it has none of its settings.
    pub(crate) fn built_at(
        &self,
        model: usize,
        entry: &ParameterEntry,
        value: f64,
        fillings: &FillingLibrary,
    ) -> Option<Result<(), scene::Error>> {
        let scene = self.at(model, entry, value)?;
        Some(scene.and_then(|scene| scene.build_check(fillings)))
    }

    /// The scene of a model at a value of a parameter; none where it has none of its settings.
    pub(crate) fn at(
        &self,
        model: usize,
        entry: &ParameterEntry,
        value: f64,
    ) -> Option<Result<Scene, scene::Error>> {
        let scene = self.scenes.get(model)?;
        let name = &self.models[model].scene;
        let acts = entry
            .scenes
            .as_ref()
            .is_none_or(|names| names.contains(name));
        if !acts {
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
        let of_scene = entry.sets.iter().filter(|p| leaf(&table, p).is_some());
        let changes: Vec<Override> = of_scene
            .map(|path| change(path, value, entry.unit.as_deref()))
            .collect();
        (!changes.is_empty()).then(|| scene.with(&changes))
    }
}

/// The name of a model: `drum`, or `drum @ apparatus.speed = 15 rpm`.
pub(crate) fn model_name(scene: &str, condition: &BTreeMap<String, String>) -> String {
    if condition.is_empty() {
        scene.to_owned()
    } else {
        format!("{scene} @ {}", condition_text(condition))
    }
}

/// A condition in words.
pub(crate) fn condition_text(condition: &BTreeMap<String, String>) -> String {
    let one = |(name, value): (&String, &String)| format!("{name} = {value}");
    condition.iter().map(one).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::{Choices, Document, Path, Problems, Scenes, StudyFile};

    /// The drum of the example holds 1200 seeds, its slice under the conditions 320: as it is it would not fit, and to try
    /// takes seconds. Nothing is made of it.
    #[test]
    fn a_scene_measured_under_conditions_is_not_built_without_one() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton");
        let text = std::fs::read_to_string(folder.join("blind.toml")).unwrap();
        let mut problems = Problems::default();
        let document = Document::parse(&text, "blind.toml", &mut problems).unwrap();
        let file = StudyFile::of(&document, &mut problems);
        let choices = Choices::default();
        let scenes = Scenes::read(&document, &file, &choices, &folder, &mut problems);
        problems.into_result().unwrap();
        assert!(scenes.by_name.contains_key("drum"));
        assert!(scenes.fillings.is_empty());
    }
}
