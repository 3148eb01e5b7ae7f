//! `[[input]]`: what the user weighed, counted or measured, with its error.

use super::parts::NUMBER;
use super::{MeasuredEntry, ParameterEntry};
use crate::document::{Document, Fields, below};
use crate::keys;
use crate::limits::physical_limits;
use crate::plausible::wrong_name;
use crate::problem::Problems;
use inference::Prior;
use simulators::effects::{Effect, find};

/// How far an input may move, in standard deviations. Our choice: of right ones 3 in 1000 lie beyond.
const REACH: f64 = 3.0;
/// Inputs that pictures of a bed depend on, as effects of the library, with the errors that they have if the file states none, as shares:
/// seeds are counted, or weighed and divided by the mass of one of them, to some per cent, and a few calipered seeds tell the mean size
/// of all to less. Our choice.
const BEHIND_PHOTOS: [(&str, f64); 2] = [("seed-count", 0.03), ("seed-size", 0.01)];

/// A `[[input]]` of the scenes: an effect of the library, by which the truth may deviate from what is stated, or settings.
pub(super) fn input(fields: &Fields<'_>, problems: &mut Problems) -> Option<ParameterEntry> {
    fields.check_keys(&keys::INPUT, problems);
    let effect: Option<String> = fields.optional("effect", "the name of an effect", problems);
    let sets: Option<Vec<String>> = fields.optional("sets", "a list of dotted paths", problems);
    let scenes = fields.optional("scenes", "a list of names of scenes", problems);
    if effect.is_some() == sets.is_some() {
        let problem = "needs one of 'effect', such as \"seed-count\", and 'sets', the settings that it stands for";
        let what = fields.words.clone();
        problems.add(fields.document.problem(&fields.path, what, problem));
        return None;
    }
    let Some(name) = effect else {
        let entry = stated(fields, sets, problems)?;
        return Some(ParameterEntry { scenes, ..entry });
    };
    for key in ["mean", "unit"] {
        if fields.table.contains_key(key) {
            let problem = "belongs to an input with 'sets': an effect deviates from what the scenes state, 0 on average, in its own unit";
            problems.add(fields.wrong(key, problem));
        }
    }
    let sd = sd(fields, problems);
    let found = find(&name);
    if let Err(error) = &found {
        problems.add(fields.wrong("effect", format!("cannot be used: {error}")));
    }
    let symbol: Option<String> = text(fields, "symbol", problems);
    let words = text(fields, "name", problems);
    let mut entry = of_effect(found.ok()?, sd?, &fields.path);
    entry.symbol = symbol.unwrap_or(entry.symbol);
    entry.name = words.or(entry.name);
    entry.scenes = scenes;
    Some(entry)
}

/// A `[[input]]` that a program of the user is told by its symbol.
pub(super) fn command_input(
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<ParameterEntry> {
    fields.check_keys(&keys::INPUT_COMMAND, problems);
    let symbol: Option<String> = fields.required("symbol", "a text", problems);
    stated(fields, symbol.map(|symbol| vec![symbol]), problems)
}

/// An input whose value the file repeats.
fn stated(
    fields: &Fields<'_>,
    sets: Option<Vec<String>>,
    problems: &mut Problems,
) -> Option<ParameterEntry> {
    let symbol = text(fields, "symbol", problems);
    let name = text(fields, "name", problems);
    let unit = fields.optional("unit", "a text such as \"mm\"", problems);
    let mean: Option<f64> = fields.required("mean", NUMBER, problems);
    let (mean, sd, sets) = (mean, sd(fields, problems), sets?);
    let (mean, sd) = (mean?, sd?);
    let Some(first) = sets.first().cloned() else {
        problems.add(fields.wrong("sets", "is empty: name the settings of the scenes"));
        return None;
    };
    let known = sets.iter().filter_map(|path| physical_limits(path));
    let narrowest = known.fold([f64::NEG_INFINITY, f64::INFINITY], |a, b| {
        [a[0].max(b[0]), a[1].min(b[1])]
    });
    Some(ParameterEntry {
        name: Some(name.unwrap_or_else(|| first.clone())),
        symbol: symbol.unwrap_or(first),
        sets,
        unit,
        ..about(Prior { mean, sd }, narrowest, &fields.path)
    })
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
        path: path.to_owned(),
    }
}

/// The standard deviation; 0 says that the input is right.
fn sd(fields: &Fields<'_>, problems: &mut Problems) -> Option<f64> {
    let sd: f64 = fields.required("sd", NUMBER, problems)?;
    if !(sd.is_finite() && sd >= 0.0) {
        problems.add(fields.wrong("sd", "must be 0, for an input that is exact, or more"));
        return None;
    }
    Some(sd)
}

/// A name that may be left out.
fn text(fields: &Fields<'_>, key: &str, problems: &mut Problems) -> Option<String> {
    let text: Option<String> = fields.optional(key, "a text", problems);
    if let Some(problem) = text.as_deref().and_then(wrong_name) {
        problems.add(fields.wrong(key, problem));
    }
    text
}

/// Adds the inputs that photos depend on where the file does not state them, and leaves out those that it states to be exact.
pub(super) fn complete(
    document: &Document,
    mut inputs: Vec<ParameterEntry>,
    measured: &[MeasuredEntry],
    problems: &mut Problems,
) -> Vec<ParameterEntry> {
    let names = document.table.get("scene").and_then(toml::Value::as_array);
    let names = names.into_iter().flatten();
    let names: Vec<&str> = names.filter_map(|s| s.get("name")?.as_str()).collect();
    for input in &inputs {
        for (k, name) in input.scenes.iter().flatten().enumerate() {
            if !names.contains(&name.as_str()) {
                let at = below(&below(&input.path, "scenes"), k);
                let what = format!("[[input]] {}: scenes: '{name}'", input.symbol);
                let problem = format!("is no [[scene]]; there are {}", names.join(", "));
                problems.add(document.problem(&at, what, problem));
            }
        }
    }
    let mut scenes: Vec<String> = Vec::new();
    for entry in measured.iter().filter(|m| !m.photos.is_empty()) {
        if !scenes.contains(&entry.scene) {
            scenes.push(entry.scene.clone());
        }
    }
    for (name, sd) in BEHIND_PHOTOS {
        let is_stated = |input: &ParameterEntry| input.effect.as_deref() == Some(name);
        if let (false, Ok(effect)) = (
            scenes.is_empty() || inputs.iter().any(is_stated),
            find(name),
        ) {
            inputs.push(ParameterEntry {
                scenes: Some(scenes.clone()),
                ..of_effect(effect, sd, "")
            });
        }
    }
    with_error(inputs)
}

/// Inputs that are not exact.
pub(super) fn with_error(mut inputs: Vec<ParameterEntry>) -> Vec<ParameterEntry> {
    inputs.retain(|input| input.prior.is_some_and(|prior| prior.sd > 0.0));
    inputs
}
