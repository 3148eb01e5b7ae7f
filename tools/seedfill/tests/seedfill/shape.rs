//! Shape of the mesh, moments and axes.

use crate::{fixture, json_of, path_text, seedfill, text};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Writes a cuboid about the origin (edges in mm) as a text OBJ, turned by an angle (rad) about z.
pub(crate) fn cuboid(folder: &Path, name: &str, size: [f64; 3], turn: f64) -> PathBuf {
    let mut obj = String::new();
    for bits in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|k| if bits >> k & 1 == 1 { 0.5 } else { -0.5 } * size[k]);
        let (sin, cos) = turn.sin_cos();
        let (x, y) = (x * cos - y * sin, x * sin + y * cos);
        writeln!(obj, "v {x} {y} {z}").expect("a string takes all text");
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}").expect("a string takes all text");
    }
    let file = folder.join(name);
    std::fs::write(&file, obj).expect("the folder takes a file");
    file
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// The command on a cuboid of 8 x 4 x 3 mm, turned by 30 degrees, with two balls of 1 mm at +-2 mm along x as its spheres.
fn turned_cuboid(more: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let turn = std::f64::consts::FRAC_PI_6;
    let mesh = cuboid(folder.path(), "box.obj", [8.0, 4.0, 3.0], turn);
    let spheres = folder.path().join("two.csv");
    std::fs::write(&spheres, "x,y,z,radius\n-2,0,0,1\n2,0,0,1\n").expect("a file");
    Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args([path_text(&mesh), "--spheres", path_text(&spheres)])
        .args(more)
        .output()
        .expect("the command starts")
}

/// Asserts that numbers are exact to a relative error.
fn assert_near(found: &[f64], exact: [f64; 3], error: f64) {
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(exact) {
        assert!(
            (found / exact - 1.0).abs() < error,
            "{found} instead of {exact}"
        );
    }
}

/// Lengths, volume and area of the cuboid, and the figures made of them, to rounding.
#[test]
fn shape_has_its_closed_forms() {
    let shape = &json_of(&turned_cuboid(&["--json"]))["shape"];
    let area = 2.0 * (32.0 + 24.0 + 12.0);
    for (key, exact) in [
        ("volume", 96.0),
        ("area", area),
        ("longest", 8.0),
        ("intermediate", 4.0),
        ("shortest", 3.0),
        ("elongation", 0.5),
        ("flatness", 0.75),
        ("equivalent_diameter", (6.0 * 96.0 / PI).cbrt()),
        ("sphericity", (36.0 * PI * 96.0 * 96.0).cbrt() / area),
    ] {
        let found = shape[key].as_f64().unwrap();
        assert!((found / exact - 1.0).abs() < 1e-9, "{key}: {found}");
    }
}

/// Moments of the cuboid are m (b² + c²)/12. The two balls have 2/5 r² and 2/5 r² + d² for a unit of mass, and their axis is
/// 30 degrees away from that of the cuboid; about it no other axis has a direction. The tolerances are rounding, and
/// for the spheres that of the chords of the union, 1e-4.
#[test]
fn moments_and_axes_have_their_closed_forms() {
    let json = json_of(&turned_cuboid(&["--json", "--mass", "2e-3"]));
    let moments = &json["moments"];
    let exact = [25.0, 73.0, 80.0].map(|sum| sum / 12.0);
    let of_mesh = |key: &str| numbers(&moments["mesh"][key]);
    assert_near(&of_mesh("principal_per_mass"), exact, 1e-9);
    assert_near(
        &of_mesh("principal_kg_m2"),
        exact.map(|moment| moment * 2e-9),
        1e-9,
    );
    let own = [0.4, 4.4, 4.4];
    let of_spheres = numbers(&moments["spheres"]["principal_per_mass"]);
    assert_near(&of_spheres, own, 1e-3);
    let errors = numbers(&moments["error_percent"]);
    for (k, (own, exact)) in own.iter().zip(exact).enumerate() {
        let expected = 100.0 * (own / exact - 1.0);
        assert!((errors[k] - expected).abs() < 0.1, "{errors:?}");
    }
    let angles = &moments["axis_angle_deg"];
    assert!(
        (angles[0].as_f64().unwrap() - 30.0).abs() < 1e-3,
        "{angles}"
    );
    assert!(angles[1].is_null() && angles[2].is_null(), "{angles}");
}

/// The text has the closed forms in rounded numbers.
#[test]
fn shape_moments_and_axes_are_printed() {
    let printed = text(&turned_cuboid(&[]).stdout);
    for part in [
        "8.000 x 4.000 x 3.000 mm",
        "0.500 (I / L), 0.750 (S / I)",
        "2.083, 6.083, 6.667 mm2 a unit of mass",
        "30.00, -, - deg",
    ] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
}

/// The same seed in metres and in millimetres: lengths follow the unit, shape and kg m2 do not.
#[test]
fn shape_follows_the_unit_of_the_mesh() {
    let mesh = fixture("cotton_flat.stl");
    let of = |unit: &str| {
        let words = [
            path_text(&mesh),
            "--unit",
            unit,
            "--radius",
            "1.2",
            "--count",
            "2",
            "--density",
            "1000",
        ];
        json_of(&seedfill(&[&words[..], &["--json", "--quiet"]].concat()))
    };
    let (small, large) = (of("mm"), of("m"));
    for key in ["longest", "sphericity", "volume"] {
        let (a, b) = (small["shape"][key].as_f64(), large["shape"][key].as_f64());
        assert!((a.unwrap() / b.unwrap() - 1.0).abs() < 1e-9, "{key}");
    }
    let moment = |json: &Value| numbers(&json["moments"]["mesh"]["principal_kg_m2"])[0];
    assert!((moment(&large) / moment(&small) * 1e-15 - 1.0).abs() < 1e-9);
}
