//! Several meshes in one call.

use crate::shape::cuboid;
use crate::{fixture, json_of, text};
use std::path::Path;
use std::process::{Command, Output};

fn shapes(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the command starts")
}

/// Two cuboids, a mesh that is cut off and one that is missing: the good ones have their rows, the others
/// their reasons under their names, and the exit code is 1; with no good one at all 2. The ball of 1 mm
/// fits the first cuboid alone.
#[test]
fn a_bad_mesh_does_not_lose_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    cuboid(at, "a.obj", [8.0, 4.0, 2.2], 0.4);
    cuboid(at, "b, c.obj", [3.0, 1.5, 1.0], 0.0);
    let whole = std::fs::read(fixture("cotton_flat.stl")).unwrap();
    std::fs::write(at.join("cut.stl"), &whole[..9999]).unwrap();
    let meshes = ["a.obj", "cut.stl", "none.stl", "b, c.obj"];
    let more = [
        "--shapes",
        "shapes.csv",
        "--radius",
        "1",
        "--effort",
        "0.05",
        "--json",
    ];
    let output = shapes(at, &[&meshes[..], &more].concat());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let message = text(&output.stderr);
    for part in [
        "cut.stl: cut.stl declares",
        "cannot read none.stl",
        "b, c.obj: a sphere of radius",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let json = json_of(&output);
    assert_eq!(json["inputs"].as_object().unwrap().len(), 3);
    let rows = json["meshes"].as_array().unwrap();
    assert!((rows[0]["shape"]["longest"].as_f64().unwrap() - 8.0).abs() < 1e-9);
    assert!(rows[0]["spheres"].as_u64().unwrap() >= 4 && rows[0]["problem"].is_null());
    assert!(rows[1]["shape"].is_null() && rows[2]["shape"].is_null());
    assert!((rows[3]["shape"]["flatness"].as_f64().unwrap() - 1.0 / 1.5).abs() < 1e-9);
    assert!(rows[3]["spheres"].is_null());
    let table = command_line::table_file::read(&at.join("shapes.csv")).unwrap();
    let head = "mesh volume_mm3 area_mm2 equivalent_diameter_mm longest_mm intermediate_mm shortest_mm elongation \
                flatness sphericity spheres volume_share problem";
    assert_eq!(table.header().join(" "), head);
    let names: Vec<&str> = table.rows().iter().map(|row| row.text(0)).collect();
    assert_eq!(names, meshes);
    let share = table.column("volume_share").unwrap();
    assert_eq!(
        table.number(&table.rows()[0], share).unwrap(),
        rows[0]["volume_share"].as_f64().unwrap()
    );
    let worst = shapes(at, &["cut.stl", "none.stl", "--shapes", "worst.csv"]);
    assert_eq!(worst.status.code(), Some(2));
    let good = shapes(at, &["a.obj", "b, c.obj", "--shapes", "book.xlsx"]);
    assert_eq!(good.status.code(), Some(0), "{}", text(&good.stderr));
    let book = command_line::table_file::read(&at.join("book.xlsx")).unwrap();
    let volume = book.column("volume_mm3").unwrap();
    assert!((book.number(&book.rows()[1], volume).unwrap() - 4.5).abs() < 1e-9);
    assert!(
        text(&good.stdout).contains("b, c.obj"),
        "{}",
        text(&good.stdout)
    );
}

#[test]
fn several_meshes_are_refused_where_one_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    cuboid(at, "a.obj", [8.0, 4.0, 2.2], 0.0);
    let cases: [(&[&str], &str); 4] = [
        (&["a.obj", "a.obj", "--radius", "1"], "--shapes FILE.csv"),
        (
            &["a.obj", "--shapes", "s.csv", "--count", "3"],
            "--radius as well",
        ),
        (&["a.obj", "--shapes", "s.csv", "--out", "o.csv"], "--out"),
        (&["a.obj", "--shapes", "s.xlsm"], ".xlsx"),
    ];
    for (words, part) in cases {
        let output = shapes(at, words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            text(&output.stderr).contains(part),
            "{words:?}: {}",
            text(&output.stderr)
        );
    }
    assert_eq!(
        std::fs::read_dir(at).unwrap().count(),
        1,
        "nothing is left behind"
    );
}
