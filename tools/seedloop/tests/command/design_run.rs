//! `seedloop run`: from a design to its analysis.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, json, seedloop, text, words_in};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

/// A ball on a plate; a tilt of it takes a tenth of a second.
const BALL: &str = include_str!("ball.toml");

/// Ranges of two settings of the scene.
const FACTORS: &str =
    "symbol,name,unit,low,high\nR,rolling friction,1,0.02,0.1\nB,friction,1,0.2,0.4\n";

/// What the factors stand for.
const BINDS: [&str; 4] = [
    "--bind",
    "R=contact.pea-steel.rolling_friction",
    "--bind",
    "B=contact.pea-steel.static_friction",
];

/// A folder with the scene, the factors and a design of them.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let tilt = BALL.replace("\"slider\"", "\"tilt\"");
    fs::write(folder.path().join("ball.toml"), tilt).unwrap();
    fs::write(folder.path().join("factors.csv"), FACTORS).unwrap();
    let words = "design ccd --factors factors.csv --centre 1 --seed 2 --out design.csv";
    assert_code(&words_in(folder.path(), words), 0);
    folder
}

/// Runs the design with further words.
fn run(folder: &Path, words: &[&str]) -> Output {
    let run = ["run", "design.csv", "--scene", "ball.toml"];
    seedloop(folder, &[&run[..], &BINDS, words].concat())
}

/// A design in a workbook is run as that of its CSV, and its results are a workbook as well; an invalid cell is
/// reported with its name.
#[test]
fn a_design_in_a_workbook_is_run() {
    let folder = folder();
    let here = folder.path();
    let design = fs::read_to_string(here.join("design.csv")).unwrap();
    let short: Vec<&str> = design.lines().take(3).collect();
    let workbook = |name: &str, csv: &str| {
        let file = here.join(name);
        fs::write(
            &file,
            command_line::table_file::bytes_for(&file, csv).unwrap(),
        )
        .unwrap();
    };
    workbook("short.xlsx", &short.join("\n"));
    let words = [
        "run",
        "short.xlsx#Sheet1",
        "--scene",
        "ball.toml",
        "--out",
        "short",
    ];
    assert_code(&seedloop(here, &[&words[..], &BINDS].concat()), 0);
    let [csv, xlsx] = ["csv", "xlsx"].map(|end| {
        command_line::table_file::read(&here.join(format!("short/results.{end}"))).unwrap()
    });
    assert_eq!((csv.header(), csv.rows().len()), (xlsx.header(), 2));
    for (row, expected) in xlsx.rows().iter().zip(csv.rows()) {
        for column in 0..csv.header().len() {
            assert_eq!(
                row.text(column),
                expected.text(column),
                "{}",
                csv.header()[column]
            );
        }
    }
    let natural = short[2].rsplit_once(',').unwrap().0;
    workbook(
        "wrong.xlsx",
        &format!("{}\n{}\n{natural},steep\n", short[0], short[1]),
    );
    let words = ["run", "wrong.xlsx", "--scene", "ball.toml", "--plan"];
    let says = ["wrong.xlsx", "line 3", "cell H3", "B_natural", "'steep'"];
    assert_error(&seedloop(here, &[&words[..], &BINDS].concat()), &says);
}

/// Names of the records, and when each was written.
fn records(folder: &Path) -> Vec<(String, SystemTime)> {
    let entries = fs::read_dir(folder.join("results/runs")).unwrap();
    let mut all: Vec<_> = entries
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().extension().is_some_and(|end| end == "json"))
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, entry.metadata().unwrap().modified().unwrap())
        })
        .collect();
    all.sort();
    all
}

/// Design, runs and analysis in three commands. A sphere begins to roll where the tangent of the slope reaches its
/// rolling friction: the shown one is a line over it, up to the lag of its creep (a share of 1e-5 of
/// the variance in runs of this scene; 1 % is let pass).
#[test]
fn a_design_is_run_and_analysed_without_a_script() {
    let folder = folder();
    let here = folder.path();
    let plan = run(here, &["--plan", "--json=-", "--out", "results"]);
    assert_code(&plan, 0);
    let plan = json(&plan);
    assert_eq!((&plan["runs"], &plan["kept"]), (&9.into(), &0.into()));
    assert_eq!(
        plan["inputs"].as_object().map(serde_json::Map::len),
        Some(2)
    );
    assert!(!here.join("results").exists(), "a plan leaves nothing");

    let done = run(here, &["--out", "results", "--json", "run.json"]);
    assert_code(&done, 0);
    assert!(text(&done.stdout).contains("9 runs, 0 without a result"));
    assert!(text(&done.stderr).contains("9/9 runs"));
    let report: Value = serde_json::from_slice(&fs::read(here.join("run.json")).unwrap()).unwrap();
    assert_eq!(
        (&report["n_runs"], &report["n_failed"]),
        (&9.into(), &0.into())
    );
    let design = fs::read_to_string(here.join("design.csv")).unwrap();
    let results = fs::read_to_string(here.join("results/results.csv")).unwrap();
    let page = fs::read_to_string(here.join("results/report.html")).unwrap();
    assert!(page.contains("Finished"));
    for (i, (row, result)) in design.lines().zip(results.lines()).enumerate() {
        assert!(result.starts_with(row), "line {}: {result}", i + 1);
    }
    for (i, run) in report["runs"].as_array().unwrap().iter().enumerate() {
        assert_eq!(run["seed"], 1 + i, "fresh seeds, row by row");
        let shown = &run["observables"]["shown_rolling_friction"]["mean"];
        let line = results.lines().nth(1 + i).unwrap();
        assert!(
            line.contains(&format!(",{shown},")),
            "{shown} is not in {line}"
        );
    }

    let words = "analyse results/results.csv --factors factors.csv --response shown_rolling_friction --model linear \
                 --json=-";
    let analysis = words_in(here, words);
    assert_code(&analysis, 0);
    let analysis = json(&analysis);
    assert_eq!(analysis["columns_hold"], "coded");
    let r2 = analysis["r2"].as_f64().unwrap();
    assert!(r2 > 0.99, "{r2}");

    assert_error(&run(here, &["--out", "results"]), &["results", "--resume"]);
    let before = records(here);
    assert_eq!(before.len(), 9);
    fs::remove_file(here.join("results/results.csv")).unwrap();
    let again = run(here, &["--out", "results", "--resume"]);
    assert_code(&again, 0);
    assert!(text(&again.stderr).contains("9 reused"));
    assert_eq!(records(here), before, "no record is written again");
    let renewed = fs::read_to_string(here.join("results/results.csv")).unwrap();
    assert_eq!(renewed, results);
}

/// A wrong column and a wrong cell are reported together, and nothing is run.
#[test]
fn a_wrong_table_is_refused_before_any_run() {
    let folder = folder();
    let here = folder.path();
    let table = "contact.pea-steel.static_friction,roling_friction\n0.3,0.1\n-0.3,0.1\n";
    fs::write(here.join("wrong.csv"), table).unwrap();
    let words = "run wrong.csv --scene ball.toml --out results";
    assert_error(
        &words_in(here, words),
        &[
            "wrong.csv, line 1",
            "'roling_friction'",
            "contact.pea-steel.rolling_friction",
            "wrong.csv, line 3",
            "'-0.3'",
        ],
    );
    assert!(!here.join("results").exists());
}

/// Two seeds in a drum show no surface: that run has no result, and the other row has its own. The
/// reason is in the table and on standard error, and the exit code is 1.
#[test]
fn a_run_that_fails_is_told_and_the_others_are_kept() {
    let scene = TinyScene::new();
    let table = "seed.0.count,seed.1.count\n34,6\n1,1\n";
    fs::write(scene.path("few.csv"), table).unwrap();
    let words =
        "run few.csv --scene tiny.toml --set time_s=0.2 --set frames=2 --out results --json=-";
    let output = words_in(&scene.path(""), words);
    assert_code(&output, 1);
    assert!(text(&output.stderr).contains("line 3, seed 2"));
    let report = json(&output);
    assert_eq!(
        (&report["n_runs"], &report["n_failed"]),
        (&2.into(), &0.into())
    );
    assert_eq!(report["n_refused"], 1);
    // What the places of the seeds tell is there.
    let second = &report["runs"][1]["observables"];
    assert!(second["angle_deg"].is_null() && second["centre_of_mass_deg"]["mean"].is_f64());
    let angle = report["runs"][0]["observables"]["angle_deg"]["mean"].to_string();
    let results = fs::read_to_string(scene.path("results/results.csv")).unwrap();
    let lines: Vec<&str> = results.lines().collect();
    assert!(lines[2].contains("shows a measurable surface"), "{results}");
    assert!(lines[1].contains(&angle), "{results}");
    assert!(lines[1].contains("not steady,false,"), "{results}");
}

/// Ctrl-C keeps what is finished, leaves no table, and the same command continues from there.
#[cfg(unix)]
#[test]
fn a_stopped_table_goes_on() {
    let scene = TinyScene::new();
    let rows: Vec<String> = (20..32).map(|rpm| rpm.to_string()).collect();
    fs::write(
        scene.path("speeds.csv"),
        format!("rpm\n{}\n", rows.join("\n")),
    )
    .unwrap();
    let words = "run speeds.csv --scene tiny.toml --set time_s=0.2 --set frames=2 --out results --threads 1";
    let mut child = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(words.split(' '))
        .current_dir(scene.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let runs = scene.path("results/runs");
    let is_record = |path: &Path| path.extension().is_some_and(|end| end == "json");
    let kept = || {
        let entries = fs::read_dir(&runs).into_iter().flatten();
        entries
            .filter(|entry| is_record(&entry.as_ref().unwrap().path()))
            .count()
    };
    while kept() == 0 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let pid = child.id().to_string();
    let interrupt = Command::new("kill").args(["-INT", &pid]).status().unwrap();
    assert!(interrupt.success());
    let output = child.wait_with_output().unwrap();
    assert_code(&output, 130);
    assert!(text(&output.stderr).contains("--resume"));
    let finished = kept();
    assert!((1..12).contains(&finished), "{finished} of 12");
    assert!(!scene.path("results/results.csv").exists());
    let output = words_in(&scene.path(""), &format!("{words} --resume"));
    let log = text(&output.stderr);
    assert!(
        log.contains(&format!("({finished} reused, 0 running)")),
        "{log}"
    );
    let results = fs::read_to_string(scene.path("results/results.csv")).unwrap();
    assert_eq!(results.lines().count(), 13);
}
