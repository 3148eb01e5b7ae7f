//! The guide's chapter "Your material": each of its commands, in its order and unchanged, on a small drum.

use crate::{fixture, text};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::tempdir;

/// The guide.
const GUIDE: &str = include_str!("../../../../docs/guide.md");

/// Replaces the drum of the example: small enough for a test, and the loop about it no larger than
/// it must be.
const SMALLER: [(&str, &str); 4] = [
    ("inner_diameter = \"200 mm\"", "inner_diameter = \"60 mm\""),
    ("width = \"30 mm\"", "width = \"10 mm\""),
    ("sphere = \"6 mm\"", "sphere = \"4 mm\""),
    ("shear_modulus = \"5 MPa\"", "shear_modulus = \"1 MPa\""),
];
/// Likewise for the trial of the study, whose drum is larger than that.
const SMALLER_TRIAL: [(&str, &str); 2] = [
    ("inner_diameter = 84 mm", "inner_diameter = 60 mm"),
    ("width = 20 mm", "width = 10 mm"),
];
/// Likewise for the study.
const SHORTER: &str = "[design]\nbefore_runs = 0\nconfirmation_runs = 2\ncheck_runs = 2\nmost_boxes = 1\n\
                       most_confirmations = 1\njoint = false\n";

/// Blocks of code of the chapter: language and text, in their order.
fn blocks() -> Vec<(&'static str, &'static str)> {
    let (_, chapter) = GUIDE.split_once("\n## Your material\n").unwrap();
    let (chapter, _) = chapter.split_once("\n## ").unwrap();
    let fenced = chapter.split("```").skip(1).step_by(2);
    fenced
        .map(|block| block.split_once('\n').unwrap())
        .collect()
}

/// The command that belongs to a name of the guide: built with this package, or beside it.
fn program(name: &str) -> PathBuf {
    let seedloop = PathBuf::from(env!("CARGO_BIN_EXE_seedloop"));
    if name == "seedloop" {
        return seedloop;
    }
    let beside = seedloop.with_file_name(name);
    if !beside.exists() {
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "--locked", "--package", name]);
        if !cfg!(debug_assertions) {
            build.arg("--release");
        }
        assert!(build.status().unwrap().success(), "{name} cannot be built");
    }
    beside
}

/// Runs a line of the guide in a folder.
fn run(folder: &Path, line: &str) -> Output {
    let mut words = line.split_whitespace();
    let command = program(words.next().unwrap());
    let run = Command::new(command)
        .current_dir(folder)
        .args(words)
        .output();
    run.unwrap()
}

/// Puts two photographs where the guide has the reader's own.
fn take_photos(folder: &Path) {
    for (speed, photo) in [
        ("15rpm", "granudrum_mccA_15rpm_avg.bmp"),
        ("30rpm", "granudrum_mccA_45rpm_avg.bmp"),
    ] {
        let there = folder.join("photos").join(speed);
        fs::create_dir_all(&there).unwrap();
        fs::copy(fixture("photos").join(photo), there.join(photo)).unwrap();
    }
}

/// Makes the drum that was begun a small one.
fn shrink(folder: &Path) {
    let file = folder.join("drum.toml");
    let mut scene = smaller(&fs::read_to_string(&file).unwrap(), &SMALLER);
    scene.push_str("\n[protocol]\nframes = 3\nsettle_limit = \"0.2 s\"\n[camera]\npixels = 240\n");
    fs::write(file, scene).unwrap();
}

/// A text with these pieces replaced, each of which must be in it.
fn smaller(text: &str, pieces: &[(&str, &str)]) -> String {
    pieces.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no '{from}' in {text}");
        text.replace(from, to)
    })
}

/// Replaces the measured tables of the study by those of the guide.
fn fill_in(folder: &Path, tables: &str) {
    let file = folder.join("study.toml");
    let study = fs::read_to_string(&file).unwrap();
    let (head, _) = study.split_once("[[measured]]").unwrap();
    let tables = smaller(tables, &SMALLER_TRIAL);
    fs::write(file, format!("{head}{SHORTER}\n{tables}")).unwrap();
}

/// Photos at two speeds leave a parameter open, which is an answer (exit code 0 or 1); all else must end with 0. What the
/// last commands read was written by those before.
#[test]
fn each_command_of_the_chapter_runs() {
    let begin = tempdir().unwrap();
    let mut folder = begin.path().to_path_buf();
    let mut n_run = 0;
    let mut filled_in = false;
    for (language, block) in blocks() {
        if language == "toml" && !filled_in {
            take_photos(&folder);
            fill_in(&folder, block);
            filled_in = true;
        }
        for line in block.lines().filter(|_| language == "sh") {
            if let Some(path) = line.strip_prefix("cargo install --locked --path ") {
                let package = fixture("..").join(path).join("Cargo.toml");
                assert!(
                    package.exists(),
                    "{line}: there is no {}",
                    package.display()
                );
                continue;
            }
            if let Some(into) = line.strip_prefix("cd ") {
                folder.push(into);
                shrink(&folder);
                continue;
            }
            if line.starts_with("angle-from-image") {
                take_photos(&folder);
            }
            let output = run(&folder, line);
            let code = output.status.code();
            // One photo a speed is one fitted value for two parameters, which the plan says too.
            let answers = line.starts_with("seedloop calibrate");
            // The trial has its own folder only by its own name: what it wrote is in the way of the run itself.
            assert!(
                code == Some(0) || (answers && code == Some(1)),
                "{line}: {code:?}\n{}\n{}",
                text(&output.stdout),
                text(&output.stderr)
            );
            n_run += 1;
        }
    }
    assert!(n_run >= 9 && filled_in, "{n_run} commands were run");
    for written in ["drum.png", "overlay.png", "out/my-drum/report.html", "deck"] {
        assert!(folder.join(written).exists(), "no {written}");
    }
}
