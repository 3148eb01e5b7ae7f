//! Films, by programs that stand for `ffprobe` and `ffmpeg`: they leave what is written into them. The real ones are tried by
//! `trials/programs.sh films`.

use super::{folder, text};
use dev_support::drawn_pictures::Scene;
use image::GrayImage;
use image::codecs::pnm::PnmEncoder;
use serde_json::Value;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Output};

/// A drum of 200 px whose surface stands at an angle, degrees.
fn drum(angle_deg: f64) -> GrayImage {
    Scene {
        size: 200,
        radius: 90.0,
        inclination: angle_deg.to_radians(),
        blur: 1.0,
        ..Scene::default()
    }
    .draw()
}

/// Slopes of the pictures of the film, degrees.
const SLOPES: [f64; 6] = [30.0, 32.0, 34.0, 36.0, 38.0, 40.0];

/// A folder with a film and the two programs: `ffmpeg` gives these pictures and then runs `end`.
fn films(name: &str, pictures: &[GrayImage], end: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let mut bytes = Vec::new();
    for picture in pictures {
        let colour = image::DynamicImage::from(picture.clone()).to_rgb8();
        colour
            .write_with_encoder(PnmEncoder::new(&mut bytes))
            .unwrap();
    }
    std::fs::write(folder.join("pictures.ppm"), bytes).unwrap();
    std::fs::write(folder.join("film.mp4"), "a film").unwrap();
    program(&folder, "ffprobe", "echo 25/2");
    let cat = format!("cat '{}'\n{end}", folder.join("pictures.ppm").display());
    program(&folder, "ffmpeg", &cat);
    folder
}

/// A shell script as a program.
fn program(folder: &Path, name: &str, lines: &str) {
    let path = folder.join(name);
    std::fs::write(&path, format!("#!/bin/sh\n{lines}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// The command with programs from a folder before all others.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
    Command::new(env!("CARGO_BIN_EXE_angle-from-image"))
        .current_dir(folder)
        .env("PATH", path)
        .args(arguments)
        .output()
        .unwrap()
}

/// The pictures come in order, with the rate that the film states (25/2 a second) or that is stated for it; every second one
/// keeps its own number and time. 0.3 degrees: a drum of 200 px.
#[test]
fn the_pictures_of_a_film_come_in_order_with_their_times() {
    let folder = films("film", &SLOPES.map(drum), "");
    for (words, step, interval) in [
        (&[][..], 1, 0.08),
        (&["--fps", "100"][..], 1, 0.01),
        (&["--every", "2"][..], 2, 0.16),
        (&["--every", "4", "--threads", "1"][..], 4, 0.32),
    ] {
        let output = run(&folder, &[&["film.mp4", "--json"], words].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let images = json["images"].as_array().unwrap();
        let expected: Vec<f64> = SLOPES.iter().step_by(step).copied().collect();
        assert_eq!(images.len(), expected.len(), "{words:?}");
        for (place, (image, slope)) in images.iter().zip(expected).enumerate() {
            let angle = image["angle_deg"].as_f64().unwrap();
            assert!((angle - slope).abs() < 0.3, "{words:?} {place}: {angle}");
            assert_eq!(image["frame"], place * step, "{words:?}");
            let time = image["time_s"].as_f64().unwrap();
            assert!(
                (time - place as f64 * interval).abs() < 1e-12,
                "{words:?} {time}"
            );
        }
    }
}

/// Where a film breaks off, its pictures are kept and the break is reported, with exit code 1: by a program that fails, by one that
/// complains and continues, and by a picture that is cut.
#[test]
fn a_film_that_breaks_off_keeps_its_beginning() {
    let three = SLOPES.map(drum)[..3].to_vec();
    let complains = "echo 'moov atom is damaged' >&2";
    let cut = "P6\\n200 200\\n255\\n";
    for (end, reason) in [
        (format!("{complains}; exit 1"), "moov atom"),
        (complains.to_owned(), "moov atom"),
        (format!("printf '{cut}abc'"), "cannot decode"),
    ] {
        let folder = films("broken film", &three, &end);
        let output = run(&folder, &["film.mp4", "--json", "--csv", "a.csv"]);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (&json["summary"]["n"], &json["summary"]["unread"]),
            (&3.into(), &1.into())
        );
        let told = json["images"][3]["reason"].as_str().unwrap();
        assert!(told.contains(reason), "{told}");
        assert!(folder.join("a.csv").exists());
    }
}

/// A film without pictures, one that no program knows, and a machine without the programs: an error that says what to do.
#[test]
fn a_film_that_cannot_be_read_is_an_error() {
    let folder = films("no film", &[], "");
    let output = run(&folder, &["film.mp4"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("0 pictures"),
        "{}",
        text(&output.stderr)
    );
    program(&folder, "ffprobe", "echo 'Invalid data found' >&2; exit 1");
    let output = run(&folder, &["film.mp4"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("Invalid data found"),
        "{}",
        text(&output.stderr)
    );
    let alone = Command::new(env!("CARGO_BIN_EXE_angle-from-image"))
        .current_dir(&folder)
        .env("PATH", folder.join("nowhere"))
        .arg("film.mp4")
        .output()
        .unwrap();
    assert_eq!(alone.status.code(), Some(2));
    assert!(
        text(&alone.stderr).contains("install ffmpeg"),
        "{}",
        text(&alone.stderr)
    );
}

/// Packs the pictures `0.png`, `1.png` and so on of a folder as a film of 12.5 pictures a second.
fn pack(folder: &Path, name: &str, codec: &str) {
    let colours = if codec == "mjpeg" {
        "yuvj420p"
    } else {
        "yuv420p"
    };
    let made = Command::new("ffmpeg")
        .current_dir(folder)
        .args(["-v", "error", "-framerate", "25/2", "-i", "%d.png"])
        .args(["-c:v", codec, "-q:v", "2", "-pix_fmt", colours, name])
        .status()
        .expect("`trials/programs.sh films` installs ffmpeg");
    assert!(made.success(), "{name}");
}

/// The real programs (`trials/programs.sh films`): slopes from 30 to 40 degrees at 12.5 pictures a second, packed as a camera packs them; 0.5 degrees: a
/// drum of 200 px behind the losses of the packing. Half of the file is a film that breaks off or none at all.
#[test]
#[ignore = "needs ffmpeg: trials/programs.sh films"]
fn real_films_are_read() {
    let folder = super::folder("real films");
    for (number, slope) in SLOPES.iter().enumerate() {
        dev_support::drawn_pictures::save(drum(*slope), folder.join(format!("{number}.png")))
            .unwrap();
    }
    for (name, codec) in [
        ("a.mp4", "libx264"),
        ("b.mov", "mpeg4"),
        ("c.avi", "mjpeg"),
        ("d.webm", "libvpx"),
    ] {
        pack(&folder, name, codec);
        let output = super::run(&[folder.join(name).to_str().unwrap(), "--json"]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{name}: {}",
            text(&output.stderr)
        );
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let images = json["images"].as_array().unwrap();
        assert_eq!(images.len(), SLOPES.len(), "{name}");
        for (place, (image, slope)) in images.iter().zip(SLOPES).enumerate() {
            let angle = image["angle_deg"].as_f64().unwrap();
            assert!((angle - slope).abs() < 0.5, "{name} {place}: {angle}");
            let time = image["time_s"].as_f64().unwrap();
            assert!((time - place as f64 * 0.08).abs() < 1e-9, "{name}: {time}");
        }
        let whole = std::fs::read(folder.join(name)).unwrap();
        let half = folder.join(format!("half-{name}"));
        std::fs::write(&half, &whole[..whole.len() / 2]).unwrap();
        let output = super::run(&[half.to_str().unwrap()]);
        assert_ne!(
            output.status.code(),
            Some(0),
            "{name}: {}",
            text(&output.stdout)
        );
    }
}
