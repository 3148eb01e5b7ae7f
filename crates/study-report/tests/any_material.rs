//! No word and no number of one study is in the report: it shows any material.

use std::fs;
use std::path::{Path, PathBuf};

/// Words and numbers of the study that the first version of the report was written for.
///
/// They are put together here so that a search of the sources does not find this list.
fn words_of_one_study() -> Vec<String> {
    let pieces: [&[&str]; 12] = [
        &["cot", "ton"],
        &["meter", "ing"],
        &["E'kang", "mian"],
        &["kang", "mian"],
        &["38.", "87"],
        &["38.", "868"],
        &["36.", "39"],
        &["39.", "07"],
        &["eq. (", "10)"],
        &["eq. (", "9)"],
        &["Table", " 4 of"],
        &["published ", "optimum"],
    ];
    pieces
        .iter()
        .map(|piece| piece.concat().to_lowercase())
        .collect()
}

/// All files of a folder and the folders in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of this crate");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                files(&path)
            } else {
                vec![path]
            }
        })
        .collect()
}

#[test]
fn no_word_of_one_study_stands_in_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = files(&root.join("src"));
    sources.extend(files(&root.join("tests")));
    assert!(sources.len() > 30, "the sources were found");
    let mut found = Vec::new();
    for path in sources {
        let text = fs::read_to_string(&path)
            .expect("code is text")
            .to_lowercase();
        for word in words_of_one_study() {
            if text.contains(&word) {
                found.push(format!("{}: {word}", path.display()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
