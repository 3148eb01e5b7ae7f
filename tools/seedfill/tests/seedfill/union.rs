//! The surface of the spheres as an STL file.

use crate::{fixture, json_of, path_text, seedfill, text};
use trimesh::{LengthUnit, read_mesh};

/// The file of an overlapping filling is one closed body without repairs, its volume the one that is reported and
/// within 0.3 (cell / radius)² of the union (the deficit of inscribed facets, as tested in sphere-fill); half
/// the cell has a quarter of the error, within a factor 1.5 for the necks, and a reader in the same unit
/// finds it where the mesh lies.
#[test]
fn the_union_is_a_closed_body_of_the_volume_told() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = fixture("cotton_flat.stl");
    let with = |cell: &str| {
        let file = folder.path().join(format!("union{cell}.stl"));
        let words = [
            path_text(&mesh),
            "--radius",
            "0.8",
            "--method",
            "surface",
            "--count",
            "8",
            "--json",
        ];
        let more = ["--quiet", "--union", path_text(&file), "--union-cell", cell];
        let output = seedfill(&[&words[..], &more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json = json_of(&output);
        let read = read_mesh(&file, LengthUnit::Millimetre).unwrap();
        read.mesh.require_closed().unwrap();
        assert!(
            read.report.warnings.is_empty(),
            "{:?}",
            read.report.warnings
        );
        let told = &json["union_surface"];
        assert_eq!(told["triangles"], read.report.triangles);
        let volume = read.report.volume.unwrap() * 1e9;
        assert!((told["volume"].as_f64().unwrap() / volume - 1.0).abs() < 1e-12);
        let union = json["fit"]["union_fraction"].as_f64().unwrap()
            * json["mesh"]["volume"].as_f64().unwrap();
        let error = 100.0 * (volume / union - 1.0);
        assert!((told["volume_error_percent"].as_f64().unwrap() - error).abs() < 1e-6);
        let (own, other) = (
            read.report.bounding_box,
            &json["mesh"]["bounding_box"]["low"],
        );
        for k in 0..3 {
            let low = other[k].as_f64().unwrap();
            assert!(
                (own.low[k] * 1e3 - low).abs() < 0.5,
                "{} {low}",
                own.low[k] * 1e3
            );
        }
        error
    };
    let (coarse, fine) = (with("0.2"), with("0.1"));
    assert!(
        coarse < 0.0 && coarse > -30.0 * (0.2_f64 / 0.8).powi(2),
        "{coarse}"
    );
    let ratio = coarse / fine;
    assert!((4.0 / 1.5..4.0 * 1.5).contains(&ratio), "{coarse} {fine}");
}

/// Loose spheres are several closed surfaces, and the text says so; cells that are too small, and digits that
/// STL does not have, are refused with the remedy and leave no file.
#[test]
fn the_union_of_a_loose_pack_is_told_and_bad_cells_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = fixture("cotton_flat.stl");
    let file = folder.path().join("union.stl");
    let words = [
        path_text(&mesh),
        "--radius",
        "0.8",
        "--count",
        "4",
        "--quiet",
        "--union",
        path_text(&file),
    ];
    let told = text(&seedfill(&words).stdout);
    assert!(told.contains("4 surfaces closed"), "{told}");
    std::fs::remove_file(&file).unwrap();
    for (cell, part) in [
        ("1e-6", "take at least"),
        ("0", "positive"),
        ("x", "--union-cell"),
    ] {
        let refused = seedfill(&[&words[..], &["--union-cell", cell]].concat());
        assert_eq!(refused.status.code(), Some(2), "{cell}");
        assert!(
            text(&refused.stderr).contains(part),
            "{}",
            text(&refused.stderr)
        );
        assert!(!file.exists());
    }
}
