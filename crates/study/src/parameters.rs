//! The parameters of a study, resolved against its scenes.

use crate::defaults::Defaults;
use crate::document::below;
use crate::file::ParameterEntry;
use crate::limits::{LEAST_RATIO, MOST, physical_limits};
use crate::problem::Problems;
use crate::scenes::{Models, Scenes, Setup};
use crate::setting::{leaf, number, paths, table_of};
use experiment_design::Factor;
use inference::{MOST_PARAMETERS, Parameter};
use scene::{Scene, like_names};
use toml::Table;

/// Refuses counts, symbols and paths that are there twice.
pub(crate) fn check_all(entries: &[ParameterEntry], problems: &mut Problems) {
    for (kind, is_input) in [("parameter", false), ("input", true)] {
        let n = entries.iter().filter(|e| e.is_input == is_input).count();
        let problem = format!(
            "has {n} [[{kind}]]: {MOST_PARAMETERS} can be calibrated at once; keep those that matter"
        );
        problems.require(n <= MOST_PARAMETERS, "", &problem);
    }
    for (k, entry) in entries.iter().enumerate() {
        let before = &entries[..k];
        let is_new = before.iter().all(|o| o.symbol != entry.symbol);
        let problem = "symbol of another parameter: give each its own";
        problems.require(is_new, &entry.at("symbol"), problem);
        for (i, path) in entry.sets.iter().enumerate() {
            let at = below(&entry.at("sets"), i);
            let mut before = before.iter();
            if let Some(other) = before.find(|o| o.sets.contains(path) && o.meets(entry)) {
                let other = &other.symbol;
                problems.wrong(
                    &at,
                    format!(
                        "parameter {other} sets it too: leave it to one of the two, or state 'scenes' of inputs that have none in common"
                    ),
                );
            } else if entry.sets[..i].contains(path) {
                problems.wrong(&at, "is there twice: name each setting once");
            }
        }
    }
}

impl ParameterEntry {
    /// Whether it can act on a scene on which another acts.
    fn meets(&self, other: &Self) -> bool {
        match (&self.scenes, &other.scenes) {
            (Some(own), Some(others)) => own.iter().any(|name| others.contains(name)),
            _ => true,
        }
    }
}

/// Checks parameters against the scenes.
pub(crate) struct Resolver<'a> {
    pub(crate) scenes: &'a Scenes<'a>,
    /// The models that the measurements ask for.
    pub(crate) models: &'a Models,
    /// Whether all scenes could be read and all measurements be resolved: only then a parameter can change nothing.
    pub(crate) complete: bool,
    /// Settings of each scene, in the order of the file; empty if a program of the user knows them.
    tables: Vec<(&'a Scene, Table)>,
    pub(crate) defaults: &'a mut Defaults,
    pub(crate) problems: &'a mut Problems,
}

impl<'a> Resolver<'a> {
    pub(crate) fn new(
        scenes: &'a Scenes<'a>,
        models: &'a Models,
        complete: bool,
        defaults: &'a mut Defaults,
        problems: &'a mut Problems,
    ) -> Self {
        let names = scenes.file.scene.iter();
        let of_file = names.filter_map(|entry| scenes.by_name.get(&entry.name));
        Self {
            tables: of_file.map(|scene| (scene, table_of(scene))).collect(),
            scenes,
            models,
            complete,
            defaults,
            problems,
        }
    }

    /// Adds a problem of one key of a parameter.
    fn wrong(&mut self, entry: &ParameterEntry, key: &str, problem: impl std::fmt::Display) {
        if entry.path.is_empty() {
            // An input that the file leaves out has no line.
            let problem = format!("input {}: {key}: {problem}", entry.symbol);
            return self.problems.wrong("", problem);
        }
        self.problems.wrong(&entry.at(key), problem.to_string());
    }

    /// Checks a parameter. Values that the file leaves out are reported; those that cannot be found are that of low.
    pub(crate) fn resolve(&mut self, entry: &ParameterEntry) -> Parameter {
        let before = self.problems.count();
        let unit = entry.unit.clone().unwrap_or_else(|| "1".into());
        if let Err(error) = Factor::new(&entry.symbol, "", &unit, 0.0, 1.0) {
            self.wrong(entry, "symbol", error);
        }
        self.check_paths(entry);
        self.check_conditions(entry);
        let in_use = self.value_in_use(entry);
        if let (true, Some(mean), Some(there)) = (entry.is_input, entry.start, in_use)
            && (mean - there).abs() > LEAST_RATIO * mean.abs().max(there.abs())
        {
            let problem = format!("the scene has {there}: state what you measured in both");
            self.wrong(entry, "mean", problem);
        }
        let limits = self.limits(entry);
        self.check_numbers(entry, limits);
        if self.problems.count() == before {
            self.check_ends(entry, limits);
        }
        if self.problems.count() == before {
            self.check_runs(entry, limits);
        }
        let first_path = || entry.sets.first().cloned().unwrap_or_default();
        Parameter {
            symbol: entry.symbol.clone(),
            name: entry.name.clone().unwrap_or_else(first_path),
            unit,
            sets: entry.sets.clone(),
            range: [entry.low, entry.high],
            limits,
            start: self.start(entry, in_use, limits),
            prior: entry.prior,
            is_input: entry.is_input,
        }
    }

    /// The value in use before: stated, that of the first scene, or, as a program of the user does not say it, the middle of the range.
    fn start(&mut self, entry: &ParameterEntry, in_use: Option<f64>, limits: [f64; 2]) -> f64 {
        let middle = 0.5 * (entry.low + entry.high);
        let of_command = self.scenes.file.is_of_command().then_some(middle);
        let (start, why) = match (entry.start, in_use, of_command) {
            (Some(start), ..) => (start, None),
            (None, Some(value), _) => (value, Some("the value in the first scene that has it")),
            (None, None, Some(middle)) => (middle, Some("the middle of low and high")),
            (None, None, None) => return entry.low,
        };
        if let Some(why) = why {
            let key = format!("parameter {}: start", entry.symbol);
            self.defaults.tell(&key, &start.to_string(), why);
        }
        if let (Some(effect), Some(prior), true) =
            (&entry.effect, entry.prior, entry.path.is_empty())
        {
            let why = "photos of a bed depend on it; state it, or 0 if it is exact";
            self.defaults
                .tell(&format!("input {effect}: sd"), &prior.sd.to_string(), why);
        }
        let [least, most] = limits;
        if !(least..=most).contains(&start) {
            let problem = format!(
                "{start} is outside the limits {least} to {most}: state another start, or wider limits"
            );
            self.wrong(entry, "start", problem);
        }
        start
    }

    /// Refuses paths that no scene has, and parameters on which no run depends.
    fn check_paths(&mut self, entry: &ParameterEntry) {
        if self.scenes.file.is_of_command() || !self.scenes.are_known() {
            return;
        }
        let before = self.problems.count();
        for (i, path) in entry.sets.iter().enumerate() {
            if self.tables.iter().all(|(_, t)| leaf(t, path).is_none()) {
                let mut all: Vec<String> = self.tables.iter().flat_map(|(_, t)| paths(t)).collect();
                all.sort();
                all.dedup();
                let near = like_names(&all, path);
                let problem = format!("a setting that no scene has; settings like it are {near}");
                self.problems.wrong(&below(&entry.at("sets"), i), problem);
            }
        }
        let mut models = 0..self.models.models.len();
        let sound = entry.low.is_finite() && entry.high.is_finite() && entry.low < entry.high;
        let judged = self.complete && sound && self.problems.count() == before;
        if judged && !models.any(|model| self.models.depends_on(model, entry)) {
            let problem = "changes nothing in any scene that is measured: remove the parameter, or measure a scene in \
                           which these surfaces meet";
            self.wrong(entry, "sets", problem);
        }
    }

    /// The number in the first scene that has one of the settings; refuses settings that are not a number in the unit.
    fn value_in_use(&mut self, entry: &ParameterEntry) -> Option<f64> {
        let mut first = None;
        let mut wrong = Vec::new();
        for path in &entry.sets {
            for (_, table) in &self.tables {
                let Some(value) = leaf(table, path) else {
                    continue;
                };
                if value.is_integer() {
                    let way_out = if entry.is_input {
                        "an input, too; a number of seeds is effect = \"seed-count\""
                    } else {
                        "study it by conditions"
                    };
                    let problem = format!(
                        "'{path}' is a whole number ({value}), and a parameter takes each value of its range: {way_out}"
                    );
                    wrong.push(("sets", problem));
                    continue;
                }
                match number(value, entry.unit.as_deref()) {
                    Ok(value) => drop(first.get_or_insert(value)),
                    Err(reason) => {
                        let key = if entry.unit.is_some() { "unit" } else { "sets" };
                        wrong.push((key, format!("'{path}' {reason}")));
                    }
                }
            }
        }
        for (key, problem) in wrong {
            self.wrong(entry, key, problem);
        }
        first
    }

    /// The limits as stated, or what is physically possible, or the range.
    fn limits(&mut self, entry: &ParameterEntry) -> [f64; 2] {
        if let Some(limits) = entry.limits {
            return limits;
        }
        let known = entry.sets.iter().filter_map(|path| physical_limits(path));
        let narrowest = known.reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])]);
        let (limits, why) = match narrowest {
            Some(limits) => (limits, "what is physically possible for such a setting"),
            None => (
                [entry.low, entry.high],
                "low and high: nothing is known of such a setting",
            ),
        };
        let (key, [least, most]) = (format!("parameter {}: limits", entry.symbol), limits);
        self.defaults.tell(&key, &format!("{least} to {most}"), why);
        limits
    }

    /// Refuses numbers that are out of order.
    fn check_numbers(&mut self, entry: &ParameterEntry, [least, most]: [f64; 2]) {
        let (low, high) = (entry.low, entry.high);
        if !(-MOST <= least && least < most && most <= MOST) {
            let problem = format!("{least:e} to {most:e} must rise, with a size of 1e15 at most");
            self.wrong(entry, "limits", problem);
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            return self.wrong(
                entry,
                "low",
                format!("low and high = {high} must be finite and rise"),
            );
        }
        if high - low < LEAST_RATIO * low.abs().max(high.abs()) {
            let problem =
                format!("low and high = {high} are the same to nine digits: widen the range");
            self.wrong(entry, "low", problem);
        }
        for (key, value) in [("low", low), ("high", high)] {
            if !(least..=most).contains(&value) {
                let problem = format!(
                    "{value} is outside the limits {least} to {most}, within which the search begins: narrow the range, or state \
                     wider limits"
                );
                self.wrong(entry, key, problem);
            }
        }
        let Some(prior) = entry.prior else { return };
        let problem = if !(prior.mean.abs() <= MOST && prior.sd > 0.0 && prior.sd <= MOST) {
            "needs a mean of a size of 1e15 at most and an sd above 0, at most 1e15".to_owned()
        } else if prior.sd < LEAST_RATIO * (high - low) {
            let sd = prior.sd;
            format!(
                "has the sd {sd:e}, less than 1e-9 of the range: set the parameter in the scene, or state its error"
            )
        } else if !(least..=most).contains(&prior.mean) {
            let mean = prior.mean;
            format!(
                "has the mean {mean}, outside the limits {least} to {most}: correct it, or state wider limits"
            )
        } else {
            return;
        };
        self.wrong(entry, "prior", problem);
    }

    /// Refuses limits that a scene does not take.
    fn check_ends(&mut self, entry: &ParameterEntry, limits: [f64; 2]) {
        let mut refused = Vec::new();
        for (scene, table) in &self.tables {
            for value in limits {
                let changes = entry
                    .binding()
                    .changes(|path| leaf(table, path).is_some(), value);
                if let Err(error) = scene.with(&changes) {
                    // The message of a text that cannot be read ends with a line of its own.
                    let reason = error.to_string();
                    refused.push(format!(
                        "reach {value}, which a scene refuses: {}; narrow them",
                        reason.trim_end()
                    ));
                }
            }
        }
        for problem in refused {
            self.wrong(entry, "limits", problem);
        }
    }

    /// Refuses settings that a condition of a measurement states: they would have the value of the parameter in all of them.
    fn check_conditions(&mut self, entry: &ParameterEntry) {
        for (model, setup) in self.models.models.iter().zip(&self.models.setups) {
            let named = |name: &String| setup.scene()?.named_setting(name).ok();
            let mut settings = model.condition.keys().filter_map(named);
            if let Some(setting) = settings.find(|setting| entry.sets.contains(&setting.path)) {
                let problem = format!(
                    "'{}' is stated by the condition of {}: a parameter has one value under all conditions; remove one of the two",
                    setting.path, model.name
                );
                return self.wrong(entry, "sets", problem);
            }
        }
    }

    /// Refuses a range at whose ends a measured scene cannot be built, such as seeds that do not fit any more, and ends and limits at
    /// which another code does not take a scene that it takes as it is.
    fn check_runs(&mut self, entry: &ParameterEntry, [least, most]: [f64; 2]) {
        if !self.complete {
            return;
        }
        // Contacts build nothing.
        let of_contacts = |path: &String| path.starts_with("contact.");
        let builds = entry.effect.is_some() || !entry.sets.iter().all(of_contacts);
        let peer = self.scenes.peer();
        let ends = [
            ("low", entry.low),
            ("high", entry.high),
            ("limits", least),
            ("limits", most),
        ];
        // Limits are often the ends of the range.
        let mut refused: Vec<(&str, f64, String)> = Vec::new();
        for (key, value) in ends {
            for (model, setup) in self.models.setups.iter().enumerate() {
                let Some(Ok(scene)) = self.models.at(model, entry, value) else {
                    continue;
                };
                let taken = |peer: &simulators::external_simulator::Peer| {
                    setup.scene().is_some_and(|scene| peer.check(scene).is_ok())
                };
                let (name, changed) = (
                    &self.models.models[model].name,
                    Setup::Scene(Box::new(scene)),
                );
                let unbuilt = (builds && key != "limits")
                    .then(|| self.scenes.unbuilt(&changed))
                    .flatten();
                let unbuilt = unbuilt.map(|reason| format!("{name} cannot be built: {reason}"));
                let not_taken = || {
                    Some(
                        peer.filter(taken)?
                            .check(changed.scene()?)
                            .err()?
                            .to_string(),
                    )
                };
                if let Some(reason) = unbuilt.or_else(not_taken) {
                    refused.push((key, value, reason));
                    break;
                }
            }
        }
        for (k, (key, value, reason)) in refused.iter().enumerate() {
            if refused[..k].iter().all(|(_, other, _)| other != value) {
                let problem = format!("at {value} {reason}; narrow the range or the limits");
                self.wrong(entry, key, problem);
            }
        }
    }
}
