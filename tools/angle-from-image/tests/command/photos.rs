//! What a photo gives, and how to continue without an angle.

use super::{GOOD, REFUSED, folder, photo, run, text};
use dev_support::drawn_pictures::save;
use serde_json::Value;

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

/// A binarised bed in a tenth of a drum whose rim does not show, 30 degrees steep: refused for want of a drum, with a flag in
/// the message that, pasted, gives the drawn angle within its interval. Coarse grains in a drum that shows: the
/// flag allows for their error. A blank picture has words only.
#[test]
fn a_refusal_names_the_flag_to_go_on_with() {
    use dev_support::drawn_pictures::Scene;
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
        save(picture, &file).unwrap();
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
    let grey = image::GrayImage::from_pixel(300, 200, image::Luma([99]));
    save(grey, &blank).unwrap();
    let said = text(&run(&[blank.to_str().unwrap()]).stdout);
    assert!(said.contains("--drum CX,CY,R"), "{said}");
}
