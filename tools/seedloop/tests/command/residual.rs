//! `seedloop diagnose` on problems with a known answer.

use crate::{assert_code, assert_error, fixture, json, seedloop, text};
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::tempdir;

/// Diagnoses one of the problems.
fn diagnose(name: &str) -> Output {
    let problem = fixture(&format!("diagnosis/{name}/problem.json"));
    seedloop(
        Path::new("."),
        &["diagnose", problem.to_str().unwrap(), "--json=-"],
    )
}

/// The problem was made with this effect switched on.
#[test]
fn the_one_effect_of_a_problem_is_named() {
    let output = diagnose("single");
    assert_code(&output, 0);
    let json = json(&output);
    assert_eq!(json["verdict"], "named");
    assert_eq!(json["effects"], serde_json::json!(["E3"]));
    assert!(json["candidates"]["E3"]["z"].is_f64());
    assert!(json["structured_residual"]["p"].is_f64());
    assert_eq!(json["seed"], 1);
    assert_eq!(json["inputs"].as_object().unwrap().len(), 1);
    let problem = fixture("diagnosis/single/problem.json");
    let plain = seedloop(Path::new("."), &["diagnose", problem.to_str().unwrap()]);
    assert!(
        text(&plain.stdout).contains("named E3"),
        "{}",
        text(&plain.stdout)
    );
}

/// The problem has no more observations than parameters.
#[test]
fn a_problem_that_cannot_be_tested_ends_with_exit_1() {
    let output = diagnose("refuse");
    assert_code(&output, 1);
    assert_eq!(json(&output)["verdict"], "refused");
}

#[test]
fn noise_alone_is_a_good_answer() {
    let output = diagnose("null");
    assert_code(&output, 0);
    assert_eq!(json(&output)["verdict"], "none");
}

/// The flags of a study mean nothing for a problem, which is run by nobody.
#[test]
fn a_problem_takes_no_flags_of_studies() {
    let problem = fixture("diagnosis/single/problem.json");
    let output = seedloop(
        Path::new("."),
        &["diagnose", problem.to_str().unwrap(), "--resume"],
    );
    assert_error(&output, &["problem.json", "--resume", "for studies"]);
}

#[test]
fn a_file_that_is_no_problem_is_named_with_its_line() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("bad.json"), "{\n\"id\": 3 4\n}").unwrap();
    assert_error(
        &seedloop(folder.path(), &["diagnose", "bad.json"]),
        &["bad.json", "line 2"],
    );
}
