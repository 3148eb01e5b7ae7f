//! The tables of a study file, one by one.

use super::{
    Budget, Choices, CompareEntry, MeasuredEntry, MeasuredValue, ParameterEntry, PhotoOptions,
    SceneEntry, settings,
};
use crate::document::{Document, Fields, below};
use crate::keys;
use crate::problem::Problems;
use calibration::{LoopSettings, Prior};
use quantity::Angle;
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::{Table, Value};

/// What a number must be, for messages.
const NUMBER: &str = "a number";
/// What a change of a scene must be.
const CHANGES: &str = "a list of texts \"name = value\"";

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
    let name: Option<String> = fields.required("name", "a text", problems);
    let file: Option<PathBuf> = fields.required("file", "the path of a scene file", problems);
    let changes = changes(fields, problems);
    let apparatus = fields.table("apparatus", problems);
    if let Some(name) = &name
        && (name.trim().is_empty() || name.contains(['@', '/']))
    {
        problems.add(fields.wrong("name", "must be a word without '@' and '/'"));
    }
    Some(SceneEntry {
        name: name?,
        file: file?,
        changes,
        apparatus: apparatus.map(|a| a.table.clone()),
        path: fields.path.clone(),
    })
}

/// Changes of a scene; those without an equals sign are told.
fn changes(fields: &Fields<'_>, problems: &mut Problems) -> Vec<String> {
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

/// Leaves out scenes whose name stands there twice.
pub(super) fn refuse_twice(
    document: &Document,
    scenes: &mut Vec<SceneEntry>,
    problems: &mut Problems,
) {
    let mut seen: Vec<String> = Vec::new();
    scenes.retain(|scene| {
        let twice = seen.contains(&scene.name);
        if twice {
            let what = format!("[[scene]] '{}'", scene.name);
            let problem = "stands there twice: give each scene a name of its own";
            problems.add(document.problem(&scene.path, what, problem));
        }
        seen.push(scene.name.clone());
        !twice
    });
}

/// A `[[parameter]]`.
pub(super) fn parameter(fields: &Fields<'_>, problems: &mut Problems) -> Option<ParameterEntry> {
    let symbol: Option<String> = fields.required("symbol", "a text", problems);
    let fields = &Fields {
        words: match &symbol {
            Some(symbol) => format!("[[parameter]] {symbol}"),
            None => fields.words.clone(),
        },
        ..fields.clone()
    };
    fields.check_keys(&keys::PARAMETER, problems);
    let name = fields.optional("name", "a text", problems);
    let sets: Option<Vec<String>> = fields.required("sets", "a list of dotted paths", problems);
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
        photos,
        photo: photo.unwrap_or_default(),
        path: fields.path.clone(),
    })
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
    demand("mean", mean.is_none_or(f64::is_finite), "must be finite");
    demand(
        "sd",
        sd.is_none_or(|sd| sd.is_finite() && sd > 0.0),
        "must be above 0: the standard deviation of the single values; where only one was read, the error of the \
         reading",
    );
    demand(
        "n",
        n.is_none_or(|n| n.is_finite() && n >= 1.0),
        "must be 1 or more: the number of independent values behind the mean",
    );
    Some(MeasuredValue {
        mean: mean?,
        sd: sd?,
        n: n?,
    })
}

/// How photos are read.
fn photo_options(fields: &Fields<'_>, problems: &mut Problems) -> PhotoOptions {
    fields.check_keys(&keys::PHOTO, problems);
    let definition: Option<String> = fields.optional("definition", "\"line\"", problems);
    if definition.is_some_and(|d| d != "line") {
        problems.add(fields.wrong(
            "definition",
            "cannot be compared: the angle of a simulated frame is that of the line through the whole surface; \
             write \"line\"",
        ));
    }
    let roll: Option<Angle> = fields.optional("roll", "an angle such as \"0.4 deg\"", problems);
    let drum = fields.optional("drum", "three numbers [cx, cy, r] in px", problems);
    let corners: Option<String> = fields.optional("corners", "a text", problems);
    let corners = corners.and_then(|text| {
        let found = corners_of(&text);
        if found.is_none() {
            let problem = "must be \"X,Y;X,Y;X,Y;X,Y\" in px: upper left, upper right, lower right, lower left";
            problems.add(fields.wrong("corners", problem));
        }
        found
    });
    let kinds = "\"auto\", \"dark\" or \"light\"";
    let foreground = fields.optional("foreground", kinds, problems);
    PhotoOptions {
        roll_rad: roll.map_or(0.0, Angle::si),
        drum,
        corners,
        foreground: foreground.unwrap_or_default(),
    }
}

/// Four corners `X,Y` with semicolons between them.
fn corners_of(text: &str) -> Option<[[f64; 2]; 4]> {
    let point = |pair: &str| -> Option<[f64; 2]> {
        let (x, y) = pair.split_once(',')?;
        let finite = |t: &str| t.trim().parse().ok().filter(|v: &f64| v.is_finite());
        Some([finite(x)?, finite(y)?])
    };
    let all: Option<Vec<_>> = text.split(';').map(point).collect();
    all?.try_into().ok()
}

/// The optional tables of the file or of a profile.
pub(super) fn choices(fields: &Fields<'_>, problems: &mut Problems) -> Choices {
    let budget = fields.table("budget", problems).map(|budget| {
        budget.check_keys(&keys::BUDGET, problems);
        let found = Budget {
            runs: budget.optional("runs", "a whole number", problems),
            core_hours: budget.optional("core_hours", NUMBER, problems),
        };
        if found.runs == Some(0) {
            problems.add(budget.wrong("runs", "must be 1 or more"));
        }
        if found
            .core_hours
            .is_some_and(|h| !(h.is_finite() && h > 0.0))
        {
            problems.add(budget.wrong("core_hours", "must be above 0"));
        }
        if found.runs.is_some() && found.core_hours.is_some() {
            problems.add(budget.wrong("core_hours", "stands beside 'runs': keep one of both"));
        }
        found
    });
    let effects = fields.table("effects", problems);
    let effects = effects.and_then(|effects| {
        effects.check_keys(&keys::EFFECTS, problems);
        let found: Option<Vec<String>> =
            effects.optional("search", "a list of names of effects", problems);
        for name in found.iter().flatten() {
            if let Err(error) = effect_library::find(name) {
                problems.add(effects.wrong("search", format!(": {error}")));
            }
        }
        found
    });
    let compare = fields.table.contains_key("compare").then(|| {
        let list = fields.list("compare", problems);
        each(&list, problems, compare)
    });
    let mut changed = BTreeMap::new();
    if !fields.path.is_empty()
        && let Some(scenes) = fields.table("scene", problems)
    {
        for name in scenes.table.keys() {
            if let Some(scene) = scenes.table(name, problems) {
                scene.check_keys(&keys::PROFILE_SCENE, problems);
                changed.insert(name.clone(), changes(&scene, problems));
            }
        }
    }
    Choices {
        design: design(fields, problems),
        budget,
        effects,
        compare,
        changes: changed,
        path: fields.path.clone(),
    }
}

/// A `[[compare]]`.
fn compare(fields: &Fields<'_>, problems: &mut Problems) -> Option<CompareEntry> {
    fields.check_keys(&keys::COMPARE, problems);
    let result = fields.required("result", "the name of a result", problems);
    let value = fields.required("value", NUMBER, problems);
    let sd: Option<f64> = fields.optional("sd", NUMBER, problems);
    if sd.is_some_and(|sd| !(sd.is_finite() && sd > 0.0)) {
        problems.add(fields.wrong("sd", "must be above 0, or left out"));
    }
    let source = fields.required(
        "source",
        "a text that says where it was published",
        problems,
    );
    Some(CompareEntry {
        result: result?,
        value: value?,
        sd,
        source: source?,
        path: fields.path.clone(),
    })
}

/// Settings of the loop that can be meant, each checked alone.
fn design(fields: &Fields<'_>, problems: &mut Problems) -> Table {
    let Some(design) = fields.table("design", problems) else {
        return Table::new();
    };
    design.check_keys(&keys::DESIGN, problems);
    let mut kept = Table::new();
    for (key, value) in design.table {
        if !keys::DESIGN.contains(&key.as_str()) {
            continue;
        }
        let alone = Table::from_iter([(key.clone(), value.clone())]);
        match alone.clone().try_into::<LoopSettings>() {
            Ok(settings) => match out_of_range(&settings) {
                Some((wrong, problem)) if wrong == key => problems.add(design.wrong(key, problem)),
                _ => kept.extend(alone),
            },
            Err(error) => {
                let reason = error.message().replace('\n', ", ");
                problems.add(design.wrong(key, format!("cannot be meant: {reason}")));
            }
        }
    }
    kept
}

/// The first setting of the loop that is too small, with what it must be.
fn out_of_range(settings: &LoopSettings) -> Option<(&'static str, &'static str)> {
    let alpha = settings.screening_alpha;
    let demands = [
        (settings.replicates >= 1, "replicates", "must be 1 or more"),
        (
            alpha > 0.0 && alpha < 1.0,
            "screening_alpha",
            "must lie between 0 and 1",
        ),
        (
            settings.screening_least >= 1,
            "screening_least",
            "must be 1 or more",
        ),
        (
            settings.confirmation_runs >= 1,
            "confirmation_runs",
            "must be 1 or more",
        ),
        (settings.check_runs >= 1, "check_runs", "must be 1 or more"),
        (settings.most_boxes >= 1, "most_boxes", "must be 1 or more"),
        (
            settings.diagnosis_replicates >= 2,
            "diagnosis_replicates",
            "must be 2 or more: they give the noise of the simulator",
        ),
    ];
    let wrong = demands.into_iter().find(|(holds, ..)| !holds);
    wrong.map(|(_, key, problem)| (key, problem))
}
