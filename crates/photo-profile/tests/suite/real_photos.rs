//! Instrument pictures against readings made by hand.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::fixture_files::fixture;
use image::{DynamicImage, imageops};
use photo_profile::{PhotoPixels, Settings, measure_image, read_photo};
use std::path::PathBuf;
use surface_profile::HighSide;

fn folder() -> PathBuf {
    fixture("photos")
}

/// One row of `readings.csv`, degrees and px; `None` if no reading by hand exists.
struct HandReading {
    file: String,
    chord: Option<[f64; 2]>,
    mid: Option<[f64; 2]>,
    drum: Option<[f64; 3]>,
}

fn hand_readings() -> Vec<HandReading> {
    let text = std::fs::read_to_string(folder().join("readings.csv")).unwrap();
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().ok();
        HandReading {
            file: cells[0].to_owned(),
            chord: number(3).zip(number(4)).map(|(a, b)| [a, b]),
            mid: number(5).zip(number(6)).map(|(a, b)| [a, b]),
            drum: number(7)
                .zip(number(8))
                .zip(number(9))
                .map(|((x, y), r)| [x, y, r]),
        }
    });
    rows.collect()
}

/// Chord and middle within the uncertainty of the hand reading plus half a degree, the drum
/// within 1 % of its radius, the side left in all of them.
#[test]
fn chord_and_middle_agree_with_the_readings_by_hand() {
    let mut n_read = 0;
    for hand in hand_readings() {
        let (Some(chord), Some(mid), Some(drum)) = (hand.chord, hand.mid, hand.drum) else {
            continue;
        };
        n_read += 1;
        let reading =
            crate::measure_file(&folder().join(&hand.file), &Settings::default()).unwrap();
        let angle = reading.angle().unwrap();
        for (name, value, [by_hand, uncertainty]) in
            [("chord", angle.chord, chord), ("mid", angle.mid, mid)]
        {
            let off = (value.to_degrees() - by_hand).abs();
            assert!(
                off <= uncertainty + 0.5,
                "{}: {name} is off by {off} deg",
                hand.file
            );
        }
        assert_eq!(angle.high_side, HighSide::Left);
        let found = reading.drum().unwrap();
        let off = (found.cx - drum[0])
            .hypot(found.cy - drum[1])
            .max((found.r - drum[2]).abs());
        assert!(off < 0.01 * drum[2], "{}: {found:?}", hand.file);
        assert!(
            reading.quality() > 0.9,
            "{}: quality {}",
            hand.file,
            reading.quality()
        );
    }
    assert_eq!(n_read, 6, "six pictures have readings by hand");
}

/// The inverted picture is the 45 rpm one with bright powder, saved again: 0.1 degrees.
#[test]
fn polarity_does_not_change_the_angle() {
    let line = |file: &str| {
        crate::measure_file(&folder().join(file), &Settings::default())
            .unwrap()
            .angle()
            .unwrap()
            .line
    };
    let difference = line("granudrum_mccA_45rpm_avg.bmp") - line("granudrum_mccA_inverted.jpg");
    assert!(difference.abs().to_degrees() < 0.1, "{difference} rad");
}

/// Mirror: 0.01 degrees, for a single frame with dust and for an average with halo.
#[test]
fn a_mirrored_photo_has_the_same_angle() {
    for file in [
        "granudrum_400um_single_frame.bmp",
        "granudrum_mccB_30rpm_avg_multi.jpg",
    ] {
        let gray = read_photo(&folder().join(file)).unwrap().to_luma8();
        let mirror = imageops::flip_horizontal(&gray);
        let line = |picture| {
            measure_image(picture, &Settings::default())
                .unwrap()
                .angle()
                .unwrap()
                .line
                .to_degrees()
        };
        let (one, other) = (line(&gray), line(&mirror));
        assert!((one - other).abs() < 0.01, "{file}: {one} and {other} deg");
    }
}

/// Twice the pixels by interpolation carry no more truth: 0.05 degrees, a tenth of a pixel over
/// the chord, on the line.
#[test]
fn the_size_of_the_picture_does_not_change_the_angle() {
    let photo = read_photo(&folder().join("granudrum_mccA_15rpm_avg.bmp")).unwrap();
    let (w, h) = (photo.width(), photo.height());
    let twice = photo.resize_exact(2 * w, 2 * h, imageops::FilterType::Triangle);
    let line = |picture: &DynamicImage| {
        let pixels = PhotoPixels::from_picture(picture);
        let reading = photo_profile::measure_photo(&pixels, &Settings::default()).unwrap();
        reading.angle().unwrap().line.to_degrees()
    };
    let (one, other) = (line(&photo), line(&twice));
    assert!((one - other).abs() < 0.05, "{one} and {other} deg");
}
