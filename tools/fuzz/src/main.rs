//! Every reader of files under a coverage-guided fuzzer: `trials/fuzz.sh READER`.
//!
//! One program for all readers; the environment variable `READER` says which one gets the inputs. A reader may refuse
//! anything, and must neither panic nor hang nor take more memory than libFuzzer allows. What it accepts is not looked at.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The reader of this process.
static READER: LazyLock<String> = LazyLock::new(|| {
    std::env::var("READER").expect("READER is one of those in tools/fuzz/src/main.rs")
});

/// The rows that a table of results must have.
static ROWS: LazyLock<Vec<passport::Expected>> = LazyLock::new(|| {
    let text = include_str!("../../../fixtures/passport/stored/rolling.json");
    passport::read_passport(text).expect("the stored passport can be read").expected
});

fuzz_target!(|bytes: &[u8]| match READER.as_str() {
    "mesh" => {
        let _ = trimesh::parse_mesh(bytes.to_vec(), trimesh::LengthUnit::Millimetre, "mesh.stl");
    }
    "obj" => {
        let _ = trimesh::parse_mesh(bytes.to_vec(), trimesh::LengthUnit::Millimetre, "mesh.obj");
    }
    "spheres" => {
        let text = String::from_utf8_lossy(bytes);
        let _ = geometry::clump::files::read_spheres(&text, "seed.csv", 1e-3);
    }
    "picture" => {
        let _ = photo_profile::read_frames(&on_disk(bytes, "png"));
    }
    "scene" => {
        let text = String::from_utf8_lossy(bytes);
        let _ = scene::Scene::from_text(&text, "scene.toml", Path::new("."), &[]);
    }
    "study" => {
        let _ = study::Study::read(&on_disk(bytes, "toml"), None);
    }
    "table" => {
        let text = experiment_design::table::text_of_bytes(bytes.to_vec());
        let _ = experiment_design::table::Table::parse(&text);
        let _ = experiment_design::table::factors_from_csv(&text);
    }
    "workbook" => {
        let _ = command_line::table_file::read(&on_disk(bytes, "xlsx"));
    }
    "problem" => {
        let file = serde_json::from_slice::<inference::diagnosis::ProblemFile>(bytes);
        let _ = file.map(inference::diagnosis::Problem::try_from);
    }
    "positions" => {
        // The first byte says which form the rest has.
        let Some((form, rest)) = bytes.split_first() else {
            return;
        };
        let ending = ["csv", "vtk", "vtp", "dump"][usize::from(form % 4)];
        let _ = simulators::exchange::read_positions(&on_disk(rest, ending));
    }
    "record" => {
        let _ = campaign::run_store::unseal(bytes);
        let _ = serde_json::from_slice::<campaign::run_store::Record>(bytes);
    }
    "passport" => {
        let text = String::from_utf8_lossy(bytes);
        let _ = passport::read_results(&text, "RESULTS.csv", &ROWS);
        let _ = passport::read_passport(&text);
    }
    "state" => {
        let _ = campaign::run_store::unseal_text("key", bytes);
        let _ = serde_json::from_slice::<scene::Progress>(bytes);
    }
    "quantity" => {
        let text = String::from_utf8_lossy(bytes);
        let _ = input::quantity::Length::parse(&text);
        let _ = input::quantity::AngularSpeed::parse(&text);
        let _ = input::quantity::Angle::parse(&text);
    }
    other => panic!("READER is '{other}', which is none of those in tools/fuzz/src/main.rs"),
});

/// The bytes as a file of this process, for readers of files; in a folder of the memory where `TMPDIR` is one.
fn on_disk(bytes: &[u8], ending: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("fuzz-{}.{ending}", std::process::id()));
    std::fs::write(&path, bytes).expect("the folder for temporary files can be written");
    path
}
