//! Names of the files of a store.
//!
//! Hidden files (their names begin with a point) are never records: files that are being written, claims, and what
//! systems and shared folders put beside them.

use std::path::{Path, PathBuf};

/// Ending of a record file.
const RECORD_ENDING: &str = ".json";
const CLAIM_ENDING: &str = ".claim";
/// Ending of a note on a run that failed.
const FAILURE_ENDING: &str = ".failed";
/// Ending of a file that is being written.
const ASIDE_ENDING: &str = ".aside";
/// Follows the name of a record that was set aside.
const DAMAGED_ENDING: &str = ".damaged";

/// Whether a text has the form of a key.
pub(crate) fn is_key(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

/// The file of a key.
pub(crate) fn record(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("{key}{RECORD_ENDING}"))
}

pub(crate) fn claim(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!(".{key}{CLAIM_ENDING}"))
}

/// The note on the failed run of a key.
pub(crate) fn failure(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!(".{key}{FAILURE_ENDING}"))
}

/// A file that is being written, or kept for a moment, by a process of a machine.
pub(crate) fn aside(
    folder: &Path,
    stem: &str,
    machine: &str,
    process: u32,
    number: u64,
) -> PathBuf {
    folder.join(format!(
        ".{stem}.{machine}.{process}.{number}{ASIDE_ENDING}"
    ))
}

/// The `number`th name, from 1 on, under which a record is set aside.
pub(crate) fn damaged(record: &Path, number: usize) -> PathBuf {
    let mut name = record.as_os_str().to_owned();
    name.push(DAMAGED_ENDING);
    if number > 1 {
        name.push(format!("-{number}"));
    }
    name.into()
}

/// The last part of a path, where it is text.
fn name(path: &Path) -> Option<&str> {
    path.file_name()?.to_str()
}

/// The key in the name of a record file.
pub(crate) fn key_of(path: &Path) -> Option<&str> {
    name(path)?
        .strip_suffix(RECORD_ENDING)
        .filter(|key| is_key(key))
}

/// The key in the name of a claim.
pub(crate) fn claimed_key_of(path: &Path) -> Option<&str> {
    hidden_key_of(path, CLAIM_ENDING)
}

/// The key in the name of a note on a failed run.
pub(crate) fn failed_key_of(path: &Path) -> Option<&str> {
    hidden_key_of(path, FAILURE_ENDING)
}

/// The key in the name of a hidden file with an ending.
fn hidden_key_of<'p>(path: &'p Path, ending: &str) -> Option<&'p str> {
    name(path)?
        .strip_prefix('.')?
        .strip_suffix(ending)
        .filter(|key| is_key(key))
}

/// Whether the name is that of a file that is being written.
pub(crate) fn is_aside(path: &Path) -> bool {
    name(path).is_some_and(|name| name.starts_with('.') && name.ends_with(ASIDE_ENDING))
}

/// Machine and process in the name of a file that is being written.
pub(crate) fn writer_of(path: &Path) -> Option<(&str, u32)> {
    let mut parts = name(path)?.strip_suffix(ASIDE_ENDING)?.rsplitn(4, '.');
    let _number = parts.next()?;
    let process = parts.next()?.parse().ok()?;
    Some((parts.next()?, process))
}

/// Whether a file other than a record belongs here: hidden, or set aside.
pub(crate) fn is_beside_records(path: &Path) -> bool {
    let Some(name) = path.file_name() else {
        return false;
    };
    name.as_encoded_bytes().starts_with(b".") || damaged_name(path).is_some()
}

/// The name of a record that was set aside.
pub(crate) fn damaged_name(path: &Path) -> Option<&str> {
    let name = name(path)?;
    let (record, rest) = name.split_once(DAMAGED_ENDING)?;
    key_of(Path::new(record))?;
    let number = rest.strip_prefix('-').unwrap_or("2");
    let fits = (rest.is_empty() || rest.starts_with('-')) && number.parse::<usize>().is_ok();
    fits.then_some(name)
}

#[cfg(test)]
mod tests {
    use super::{aside, claim, claimed_key_of, damaged, is_aside, is_beside_records, key_of};
    use super::{failed_key_of, failure, record, writer_of};
    use std::path::Path;

    /// Each kind of name is distinguished from the others, for any text before its ending.
    #[test]
    fn names_are_read_back_as_what_they_were_made_for() {
        let folder = Path::new("runs");
        let key = "0123456789abcdef".repeat(4);
        let file = record(folder, &key);
        assert_eq!(key_of(&file), Some(key.as_str()));
        assert!(!is_beside_records(&file));
        let claimed = claim(folder, &key);
        assert_eq!(claimed_key_of(&claimed), Some(key.as_str()));
        assert!(is_beside_records(&claimed) && key_of(&claimed).is_none());
        let failed = failure(folder, &key);
        assert_eq!(failed_key_of(&failed), Some(key.as_str()));
        assert_eq!(
            (claimed_key_of(&failed), failed_key_of(&claimed)),
            (None, None)
        );
        assert!(is_beside_records(&failed) && key_of(&failed).is_none());
        let written = aside(folder, &key, "node-7-0a1b2c3d", 4711, 12);
        assert!(is_aside(&written) && key_of(&written).is_none());
        assert_eq!(writer_of(&written), Some(("node-7-0a1b2c3d", 4711)));
        for number in [1, 2, 30] {
            let away = damaged(&file, number);
            assert!(is_beside_records(&away), "{}", away.display());
            assert_eq!(key_of(&away), None);
        }
        for other in ["notes.txt", "notes.json.damaged", "a.json"] {
            assert!(!is_beside_records(&folder.join(other)), "{other}");
        }
        let odd = format!("{key}.json.damaged-by-me");
        assert!(!is_beside_records(&folder.join(odd)));
    }
}
