//! The exported decks, run by LAMMPS and LIGGGHTS themselves: slow, and only where the variables `LAMMPS` and
//! `LIGGGHTS` name their commands (`just lammps` and `just liggghts` install them and run this). What they gave is kept,
//! and every test run holds the bed here to it.

use exchange::dump;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A small drum of coarse seeds; FIXTURES stands for the folder of the meshes.
const SCENE: &str = include_str!("decks.toml");

/// Spheres at the surface of its 90 and 10 seeds, of 16 and 13 each.
const SPHERES: usize = 90 * 16 + 10 * 13;

/// Inner radius of its drum, m.
const RADIUS: f64 = 0.03;

/// Moments of a dump that count, 0.1 s apart: the last 2 of 3 s of rotation.
const STEADY: usize = 20;

/// Seeds of the runs.
const SEEDS: [&str; 8] = ["1", "2", "3", "4", "5", "6", "7", "8"];

/// Mean angle of the bed from each seed, deg, as the real codes gave it from the exported decks: LAMMPS (package
/// 2025.7.22.4.0) by `just lammps`, LIGGGHTS (Debian, 3.8.0) by `just liggghts`, both on 24 November 2026.
const PEERS: [[f64; 8]; 2] = [
    [35.71, 36.89, 37.15, 38.04, 36.52, 36.48, 35.88, 36.62],
    [35.80, 36.79, 37.02, 38.49, 37.01, 36.49, 36.55, 37.18],
];

/// Mean and variance of a mean of values that are about independent.
fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, square / (n - 1.0) / n)
}

fn seedloop(folder: &Path, words: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the command starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    output.stdout
}

/// Mean angle of the bed in a run here, from the positions of the spheres, deg.
fn angle_here(folder: &Path, seed: &str) -> f64 {
    let words = ["simulate", "drum.toml", "--quiet", "--json", "--seed", seed];
    let json: Value = serde_json::from_slice(&seedloop(folder, &words)).expect("JSON");
    let angles = &json["frames"]["angles_by_position_deg"];
    let angles = angles
        .as_array()
        .expect("angles")
        .iter()
        .filter_map(Value::as_f64);
    mean_and_variance(&angles.collect::<Vec<_>>()).0
}

/// Mean angle of the bed in a run of the exported deck, by the same code, deg.
fn angle_there(folder: &Path, seed: &str, format: &str, command: &str) -> f64 {
    let deck = format!("deck{seed}");
    let words = [
        "export",
        format,
        "drum.toml",
        "--quiet",
        "--out",
        &deck,
        "--seed",
        seed,
    ];
    seedloop(folder, &words);
    let deck = folder.join(deck);
    let output = Command::new(command)
        .args(["-in", "in.drum", "-log", "log.txt"])
        .env("OMP_NUM_THREADS", "1")
        .current_dir(&deck)
        .output()
        .expect("the command starts");
    assert!(
        output.status.success(),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    let text = std::fs::read_to_string(deck.join("bed.dump")).expect("a dump");
    let moments = dump::read(&text, "bed.dump").expect("the dump can be read");
    assert!(moments.len() >= 30, "{} moments", moments.len());
    let steady = &moments[moments.len() - STEADY..];
    assert!(
        steady.iter().all(|m| m.discs.len() == SPHERES),
        "{} spheres of {SPHERES}",
        steady[0].discs.len()
    );
    let angles: Vec<f64> = steady
        .iter()
        .step_by(2)
        .filter_map(|m| dump::angle(m, RADIUS))
        .map(f64::to_degrees)
        .collect();
    mean_and_variance(&angles).0
}

/// A folder with the scene, its meshes by their whole paths.
fn scene_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/stl");
    let meshes = meshes.canonicalize().expect("the meshes exist");
    let text = SCENE.replace("FIXTURES", meshes.to_str().expect("a plain path"));
    std::fs::write(folder.path().join("drum.toml"), text).expect("the scene is written");
    folder
}

/// Compares the bed here with that of the command that a variable names.
///
/// Both beds are read by the positions of the spheres with the same code. The difference must be within
/// 3 of its standard errors, which the scatter of eight runs here and eight there tells.
#[expect(clippy::print_stdout, reason = "the figures are the purpose")]
fn compare(variable: &str, format: &str) {
    let command = std::env::var(variable).expect("the variable names the command");
    let folder = scene_folder();
    let own = SEEDS.map(|seed| angle_here(folder.path(), seed));
    let theirs = SEEDS.map(|seed| angle_there(folder.path(), seed, format, &command));
    let ((a, va), (b, vb)) = (mean_and_variance(&own), mean_and_variance(&theirs));
    let error = (va + vb).sqrt();
    println!(
        "here {own:?}, {variable} {theirs:?}: difference {:.2} deg, standard error {error:.2}",
        a - b
    );
    assert!(
        (a - b).abs() < 3.0 * error,
        "here {own:?}, {variable} {theirs:?}"
    );
}

/// The bed here stands where both codes had it, within 3 standard errors of the difference: some 1.1 deg, since one run
/// scatters by 0.7 to 0.8. Runs of one seed resemble each other in the two codes, so that their mean is taken as that of
/// eight runs, not of sixteen. With a friction of 0.2 in place of 0.1 the bed stands 6 deg higher.
#[test]
fn bed_angle_is_what_lammps_and_liggghts_gave() {
    let folder = scene_folder();
    let own = SEEDS.map(|seed| angle_here(folder.path(), seed));
    let theirs: Vec<f64> = (0..SEEDS.len())
        .map(|i| f64::midpoint(PEERS[0][i], PEERS[1][i]))
        .collect();
    let ((a, va), (b, vb)) = (mean_and_variance(&own), mean_and_variance(&theirs));
    let error = (va + vb).sqrt();
    assert!(
        (a - b).abs() < 3.0 * error,
        "here {a:.2}, there {b:.2}, standard error {error:.2} deg: {own:?}"
    );
}

#[test]
#[ignore = "runs LAMMPS for minutes; `just lammps`"]
fn bed_angle_of_the_exported_deck_agrees_with_lammps() {
    compare("LAMMPS", "lammps");
}

#[test]
#[ignore = "runs LIGGGHTS for minutes; `just liggghts`"]
fn bed_angle_of_the_exported_deck_agrees_with_liggghts() {
    compare("LIGGGHTS", "liggghts");
}
