//! `seedloop calibrate`: from a file of measurements to parameters.

use crate::{assert_code, assert_error, json, seedloop, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::{TempDir, tempdir};

/// A ball on a plate.
const BALL: &str = include_str!("ball.toml");

/// A study of it; TILT and CHECK stand for measured means.
const STUDY: &str = include_str!("bench_study.toml");

/// What a tilted plate shows of a ball with a rolling friction of 0.1: it starts to roll at that tangent.
const TANGENT_OF_THE_TILT: f64 = 0.1;

/// The study with a mean that the check measured.
fn study(check: f64) -> String {
    STUDY
        .replace("TILT", &TANGENT_OF_THE_TILT.to_string())
        .replace("CHECK", &check.to_string())
}

/// A folder with the scene and a study.
fn folder(study: &str) -> TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("ball.toml"), BALL).unwrap();
    fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

/// Runs `seedloop calibrate study.toml` with further words in the folder.
fn calibrate(folder: &Path, words: &[&str]) -> Output {
    seedloop(folder, &[&["calibrate", "study.toml"], words].concat())
}

/// The value of a parameter of a result.
fn value(result: &Value, symbol: &str) -> f64 {
    let all = result["parameters"].as_array().unwrap();
    let found = all.iter().find(|p| p["symbol"] == symbol);
    found.unwrap()["value"].as_f64().unwrap()
}

#[test]
fn the_studies_to_start_from_say_what_would_be_run() {
    let benches = [
        "hopper",
        "draw-down",
        "poured-heap",
        "ledge",
        "bulk-density",
        "compression",
        "direct-shear",
        "penetration",
    ];
    for kind in ["drum", "heap", "box"].into_iter().chain(benches) {
        let folder = tempdir().unwrap();
        assert_code(&seedloop(folder.path(), &["init", kind]), 0);
        let plan = calibrate(folder.path(), &["--plan"]);
        assert_code(&plan, 0);
        for stage in [
            "screening",
            "surfaces and estimate",
            "confirmation by fresh runs",
            "check",
            "diagnosis of the residual",
        ] {
            let said = text(&plan.stdout);
            assert!(said.contains(stage), "{kind}: no '{stage}' in {said}");
        }
        assert!(!folder.path().join("out").exists(), "{kind}: it was run");
        // Somebody's own files stay as they are.
        assert_error(&seedloop(folder.path(), &["init", kind]), &["exists"]);
    }
}

/// One angle fixes no two frictions: the plan says so, and what the benches that are offered would cost: four of them, each at 4 runs at the
/// estimate and 4 about it.
#[test]
fn the_study_of_benches_plans_what_to_measure_next() {
    let folder = tempdir().unwrap();
    assert_code(&seedloop(folder.path(), &["init", "benches"]), 0);
    let plan = calibrate(folder.path(), &["--plan", "--json=-"]);
    assert_code(&plan, 1);
    let plan = json(&plan);
    let stages = plan["stages"].as_array().unwrap();
    let next = stages.last().unwrap();
    assert_eq!(next["stage"], "what to measure next", "{plan}");
    assert_eq!(next["runs"], 0);
    assert_eq!(next["at_most_further"], 5 * 10, "{plan}");
    assert!(next["further_core_s"].as_f64().unwrap() > 0.0, "{plan}");
}

/// A sled on a smooth plate shows the friction of its spheres to 1 %, which is what it still swings. The rolling friction
/// follows within a tenth: the closed form leaves out that the rolling torque builds up first. What was found shows the
/// measured tangent to 1 % in a test of its own: that is the curvature which a parabola leaves.
#[test]
fn bench_tests_give_back_the_frictions_behind_them() {
    let folder = folder(&study(0.35));
    let here = folder.path();
    let first = calibrate(here, &["--json=-"]);
    assert_code(&first, 0);
    let first = json(&first);
    for key in [
        "parameters",
        "correlation",
        "fit",
        "check",
        "boxes",
        "diagnosis",
        "compare",
        "cost",
    ] {
        assert!(!first[key].is_null(), "no {key} in the result");
    }
    assert!((value(&first, "S") / 0.35 - 1.0).abs() < 0.01, "{first}");
    assert!((value(&first, "R") / 0.1 - 1.0).abs() < 0.1, "{first}");
    assert_eq!(first["check"][0]["holds"], true);
    assert_eq!(
        first["compare"][0]["found"].as_f64().unwrap(),
        value(&first, "S")
    );
    let folder_of = here.join("out/bench");
    let written =
        campaign::run_store::unseal(&fs::read(folder_of.join("result.json")).unwrap()).unwrap();
    assert_eq!(written, first);
    let report = fs::read_to_string(folder_of.join("report.html")).unwrap();
    assert!(report.ends_with("</html>\n"));
    assert!(
        !report.contains("http-equiv=\"refresh\""),
        "the page of the run"
    );

    let words = "bench-test tilt --scene ball.toml --plate steel --repeats 2 --json=- --set-file out/bench/parameters.toml";
    let tilted = seedloop(here, &words.split(' ').collect::<Vec<_>>());
    assert_code(&tilted, 0);
    let shown = json(&tilted);
    assert_eq!(shown["put_in"].as_f64().unwrap(), value(&first, "R"));
    let shown = shown["mean"].as_f64().unwrap();
    assert!((shown / TANGENT_OF_THE_TILT - 1.0).abs() < 0.01, "{shown}");

    goes_on(here, &first);
    fails(here);
}

/// The same command refuses the folder and says how to continue; then nothing is run again, and nothing changes.
fn goes_on(here: &Path, first: &Value) {
    assert_error(&calibrate(here, &[]), &["out/bench", "--resume"]);
    let again = calibrate(here, &["--resume", "--json=-"]);
    assert_code(&again, 0);
    let again = json(&again);
    assert!(first["cost"]["runs"].as_u64().unwrap() > 0);
    assert_eq!(again["cost"]["runs"], 0);
    assert_eq!(again["parameters"], first["parameters"]);
}

/// Had the heavier sled shown 0.25, the parameters would not hold for it: 0.1 are seven standard errors of 0.02 / 2 and
/// the estimate's own.
fn fails(here: &Path) {
    fs::write(here.join("study.toml"), study(0.25)).unwrap();
    let output = calibrate(here, &["--resume"]);
    assert_code(&output, 1);
    let said = text(&output.stdout);
    let missed = "shown_static_friction of sled at seed.0.density = 2500 kg/m3";
    assert!(said.contains(missed), "{said}");
    // What is passed on alone says so too.
    let file = fs::read_to_string(here.join("out/bench/parameters.toml")).unwrap();
    let verdict = file.lines().nth(1).unwrap();
    assert!(file.starts_with("met = false\n"), "{file}");
    assert!(
        verdict.starts_with("verdict = ") && verdict.contains(missed),
        "{file}"
    );
}

/// Five slips, told together with their lines, before any run.
#[test]
fn everything_that_is_wrong_with_a_study_is_told_at_once() {
    let mut wrong = study(0.35);
    for (from, to) in [
        ("high = 0.5", "high = 0.2"),
        ("role = \"fit\"", "role = \"fitt\""),
        ("sd = 0.01", "sd = 0.0"),
        ("before_runs = 1", "before_runs = -1"),
        ("search = []", "search = [\"colour\"]"),
    ] {
        assert!(wrong.contains(from), "{from}");
        wrong = wrong.replacen(from, to, 1);
    }
    let folder = folder(&wrong);
    let line = |text: &str| {
        let at = wrong.find(text).unwrap();
        format!("line {}", 1 + wrong[..at].matches('\n').count())
    };
    let output = calibrate(folder.path(), &[]);
    assert_error(
        &output,
        &[
            "5 things are wrong",
            &format!("{}: [[parameter]] S: low = 0.25", line("low = 0.25")),
            &format!("{}: [[measured]] sled: role = \"fitt\"", line("\"fitt\"")),
            &format!(
                "{}: [[measured]] tilt: shown_rolling_friction.sd = 0",
                line("sd = 0.0,")
            ),
            &format!("{}: [design]: before_runs = -1", line("before_runs")),
            &format!("{}: [effects]: search", line("search")),
        ],
    );
    assert!(!folder.path().join("out").exists(), "something was run");
}
