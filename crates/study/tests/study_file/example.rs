//! The commented example of every key.

use super::folder::fixture;
use calibration::LoopSettings;
use std::collections::BTreeSet;
use study::Study;
use toml::{Table, Value};

/// Keys of each kind of table, as [`Study::read`] knows them.
fn expected() -> Vec<(&'static str, Vec<String>)> {
    let keys = study::keys_of_a_study();
    keys.into_iter()
        .map(|(table, keys)| (table, keys.iter().map(|k| (*k).to_owned()).collect()))
        .collect()
}

/// Adds the keys of a table, and of each table below it, under the name of its kind.
fn collect(kind: &str, table: &Table, found: &mut BTreeSet<(String, String)>) {
    for (key, value) in table {
        found.insert((kind.to_owned(), key.clone()));
        let below = match (kind, key.as_str()) {
            ("study" | "profile", _) => key.as_str(),
            ("parameter", "prior") => "prior",
            ("measured", "photo") => "photo",
            ("measured", "condition") | ("scene", "apparatus") => continue,
            ("measured", _) => "value",
            _ => continue,
        };
        let tables: Vec<&Table> = match value {
            Value::Table(table)
                if below == "profile" || (kind == "profile" && below == "scene") =>
            {
                table.values().filter_map(Value::as_table).collect()
            }
            Value::Table(table) => vec![table],
            Value::Array(list) => list.iter().filter_map(Value::as_table).collect(),
            _ => Vec::new(),
        };
        let below = if kind == "profile" && below == "scene" {
            "profile scene"
        } else {
            below
        };
        for table in tables {
            collect(below, table, found);
        }
    }
}

#[test]
fn the_example_reads_and_shows_every_key() {
    let path = fixture("study-example/study.toml");
    Study::read(&path, None).unwrap();
    Study::read(&path, Some("quick")).unwrap();
    let table: Table = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let mut found = BTreeSet::new();
    collect("study", &table, &mut found);
    for (kind, keys) in expected() {
        for key in keys {
            let entry = (kind.to_owned(), key);
            assert!(
                found.contains(&entry),
                "{entry:?} is missing in {}",
                path.display()
            );
        }
    }
}

#[test]
fn every_key_of_the_example_has_a_comment() {
    let text = std::fs::read_to_string(fixture("study-example/study.toml")).unwrap();
    let is_key = |line: &&str| line.contains(" = ") && !line.trim_start().starts_with('#');
    for line in text.lines().filter(is_key) {
        assert!(line.contains('#'), "no comment: {line}");
    }
}

/// A setting that the loop gets later must be a key of `[design]`, or stand in the list of those that come from
/// elsewhere.
#[test]
fn every_setting_of_the_loop_can_be_stated() {
    let settings = LoopSettings {
        most_runs: Some(1),
        ..LoopSettings::default()
    };
    let all = Table::try_from(&settings).unwrap();
    let expected = expected();
    let design = &expected
        .iter()
        .find(|(kind, _)| *kind == "design")
        .unwrap()
        .1;
    for key in all.keys() {
        let elsewhere = ["seed", "most_runs"].contains(&key.as_str());
        assert!(elsewhere != design.contains(key), "{key}");
    }
}
