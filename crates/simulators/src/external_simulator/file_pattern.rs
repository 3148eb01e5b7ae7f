//! Files by a name with `*` in it.

use crate::external_simulator::process::Failure;
use input::file::name_order;
use std::fs;
use std::path::{Path, PathBuf};

/// The files that a path with `*` in its last part means, in the order of the numbers in their names; all of a folder.
pub(crate) fn matching(folder: &Path, pattern: &Path) -> Result<Vec<PathBuf>, Failure> {
    let whole = folder.join(pattern);
    let (parent, name) = if whole.is_dir() {
        (whole.clone(), "*".to_owned())
    } else {
        let name = whole.file_name().and_then(|n| n.to_str()).unwrap_or("");
        (whole.parent().unwrap_or(folder).to_owned(), name.to_owned())
    };
    let entries = fs::read_dir(&parent);
    let entries = entries.map_err(|error| format!("cannot list {}: {error}", parent.display()))?;
    let mut found: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| {
            let file = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
            path.is_file() && matches(file, &name)
        })
        .collect();
    if found.is_empty() {
        return Err(format!("the program left no {}", whole.display()));
    }
    found.sort_by_cached_key(|path| name_order(path));
    Ok(found)
}

/// Whether a name is one that a pattern with `*` means.
fn matches(name: &str, pattern: &str) -> bool {
    match pattern.split_once('*') {
        None => name == pattern,
        Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| {
            (0..=rest.len())
                .filter(|k| rest.is_char_boundary(*k))
                .any(|k| matches(&rest[k..], after))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn a_star_stands_for_any_text() {
        for (name, pattern, expected) in [
            ("bed10.vtk", "bed*.vtk", true),
            ("bed.vtk", "bed*.vtk", true),
            ("abed1.vtk", "bed*.vtk", false),
            ("bed1.vtk.gz", "bed*.vtk", false),
            ("a_b_c", "a*b*c", true),
            ("x", "*", true),
        ] {
            assert_eq!(matches(name, pattern), expected, "{name} {pattern}");
        }
    }
}
