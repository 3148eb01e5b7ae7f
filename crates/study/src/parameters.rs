//! The parameters of a study, resolved against its scenes.

use crate::defaults::Defaults;
use crate::document::{Document, below};
use crate::file::ParameterEntry;
use crate::limits::{LEAST_RATIO, MOST, physical_limits};
use crate::problem::{Problem, Problems};
use crate::scenes::Models;
use crate::setting::{change, leaf, number, paths, table_of};
use experiment_design::Factor;
use inference::{MOST_PARAMETERS, Parameter};
use scene::{FillingLibrary, Scene, like_names};
use simulators::external_simulator::Peer;
use toml::Table;

/// Refuses counts, symbols and paths that stand there twice.
pub(crate) fn check_all(document: &Document, entries: &[ParameterEntry], problems: &mut Problems) {
    for (kind, is_input) in [("parameter", false), ("input", true)] {
        let n = entries.iter().filter(|e| e.is_input == is_input).count();
        if n > MOST_PARAMETERS {
            let what = format!("[[{kind}]] x {n}");
            let problem = format!(
                "are too many: {MOST_PARAMETERS} can be calibrated at once; keep those that matter"
            );
            problems.add(document.problem(kind, what, problem));
        }
    }
    for (k, entry) in entries.iter().enumerate() {
        let (before, words) = (&entries[..k], words(entry));
        if before.iter().any(|o| o.symbol == entry.symbol) {
            let path = below(&entry.path, "symbol");
            let problem = "has the symbol of another: give each parameter its own";
            problems.add(document.problem(&path, words.clone(), problem));
        }
        for (i, path) in entry.sets.iter().enumerate() {
            let at = below(&below(&entry.path, "sets"), i);
            let what = format!("{words}: sets '{path}',");
            let other = before.iter().find(|o| o.sets.contains(path));
            if let Some(other) = other {
                let problem = format!(
                    "which parameter {} sets too: one setting can have one parameter only",
                    other.symbol
                );
                problems.add(document.problem(&at, what, problem));
            } else if entry.sets[..i].contains(path) {
                problems.add(document.problem(&at, what, "twice: name each setting once"));
            }
        }
    }
}

/// A parameter in words.
fn words(entry: &ParameterEntry) -> String {
    let kind = if entry.is_input { "input" } else { "parameter" };
    format!("[[{kind}]] {}", entry.symbol)
}

/// One parameter against the scenes.
pub(crate) struct Resolver<'a> {
    /// The study file.
    pub(crate) document: &'a Document,
    /// The models that the measurements ask for.
    pub(crate) models: &'a Models,
    /// Whether all scenes could be read: only then can a path be nowhere.
    pub(crate) scenes_known: bool,
    /// Whether all measurements could be resolved too: only then can a parameter change nothing.
    pub(crate) complete: bool,
    /// Settings of each scene, in the order of the file.
    pub(crate) tables: &'a [(&'a Scene, Table)],
    /// Bodies of the seeds; none where a program of the user knows them.
    pub(crate) fillings: Option<&'a FillingLibrary>,
    /// The other code that runs the scenes, if one does.
    pub(crate) peer: Option<Peer>,
}

impl Resolver<'_> {
    /// A problem of one key of a parameter.
    fn wrong(&self, entry: &ParameterEntry, key: &str, problem: impl Into<String>) -> Problem {
        let document = self.document;
        let what = format!("{}: {key}", words(entry));
        document.problem(&below(&entry.path, key), what, problem)
    }

    /// Checks a parameter. Values that the file leaves out are told; those that cannot be found are that of low.
    pub(crate) fn resolve(
        &self,
        entry: &ParameterEntry,
        defaults: &mut Defaults,
        problems: &mut Problems,
    ) -> Parameter {
        let before = problems.count();
        let unit = entry.unit.clone().unwrap_or_else(|| "1".into());
        if let Err(error) = Factor::new(&entry.symbol, "", &unit, 0.0, 1.0) {
            problems.add(self.wrong(entry, "symbol", format!(": {error}")));
        }
        self.check_paths(entry, problems);
        self.check_conditions(entry, problems);
        let standing = self.standing(entry, problems);
        self.check_stated(entry, standing, problems);
        tell_input(entry, defaults);
        let limits = Self::limits(entry, defaults);
        self.check_numbers(entry, limits, problems);
        if problems.count() == before {
            self.check_ends(entry, limits, problems);
        }
        if problems.count() == before {
            self.check_builds(entry, problems);
            self.check_peer(entry, limits, problems);
        }
        let start = entry.start.or_else(|| {
            let value = standing?;
            defaults.tell(
                &format!("parameter {}: start", entry.symbol),
                &value.to_string(),
                "what stands in the first scene that has it",
            );
            Some(value)
        });
        let start = start.or_else(|| {
            // A program of the user does not say what it holds.
            let middle = 0.5 * (entry.low + entry.high);
            (!self.scenes_known && self.tables.is_empty()).then(|| {
                defaults.tell(
                    &format!("parameter {}: start", entry.symbol),
                    &middle.to_string(),
                    "the middle of low and high",
                );
                middle
            })
        });
        if let Some(start) = start
            && !(limits[0]..=limits[1]).contains(&start)
        {
            let [least, most] = limits;
            let problem = format!(
                "= {start} lies outside the limits {least} to {most}: state another start, or wider limits"
            );
            problems.add(self.wrong(entry, "start", problem));
        }
        let first_path = || entry.sets.first().cloned().unwrap_or_default();
        Parameter {
            symbol: entry.symbol.clone(),
            name: entry.name.clone().unwrap_or_else(first_path),
            unit,
            sets: entry.sets.clone(),
            range: [entry.low, entry.high],
            limits,
            start: start.unwrap_or(entry.low),
            prior: entry.prior,
            is_input: entry.is_input,
        }
    }

    /// Refuses an input whose value is not the one in use: nobody could tell which is meant.
    fn check_stated(&self, entry: &ParameterEntry, standing: Option<f64>, problems: &mut Problems) {
        if let (true, Some(mean), Some(standing)) = (entry.is_input, entry.start, standing)
            && (mean - standing).abs() > LEAST_RATIO * mean.abs().max(standing.abs())
        {
            let problem = format!(
                "= {mean}, while the scene has {standing}: state in both what you measured"
            );
            problems.add(self.wrong(entry, "mean", problem));
        }
    }

    /// Refuses paths that no scene has, and parameters on which no run depends.
    fn check_paths(&self, entry: &ParameterEntry, problems: &mut Problems) {
        if !self.scenes_known {
            return;
        }
        let mut exists = true;
        for (i, path) in entry.sets.iter().enumerate() {
            if self.tables.iter().any(|(_, t)| leaf(t, path).is_some()) {
                continue;
            }
            exists = false;
            let at = below(&below(&entry.path, "sets"), i);
            let what = format!("{}: sets '{path}',", words(entry));
            let near = self.near(path);
            let problem = format!("a setting that no scene has; there are {near}");
            problems.add(self.document.problem(&at, what, problem));
        }
        let mut models = 0..self.models.models.len();
        let sound = entry.low.is_finite() && entry.high.is_finite() && entry.low < entry.high;
        if self.complete
            && exists
            && sound
            && !models.any(|model| self.models.depends_on(model, entry))
        {
            let problem = "changes nothing in any scene that is measured: remove the parameter, or measure a scene in \
                           which these surfaces meet";
            problems.add(self.wrong(entry, "sets", problem));
        }
    }

    /// Settings with a like name.
    fn near(&self, path: &str) -> String {
        let mut all: Vec<String> = self.tables.iter().flat_map(|(_, t)| paths(t)).collect();
        all.sort();
        all.dedup();
        like_names(&all, path)
    }

    /// The number that stands in the first scene that has one of the settings; refuses settings that are no number
    /// in the unit.
    fn standing(&self, entry: &ParameterEntry, problems: &mut Problems) -> Option<f64> {
        let mut first = None;
        for path in &entry.sets {
            for (_, table) in self.tables {
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
                    problems.add(self.wrong(entry, "sets", problem));
                    continue;
                }
                match number(value, entry.unit.as_deref()) {
                    Ok(value) => {
                        first.get_or_insert(value);
                    }
                    Err(reason) => {
                        let key = if entry.unit.is_some() { "unit" } else { "sets" };
                        problems.add(self.wrong(entry, key, format!("'{path}' {reason}")));
                    }
                }
            }
        }
        first
    }

    /// The limits as stated, or what is physically possible, or the range.
    fn limits(entry: &ParameterEntry, defaults: &mut Defaults) -> [f64; 2] {
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
        let [least, most] = limits;
        defaults.tell(
            &format!("parameter {}: limits", entry.symbol),
            &format!("{least} to {most}"),
            why,
        );
        limits
    }

    /// Refuses numbers that are out of order.
    fn check_numbers(&self, entry: &ParameterEntry, limits: [f64; 2], problems: &mut Problems) {
        let (low, high, [least, most]) = (entry.low, entry.high, limits);
        if !(-MOST <= least && least < most && most <= MOST) {
            let problem = format!(
                "{least:e} to {most:e} must be two numbers that rise, of a size of 1e15 at most"
            );
            problems.add(self.wrong(entry, "limits", problem));
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            let problem = format!("= {low} and high = {high} must be finite and rise");
            problems.add(self.wrong(entry, "low", problem));
            return;
        }
        if high - low < LEAST_RATIO * low.abs().max(high.abs()) {
            let problem =
                format!("= {low} and high = {high} are the same to nine digits: widen the range");
            problems.add(self.wrong(entry, "low", problem));
        }
        for (key, value) in [("low", low), ("high", high)] {
            if !(least..=most).contains(&value) {
                let problem = format!(
                    "= {value} lies outside the limits {least} to {most}: the search begins within them; narrow the \
                     range, or state wider limits"
                );
                problems.add(self.wrong(entry, key, problem));
            }
        }
        if let Some(prior) = entry.prior
            && !(prior.mean.abs() <= MOST && prior.sd > 0.0 && prior.sd <= MOST)
        {
            let problem = format!(
                "{:e} +- {:e} needs a mean of a size of 1e15 at most and an sd above 0, at most 1e15",
                prior.mean, prior.sd
            );
            problems.add(self.wrong(entry, "prior", problem));
        } else if let Some(prior) = entry.prior
            && prior.sd < LEAST_RATIO * (high - low)
        {
            let problem = format!(
                "has the sd {:e}, less than 1e-9 of the range from low to high: set the parameter in the scene, or state its error",
                prior.sd
            );
            problems.add(self.wrong(entry, "prior", problem));
        } else if let Some(prior) = entry.prior
            && !(least..=most).contains(&prior.mean)
        {
            let problem = format!(
                "has the mean {}, outside the limits {least} to {most}: correct it, or state wider limits",
                prior.mean
            );
            problems.add(self.wrong(entry, "prior", problem));
        }
    }

    /// Refuses limits that a scene does not take.
    fn check_ends(&self, entry: &ParameterEntry, limits: [f64; 2], problems: &mut Problems) {
        for (scene, table) in self.tables {
            let of_scene = entry.sets.iter().filter(|p| leaf(table, p).is_some());
            let of_scene: Vec<&String> = of_scene.collect();
            for value in limits {
                let changes: Vec<_> = of_scene
                    .iter()
                    .map(|path| change(path, value, entry.unit.as_deref()))
                    .collect();
                if let Err(error) = scene.with(&changes) {
                    // The message of a text that cannot be read ends with a line of its own.
                    let reason = error.to_string();
                    let problem = format!(
                        "reach {value}, which a scene refuses: {}; narrow them",
                        reason.trim_end()
                    );
                    problems.add(self.wrong(entry, "limits", problem));
                }
            }
        }
    }
}

impl Resolver<'_> {
    /// Refuses settings that a condition of a measurement states: they would have the value of the parameter in all of them.
    fn check_conditions(&self, entry: &ParameterEntry, problems: &mut Problems) {
        let models = self.models.models.iter().zip(&self.models.scenes);
        for (model, scene) in models {
            for name in model.condition.keys() {
                let Ok(setting) = scene.named_setting(name) else {
                    continue;
                };
                if entry.sets.contains(&setting.path) {
                    let problem = format!(
                        "'{}' is what the condition '{name}' of {} states: a parameter has one value under all \
                         conditions; remove one of both",
                        setting.path, model.name
                    );
                    problems.add(self.wrong(entry, "sets", problem));
                    return;
                }
            }
        }
    }

    /// Refuses a range at whose ends a measured scene cannot be built, such as seeds that do not fit any more; contacts
    /// build nothing.
    fn check_builds(&self, entry: &ParameterEntry, problems: &mut Problems) {
        let Some(fillings) = self.fillings else {
            return;
        };
        let of_contacts = |path: &String| path.starts_with("contact.");
        if entry.effect.is_none() && entry.sets.iter().all(of_contacts) {
            return;
        }
        for model in 0..self.models.models.len() {
            for (key, value) in [("low", entry.low), ("high", entry.high)] {
                let Some(Err(error)) = self.models.built_at(model, entry, value, fillings) else {
                    continue;
                };
                let name = &self.models.models[model].name;
                let problem =
                    format!("= {value} is where {name} cannot be built: {error}; narrow the range");
                problems.add(self.wrong(entry, key, problem));
            }
        }
    }
}

impl Resolver<'_> {
    /// Refuses a range or limits at whose ends another code does not take a measured scene that it takes as it stands.
    fn check_peer(&self, entry: &ParameterEntry, limits: [f64; 2], problems: &mut Problems) {
        let Some(peer) = self.peer else {
            return;
        };
        let [least, most] = limits;
        let ends = [
            ("low", entry.low),
            ("high", entry.high),
            ("limits", least),
            ("limits", most),
        ];
        let mut told = Vec::new();
        for (key, value) in ends {
            let taken = |model: &usize| peer.check(&self.models.scenes[*model]).is_ok();
            let models = (0..self.models.models.len()).filter(taken);
            let mut refused = models.filter_map(|model| {
                let scene = self.models.at(model, entry, value)?.ok()?;
                peer.check(&scene).err()
            });
            // Limits are often the ends of the range.
            if told.contains(&value) {
                continue;
            }
            if let Some(error) = refused.next() {
                told.push(value);
                let word = if key == "limits" { "reach" } else { "=" };
                let problem = format!("{word} {value}: {error}; narrow the range and state limits");
                problems.add(self.wrong(entry, key, problem));
            }
        }
    }
}

/// Tells an input that the file leaves out.
fn tell_input(entry: &ParameterEntry, defaults: &mut Defaults) {
    if let (Some(effect), Some(prior), true) = (&entry.effect, entry.prior, entry.path.is_empty()) {
        defaults.tell(
            &format!("input {effect}: sd"),
            &prior.sd.to_string(),
            "photos of a bed depend on it; state it, or 0 if it is exact",
        );
    }
}

/// Settings of each scene.
pub(crate) fn tables<'a>(scenes: impl Iterator<Item = &'a Scene>) -> Vec<(&'a Scene, Table)> {
    scenes.map(|scene| (scene, table_of(scene))).collect()
}
