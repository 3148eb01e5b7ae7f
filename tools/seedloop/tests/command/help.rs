//! Help, version, usage.

use crate::{assert_code, assert_error, seedloop, text};
use std::path::Path;

const COMMANDS: [&str; 12] = [
    "simulate",
    "design",
    "run",
    "analyse",
    "optimise",
    "init",
    "calibrate",
    "watch",
    "diagnose",
    "bench-test",
    "export",
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
