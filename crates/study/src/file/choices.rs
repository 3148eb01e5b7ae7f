//! The optional tables, of the file and of its profiles.

use super::parts::{NUMBER, changes, each};
use super::simulator::simulator;
use super::{Budget, Choices, CompareEntry, SimulatorEntry};
use crate::document::Fields;
use crate::keys;
use crate::limits::{MOST, MOST_RUNS};
use crate::problem::Problems;
use inference::LoopSettings;
use std::collections::BTreeMap;
use toml::Table;

/// The optional tables of the file or of a profile; `of_command` where a program of the user does the runs.
pub(super) fn choices(fields: &Fields<'_>, of_command: bool, problems: &mut Problems) -> Choices {
    let budget = fields.table("budget", problems).map(|budget| {
        budget.check_keys(&keys::BUDGET, problems);
        let found = Budget {
            runs: budget.optional("runs", "a whole number", problems),
            core_hours: budget.optional("core_hours", NUMBER, problems),
        };
        if found.runs == Some(0) {
            problems.add(budget.wrong("runs", "must be 1 or more"));
        }
        if found.core_hours.is_some_and(|h| !(h > 0.0 && h <= MOST)) {
            problems.add(budget.wrong("core_hours", "must be above 0, at most 1e15"));
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
        let names = found.iter().flatten();
        for (k, name) in names.clone().enumerate() {
            if names.clone().take(k).any(|before| before == name) {
                let problem = format!("names '{name}' twice: remove one of them");
                problems.add(effects.wrong("search", problem));
            }
        }
        // Those of a program of the user stand in the file, and are looked for there.
        for name in found.iter().flatten().filter(|_| !of_command) {
            if let Err(error) = simulators::effects::find(name) {
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
    let in_profile = !fields.path.is_empty() && fields.table.contains_key("simulator");
    let simulator = in_profile.then(|| {
        let entry = simulator(fields, problems);
        if of_command || matches!(entry, SimulatorEntry::Command(_)) {
            let problem = "cannot change to or from a program of the user: its scenes are others; write a study of its own";
            problems.add(fields.wrong("simulator", problem));
        }
        entry
    });
    Choices {
        simulator,
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

/// Valid settings of the loop, each checked alone.
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
                problems.add(design.wrong(key, format!("is invalid: {reason}")));
            }
        }
    }
    kept
}

/// The first setting of the loop that is too small or too large, with what it must be.
fn out_of_range(settings: &LoopSettings) -> Option<(&'static str, String)> {
    let alpha = settings.screening_alpha;
    if !(alpha > 0.0 && alpha < 1.0) {
        return Some(("screening_alpha", "must lie between 0 and 1".into()));
    }
    let counts = [
        ("replicates", settings.replicates, 1),
        ("centre_points", settings.centre_points, 0),
        ("screening_least", settings.screening_least, 1),
        ("before_runs", settings.before_runs, 0),
        ("confirmation_runs", settings.confirmation_runs, 2),
        ("check_runs", settings.check_runs, 2),
        ("most_confirmations", settings.most_confirmations, 0),
        ("most_boxes", settings.most_boxes, 1),
        // They give the noise of the simulator.
        ("diagnosis_replicates", settings.diagnosis_replicates, 2),
    ];
    let is_wrong = |(_, count, least): &(&str, usize, usize)| !(*least..=MOST_RUNS).contains(count);
    let (key, _, least) = counts.into_iter().find(is_wrong)?;
    Some((key, format!("must be {least} to {MOST_RUNS}")))
}
