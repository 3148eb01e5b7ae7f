//! Heaps.

use super::{GOOD, folder, photo, run, text};
use dev_support::drawn_pictures::save;
use serde_json::Value;

/// A heap with flanks of 0.5 and 0.66 rad, 28.6 and 37.8 degrees, mean 33.2: both flanks, the apex
/// at (450, 180) px and the mean, known to half of their difference, are in the JSON. A drum is not a heap.
#[test]
fn a_heap_gives_both_flanks_and_a_drum_none() {
    let folder = folder("heap");
    let path = folder.join("heap.png");
    let heap = dev_support::drawn_pictures::HeapScene {
        flanks: [0.5, 0.66],
        rounding: 0.005,
        ..dev_support::drawn_pictures::HeapScene::default()
    };
    save(heap.draw(), &path).unwrap();
    let overlay = folder.join("overlay.png");
    let output = run(&[
        path.to_str().unwrap(),
        "--mode",
        "heap",
        "--max-error-deg",
        "5",
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
    let plain = dev_support::drawn_pictures::HeapScene {
        tones: [60.0, 210.0, 210.0],
        rounding: 0.005,
        ..dev_support::drawn_pictures::HeapScene::default()
    };
    let with_foot = dev_support::drawn_pictures::HeapScene {
        spread: 0.5,
        ..plain
    };
    save(with_foot.draw(), &spread).unwrap();
    let from_above = dev_support::drawn_pictures::HeapScene {
        lean: 2.0_f64.to_radians(),
        elevation: 12.0_f64.to_radians(),
        ..plain
    };
    save(from_above.draw(), &above).unwrap();
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

/// Two heaps, of which one has flanks of 34.4 and 54.4 degrees, known to 10: it is refused by the limit and not in the mean, and
/// the summary says what it would change.
#[test]
fn a_heap_that_is_too_uncertain_enters_no_mean() {
    let folder = folder("uncertain heap");
    for (name, flanks) in [("a.png", [0.56, 0.56]), ("b.png", [0.6, 0.95])] {
        let heap = dev_support::drawn_pictures::HeapScene {
            width: 480,
            flanks,
            rounding: 0.005,
            ..dev_support::drawn_pictures::HeapScene::default()
        };
        save(heap.draw(), folder.join(name)).unwrap();
    }
    let output = run(&[folder.to_str().unwrap(), "--mode", "heap", "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["summary"]["n"], 1);
    let mean = json["summary"]["mean_deg"].as_f64().unwrap();
    assert!((mean - 32.09).abs() < 0.3, "{mean}");
    let refused = &json["images"][1];
    let reason = refused["reason"].as_str().unwrap();
    assert!(reason.contains("at most 3.0"), "{reason}");
    let flag = refused["advice_flag"].as_str().unwrap();
    assert!(flag.starts_with("--max-error-deg 10."), "{flag}");
    let without = json["summary"]["too_rough"]["mean_deg"].as_f64().unwrap();
    assert!((without - 44.4).abs() < 0.3, "{without}");
}
