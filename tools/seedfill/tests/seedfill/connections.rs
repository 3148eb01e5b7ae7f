//! Pieces, contacts and bonds.

use crate::{fixture, json_of, path_text, text};
use geometry::clump::{MassProperties, Sphere};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the command on given spheres (x, y, z, radius in mm).
fn measured(folder: &Path, spheres: &[[f64; 4]], more: &[&str]) -> Output {
    let file = folder.join("spheres.csv");
    let mut table = "x,y,z,radius\n".to_owned();
    for [x, y, z, r] in spheres {
        writeln!(table, "{x},{y},{z},{r}").expect("a string takes all text");
    }
    std::fs::write(&file, table).expect("the folder takes a file");
    Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args([
            path_text(&fixture("cotton_flat.stl")),
            "--spheres",
            path_text(&file),
        ])
        .args(more)
        .output()
        .expect("the command starts")
}

/// Three overlapping spheres and one that is 0.3 mm away, counted by hand: equal spheres of 1 mm at 1.2
/// and 1.6 mm have necks of 0.8 and 0.6 mm. The gap that is reported, used as it is reported, joins them.
#[test]
fn a_loose_piece_is_told_with_the_gap_that_joins_it() {
    let folder = tempfile::tempdir().unwrap();
    let spheres = [0.0, 1.2, 2.8, 5.1].map(|x| [x, 0.0, 0.0, 1.0]);
    let page = folder.path().join("page.html");
    let output = measured(
        folder.path(),
        &spheres,
        &["--json", "--html", path_text(&page)],
    );
    let json = json_of(&output);
    let found = &json["connections"];
    assert_eq!(
        (&found["pieces"], &found["largest_piece"]),
        (&2.into(), &3.into())
    );
    assert_eq!(
        (&found["contacts"], &found["rattlers"]),
        (&2.into(), &1.into())
    );
    assert_eq!(found["mean_coordination"], 1.0);
    assert_eq!(found["loosest_neck_spheres"], serde_json::json!([1, 2]));
    let near = |key: &str, exact: f64| {
        let value = found[key].as_f64().unwrap();
        assert!((value - exact).abs() < 1e-12, "{key} {value}");
    };
    near("loosest_neck_radius", 0.6);
    near("joining_gap", 0.3);
    near("bond_gap", 0.01);
    let warning = json["warnings"][0].as_str().unwrap();
    assert!(
        text(&output.stderr).contains(warning),
        "{}",
        text(&output.stderr)
    );
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("2 loose pieces") && page.contains("loosest neck"));
    let (_, flag) = warning.split_once("--bond-gap ").unwrap();
    let (gap, _) = flag.split_once(',').unwrap();
    let joined = measured(folder.path(), &spheres, &["--json", "--bond-gap", gap]);
    let json = json_of(&joined);
    assert_eq!(json["connections"]["pieces"], 1);
    assert_eq!(json["warnings"], serde_json::json!([]));
    for (gap, part) in [
        ("2.1", "at most the diameter"),
        ("-1", "positive"),
        ("0,1", "--bond-gap"),
    ] {
        let refused = measured(folder.path(), &spheres, &["--bond-gap", gap]);
        assert_eq!(refused.status.code(), Some(2), "{gap}");
        assert!(
            text(&refused.stderr).contains(part),
            "{}",
            text(&refused.stderr)
        );
    }
}

/// The bonds of the table are the pairs that the solver bonds at the same gap, in the same numbers; and the
/// gap that joins all is the least that the solver does not refuse.
#[test]
fn the_bonds_are_those_of_the_solver() {
    let folder = tempfile::tempdir().unwrap();
    let bonds = folder.path().join("bonds.csv");
    let output = crate::seedfill(&[
        path_text(&fixture("cotton_flat.stl")),
        "--radius",
        "0.6",
        "--count",
        "40",
        "--bond-gap",
        "0.25",
        "--bonds",
        path_text(&bonds),
        "--json",
        "--quiet",
    ]);
    let json = json_of(&output);
    let spheres: Vec<Sphere> = json["sphere_list"]
        .as_array()
        .unwrap()
        .iter()
        .map(sphere_of)
        .collect();
    let properties = MassProperties {
        mass: 1e-4,
        centre: Vector3::zeros(),
        inertia: Matrix3::identity() * 1e-10,
    };
    let clump = geometry::clump::Clump::new(&spheres, &properties).unwrap();
    let start = dem_solver::Placement {
        template: 0,
        position: Vector3::zeros(),
        orientation: UnitQuaternion::identity(),
        velocity: Vector3::zeros(),
        spin: Vector3::zeros(),
    };
    let agglomerate = |gap: f64| dem_solver::bonds::agglomerate(&clump, &start, 0, 0, gap);
    let table = std::fs::read_to_string(&bonds).unwrap();
    let mut lines = table.lines();
    assert_eq!(
        lines.next().unwrap(),
        "sphere_i,sphere_j,distance_mm,gap_mm,neck_radius_mm,radius_i_mm,radius_j_mm"
    );
    let pairs: Vec<[usize; 2]> = lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), 7, "{line}");
            [cells[0], cells[1]].map(|cell| cell.parse().unwrap())
        })
        .collect();
    assert!(pairs.len() > 60, "{} bonds", pairs.len());
    assert_eq!(pairs, agglomerate(0.25e-3).unwrap().pairs);
    assert_eq!(json["connections"]["contacts"], pairs.len());
    // Rounding when the clump is turned to its axes is below 1e-12 of the gap.
    let joining = json["connections"]["joining_gap"].as_f64().unwrap() * 1e-3;
    assert!(joining > 1e-5, "the case is not a case: {joining}");
    assert!(agglomerate(joining * (1.0 + 1e-9)).is_ok());
    assert!(agglomerate(joining * (1.0 - 1e-9)).is_err());
}

/// A row of `sphere_list` in mm.
fn sphere_of(row: &serde_json::Value) -> Sphere {
    let number = |k: usize| row[k].as_f64().expect("a number") * 1e-3;
    Sphere {
        centre: Vector3::new(number(0), number(1), number(2)),
        radius: number(3),
    }
}
