//! Answers beyond a fit: intervals of runs, scatter of factors, branches, batches, named levels.

use crate::{assert_code, assert_error, fixture, json, seedloop, text};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Writes the analysis of table 5 into a folder.
fn analyse_table_5(folder: &Path) {
    let data = fixture("paper/bbd_table5.csv");
    let words = [
        "analyse",
        data.to_str().unwrap(),
        "--factors",
        "B=0.30:0.42,E=0.01:0.18,F=0.00:0.10",
        "--response",
        "theta_deg",
        "--sd",
        "theta_sd_deg",
        "--n",
        "n_rep",
        "--json",
        "a.json",
    ];
    assert_code(&seedloop(folder, &words), 0);
}

/// A tolerance interval of single runs is wider than the prediction interval of a mean of five; the
/// bounds that redrawn experiments end on are reported as a share; the printed optimum is not 38.87.
#[test]
fn the_answer_to_a_target_has_intervals_scatter_and_redrawn_experiments() {
    let folder = tempdir().unwrap();
    analyse_table_5(folder.path());
    let output = seedloop(
        folder.path(),
        &[
            "optimise",
            "a.json",
            "--target",
            "38.87",
            "--at",
            "B=0.33,E=0.06,F=0.10",
            "--near",
            "B=0.32,E=0.06,F=0.10",
            "--factor-sd",
            "B=0.01,F=0.005",
            "--bootstrap",
            "200",
            "--json=-",
        ],
    );
    assert_code(&output, 0);
    let got = json(&output);
    let number = |pointer: &str| {
        got.pointer(pointer)
            .and_then(serde_json::Value::as_f64)
            .unwrap()
    };
    assert!((number("/at/mean") - 39.07).abs() < 0.005);
    assert!(number("/tolerance/interval/0") < number("/at/pi95/0"));
    assert!(number("/tolerance/interval/1") > number("/at/pi95/1"));
    assert!(number("/propagation/total_sd") > number("/propagation/transmitted_sd"));
    let robust = number("/most_robust/transmitted_sd");
    assert!(robust <= number("/propagation_nearest/coded/transmitted_sd"));
    assert!(number("/bootstrap/0/factors/F/at_high") > 0.3);
    assert_eq!(got.pointer("/seed").unwrap(), 1);
    assert_eq!(got.pointer("/region/open/F/1").unwrap(), true);
}

/// A parabola meets a target on two sides; both are reported.
#[test]
fn two_branches_are_an_answer() {
    let folder = tempdir().unwrap();
    let table = "A,y\n-1,1.1\n-1,0.9\n-0.5,0.26\n0,0.01\n0,-0.01\n0.5,0.24\n1,1.02\n1,0.98\n";
    fs::write(folder.path().join("t.csv"), table).unwrap();
    let words = [
        "analyse",
        "t.csv",
        "--factors",
        "A",
        "--response",
        "y",
        "--json",
        "t.json",
    ];
    assert_code(&seedloop(folder.path(), &words), 0);
    let output = seedloop(folder.path(), &["optimise", "t.json", "--target", "0.5"]);
    assert_code(&output, 0);
    assert!(
        text(&output.stdout).contains("2 branches"),
        "{}",
        text(&output.stdout)
    );
}

/// Batches with names, and the pastes of a batch differ less than the batches.
#[test]
fn batches_drawn_at_random_have_their_own_variance() {
    let folder = tempdir().unwrap();
    let data = fixture("r/gasoline.csv");
    let words = [
        "analyse",
        data.to_str().unwrap(),
        "--factors",
        "endpoint,vapor",
        "--response",
        "y",
        "--model",
        "linear",
        "--batch",
        "batch",
        "--json=-",
    ];
    let output = seedloop(folder.path(), &words);
    assert_code(&output, 0);
    let got = json(&output);
    assert_eq!(got.pointer("/random_batches/blocks").unwrap(), 10);
    let few = got
        .pointer("/random_batches/terms/vapor/df")
        .unwrap()
        .as_f64()
        .unwrap();
    assert!(few < 10.0, "vapor varies between ten batches only: {few}");
}

/// A design over a wall of two materials, filled with a response that depends on the wall, gives back
/// the effect of the wall, and a level must be chosen to look for a solution.
#[test]
fn named_levels_go_from_the_design_to_the_solution() {
    let folder = tempdir().unwrap();
    let factors = "symbol,name,unit,low,high\nB,friction,1,0.3,0.4\nF,rolling,1,0,0.1\n";
    fs::write(folder.path().join("f.csv"), factors).unwrap();
    let run = |words: &str| seedloop(folder.path(), &words.split(' ').collect::<Vec<_>>());
    let design =
        "design ccd --factors f.csv --centre 3 --category wall=steel:glass --seed 4 --out d.csv";
    assert_code(&run(design), 0);
    let table = fs::read_to_string(folder.path().join("d.csv")).unwrap();
    let mut filled = Vec::new();
    for (i, line) in table.lines().enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        let wall = fields[fields.len() - 1];
        let y = if i == 0 {
            "y".to_owned()
        } else {
            let b: f64 = fields[4].parse().unwrap();
            let shift = if wall == "steel" { 2.0 } else { -2.0 };
            (30.0 + b + shift + 0.01 * (i % 3) as f64).to_string()
        };
        filled.push(format!("{line},{y}"));
    }
    assert_eq!(filled.len(), 1 + 2 * 11);
    fs::write(folder.path().join("d.csv"), filled.join("\n")).unwrap();
    let analyse =
        "analyse d.csv --factors f.csv --response y --model linear --categories wall --json a.json";
    assert_code(&run(analyse), 0);
    assert_error(
        &run("optimise a.json --target 32"),
        &["--level wall=", "glass, steel"],
    );
    assert_error(
        &run("optimise a.json --target 32 --level wall=wood"),
        &["wood", "glass, steel"],
    );
    assert_code(&run("optimise a.json --target 32.5 --level wall=steel"), 0);
    assert_code(&run("optimise a.json --target 32.5 --level wall=glass"), 1);
}

/// The coded columns of a Latin hypercube do not reach -1 and +1: the natural ones beside them tell what they are. The
/// response is 30 + 100 B, so that the slopes are 5 per coded and 100 per natural unit.
#[test]
fn the_columns_of_a_design_are_coded_though_they_miss_the_ends() {
    let folder = tempdir().unwrap();
    let factors = "symbol,name,unit,low,high\nB,friction,1,0.3,0.4\nF,rolling,1,0,0.1\n";
    fs::write(folder.path().join("f.csv"), factors).unwrap();
    let run = |words: &str| seedloop(folder.path(), &words.split(' ').collect::<Vec<_>>());
    assert_code(
        &run("design lhs --factors f.csv --runs 12 --seed 4 --out d.csv"),
        0,
    );
    let table = fs::read_to_string(folder.path().join("d.csv")).unwrap();
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let (coded, natural) = (at("B"), at("B_natural"));
    let mut filled = vec![format!("{},y", header.join(","))];
    // Without the natural columns, nothing shows that these are coded: they lie far outside 0.3 to 0.4.
    let mut alone = vec!["B,y".to_owned()];
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let b: f64 = fields[natural].parse().unwrap();
        filled.push(format!("{line},{}", 30.0 + 100.0 * b));
        alone.push(format!("{},{}", fields[coded], 30.0 + 100.0 * b));
    }
    fs::write(folder.path().join("filled.csv"), filled.join("\n")).unwrap();
    fs::write(folder.path().join("alone.csv"), alone.join("\n")).unwrap();
    let output = run("analyse filled.csv --factors f.csv --response y --model linear --json=-");
    assert_code(&output, 0);
    let fit = json(&output);
    let slopes = [
        (&fit["terms"]["B"]["coef"], 5.0),
        (&fit["coef_natural_units"]["B"], 100.0),
    ];
    // The files hold all digits of a value.
    for (found, slope) in slopes {
        let found = found.as_f64().unwrap();
        assert!((found - slope).abs() < 1e-9 * slope, "{found}, not {slope}");
    }
    let analyse = "analyse alone.csv --factors B=0.3:0.4 --response y --model linear";
    assert_error(&run(analyse), &["alone.csv", "'B'", "--coded", "--natural"]);
    assert_code(&run(&format!("{analyse} --coded")), 0);
}

/// Sizes in metres beside a range in millimetres lie all at one place of it; what fits would be a slope per nothing. In
/// millimetres, and as told, they are taken.
#[test]
fn values_in_another_unit_than_their_range_are_refused() {
    let folder = tempdir().unwrap();
    let table = |scale: f64| {
        let rows = [5.0, 20.0, 35.0, 50.0, 27.5].map(|d| format!("{},{}\n", d * scale, 30.0 + d));
        format!("D,y\n{}", rows.concat())
    };
    fs::write(folder.path().join("mm.csv"), table(1.0)).unwrap();
    fs::write(folder.path().join("m.csv"), table(1e-3)).unwrap();
    let analyse = |file: &str, more: &str| {
        let words = format!("analyse {file} --factors D=5:50 --response y --model linear{more}");
        seedloop(folder.path(), &words.split(' ').collect::<Vec<_>>())
    };
    assert_code(&analyse("mm.csv", ""), 0);
    let words = ["m.csv", "'D'", "0.005", "5 to 50", "unit", "--natural"];
    assert_error(&analyse("m.csv", ""), &words);
    assert_code(&analyse("m.csv", " --natural"), 0);
}

/// A path or a second stage from an analysis of coded values, asked for in natural units, would run in a
/// wrong direction: the slopes belong to other ranges.
#[test]
fn a_coded_analysis_is_not_taken_for_natural_ranges() {
    let folder = tempdir().unwrap();
    let data = fixture("paper/bbd_table5.csv");
    let words = [
        "analyse",
        data.to_str().unwrap(),
        "--factors",
        "B,E,F",
        "--response",
        "theta_deg",
        "--json",
        "coded.json",
    ];
    assert_code(&seedloop(folder.path(), &words), 0);
    let table = "symbol,name,unit,low,high\nB,b,1,0.30,0.42\nE,e,1,0.01,0.18\nF,f,1,0,0.10\n";
    fs::write(folder.path().join("f.csv"), table).unwrap();
    let words = [
        "design",
        "steepest",
        "--factors",
        "f.csv",
        "--analysis",
        "coded.json",
        "--out",
        "path.csv",
    ];
    assert_error(
        &seedloop(folder.path(), &words),
        &["coded.json", "coded values of 'B'", "--factors B=0.3:0.42"],
    );
    assert!(!folder.path().join("path.csv").exists());
}
