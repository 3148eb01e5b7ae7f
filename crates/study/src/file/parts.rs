//! The tables of a study file, one by one.

use super::photo::photo_options;
use super::simulator::drum as drum_of;
use super::{
    MeasuredCorrelation, MeasuredEntry, MeasuredValue, ParameterEntry, SceneEntry, settings,
};
use crate::document::{Document, Fields, below};
use crate::keys;
use crate::limits::{LEAST_RATIO, MOST, range_of};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use inference::Prior;
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::Value;

/// What a number must be, for messages.
pub(super) const NUMBER: &str = "a number";
/// What a change of a scene must be.
const CHANGES: &str = "a list of texts \"name = value\"";

/// How a `[[scene]]` is read.
pub(super) type ReadScene = fn(&Fields<'_>, &mut Problems) -> Option<SceneEntry>;
/// How a `[[parameter]]` is read.
pub(super) type ReadParameter = fn(&Fields<'_>, &mut Problems) -> Option<ParameterEntry>;

/// Entries of a list; those that cannot be read are left out.
pub(super) fn each<T>(
    list: &[Fields<'_>],
    problems: &mut Problems,
    read: fn(&Fields<'_>, &mut Problems) -> Option<T>,
) -> Vec<T> {
    list.iter()
        .filter_map(|fields| read(fields, problems))
        .collect()
}

/// A `[[scene]]`.
pub(super) fn scene(fields: &Fields<'_>, problems: &mut Problems) -> Option<SceneEntry> {
    fields.check_keys(&keys::SCENE, problems);
    let name = scene_name(fields, problems);
    let file: Option<PathBuf> = fields.required("file", "the path of a scene file", problems);
    let changes = changes(fields, problems);
    let apparatus = fields.table("apparatus", problems);
    Some(SceneEntry {
        name: name?,
        file: Some(file?),
        changes,
        apparatus: apparatus.map(|a| a.table.clone()),
        observables: None,
        parameters: None,
        drum: None,
        path: fields.path.clone(),
    })
}

/// A `[[scene]]` that a program of the user knows.
pub(super) fn command_scene(fields: &Fields<'_>, problems: &mut Problems) -> Option<SceneEntry> {
    fields.check_keys(&keys::SCENE_COMMAND, problems);
    let name = scene_name(fields, problems);
    let observables = names(fields, "observables", "a list of names", problems);
    let parameters = names(fields, "parameters", "a list of symbols", problems);
    let drum = fields.table("drum", problems);
    let drum = drum.and_then(|fields| drum_of(&fields, problems));
    Some(SceneEntry {
        name: name?,
        file: None,
        changes: Vec::new(),
        apparatus: None,
        observables,
        parameters,
        drum,
        path: fields.path.clone(),
    })
}

/// A list of names, each once.
fn names(
    fields: &Fields<'_>,
    key: &str,
    kind: &str,
    problems: &mut Problems,
) -> Option<Vec<String>> {
    let names: Option<Vec<String>> = fields.optional(key, kind, problems);
    for (k, name) in names.iter().flatten().enumerate() {
        let twice = names.iter().flatten().take(k).any(|before| before == name);
        let twice = twice.then(|| "stands there twice: name it once".to_owned());
        if let Some(problem) = wrong_name(name).or(twice) {
            let what = format!("{}: {key}: '{name}'", fields.words);
            let path = below(&below(&fields.path, key), k);
            problems.add(fields.document.problem(&path, what, problem));
        }
    }
    names
}

/// The name of a scene.
fn scene_name(fields: &Fields<'_>, problems: &mut Problems) -> Option<String> {
    let name: Option<String> = fields.required("name", "a text", problems);
    if let Some(name) = &name {
        if name.trim().is_empty() || name.contains(['@', '/']) {
            problems.add(fields.wrong("name", "must be a word without '@' and '/'"));
        } else if let Some(problem) = wrong_name(name) {
            problems.add(fields.wrong("name", problem));
        }
    }
    name
}

/// Changes of a scene; those without an equals sign are told.
pub(super) fn changes(fields: &Fields<'_>, problems: &mut Problems) -> Vec<String> {
    let changes: Option<Vec<String>> = fields.optional("changes", CHANGES, problems);
    let changes = changes.unwrap_or_default();
    for change in &changes {
        if !change.contains('=') {
            let what = format!("{}: change '{change}'", fields.words);
            let path = below(&fields.path, "changes");
            let problem = "has no '=': write \"name = value\"";
            problems.add(fields.document.problem(&path, what, problem));
        }
    }
    changes.into_iter().filter(|c| c.contains('=')).collect()
}

/// Leaves out entries of a kind whose name stands there twice; `named` gives the name of one and where it stands.
pub(super) fn refuse_twice<T>(
    document: &Document,
    kind: &str,
    entries: &mut Vec<T>,
    named: impl Fn(&T) -> (&str, &str),
    problems: &mut Problems,
) {
    let mut seen: Vec<String> = Vec::new();
    entries.retain(|entry| {
        let (name, path) = named(entry);
        let twice = seen.iter().any(|before| before == name);
        if twice {
            let what = format!("[[{kind}]] '{name}'");
            let problem = format!("stands there twice: give each {kind} a name of its own");
            problems.add(document.problem(path, what, problem));
        }
        seen.push(name.to_owned());
        !twice
    });
}

/// A `[[parameter]]` of the scenes.
pub(super) fn parameter(fields: &Fields<'_>, problems: &mut Problems) -> Option<ParameterEntry> {
    read_parameter(fields, true, problems)
}

/// A `[[parameter]]` of a program of the user, which is told by its symbol.
pub(super) fn command_parameter(
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<ParameterEntry> {
    read_parameter(fields, false, problems)
}

/// A `[[parameter]]` that sets settings of scenes, or is told by its symbol alone.
fn read_parameter(
    fields: &Fields<'_>,
    of_scenes: bool,
    problems: &mut Problems,
) -> Option<ParameterEntry> {
    let symbol: Option<String> = fields.required("symbol", "a text", problems);
    let fields = &Fields {
        words: match &symbol {
            Some(symbol) => format!("[[parameter]] {symbol}"),
            None => fields.words.clone(),
        },
        ..fields.clone()
    };
    let known: Vec<&str> = keys::PARAMETER.into_iter().collect();
    let known = known.into_iter().filter(|key| of_scenes || *key != "sets");
    fields.check_keys(&known.collect::<Vec<_>>(), problems);
    let name: Option<String> = fields.optional("name", "a text", problems);
    for (key, text) in [("symbol", &symbol), ("name", &name)] {
        if let Some(problem) = text.as_deref().and_then(wrong_name) {
            problems.add(fields.wrong(key, problem));
        }
    }
    let sets: Option<Vec<String>> = if of_scenes {
        fields.required("sets", "a list of dotted paths", problems)
    } else {
        symbol.clone().map(|symbol| vec![symbol])
    };
    if sets.as_ref().is_some_and(Vec::is_empty) {
        problems.add(fields.wrong("sets", "is empty: name the settings of the scenes"));
    }
    let unit = fields.optional("unit", "a text such as \"mm\"", problems);
    let low = fields.required("low", NUMBER, problems);
    let high = fields.required("high", NUMBER, problems);
    let limits = fields.optional("limits", "two numbers [lowest, highest]", problems);
    let start = fields.optional("start", NUMBER, problems);
    let prior = fields.table("prior", problems).and_then(|prior| {
        prior.check_keys(&keys::PRIOR, problems);
        let mean = prior.required("mean", NUMBER, problems);
        let sd = prior.required("sd", NUMBER, problems);
        Some(Prior {
            mean: mean?,
            sd: sd?,
        })
    });
    Some(ParameterEntry {
        symbol: symbol?,
        name,
        sets: sets?,
        unit,
        low: low?,
        high: high?,
        limits,
        start,
        prior,
        is_input: false,
        effect: None,
        scenes: None,
        path: fields.path.clone(),
    })
}

/// A `[[measured]]`; whether its other keys are observables of the scene is asked later.
pub(super) fn measured(fields: &Fields<'_>, problems: &mut Problems) -> Option<MeasuredEntry> {
    let scene = fields.required("scene", "the name of a [[scene]]", problems);
    let role = fields.required("role", "\"fit\", \"check\" or \"show\"", problems);
    let condition = fields.table("condition", problems);
    let condition = condition.map(|c| settings(&c, problems));
    let mut values = BTreeMap::new();
    for key in fields.table.keys() {
        if !keys::MEASURED.contains(&key.as_str()) {
            values.extend(value(fields, key, problems).map(|v| (key.clone(), v)));
        }
    }
    let photos = match fields.table.get("photos") {
        Some(Value::String(one)) => vec![PathBuf::from(one)],
        Some(_) => fields
            .optional("photos", "a folder, or a list of files", problems)
            .unwrap_or_default(),
        None => Vec::new(),
    };
    if fields.table.contains_key("photo") && !fields.table.contains_key("photos") {
        problems.add(fields.wrong(
            "photo",
            "says how to read photos, but there are no 'photos'",
        ));
    }
    let photo = fields.table("photo", problems);
    let photo = photo.map(|photo| photo_options(&photo, problems));
    let names_none = fields.table.get("photos").and_then(Value::as_array);
    if names_none.is_some_and(Vec::is_empty) {
        let problem = "is empty: name a folder or files, or remove the line";
        problems.add(fields.wrong("photos", problem));
    }
    let only_photos_wrong = fields.table.contains_key("photos") && photos.is_empty();
    if values.is_empty() && photos.is_empty() && !only_photos_wrong {
        let mut others = fields.table.keys();
        if others.all(|k| keys::MEASURED.contains(&k.as_str())) {
            let problem = "holds no measurement: add OBSERVABLE = { mean = ..., sd = ..., n = ... }, or photos";
            problems.add(
                fields
                    .document
                    .problem(&fields.path, fields.words.clone(), problem),
            );
        }
    }
    Some(MeasuredEntry {
        scene: scene?,
        condition: condition.unwrap_or_default(),
        role: role?,
        values,
        correlations: correlations(fields, problems),
        photos,
        photo: photo.unwrap_or_default(),
        path: fields.path.clone(),
    })
}

/// The correlations that a `[[measured]]` states.
fn correlations(fields: &Fields<'_>, problems: &mut Problems) -> Vec<MeasuredCorrelation> {
    let form = "a list of [\"OBSERVABLE\", \"OBSERVABLE\", correlation]";
    let stated: Option<Vec<(String, String, f64)>> = fields.optional("correlation", form, problems);
    let stated = stated.unwrap_or_default();
    if let Some((a, b, value)) = stated.iter().find(|c| c.2.is_nan() || c.2.abs() >= 1.0) {
        let problem = format!("of {a} and {b} is {value}: it must lie between -1 and 1");
        problems.add(fields.wrong("correlation", problem));
        return Vec::new();
    }
    let each = stated.into_iter();
    each.map(|(a, b, value)| MeasuredCorrelation { a, b, value })
        .collect()
}

/// The mean of one observable.
fn value(fields: &Fields<'_>, key: &str, problems: &mut Problems) -> Option<MeasuredValue> {
    if !matches!(fields.table.get(key), Some(Value::Table(_))) {
        let problem = format!(
            "is no key of [[measured]] ({}), nor a measurement {{ mean = ..., sd = ..., n = ... }}",
            keys::MEASURED.join(", ")
        );
        problems.add(fields.wrong(key, problem));
        return None;
    }
    let value = fields.table(key, problems)?;
    value.check_keys(&keys::VALUE, problems);
    let mean: Option<f64> = value.required("mean", NUMBER, problems);
    let sd: Option<f64> = value.required("sd", NUMBER, problems);
    let n: Option<f64> = value.required("n", NUMBER, problems);
    let mut demand = |key: &str, holds: bool, problem: &str| {
        if !holds {
            problems.add(value.wrong(key, problem));
        }
    };
    let ([least, most], unit) = range_of(key);
    demand(
        "mean",
        mean.is_none_or(|mean| (least..=most).contains(&mean)),
        &format!("must be {least} to {most}{unit}"),
    );
    demand(
        "sd",
        sd.is_none_or(|sd| sd > 0.0 && sd <= MOST),
        "must be above 0, at most 1e15: the standard deviation of the single values; where only one was read, the \
         error of the reading",
    );
    let is_exact = |sd: f64| sd > 0.0 && sd < LEAST_RATIO * mean.map_or(0.0, f64::abs);
    demand(
        "sd",
        !sd.is_some_and(is_exact),
        "is less than 1e-9 of the mean, which nothing is measured to: state the error of the reading",
    );
    demand(
        "n",
        n.is_none_or(|n| (1.0..=MOST).contains(&n)),
        "must be 1 or more, at most 1e15: the number of independent values behind the mean",
    );
    Some(MeasuredValue {
        mean: mean?,
        sd: sd?,
        n: n?,
    })
}
