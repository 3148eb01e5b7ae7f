//! What no study means, wherever it stands in the file: numbers beyond all quantities, texts that are no words.
//!
//! Names and numbers go into names of files, command lines, columns of tables and fits. What would fail there is refused before the first
//! run.

use crate::document::{Document, below};
use crate::limits::{LEAST, LONGEST_NAME, LONGEST_TEXT, MOST};
use crate::problem::Problems;
use toml::{Table, Value};

/// Refuses numbers and texts of a whole file; lines in which something else is wrong are left out.
pub(crate) fn check(document: &Document, problems: &mut Problems) {
    let mut found = Problems::default();
    check_table(document, &document.table, "", &mut found);
    problems.add_of_other_lines(found);
}

/// What is wrong with a name, as the rest of a sentence about it: with one of a scene, a parameter, a study.
pub(crate) fn wrong_name(name: &str) -> Option<String> {
    if name.trim().is_empty() {
        return Some("is empty: take a word".to_owned());
    }
    if name.len() > LONGEST_NAME {
        return Some(format!(
            "has {} bytes: take {LONGEST_NAME} at most, since names of files are made of it",
            name.len()
        ));
    }
    if name.trim() != name || name.contains(char::is_control) {
        return Some(
            "must neither begin nor end with a blank, nor hold line ends or control characters"
                .to_owned(),
        );
    }
    None
}

/// Looks at the keys and the values of a table.
fn check_table(document: &Document, table: &Table, path: &str, problems: &mut Problems) {
    for (key, value) in table {
        let path = below(path, key);
        if let Some(problem) = wrong_name(key) {
            let what = format!("the key '{}'", shown(key));
            problems.add(document.problem(&path, what, problem));
        }
        check_value(document, key, value, &path, problems);
    }
}

/// Looks at a value.
fn check_value(document: &Document, key: &str, value: &Value, path: &str, problems: &mut Problems) {
    let problem = match value {
        Value::Float(number) => wrong_number(*number),
        Value::Integer(number) => wrong_number(*number as f64),
        Value::String(text) => wrong_text(text),
        Value::Table(table) => {
            check_table(document, table, path, problems);
            None
        }
        Value::Array(list) => {
            for (k, item) in list.iter().enumerate() {
                check_value(document, key, item, &below(path, k), problems);
            }
            None
        }
        Value::Boolean(_) | Value::Datetime(_) => None,
    };
    if let Some(problem) = problem {
        // Hundreds of zeros say less than an exponent.
        let text = match value {
            Value::Float(number) => format!("{number:e}"),
            other => other.to_string(),
        };
        let what = format!("{key} = {}", shown(&text));
        problems.add(document.problem(path, what, problem));
    }
}

/// What is wrong with a number.
fn wrong_number(number: f64) -> Option<String> {
    let size = number.abs();
    let is_plausible = size == 0.0 || (LEAST..=MOST).contains(&size);
    (!is_plausible).then(|| format!("must be 0, or of a size of {LEAST:e} to {MOST:e}"))
}

/// What is wrong with a text.
fn wrong_text(text: &str) -> Option<String> {
    if text.len() > LONGEST_TEXT {
        return Some(format!(
            "has {} bytes: {LONGEST_TEXT} at most are a text to be read",
            text.len()
        ));
    }
    let is_odd = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.contains(is_odd)
        .then(|| "holds a control character: remove it".to_owned())
}

/// The start of a text, as a message shows it.
fn shown(text: &str) -> String {
    const SHOWN: usize = 40;
    let mut begin: String = text.chars().take(SHOWN).collect();
    if begin.len() < text.len() {
        begin.push_str(" ...");
    }
    begin.escape_debug().to_string()
}
