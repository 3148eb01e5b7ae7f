//! Photos that cannot be read among others.

use super::folder::{Folder, changed};
use dev_support::drawn_pictures::Scene;
use study::{Error, Study};

/// The study with drawn pictures at 30 rpm whose angles alternate by a degree about 34 deg; the files of some numbers are damaged.
fn with_damage(n: usize, damaged: &[usize], more: &str) -> Result<Study, Error> {
    let folder = Folder::new(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        &format!("photos = \"photos\"\n{more}"),
    ));
    std::fs::create_dir(folder.path("photos")).expect("a new folder");
    for k in 0..n {
        let file = folder.path(&format!("photos/{k:03}.png"));
        let steps = [0, 2, 1, 3, 2, 0, 3, 1][k % 8];
        let inclination = -(33.0 + 0.7 * f64::from(steps)).to_radians();
        let scene = Scene {
            size: 240,
            radius: 112.0,
            inclination,
            ..Scene::default()
        };
        dev_support::drawn_pictures::save(scene.draw(), &file).expect("written");
        if damaged.contains(&k) {
            let bytes = std::fs::read(&file).expect("a picture");
            std::fs::write(&file, &bytes[..bytes.len() / 3]).expect("written");
        }
    }
    folder.read(None)
}

/// One of 24 photos is damaged: the others give the means, and the study says which is left out, and that the mean could lie by
/// the bound for a share of 1/24 off: z = 1.732, density 0.0891, l = 0.0929, 0.1020 standard deviations. The angles are correlated
/// with nothing, so that they count in full, to what the lag correlations of 23 values make of it.
#[test]
fn a_damaged_photo_among_many_is_left_out_with_its_bias() {
    let study = with_damage(24, &[5], "").unwrap();
    let photos = &study.photos[0];
    assert_eq!((photos.files.len(), photos.angles_deg.len()), (24, 23));
    let angle = photos.values["angle_deg"];
    let mean = photos.angles_deg.iter().sum::<f64>() / 23.0;
    assert!((angle.mean - mean).abs() < 1e-12);
    let told = photos.left_out.join("; ");
    let bound = told
        .split("angle_deg: 1 of 24 photos")
        .nth(1)
        .and_then(|told| told.split("would lie ").nth(1)?.split(' ').next());
    let bound: f64 = bound.expect("a bound").parse().expect("a number");
    // Two digits are reported.
    assert!((bound / (0.1020 * angle.sd) - 1.0).abs() < 0.06, "{told}");
    for word in [
        "drum @ rpm = 30",
        "005.png",
        "cannot be read",
        "fluctuation_deg",
    ] {
        assert!(told.contains(word), "'{word}' is missing in: {told}");
    }
}

/// Six of 24 could move the mean by 0.58 standard deviations, more than its standard error: the names and the remedy.
#[test]
fn too_many_damaged_photos_are_refused_by_name() {
    let all: Vec<usize> = (0..24).collect();
    for (damaged, words) in [
        (
            &[0, 4, 8, 12, 16, 20][..],
            &[
                "000.png",
                "020.png",
                "6 of 24",
                "standard errors",
                "photo = { ... }",
            ][..],
        ),
        (&all, &["019.png", "4 more photos"]),
    ] {
        let message = with_damage(24, damaged, "").unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "'{word}': {message}");
        }
    }
}

/// The second picture of a pair is lost: the angle of the first stays. A series with a gap tells no time over the gap: the longest part
/// without one is looked at.
#[test]
fn a_damaged_photo_keeps_its_place_in_the_series() {
    let study = with_damage(24, &[7], "photo = { pair_interval = \"2 ms\" }").unwrap();
    assert_eq!(study.photos[0].angles_deg.len(), 12);
    let study = with_damage(24, &[8], "photo = { pair_interval = \"2 ms\" }").unwrap();
    assert_eq!(study.photos[0].angles_deg.len(), 11);
}
