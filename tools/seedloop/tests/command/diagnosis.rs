//! `seedloop diagnose STUDY.toml`: own simulations.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, fixture, json, seedloop, text};
use std::fs;
use std::process::{Command, Output, Stdio};

/// Two speeds for the fit and one for the check in the tiny drum, one friction, two effects.
const STUDY: &str = r#"
name = "tiny"

[[scene]]
name = "drum"
file = "tiny.toml"
changes = ["seed.0.count = 60", "protocol.frames = 4", "protocol.start_slope = 0 deg", "camera.pixels = 240"]

[[parameter]]
symbol = "F"
sets = ["contact.seed-seed.static_friction"]
low = 0.02
high = 0.18
limits = [0.0, 0.8]
prior = { mean = 0.1, sd = 0.02 }

[[measured]]
scene = "drum"
condition = { rpm = 20 }
role = "fit"
angle_deg = { mean = 39.0, sd = 3.0, n = 2 }
curvature = { mean = -0.1, sd = 0.1, n = 2 }

[[measured]]
scene = "drum"
condition = { rpm = 30 }
role = "fit"
angle_deg = { mean = 39.0, sd = 3.0, n = 2 }

[[measured]]
scene = "drum"
condition = { rpm = 25 }
role = "check"
angle_deg = { mean = 39.0, sd = 3.0, n = 2 }

[design]
diagnosis_replicates = 2

[budget]
runs = 220

[effects]
search = ["camera-roll", "cohesion"]
"#;

/// A tiny scene with a study beside it, one piece of whose text is replaced.
fn study(from: &str, to: &str) -> TinyScene {
    let scene = TinyScene::new();
    assert!(STUDY.contains(from), "'{from}' is not in the study");
    fs::write(scene.path("tiny-study.toml"), STUDY.replacen(from, to, 1)).unwrap();
    scene
}

/// Runs `seedloop diagnose tiny-study.toml` with further words beside the scene.
fn diagnose(scene: &TinyScene, words: &[&str]) -> Output {
    let words = [&["diagnose", "tiny-study.toml"], words].concat();
    seedloop(scene.path("").as_path(), &words)
}

/// The example of the guide: three conditions for the fit, two for the check, three values each. By hand: 2 runs at each of
/// (1 start + 2 parameters + 4 effects + 65 rounds) x 3 and 3 x 4 x 2 conditions are 480.
#[test]
fn the_example_says_what_would_be_run_and_runs_nothing() {
    let example = fixture("cotton/blind.toml");
    let folder = tempfile::tempdir().unwrap();
    let words = ["diagnose", example.to_str().unwrap(), "--plan"];
    let output = seedloop(folder.path(), &words);
    assert_code(&output, 0);
    let said = text(&output.stdout);
    // Certain are the start and six steps, the first fit, and its end at the kept ones: 2 (8 x 3 + 2).
    assert!(said.contains(": 52 to 480 runs"), "{said}");
    assert!(said.contains("of one core"), "{said}");
    assert_eq!(said.matches("\n  fit ").count(), 9, "{said}");
    assert_eq!(said.matches("\n  check ").count(), 6, "{said}");
    assert!(!folder.path().join("out").exists());
}

/// Ctrl-C while runs are left: the running one is broken off, finished records are kept, and the command says where they
/// are. The same command continues with them to the end; once more it reuses all of them and gives the same study, bit for
/// bit.
#[cfg(unix)]
#[test]
fn an_interrupted_diagnosis_keeps_its_runs_and_goes_on_to_its_end() {
    use std::io::{BufRead as _, BufReader};
    let scene = study("", "");
    let mut child = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(["diagnose", "tiny-study.toml", "--threads", "1"])
        .current_dir(scene.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut next = || lines.next().map(|line| line.unwrap());
    while next().is_some_and(|line| !line.contains("1/16 runs of this list")) {}
    let interrupt = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    let mut told = String::new();
    while let Some(line) = next() {
        told = line;
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let out = scene.path("out/tiny-diagnosis");
    let kept = fs::read_dir(out.join("runs")).unwrap().count();
    assert!((1..16).contains(&kept), "{kept}");
    let said = "stopped by Ctrl-C: finished runs are kept in out/tiny-diagnosis/runs";
    assert!(told.starts_with(said), "{told}");

    assert_error(&diagnose(&scene, &[]), &["tiny-diagnosis", "--resume"]);
    let first = diagnose(&scene, &["--resume", "--json=-"]);
    assert_code(&first, 0);
    reused(&first, kept);
    let first = json(&first);
    assert!(first["verdict"].is_string());
    assert!(first["candidates"]["camera-roll"]["testable"].is_boolean());
    for name in ["result.json", "report.html", "problem.json"] {
        assert!(out.join(name).exists(), "{name}");
    }

    let again = diagnose(&scene, &["--resume", "--json=-"]);
    assert_code(&again, 0);
    reused(&again, 16);
    assert_eq!(
        json(&again)["result"]["diagnosis"],
        first["result"]["diagnosis"]
    );
}

/// Fails unless this many of the first 16 runs were found.
fn reused(output: &Output, number: usize) {
    let log = text(&output.stderr);
    let said = format!("16/16 runs of this list ({number} reused");
    assert!(log.contains(&said), "{log}");
}

#[test]
fn what_cannot_be_meant_is_refused_with_its_place() {
    let wrong = [
        (
            "replicates = 2",
            "replicates = 1",
            "line 37: [design]: diagnosis_replicates = 1",
        ),
        ("rpm = 25", "rpm = 30", "another role in line 28"),
        ("rpm = 25", "rpn = 25", "no setting 'rpn'"),
        (
            "\"cohesion\"",
            "\"cohesiveness\"",
            "no effect 'cohesiveness'",
        ),
        (
            "seed-seed",
            "seed-sede",
            "\"contact.seed-sede.static_friction\"",
        ),
        (
            "n = 2 }\ncurvature",
            "n = 0 }\ncurvature",
            "angle_deg.n = 0: must be",
        ),
        ("low = 0.02", "low = 0.9", "must be finite and rise"),
        ("high = 0.18", "high = inf", "must be finite and rise"),
        // By hand: 2 runs at each of (1 start + 1 parameter + 2 effects + 45 rounds) x 2 and 3 x 3 x 1 conditions are 214.
        ("runs = 220", "runs = 213", "214"),
    ];
    for (from, to, said) in wrong {
        let scene = study(from, to);
        assert_error(&diagnose(&scene, &[]), &["tiny-study.toml", said]);
        assert!(!scene.path("out").exists(), "{to}: something was written");
    }
}

/// One value and one parameter: what can always be met tests nothing, and no run is made for it.
#[test]
fn as_many_parameters_as_values_leave_no_diagnosis() {
    let curvature = "curvature = { mean = -0.1, sd = 0.1, n = 2 }\n";
    let scene = study(curvature, "");
    let text_of = fs::read_to_string(scene.path("tiny-study.toml")).unwrap();
    let one = text_of.replacen(
        "rpm = 30 }\nrole = \"fit\"",
        "rpm = 30 }\nrole = \"show\"",
        1,
    );
    assert_ne!(one, text_of);
    fs::write(scene.path("tiny-study.toml"), one).unwrap();
    let output = diagnose(&scene, &[]);
    assert_code(&output, 1);
    let said = text(&output.stdout);
    assert!(said.contains("no diagnosis: 1 measurement"), "{said}");
    let runs = fs::read_dir(scene.path("out/tiny-diagnosis/runs")).unwrap();
    assert_eq!(runs.count(), 0);
}
