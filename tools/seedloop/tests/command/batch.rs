//! The loop with its runs as jobs of a batch system: a shell that starts them in the background stands for one.

use super::{assert_code, fixture, seedloop, text};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The settings of a batch system that is this machine.
pub(crate) const RUNNER: &str = r#"
[runner]
seconds_per_cost = 0.0025
task_seconds = 1
least_task_seconds = 0.5
poll_s = 0.05
poll_most_s = 0.2
state_interval_s = 0.1
heartbeat_s = 1
[runner.command]
submit = "sh {script} > {log} 2>&1 & echo $!"
"#;

/// The worked example of a program of the user, with a batch system.
fn study(folder: &Path) {
    let source = fixture("command-example");
    fs::create_dir(folder.join("mill")).unwrap();
    fs::copy(source.join("mill/run.py"), folder.join("mill/run.py")).unwrap();
    let study = fs::read_to_string(source.join("study.toml")).unwrap();
    fs::write(folder.join("study.toml"), format!("{study}{RUNNER}")).unwrap();
}

/// A result without what depends on the clock.
fn result(folder: &Path, out: &str) -> Value {
    let bytes = fs::read(folder.join(out).join("result.json")).unwrap();
    let mut result = campaign::run_store::unseal(&bytes).unwrap();
    result.as_object_mut().unwrap().remove("cost");
    result
}

/// Jobs give what threads give, to the last bit; the same command again finds all runs and submits nothing.
#[test]
fn a_calibration_by_jobs_is_the_same_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let local = ["calibrate", "study.toml", "--out", "local", "--quiet"];
    assert_code(&seedloop(folder.path(), &local), 0);
    let jobs = [
        "calibrate",
        "study.toml",
        "--out",
        "jobs",
        "--runner",
        "command",
    ];
    let output = seedloop(folder.path(), &jobs);
    assert_code(&output, 0);
    assert_eq!(
        result(folder.path(), "jobs"),
        result(folder.path(), "local")
    );
    let tasks = || {
        let entries = fs::read_dir(folder.path().join("jobs/batch/tasks")).unwrap();
        let paths = entries.map(|e| e.unwrap().path());
        paths
            .filter(|path| path.extension().is_some_and(|end| end == "sh"))
            .count()
    };
    let before = tasks();
    let again = [&jobs[..], &["--resume"]].concat();
    assert_code(&seedloop(folder.path(), &again), 0);
    assert_eq!(tasks(), before, "nothing is submitted again");
}

/// What is invalid in [runner] is told before anything is run.
#[test]
fn settings_of_jobs_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let path = folder.path().join("study.toml");
    let right = fs::read_to_string(&path).unwrap();
    for (from, to, word) in [
        ("poll_s = 0.05", "pole_s = 0.05", "pole_s"),
        ("task_seconds = 1", "task_seconds = -1", "task_seconds"),
        ("{script} >", ">", "{script}"),
    ] {
        fs::write(&path, right.replacen(from, to, 1)).unwrap();
        let output = seedloop(
            folder.path(),
            &["calibrate", "study.toml", "--runner", "command"],
        );
        assert_code(&output, 2);
        let told = text(&output.stderr);
        assert!(told.contains(word) && told.contains("[runner]"), "{told}");
    }
    fs::write(&path, right.split("[runner.command]").next().unwrap()).unwrap();
    let output = seedloop(
        folder.path(),
        &["calibrate", "study.toml", "--runner", "command"],
    );
    assert_code(&output, 2);
    assert!(
        text(&output.stderr).contains("command"),
        "{}",
        text(&output.stderr)
    );
}

/// A design table by jobs gives the table of results that threads give.
#[test]
fn a_design_table_by_jobs_gives_the_same_table() {
    let folder = tempfile::tempdir().unwrap();
    let ball =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/ball.toml"));
    fs::write(folder.path().join("ball.toml"), ball.unwrap()).unwrap();
    let table = "run,contact.pea-steel.restitution\n1,0.4\n2,0.6\n3,0.8\n";
    fs::write(folder.path().join("few.csv"), table).unwrap();
    fs::write(folder.path().join("jobs.toml"), RUNNER).unwrap();
    let words = ["run", "few.csv", "--scene", "ball.toml"];
    let local = [&words[..], &["--out", "local"]].concat();
    assert_code(&seedloop(folder.path(), &local), 0);
    let jobs = [
        "--out",
        "jobs",
        "--runner",
        "command",
        "--runner-settings",
        "jobs.toml",
    ];
    let jobs = [&words[..], &jobs].concat();
    assert_code(&seedloop(folder.path(), &jobs), 0);
    let results =
        |out: &str| fs::read_to_string(folder.path().join(out).join("results.csv")).unwrap();
    assert_eq!(results("jobs"), results("local"));
    assert!(folder.path().join("jobs/batch/job.json").exists());
}
