//! The arrows between crates agree with the table in ARCHITECTURE.md.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::tree;

/// A crate as its manifest or as the table describes it.
#[derive(Debug, PartialEq, Eq)]
struct Node {
    /// Its purpose, without a full stop.
    duty: String,
    /// The crates of the workspace that it depends on, in alphabetical order.
    dependencies: Vec<String>,
}

/// The crates of the workspace by name.
type Map = BTreeMap<String, Node>;

/// Reads the crates under `crates/` and `tools/` from their manifests.
fn from_manifests() -> Map {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--format-version",
            "1",
            "--offline",
        ])
        .current_dir(tree::root())
        .output()
        .expect("cargo runs, for it runs this test");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo metadata failed: {errors}");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo writes JSON");
    let packages = metadata["packages"].as_array().expect("a list");
    packages
        .iter()
        .filter(|package| package["name"] != "workspace-tests")
        .map(|package| (text(&package["name"]), node(package)))
        .collect()
}

/// Reads one crate from the metadata; dependencies of tests only do not count.
fn node(package: &Value) -> Node {
    let mut dependencies: Vec<String> = package["dependencies"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|dependency| dependency["path"].is_string() && dependency["kind"] != "dev")
        .map(|dependency| text(&dependency["name"]))
        .collect();
    dependencies.sort();
    dependencies.dedup();
    Node {
        duty: text(&package["description"])
            .trim_end_matches('.')
            .to_owned(),
        dependencies,
    }
}

/// Returns the text of a JSON string, and nothing for anything else.
fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// Returns the cells of a row of the table, if the line is one.
fn cells(line: &str) -> Option<[&str; 4]> {
    let inner = line.strip_prefix('|')?.strip_suffix('|')?;
    let cells: Vec<&str> = inner.split('|').map(str::trim).collect();
    let cells: [&str; 4] = cells.try_into().ok()?;
    cells[0].parse::<usize>().ok().map(|_| cells)
}

/// Reads the table: the crates, and the level of each.
fn from_table() -> (Map, BTreeMap<String, usize>) {
    let page = fs::read_to_string(tree::root().join("ARCHITECTURE.md")).expect("the map exists");
    let (mut map, mut levels) = (Map::new(), BTreeMap::new());
    for [level, name, duty, dependencies] in page.lines().filter_map(cells) {
        let name = name.trim_matches('`').to_owned();
        let node = Node {
            duty: duty.to_owned(),
            dependencies: dependencies
                .split(", ")
                .filter(|name| *name != "-")
                .map(str::to_owned)
                .collect(),
        };
        levels.insert(name.clone(), level.parse().expect("checked by `cells`"));
        let twice = map.insert(name.clone(), node);
        assert!(twice.is_none(), "{name} has two rows");
    }
    (map, levels)
}

/// Returns one more than the highest level that a crate points to, and 0 without arrows.
fn level(name: &str, map: &Map) -> usize {
    map[name]
        .dependencies
        .iter()
        .map(|below| level(below, map) + 1)
        .max()
        .unwrap_or(0)
}

/// Writes the table that the manifests ask for, sorted by level and name.
fn table(map: &Map) -> String {
    let mut rows: Vec<(usize, String)> = map
        .iter()
        .map(|(name, node)| {
            let level = level(name, map);
            let dependencies = match node.dependencies.join(", ") {
                none if none.is_empty() => "-".to_owned(),
                some => some,
            };
            let row = format!("| {level} | `{name}` | {} | {dependencies} |", node.duty);
            (level, row)
        })
        .collect();
    rows.sort();
    let rows: Vec<String> = rows.into_iter().map(|(_, row)| row).collect();
    rows.join("\n")
}

#[test]
fn table_of_crates_agrees_with_the_manifests_both_ways() {
    let manifests = from_manifests();
    let (page, _) = from_table();
    assert!(
        manifests == page,
        "ARCHITECTURE.md must hold these rows:\n{}",
        table(&manifests)
    );
}

#[test]
fn levels_in_the_table_are_one_above_the_highest_arrow() {
    let (page, levels) = from_table();
    for (name, node) in &page {
        for below in &node.dependencies {
            assert!(
                levels.get(below).is_some_and(|below| *below < levels[name]),
                "the arrow from {name} to {below} does not point down"
            );
        }
        assert_eq!(levels[name], level(name, &page), "level of {name}");
    }
}

/// ARCHITECTURE.md gives the reasons for these gaps under "Why these crates are separate".
#[test]
fn crates_that_must_not_know_each_other_do_not() {
    let map = from_manifests();
    for (from, to) in [
        ("frame-render", "photo-profile"),
        ("frame-render", "surface-profile"),
        ("photo-profile", "frame-render"),
        ("inference", "dem-solver"),
        ("campaign", "dem-solver"),
        ("response-surface", "dem-solver"),
        ("campaign", "response-surface"),
    ] {
        assert!(!reaches(from, to, &map), "{from} reaches {to}");
    }
}

/// Returns whether a path of arrows leads from one crate to another.
fn reaches(from: &str, to: &str, map: &Map) -> bool {
    map[from]
        .dependencies
        .iter()
        .any(|below| below == to || reaches(below, to, map))
}
