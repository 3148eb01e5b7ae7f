//! The command as users and scripts call it.

mod connections;
mod programs;
mod shape;
mod shapes;
mod slices;
mod union;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::codecs::png::PngDecoder;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fixture(name: &str) -> PathBuf {
    dev_support::fixture_files::fixture("stl").join(name)
}

/// Runs the command with little search work.
fn seedfill(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args(["--effort", "0.05"])
        .args(words)
        .output()
        .expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn path_text(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

#[track_caller]
fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("JSON alone on standard output")
}

/// Figures of a fit that are one number.
const FIT_FIGURES: [&str; 8] = [
    "packing_fraction",
    "union_fraction",
    "max_protrusion",
    "max_overlap",
    "surface_rms",
    "surface_hausdorff",
    "roughness_rms",
    "centroid_offset",
];

/// Fills the flat seed with the number of spheres and the mass of the study, and returns the JSON.
fn filled_flat_seed(more: &[&str]) -> Value {
    let mesh = fixture("cotton_flat.stl");
    let words = [path_text(&mesh), "--radius", "0.45", "--count", "127"];
    let mass = ["--mass", "94.5e-6", "--json"];
    let output = seedfill(&[&words[..], &mass, more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    json_of(&output)
}

/// The JSON states the mesh, the mass and every figure of the fit.
#[test]
fn json_has_mesh_mass_and_fit_of_the_flat_seed() {
    let json = filled_flat_seed(&[]);
    assert_eq!(json["spheres"], 127);
    assert_eq!(json["radius"], 0.45);
    let mesh = &json["mesh"];
    assert_eq!(mesh["triangles"], 13520);
    assert_eq!(mesh["watertight"], true);
    assert_eq!(mesh["warnings"].as_array().unwrap().len(), 0);
    assert!((mesh["volume"].as_f64().unwrap() - 93.0).abs() < 1e-3);
    assert!((mesh["bounding_box"]["size"][0].as_f64().unwrap() - 9.26).abs() < 1e-6);
    // Eq. (9) of the study for its own count and mass.
    let density = json["fraction_density_kg_m3"].as_f64().unwrap();
    assert!((density - 1949.40).abs() < 0.01, "{density}");
    assert_eq!(json["mass_kg"], 94.5e-6);
    let fit = &json["fit"];
    for key in FIT_FIGURES {
        assert!(fit[key].is_number(), "{key}");
    }
    assert_eq!(fit["inertia_error_percent"].as_array().unwrap().len(), 3);
    assert!(json["version"].is_string() && json["seed"] == 1 && json["elapsed_s"].is_number());
    let sum = json["inputs"].as_object().unwrap().values().next().unwrap();
    assert_eq!(
        sum,
        "e2996577b429fe98c8fe43631c9df8ba3435022fc95f66195103c6b25576721d"
    );
}

/// The table has the spheres of the JSON, and the picture is a PNG.
#[test]
fn csv_json_and_picture_of_the_flat_seed_agree() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, png) = (
        folder.path().join("flat.csv"),
        folder.path().join("flat.png"),
    );
    let json = filled_flat_seed(&["--out", path_text(&csv), "--preview", path_text(&png)]);
    let table = std::fs::read_to_string(&csv).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines[0], lines.len()), ("x,y,z,radius", 128));
    for (k, word) in lines[1].split(',').enumerate() {
        let value: f64 = word.parse().unwrap();
        assert_eq!(json["sphere_list"][0][k].as_f64(), Some(value));
    }
    assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_file_is_overwritten_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("seed.csv");
    std::fs::write(&file, "mine").unwrap();
    let mesh = fixture("cotton_flat.stl");
    let words = [
        path_text(&mesh),
        "--radius",
        "0.8",
        "--out",
        path_text(&file),
    ];
    let output = seedfill(&words);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("--force"),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    let output = seedfill(&[&words[..], &["--force"]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(
        std::fs::read_to_string(&file)
            .unwrap()
            .starts_with("x,y,z,radius\n")
    );
}

#[test]
fn every_format_has_a_line_with_the_size_of_each_sphere() {
    let mesh = fixture("cotton_flat.stl");
    for (format, size) in [
        ("csv", ",1"),
        ("liggghts", " 0.001"),
        ("yade", " 0.001 0"),
        ("vtk", "1"),
        ("lammps", " 0.002"),
        ("edem", "sphere "),
        ("pfc", "    0.001 "),
    ] {
        let output = seedfill(&[
            path_text(&mesh),
            "--radius",
            "1mm",
            "--count",
            "3",
            "--format",
            format,
            "--quiet",
        ]);
        assert_eq!(output.status.code(), Some(0), "{format}");
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
        let table = text(&output.stdout);
        let has_size = |line: &&str| line.ends_with(size) || line.starts_with(size);
        let n = table.lines().filter(has_size).count();
        assert!(n >= 3, "{format}: {table}");
    }
}

/// A surface that is rebuilt is reported with the length of its cubes, in text and JSON, and fills as before; lengths that are none end
/// before any work.
#[test]
fn a_surface_is_made_anew_on_request() {
    let mesh = fixture("sphere.stl");
    let run = |cell: &str| {
        seedfill(&[
            path_text(&mesh),
            "--rebuild",
            cell,
            "--radius",
            "0.2",
            "--count",
            "4",
            "--json",
        ])
    };
    let output = run("0.2mm");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("rebuilt on cubes of 0.2000 mm"),
        "{}",
        text(&output.stderr)
    );
    let json = json_of(&output);
    let told = json["mesh"]["warnings"][0].as_str().unwrap();
    assert!(told.contains("rebuilt"), "{told}");
    for cell in ["0", "-1mm", "1nm", "500mm", "x"] {
        let output = run(cell);
        assert_eq!(output.status.code(), Some(2), "{cell}");
        assert!(output.stdout.is_empty(), "{cell}");
    }
}

/// The fewest spheres: the target is kept, and half as many do not keep it.
#[test]
fn a_target_is_kept_with_few_spheres_or_refused_with_what_was_reached() {
    let mesh = fixture("cotton_flat.stl");
    let run = |more: &[&str]| {
        let words = [
            "--radius", "0.2", "--method", "surface", "--json", "--quiet",
        ];
        seedfill(&[&[path_text(&mesh)], &words[..], more].concat())
    };
    let output = run(&["--target", "volume=1%,inertia=2%,surface=0.05mm"]);
    let json = json_of(&output);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let spheres = json["spheres"].as_u64().unwrap();
    assert!(spheres < 30, "{spheres} spheres");
    assert!(json["fit"]["surface_rms"].as_f64().unwrap() <= 0.05);
    assert!((json["fit"]["union_fraction"].as_f64().unwrap() - 1.0).abs() <= 0.01);
    let half = run(&[
        "--count",
        &(spheres / 2).to_string(),
        "--target",
        "surface=0.05",
    ]);
    assert_eq!(half.status.code(), Some(1));
    let refused = run(&["--target", "surface=0.001mm", "--max-spheres", "20"]);
    assert_eq!(refused.status.code(), Some(1));
    let reason = json_of(&refused)["reason"].as_str().unwrap().to_owned();
    assert!(
        reason.contains("20 spheres give") && reason.contains("surface 0.001000 mm"),
        "{reason}"
    );
}

/// The page holds the figures, two pictures and the viewer. Four times as many spheres of the same surface are nearly in touch with
/// more: a step costs more.
#[test]
fn the_page_and_the_cost_of_a_filling() {
    let folder = tempfile::tempdir().unwrap();
    let html = folder.path().join("a.html");
    let mesh = fixture("cotton_flat.stl");
    let cost_of = |count: &str, more: &[&str]| {
        let words = [path_text(&mesh), "--radius", "0.3", "--count", count];
        let method = ["--method", "surface", "--json", "--quiet"];
        let output = seedfill(&[&words[..], &method, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let cost = json_of(&output)["cost"].clone();
        let number = |key: &str| cost[key].as_f64().unwrap();
        [
            number("near_pairs_per_contact"),
            number("relative_step_cost"),
        ]
    };
    let [pairs, step] = cost_of("10", &["--html", path_text(&html)]);
    let [more_pairs, dearer] = cost_of("40", &[]);
    assert!(
        pairs > 1.0 && more_pairs > 2.0 * pairs,
        "{pairs} {more_pairs}"
    );
    assert!(dearer > 1.1 * step, "{step} {dearer}");
    let page = std::fs::read_to_string(&html).unwrap();
    for part in [
        "data-bodies=",
        "surface error, rms",
        "stand out",
        "near pairs of spheres",
        "SHA-256 e2996577",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("data:image/png").count(), 3);
}

/// What is written and read back has the report of the filling, and no other is made.
#[test]
fn given_spheres_are_measured() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, csv) = (fixture("cotton_flat.stl"), folder.path().join("flat.csv"));
    let (mesh, csv_text) = (path_text(&mesh), path_text(&csv));
    let filled = ["--radius", "0.8", "--json", "--quiet", "--out", csv_text];
    let filled = json_of(&seedfill(&[&[mesh], &filled[..]].concat()));
    let run = || {
        Command::new(env!("CARGO_BIN_EXE_seedfill"))
            .args([mesh, "--spheres", csv_text, "--json", "--quiet"])
            .output()
            .expect("the command starts")
    };
    let measured = json_of(&run());
    assert_eq!(measured["method"], "given");
    assert_eq!(measured["spheres"], filled["spheres"]);
    for key in ["union_fraction", "surface_rms", "roughness_rms"] {
        let (a, b) = (measured["fit"][key].as_f64(), filled["fit"][key].as_f64());
        assert!((a.unwrap() / b.unwrap() - 1.0).abs() < 1e-9, "{key}");
    }
    for (table, place) in [
        ("x,y,z,radius\n0,0,0,1\n0,0,nan,1\n", "line 3"),
        ("radius,x,y,z\n1,0,0,0\n", "line 1: the columns"),
        ("1 000,3,3,2\n", "line 1: expected"),
        ("0,0,0,1,0\n", "line 1: expected"),
        ("x;y;z;radius\n1,5;1;1;0,5;2\n", "line 2: expected"),
    ] {
        std::fs::write(&csv, table).unwrap();
        let refused = run();
        assert_eq!(refused.status.code(), Some(2), "{table}");
        let told = text(&refused.stderr);
        assert!(told.contains(place), "{told}");
    }
    // A spreadsheet of a country with decimal commas.
    std::fs::write(&csv, "x;y;z;radius\n0,5;0;0;0,75\n").unwrap();
    let read = json_of(&run());
    assert_eq!(read["spheres"], 1);
    assert_eq!(read["radius_mm"], 0.75);
}

#[test]
fn a_preview_is_a_png_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, preview) = (fixture("cotton_flat.stl"), folder.path().join("seed.jpg"));
    let run = Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args([path_text(&mesh), "--radius", "0.8", "--preview"])
        .arg(&preview)
        .output()
        .expect("the command starts");
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(2), "{told}");
    assert!(
        told.contains("seed.jpg: the picture is written as PNG"),
        "{told}"
    );
    assert!(!preview.exists());
}

/// `--force` replaces results of before, and never what the command reads.
#[test]
fn a_mesh_is_not_replaced_by_its_filling() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("seed.stl");
    std::fs::copy(fixture("cotton_flat.stl"), &mesh).unwrap();
    let mesh = path_text(&mesh);
    for out in ["--out", "--union", "--preview"] {
        let run = Command::new(env!("CARGO_BIN_EXE_seedfill"))
            .args([
                mesh, "--radius", "0.8", out, mesh, "--format", "csv", "--force",
            ])
            .output()
            .expect("the command starts");
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{told}");
        assert!(told.contains("is read by this command"), "{told}");
    }
    assert_eq!(
        std::fs::read(mesh).unwrap(),
        std::fs::read(fixture("cotton_flat.stl")).unwrap()
    );
}

#[test]
fn broken_meshes_end_with_code_2_and_the_name_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(fixture("cotton_flat.stl")).unwrap();
    // A part as large as a cap is missing; a hole of one triangle would be closed.
    let mut open = whole.clone();
    open.truncate(84 + 50 * 10_000);
    open[80..84].copy_from_slice(&10_000_u32.to_le_bytes());
    let cases: [(&str, &[u8], &str); 4] = [
        ("empty.stl", &[], "0 bytes"),
        ("cut.stl", &whole[..9999], "cut off"),
        ("open.stl", &open, "not closed"),
        ("none.stl", &[0; 84], "no triangle"),
    ];
    for (name, bytes, part) in cases {
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).unwrap();
        let output = seedfill(&[path_text(&file), "--radius", "0.45", "--quiet", "--json"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(
            message.contains(name) && message.contains(part),
            "{name}: {message}"
        );
        assert!(output.stdout.is_empty(), "{name}");
    }
}

#[test]
fn a_radius_that_does_not_fit_is_an_answer_with_its_reason() {
    let mesh = fixture("cotton_flat.stl");
    let output = seedfill(&[path_text(&mesh), "--radius", "3", "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(1));
    let json = json_of(&output);
    assert_eq!(json["verdict"], "refused");
    assert!(
        json["reason"]
            .as_str()
            .unwrap()
            .contains("the largest that does has about 1.69")
    );
    assert!(text(&output.stderr).contains("does not fit"));
}

/// A seed whose numbers are metres, read as millimetres, and the other way round.
#[test]
fn a_mesh_in_another_unit_is_warned_of() {
    let mesh = fixture("cotton_flat.stl");
    let output = seedfill(&[path_text(&mesh), "--unit", "m", "--radius", "1.2", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json = json_of(&output);
    let warning = json["mesh"]["warnings"][0].as_str().unwrap().to_owned();
    assert!(
        warning.contains("with the unit mm (factor 1e-3)"),
        "{warning}"
    );
    assert!(text(&output.stderr).contains(&warning));
    assert_eq!(json["unit"], "m");
}

#[test]
fn usage_that_cannot_be_meant_ends_with_code_2() {
    let mesh = fixture("cotton_flat.stl");
    let mesh = path_text(&mesh);
    let cases: [(&[&str], &str); 11] = [
        (&[mesh], "--radius"),
        (&[mesh, "--radius", "nan"], "positive"),
        (&[mesh, "--radius", "-0.45"], "positive"),
        (&[mesh, "--radius", "0.45", "--unit", "inch"], "inch"),
        (&[mesh, "--radius", "0.45", "--count", "0"], "at least 1"),
        (&[mesh, "--radius", "0.45", "--mass", "0"], "--mass"),
        // 94.5 mg typed as milligrams, and a density in g/cm3.
        (
            &[mesh, "--radius", "0.45", "--mass", "94.5"],
            "5 to 25000 kg/m3; --mass is in kg",
        ),
        (
            &[mesh, "--radius", "0.45", "--density", "1.05"],
            "the density is 1.050 kg/m3",
        ),
        (
            &[mesh, "--radius", "0.45", "--mass", "1", "--density", "900"],
            "--density",
        ),
        (
            &[mesh, "--radius", "0.45", "--roughness", "0.01"],
            "smooth, surface and ferellec only",
        ),
        (
            &[mesh, "--radius", "0.45", "--out", "seed.xyz"],
            "supported are csv",
        ),
    ];
    for (words, part) in cases {
        let output = seedfill(words);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {message}");
        assert!(message.contains(part), "{words:?}: {message}");
    }
}

/// A cap is missing, as where a scan stood on a table: refused with the width of the hole, filled when
/// holes of that width may be closed, and the change is reported in JSON and on the page.
#[test]
fn a_hole_is_closed_when_it_is_asked_for_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(fixture("cotton_flat.stl")).unwrap();
    let number =
        |record: &[u8], k: usize| f32::from_le_bytes(record[4 * k..4 * k + 4].try_into().unwrap());
    // All corners of a kept triangle lie below x = 3 mm; the seed reaches 4.63 mm.
    let records = whole[84..].chunks_exact(50);
    let kept: Vec<&[u8]> = records
        .filter(|r| [3, 6, 9].iter().all(|&k| number(r, k) < 3.0))
        .collect();
    let count = u32::try_from(kept.len()).unwrap().to_le_bytes();
    let (file, page) = (
        folder.path().join("cap.stl"),
        folder.path().join("cap.html"),
    );
    std::fs::write(&file, [&whole[..80], &count, &kept.concat()].concat()).unwrap();
    let words = [path_text(&file), "--radius", "0.8", "--json", "--quiet"];
    let refused = seedfill(&words);
    let message = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        message.contains("holes: 1, the widest") && message.contains("--close-holes"),
        "{message}"
    );
    let more = ["--close-holes", "6", "--html", path_text(&page)];
    let output = seedfill(&[&words[..], &more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mesh = json_of(&output)["mesh"].clone();
    assert_eq!(mesh["holes_closed"], 1);
    let width = mesh["widest_hole_closed"].as_f64().unwrap();
    assert!(width > 3.0 && width < 6.0, "{width}");
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("1 hole closed, the widest"));
    // Seen from over the lid, a good part of the body is red.
    let picture = page
        .split("The mesh with the lids of its holes in red")
        .nth(1);
    let data = picture.unwrap().split("base64,").nth(1).unwrap();
    let data = data.split('"').next().unwrap();
    let bytes = STANDARD.decode(data).unwrap();
    let picture = PngDecoder::new(std::io::Cursor::new(&bytes)).unwrap();
    let picture = image::DynamicImage::from_decoder(picture)
        .unwrap()
        .into_rgb8();
    let red = picture
        .pixels()
        .filter(|p| u32::from(p[0]) > 2 * u32::from(p[2]));
    let body = picture.pixels().filter(|p| p[2] < 240).count();
    let share = red.count() as f64 / body as f64;
    assert!((0.1..0.9).contains(&share), "{share}");
    for flag in ["--close-holes", "--join", "--crumbs"] {
        let wrong = seedfill(&[&words[..], &[flag, "-1"]].concat());
        assert_eq!(wrong.status.code(), Some(2));
        assert!(
            text(&wrong.stderr).contains(flag),
            "{}",
            text(&wrong.stderr)
        );
    }
}

/// The numbers of one mesh read as micrometres, millimetres and centimetres, 9 um to 9 cm: the same spheres, figures and cost in the unit of
/// the mesh. A factor of ten changes the last bit of a coordinate, which a fit by least squares does not enlarge much: 1e-6.
#[test]
fn a_body_is_filled_alike_in_every_unit() {
    let mesh = fixture("cotton_flat.stl");
    let filled = |unit: &str| {
        let words = ["--radius", "0.3", "--method", "surface", "--count", "10"];
        let more = ["--density", "1000", "--json", "--quiet", "--unit", unit];
        let output = seedfill(&[&[path_text(&mesh)][..], &words, &more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json = json_of(&output);
        let spheres = json["sphere_list"].as_array().unwrap().iter();
        let coordinates = spheres.flat_map(|sphere| sphere.as_array().unwrap());
        let figures = ["surface_rms", "surface_hausdorff", "union_fraction"];
        let figures = figures.iter().map(|key| &json["fit"][key]);
        let cost = [
            &json["cost"]["near_pairs_per_contact"],
            &json["connections"]["contacts"],
        ];
        let numbers = coordinates.chain(figures).chain(cost);
        numbers
            .map(|number| number.as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    let usual = filled("mm");
    for unit in ["um", "cm"] {
        let other = filled(unit);
        assert_eq!(other.len(), usual.len());
        for (a, b) in usual.iter().zip(other) {
            assert!((a - b).abs() < 1e-6, "{unit}: {b} instead of {a}");
        }
    }
}

/// Files are limited to some kilobytes, so that picture and page cannot be written: table and JSON are there all the same, the
/// JSON and standard error say what is missing, and the exit code is that of an error.
#[cfg(unix)]
#[test]
fn a_picture_that_cannot_be_written_loses_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let limited = "trap '' XFSZ; ulimit -f 24; exec \"$0\" \"$@\"";
    let output = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_seedfill")])
        .args([path_text(&fixture("cotton_flat.stl")), "--radius", "0.8"])
        .args(["--method", "favier", "--count", "3", "--quiet"])
        .args(["--out", path_text(&file("a.csv"))])
        .args(["--preview", path_text(&file("a.png"))])
        .args(["--html", path_text(&file("a.html"))])
        .args(["--json", path_text(&file("a.json"))])
        .output()
        .expect("a shell");
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    for name in ["a.png is not written", "a.html is not written"] {
        assert!(told.contains(name), "{told}");
    }
    let table = std::fs::read_to_string(file("a.csv")).unwrap();
    assert_eq!(table.lines().count(), 4);
    let json = std::fs::read_to_string(file("a.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["spheres"], 3);
    let warnings = json["warnings"].to_string();
    assert_eq!(warnings.matches("is not written").count(), 2, "{warnings}");
    assert!(!file("a.png").exists() && !file("a.html").exists());
}

/// A cell of the surface of the spheres that is too small ends neither the table nor the JSON.
#[test]
fn a_surface_that_cannot_be_made_loses_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, stl) = (folder.path().join("a.csv"), folder.path().join("a.stl"));
    let mesh = fixture("cotton_flat.stl");
    let words = [
        path_text(&mesh),
        "--radius",
        "1.2",
        "--method",
        "favier",
        "--json",
    ];
    let files = ["--out", path_text(&csv), "--union", path_text(&stl)];
    let output = seedfill(&[&words[..], &files, &["--union-cell", "0.001um"]].concat());
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("a.stl is not written") && told.contains("--union-cell"),
        "{told}"
    );
    let json = json_of(&output);
    assert!(json["union_surface"].is_null());
    let rows = std::fs::read_to_string(&csv).unwrap().lines().count();
    assert_eq!(json["spheres"], rows - 1);
}

/// Spheres of a ball of 1 mm in a mesh of its size: read in the wrong unit they are measured with a warning whose flag, followed,
/// brings the right figures; one small sphere raises no question.
#[test]
fn spheres_in_another_unit_than_the_mesh_are_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("spheres.csv");
    let mesh = fixture("sphere.stl");
    let measured = |table: &str, more: &[&str]| {
        std::fs::write(&csv, table).unwrap();
        let words = [path_text(&mesh), "--spheres", path_text(&csv), "--json"];
        let output = Command::new(env!("CARGO_BIN_EXE_seedfill"))
            .args(words)
            .args(more)
            .output()
            .expect("the command starts");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json = json_of(&output);
        let share = json["fit"]["union_fraction"].as_f64().unwrap();
        (json["warnings"].to_string(), share)
    };
    let (none, right) = measured("0,0,0,1\n", &[]);
    assert_eq!(none, "[]");
    for (table, unit) in [
        ("0,0,0,1e-3\n", "m"),
        ("0,0,0,1000\n", "um"),
        ("0,0,0,0.1\n", "cm"),
    ] {
        let (warning, share) = measured(table, &[]);
        let flag = format!("(--spheres-unit {unit})");
        assert!(warning.contains(&flag), "{warning}");
        assert!((share / right - 1.0).abs() > 0.9);
        let (warning, share) = measured(table, &["--spheres-unit", unit]);
        assert_eq!(warning, "[]");
        assert!((share / right - 1.0).abs() < 1e-9);
    }
    // The numbers of the mesh are the wrong ones: both flags that the warning names.
    let (warning, _) = measured("0,0,0,1\n", &["--unit", "um", "--spheres-unit", "mm"]);
    assert!(
        warning.contains("(--unit mm --spheres-unit mm)"),
        "{warning}"
    );
    for table in ["0.5,0,0,0.02\n", "0,0,0,0.4\n"] {
        assert_eq!(measured(table, &[]).0, "[]", "{table}");
    }
    let (warning, _) = measured("9,0,0,1\n", &[]);
    assert!(warning.contains("beside the mesh"), "{warning}");
}

/// A radius without a unit is in the unit of the mesh: both are named with their flags, whichever is wrong.
#[test]
fn a_radius_in_another_unit_is_answered_with_unit_and_flag() {
    let mesh = fixture("cotton_flat.stl");
    for (words, code) in [
        (["--radius", "0.00045", "--unit", "mm"], 2),
        (["--radius", "450", "--unit", "mm"], 1),
        (["--radius", "0.45mm", "--unit", "um"], 1),
    ] {
        let output = seedfill(&[&[path_text(&mesh)][..], &words, &["--quiet"]].concat());
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(
            told.contains(&format!("--unit, now {}", words[3])),
            "{told}"
        );
        assert!(told.contains("--radius 0.45mm"), "{told}");
    }
}

/// The example of the help, word for word, on a mesh of that name: it fills, and both files are there.
#[test]
fn the_example_of_the_help_runs() {
    let help = text(&seedfill(&["--help"]).stdout);
    let (_, example) = help.split_once("Example:\n  seedfill ").unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(fixture("cotton_flat.stl"), folder.path().join("seed.stl")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_seedfill"))
        .args(["--effort", "0.05"])
        .args(example.trim().split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for file in ["seed.csv", "seed.png"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
}

/// Two spheres of 1.5 mm hold 28.27 of the 93.00 mm3 of the flat seed, 30 %: told, with the ways out, unless a number was asked for.
#[test]
fn equal_spheres_that_reach_little_of_the_volume_are_told() {
    let mesh = fixture("cotton_flat.stl");
    let warnings = |words: &[&str]| {
        let output = seedfill(&[&[path_text(&mesh), "--json"][..], words].concat());
        json_of(&output)["warnings"].to_string()
    };
    let said = warnings(&["--radius", "1.5"]);
    assert!(
        said.contains("30 % of the volume") && said.contains("--method surface"),
        "{said}"
    );
    for words in [
        &["--radius", "1.5", "--count", "2"][..],
        &["--radius", "0.6"],
        &["--radius", "1.2", "--method", "smooth", "--count", "2"],
    ] {
        let said = warnings(words);
        assert!(!said.contains("of the volume"), "{words:?} {said}");
    }
}
