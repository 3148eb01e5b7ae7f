//! A small drum of coarse seeds beside LAMMPS and LIGGGHTS.
//!
//! What the two codes gave for the exported decks is kept in `fixtures/peers`, and every test run holds the bed here to
//! it. The tests that run the codes themselves are slow and only run where the variables `LAMMPS` and `LIGGGHTS` name
//! their commands (`trials/programs.sh lammps` and `trials/programs.sh liggghts` install them and run these tests); they print the rows of the
//! tables.

mod fall;
mod hand_over;
mod simulator;
mod steady;

use dev_support::fixture_files::fixture;
use scene::{Override, Scene};
use simulators::exchange::vtk::File;
use simulators::exchange::{Moment, dump};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Inner radius of the drum, m.
const RADIUS: f64 = 0.03;

/// Spheres at the surface of its 90 and 10 seeds, of 16 and 13 each.
const SPHERES: usize = 90 * 16 + 10 * 13;

/// Seeds of the runs.
const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];

/// The drum with changes.
fn drum(changes: &[(&str, &str)]) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/drum.toml");
    let changes: Vec<Override> = changes
        .iter()
        .map(|(name, value)| Override {
            name: (*name).into(),
            value: (*value).into(),
        })
        .collect();
    Scene::read(&file, &changes).expect("the scene of the test")
}

/// The command that a variable names.
fn command(variable: &str) -> String {
    std::env::var(variable).expect("the variable names the command")
}

/// Runs a deck in a folder; the moments that it dumped.
fn run_deck(command: &str, folder: &Path, files: &[File]) -> Vec<Moment> {
    fs::create_dir_all(folder).expect("a folder");
    for file in files {
        fs::write(folder.join(&file.name), &file.text).expect("the deck is written");
    }
    let output = Command::new(command)
        .args(["-in", "in.drum", "-log", "log.txt"])
        .env("OMP_NUM_THREADS", "1")
        .current_dir(folder)
        .output()
        .expect("the command starts");
    assert!(
        output.status.success(),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    let text = fs::read_to_string(folder.join("bed.dump")).expect("a dump");
    let moments = dump::read(&text, "bed.dump", 1).expect("the dump can be read");
    let last = moments.last().map_or(0, |m| m.spheres.len());
    assert!(last == SPHERES, "{last} spheres of {SPHERES} at the end");
    moments
}

/// The rows of a table of `fixtures/peers` that belong to a code: its numbers, seed by seed.
fn kept<const N: usize>(table: &str, code: &str) -> Vec<[f64; N]> {
    let file: PathBuf = fixture("peers").join(table);
    let text = fs::read_to_string(&file).expect("the table");
    let rows = text.lines().filter(|l| l.starts_with(code));
    let rows: Vec<[f64; N]> = rows
        .map(|row| {
            let cells = row.split(',').skip(2);
            let numbers: Vec<f64> = cells.map(|c| c.parse().expect("a number")).collect();
            numbers.try_into().expect("as many cells as columns")
        })
        .collect();
    assert!(!rows.is_empty(), "no rows of {code} in {table}");
    rows
}

/// Mean of values and the variance of that mean.
fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, square / (n - 1.0) / n)
}
