//! The command as a user meets it: exit codes, text, JSON, overlays.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod browser;
mod films;
mod heaps;
mod outputs;
mod photos;
mod series;
mod views;

use dev_support::fixture_files::fixture;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn photo(name: &str) -> PathBuf {
    fixture("photos").join(name)
}

const GOOD: &str = "granudrum_mccA_15rpm_avg.bmp";
const REFUSED: &str = "phone_prototype_drums_tilted_camera.jpg";

/// An empty folder of its own for one test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("angle-{name}"));
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_angle-from-image"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The rows of a table by the names of their columns; no cell of these tables holds a quotation mark.
fn table_of(file: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = std::fs::read_to_string(file).unwrap();
    let cells = |line: &str| -> Vec<String> {
        let mut quoted = false;
        let parted = line.split(|c| {
            quoted ^= c == '"';
            c == ',' && !quoted
        });
        parted
            .map(|cell| cell.trim_matches('"').to_owned())
            .collect()
    };
    let mut lines = text.lines();
    let head = cells(lines.next().unwrap());
    lines
        .map(|line| head.iter().cloned().zip(cells(line)).collect())
        .collect()
}
