//! What no type of the file can refuse: names, ranges, and keys that contradict each other.

use super::{
    Budget, CandidateEntry, CoarseGrainingEntry, CompareEntry, EffectEntry, EffectsTable,
    MeasuredEntry, ParameterEntry, SceneEntry, SimulatorTable, StudyFile, input, photo,
};
use crate::document::below;
use crate::limits::{LEAST_RATIO, MOST, MOST_RUNS, range_of};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use ::input::quantity::Angle;
use inference::LoopSettings;
use input::complete;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Largest factor by which grains are coarser: a scale of the scenes.
const COARSEST: f64 = 100.0;
/// Keys of `[[scene]]`, `[[parameter]]` and `[[input]]` that only scene files give a meaning, and those that only a program of the user does.
const OF_SCENE_FILES: [&str; 6] = ["file", "changes", "apparatus", "sets", "effect", "scenes"];
const OF_A_PROGRAM: [&str; 3] = ["observables", "parameters", "drum"];

impl StudyFile {
    /// Checks all entries; inputs with an error follow the parameters from here on.
    pub(super) fn check(&mut self, problems: &mut Problems) {
        match (self.name.as_str(), problems.document.value("name")) {
            ("", None) => problems.wrong("", "has no 'name': add it"),
            (name, Some(_)) => {
                if let Some(problem) = folder_name(name) {
                    problems.wrong("name", problem);
                }
            }
            _ => {}
        }
        let kind = problems.document.value(&below("simulator", "kind"));
        let is_stated = problems.document.value("simulator").is_some();
        let is_own = kind.and_then(Value::as_str) == Some("own");
        if is_stated && !is_own && self.simulator == SimulatorTable::default() {
            // The table could not be read: what the others may hold depends on the kind.
            *self = Self {
                profile: std::mem::take(&mut self.profile),
                ..Self::default()
            };
            return;
        }
        for key in ["scene", "parameter", "measured"] {
            let problem = format!("has no [[{key}]]: a study needs at least one");
            problems.require(problems.document.value(key).is_some(), "", &problem);
        }
        self.check_kind(problems);
        self.scene.iter().for_each(|scene| scene.check(problems));
        refuse_twice(&mut self.scene, |s| (&s.name, &s.path), problems);
        self.effect.iter().for_each(|effect| effect.check(problems));
        refuse_twice(&mut self.effect, |e| (&e.name, &e.path), problems);
        let of_command = self.is_of_command();
        for parameter in &mut self.parameter {
            parameter.check(of_command, problems);
        }
        let inputs = self.input.iter();
        let inputs = inputs
            .filter_map(|input| input.parameter(of_command, problems))
            .collect();
        self.take_out_lost_conditions(problems);
        self.measured.iter().for_each(|entry| entry.check(problems));
        let candidates = self.candidate.iter().flatten();
        candidates.for_each(|candidate| candidate.check(problems));
        self.parameter.extend(complete(self, inputs, problems));
        if let Some(coarse) = &mut self.coarse_graining {
            let names: Vec<_> = self.scene.iter().map(|s| s.name.as_str()).collect();
            coarse.check(&names, problems);
        }
        self.check_tables(problems);
    }

    /// Takes out measurements and candidates whose condition could not be read: what they were measured at is not known.
    fn take_out_lost_conditions(&mut self, problems: &Problems) {
        let is_lost = |path: &str, condition: &BTreeMap<String, String>| {
            let stated = problems.document.value(&below(path, "condition"));
            let is_empty = stated
                .and_then(Value::as_table)
                .is_some_and(Table::is_empty);
            condition.is_empty() && stated.is_some() && !is_empty
        };
        self.measured.retain(|m| !is_lost(&m.path, &m.condition));
        let candidates = self.candidate.iter_mut();
        candidates.for_each(|all| all.retain(|c| !is_lost(&c.path, &c.condition)));
    }

    /// Refuses keys that belong to another kind of simulator.
    fn check_kind(&self, problems: &mut Problems) {
        let of_command = self.is_of_command();
        let scenes = self.scene.iter().map(|s| &s.path);
        let inputs = self.input.iter().map(|i| &i.path);
        let all = scenes
            .chain(self.parameter.iter().map(|p| &p.path))
            .chain(inputs);
        for path in all {
            let of_files =
                "is only for scene files: a program of the user knows its scenes; remove it";
            let of_programs = "is only for a program of the user: set kind = \"command\" in [simulator], or remove it";
            let (wrong, problem) = if of_command {
                (&OF_SCENE_FILES[..], of_files)
            } else {
                (&OF_A_PROGRAM[..], of_programs)
            };
            for key in wrong {
                let at = below(path, key);
                problems.require(problems.document.value(&at).is_none(), &at, problem);
            }
        }
        if !of_command {
            for scene in &self.scene {
                let problem = "has no 'file': add the path of a scene file";
                problems.require(scene.file.is_some(), &scene.path, problem);
            }
            let problem = "is only for a program of the user: set kind = \"command\" in [simulator], or remove it";
            problems.require(self.effect.is_empty(), "effect", problem);
        }
    }

    /// Checks the tables that a profile may replace, in the file and in all profiles.
    fn check_tables(&self, problems: &mut Problems) {
        let of_command = self.is_of_command();
        let own: Vec<&str> = self.effect.iter().map(|e| e.name.as_str()).collect();
        let own = of_command.then_some(&own[..]);
        self.simulator.check("simulator", problems);
        self.budget.check("budget", problems);
        self.effects.check("effects", own, problems);
        self.compare.iter().for_each(|entry| entry.check(problems));
        check_design("design", problems);
        for (name, profile) in &self.profile {
            let at = |key: &str| below(&profile.path, key);
            if let Some(problem) = folder_name(name) {
                problems.wrong(&profile.path, problem);
            }
            profile
                .budget
                .unwrap_or_default()
                .check(&at("budget"), problems);
            profile.effects.check(&at("effects"), own, problems);
            profile
                .compare
                .iter()
                .flatten()
                .for_each(|entry| entry.check(problems));
            check_design(&at("design"), problems);
            for (scene, changes) in &profile.scene {
                let at = below(&at("scene"), scene);
                if !self.scene.iter().any(|s| s.name == *scene) {
                    let names = self.scene_names();
                    problems.wrong(&at, format!("not a [[scene]]; the scenes are {names}"));
                }
                check_changes(&changes.changes, &at, problems);
            }
            if let Some(simulator) = &profile.simulator {
                simulator.check(&at("simulator"), problems);
                let problem = "cannot change to or from a program of the user: its scenes are others; write a study of its own";
                let other = simulator.kind == super::SimulatorKind::Command;
                problems.require(!of_command && !other, &at("simulator"), problem);
            }
        }
    }
}

impl SceneEntry {
    fn check(&self, problems: &mut Problems) {
        let at = |key: &str| below(&self.path, key);
        if let Some(problem) = wrong_name(&self.name) {
            problems.wrong(&at("name"), problem);
        }
        let holds = !self.name.contains(['@', '/']);
        problems.require(holds, &at("name"), "must be a word without '@' and '/'");
        check_changes(&self.changes, &self.path, problems);
        let parameters = self.parameters.as_deref().unwrap_or_default();
        for (key, names) in [
            ("observables", &self.observables[..]),
            ("parameters", parameters),
        ] {
            for (k, name) in names.iter().enumerate() {
                let twice = names[..k]
                    .contains(name)
                    .then(|| "is there twice: name it once".into());
                if let Some(problem) = wrong_name(name).or(twice) {
                    problems.wrong(&below(&at(key), k), problem);
                }
            }
        }
        if let Some(drum) = &self.drum {
            let at = |key: &str| below(&at("drum"), key);
            let gravity = drum.gravity_m_s2;
            let holds = gravity.is_finite() && gravity > 0.0;
            problems.require(holds, &at("gravity_m_s2"), "must be above 0");
            let angle = Angle::from_si(drum.max_angle_error).ok();
            photo::require_angle(angle, [0.1, 30.0], &at("max_angle_error"), problems);
        }
    }
}

/// Refuses changes of a scene without an equals sign.
fn check_changes(changes: &[String], path: &str, problems: &mut Problems) {
    for (k, _) in changes
        .iter()
        .enumerate()
        .filter(|(_, change)| !change.contains('='))
    {
        problems.wrong(
            &below(&below(path, "changes"), k),
            "has no '=': write \"name = value\"",
        );
    }
}

impl ParameterEntry {
    fn check(&mut self, of_command: bool, problems: &mut Problems) {
        let at = |key: &str| below(&self.path, key);
        for (key, text) in [("symbol", Some(&self.symbol)), ("name", self.name.as_ref())] {
            if let Some(problem) = text.and_then(|text| wrong_name(text)) {
                problems.wrong(&at(key), problem);
            }
        }
        if of_command {
            self.sets = vec![self.symbol.clone()];
        }
        let problem = "names no settings of the scenes: add sets = [...]";
        problems.require(!self.sets.is_empty(), &at("sets"), problem);
    }
}

impl MeasuredEntry {
    fn check(&self, problems: &mut Problems) {
        let at = |key: &str| below(&self.path, key);
        for (name, value) in &self.values {
            let at = |key: &str| below(&at(name), key);
            let ([least, most], unit) = range_of(name);
            let value_key = if value.is_scatter { "scatter" } else { "mean" };
            let holds = (least..=most).contains(&value.mean);
            problems.require(
                holds,
                &at(value_key),
                &format!("must be {least} to {most}{unit}"),
            );
            if value.is_scatter {
                let problem = "must be above 0: the standard deviation of the single values";
                problems.require(value.mean > 0.0, &at("scatter"), problem);
                let problem = "must be 2 or more, at most 1e15: the number of independent values that scatter so";
                problems.require((1.0..=MOST).contains(&value.n), &at("n"), problem);
                continue;
            }
            let problem = "must be above 0, at most 1e15: the standard deviation of the single values, or the error of the reading if \
                           only one was read";
            problems.require(value.sd > 0.0 && value.sd <= MOST, &at("sd"), problem);
            let is_exact = value.sd > 0.0 && value.sd < LEAST_RATIO * value.mean.abs();
            let problem = "is less than 1e-9 of the mean: state the error of the reading";
            problems.require(!is_exact, &at("sd"), problem);
            let problem =
                "must be 1 or more, at most 1e15: the number of independent values behind the mean";
            problems.require((1.0..=MOST).contains(&value.n), &at("n"), problem);
        }
        for (k, c) in self.correlations.iter().enumerate() {
            let problem = format!(
                "of {} and {} is {}: it must lie between -1 and 1",
                c.a, c.b, c.value
            );
            problems.require(c.value.abs() < 1.0, &below(&at("correlation"), k), &problem);
        }
        let has = |key: &str| problems.document.value(&at(key)).is_some();
        let (photos, photo) = (has("photos"), has("photo"));
        let known = ["scene", "condition", "role", "correlation", "photo"];
        let table = problems
            .document
            .value(&self.path)
            .and_then(Value::as_table);
        let others = table.into_iter().flat_map(Table::keys);
        let measures = { others }.any(|key| !known.contains(&key.as_str()));
        let problem =
            "holds no measurement: add OBSERVABLE = { mean = ..., sd = ..., n = ... }, or photos";
        problems.require(measures, &self.path, problem);
        let problem = "says how to read photos: add 'photos', or remove it";
        problems.require(photos || !photo, &at("photo"), problem);
        let is_empty = problems
            .document
            .value(&at("photos"))
            .and_then(Value::as_array);
        let is_empty = is_empty.is_some_and(Vec::is_empty);
        let problem = "is empty: name a folder or files, or remove the line";
        problems.require(!is_empty, &at("photos"), problem);
        self.photo.check(&at("photo"), problems);
    }
}

impl CandidateEntry {
    /// Whether its observables are those of the scene is checked with the scenes.
    fn check(&self, problems: &mut Problems) {
        let at = |key: &str| below(&self.path, key);
        let positive = |x: f64| x.is_finite() && x > 0.0;
        for (name, sd) in &self.sd {
            let at = below(&at("sd"), name);
            problems.require(
                positive(*sd),
                &at,
                "must be above 0, in the unit of the observable",
            );
        }
        let holds = self.n.is_none_or(|n| n.is_finite() && n >= 1.0);
        problems.require(
            holds,
            &at("n"),
            "must be 1 or more: the number of photos or repeats",
        );
        let holds = self.minutes.is_none_or(positive);
        problems.require(
            holds,
            &at("minutes"),
            "must be above 0: the work in the laboratory",
        );
    }
}

impl CompareEntry {
    fn check(&self, problems: &mut Problems) {
        let holds = self.sd.is_none_or(|sd| sd.is_finite() && sd > 0.0);
        problems.require(
            holds,
            &below(&self.path, "sd"),
            "must be above 0, or left out",
        );
    }
}

impl EffectEntry {
    fn check(&self, problems: &mut Problems) {
        let ([low, high], probe) = (self.range, self.probe);
        let sound = low.is_finite() && high.is_finite() && low <= 0.0 && high >= 0.0 && low < high;
        let problem = "must be two finite numbers around 0, at which the effect is off";
        problems.require(sound, &below(&self.path, "range"), problem);
        let holds = !sound || probe != 0.0 && (low..=high).contains(&probe);
        problems.require(
            holds,
            &below(&self.path, "probe"),
            "must lie in the range, and not at 0",
        );
    }
}

impl Budget {
    fn check(self, path: &str, problems: &mut Problems) {
        let at = |key: &str| below(path, key);
        problems.require(self.runs != Some(0), &at("runs"), "must be 1 or more");
        let holds = self.core_hours.is_none_or(|h| h > 0.0 && h <= MOST);
        problems.require(holds, &at("core_hours"), "must be above 0, at most 1e15");
        let both = self.runs.is_some() && self.core_hours.is_some();
        problems.require(
            !both,
            &at("core_hours"),
            "limits the runs again: leave out runs or core_hours",
        );
    }
}

impl EffectsTable {
    /// Refuses names that neither the library has nor, if it does the runs, a program of the user with its `own` effects.
    fn check(&self, path: &str, own: Option<&[&str]>, problems: &mut Problems) {
        let path = below(path, "search");
        let mut seen = BTreeSet::new();
        for name in self.search.iter().flatten() {
            let problem = format!("names '{name}' twice: remove one of them");
            problems.require(seen.insert(name), &path, &problem);
            match (own, simulators::effects::find(name)) {
                (None, Err(error)) => problems.wrong(&path, error.to_string()),
                (Some(own), _) if !own.contains(&name.as_str()) => {
                    let own = own.join(", ");
                    problems.wrong(
                        &path,
                        format!("'{name}' is not an [[effect]]; the effects are {own}"),
                    );
                }
                _ => {}
            }
        }
    }
}

impl CoarseGrainingEntry {
    /// Brings the coarsest to the front.
    fn check(&mut self, names: &[&str], problems: &mut Problems) {
        let at = |key: &str| below("coarse_graining", key);
        let holds = self
            .error
            .is_none_or(|error| error.is_finite() && error > 0.0);
        let problem = "must be above 0: the largest error, in standard errors of what was measured";
        problems.require(holds, &at("error"), problem);
        refuse_unknown_scenes(&self.scenes, "coarse_graining", names, problems);
        problems.require(
            !self.scenes.is_empty(),
            &at("scenes"),
            "is empty: name the scenes",
        );
        if let Some(problem) = wrong_factors(&self.factors) {
            problems.wrong(&at("factors"), problem);
        }
        self.factors.sort_by(|a, b| b.total_cmp(a));
    }
}

/// Why factors show no trend.
fn wrong_factors(factors: &[f64]) -> Option<String> {
    let is_coarser = |f: &&f64| f.is_finite() && **f > 1.0 && **f <= COARSEST;
    if let Some(factor) = factors.iter().find(|f| !is_coarser(f)) {
        return Some(format!(
            "has {factor}: a factor must be above 1, since the grains of the scene are the real ones, and {COARSEST} at most"
        ));
    }
    if (0..factors.len()).any(|k| factors[..k].contains(&factors[k])) {
        return Some("has one size twice: each must differ from the others".into());
    }
    (factors.len() < 2).then(|| "has one size: a trend with the size needs two or more".into())
}

/// Refuses names in the list `scenes` of a table that no scene has.
pub(super) fn refuse_unknown_scenes(
    scenes: &[String],
    path: &str,
    names: &[&str],
    problems: &mut Problems,
) {
    for (k, name) in scenes.iter().enumerate() {
        let problem = format!("not a [[scene]]; the scenes are {}", names.join(", "));
        let at = below(&below(path, "scenes"), k);
        problems.require(names.contains(&name.as_str()), &at, &problem);
    }
}

/// Leaves out entries whose name is taken; `named` gives the name of one and its path.
fn refuse_twice<T>(
    entries: &mut Vec<T>,
    named: impl Fn(&T) -> (&str, &str),
    problems: &mut Problems,
) {
    let mut seen = BTreeSet::new();
    entries.retain(|entry| {
        let (name, path) = named(entry);
        let is_new = seen.insert(name.to_owned());
        problems.require(is_new, &below(path, "name"), "duplicate name: rename one");
        is_new
    });
}

/// Settings of the loop: all keys but the seed, which the command line gives, and the budget.
fn check_design(path: &str, problems: &mut Problems) {
    if problems.document.value(path).is_none() {
        return;
    }
    let (settings, found) = problems.document.read::<LoopSettings>(path);
    problems.extend(found);
    for (key, owner) in [("seed", "--seed"), ("most_runs", "[budget]")] {
        let at = below(path, key);
        let problem = format!("is not part of [design]: use {owner}");
        problems.require(problems.document.value(&at).is_none(), &at, &problem);
    }
    let Some(settings) = settings else { return };
    let alpha = settings.screening_alpha;
    let holds = alpha > 0.0 && alpha < 1.0;
    problems.require(
        holds,
        &below(path, "screening_alpha"),
        "must lie between 0 and 1",
    );
    for (key, count, least) in [
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
    ] {
        let holds = (least..=MOST_RUNS).contains(&count);
        problems.require(
            holds,
            &below(path, key),
            &format!("must be {least} to {MOST_RUNS}"),
        );
    }
}

/// Why a name cannot become that of a result folder.
fn folder_name(name: &str) -> Option<String> {
    let usable = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
    let is_wrong = name.starts_with('.') || !name.chars().all(usable);
    let problem = "names the result folder: use letters, digits, '-', '_', '.' and blanks";
    wrong_name(name).or(is_wrong.then(|| problem.to_owned()))
}

/// Names of a value that may be written in a command line and as a variable.
pub(crate) fn usable_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(char::is_alphabetic)
        && letters.all(|c| c.is_alphanumeric() || "_-.".contains(c))
}
