//! Runs that are asked to end, folders that others use, and results that cannot be written.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, text};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Starts the command in a folder, with SIGHUP as a terminal has it: a test may itself run under `nohup`.
fn start(folder: &Path, words: &[&str]) -> Child {
    Command::new("env")
        .args(["--default-signal=HUP", env!("CARGO_BIN_EXE_seedloop")])
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

/// Sends a signal, and returns the outcome and how long it took.
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
/// and a state that the same command continues from.
#[test]
fn a_run_ends_at_once_with_its_state_kept() {
    let heap = "kind = \"heap\"\ninner_diameter = \"70 mm\"\nheight = \"60 mm\"\nlift_speed = \"0.01 mm/s\"\n\
                floor = \"tough_resin\"\ncylinder = \"clear_resin\"\n";
    let drum = "kind = \"drum\"\ninner_diameter = \"70 mm\"\nwidth = \"14 mm\"\nspeed = \"20 rpm\"\n\
                shell = \"tough_resin\"\ncover = \"clear_resin\"\n";
    for (apparatus, signal, code) in [
        (drum, "-TERM", 143),
        (drum, "-INT", 130),
        (heap, "-HUP", 129),
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
            text(&output.stderr).contains("continues from"),
            "{}",
            text(&output.stderr)
        );
    }
}

/// A program of the user that sleeps for a minute ends with the command, and what it started with it: at SIGTERM, when the terminal is
/// closed, and after `kill -9`, which the command itself cannot answer. The child would write its file after 5 s: a loaded machine may take more than one to end it.
#[test]
fn a_program_of_the_user_is_not_left_behind() {
    let ends = [("-TERM", Some(143)), ("-HUP", Some(129)), ("-KILL", None)];
    std::thread::scope(|scope| {
        let tests = ends.map(|(signal, code)| scope.spawn(move || leaves_nothing(signal, code)));
        for test in tests {
            test.join().unwrap();
        }
    });
}

/// Ends a calibration by a signal, and looks for what its program left running.
fn leaves_nothing(signal: &str, code: Option<i32>) {
    let folder = tempfile::tempdir().unwrap();
    let script = "(sleep 5; touch ../../../../lived) &\ntouch ../../../../began\nsleep 60\n";
    write_mill(folder.path(), script);
    let words = [
        "calibrate",
        "study.toml",
        "--out",
        "out/mill",
        "--threads=1",
    ];
    let child = start(folder.path(), &words);
    wait_for(|| folder.path().join("began").exists());
    let (output, time) = end(child, signal);
    std::thread::sleep(Duration::from_millis(5300));
    assert!(
        !folder.path().join("lived").exists(),
        "{signal}: a child of the program lived on"
    );
    // A killed process leaves the page, which a browser keeps loading.
    let page = fs::read_to_string(folder.path().join("out/mill/report.html")).unwrap();
    assert_eq!(page.contains("http-equiv=\"refresh\""), code.is_none());
    assert_eq!(page.contains("Ended early"), code.is_some());
    let Some(code) = code else { return };
    assert_code(&output, code);
    assert!(time < Duration::from_secs(2), "{time:?}");
    let told = text(&output.stderr);
    assert!(
        told.contains(&format!("stopped by SIG{}", &signal[1..])) && told.contains("out/mill/runs"),
        "{told}"
    );
    assert!(
        names(&folder.path().join("out/mill/work"), "").is_empty(),
        "the folder of the run stayed"
    );
}

/// A study of a closed form: 20 degrees, 30 for a friction of 1 and 0.13 for each turn a minute, with noise by the seed.
const MILL: &str = r#"
name = "mill"
[simulator]
kind = "command"
command = ["sh", "run.sh"]
template = "mill"
version = "1"
[[scene]]
name = "drum"
observables = ["angle_deg"]
[[parameter]]
symbol = "mu"
low = 0.1
high = 0.6
limits = [0.0, 2.0]
[[measured]]
scene = "drum"
condition = { rpm = 15 }
role = "fit"
angle_deg = { mean = 31.0, sd = 0.8, n = 10 }
[[measured]]
scene = "drum"
condition = { rpm = 30 }
role = "check"
angle_deg = { mean = 33.0, sd = 0.8, n = 10 }
[design]
before_runs = 0
"#;

/// What does its runs.
const RUN: &str = r#"awk "BEGIN { noise = (($SEEDLOOP_SEED * 7919) % 13 - 6) / 60
printf \"{\\\"angle_deg\\\": %.9f}\", 20 + 30 * $SEEDLOOP_MU + 0.13 * $SEEDLOOP_RPM + noise }" > results.json
"#;

/// Writes the study with a script that does its runs.
fn write_mill(folder: &Path, script: &str) {
    fs::write(folder.join("study.toml"), MILL).unwrap();
    fs::create_dir(folder.join("mill")).unwrap();
    fs::write(folder.join("mill/run.sh"), script).unwrap();
}

/// A result without its keys that depend on the clock, which it lists itself, and the text of its digest.
fn without_clock(file: &Path) -> serde_json::Value {
    let mut result: serde_json::Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    for pointer in result["not_in_digest"].as_array().unwrap().clone() {
        let (owner, name) = pointer.as_str().unwrap().rsplit_once('/').unwrap();
        let fields = result.pointer_mut(owner).unwrap().as_object_mut().unwrap();
        assert!(fields.remove(name).is_some(), "{pointer}");
    }
    result
}

/// A calibration that `kill -9` ends twice and that is resumed, by a path typed in another way, gives the result of one that nothing ends:
/// every key but the times, the digest included, and the same parameters to the byte.
#[test]
fn a_killed_and_resumed_calibration_has_the_same_result() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_mill(here, RUN);
    let whole = crate::seedloop(
        here,
        &["calibrate", "study.toml", "--out", "whole", "--quiet"],
    );
    assert_code(&whole, 0);
    let path = here.join("study.toml");
    let words = [
        "calibrate",
        path.to_str().unwrap(),
        "--out",
        "killed",
        "--resume",
    ];
    for runs in [3, 9] {
        let child = start(here, &words);
        wait_for(|| names(&here.join("killed/runs"), ".json").len() >= runs);
        end(child, "-KILL");
    }
    assert!(
        !here.join("killed/result.json").exists(),
        "it was over before"
    );
    assert_code(&crate::seedloop(here, &words), 0);
    let [whole, killed] = ["whole", "killed"].map(|out| here.join(out));
    let results = [&whole, &killed].map(|out| without_clock(&out.join("result.json")));
    assert_eq!(results[0]["digest"], results[1]["digest"]);
    assert!(results[0] == results[1], "equal digests of unequal results");
    let parameters = |out: &Path| fs::read(out.join("parameters.toml")).unwrap();
    assert_eq!(parameters(&whole), parameters(&killed));
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
    let long = format!("new/{}/out", "n".repeat(300));
    for (words, told) in [
        (vec!["--json", "no/where.json"], "folder no "),
        (vec!["--frame", "no/where.png"], "folder no "),
        (
            vec!["--json", "folder.json", "--force"],
            "folder.json: it is a folder",
        ),
        (vec!["--frame", "a.png", "--json", "a.png"], "two results"),
        (vec!["--out", "tiny.toml/out"], "tiny.toml is not a folder"),
        (vec!["--out", &long], "give another name"),
        (vec!["--json", "/dev/full", "--force"], "/dev/full"),
    ] {
        let output = scene.simulate(&words);
        assert_error(&output, &[told]);
        assert!(!text(&output.stderr).contains("running"), "{words:?} began");
    }
    let verify = ["verify", "--out", "no/table.md"];
    let output = crate::seedloop(&scene.path(""), &verify);
    assert_error(&output, &["folder no "]);
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
            &["pipe", "plain file"],
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
