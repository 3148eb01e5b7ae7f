//! Calibrated parameters on their way to another code: `seedloop export` with a parameter file, and the code runs the deck.

use crate::{SPHERES, command};
use simulators::exchange::dump;
use std::fs;
use std::path::Path;
use std::process::Command;

/// What a calibration hands over: a friction between the seeds that the scene does not have.
const PARAMETERS: &str = r#"
[[parameter]]
symbol = "F"
name = "friction seed-seed"
sets = ["contact.seed-seed.static_friction"]
value = 0.2371
"#;

/// Exports the small drum, cut to some milliseconds, with the parameters, and runs the deck with the code.
fn hand_over(format: &str, variable: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let parameters = folder.path().join("parameters.toml");
    fs::write(&parameters, PARAMETERS).expect("the parameters");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/drum.toml");
    let deck = folder.path().join("deck");
    let output = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(["export", format])
        .arg(scene)
        .arg("--set-file")
        .arg(&parameters)
        .args([
            "--set",
            "rotation_limit=0.04 s",
            "--set",
            "settle_limit=0.05 s",
        ])
        .args([
            "--set",
            "frame_interval=0.02 s",
            "--set",
            "frames=2",
            "--out",
        ])
        .arg(&deck)
        .output()
        .expect("the command starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let script = fs::read_to_string(deck.join("in.drum")).expect("a deck");
    let written = ["0.2371", "2.371e-1"]
        .iter()
        .any(|value| script.contains(value));
    assert!(written, "the friction of the parameter file");
    let output = Command::new(command(variable))
        .args(["-in", "in.drum"])
        .env("OMP_NUM_THREADS", "1")
        .current_dir(&deck)
        .output()
        .expect("the command starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stdout)
    );
    let text = fs::read_to_string(deck.join("bed.dump")).expect("a dump");
    let moments = dump::read(&text, "bed.dump", 1).expect("moments");
    let last = moments.last().map_or(0, |m| m.spheres.len());
    assert_eq!(last, SPHERES, "all spheres are there");
}

#[test]
#[ignore = "runs LAMMPS; `trials/programs.sh lammps`"]
fn lammps_takes_over_the_parameters() {
    hand_over("lammps", "LAMMPS");
}

#[test]
#[ignore = "runs LIGGGHTS; `trials/programs.sh liggghts`"]
fn liggghts_takes_over_the_parameters() {
    hand_over("liggghts", "LIGGGHTS");
}
