//! Help, version, usage.

use crate::{assert_code, assert_error, seedloop, text};
use std::path::Path;

const COMMANDS: [&str; 13] = [
    "simulate",
    "design",
    "run",
    "analyse",
    "optimise",
    "init",
    "calibrate",
    "diagnose",
    "bench-test",
    "export",
    "read-deck",
    "passport",
    "verify",
];

#[test]
fn help_names_every_command_and_each_has_its_own_help_and_version() {
    let here = Path::new(".");
    let help = seedloop(here, &["--help"]);
    assert_code(&help, 0);
    for command in COMMANDS {
        assert!(
            text(&help.stdout).contains(command),
            "{command} is not in the help"
        );
        let own = seedloop(here, &[command, "--help"]);
        assert_code(&own, 0);
        for flag in ["--json", "--quiet", "--threads", "--force"] {
            assert!(
                text(&own.stdout).contains(flag),
                "{command} --help has no {flag}"
            );
        }
        let version = seedloop(here, &[command, "--version"]);
        assert_code(&version, 0);
        assert!(text(&version.stdout).contains(env!("CARGO_PKG_VERSION")));
    }
}

/// The example in the help of every command is one that the command takes: in an empty folder its files are missing, but no
/// word of it is wrong. Those that need no file are done.
#[test]
fn every_help_has_an_example_that_is_understood() {
    for command in [&[][..]]
        .into_iter()
        .chain(COMMANDS.iter().map(std::slice::from_ref))
    {
        let folder = tempfile::tempdir().unwrap();
        let help = seedloop(folder.path(), &[command, &["--help"]].concat());
        let help = text(&help.stdout);
        let (_, example) = help
            .split_once("Example:\n  seedloop ")
            .unwrap_or_else(|| panic!("{help}"));
        let words: Vec<&str> = example.trim().split(' ').collect();
        if let Some(command) = command.first() {
            assert_eq!(words.first(), Some(command));
        }
        let output = seedloop(folder.path(), &words);
        let told = text(&output.stderr);
        assert!(!told.contains("Usage:"), "{example}: {told}");
        let is_done = ["init", "verify"].contains(&words[0]);
        assert_code(&output, if is_done { 0 } else { 2 });
    }
}

/// A shell that reads the completion knows the commands and their flags; the man page holds them and the examples.
#[test]
fn completions_and_the_man_page_know_every_command() {
    let here = Path::new(".");
    for kind in [
        "complete-bash",
        "complete-zsh",
        "complete-fish",
        "complete-powershell",
        "man",
    ] {
        let output = seedloop(here, &["--generate", kind]);
        assert_code(&output, 0);
        // Roff writes a hyphen with a backslash.
        let told = text(&output.stdout).replace('\\', "");
        for word in COMMANDS.iter().chain(&["replicates", "resume"]) {
            assert!(told.contains(word), "{kind} has no {word}");
        }
    }
    let page = seedloop(here, &["--generate", "man"]);
    let page = text(&page.stdout);
    assert!(
        page.contains(".TH seedloop 1") && !page.contains("EXTRA"),
        "{page}"
    );
    assert_eq!(page.matches("Example:").count(), COMMANDS.len() + 1);
    assert_error(
        &seedloop(here, &["--generate", "tcsh"]),
        &["tcsh", "complete-bash"],
    );
    assert_error(
        &seedloop(here, &["verify", "--generate", "man"]),
        &["--generate"],
    );
}

#[test]
fn version_is_that_of_the_workspace() {
    let version = seedloop(Path::new("."), &["--version"]);
    assert_code(&version, 0);
    assert_eq!(
        text(&version.stdout),
        concat!("seedloop ", env!("CARGO_PKG_VERSION"), "\n")
    );
}

#[test]
fn unknown_commands_and_flags_are_errors_of_usage() {
    let here = Path::new(".");
    assert_code(&seedloop(here, &["simulat"]), 2);
    assert_code(&seedloop(here, &["simulate"]), 2);
    assert_code(&seedloop(here, &["diagnose", "problem.json", "--wrong"]), 2);
}

#[test]
fn a_study_that_is_missing_is_named() {
    let output = seedloop(Path::new("."), &["calibrate", "nowhere.toml"]);
    assert_error(&output, &["nowhere.toml"]);
}
