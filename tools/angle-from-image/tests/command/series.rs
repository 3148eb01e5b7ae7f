//! Folders and series.

use super::{GOOD, folder, photo, run, text};
use dev_support::drawn_pictures::save;
use serde_json::Value;

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
/// lost, and the exit code says that not all was measured. If nothing could be read it is 2.
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
/// come every 0.4 s; the reading of a drawn picture of this size is good to 0.2 degrees. Without the rate nothing is reported of
/// time.
#[test]
fn pictures_at_a_rate_tell_avalanches() {
    let folder = folder("rate");
    for k in 0..44 {
        let scene = dev_support::drawn_pictures::Scene {
            size: 240,
            radius: 112.0,
            inclination: (30.0 + f64::from((k + 3) % 8)).to_radians(),
            ..dev_support::drawn_pictures::Scene::default()
        };
        let file = folder.join(format!("{k:02}.png"));
        save(scene.draw(), file).unwrap();
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

/// A microscope writes TIFF and a browser WebP: both keep every pixel here, so each gives the angle of the PNG to the bit. What
/// is left out of a folder is named.
#[test]
fn tiff_and_webp_in_a_folder_are_read_and_what_is_skipped_is_named() {
    let folder = folder("formats");
    let drawn = dev_support::drawn_pictures::Scene {
        size: 240,
        radius: 112.0,
        ..dev_support::drawn_pictures::Scene::default()
    }
    .draw();
    save(drawn.clone(), folder.join("a.png")).unwrap();
    save(drawn.clone(), folder.join("b.tif")).unwrap();
    let colour = image::DynamicImage::from(drawn).into_rgb8();
    save(colour, folder.join("c.webp")).unwrap();
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
        said.contains("left out") && said.contains("film.avi"),
        "{said}"
    );
}

/// Overlays written into the folder of the photos are not photos the second time, and the first result comes back; what was left
/// out is reported.
#[test]
fn overlays_in_the_folder_of_the_photos_are_left_out() {
    let folder = folder("own overlays");
    for (name, inclination) in [("1.png", 0.5), ("2.png", 0.6)] {
        let scene = dev_support::drawn_pictures::Scene {
            size: 240,
            radius: 112.0,
            inclination,
            ..dev_support::drawn_pictures::Scene::default()
        };
        let colours = image::DynamicImage::from(scene.draw()).into_rgb8();
        save(colours, folder.join(name)).unwrap();
    }
    let (place, overlay) = (folder.to_str().unwrap(), folder.join("overlay.png"));
    let measured = |arguments: &[&str]| -> Value {
        let output = run(&[&[place, "--json", "--quiet"], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let first = measured(&["--overlay", overlay.to_str().unwrap()]);
    assert!(folder.join("overlay-002.png").exists());
    let second = measured(&[]);
    assert_eq!(first["summary"], second["summary"]);
    assert_eq!(second["skipped"].as_array().unwrap().len(), 2);
    let said = text(&run(&[place]).stdout);
    assert!(
        said.contains("2 overlays of this program (overlay-001.png"),
        "{said}"
    );
}

/// One of four pictures of a bed at 34.4 degrees is turned by a quarter: it is measured as 55.6 and named in text, JSON and table.
/// The others are not.
#[test]
fn a_picture_on_its_side_is_named() {
    let folder = folder("sideways");
    let drawn = dev_support::drawn_pictures::Scene {
        size: 240,
        radius: 112.0,
        inclination: 0.6,
        ..dev_support::drawn_pictures::Scene::default()
    }
    .draw();
    for name in ["a.png", "b.png", "d.png"] {
        save(drawn.clone(), folder.join(name)).unwrap();
    }
    save(image::imageops::rotate90(&drawn), folder.join("c.png")).unwrap();
    let table = folder.join("table.csv");
    let place = folder.to_str().unwrap();
    let output = run(&[place, "--csv", table.to_str().unwrap()]);
    let said = text(&output.stdout);
    assert!(said.contains("c.png: may lie on its side"), "{said}");
    let warned: Vec<bool> = super::table_of(&table)
        .iter()
        .map(|row| !row["warning"].is_empty())
        .collect();
    assert_eq!(warned, [false, false, true, false]);
}
