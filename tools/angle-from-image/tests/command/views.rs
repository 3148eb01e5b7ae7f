//! Which part of a picture is looked at, and which way is level in it.

use super::{folder, run, text};
use dev_support::drawn_pictures::{Scene, save};
use image::{GrayImage, Luma, imageops};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A drum of 300 px whose surface stands at an angle, degrees.
fn drum(angle_deg: f64) -> Scene {
    Scene {
        size: 300,
        radius: 130.0,
        inclination: angle_deg.to_radians(),
        blur: 1.0,
        noise: 4.0,
        ..Scene::default()
    }
}

/// The JSON of one picture with further words.
fn read(path: &Path, words: &[&str]) -> Value {
    let output = run(&[&[path.to_str().unwrap(), "--json", "--points"], words].concat());
    assert!(output.status.code() < Some(2), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Two drums of 30 and 40 degrees side by side: each region is read as the same pixels in a file of their own, with circle and
/// points in the pixels of the whole picture, and the circle that was found can be stated: all to rounding.
#[test]
fn a_region_is_measured_alone_in_the_pixels_of_the_whole() {
    let folder = folder("region");
    let path = folder.join("two.png");
    let mut both = GrayImage::from_pixel(640, 320, Luma([120]));
    for (angle, left) in [(30.0, 10), (40.0, 330)] {
        let alone = drum(angle).draw();
        save(alone.clone(), folder.join(format!("{left}.png"))).unwrap();
        imageops::replace(&mut both, &alone, left, 10);
    }
    save(both, &path).unwrap();
    for left in [10.0, 330.0] {
        let alone = read(&folder.join(format!("{left}.png")), &[]);
        let region = format!("{left},10,300,300");
        let json = read(&path, &["--region", &region]);
        let differs = |key: &str| json[key].as_f64().unwrap() - alone[key].as_f64().unwrap();
        assert!(differs("angle_deg").abs() < 1e-9, "{left}");
        let moved =
            |key: &str| json["drum"][key].as_f64().unwrap() - alone["drum"][key].as_f64().unwrap();
        assert!((moved("cx") - left).abs() < 1e-9 && (moved("cy") - 10.0).abs() < 1e-9);
        let points = [&json, &alone].map(|json| json["surface"].as_array().unwrap());
        assert_eq!(points[0].len(), points[1].len());
        for (point, alone) in points[0].iter().zip(points[1]) {
            let moved = |axis: usize| point[axis].as_f64().unwrap() - alone[axis].as_f64().unwrap();
            assert!((moved(0) - left).abs() < 1e-9 && (moved(1) - 10.0).abs() < 1e-9);
        }
        let [x, y, r] = ["cx", "cy", "r"].map(|key| json["drum"][key].as_f64().unwrap());
        let stated = read(
            &path,
            &["--region", &region, "--drum", &format!("{x},{y},{r}")],
        );
        let off = stated["angle_deg"].as_f64().unwrap() - json["angle_deg"].as_f64().unwrap();
        assert!(off.abs() < 1e-9, "{off}");
    }
    // Which of the two is meant, nothing says; either flag of the advice does.
    let json = read(&path, &[]);
    assert_eq!(json["verdict"], "refused");
    let advice = json["advice"].as_str().unwrap();
    let mut angles: Vec<f64> = Vec::new();
    for circle in advice.split("--drum ").skip(1) {
        let circle = circle.split(' ').next().unwrap();
        let json = read(&path, &["--drum", circle]);
        angles.push(json["angle_deg"].as_f64().unwrap());
    }
    angles.sort_by(f64::total_cmp);
    assert!(angles.len() == 2 && (angles[0] - 30.0).abs() < 0.2 && (angles[1] - 40.0).abs() < 0.2);
    for region in ["600,0,100,100", "0,0,0,10", "5,5,10"] {
        let output = run(&[path.to_str().unwrap(), "--region", region]);
        assert_eq!(output.status.code(), Some(2), "{region}");
    }
}

/// A bright clamp of an eighth of the drum across the lower half of a surface: it turns the line by degrees. Behind a mask the angle is
/// the one without it, to 0.3 degrees: an eighth of the points is gone. A mask of another size, or of nothing but black, is an
/// error.
#[test]
fn what_a_mask_hides_does_not_count() {
    let folder = folder("mask");
    let (path, mask) = (folder.join("clamp.png"), folder.join("mask.png"));
    let mut picture = drum(35.0).draw();
    let mut seen = GrayImage::from_pixel(300, 300, Luma([255]));
    for y in 150..270 {
        for x in 60..95 {
            picture.put_pixel(x, y, Luma([205]));
            seen.put_pixel(x, y, Luma([0]));
        }
    }
    save(picture, &path).unwrap();
    save(seen, &mask).unwrap();
    let without = read(&path, &[]);
    let off = without["angle_deg"]
        .as_f64()
        .map_or(90.0, |a| (a - 35.0).abs());
    assert!(off > 1.0, "the clamp does no harm: {off}");
    let json = read(&path, &["--mask", mask.to_str().unwrap()]);
    let found = json["angle_deg"].as_f64().unwrap();
    assert!((found - 35.0).abs() < 0.3, "{found}");
    for point in json["surface"].as_array().unwrap() {
        let x = point[0].as_f64().unwrap();
        assert!(
            !(60.0..95.0).contains(&x),
            "a point under the mask: {point}"
        );
    }
    for (width, level) in [(299, 255), (300, 0)] {
        let wrong: PathBuf = folder.join("wrong.png");
        let mask = GrayImage::from_pixel(width, 300, Luma([level]));
        save(mask, &wrong).unwrap();
        let output = run(&[path.to_str().unwrap(), "--mask", wrong.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{width}");
        assert!(
            text(&output.stderr).contains("mask"),
            "{}",
            text(&output.stderr)
        );
    }
}

/// A camera turned by 3 degrees shows a surface of 35 degrees at 38; a plumb line (200 px down, 10.481 px aside) or a level
/// (200 px across, 10.481 px up) gives the turn: atan(10.481 / 200) = 3.000 degrees.
#[test]
fn a_plumb_line_or_a_level_tells_the_horizontal() {
    let path = folder("plumb").join("turned.png");
    save(drum(38.0).draw(), &path).unwrap();
    let as_is = read(&path, &[])["angle_deg"].as_f64().unwrap();
    for words in [
        ["--plumb-line", "50,20;60.481,220"],
        ["--level", "20,240;220,229.519"],
        ["--camera-roll-deg", "3"],
    ] {
        let json = read(&path, &words);
        let roll = json["camera_roll_deg"].as_f64().unwrap();
        assert!((roll - 3.0).abs() < 1e-3, "{words:?}: {roll}");
        let found = json["angle_deg"].as_f64().unwrap();
        assert!(
            (as_is - found - 3.0).abs() < 0.1,
            "{words:?}: {found} for {as_is}"
        );
    }
    let path = path.to_str().unwrap();
    for words in [
        &["--plumb-line", "0,0;200,10"][..],
        &["--level", "0,0;10,0"],
        &["--level", "0,0"],
        &["--level", "0,0;200,0", "--camera-roll-deg", "1"],
    ] {
        let output = run(&[&[path], words].concat());
        assert_eq!(output.status.code(), Some(2), "{words:?}");
    }
}

/// Seven of the points that the program finds, stated in any order, give its angle: 0.3 degrees are the noise of single points,
/// some 0.3 px of a drum of 130 px. The result says that the surface was stated. What cannot be is reported.
#[test]
fn a_surface_that_is_stated_has_the_angle_of_its_places() {
    let folder = folder("surface");
    let path = folder.join("drum.png");
    save(drum(35.0).draw(), &path).unwrap();
    let found = read(&path, &[]);
    assert!(found.get("surface_given").is_none());
    let points = found["surface"].as_array().unwrap();
    let mut places: Vec<String> = (0..7)
        .map(|k| &points[k * (points.len() - 1) / 6])
        .map(|point| format!("{},{}", point[0], point[1]))
        .collect();
    places.swap(1, 5);
    let stated = read(&path, &["--surface", &places.join(";")]);
    assert_eq!(stated["surface_given"], true);
    let angle = |json: &Value| json["angle_deg"].as_f64().unwrap();
    assert!((angle(&stated) - angle(&found)).abs() < 0.3);
    let error = stated["angle_se_deg"].as_f64().unwrap();
    assert!(error > 0.0 && error < 1.0, "{error}");
    let file = path.to_str().unwrap();
    for (words, what) in [
        (&[file, "--surface", "1,2;3,4"][..], "5 or more places"),
        (&[file, file, "--surface", &places.join(";")], "one picture"),
        (
            &[file, "--mode", "heap", "--surface", &places.join(";")],
            "--mode heap",
        ),
        (
            &[
                file,
                "--region",
                "0,0,200,200",
                "--surface",
                &places.join(";"),
            ],
            "--region",
        ),
    ] {
        let output = run(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let message = text(&output.stderr);
        assert!(message.contains(what), "{message}");
    }
}

/// Five places, a pixel or so off a line of 30 degrees, in a picture of 800 px: the interval is that of one degree of freedom, or of
/// pointing, and holds 30.
#[test]
fn few_places_on_a_surface_have_an_interval_that_says_so() {
    let folder = folder("few places");
    let path = folder.join("drum.png");
    save(
        image::GrayImage::from_pixel(800, 800, image::Luma([90])),
        &path,
    )
    .unwrap();
    let places = "130,244;265,322;400,401;535,480;670,558";
    let flags = ["--drum", "400,400,380", "--surface", places];
    let output = run(&[&[path.to_str().unwrap()], &flags[..]].concat());
    let said = text(&output.stdout);
    assert!(said.contains("with 1 degree of freedom"), "{said}");
    let output = run(&[&[path.to_str().unwrap(), "--json"], &flags[..]].concat());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["degrees_of_freedom"], 1);
    let interval = [0, 1].map(|k| json["angle_interval_deg"][k].as_f64().unwrap());
    assert!(interval[0] < 30.0 && interval[1] > 30.0, "{interval:?}");
    // One pixel at five places over 625 px along the line: 0.13 degrees.
    assert!(json["angle_se_deg"].as_f64().unwrap() > 0.1, "{interval:?}");
}
