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

/// The coded value and the natural one beside it, of which one was edited: neither is passed over in silence.
#[test]
fn values_that_contradict_each_other_are_refused() {
    let folder = tempdir().unwrap();
    let table = "run,B,B_natural,angle\n1,-1,0.30,30\n2,0,0.36,31\n3,1,0.40,32\n4,0,0.36,31.2\n";
    fs::write(folder.path().join("data.csv"), table).unwrap();
    let words = "analyse data.csv --response angle --model linear --factors";
    let words: Vec<&str> = words.split(' ').collect();
    let analyse = |factors: &str| seedloop(folder.path(), &[&words[..], &[factors]].concat());
    assert_error(&analyse("B=0.30:0.42"), &["line 4", "'B'", "0.4", "0.42"]);
    assert_error(&analyse("B=30:42"), &["line 2", "'B'", "30", "0.3"]);
    let sound = table.replace("0.40", "0.42");
    fs::write(folder.path().join("data.csv"), sound).unwrap();
    assert_code(&analyse("B=0.30:0.42"), 0);
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

/// Factors A to E on 0 to 1, in a folder.
fn five_factors() -> TempDir {
    let folder = tempdir().unwrap();
    let rows = ["A", "B", "C", "D", "E"]
        .map(|s| format!("{s},0,1\n"))
        .concat();
    fs::write(
        folder.path().join("f.csv"),
        format!("symbol,low,high\n{rows}"),
    )
    .unwrap();
    folder
}

/// The 2^(5-2) with D = AB, E = AC is the textbook fraction of resolution III; blocks by ABC and CDE
/// of the full factorial confound ABDE as well.
#[test]
fn generators_and_blocks_tell_what_they_cost() {
    let folder = five_factors();
    let words = [
        "design",
        "fraction",
        "--factors",
        "f.csv",
        "--generators",
        "D=AB,E=AC",
    ];
    let output = seedloop(
        folder.path(),
        &[&words[..], &["--out", "fr.csv", "--json=-"]].concat(),
    );
    assert_code(&output, 0);
    let report = json(&output);
    assert_eq!(report["facts"]["resolution"], 3);
    assert_eq!(
        report["facts"]["alias_sets"][0],
        serde_json::json!(["A", "B:D", "C:E"])
    );
    assert_eq!(report["evaluation"]["greatest_correlation"], 0.0);
    let words = [
        "design",
        "full",
        "--factors",
        "f.csv",
        "--blocks",
        "ABC,CDE",
    ];
    let output = seedloop(
        folder.path(),
        &[&words[..], &["--out", "fu.csv", "--json=-"]].concat(),
    );
    assert_code(&output, 0);
    let confounded = &json(&output)["facts"]["confounded_with_blocks"];
    assert_eq!(
        confounded,
        &serde_json::json!(["A:B:C", "C:D:E", "A:B:D:E"])
    );
    let bad = seedloop(
        folder.path(),
        &[
            "design",
            "bbd",
            "--factors",
            "f.csv",
            "--generators",
            "D=AB",
            "--out",
            "x.csv",
        ],
    );
    assert_error(&bad, &["--generators is for fraction"]);
}

/// The second stage adds its runs as block 2, all where the surface of the first stage cannot be
/// told from the target; bounds are kept exactly, and confirmation runs far off refute (exit 1).
#[test]
fn second_stage_bounds_and_confirmation_work_together() {
    let folder = analysed();
    let factors = "symbol,low,high\nB,0.30,0.42\nE,0.01,0.18\nF,0.00,0.10\n";
    fs::write(folder.path().join("f.csv"), factors).unwrap();
    let first = ["design", "bbd", "--factors", "f.csv", "--out", "one.csv"];
    assert_code(&seedloop(folder.path(), &first), 0);
    let second = [
        "design",
        "d-optimal",
        "--factors",
        "f.csv",
        "--augment",
        "one.csv",
        "--runs",
        "6",
        "--analysis",
        "analysis.json",
        "--target",
        "38.87",
        "--out",
        "two.csv",
        "--json=-",
    ];
    let output = seedloop(folder.path(), &second);
    assert_code(&output, 0);
    let runs = json(&output)["runs"].as_array().unwrap().clone();
    assert_eq!(runs.len(), 17 + 6);
    assert!(runs[17..].iter().all(|run| run["block"] == 2));
    let optimise = |more: &[&str]| {
        let words = ["optimise", "analysis.json", "--json=-"];
        seedloop(folder.path(), &[&words[..], more].concat())
    };
    let narrow = optimise(&["--target", "38.87", "--bounds", "F=0.02:0.08"]);
    assert_code(&narrow, 0);
    let f = json(&narrow)["factor_ranges"]["F"]["natural"][1]
        .as_f64()
        .unwrap();
    assert_eq!(f, 0.08);
    let at = [
        "--target",
        "38.87",
        "--at",
        "B=0.33,E=0.06,F=0.10",
        "--confirm",
    ];
    assert_code(&optimise(&[&at[..], &["38.9,39.4"]].concat()), 0);
    let far = optimise(&[&at[..], &["33,34"]].concat());
    assert_code(&far, 1);
    assert_eq!(json(&far)["confirmation"]["confirmed"], false);
    let best = optimise(&["--goal", "max"]);
    assert_code(&best, 0);
    let point = json(&best)["compromises"][0]["natural"].clone();
    assert_eq!(point, serde_json::json!([0.42, 0.01, 0.1]));
    assert_code(&optimise(&["--goal", "range:50:60"]), 1);
}

/// Charts are written as SVG, and the table of orders names what the design cannot hold.
#[test]
fn analyse_draws_its_charts_and_compares_orders() {
    let folder = tempdir().unwrap();
    let data = fixture("paper/bbd_table5.csv");
    let words = [
        "analyse",
        data.to_str().unwrap(),
        "--factors",
        FACTORS,
        "--response",
        "theta",
        "--reduce",
        "p",
        "--plots",
        "plots",
        "--json=-",
    ];
    let output = seedloop(folder.path(), &words);
    assert_code(&output, 0);
    let report = json(&output);
    assert_eq!(
        report["orders"]["orders"][4]["aliased"]
            .as_array()
            .map(Vec::len),
        Some(7)
    );
    let kept = report["formula"]["formula"].as_str().unwrap();
    assert_eq!(kept, "1 + B + E + F + B:F + B^2");
    for chart in [
        "pareto",
        "half-normal",
        "normal",
        "contour-B-F",
        "surface-B-F",
        "interaction-B-F",
    ] {
        let text = fs::read_to_string(folder.path().join(format!("plots/{chart}.svg"))).unwrap();
        assert!(text.starts_with("<svg"), "{chart}");
    }
}

/// Bad tables: the message names the place and its fault.
#[test]
fn tables_that_cannot_be_meant_are_refused_with_the_place() {
    let folder = tempdir().unwrap();
    let cases = [
        ("A,B,y\n1,2,3\n2,,4\n", "A,B", &["line 3", "'B'"][..]),
        ("A,B,y\n1,2,3\n2,x,4\n", "A,B", &["line 3", "'x'"]),
        ("A,B,y\n1,2,3\n2,2,4\n", "A,B", &["'B' never varies"]),
        ("A,A,y\n1,2,3\n2,3,4\n", "A", &["2 columns are named 'A'"]),
        (
            "A,B,y\n1,2,3\n2,3,3\n",
            "A,B",
            &["response 'y' never varies"],
        ),
        (
            "A,y\n1,2\n2,3\n",
            "A,y",
            &["'y'", "factor and as the response"],
        ),
        ("A,y\n1,3\n2,4\n", "A", &["2 observations", "3 terms"]),
        (
            "A,B,y\n1,2,3\n2,4,4\n3,6,6\n4,8,7\n5,10,7\n6,12,1\n7,14,3\n",
            "A,B",
            &["B = A"],
        ),
    ];
    for (text, factors, parts) in cases {
        fs::write(folder.path().join("t.csv"), text).unwrap();
        let output = seedloop(
            folder.path(),
            &["analyse", "t.csv", "--factors", factors, "--response", "y"],
        );
        assert_error(&output, parts);
    }
}
