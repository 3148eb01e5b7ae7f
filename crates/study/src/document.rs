//! A TOML file with the lines of its keys, and its tables read key by key.

use crate::problem::{Problem, Problems};
use input::file::toml_slip;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// A TOML file with the lines of its keys.
#[derive(Debug)]
pub(crate) struct Document {
    /// Name for messages.
    pub(crate) file: String,
    /// Content.
    pub(crate) table: Table,
    /// Line, from 1, of each key by its path; the items of a list are numbered from 0.
    lines: BTreeMap<String, usize>,
}

impl Document {
    /// Parses a text; syntax that cannot be read is told, all of it, and gives none.
    pub(crate) fn parse(text: &str, file: &str, problems: &mut Problems) -> Option<Self> {
        let (spanned, errors) = DeTable::parse_recoverable(text);
        let before = problems.count();
        // Each key asks for its line: to count from the start each time takes minutes for a file of thousands.
        let ends: Vec<usize> = text.match_indices('\n').map(|(end, _)| end).collect();
        let line_of = |at: usize| 1 + ends.partition_point(|end| *end < at);
        let mut told = BTreeSet::new();
        for error in errors {
            // What follows in a line that could not be read is read wrongly.
            let line = error.span().map(|span| line_of(span.start));
            if !told.insert(line) {
                continue;
            }
            let slip = line.and_then(|n| toml_slip(text.lines().nth(n - 1)?));
            let reason = slip.unwrap_or_else(|| error.message().replace('\n', ", "));
            problems.add(Problem {
                file: file.into(),
                line,
                what: "the text".into(),
                problem: format!("is no TOML: {reason}"),
            });
        }
        if problems.count() > before {
            return None;
        }
        let mut lines = BTreeMap::new();
        walk_table(spanned.get_ref(), "", &mut |path, at| {
            lines.insert(path, line_of(at));
        });
        match toml::from_str(text) {
            Ok(table) => Some(Self {
                file: file.into(),
                table,
                lines,
            }),
            Err(error) => {
                problems.add(Problem {
                    file: file.into(),
                    line: error.span().map(|span| line_of(span.start)),
                    what: "the text".into(),
                    problem: format!("cannot be read: {}", error.message()),
                });
                None
            }
        }
    }

    /// The line of a path, or of the nearest table around it.
    pub(crate) fn line(&self, path: &str) -> Option<usize> {
        let mut path = path;
        loop {
            if let Some(line) = self.lines.get(path) {
                return Some(*line);
            }
            path = path.rsplit_once('\u{1f}')?.0;
        }
    }

    /// A problem of this file.
    pub(crate) fn problem(
        &self,
        path: &str,
        what: impl Into<String>,
        problem: impl Into<String>,
    ) -> Problem {
        Problem {
            file: self.file.clone(),
            line: self.line(path),
            what: what.into(),
            problem: problem.into(),
        }
    }
}

/// A path one step deeper; keys may hold dots, so that steps are parted by a character that none holds.
pub(crate) fn below(path: &str, key: impl std::fmt::Display) -> String {
    if path.is_empty() {
        key.to_string()
    } else {
        format!("{path}\u{1f}{key}")
    }
}

/// Tells the place of each key of a table.
fn walk_table(table: &DeTable<'_>, path: &str, tell: &mut dyn FnMut(String, usize)) {
    for (key, value) in table {
        let path = below(path, key.get_ref());
        tell(path.clone(), key.span().start);
        walk_value(value.get_ref(), &path, tell);
    }
}

/// Tells the place of each key below a value.
fn walk_value(value: &DeValue<'_>, path: &str, tell: &mut dyn FnMut(String, usize)) {
    if let Some(table) = value.as_table() {
        walk_table(table, path, tell);
    } else if let Some(list) = value.as_array() {
        for (k, item) in list.iter().enumerate() {
            let path = below(path, k);
            tell(path.clone(), item.span().start);
            walk_value(item.get_ref(), &path, tell);
        }
    }
}

/// A table of a file that is read key by key.
#[derive(Debug, Clone)]
pub(crate) struct Fields<'a> {
    /// The file.
    pub(crate) document: &'a Document,
    /// The table.
    pub(crate) table: &'a Table,
    /// Its path.
    pub(crate) path: String,
    /// The table in words, for messages.
    pub(crate) words: String,
}

impl<'a> Fields<'a> {
    /// The whole file.
    pub(crate) fn root(document: &'a Document) -> Self {
        Self {
            document,
            table: &document.table,
            path: String::new(),
            words: "the study".into(),
        }
    }

    /// The tables of a list `[[key]]`, in the order of the file.
    pub(crate) fn list(&self, key: &str, problems: &mut Problems) -> Vec<Fields<'a>> {
        let Some(value) = self.table.get(key) else {
            return Vec::new();
        };
        let path = below(&self.path, key);
        let wrong = || {
            let what = format!("'{key}'");
            self.document.problem(
                &path,
                what,
                format!("must be a list of tables: write [[{key}]]"),
            )
        };
        let Value::Array(items) = value else {
            problems.add(wrong());
            return Vec::new();
        };
        let mut found = Vec::new();
        for (k, item) in items.iter().enumerate() {
            match item {
                Value::Table(table) => found.push(Fields {
                    document: self.document,
                    table,
                    path: below(&path, k),
                    words: format!("[[{key}]] {}", k + 1),
                }),
                _ => problems.add(wrong()),
            }
        }
        found
    }

    /// The table `[key]`; none where it is absent.
    pub(crate) fn table(&self, key: &str, problems: &mut Problems) -> Option<Fields<'a>> {
        let value = self.table.get(key)?;
        let path = below(&self.path, key);
        let Value::Table(table) = value else {
            let what = format!("'{key}' = {value}");
            problems.add(
                self.document
                    .problem(&path, what, "must be a table of keys"),
            );
            return None;
        };
        let words = if self.path.is_empty() {
            format!("[{key}]")
        } else {
            format!("{}: {key}", self.words)
        };
        Some(Fields {
            document: self.document,
            table,
            path,
            words,
        })
    }

    /// A key that must be there.
    pub(crate) fn required<T: DeserializeOwned>(
        &self,
        key: &str,
        kind: &str,
        problems: &mut Problems,
    ) -> Option<T> {
        if !self.table.contains_key(key) {
            let problem = format!("has no '{key}': add {key} = ..., {kind}");
            problems.add(
                self.document
                    .problem(&self.path, self.words.clone(), problem),
            );
        }
        self.optional(key, kind, problems)
    }

    /// A key that may be there.
    pub(crate) fn optional<T: DeserializeOwned>(
        &self,
        key: &str,
        kind: &str,
        problems: &mut Problems,
    ) -> Option<T> {
        let value = self.table.get(key)?;
        let read = value.clone().try_into().ok();
        if read.is_none() {
            problems.add(self.wrong(key, format!("must be {kind}")));
        }
        read
    }

    /// A problem of one key, with its value.
    pub(crate) fn wrong(&self, key: &str, problem: impl Into<String>) -> Problem {
        let value = match self.table.get(key) {
            Some(value) => format!(" = {value}"),
            None => String::new(),
        };
        let what = format!("{}: {key}{value}", self.words);
        self.document
            .problem(&below(&self.path, key), what, problem)
    }

    /// Refuses keys that are not among those known.
    pub(crate) fn check_keys(&self, known: &[&str], problems: &mut Problems) {
        for key in self.table.keys() {
            if !known.contains(&key.as_str()) {
                let problem = format!("is no key here; there are {}", known.join(", "));
                problems.add(self.wrong(key, problem));
            }
        }
    }
}
