//! `[[input]]`: what the user weighed, counted or measured, with its error.

use super::check::refuse_unknown_scenes;
use super::{ParameterEntry, StudyFile};
use crate::document::below;
use crate::limits::physical_limits;
use crate::plausible::wrong_name;
use crate::problem::Problems;
use inference::Prior;
use serde::Deserialize;
use simulators::effects::{Effect, find};

/// How far an input may move, in standard deviations. Our choice: of right ones 3 in 1000 lie beyond.
const REACH: f64 = 3.0;
/// Inputs that pictures of a bed depend on, as effects of the library, with the errors that they have if the file states none, as shares:
/// seeds are counted, or weighed and divided by the mass of one of them, to some per cent, and a few calipered seeds give the mean size
/// of all to less. Our choice.
const BEHIND_PHOTOS: [(&str, f64); 2] = [("seed-count", 0.03), ("seed-size", 0.01)];

/// An input: settings with the value that the scenes have, or an effect by which the truth may deviate from what the scenes state.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InputEntry {
    #[serde(rename = "(path)")]
    pub(super) path: String,
    effect: Option<String>,
    sets: Option<Vec<String>>,
    symbol: Option<String>,
    name: Option<String>,
    unit: Option<String>,
    mean: Option<f64>,
    sd: f64,
    scenes: Option<Vec<String>>,
}

impl InputEntry {
    /// The parameter that it is; `None` if it is wrong.
    pub(super) fn parameter(
        &self,
        of_command: bool,
        problems: &mut Problems,
    ) -> Option<ParameterEntry> {
        let (before, at) = (problems.count(), |key: &str| below(&self.path, key));
        for (key, text) in [("symbol", &self.symbol), ("name", &self.name)] {
            if let Some(problem) = text.as_deref().and_then(wrong_name) {
                problems.wrong(&at(key), problem);
            }
        }
        let holds = self.sd.is_finite() && self.sd >= 0.0;
        problems.require(
            holds,
            &at("sd"),
            "must be 0 or more; 0 if the input is exact",
        );
        // A program of the user gets an input by its symbol.
        let symbol = self.symbol.clone().filter(|_| of_command);
        let sets = symbol.map(|symbol| vec![symbol]).or(self.sets.clone());
        let found = match (&self.effect, sets) {
            (None, Some(sets)) => self.stated(sets, problems),
            (Some(name), None) => self.deviation(name, problems),
            _ if of_command => {
                problems.wrong(&self.path, "has no 'symbol': add it");
                None
            }
            _ => {
                let problem = "needs one of 'effect', such as \"seed-count\", and 'sets', the settings that it is the value of";
                problems.wrong(&self.path, problem);
                None
            }
        };
        found.filter(|_| problems.count() == before)
    }

    /// Settings whose value the file repeats.
    fn stated(&self, sets: Vec<String>, problems: &mut Problems) -> Option<ParameterEntry> {
        let problem = "has no 'mean': add the value that the scenes have";
        problems.require(self.mean.is_some(), &self.path, problem);
        let problem = "is empty: name the settings of the scenes";
        problems.require(!sets.is_empty(), &below(&self.path, "sets"), problem);
        let first = sets.first()?.clone();
        let known = sets.iter().filter_map(|path| physical_limits(path));
        let possible = known.fold([f64::NEG_INFINITY, f64::INFINITY], |a, b| {
            [a[0].max(b[0]), a[1].min(b[1])]
        });
        let prior = Prior {
            mean: self.mean?,
            sd: self.sd,
        };
        Some(ParameterEntry {
            name: self.name.clone().or(Some(first.clone())),
            symbol: self.symbol.clone().unwrap_or(first),
            sets,
            unit: self.unit.clone(),
            scenes: self.scenes.clone(),
            ..about(prior, possible, &self.path)
        })
    }

    /// An effect of the library.
    fn deviation(&self, effect: &str, problems: &mut Problems) -> Option<ParameterEntry> {
        for (key, is_there) in [("mean", self.mean.is_some()), ("unit", self.unit.is_some())] {
            let problem = "is only for an input with 'sets': an effect deviates from what the scenes state, 0 on average, in its own unit";
            problems.require(!is_there, &below(&self.path, key), problem);
        }
        let found = find(effect);
        if let Err(error) = &found {
            problems.wrong(&below(&self.path, "effect"), error.to_string());
        }
        let of_effect = of_effect(found.ok()?, self.sd, &self.path);
        Some(ParameterEntry {
            symbol: self.symbol.clone().unwrap_or(of_effect.symbol),
            name: self.name.clone().or(of_effect.name),
            scenes: self.scenes.clone(),
            ..of_effect
        })
    }
}

/// An effect of the library as an input.
fn of_effect(effect: &Effect, sd: f64, path: &str) -> ParameterEntry {
    ParameterEntry {
        symbol: effect.name.replace('-', "_"),
        name: Some(format!("{}, deviation from what is stated", effect.name)),
        effect: Some(effect.name.to_owned()),
        unit: (effect.unit != "1").then(|| effect.unit.to_owned()),
        ..about(Prior { mean: 0.0, sd }, effect.range, path)
    }
}

/// An input without names, about its mean and within what is possible.
fn about(prior: Prior, [least, most]: [f64; 2], path: &str) -> ParameterEntry {
    let Prior { mean, sd } = prior;
    let (low, high) = (
        (mean - REACH * sd).max(least.min(mean)),
        (mean + REACH * sd).min(most.max(mean)),
    );
    ParameterEntry {
        path: path.to_owned(),
        symbol: String::new(),
        name: None,
        sets: Vec::new(),
        unit: None,
        low,
        high,
        limits: Some([low, high]),
        start: Some(mean),
        prior: Some(prior),
        is_input: true,
        effect: None,
        scenes: None,
    }
}

/// The inputs that have an error, with those that photos depend on if the file does not state them.
pub(super) fn complete(
    file: &StudyFile,
    mut inputs: Vec<ParameterEntry>,
    problems: &mut Problems,
) -> Vec<ParameterEntry> {
    let names: Vec<&str> = file.scene.iter().map(|s| s.name.as_str()).collect();
    for input in &inputs {
        let scenes = input.scenes.as_deref().unwrap_or_default();
        refuse_unknown_scenes(scenes, &input.path, &names, problems);
    }
    let photographed = |name: &&str| {
        let mut measured = file.measured.iter();
        measured.any(|m| m.scene == **name && !m.photos.is_empty())
    };
    let scenes: Vec<String> = names
        .into_iter()
        .filter(photographed)
        .map(str::to_owned)
        .collect();
    for (name, sd) in BEHIND_PHOTOS {
        let is_stated = |input: &ParameterEntry| input.effect.as_deref() == Some(name);
        if file.is_of_command() || scenes.is_empty() || inputs.iter().any(is_stated) {
            continue;
        }
        inputs.extend(find(name).map(|effect| ParameterEntry {
            scenes: Some(scenes.clone()),
            ..of_effect(effect, sd, "")
        }));
    }
    inputs.retain(|input| input.prior.is_some_and(|prior| prior.sd > 0.0));
    inputs
}
