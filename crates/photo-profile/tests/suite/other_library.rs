//! Why the reading of photos does without these steps of `imageproc`: what each does to pictures of known truth. Where one
//! of these tests fails with a newer version, that step can take the place of ours.

use dev_support::drawn_pictures::Scene;
use image::imageops::flip_horizontal;
use image::{GrayImage, Luma};
use imageproc::contrast::otsu_level;
use imageproc::edges::canny;
use imageproc::hough::{LineDetectionOptions, detect_lines};

/// A photo of grains and its mirror image show the same slope, so that their edges must be mirror images. Of those of
/// `canny` one in a hundred or more is not.
#[test]
fn edges_of_a_mirrored_picture_are_not_the_mirrored_edges() {
    let scene = Scene {
        grain: [6.0, 4.0],
        ..Scene::default()
    };
    let picture = scene.draw();
    let edges = canny(&picture, 30.0, 60.0);
    let mirrored = flip_horizontal(&canny(&flip_horizontal(&picture), 30.0, 60.0));
    let pairs = edges.pixels().zip(mirrored.pixels());
    let differing = pairs.filter(|(a, b)| a != b).count();
    let found = edges.pixels().filter(|edge| edge[0] > 0).count();
    assert!(differing > found / 100, "{differing} pixels of {found}");
}

/// A standard error of an angle is some tenths of a degree. A line at 30.5 degrees is found at a whole number of them.
#[test]
fn lines_are_found_at_whole_degrees() {
    let slope = 30.5_f64.to_radians().tan();
    let line = GrayImage::from_fn(400, 400, |x, y| {
        let away = f64::from(y) - 50.0 - slope * f64::from(x);
        Luma([if away.abs() < 0.7 { 255 } else { 0 }])
    });
    let options = LineDetectionOptions {
        vote_threshold: 100,
        suppression_radius: 8,
    };
    let lines = detect_lines(&line, options);
    let off = lines
        .iter()
        .map(|line| (f64::from(line.angle_in_degrees) - 90.0 - 30.5).abs());
    let nearest = off.fold(f64::INFINITY, f64::min);
    assert!((0.49..2.0).contains(&nearest), "{nearest} degrees");
}

/// Tones of 60, 200 and 255 on 10, 3 and 87 % of a picture. By hand: the variance between the classes, w (1 - w) (m1 - m2)^2,
/// is 3352 for a level of 60 and 3003 for one of 200, whatever the size. In 25 million pixels the sum over the white ones
/// leaves 32 bits, and the level found is 200, or the call panics.
#[test]
fn a_threshold_of_a_large_picture_overflows() {
    let tones = |side: u32| {
        GrayImage::from_fn(side, side, |x, _| {
            Luma([match 100 * x / side {
                0..10 => 60,
                10..13 => 200,
                _ => 255,
            }])
        })
    };
    assert_eq!(otsu_level(&tones(500)), 60);
    let large = std::panic::catch_unwind(|| otsu_level(&tones(5000)));
    assert!(!large.as_ref().is_ok_and(|level| *level == 60), "{large:?}");
}
