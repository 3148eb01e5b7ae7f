//! Pictures without an honest answer must be refused, each for its reason.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::drawn_pictures::Scene;
use dev_support::fixture_files::fixture;
use image::{GrayImage, Luma};
use photo_profile::{
    DrumPixels, PhotoReading, Refusal, RefusedReading, Settings, measure_image, overlay_gray,
};

fn refusal(picture: &GrayImage, settings: &Settings) -> Refusal {
    refused(&measure_image(picture, settings).unwrap())
        .reason
        .clone()
}

fn refused(reading: &PhotoReading) -> &RefusedReading {
    let refused = reading.refused();
    refused.expect("not measured, for there is nothing to measure")
}

/// Grey noise from a plain congruence, spread over all levels.
fn noise(size: u32) -> GrayImage {
    let mut state = 1_u32;
    GrayImage::from_fn(size, size, |_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Luma([state.to_be_bytes()[0]])
    })
}

/// The drum was found, the surface not.
fn is_about_the_surface(reason: &Refusal) -> bool {
    matches!(
        reason,
        Refusal::OneTone { .. }
            | Refusal::NoClearSurface { .. }
            | Refusal::TooRough { .. }
            | Refusal::Surface(_)
    )
}

fn given_drum() -> Settings {
    Settings {
        drum: Some(DrumPixels {
            cx: 279.5,
            cy: 279.5,
            r: 260.0,
        }),
        ..Settings::default()
    }
}

#[test]
fn a_blank_picture_has_no_drum_and_a_given_drum_no_surface() {
    let blank = GrayImage::from_pixel(560, 560, Luma([128]));
    assert!(matches!(
        refusal(&blank, &Settings::default()),
        Refusal::NoDrum { .. }
    ));
    assert!(matches!(
        refusal(&blank, &given_drum()),
        Refusal::OneTone { .. }
    ));
}

#[test]
fn noise_has_no_drum_and_no_surface() {
    let noise = noise(560);
    assert!(matches!(
        refusal(&noise, &Settings::default()),
        Refusal::NoDrum { .. }
    ));
    let reason = refusal(&noise, &given_drum());
    assert!(!matches!(reason, Refusal::DrumOutside { .. }), "{reason}");
}

#[test]
fn an_empty_drum_is_refused() {
    for noise in [0.0, 4.0] {
        let scene = Scene {
            height: -1.5,
            noise,
            blur: 1.0,
            ..Scene::default()
        };
        let reason = refusal(&scene.draw(), &Settings::default());
        assert!(is_about_the_surface(&reason), "{reason}");
    }
}

#[test]
fn a_full_drum_is_refused() {
    for grain in [[0.0, 0.0], [18.0, 10.0]] {
        let scene = Scene {
            height: 1.5,
            noise: 4.0,
            blur: 1.0,
            grain,
            ..Scene::default()
        };
        let reason = refusal(&scene.draw(), &Settings::default());
        assert!(is_about_the_surface(&reason), "{reason}");
    }
}

/// Light that fades across an empty drum parts it into two tones without a boundary.
#[test]
fn fading_light_is_no_surface() {
    let mut picture = Scene {
        height: -1.5,
        ..Scene::default()
    }
    .draw();
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let light = 0.4 + 0.6 * f64::from(x + 2 * y) / (3.0 * 560.0);
        let shaded = (f64::from(pixel.0[0]) * light).round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 255"
        )]
        let level = shaded as u8;
        *pixel = Luma([level]);
    }
    let reason = refusal(&picture, &Settings::default());
    assert!(matches!(reason, Refusal::NoClearSurface { .. }), "{reason}");
}

/// A camera 26 degrees off the axis (flattening 0.1) and one 14 degrees off (0.03).
#[test]
fn an_oblique_view_is_refused() {
    for aspect in [0.9, 0.97] {
        let scene = Scene {
            aspect,
            blur: 1.0,
            inclination: 0.6,
            ..Scene::default()
        };
        let reason = refusal(&scene.draw(), &Settings::default());
        let named = matches!(
            reason,
            Refusal::NoDrum { .. } | Refusal::TiltedView { .. } | Refusal::BrokenRim { .. }
        );
        assert!(named, "{reason}");
    }
}

/// Nearly on the axis the circle still shows all round, and only its flattening tells.
#[test]
fn a_slightly_oblique_view_is_refused_for_its_flattening() {
    let scene = Scene {
        aspect: 0.97,
        blur: 1.0,
        inclination: 0.6,
        ..Scene::default()
    };
    let reason = refusal(&scene.draw(), &Settings::default());
    let Refusal::TiltedView { flattening, .. } = reason else {
        panic!("{reason}")
    };
    assert!((flattening - 0.03).abs() < 0.005, "flattening {flattening}");
}

#[test]
fn the_oblique_phone_photo_is_refused_for_its_drum() {
    let path = fixture("photos/phone_prototype_drums_tilted_camera.jpg");
    let reading = crate::measure_file(&path, &Settings::default()).unwrap();
    let reason = &refused(&reading).reason;
    assert!(reason.to_string().contains("no drum circle"), "{reason}");
}

#[test]
fn a_tiny_picture_and_a_drum_outside_are_refused() {
    let tiny = GrayImage::from_pixel(30, 200, Luma([9]));
    assert!(matches!(
        refusal(&tiny, &Settings::default()),
        Refusal::TooSmall { .. }
    ));
    let outside = Settings {
        drum: Some(DrumPixels {
            cx: 0.0,
            cy: 0.0,
            r: 200.0,
        }),
        ..Settings::default()
    };
    let picture = Scene::default().draw();
    assert!(matches!(
        refusal(&picture, &outside),
        Refusal::DrumOutside { .. }
    ));
}

#[test]
fn settings_that_cannot_be_meant_are_errors() {
    let picture = Scene::default().draw();
    let with = |settings: Settings| measure_image(&picture, &settings);
    for r in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        let drum = Some(DrumPixels {
            cx: 1.0,
            cy: 1.0,
            r,
        });
        assert!(
            with(Settings {
                drum,
                ..Settings::default()
            })
            .is_err(),
            "radius {r}"
        );
    }
    for camera_roll in [f64::NAN, 2.0] {
        let settings = Settings {
            camera_roll,
            ..Settings::default()
        };
        assert!(with(settings).is_err(), "roll {camera_roll}");
    }
}

/// A binarised bed of grains (px) at an inclination in a tenth of a drum, of 172 px, whose rim has the tone of the air.
pub(crate) fn binarised_arc(degrees: f64, grain: f64) -> GrayImage {
    let scene = Scene {
        size: 400,
        radius: 172.0,
        height: -0.7,
        inclination: degrees.to_radians(),
        grain: [grain, 0.6 * grain],
        bed: 0.0,
        air: 255.0,
        outside: 255.0,
        rim: 255.0,
        rim_width: 0.0,
        ..Scene::default()
    };
    let mut picture = scene.draw();
    for pixel in picture.pixels_mut() {
        pixel.0[0] = if pixel.0[0] < 128 { 0 } else { 255 };
    }
    picture
}

/// A binarised bed in an arc of a drum: too little of the circle shows, or the
/// surface next to it passes for the side of an ellipse. The circle that is proposed is that of the drum within 1 px, as
/// grains of 6 and 12 px at the ends of the arc are outliers. Noise has no circle.
#[test]
fn a_circle_that_is_not_taken_for_the_drum_is_proposed() {
    for (degrees, grain) in [(15.0, 12.0), (30.0, 12.0), (15.0, 6.0), (30.0, 6.0)] {
        let picture = binarised_arc(degrees, grain);
        let reading = measure_image(&picture, &Settings::default()).unwrap();
        let refused = refused(&reading);
        assert!(refused.drum.is_none(), "{:?}", refused.reason);
        let circle = refused.candidate.expect("an arc shows");
        let off = [circle.cx - 199.5, circle.cy - 199.5, circle.r - 172.0];
        assert!(off.iter().all(|o| o.abs() < 1.0), "{off:?} at {degrees}");
    }
    let blind = measure_image(&noise(560), &Settings::default()).unwrap();
    assert_eq!(refused(&blind).candidate, None);
}

/// A bed of grains, refused for its standard error: the boundary that was found runs from rim to rim along the drawn surface,
/// with bumps of half a grain (10 px), and the overlay shows it in magenta over the picture and the reason below. A dashed
/// circle has three fifths of the pixels of a whole one.
#[test]
fn the_overlay_of_a_refused_picture_shows_what_was_found() {
    let scene = Scene {
        grain: [20.0, 12.0],
        ..Scene::default()
    };
    let (picture, strict) = (
        scene.draw(),
        Settings {
            max_angle_error: 0.1_f64.to_radians(),
            ..Settings::default()
        },
    );
    let reading = measure_image(&picture, &strict).unwrap();
    let seen = refused(&reading);
    assert!(
        matches!(seen.reason, Refusal::TooRough { .. }),
        "{:?}",
        seen.reason
    );
    let boundary = &seen.boundary;
    let rise = scene.inclination.tan();
    let off = boundary
        .iter()
        .map(|p| (279.5 - p.y - rise * (p.x - 279.5)).abs() * scene.inclination.cos());
    let mean = off.sum::<f64>() / boundary.len() as f64;
    assert!(
        boundary.len() > 300 && mean < 10.0,
        "{} points, {mean} px",
        boundary.len()
    );
    let drawn = overlay_gray(&picture, &reading, &strict);
    let count = |drawn: &image::RgbImage, colour| drawn.pixels().filter(|p| p.0 == colour).count();
    let (magenta, orange) = ([230, 0, 200], [255, 130, 0]);
    let no_line = PhotoReading::Refused(RefusedReading {
        line: None,
        ..seen.clone()
    });
    let points = count(&overlay_gray(&picture, &no_line, &strict), magenta);
    let with_line = count(&drawn, magenta);
    assert!(
        points > 600 && with_line > points + 200,
        "{points} {with_line}"
    );
    assert!(drawn.height() > 560 && drawn.width() == 560);
    let strip = image::imageops::crop_imm(&drawn, 0, 560, 560, drawn.height() - 560).to_image();
    assert!(count(&strip, orange) > 500, "words");
    assert!(seen.drum.is_some());
    let guess = PhotoReading::Refused(RefusedReading {
        drum: None,
        candidate: seen.drum,
        ..seen.clone()
    });
    let blue = [40, 120, 255];
    let whole = count(&drawn, blue) as f64;
    let part = count(&overlay_gray(&picture, &guess, &strict), blue) as f64 / whole;
    assert!((part - 0.6).abs() < 0.05, "{part}");
}
