//! Colour pictures whose bed and air differ in colour and hardly in luminance.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::drawn_pictures::{Class, Scene, kinds};
use image::{DynamicImage, GrayImage, Rgb, RgbImage};
use photo_profile::{
    Channel, Mode, PhotoPixels, PhotoReading, Settings, measure_image, measure_photo,
};

/// The grey picture with its levels 0 to 255 spread from one colour to another.
fn coloured(grey: &GrayImage, dark: [f64; 3], light: [f64; 3]) -> DynamicImage {
    RgbImage::from_fn(grey.width(), grey.height(), |x, y| {
        let part = f64::from(grey.get_pixel(x, y).0[0]) / 255.0;
        Rgb([0, 1, 2].map(|c: usize| {
            let level = dark[c] + part * (light[c] - dark[c]);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to 255"
            )]
            let level = level.round() as u8;
            level
        }))
    })
    .into()
}

fn read(picture: &DynamicImage, settings: &Settings) -> PhotoReading {
    measure_photo(&PhotoPixels::from_picture(picture), settings).unwrap()
}

const SCENE: Scene = Scene {
    inclination: 0.6,
    blur: 1.0,
    noise: 3.0,
    bed: 235.0,
    air: 15.0,
    ..GRAINY
};

/// Fine grains before a dark wall, as drawn by [`Scene::default`] otherwise.
const GRAINY: Scene = Scene {
    size: 560,
    radius: 255.0,
    shift: [2.0, -1.0],
    inclination: 0.0,
    height: 0.0,
    curvature: 0.0,
    s_shape: 0.0,
    bed: 0.0,
    air: 0.0,
    outside: 8.0,
    rim: 60.0,
    rim_width: 2.0,
    blur: 0.0,
    ramp: 0.0,
    noise: 0.0,
    grain: [6.0, 5.0],
    n_dust: 0,
    aspect: 1.0,
    disturbance: dev_support::drawn_pictures::Disturbance::NONE,
    seed: 4,
};

/// Dark blue grains on black have a luminance of 5 of 255 levels, red on green of one luminance has none at all. Each is read
/// as the same picture in black and white is, to 0.5 degrees, three of its standard errors.
#[test]
fn grains_that_differ_in_colour_alone_are_read_as_grey_ones_are() {
    let grey = SCENE.draw();
    let truth = measure_image(&grey, &Settings::default()).unwrap();
    let truth = truth.angle().unwrap();
    let same_luma = [(1.0 - 0.2126 * 0.9 - 0.0722 * 0.2) / 0.7152, 0.9, 0.2];
    let cases = [
        ([4.0, 4.0, 4.0], [6.0, 6.0, 70.0]),
        ([4.0, 4.0, 4.0], [60.0, 3.0, 3.0]),
        ([100.0, 100.0, 100.0], [90.0, 100.0 * same_luma[0], 20.0]),
    ];
    for (dark, light) in cases {
        let reading = read(&coloured(&grey, dark, light), &Settings::default());
        assert_ne!(reading.channel(), Channel::Luma, "{light:?}");
        let off = (reading.angle().unwrap().line - truth.line).to_degrees();
        assert!(off.abs() < 0.5, "{off} degrees for {light:?}");
    }
}

/// Where the luminance parts bed and air well, a colour picture gives what its grey copy gives, to the bit.
#[test]
fn a_picture_with_good_luminance_is_read_by_it() {
    let picture = coloured(&SCENE.draw(), [20.0, 10.0, 5.0], [250.0, 220.0, 160.0]);
    let reading = read(&picture, &Settings::default());
    let grey = measure_image(&picture.to_luma8(), &Settings::default()).unwrap();
    assert_eq!(reading.channel(), Channel::Luma);
    assert_eq!(reading.angle().unwrap(), grey.angle().unwrap());
}

/// Five channels are five chances to find something if nothing is.
#[test]
fn hopeless_pictures_stay_refused_in_colour() {
    for kind in kinds().iter().filter(|k| k.class == Class::Hopeless) {
        let grey = kind.trial(7).picture;
        let picture = coloured(&grey, [10.0, 60.0, 30.0], [60.0, 20.0, 90.0]);
        let reading = read(&picture, &Settings::default());
        assert!(reading.refused().is_some(), "{}", kind.name);
    }
}

/// A heap of dark blue grains before black: both flanks of 0.56 rad to 0.5 degrees.
#[test]
fn a_dark_blue_heap_before_black_is_read() {
    let scene = dev_support::drawn_pictures::HeapScene {
        tones: [235.0, 15.0, 235.0],
        rounding: 0.005,
        ..dev_support::drawn_pictures::HeapScene::default()
    };
    let picture = coloured(&scene.draw(), [4.0, 4.0, 4.0], [6.0, 6.0, 60.0]);
    let settings = Settings {
        mode: Mode::Heap,
        ..Settings::default()
    };
    let reading = read(&picture, &settings);
    assert_eq!(reading.channel(), Channel::Blue, "{reading:?}");
    let heap = reading.heap().unwrap();
    for flank in [heap.left, heap.right] {
        assert!((flank - 0.56).to_degrees().abs() < 0.5, "{flank}");
    }
}
