//! Runs that are told to end, folders that others use, and results that cannot be written.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, text};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Starts the command in a folder.
fn start(folder: &Path, words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(words)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Waits until something is there, a minute at most.
fn wait_for(mut is_there: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_there() {
        assert!(begin.elapsed() < Duration::from_mins(1), "it never came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a signal, and gives what came of it and how long that took.
fn end(child: Child, signal: &str) -> (Output, Duration) {
    let process = child.id().to_string();
    let begin = Instant::now();
    let sent = Command::new("kill").args([signal, &process]).status();
    assert!(sent.unwrap().success());
    (child.wait_with_output().unwrap(), begin.elapsed())
}

/// Names in a folder that end like this.
fn names(folder: &Path, ending: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(ending)).collect()
}

/// A drum, a heap and a box that would run for minutes end within two seconds, with the code that shells give such an end, one sentence,
/// and a state that the same command goes on from.
#[test]
fn a_run_ends_at_once_with_its_state_kept() {
    let heap = "kind = \"heap\"\ninner_diameter = \"70 mm\"\nheight = \"60 mm\"\nlift_speed = \"0.01 mm/s\"\n\
                floor = \"tough_resin\"\ncylinder = \"clear_resin\"\n";
    let drum = "kind = \"drum\"\ninner_diameter = \"70 mm\"\nwidth = \"14 mm\"\nspeed = \"20 rpm\"\n\
                shell = \"tough_resin\"\ncover = \"clear_resin\"\n";
    for (apparatus, signal, code) in [
        (drum, "-TERM", 143),
        (drum, "-INT", 130),
        (heap, "-TERM", 143),
    ] {
        let scene = TinyScene::changed(drum, apparatus);
        let words = [
            "simulate",
            "tiny.toml",
            "time_s=9000",
            "frames=8000",
            "--out",
            "out",
        ];
        let words = [&words[..], &["--keep-every", "0"]].concat();
        let child = start(&scene.path(""), &words);
        wait_for(|| !names(&scene.path("out"), ".state-2.json").is_empty());
        let (output, time) = end(child, signal);
        assert_code(&output, code);
        assert!(time < Duration::from_secs(2), "{time:?}");
        let log = text(&output.stderr);
        let told = log.lines().last().unwrap();
        assert!(
            told.contains("stopped by") && told.contains("--resume"),
            "{log}"
        );
        assert!(!names(&scene.path("out"), ".state.json").is_empty());
        assert!(names(&scene.path("out"), ".part").is_empty());
        let child = start(&scene.path(""), &[&words[..], &["--resume"]].concat());
        std::thread::sleep(Duration::from_millis(700));
        let (output, _) = end(child, signal);
        assert_code(&output, code);
        assert!(
            text(&output.stderr).contains("goes on from"),
            "{}",
            text(&output.stderr)
        );
    }
}

/// A program of the user that sleeps for a minute is ended with the command, and what it started with it.
#[test]
fn a_program_of_the_user_is_not_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let study = fs::read_to_string(crate::fixture("command-example/study.toml")).unwrap();
    let study = study.replace("[\"python3\", \"run.py\"]", "[\"sh\", \"run.sh\"]");
    fs::write(folder.path().join("study.toml"), study).unwrap();
    fs::create_dir(folder.path().join("mill")).unwrap();
    let script =
        "echo $$ > ../../../../process-$$\n(sleep 3; touch ../../../../lived) & sleep 60\n";
    fs::write(folder.path().join("mill/run.sh"), script).unwrap();
    let words = [
        "calibrate",
        "study.toml",
        "--out",
        "out/mill",
        "--threads",
        "1",
    ];
    let child = start(folder.path(), &words);
    let began = || {
        let entries = fs::read_dir(folder.path()).unwrap();
        let mut names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.any(|name| name.starts_with("process-"))
    };
    wait_for(began);
    let (output, time) = end(child, "-TERM");
    assert_code(&output, 143);
    assert!(time < Duration::from_secs(2), "{time:?}");
    assert!(
        text(&output.stderr)
            .contains("stopped by SIGTERM: finished runs are kept in out/mill/runs")
    );
    assert!(
        names(&folder.path().join("out/mill/work"), "").is_empty(),
        "the folder of the run stayed"
    );
    std::thread::sleep(Duration::from_millis(3300));
    assert!(
        !folder.path().join("lived").exists(),
        "a child of the program lived on"
    );
}

/// While a table is run, the same table may be run beside it, and another one in the same folder is refused in words.
#[test]
fn a_folder_in_use_is_refused_to_other_work() {
    let scene = TinyScene::new();
    let table = |name: &str, first: u32| {
        let rows: Vec<String> = (first..first + 12).map(|rpm| rpm.to_string()).collect();
        fs::write(scene.path(name), format!("rpm\n{}\n", rows.join("\n"))).unwrap();
    };
    table("speeds.csv", 20);
    table("others.csv", 50);
    let run = |table: &str| {
        let words = [
            "run",
            table,
            "--scene",
            "tiny.toml",
            "--set",
            "time_s=0.2",
            "--set",
            "frames=2",
        ];
        let words = [
            &words[..],
            &["--out", "results", "--resume", "--threads", "1"],
        ]
        .concat();
        start(&scene.path(""), &words)
    };
    let first = run("speeds.csv");
    wait_for(|| !names(&scene.path("results/runs"), ".json").is_empty());
    let other = run("others.csv").wait_with_output().unwrap();
    let process = format!("in use by process {} on ", first.id());
    assert_error(&other, &["results", &process, "other input", "--out"]);
    let same = run("speeds.csv").wait_with_output().unwrap();
    assert_code(&same, 0);
    assert!(
        text(&same.stderr).contains("the runs are shared"),
        "{}",
        text(&same.stderr)
    );
    assert_code(&first.wait_with_output().unwrap(), 0);
    assert_eq!(
        names(&scene.path("results/runs"), ".json").len(),
        12,
        "each run once"
    );
    assert!(names(&scene.path("results/runs"), ".claim").is_empty());
    assert_code(&run("others.csv").wait_with_output().unwrap(), 0);
}

/// A result that cannot be written costs no run: nothing is said of one, and no folder is made.
#[test]
fn results_are_tried_before_the_run() {
    let scene = TinyScene::new();
    fs::create_dir(scene.path("folder.json")).unwrap();
    for (words, told) in [
        (
            vec!["--json", "no/where.json"],
            "the folder no does not exist",
        ),
        (
            vec!["--frame", "no/where.png"],
            "the folder no does not exist",
        ),
        (
            vec!["--json", "folder.json", "--force"],
            "folder.json: it is a folder",
        ),
        (vec!["--frame", "a.png", "--json", "a.png"], "two results"),
        (vec!["--out", "tiny.toml/out"], "tiny.toml is no folder"),
        (vec!["--json", "/dev/full", "--force"], "/dev/full"),
    ] {
        let output = scene.simulate(&words);
        assert_error(&output, &[told]);
        assert!(!text(&output.stderr).contains("running"), "{words:?} began");
    }
    let verify = ["verify", "--out", "no/table.md"];
    let output = crate::seedloop(&scene.path(""), &verify);
    assert_error(&output, &["the folder no does not exist"]);
    assert!(!text(&output.stderr).contains("checking"), "it began");
}

/// What a process that was killed has left of a file on its way goes with the next run in the folder; what somebody writes stays.
#[test]
fn leftovers_are_swept() {
    let scene = TinyScene::new();
    fs::create_dir(scene.path("out")).unwrap();
    let [dead, living] =
        [".a.json.1-0.part", ".b.json.1-0.part"].map(|name| scene.path("out").join(name));
    fs::write(&dead, "half").unwrap();
    let held = fs::File::create(&living).unwrap();
    held.lock().unwrap();
    let words = ["time_s=0.2", "frames=2", "--out", "out"];
    assert_code(&scene.simulate(&words), 0);
    assert!(!dead.exists() && living.exists());
}

/// A pipe that nobody writes to is not waited for.
#[test]
fn a_pipe_is_refused_as_input() {
    let scene = TinyScene::new();
    let made = Command::new("mkfifo").arg(scene.path("pipe")).status();
    assert!(made.unwrap().success());
    for words in [
        &["simulate", "pipe"][..],
        &["calibrate", "pipe"],
        &["diagnose", "pipe"],
        &["analyse", "pipe", "--factors", "a", "--response", "b"],
        &["run", "pipe", "--scene", "tiny.toml"],
        &["simulate", "tiny.toml", "--set-file", "pipe"],
    ] {
        assert_error(
            &crate::seedloop(&scene.path(""), words),
            &["pipe", "no plain file"],
        );
    }
}

/// A table of 0.1 million seeds with a frame kept every 20 ms of a day would take some 50 TB.
#[test]
fn a_run_that_takes_more_memory_than_there_is_is_refused() {
    let scene = TinyScene::new();
    let words = [
        "seed.0.count=100000",
        "time_s=86000",
        "--set",
        "protocol.frame_interval=0.02 s",
    ];
    let words = [&words[..], &["--set", "frames=4000000"]].concat();
    assert_error(&scene.simulate(&words), &["GiB", "fewer seeds or frames"]);
}
