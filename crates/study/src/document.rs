//! The text of a study file: its tables with the lines of their keys, read by serde.
//!
//! serde stops at the first mistake. [`Document::read`] notes it, takes the wrong part out and reads again, until the rest can be read:
//! so that all mistakes are reported at once.

use crate::problem::{Problem, Problems};
use input::file::toml_slip;
use scene::like_names;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use toml::de::{DeArray, DeTable, DeValue, ValueDeserializer};
use toml::{Spanned, Table, Value};

/// Parts the steps of a path: keys may hold dots, and no key that is accepted holds this.
const STEP: char = '\u{1f}';
/// Key under which each item of a list `[[...]]` and each profile gets its own path before it is read.
pub(crate) const PATH: &str = "(path)";
/// Mistakes after which a file is read no further: each takes a reading of the whole.
const MOST_MISTAKES: usize = 100;
/// Most letters of a value in a message.
const SHOWN: usize = 60;

/// A TOML file with the lines of its keys.
#[derive(Debug, Default)]
pub(crate) struct Document {
    /// Name for messages.
    file: String,
    text: String,
    pub(crate) table: Table,
    /// Line, from 1, of each key by its path; the items of a list are numbered from 0.
    lines: BTreeMap<String, usize>,
}

impl Document {
    /// Parses a text, or reports all lines that are not TOML.
    pub(crate) fn parse(text: &str, file: &str) -> Result<Self, Vec<Problem>> {
        // Each key asks for its line: to count from the start each time takes minutes for a file of thousands.
        let ends: Vec<usize> = text.match_indices('\n').map(|(end, _)| end).collect();
        let line_of = |at: usize| 1 + ends.partition_point(|end| *end < at);
        let (spanned, mut errors) = DeTable::parse_recoverable(text);
        let table = toml::from_str(text);
        if errors.is_empty() {
            errors.extend(table.as_ref().err().cloned());
        }
        // The parser misreads what follows a mistake in its line: one report a line.
        let mut lines_told = BTreeSet::new();
        let mut problems = Vec::new();
        for error in errors {
            let line = error.span().map(|span| line_of(span.start));
            if lines_told.insert(line) {
                let slip = line.and_then(|n| toml_slip(text.lines().nth(n - 1)?));
                let reason = slip.unwrap_or_else(|| error.message().replace('\n', ", "));
                problems.push(Problem {
                    file: file.into(),
                    line,
                    what: "the text".into(),
                    problem: format!("not valid TOML: {reason}"),
                });
            }
        }
        let (Ok(table), true) = (table, problems.is_empty()) else {
            return Err(problems);
        };
        let mut lines = BTreeMap::new();
        note_lines(spanned.get_ref(), "", &mut |path, at| {
            lines.insert(path, line_of(at));
        });
        Ok(Self {
            file: file.into(),
            text: text.into(),
            table,
            lines,
        })
    }

    /// The line of a path, or of the nearest table around it.
    pub(crate) fn line(&self, path: &str) -> Option<usize> {
        let around = std::iter::successors(Some(path), |p| Some(p.rsplit_once(STEP)?.0));
        around
            .into_iter()
            .find_map(|path| self.lines.get(path))
            .copied()
    }

    pub(crate) fn value(&self, path: &str) -> Option<&Value> {
        let mut steps = path.split(STEP);
        let mut value = self.table.get(steps.next()?)?;
        for step in steps {
            value = match value {
                Value::Table(table) => table.get(step)?,
                Value::Array(list) => list.get(step.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        Some(value)
    }

    /// A problem at a path: it names the table, the key and the value.
    pub(crate) fn problem(&self, path: &str, problem: String) -> Problem {
        Problem {
            file: self.file.clone(),
            line: self.line(path),
            what: self.words(path),
            problem,
        }
    }

    /// A path in words: `[[measured]] drum: angle_deg.sd = 0`, `[design]: replicates = 0`, `name = ""`.
    pub(crate) fn words(&self, path: &str) -> String {
        let steps: Vec<&str> = path.split(STEP).collect();
        let at = |n: usize| self.value(&steps[..n].join(&STEP.to_string()));
        let (table, keys) = match (at(1), &steps[..]) {
            (_, [""]) => return "the study".into(),
            (Some(Value::Array(_)), [list, item, keys @ ..]) => {
                let name = ["symbol", "name", "effect", "scene", "result"];
                let name = name.iter().find_map(|key| at(2)?.get(key)?.as_str());
                let number = item.parse().map_or(0, |k: usize| k + 1).to_string();
                let name = name.map_or(number, shown);
                (format!("[[{list}]] {name}"), keys)
            }
            _ => {
                let tables = (1..=steps.len()).take_while(|n| at(*n).is_some_and(Value::is_table));
                let (tables, keys) = steps.split_at(tables.count());
                (format!("[{}]", tables.join(".")), keys)
            }
        };
        let value = self.value(path).filter(|value| !value.is_table());
        let value = value.map(|value| match value {
            // Hundreds of zeros say less than an exponent.
            Value::Float(x) if *x != 0.0 && !(1e-9..1e15).contains(&x.abs()) => format!(" = {x:e}"),
            value => format!(" = {}", shown(&value.to_string())),
        });
        let key = keys.join(".") + &value.unwrap_or_default();
        match (table.as_str(), key.as_str()) {
            ("[]", _) => key,
            (_, "") => table,
            _ => format!("{table}: {key}"),
        }
    }

    /// Reads the table at a path, the whole file at an empty one; `None` if too little of it can be read.
    pub(crate) fn read<T: DeserializeOwned>(&self, path: &str) -> (Option<T>, Problems) {
        let mut found = Problems::default();
        let Ok(root) = DeTable::parse(&self.text) else {
            return (None, found);
        };
        let span = root.span();
        let mut root = root.into_inner();
        name_items(&mut root, "");
        let mut part = Some(Spanned::new(span, DeValue::Table(root)));
        for step in path.split(STEP).filter(|step| !step.is_empty()) {
            part = part.and_then(|part| match part.into_inner() {
                DeValue::Table(mut table) => table.remove(step),
                _ => None,
            });
        }
        let Some(mut part) = part else {
            return (None, found);
        };
        let mut taken_out = BTreeSet::new();
        loop {
            let error = match T::deserialize(ValueDeserializer::from(part.clone())) {
                Ok(read) => return (Some(read), found),
                Err(error) => error,
            };
            let culprit = error
                .span()
                .and_then(|span| take_out(&mut part, &span, path));
            let at = culprit.as_ref().map_or(path, |culprit| &culprit.path);
            // A required key whose value was wrong is missing now: that was reported.
            let missing = quoted(error.message(), "missing field `").next();
            if !missing.is_some_and(|key| taken_out.contains(&below(at, key))) {
                found.add(self.problem(at, plain_words(error.message())));
            }
            let Some(Culprit { path, taken: true }) = culprit else {
                return (None, found);
            };
            if found.count() >= MOST_MISTAKES {
                return (None, found);
            }
            taken_out.insert(path);
        }
    }
}

/// A path one step deeper.
pub(crate) fn below(path: &str, key: impl std::fmt::Display) -> String {
    if path.is_empty() {
        key.to_string()
    } else {
        format!("{path}{STEP}{key}")
    }
}

/// The start of a text, as a message shows it.
fn shown(text: &str) -> String {
    let mut begin: String = text.chars().take(SHOWN).collect();
    if begin.len() < text.len() {
        begin.push_str(" ...");
    }
    begin.escape_debug().to_string().replace("\\\"", "\"")
}

/// Reports the place of each key of a table.
fn note_lines(table: &DeTable<'_>, path: &str, note: &mut dyn FnMut(String, usize)) {
    for (key, value) in table {
        let path = below(path, key.get_ref());
        note(path.clone(), key.span().start);
        note_lines_below(value.get_ref(), &path, note);
    }
}

/// Reports the place of each key below a value.
fn note_lines_below(value: &DeValue<'_>, path: &str, note: &mut dyn FnMut(String, usize)) {
    if let Some(table) = value.as_table() {
        note_lines(table, path, note);
    }
    for (k, item) in value.as_array().into_iter().flatten().enumerate() {
        let path = below(path, k);
        note(path.clone(), item.span().start);
        note_lines_below(item.get_ref(), &path, note);
    }
}

/// Gives each profile, and each item of a list `[[...]]` of the file or of a profile, its path under the key [`PATH`].
fn name_items(table: &mut DeTable<'_>, path: &str) {
    let name = |value: &mut Spanned<DeValue<'_>>, path: &str| {
        if let DeValue::Table(table) = value.get_mut() {
            let own = DeValue::String(path.to_owned().into());
            // No place in the text, so that no mistake is found there.
            table.insert(Spanned::new(0..0, PATH.into()), Spanned::new(0..0, own));
        }
    };
    for (key, value) in table.iter_mut() {
        let at = below(path, key.get_ref());
        let is_profiles = path.is_empty() && key.get_ref() == "profile";
        match value.get_mut() {
            DeValue::Array(list) => {
                for (k, item) in list.iter_mut().enumerate() {
                    name(item, &below(&at, k));
                }
            }
            DeValue::Table(profiles) if is_profiles => {
                for (key, profile) in profiles.iter_mut() {
                    let at = below(&at, key.get_ref());
                    if let DeValue::Table(profile) = profile.get_mut() {
                        name_items(profile, &at);
                    }
                    name(profile, &at);
                }
            }
            _ => {}
        }
    }
}

/// Where serde found a mistake.
struct Culprit {
    path: String,
    /// Whether it was taken out, and not left to the table around it.
    taken: bool,
}

/// Takes the part of a value out that lies at a span of the text; an item of a plain list goes with its list.
fn take_out(part: &mut Spanned<DeValue<'_>>, span: &Range<usize>, path: &str) -> Option<Culprit> {
    match part.get_mut() {
        DeValue::Table(table) => {
            let (key, mut culprit) = table.iter_mut().find_map(|(key, value)| {
                let path = below(path, key.get_ref());
                let is_here = key.span() == *span || value.span() == *span;
                let inside = take_out(value, span, &path);
                let here = || is_here.then_some(Culprit { path, taken: false });
                Some((key.get_ref().to_string(), inside.or_else(here)?))
            })?;
            if !culprit.taken {
                table.remove(key.as_str());
                culprit.taken = true;
            }
            Some(culprit)
        }
        DeValue::Array(list) => {
            let items = list.iter_mut().enumerate();
            let (k, mut culprit) = { items }.find_map(|(k, item)| {
                // Items before it may have been taken out: its own path tells its number.
                let own = item
                    .get_ref()
                    .get(PATH)
                    .and_then(|own| own.get_ref().as_str());
                let (path, is_named) = (own.map_or(below(path, k), str::to_owned), own.is_some());
                let here = (item.span() == *span).then_some(Culprit {
                    path: path.clone(),
                    taken: false,
                });
                let inside = take_out(item, span, &path).or(here)?;
                Some(((k, is_named), inside))
            })?;
            if let ((k, true), false) = (k, culprit.taken) {
                let all = std::mem::replace(list, DeArray::new())
                    .into_iter()
                    .enumerate();
                *list = all
                    .filter_map(|(i, item)| (i != k).then_some(item))
                    .collect();
                culprit.taken = true;
            }
            Some(culprit)
        }
        _ => None,
    }
}

/// Names in a message between backquotes, from the one behind some words on.
fn quoted<'m>(message: &'m str, behind: &str) -> impl Iterator<Item = &'m str> + use<'m> {
    let rest = message.split_once(behind).map(|(_, rest)| rest);
    rest.into_iter().flat_map(|rest| rest.split('`').step_by(2))
}

/// A message of serde in the words of this project, with the remedy.
fn plain_words(message: &str) -> String {
    if let Some(name) = quoted(message, "unknown field `").next() {
        let known = quoted(message, "unknown field `").skip(1);
        let known: Vec<String> = known
            .filter(|key| *key != PATH)
            .map(str::to_owned)
            .collect();
        let near = like_names(&known, name);
        return match known.len() {
            0..=4 => format!("unknown key; the keys are {}", known.join(", ")),
            _ => format!(
                "unknown key; did you mean {near}? The keys are {}",
                known.join(", ")
            ),
        };
    }
    if let Some(key) = quoted(message, "missing field `").next() {
        return format!("has no '{key}': add it");
    }
    if message.starts_with("unknown variant `") {
        let known = quoted(message, "unknown variant `").skip(1);
        let known: Vec<String> = known.map(|word| format!("\"{word}\"")).collect();
        return format!("must be one of {}", known.join(", "));
    }
    let Some((_, expected)) = message.split_once(", expected ") else {
        return message.replace('\n', ", ");
    };
    let plain = match expected.trim() {
        "f64" => "a number",
        "a nonzero usize" => "a whole number, 1 or more",
        "usize" | "u32" | "u64" => "a whole number, 0 or more",
        "a sequence" => "a list",
        "a string" | "string or table" => "a text",
        "path string" => "a path",
        "a boolean" => "true or false",
        "a map" => "a table of keys",
        other if other.starts_with("struct ") => "a table of keys",
        other => other,
    };
    format!(
        "must be {}",
        plain.replace("an array of length", "a list of length")
    )
}
