//! What is wrong with a study file: all of it at once.

use std::collections::BTreeSet;
use std::fmt;

/// One thing that is wrong, with the way out.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// The file.
    pub file: String,
    /// The line, from 1, where it is known.
    pub line: Option<usize>,
    /// The entry, with its value where it has one.
    pub what: String,
    /// What is wrong with it, and the way out.
    pub problem: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {} {}", self.what, self.problem)
    }
}

/// Problems found so far.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    /// In the order in which they were found.
    list: Vec<Problem>,
}

impl Problems {
    /// Adds a problem, once.
    pub(crate) fn add(&mut self, problem: Problem) {
        if !self.list.contains(&problem) {
            self.list.push(problem);
        }
    }

    /// Adds those of others whose line has no problem yet.
    pub(crate) fn add_of_other_lines(&mut self, others: Self) {
        let known: BTreeSet<usize> = self.list.iter().filter_map(|p| p.line).collect();
        let is_new = |p: &Problem| p.line.is_none_or(|line| !known.contains(&line));
        others
            .list
            .into_iter()
            .filter(is_new)
            .for_each(|p| self.add(p));
    }

    /// Number of problems found so far.
    pub(crate) fn count(&self) -> usize {
        self.list.len()
    }

    /// Fails where there is a problem; problems are told in the order of their lines.
    pub(crate) fn into_result(mut self) -> Result<(), crate::Error> {
        if self.list.is_empty() {
            return Ok(());
        }
        self.list.sort_by_key(|p| p.line.unwrap_or(usize::MAX));
        Err(crate::Error::Problems { list: self.list })
    }
}
