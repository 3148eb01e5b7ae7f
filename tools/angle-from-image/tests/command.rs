//! The command as a user meets it: exit codes, text, JSON, overlays.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn photo(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/photos")
        .join(name)
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

/// The hand reading of the chord is 35.0 +- 0.8 degrees, of the middle 41.2 +- 1.0.
#[test]
fn a_good_photo_gives_its_angle_and_exit_code_0() {
    let good = photo(GOOD);
    let output = run(&[
        good.to_str().unwrap(),
        "--definition",
        "chord",
        "--json",
        "--quiet",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        (json["angle_deg"].as_f64().unwrap() - 35.0).abs() < 1.3,
        "{}",
        json["angle_deg"]
    );
    assert!(
        (json["mid_deg"].as_f64().unwrap() - 41.2).abs() < 1.5,
        "{}",
        json["mid_deg"]
    );
    assert_eq!(json["angle_deg"], json["chord_deg"]);
    assert!(output.stderr.is_empty(), "quiet says nothing");
}

/// The table of the same pictures as CSV and as workbook holds the same fields; a name that is no table of ours is CSV.
#[test]
fn the_table_may_be_a_workbook() {
    let folder = folder("workbook");
    let (good, refused) = (photo(GOOD), photo(REFUSED));
    let tables = ["angles.csv", "angles.xlsx"].map(|name| {
        let file = folder.join(name);
        let output = run(&[
            good.to_str().unwrap(),
            refused.to_str().unwrap(),
            "--csv",
            file.to_str().unwrap(),
        ]);
        assert_eq!(output.status.code(), Some(1), "one is refused");
        table_file::read(&file).unwrap()
    });
    assert!(
        std::fs::read(folder.join("angles.xlsx"))
            .unwrap()
            .starts_with(b"PK")
    );
    assert_eq!(tables[0].header(), tables[1].header());
    for (row, expected) in tables[1].rows().iter().zip(tables[0].rows()) {
        for (column, name) in tables[0].header().iter().enumerate() {
            let (found, expected) = (row.text(column), expected.text(column));
            let alike = found == expected || found.parse::<f64>() == expected.parse::<f64>();
            assert!(alike, "{name}: {found} is not {expected}");
        }
    }
}

/// The completion and the man page know the flags, and the example of the help is understood: the folder that it names is
/// missing, but no word of it is wrong.
#[test]
fn completion_man_page_and_example_fit_the_flags() {
    for kind in [
        "complete-bash",
        "complete-zsh",
        "complete-fish",
        "complete-powershell",
        "man",
    ] {
        let output = run(&["--generate", kind]);
        assert_eq!(output.status.code(), Some(0), "{kind}");
        assert!(text(&output.stdout).contains("overlay"), "{kind}");
    }
    let help = text(&run(&["--help"]).stdout);
    let (_, example) = help.split_once("Example:\n  angle-from-image ").unwrap();
    let words: Vec<&str> = example.trim().split(' ').collect();
    let output = run(&words);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("frames") && !told.contains("Usage:"),
        "{told}"
    );
}

/// Scripts rely on these keys.
#[test]
fn json_has_the_promised_keys() {
    let (good, refused) = (photo(GOOD), photo(REFUSED));
    let output = run(&["--json", good.to_str().unwrap(), refused.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1), "one is refused");
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        json["version"].is_string() && json["seed"].is_null(),
        "where it comes from"
    );
    assert_eq!(json["inputs"].as_object().unwrap().len(), 2);
    let image = &json["images"][0];
    for key in [
        "angle_deg",
        "angle_se_deg",
        "line_deg",
        "chord_deg",
        "mid_deg",
        "curvature",
        "quality",
    ] {
        assert!(image[key].is_f64(), "{key} is {}", image[key]);
    }
    assert_eq!(image["verdict"], "ok");
    assert!(image["reason"].is_null(), "no reason");
    assert_eq!(image["high_side"], "left");
    for key in ["cx", "cy", "r"] {
        assert!(image["drum"][key].is_f64(), "drum {key}");
    }
    let refused = &json["images"][1];
    assert_eq!(refused["verdict"], "refused");
    assert!(
        refused["reason"].as_str().unwrap().contains("drum"),
        "{}",
        refused["reason"]
    );
    assert!(refused["angle_deg"].is_null(), "no number for a refusal");
    assert!(
        refused["file"].as_str().unwrap().ends_with(REFUSED),
        "{}",
        refused["file"]
    );
    let summary = &json["summary"];
    assert_eq!(
        (summary["n"].as_u64(), summary["refused"].as_u64()),
        (Some(1), Some(1))
    );
    assert_eq!(summary["mean_deg"], image["angle_deg"]);
    for key in ["sd_deg", "se_deg"] {
        assert!(summary[key].is_null(), "{key} of one picture");
    }
}

/// A picture has hundreds of points of 2 numbers, told twice: without them its JSON is smaller by far more than 20 kB, and below
/// 8 kB, which is some 100 lines with a name. The points of a refused surface come with the others.
#[test]
fn points_are_in_the_json_on_request() {
    let good = photo(GOOD);
    let words = [good.to_str().unwrap(), "--json"];
    let plain = run(&words).stdout;
    let full = run(&[&words[..], &["--points"]].concat()).stdout;
    assert!(
        plain.len() < 8000 && full.len() > plain.len() + 20_000,
        "{} {}",
        plain.len(),
        full.len()
    );
    let [plain, full] = [plain, full].map(|json| serde_json::from_slice::<Value>(&json).unwrap());
    assert!(plain["surface"].is_null() && plain["images"][0]["surface"].is_null());
    let surface = full["surface"].as_array().unwrap();
    assert!(surface.len() > 100, "surface points");
    assert_eq!(surface[0].as_array().unwrap().len(), 2);
    assert_eq!(full["images"][0]["surface"], full["surface"]);
    assert_eq!(plain["angle_deg"], full["angle_deg"]);
    let strict = [&words[..], &["--points", "--max-error-deg", "0.1"]].concat();
    let refused: Value = serde_json::from_slice(&run(&strict).stdout).unwrap();
    assert_eq!(refused["verdict"], "refused");
    assert_eq!(refused["surface"].as_array().unwrap().len(), 0);
    assert!(refused["surface_refused"].as_array().unwrap().len() > 100);
}

#[test]
fn a_refused_photo_exits_1_and_says_why() {
    let output = run(&[photo(REFUSED).to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stdout).contains("refused: no drum circle"),
        "{}",
        text(&output.stdout)
    );
}

/// A heap with flanks of 0.5 and 0.66 rad, 28.6 and 37.8 degrees, mean 33.2: both flanks, the apex
/// at (450, 180) px and the mean are in the JSON. A drum is no heap.
#[test]
fn a_heap_gives_both_flanks_and_a_drum_none() {
    let folder = folder("heap");
    let path = folder.join("heap.png");
    photo_profile::synthetic::HeapScene {
        flanks: [0.5, 0.66],
        rounding: 0.005,
        ..photo_profile::synthetic::HeapScene::default()
    }
    .draw()
    .save(&path)
    .unwrap();
    let overlay = folder.join("overlay.png");
    let output = run(&[
        path.to_str().unwrap(),
        "--mode",
        "heap",
        "--json",
        "--overlay",
        overlay.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(overlay.exists(), "the overlay is written");
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    for (value, expected, tolerance) in [
        (&json["angle_deg"], 33.23, 0.1),
        (&json["heap"]["left_deg"], 28.65, 0.1),
        (&json["heap"]["right_deg"], 37.82, 0.1),
        (&json["heap"]["apex"][0], 450.0, 2.0),
        (&json["heap"]["apex"][1], 180.0, 3.0),
    ] {
        assert!(
            (number(value) - expected).abs() < tolerance,
            "{value} for {expected}"
        );
    }
    let drum = photo(GOOD);
    let output = run(&[drum.to_str().unwrap(), "--mode", "heap"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
}

/// A heap whose foot spreads, by a camera 12 degrees above it that leans by 2: the words name bend, lean and elevation with the
/// flags that take them off, and with these flags the mean of the upper halves comes back (a drawn heap of 32.1 degrees; half a pixel over half a flank is 0.3).
#[test]
fn what_a_heap_shows_of_its_foot_and_its_camera_is_told() {
    let folder = folder("leaning heap");
    let (spread, above) = (folder.join("spread.png"), folder.join("above.png"));
    let plain = photo_profile::synthetic::HeapScene {
        tones: [60.0, 210.0, 210.0],
        rounding: 0.005,
        ..photo_profile::synthetic::HeapScene::default()
    };
    let with_foot = photo_profile::synthetic::HeapScene {
        spread: 0.5,
        ..plain
    };
    with_foot.draw().save(&spread).unwrap();
    let from_above = photo_profile::synthetic::HeapScene {
        lean: 2.0_f64.to_radians(),
        elevation: 12.0_f64.to_radians(),
        ..plain
    };
    from_above.draw().save(&above).unwrap();
    let (spread, above) = (spread.to_str().unwrap(), above.to_str().unwrap());
    let output = run(&[spread, "--mode", "heap"]);
    let told = text(&output.stdout);
    assert!(told.contains("left flank bent from"), "{told}");
    let output = run(&[above, "--mode", "heap"]);
    let told = text(&output.stdout);
    assert!(told.contains("--camera-elevation-deg"), "{told}");
    let flags = ["--camera-elevation-deg", "12", "--camera-roll-deg", "2"];
    let output = run(&[&[above, "--mode", "heap", "--json"][..], &flags].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mean = json["angle_deg"].as_f64().unwrap();
    assert!((mean - 32.09).abs() < 0.3, "{mean}");
    let seen = json["heap"]["elevation_seen_deg"].as_f64().unwrap();
    assert!((seen - 12.0).abs() < 1.0, "{seen}");
    let output = run(&[&[above, "--mode", "heap"][..], &flags].concat());
    let told = text(&output.stdout);
    assert!(
        !told.contains("--camera-"),
        "nothing is left to take off: {told}"
    );
    // A drum is seen along its axis.
    let output = run(&[above, "--camera-elevation-deg", "12"]);
    assert_eq!(output.status.code(), Some(2));
    let told = text(&output.stderr);
    assert!(told.contains("camera elevation"), "{told}");
}

#[test]
fn what_cannot_be_read_or_meant_exits_2() {
    let folder = folder("unreadable");
    let cut = folder.join("cut.jpg");
    let whole = std::fs::read(photo("granudrum_mccA_inverted.jpg")).unwrap();
    std::fs::write(&cut, &whole[..8000]).unwrap();
    let good = photo(GOOD);
    let good = good.to_str().unwrap();
    let cases: [(&[&str], &str); 5] = [
        (&[cut.to_str().unwrap()], "cut off"),
        (&["no-such-photo.png"], "cannot read"),
        (&[good, "--drum", "1,2"], "3 finite numbers"),
        (&[good, "--drum", "10,10,NaN"], "3 finite numbers"),
        (&[good, "--camera-roll-deg", "200"], "camera roll"),
    ];
    for (arguments, expected) in cases {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?} has no result");
    }
}

#[test]
fn an_overlay_is_written_once_and_replaced_only_by_force() {
    let good = photo(GOOD);
    let out = folder("overlay").join("out.png");
    let arguments = [
        good.to_str().unwrap(),
        "--overlay",
        out.to_str().unwrap(),
        "--quiet",
    ];
    assert_eq!(run(&arguments).status.code(), Some(0));
    let drawn = image::open(&out).unwrap().to_rgb8();
    assert_eq!(drawn.dimensions(), (406, 406));
    let green = drawn.pixels().filter(|p| p.0 == [0, 200, 60]).count();
    assert!(green > 300, "{green} green pixels of the surface");
    assert_eq!(
        run(&arguments).status.code(),
        Some(2),
        "not without --force"
    );
    let forced: Vec<&str> = arguments.iter().copied().chain(["--force"]).collect();
    assert_eq!(run(&forced).status.code(), Some(0));
}

#[test]
fn a_folder_is_measured_as_a_series() {
    let frames = folder("series");
    for k in 0..3 {
        std::fs::copy(photo(GOOD), frames.join(format!("frame-{k}.bmp"))).unwrap();
    }
    std::fs::write(frames.join("notes.txt"), "no picture").unwrap();
    let json_file = frames.join("out.json");
    let output = run(&[
        frames.to_str().unwrap(),
        "--json",
        json_file.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&std::fs::read(&json_file).unwrap()).unwrap();
    assert_eq!(json["summary"]["n"], 3);
    assert_eq!(json["summary"]["sd_deg"].as_f64(), Some(0.0));
    assert!(
        text(&output.stdout).contains("3 measured, 0 refused"),
        "{}",
        text(&output.stdout)
    );
    let empty = folder("no-pictures");
    assert_eq!(
        run(&[empty.to_str().unwrap()]).status.code(),
        Some(2),
        "nothing to measure"
    );
}

/// One cut and one foreign file among two good ones: both are named with their reason, nothing is
/// lost, and the exit code says that not all was measured. Where nothing could be read it is 2.
#[test]
fn a_bad_file_in_a_folder_does_not_cost_the_others() {
    let frames = folder("mixed");
    for name in ["a.bmp", "d.bmp"] {
        std::fs::copy(photo(GOOD), frames.join(name)).unwrap();
    }
    let whole = std::fs::read(photo("granudrum_mccA_inverted.jpg")).unwrap();
    std::fs::write(frames.join("b.jpg"), &whole[..8000]).unwrap();
    std::fs::write(frames.join("c.png"), "no picture").unwrap();
    let output = run(&[frames.to_str().unwrap(), "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let verdicts: Vec<&str> = json["images"]
        .as_array()
        .unwrap()
        .iter()
        .map(|image| image["verdict"].as_str().unwrap())
        .collect();
    assert_eq!(verdicts, ["ok", "error", "error", "ok"]);
    for (index, name, reason) in [(1, "b.jpg", "cut off"), (2, "c.png", "cannot decode")] {
        let image = &json["images"][index];
        assert!(image["file"].as_str().unwrap().ends_with(name), "{image}");
        assert!(
            image["reason"].as_str().unwrap().contains(reason),
            "{image}"
        );
        assert!(image["angle_deg"].is_null(), "no number for an error");
    }
    let summary = &json["summary"];
    let counts = ["n", "refused", "unread"].map(|key| summary[key].as_u64());
    assert_eq!(counts, [Some(2), Some(0), Some(2)]);
    let plain = run(&[frames.to_str().unwrap()]);
    let said = text(&plain.stdout);
    assert!(
        said.contains("c.png: error:") && said.contains("2 measured, 0 refused, 2 not read"),
        "{said}"
    );
    for name in ["a.bmp", "d.bmp"] {
        std::fs::remove_file(frames.join(name)).unwrap();
    }
    assert_eq!(
        run(&[frames.to_str().unwrap()]).status.code(),
        Some(2),
        "nothing could be read"
    );
}

/// Eight pictures that rise by 1 degree each and fall back, five times: at 20 pictures a second avalanches of 7 degrees that
/// come every 0.4 s; the reading of a drawn picture of this size is good to 0.2 degrees. Without the rate nothing is told of
/// time.
#[test]
fn pictures_at_a_rate_tell_avalanches() {
    let folder = folder("rate");
    for k in 0..44 {
        let scene = photo_profile::synthetic::Scene {
            size: 240,
            radius: 112.0,
            inclination: (30.0 + f64::from((k + 3) % 8)).to_radians(),
            ..photo_profile::synthetic::Scene::default()
        };
        let file = folder.join(format!("{k:02}.png"));
        scene.draw().save(file).unwrap();
    }
    let observables = |more: &[&str]| -> Value {
        let all = [&[folder.to_str().unwrap(), "--json", "--quiet"], more].concat();
        let output = run(&all);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        json["summary"]["observables"].clone()
    };
    let told = observables(&["--fps", "20"]);
    let mean = |name: &str| told[name]["mean"].as_f64().unwrap_or(f64::NAN);
    assert!((mean("avalanche_size_deg") - 7.0).abs() < 0.3, "{told}");
    assert!(
        (mean("avalanche_waiting_time_s") - 0.4).abs() < 0.01,
        "{told}"
    );
    assert!((mean("avalanche_start_deg") - 37.0).abs() < 0.3, "{told}");
    assert!((mean("avalanche_stop_deg") - 30.0).abs() < 0.3, "{told}");
    assert!(told["shape_4"]["mean"].is_f64(), "{told}");
    assert!(observables(&[])["avalanche_size_deg"].is_null());
    let output = run(&[folder.to_str().unwrap(), "--fps", "0"]);
    assert_eq!(output.status.code(), Some(2));
}

/// A measured, a refused and an unread picture at 4 a second: a row each, times of 0, 0.25 and 0.5 s, the numbers of the JSON
/// to the bit and reasons in words. A heap has columns of its own.
#[test]
fn a_table_has_a_row_for_every_picture() {
    let folder = folder("table");
    std::fs::copy(photo(GOOD), folder.join("a.bmp")).unwrap();
    std::fs::copy(photo(REFUSED), folder.join("b.jpg")).unwrap();
    std::fs::write(folder.join("c.png"), "no picture").unwrap();
    let table = folder.join("angles.csv");
    let words = [folder.to_str().unwrap(), "--fps", "4", "--json", "--csv"];
    let output = run(&[&words[..], &[table.to_str().unwrap()]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = table_of(&table);
    assert_eq!(rows.len(), 3);
    for (k, (verdict, reason)) in [("ok", ""), ("refused", "no drum"), ("error", "decode")]
        .into_iter()
        .enumerate()
    {
        let (row, image) = (&rows[k], &json["images"][k]);
        assert_eq!(row["verdict"], verdict);
        assert!(row["reason"].contains(reason), "{row:?}");
        assert_eq!(row["time_s"].parse::<f64>().unwrap(), k as f64 * 0.25);
        assert_eq!(image["time_s"].as_f64(), Some(k as f64 * 0.25));
        for (column, key) in [
            ("angle_deg", "angle_deg"),
            ("standard_error_deg", "angle_se_deg"),
        ] {
            assert_eq!(row[column].parse().ok(), image[key].as_f64(), "{column}");
        }
    }
    let heap = folder.join("heap.png");
    let scene = photo_profile::synthetic::HeapScene::default();
    scene.draw().save(&heap).unwrap();
    let heaps = folder.join("heaps.csv");
    let words = [heap.to_str().unwrap(), "--mode", "heap", "--json", "--csv"];
    let output = run(&[&words[..], &[heaps.to_str().unwrap()]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = table_of(&heaps);
    assert_eq!(
        rows[0]["left_deg"].parse().ok(),
        json["heap"]["left_deg"].as_f64()
    );
    assert!(!rows[0].contains_key("chord_deg") && !rows[0].contains_key("time_s"));
    let onto = run(&[
        heap.to_str().unwrap(),
        "--force",
        "--csv",
        heap.to_str().unwrap(),
    ]);
    assert_eq!(onto.status.code(), Some(2), "a picture is not replaced");
    assert!(text(&onto.stderr).contains("is a picture to be read"));
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

/// A binarised bed in a tenth of a drum whose rim does not show, 30 degrees steep: refused for want of a drum, with a flag in
/// the message that, pasted, gives the drawn angle within its interval. Coarse grains in a drum that shows: the
/// flag allows for their error. A blank picture has words only.
#[test]
fn a_refusal_names_the_flag_to_go_on_with() {
    use photo_profile::synthetic::Scene;
    let folder = folder("advice");
    let low = Scene {
        size: 400,
        radius: 172.0,
        height: -0.7,
        inclination: 30.0_f64.to_radians(),
        grain: [12.0, 7.0],
        bed: 0.0,
        air: 255.0,
        outside: 255.0,
        rim: 255.0,
        rim_width: 0.0,
        ..Scene::default()
    };
    let coarse = Scene {
        grain: [30.0, 20.0],
        inclination: 30.0_f64.to_radians(),
        ..Scene::default()
    };
    for (name, scene, more, reason) in [
        ("low.png", low, [].as_slice(), "no drum"),
        (
            "coarse.png",
            coarse,
            &["--max-error-deg", "0.1"],
            "too rough",
        ),
    ] {
        let file = folder.join(name);
        let mut picture = scene.draw();
        for pixel in picture.pixels_mut().filter(|_| name == "low.png") {
            pixel.0[0] = if pixel.0[0] < 128 { 0 } else { 255 };
        }
        picture.save(&file).unwrap();
        let words = [&[file.to_str().unwrap(), "--json"], more].concat();
        let refused: Value = serde_json::from_slice(&run(&words).stdout).unwrap();
        assert!(
            refused["reason"].as_str().unwrap().contains(reason),
            "{refused}"
        );
        let flag = refused["advice_flag"].as_str().unwrap();
        let said = text(&run(&[&[file.to_str().unwrap()], more].concat()).stdout);
        assert!(said.contains(flag), "{said}");
        let pasted: Vec<&str> = [file.to_str().unwrap(), "--json"]
            .into_iter()
            .chain(flag.split(' '))
            .collect();
        let output = run(&pasted);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(0), "{flag}: {}", json["reason"]);
        let ends = [0, 1].map(|k| json["angle_interval_deg"][k].as_f64().unwrap());
        assert!(ends[0] < 30.0 && 30.0 < ends[1], "{ends:?} by {flag}");
    }
    let blank = folder.join("blank.png");
    image::GrayImage::from_pixel(300, 200, image::Luma([99]))
        .save(&blank)
        .unwrap();
    let said = text(&run(&[blank.to_str().unwrap()]).stdout);
    assert!(said.contains("--drum CX,CY,R"), "{said}");
}

/// A page of a measured, a refused and an unread file, whose names are markup: everything is in the page, nothing is markup
/// but the page's own, each picture that was read shows the blue circle that was found (2 px round the drum, blurred by
/// JPEG), and a refused one says how to go on before it says why.
#[test]
fn a_page_shows_every_picture_and_how_to_go_on() {
    use base64::Engine as _;
    let folder = folder("page");
    let names = ["a<img src=x onerror=y>&\".bmp", "b.jpg", "c.png"];
    std::fs::copy(photo(GOOD), folder.join(names[0])).unwrap();
    std::fs::copy(photo(REFUSED), folder.join(names[1])).unwrap();
    std::fs::write(folder.join(names[2]), "no picture").unwrap();
    let page = folder.join("page.html");
    let output = run(&[
        folder.to_str().unwrap(),
        "--quiet",
        "--html",
        page.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'"));
    for outside in ["http:", "https:", "url(", "<img src=x", "<link"] {
        let own = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(outside), "{outside}");
    }
    assert!(page.contains("a&lt;img src=x onerror=y&gt;&amp;"));
    assert!(page.contains("1 measured, 1 refused, 1 not read."));
    let place = |words: &str| {
        page.find(words)
            .unwrap_or_else(|| panic!("{words} is missing"))
    };
    assert!(
        place("How to go on") < place("<pre>--drum ")
            && place("<pre>--drum ") < place("Refused: no drum")
    );
    assert!(place("Not read: cannot decode") < place("</span> Measured pictures"));
    let pictures: Vec<&str> = page.split("data:image/jpeg;base64,").skip(1).collect();
    assert_eq!(pictures.len(), 2);
    for picture in pictures {
        let data = picture.split('"').next().unwrap();
        let bytes = base64::engine::general_purpose::STANDARD
            .decode(data)
            .unwrap();
        let drawn = image::load_from_memory(&bytes).unwrap().to_rgb8();
        let is_blue = |p: &&image::Rgb<u8>| p.0[2] > 180 && p.0[0] < 120 && p.0[1] < 170;
        let blue = drawn.pixels().filter(is_blue).count();
        assert!(blue > 500, "{blue} blue pixels of the circle");
        assert!(drawn.width().max(drawn.height()) <= 800);
    }
}

/// A microscope writes TIFF and a browser WebP: both keep every pixel here, so each gives the angle of the PNG to the bit. What
/// is left out of a folder is named.
#[test]
fn tiff_and_webp_in_a_folder_are_read_and_what_is_skipped_is_named() {
    let folder = folder("formats");
    let drawn = photo_profile::synthetic::Scene {
        size: 240,
        radius: 112.0,
        ..photo_profile::synthetic::Scene::default()
    }
    .draw();
    drawn.save(folder.join("a.png")).unwrap();
    drawn.save(folder.join("b.tif")).unwrap();
    let colour = image::DynamicImage::from(drawn).into_rgb8();
    colour.save(folder.join("c.webp")).unwrap();
    std::fs::write(folder.join("film.avi"), "no picture").unwrap();
    let output = run(&[folder.to_str().unwrap(), "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let angles: Vec<f64> = (0..3)
        .map(|k| json["images"][k]["angle_deg"].as_f64().unwrap())
        .collect();
    assert!(angles.iter().all(|a| *a == angles[0]), "{angles:?}");
    let skipped = json["skipped"].as_array().unwrap();
    assert_eq!(skipped.len(), 1);
    assert!(skipped[0].as_str().unwrap().ends_with("film.avi"));
    let plain = run(&[folder.to_str().unwrap()]);
    let said = text(&plain.stdout);
    assert!(
        said.contains("skipped") && said.contains("film.avi"),
        "{said}"
    );
}
