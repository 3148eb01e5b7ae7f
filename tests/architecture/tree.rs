//! Rules that hold for every file of the tree.

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the root of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests lie one level below the root")
        .to_owned()
}

/// Returns every file of the tree in a fixed order, without what version control ignores.
pub(crate) fn files() -> Vec<PathBuf> {
    let root = root();
    let ignored: Vec<PathBuf> = fs::read_to_string(root.join(".gitignore"))
        .expect("the root has a .gitignore")
        .lines()
        .filter_map(|line| line.strip_prefix('/'))
        .chain([".git"])
        .map(|name| root.join(name))
        .collect();
    let mut files = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the tree can be listed") {
            let path = entry.expect("an entry can be read").path();
            if ignored.contains(&path) {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Returns the text of a file, or none if it holds something else than text.
pub(crate) fn text_of(path: &Path) -> Option<String> {
    String::from_utf8(fs::read(path).expect("a file of the tree can be read")).ok()
}

/// Returns a path as seen from the root.
pub(crate) fn shown(path: &Path) -> String {
    let path = path.strip_prefix(root()).unwrap_or(path);
    path.display().to_string()
}

/// Returns whether a line holds the start of a path that exists on one machine only.
///
/// The starts are put together here so that this file does not hold them.
fn has_machine_path(line: &str) -> bool {
    ["home", "root", "work", "tmp", "Users", "mnt"]
        .iter()
        .any(|folder| {
            let start = format!("/{folder}/");
            line.match_indices(&start).any(|(at, _)| {
                // A path in the middle of a longer one, such as in a web address, is none of ours.
                let before = line[..at].chars().next_back();
                let after = line[at + start.len()..].chars().next();
                !before.is_some_and(|c| c.is_alphanumeric() || "._-~$}{*".contains(c))
                    && after.is_some_and(|c| c.is_alphanumeric() || "._$".contains(c))
            })
        })
}

#[test]
fn machine_paths_are_told_from_others() {
    let bad = ["", "home", "a"].join("/");
    assert!(has_machine_path(&bad));
    assert!(has_machine_path(&format!("see `{bad}/b`")));
    assert!(!has_machine_path(&format!("https://example.org{bad}")));
    assert!(!has_machine_path("a/b/c"));
}

#[test]
fn no_file_names_a_path_of_one_machine() {
    let mut found = Vec::new();
    for path in files() {
        let Some(text) = text_of(&path) else { continue };
        for (number, line) in text.lines().enumerate() {
            if has_machine_path(line) {
                found.push(format!("{}:{}: {line}", shown(&path), number + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn every_folder_of_fixtures_tells_its_origin_and_licence() {
    let mut missing = Vec::new();
    for entry in fs::read_dir(root().join("fixtures")).expect("fixtures exist") {
        let folder = entry.expect("an entry can be read").path();
        if !folder.is_dir() {
            continue;
        }
        let readme = fs::read_to_string(folder.join("README.md")).unwrap_or_default();
        if !readme.to_lowercase().contains("licen") {
            missing.push(shown(&folder));
        }
    }
    assert!(
        missing.is_empty(),
        "no README.md with the licence in {missing:?}"
    );
}

/// Users find nothing in more pages than they can read. Words are counted as `wc -w` counts them.
#[test]
fn pages_have_at_most_twenty_thousand_words() {
    const LIMIT: usize = 20_000;
    let docs = root().join("docs");
    let pages = files().into_iter().filter(|path| path.starts_with(&docs));
    let pages = pages.filter(|path| path.extension().is_some_and(|end| end == "md"));
    let mut words: Vec<(usize, String)> = pages
        .map(|path| {
            let text = text_of(&path).expect("a page is text");
            (text.split_whitespace().count(), shown(&path))
        })
        .collect();
    words.sort();
    let all: usize = words.iter().map(|(count, _)| count).sum();
    let longest = words.iter().rev().take(5);
    let longest: Vec<String> = longest
        .map(|(count, page)| format!("{page}: {count}"))
        .collect();
    assert!(
        all <= LIMIT,
        "docs has {all} words, {LIMIT} at most; generated tables and old figures first; the longest pages are {}",
        longest.join(", ")
    );
}

/// Generated pictures and meshes aside, a large file in the tree is one that slipped in.
#[test]
fn no_file_is_larger_than_four_mebibytes() {
    const LIMIT: u64 = 4 << 20;
    for path in files() {
        let size = fs::metadata(&path).expect("a file of the tree").len();
        assert!(size <= LIMIT, "{} has {size} bytes", shown(&path));
    }
}

/// A result that depends on the environment or the date cannot be repeated. `command-line` is where
/// the words of the command come in.
#[test]
fn libraries_read_neither_environment_nor_date() {
    let crates = root().join("crates");
    let mut found = Vec::new();
    for path in files() {
        let is_library =
            path.starts_with(&crates) && !path.starts_with(crates.join("command-line"));
        if !is_library || path.extension().is_none_or(|end| end != "rs") {
            continue;
        }
        let source = text_of(&path).expect("code is text");
        for (number, line) in source.lines().enumerate() {
            if line.contains("env::var") || line.contains("SystemTime") {
                found.push(format!("{}:{}: {line}", shown(&path), number + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
