//! A study whose runs a program of the user does: what it gets must have names that it can take.

use crate::document::below;
use crate::file::{SceneEntry, StudyFile, usable_name};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use simulators::external_simulator::variable;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// Names that every run has.
const TAKEN: [&str; 2] = ["scene", "seed"];
/// Name of the place in a command for all values.
const ALL: &str = "arguments";

/// Checks names, the template and the scenes.
pub(crate) fn check(file: &StudyFile, folder: &Path, problems: &mut Problems) {
    check_names(file, problems);
    if let Some(template) = &file.simulator.template {
        check_template(template, folder, problems);
    }
    for scene in &file.scene {
        check_scene(file, scene, problems);
    }
}

/// Refuses names that no command line takes, and names of two things.
fn check_names(file: &StudyFile, problems: &mut Problems) {
    let parameters = file
        .parameter
        .iter()
        .map(|p| (&p.symbol, &p.path, "symbol"));
    let effects = file.effect.iter().map(|e| (&e.name, &e.path, "name"));
    let measured = file.measured.iter().map(|m| (&m.condition, &m.path));
    let offered = file.candidate.iter().flatten();
    let offered = offered.map(|c| (&c.condition, &c.path));
    let conditions = measured.chain(offered).flat_map(|(condition, path)| {
        let names = condition.keys();
        names.map(move |name| (name, path, "condition"))
    });
    let mut variables: BTreeMap<String, (&str, &str)> =
        TAKEN.map(|name| (variable(name), (name, "run"))).into();
    for (name, path, key) in parameters.chain(effects).chain(conditions) {
        let (name, variable) = (name.as_str(), variable(name));
        let (other, kind) = variables.get(&variable).copied().unwrap_or((name, key));
        let problem = if !usable_name(name) {
            "must begin with a letter, and hold letters, digits, '_', '-' and '.'".into()
        } else if let Some(problem) = wrong_name(name) {
            problem
        } else if name == ALL {
            "is the place of all values in a command: use another name".into()
        } else if TAKEN.contains(&name) {
            format!("every run has {}: use another name", TAKEN.join(" and "))
        } else if other == name && kind != key {
            format!("is also the name of a {kind}: the program could not distinguish them")
        } else if other != name {
            format!(
                "reaches the program as {variable}, as '{other}' does: use names that differ in more than capitals and signs"
            )
        } else {
            String::new()
        };
        if !problem.is_empty() {
            problems.wrong(&below(path, key), format!("'{name}' {problem}"));
        }
        variables.entry(variable).or_insert((name, key));
    }
}

/// Refuses a template that is not a folder, or that holds the study: its results would become a part of what each run gets.
fn check_template(template: &Path, folder: &Path, problems: &mut Problems) {
    let (path, whole) = (below("simulator", "template"), folder.join(template));
    if !whole.is_dir() {
        return problems.wrong(&path, format!("there is no folder {}", whole.display()));
    }
    let here = folder.join(".").canonicalize();
    if let (Ok(here), Ok(whole)) = (here, whole.canonicalize()) {
        let problem = "holds the study itself: give the files of a run a folder of their own";
        problems.require(!here.starts_with(whole), &path, problem);
    }
}

/// Refuses an invalid drum, and parameters that are not there.
fn check_scene(file: &StudyFile, scene: &SceneEntry, problems: &mut Problems) {
    // The symbol of an entry that is wrong elsewhere is known all the same.
    let entries = ["parameter", "input"].map(|kind| problems.document.value(kind));
    let entries = entries
        .into_iter()
        .flatten()
        .filter_map(Value::as_array)
        .flatten();
    let symbols = entries.filter_map(|p| p.get("symbol").and_then(Value::as_str));
    let symbols: Vec<String> = symbols.map(str::to_owned).collect();
    let path = below(&scene.path, "parameters");
    for (k, name) in scene.parameters.iter().flatten().enumerate() {
        let problem = "not the symbol of a [[parameter]] or an [[input]]";
        problems.require(symbols.contains(name), &below(&path, k), problem);
    }
    if let Some(drum) = &scene.drum {
        let conditions = file.measured.iter().filter(|m| m.scene == scene.name);
        let conditions = conditions.flat_map(|m| m.condition.keys().cloned());
        let parameters = file.parameter.iter().map(|p| p.symbol.clone());
        let names: Vec<String> = conditions.chain(parameters).collect();
        if let Err(problem) = drum.check(&names) {
            problems.wrong(&below(&scene.path, "drum"), problem);
        }
    }
}
