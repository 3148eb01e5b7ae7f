//! Faults of a study file, all at once.

use crate::document::Document;
use std::collections::BTreeSet;
use std::fmt;

/// One mistake, with the remedy.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// Its name.
    pub file: String,
    /// The line, from 1, if it is known.
    pub line: Option<usize>,
    /// Table and key, with its value if it has one.
    pub what: String,
    /// Its fault, and the remedy.
    pub problem: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}: {}", self.what, self.problem)
    }
}

/// Problems found so far in a file.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    /// Empty for a design table, whose problems name their own places.
    pub(crate) document: Document,
    /// In the order in which they were found.
    list: Vec<Problem>,
}

impl Problems {
    /// None yet in this file.
    pub(crate) fn of(document: Document) -> Self {
        Self {
            document,
            list: Vec::new(),
        }
    }

    /// Adds a problem, once.
    pub(crate) fn add(&mut self, problem: Problem) {
        if !self.list.contains(&problem) {
            self.list.push(problem);
        }
    }

    /// Adds a problem at a path of the file, which is named with its value.
    pub(crate) fn wrong(&mut self, path: &str, problem: impl Into<String>) {
        self.add(self.document.problem(path, problem.into()));
    }

    /// Adds a problem at a path unless a condition holds.
    pub(crate) fn require(&mut self, holds: bool, path: &str, problem: &str) {
        if !holds {
            self.wrong(path, problem);
        }
    }

    /// Adds those of others.
    pub(crate) fn extend(&mut self, others: Self) {
        others
            .list
            .into_iter()
            .for_each(|problem| self.add(problem));
    }

    /// Lines in which something is wrong.
    pub(crate) fn lines(&self) -> BTreeSet<usize> {
        self.list.iter().filter_map(|p| p.line).collect()
    }

    /// Number of problems found so far.
    pub(crate) fn count(&self) -> usize {
        self.list.len()
    }

    /// Fails if there is a problem; they are in the order of their lines.
    pub(crate) fn into_result(mut self) -> Result<(), crate::Error> {
        if self.list.is_empty() {
            return Ok(());
        }
        self.list.sort_by_key(|p| p.line.unwrap_or(usize::MAX));
        Err(crate::Error::Problems { list: self.list })
    }
}
