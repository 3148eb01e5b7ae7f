//! Every source that the code cites is in REFERENCES.bib.

use std::collections::BTreeSet;
use std::fs;

use crate::tree;

/// Returns the keys of the bibliography.
fn known_keys() -> Vec<String> {
    fs::read_to_string(tree::root().join("REFERENCES.bib"))
        .expect("the root has a bibliography")
        .lines()
        .filter(|line| line.starts_with('@'))
        .filter_map(|line| Some(line.split_once('{')?.1.trim_end_matches(',').to_owned()))
        .collect()
}

/// Returns whether a word has the form of a key: a name, the four digits of a year, and possibly
/// a letter.
fn is_key(word: &str) -> bool {
    let word = word
        .strip_suffix(|c: char| c.is_ascii_lowercase())
        .unwrap_or(word);
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    word.len() == name.len() + 4
        && name.len() > 1
        && name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(char::is_alphabetic)
}

/// Returns the keys that a text cites: in brackets, the key first, then possibly a place in the
/// source and further keys.
fn cited_keys(text: &str) -> Vec<&str> {
    let mut keys = Vec::new();
    for opened in text.split('[').skip(1) {
        let Some((inside, _)) = opened.split_once(']') else {
            continue;
        };
        let mut words = inside
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .peekable();
        if words.peek().is_some_and(|first| is_key(first)) {
            keys.extend(words.filter(|word| is_key(word)));
        }
    }
    keys
}

/// Returns the comments of a source file as one text, so that a citation may span lines.
fn comments(source: &str) -> String {
    source
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("//"))
        .map(|line| line.trim_start_matches(['/', '!']))
        .collect::<Vec<_>>()
        .join(" ")
}

#[test]
fn keys_are_found_with_their_places_and_across_lines() {
    let source =
        "/// [Hertz1881]; `[Ai2011, type A]`\n/// [FriesHunter1980; Box2005a,\n/// table 6]";
    assert_eq!(
        cited_keys(&comments(source)),
        ["Hertz1881", "Ai2011", "FriesHunter1980", "Box2005a"]
    );
    assert!(cited_keys("[0, 1] [`Length`] [i1234] [U2019x] [X1] [a Hertz1881]").is_empty());
}

#[test]
fn every_cited_source_stands_in_the_bibliography() {
    let known = known_keys();
    let mut unknown = BTreeSet::new();
    for path in tree::files() {
        let is_code = path.extension().is_some_and(|end| end == "rs");
        let is_page = path.extension().is_some_and(|end| end == "md");
        if !(is_code || is_page) || path.starts_with(tree::root().join("tests")) {
            continue;
        }
        let text = tree::text_of(&path).expect("code and pages are text");
        let text = if is_code { comments(&text) } else { text };
        for key in cited_keys(&text) {
            if !known.iter().any(|known| known == key) {
                unknown.insert(format!("{key} in {}", tree::shown(&path)));
            }
        }
    }
    assert!(
        unknown.is_empty(),
        "not in REFERENCES.bib: {}",
        Vec::from_iter(unknown).join(", ")
    );
}

#[test]
fn the_bibliography_has_no_key_twice_and_is_in_order() {
    let keys = known_keys();
    assert!(!keys.is_empty(), "the bibliography is empty");
    for pair in keys.windows(2) {
        assert!(pair[0] < pair[1], "{} must not follow {}", pair[1], pair[0]);
    }
}
