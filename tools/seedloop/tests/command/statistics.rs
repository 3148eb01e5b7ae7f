//! `seedloop design`, `analyse` and `optimise` on the published tables.

use crate::{assert_code, assert_error, fixture, json, seedloop, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// Factors of the published Box-Behnken design, with their ranges.
const FACTORS: &str = "B=0.30:0.42,E=0.01:0.18,F=0.00:0.10";

/// A folder with the analysis of table 5 in it.
fn analysed() -> TempDir {
    let folder = tempdir().unwrap();
    let data = fixture("paper/bbd_table5.csv");
    let output = seedloop(
        folder.path(),
        &[
            "analyse",
            data.to_str().unwrap(),
            "--factors",
            FACTORS,
            "--response",
            "theta",
            "--model",
            "quadratic",
            "--json",
            "analysis.json",
        ],
    );
    assert_code(&output, 0);
    assert!(
        text(&output.stdout).contains("0.9919"),
        "{}",
        text(&output.stdout)
    );
    folder
}

/// The analysis in the folder.
fn analysis(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("analysis.json")).unwrap()).unwrap()
}

/// R2 as recomputed in exact arithmetic; the fit agrees to the accuracy of its own arithmetic.
#[test]
fn the_analysis_of_table_5_has_the_recomputed_r2() {
    let folder = analysed();
    let r2 = analysis(folder.path())["r2"].as_f64().unwrap();
    let text = fs::read_to_string(fixture("paper/recomputed.json")).unwrap();
    let recomputed: Value = serde_json::from_str(&text).unwrap();
    let expected = recomputed["bbd_quadratic"]["r2"].as_f64().unwrap();
    assert!((r2 / expected - 1.0).abs() < 1e-9, "{r2} is not {expected}");
    assert!((r2 - 0.9919).abs() < 5e-5, "as printed, to its last digit");
}

#[test]
fn a_column_that_is_missing_is_named() {
    let data = fixture("paper/bbd_table5.csv");
    let output = seedloop(
        Path::new("."),
        &[
            "analyse",
            data.to_str().unwrap(),
            "--factors",
            "B,E,Z",
            "--response",
            "theta",
        ],
    );
    assert_error(&output, &["bbd_table5.csv", "Z"]);
}

#[test]
fn a_target_on_the_surface_has_solutions_and_one_outside_its_reach_is_a_refusal() {
    let folder = analysed();
    let optimise = |target: &str| {
        seedloop(
            folder.path(),
            &["optimise", "analysis.json", "--target", target, "--json=-"],
        )
    };
    // The published target lies within the measured angles, 60 deg lies above all of them.
    let inside = optimise("38.87");
    assert_code(&inside, 0);
    assert_eq!(json(&inside)["exists"], true);
    let outside = optimise("60");
    assert_code(&outside, 1);
    assert_eq!(json(&outside)["exists"], false);
}

/// 12 edge mid-points of a cube and 5 centre runs make 17 runs.
#[test]
fn a_design_is_written_and_not_overwritten_without_force() {
    let folder = tempdir().unwrap();
    let table = "symbol,name,unit,low,high\nB,friction,1,0.30,0.42\nE,restitution,1,0.01,0.18\n\
                 F,rolling,1,0.0,0.1\n";
    fs::write(folder.path().join("factors.csv"), table).unwrap();
    let words = [
        "design",
        "bbd",
        "--factors",
        "factors.csv",
        "--out",
        "bbd.csv",
    ];
    assert_code(&seedloop(folder.path(), &words), 0);
    let design = fs::read_to_string(folder.path().join("bbd.csv")).unwrap();
    let rows = design.lines().filter(|line| !line.starts_with('#')).count();
    assert_eq!(rows, 1 + 17, "{design}");
    fs::write(folder.path().join("bbd.csv"), "kept").unwrap();
    assert_error(&seedloop(folder.path(), &words), &["bbd.csv", "--force"]);
    assert_eq!(
        fs::read_to_string(folder.path().join("bbd.csv")).unwrap(),
        "kept"
    );
    assert_code(
        &seedloop(folder.path(), &[&words[..], &["--force"]].concat()),
        0,
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("bbd.csv")).unwrap(),
        design
    );
}
