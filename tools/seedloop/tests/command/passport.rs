//! `passport --check` on stored results of other codes: the right answer, one broken convention, and each fault of a file.

use crate::{assert_code, assert_error, json, seedloop, text};
use dev_support::fixture_files::fixture;
use std::fs;
use std::process::Output;
use tempfile::{TempDir, tempdir};

/// A stored text of the trial of the self-test.
fn stored(name: &str) -> String {
    fs::read_to_string(fixture(&format!("passport/stored/{name}"))).unwrap()
}

/// A folder with the passport of rolling beads, and results.
fn folder(results: &str) -> TempDir {
    folder_of("rolling", results)
}

/// A folder with a stored passport, and results.
fn folder_of(passport: &str, results: &str) -> TempDir {
    let folder = tempdir().unwrap();
    let passport = stored(&format!("{passport}.json"));
    fs::write(folder.path().join("passport.json"), passport).unwrap();
    fs::write(folder.path().join("RESULTS.csv"), results).unwrap();
    folder
}

fn check(folder: &TempDir, words: &[&str]) -> Output {
    let all = [&["passport", "--check", "RESULTS.csv"], words].concat();
    seedloop(folder.path(), &all)
}

/// LAMMPS after conversion agrees with what its source says beforehand, and not without.
#[test]
fn a_code_agrees_with_what_its_source_says_beforehand() {
    let folder = folder(&stored("lammps-rolling.csv"));
    let agrees = check(&folder, &["--code", "lammps"]);
    assert_code(&agrees, 0);
    let said = text(&agrees.stdout);
    for part in [
        "reads the parameters as they are meant",
        "limit-moves-spring (`gran_sub_mod_tangential.cpp`",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let alone = check(&folder, &["--json"]);
    assert_code(&alone, 1);
    let alone = json(&alone);
    assert_eq!(alone["differences"][0]["convention"], "limit-moves-spring");
}

/// A clump that drops and one that rolls: each code agrees after conversion.
#[test]
fn clumps_of_other_codes_agree_after_conversion() {
    for code in ["lammps", "liggghts", "yade"] {
        let folder = folder_of("clumps", &stored(&format!("{code}-clumps.csv")));
        assert_code(&check(&folder, &["--code", code]), 0);
    }
}

/// Friction of grains at the wall, 0.3 instead of 0.4: the factor, what the code then takes, and the value to put in.
#[test]
fn a_broken_convention_is_named_with_the_value_to_put_in() {
    let folder = folder(&stored("lammps-rolling-friction-wall.csv"));
    let named = check(&folder, &["--code", "lammps"]);
    assert_code(&named, 1);
    let said = text(&named.stdout);
    for part in [
        "This convention differs:",
        "- friction-wall:",
        "takes the friction of two grains",
        "put in static friction 0.53",
    ] {
        assert!(said.contains(part), "'{part}' is not in: {said}");
    }
}

/// Faults of a table of results name file, line, value and remedy, before anything is computed.
#[test]
fn faults_of_results_name_file_line_value_and_remedy() {
    let good = stored("lammps-rolling.csv");
    let lines: Vec<&str> = good.lines().collect();
    // The third line with something else in it.
    let with = |line: &str| {
        let mut lines = lines.clone();
        lines[2] = line;
        lines.join("\n")
    };
    let without_last = lines[..lines.len() - 1].join("\n");
    let cut = &good[..good.rfind("mean_y").unwrap() + 4];
    let line_of_cut = format!("line {}", lines.len());
    let cases = [
        (
            with("head-on,velocity_x_at_t2,mm/s,1"),
            vec!["line 3", "'mm/s'", "convert it to m/s"],
        ),
        (
            with("head-on,velocity_x_at_t2,m/s,NaN"),
            vec!["line 3", "'NaN'", "finite number"],
        ),
        (
            with("head-on,velocity_x_at_t2,m/s,1e999"),
            vec!["line 3", "'1e999'", "finite number"],
        ),
        (
            with("head-on,velocity_x_at_t2,m/s,"),
            vec!["line 3", "no value", "run the case"],
        ),
        (
            with("heads-on,velocity_x_at_t2,m/s,1"),
            vec!["line 3", "'heads-on'", "expected one of head-on"],
        ),
        (
            with("head-on,speed,m/s,1"),
            vec!["line 3", "'speed'", "expected one of velocity_x_at_t1"],
        ),
        (
            with(lines[1]),
            vec!["line 3", "in line 2 already", "delete one"],
        ),
        (without_last, vec!["heap mean_y_at_t1", "add them"]),
        (
            cut.to_owned(),
            vec![&line_of_cut, "cells", "case,quantity,unit,value"],
        ),
        (
            lines[1..].join("\n"),
            vec!["line 1", "the header is", "case,quantity,unit,value"],
        ),
        (String::new(), vec!["line 1", "the header is ''"]),
    ];
    for (results, says) in cases {
        let refused = check(&folder(&results), &[]);
        assert_error(&refused, &[&["RESULTS.csv"], &says[..]].concat());
    }
}

/// An unknown code or convention, and a passport that is absent, cut off or impossible, are refused with the remedy.
#[test]
fn faults_around_the_results_name_the_remedy() {
    let good = folder(&stored("lammps-rolling.csv"));
    assert_error(
        &check(&good, &["--code", "lamps"]),
        &["'lamps'", "lammps, liggghts, mercurydpm, yade", "--accept"],
    );
    assert_error(
        &check(&good, &["--accept", "rolling"]),
        &["'rolling'", "limit-of-spring"],
    );
    let file = good.path().join("passport.json");
    let whole = fs::read_to_string(&file).unwrap();
    for (text, says) in [
        (whole[..whole.len() / 2].to_owned(), "line"),
        (
            whole.replacen("\"radius_m\": ", "\"radius_m\": -", 1),
            "radius_m is -",
        ),
        (
            whole.replacen("\"band\": ", "\"band\": -", 1),
            "a band above 0",
        ),
    ] {
        fs::write(&file, text).unwrap();
        assert_error(
            &check(&good, &[]),
            &[
                "passport.json",
                says,
                "write it again with `seedloop passport`",
            ],
        );
    }
    fs::remove_file(&file).unwrap();
    assert_error(
        &check(&good, &[]),
        &["passport.json", "put the results beside it"],
    );
}
