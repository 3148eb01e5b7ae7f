//! Numbers beyond all quantities and texts that are not names, anywhere in the file.
//!
//! Names and numbers go into names of files, command lines, columns of tables and fits. What would fail there is refused before the first
//! run.

use crate::document::below;
use crate::limits::{LEAST, LONGEST_NAME, LONGEST_TEXT, MOST};
use crate::problem::Problems;
use toml::Value;

/// Refuses numbers and texts of a whole file; lines in which something else is wrong are left out.
pub(crate) fn check(problems: &mut Problems) {
    let known = problems.lines();
    let mut found = Vec::new();
    for (key, value) in &problems.document.table {
        check_below(key, key, value, &mut found);
    }
    for (path, problem) in found {
        let line = problems.document.line(&path);
        if line.is_none_or(|line| !known.contains(&line)) {
            problems.wrong(&path, problem);
        }
    }
}

/// Why a name is invalid, such as that of a scene, a parameter or a study.
pub(crate) fn wrong_name(name: &str) -> Option<String> {
    if name.trim().is_empty() {
        return Some("is empty: use a word".to_owned());
    }
    if name.len() > LONGEST_NAME {
        return Some(format!(
            "has {} bytes: use {LONGEST_NAME} at most, since names of files are made of it",
            name.len()
        ));
    }
    let is_odd = name.trim() != name || name.contains(char::is_control);
    is_odd.then(|| {
        "must not begin or end with a blank, nor hold line ends or control characters".to_owned()
    })
}

/// Looks at a key and its value, and at all below it.
fn check_below(path: &str, key: &str, value: &Value, found: &mut Vec<(String, String)>) {
    let wrong_key = wrong_name(key).map(|problem| format!("as a key: {problem}"));
    let problem = match value {
        Value::Float(number) => wrong_number(*number),
        #[expect(clippy::cast_precision_loss, reason = "only its size counts")]
        Value::Integer(number) => wrong_number(*number as f64),
        Value::String(text) => wrong_text(text),
        _ => None,
    };
    found.extend(
        wrong_key
            .or(problem)
            .map(|problem| (path.to_owned(), problem)),
    );
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                check_below(&below(path, key), key, value, found);
            }
        }
        Value::Array(list) => {
            for (k, item) in list.iter().enumerate() {
                check_below(&below(path, k), key, item, found);
            }
        }
        _ => {}
    }
}

fn wrong_number(number: f64) -> Option<String> {
    let size = number.abs();
    let is_plausible = size == 0.0 || (LEAST..=MOST).contains(&size);
    (!is_plausible).then(|| format!("must be 0, or of a size of {LEAST:e} to {MOST:e}"))
}

fn wrong_text(text: &str) -> Option<String> {
    if text.len() > LONGEST_TEXT {
        let bytes = text.len();
        return Some(format!("has {bytes} bytes: use {LONGEST_TEXT} at most"));
    }
    let is_odd = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.contains(is_odd)
        .then(|| "holds a control character: remove it".to_owned())
}
