//! The command as a user meets it: exit codes, text, JSON, files.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "command/answers.rs"]
mod answers;
#[path = "command/apparatus.rs"]
mod apparatus;
#[path = "command/calibration.rs"]
mod calibration;
#[path = "command/comparisons.rs"]
mod comparisons;
#[path = "command/design_run.rs"]
mod design_run;
#[path = "command/designs.rs"]
mod designs;
#[path = "command/diagnosis.rs"]
mod diagnosis;
#[path = "command/edges.rs"]
mod edges;
#[path = "command/flags.rs"]
mod flags;
#[path = "command/help.rs"]
mod help;
#[path = "command/interrupted.rs"]
mod interrupted;
#[path = "command/own_program.rs"]
mod own_program;
#[path = "command/passport.rs"]
mod passport;
#[path = "command/residual.rs"]
mod residual;
#[path = "command/simulation.rs"]
mod simulation;
#[path = "command/statistics.rs"]
mod statistics;
#[path = "command/surfaces.rs"]
mod surfaces;
#[path = "command/tables.rs"]
mod tables;
#[path = "command/tiny_scene.rs"]
mod tiny_scene;
#[path = "command/wrong_scenes.rs"]
mod wrong_scenes;
#[path = "command/your_material.rs"]
mod your_material;

use dev_support::fixture_files::fixture;
use serde_json::Value;
use std::ffi::{OsStr, OsString};
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The search path for programs, with the folder of the Python interpreter first. Where `python3` is a script that chooses
/// an interpreter, the choice takes longer than a run of the example, and there are hundreds.
fn program_path() -> &'static OsStr {
    static PATH: OnceLock<OsString> = OnceLock::new();
    PATH.get_or_init(|| {
        let words = [
            "-c",
            "import os, sys; print(os.path.dirname(sys.executable))",
        ];
        let folder = Command::new("python3").args(words).output().unwrap().stdout;
        let others = std::env::var_os("PATH").unwrap_or_default();
        let first = PathBuf::from(text(&folder).trim());
        std::env::join_paths(iter::once(first).chain(std::env::split_paths(&others))).unwrap()
    })
}

/// Runs the command in a folder.
fn seedloop(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .env("PATH", program_path())
        .current_dir(folder)
        .args(words)
        .output()
        .unwrap()
}

/// Runs the command with words parted by blanks.
fn words_in(folder: &Path, words: &str) -> Output {
    seedloop(folder, &words.split(' ').collect::<Vec<_>>())
}

/// What was written, as text.
fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Asserts that the command ended with a code.
fn assert_code(output: &Output, code: i32) {
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(
        output.status.code(),
        Some(code),
        "stdout: {out}\nstderr: {err}"
    );
}

/// The JSON on standard output, which holds nothing else.
fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Asserts that the command refuses its input and says all of these.
fn assert_error(output: &Output, says: &[&str]) {
    assert_code(output, 2);
    let message = text(&output.stderr);
    for what in says {
        assert!(message.contains(what), "'{what}' is not in: {message}");
    }
    assert!(
        output.stdout.is_empty(),
        "an error puts nothing on standard output"
    );
}
