//! Pictures drawn with a known surface: bias, spread, stated error, mirror, drum, roll.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::drawn_pictures::{Disturbance, Scene};
use image::{GrayImage, imageops};
use photo_profile::{DrumPixels, DrumReading, Foreground, Refusal, Settings, measure_image};
use surface_profile::{HighSide, SurfaceAngle, SurfacePoint, measure};

/// The reading of a picture that must be measurable.
fn read(picture: &GrayImage, settings: &Settings) -> DrumReading {
    let reading = measure_image(picture, settings).unwrap();
    reading.bed().expect("a measurable bed").clone()
}

fn angle_of(picture: &GrayImage) -> SurfaceAngle {
    read(picture, &Settings::default()).angle
}

/// Statistics of the errors against the ruler's own reading of the true surface.
#[derive(Debug)]
struct Errors {
    /// Mean error, deg.
    bias: f64,
    /// Root mean square error, deg.
    rms: f64,
    /// Pictures whose 95 % interval, 1.96 stated standard errors, holds the truth.
    held: u32,
}

/// Measures `n` scenes of one kind, slopes of 20 to 53 degrees to either side.
fn errors(kind: &Scene, n: u32) -> Errors {
    let (mut sum, mut squares, mut held) = (0.0, 0.0, 0);
    for k in 0..n {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let slope = 0.35 + 0.58 * f64::from(k) / f64::from(n);
        let scene = Scene {
            inclination: side * slope,
            seed: u64::from(k),
            ..*kind
        };
        let angle = angle_of(&scene.draw());
        let truth = measure(&scene.surface(), &scene.drum()).unwrap();
        assert_eq!(angle.high_side, truth.high_side);
        let error = (angle.line - truth.line).to_degrees();
        sum += error;
        squares += error * error;
        held += u32::from(error.abs() <= 1.96 * angle.standard_error.to_degrees());
    }
    let n = f64::from(n);
    Errors {
        bias: sum / n,
        rms: (squares / n).sqrt(),
        held,
    }
}

const FINE: Scene = Scene {
    size: 560,
    radius: 265.0,
    shift: [2.3, -1.6],
    inclination: 0.0,
    height: 0.05,
    curvature: 0.0,
    s_shape: 0.0,
    bed: 40.0,
    air: 200.0,
    outside: 20.0,
    rim: 90.0,
    rim_width: 2.0,
    blur: 1.0,
    ramp: 0.0,
    noise: 4.0,
    grain: [0.0, 0.0],
    n_dust: 0,
    aspect: 1.0,
    disturbance: Disturbance::NONE,
    seed: 0,
};

/// Grains of a seventh of the drum radius, as a picture of 560 px of the study's seeds has.
const COARSE: Scene = Scene {
    grain: [18.0, 10.0],
    ..FINE
};

/// A hollow surface, to either side: the slope of its lowest fifth is that of the true curve there by y over x, to 1.5 degrees (the
/// last hundredths of the chord are hidden by the rim); a straight surface has the slope of its line, to 0.3 degrees.
#[test]
fn the_slope_of_the_toe_is_that_of_the_curve() {
    for (side, curvature) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 0.3), (-1.0, 0.3)] {
        let scene = Scene {
            inclination: side * 0.7,
            curvature,
            ..FINE
        };
        let drum = scene.drum();
        let inside = |p: &SurfacePoint| (p.x - drum.x).hypot(p.y - drum.y) < 0.97 * drum.radius;
        let curve: Vec<SurfacePoint> = scene.surface().into_iter().filter(inside).collect();
        let outwards = |p: &SurfacePoint| side * p.x;
        let low = curve.iter().map(outwards).fold(f64::INFINITY, f64::min);
        let high = curve.iter().map(outwards).fold(f64::NEG_INFINITY, f64::max);
        let toe = curve
            .iter()
            .filter(|p| outwards(p) < low + 0.2 * (high - low));
        let toe: Vec<&SurfacePoint> = toe.collect();
        let n = toe.len() as f64;
        let mean_x = toe.iter().map(|p| outwards(p)).sum::<f64>() / n;
        let rise: f64 = toe.iter().map(|p| (outwards(p) - mean_x) * p.y).sum();
        let run: f64 = toe.iter().map(|p| (outwards(p) - mean_x).powi(2)).sum();
        let truth = (rise / run).atan().to_degrees();
        let reading = read(&scene.draw(), &Settings::default());
        let found = reading.toe_slope().unwrap().to_degrees();
        let line = reading.angle.line.to_degrees();
        let most = if curvature == 0.0 { 0.3 } else { 1.5 };
        assert!((found - truth).abs() < most, "{found} for {truth}");
        assert_eq!(line - found > 10.0, curvature > 0.0, "{line} {found}");
    }
}

/// A sharp surface is read to a twentieth of a pixel over the chord of 500 px: 0.01 degrees.
#[test]
fn a_fine_powder_is_read_to_a_hundredth_of_a_degree() {
    for kind in [
        FINE,
        Scene {
            bed: 230.0,
            air: 15.0,
            outside: 10.0,
            ..FINE
        },
        Scene {
            outside: 200.0,
            rim_width: 0.0,
            ..FINE
        },
        Scene {
            bed: 120.0,
            air: 140.0,
            outside: 100.0,
            ..FINE
        },
        Scene { ramp: 25.0, ..FINE },
    ] {
        let errors = errors(&kind, 6);
        assert!(errors.rms < 0.015, "{errors:?} for {kind:?}");
    }
}

/// Curved and S-shaped surfaces: the circle's ambiguity of the rim width (2 px of 265) and the
/// smoothing over 0.03 radii change the line of an S by up to 0.1 degrees, that of a bow by less.
#[test]
fn curved_surfaces_are_read_as_the_ruler_reads_the_true_curve() {
    let bow = errors(
        &Scene {
            curvature: 0.15,
            ..FINE
        },
        6,
    );
    assert!(bow.rms < 0.03, "{bow:?}");
    let s = errors(
        &Scene {
            s_shape: 0.25,
            ..FINE
        },
        6,
    );
    assert!(s.rms < 0.12, "{s:?}");
}

/// Dust moves single stations by pixels; the line by their mean over the chord, 0.05 degrees.
#[test]
fn dust_on_the_glass_moves_the_line_by_less_than_a_twentieth_of_a_degree() {
    let errors = errors(
        &Scene {
            n_dust: 150,
            ..FINE
        },
        6,
    );
    assert!(errors.rms < 0.05, "{errors:?}");
}

/// Coarse grains, dark, bright and both at once around the tone of the air. The roughness of such
/// a bed is its own error: 0.6 to 0.7 degrees a picture. The bias over 20 pictures must be within
/// four of its standard errors (0.15). Of the 60 intervals of 95 %, 57 should hold the truth, with
/// a standard deviation of 1.7; the trials in `docs/angle-trials.md` count thousands.
#[test]
fn coarse_grains_are_read_without_bias_and_with_their_own_error() {
    let mut held = 0;
    for kind in [
        COARSE,
        Scene {
            bed: 200.0,
            air: 110.0,
            ..COARSE
        },
        Scene {
            bed: 150.0,
            air: 170.0,
            height: -0.3,
            ..COARSE
        },
    ] {
        let errors = errors(&kind, 20);
        assert!(errors.rms < 0.9, "{errors:?}");
        assert!(
            errors.bias.abs() < 4.0 * errors.rms / 20_f64.sqrt(),
            "{errors:?}"
        );
        held += errors.held;
    }
    assert!(held >= 52, "{held} of 60");
}

/// One coarse picture is known to some 0.6 degrees: refused where 0.3 are asked for, with the line that is given where 1 will do,
/// to the last bit, so that a mean with and without such pictures can be compared.
#[test]
fn a_refused_coarse_bed_still_tells_its_line() {
    let picture = COARSE.draw();
    let asked = |degrees: f64| Settings {
        max_angle_error: degrees.to_radians(),
        ..Settings::default()
    };
    let angle = read(&picture, &asked(1.0)).angle;
    let refused = measure_image(&picture, &asked(0.3)).unwrap();
    let Some(Refusal::TooRough { line, error, .. }) = refused.refused().map(|r| &r.reason) else {
        panic!("not too rough: {refused:?}")
    };
    let (line, error) = (*line, *error);
    assert_eq!(line, angle.line.to_degrees());
    assert_eq!(error, angle.standard_error.to_degrees());
}

/// A picture and its mirror: 0.01 degrees is what users are promised; also at odd sizes, at which
/// no point falls on the same pixels.
#[test]
fn a_mirrored_picture_has_the_same_angle_and_the_other_side() {
    for scene in [
        Scene {
            inclination: 0.6,
            ..FINE
        },
        Scene {
            inclination: 0.7,
            size: 601,
            seed: 4,
            ..COARSE
        },
        Scene {
            inclination: 0.5,
            size: 1203,
            radius: 560.3,
            seed: 5,
            n_dust: 60,
            ..FINE
        },
    ] {
        let picture = scene.draw();
        let (one, other) = (
            angle_of(&picture),
            angle_of(&imageops::flip_horizontal(&picture)),
        );
        assert_eq!(
            (one.high_side, other.high_side),
            (HighSide::Right, HighSide::Left)
        );
        let pairs = [
            (one.line, other.line),
            (one.mid, other.mid),
            (one.chord, other.chord),
        ];
        for (a, b) in pairs {
            assert!((a - b).abs().to_degrees() < 0.01, "{a} and {b} rad");
        }
    }
}

/// The drum is found to a pixel plus the width of its rim, also small and off the middle.
#[test]
fn the_drum_is_found_where_it_is() {
    let scene = Scene {
        size: 900,
        radius: 170.0,
        shift: [180.0, -150.0],
        ..COARSE
    };
    for scene in [
        scene,
        Scene {
            grain: [0.0, 0.0],
            ..scene
        },
    ] {
        let drum = read(&scene.draw(), &Settings::default()).drum;
        let off = (drum.cx - 629.5).hypot(drum.cy - 299.5);
        assert!(off < 1.5 && (drum.r - 171.0).abs() < 2.0, "{drum:?}");
    }
}

/// The true horizontal turned by the roll: the angle falls by it when the high side is right
/// (both counter-clockwise). 0.01 degrees is the resampling of the turned grid.
#[test]
fn camera_roll_is_taken_off() {
    let picture = Scene {
        inclination: 0.6,
        ..FINE
    }
    .draw();
    let level = angle_of(&picture).line;
    let settings = Settings {
        camera_roll: 0.1,
        ..Settings::default()
    };
    let rolled = read(&picture, &settings).angle.line;
    assert!(
        (level - rolled - 0.1).abs().to_degrees() < 0.01,
        "{level} and {rolled}"
    );
}

/// A drum given by the caller gives the reading of the drum found: the ends of the chord move by
/// the width of the rim, the line of a straight surface by nothing beyond 0.01 degrees.
#[test]
fn a_given_drum_is_used() {
    let picture = Scene {
        inclination: -0.6,
        ..FINE
    }
    .draw();
    let drum = DrumPixels {
        cx: 281.8,
        cy: 277.9,
        r: 265.0,
    };
    let settings = Settings {
        drum: Some(drum),
        ..Settings::default()
    };
    let reading = read(&picture, &settings);
    assert_eq!(reading.drum, drum);
    let difference = reading.angle.line - angle_of(&picture).line;
    assert!(difference.abs().to_degrees() < 0.01, "{difference} rad");
}

#[test]
fn polarity_is_found_and_can_be_given() {
    for (bed, air, tone) in [
        (40.0, 200.0, Foreground::Dark),
        (220.0, 30.0, Foreground::Light),
    ] {
        let picture = Scene {
            bed,
            air,
            inclination: 0.5,
            ..COARSE
        }
        .draw();
        assert_eq!(read(&picture, &Settings::default()).foreground, tone);
        let settings = Settings {
            foreground: tone,
            ..Settings::default()
        };
        assert_eq!(read(&picture, &settings).foreground, tone);
    }
}

/// Light that falls off to one side and to the corners, and the edge of the bed on the back wall as a
/// strip of half tone along the surface: 0.03 degrees. One threshold for all would be off by 0.2
/// degrees in the first, and a light fitted to all tones by 0.1 in the second.
#[test]
fn neither_uneven_light_nor_a_strip_of_half_tone_turns_the_surface() {
    let light = Disturbance {
        vignette: 0.4,
        light: [0.5, -0.3],
        ..Disturbance::NONE
    };
    let strip = Disturbance {
        back_edge: 0.06,
        ..Disturbance::NONE
    };
    for disturbance in [light, strip] {
        let errors = errors(
            &Scene {
                disturbance,
                ..FINE
            },
            6,
        );
        assert!(errors.rms < 0.03, "{errors:?} for {disturbance:?}");
    }
}

/// A powder under a straight line at a height h (drum radii) fills the segment of the disc within 0.96 of the radius. The
/// blur of the reader, 0.03 radii, moves no straight edge, and the drum is found within 1 %: 0.012 are allowed, a
/// hundredth of the drum and what the rim's neighbourhood adds.
#[test]
fn the_fill_level_is_that_of_the_segment() {
    for height in [-0.4, 0.0, 0.25] {
        let scene = Scene {
            height,
            ..Scene::default()
        };
        let fill = read(&scene.draw(), &Settings::default())
            .fill_level
            .unwrap();
        let h = height / 0.96;
        let segment = 0.5 + (h * f64::sqrt(1.0 - h * h) + f64::asin(h)) / std::f64::consts::PI;
        assert!(
            (fill - segment).abs() < 0.012,
            "{height}: {fill} for {segment}"
        );
    }
}

/// A bed at 62 degrees with steps whose risers hang over, at 105 degrees, and whose treads lie at 40: the surface is a height over its own
/// line, and its angle is that of the same curve without a picture, to the error of the smoothing on its corners, 0.5 degrees.
#[test]
fn a_steep_bed_with_steps_is_read_along_its_surface() {
    let (size, radius) = (480_u32, 220.0);
    let middle = 0.5 * f64::from(size - 1);
    let (sin, cos) = 62.0_f64.to_radians().sin_cos();
    let (tread, riser) = (22.0_f64.to_radians().tan(), 43.0_f64.to_radians().tan());
    let wave = radius;
    // Height over the line at a distance along it, uphill.
    let step = |u: f64| {
        let length = wave * riser / (tread + riser);
        let along = u.rem_euclid(wave);
        let fall = -along * tread;
        0.5 * length * tread + fall.max(-(wave - along) * riser)
    };
    let picture = GrayImage::from_fn(size, size, |i, j| {
        let (x, y) = (f64::from(i) - middle, middle - f64::from(j));
        let (u, v) = (x * cos + y * sin, y * cos - x * sin);
        image::Luma([if x.hypot(y) > radius {
            250
        } else if v < step(u) {
            60
        } else {
            200
        }])
    });
    let coarse = Settings {
        max_angle_error: 10.0_f64.to_radians(),
        ..Settings::default()
    };
    let curve: Vec<SurfacePoint> = (-2000..=2000)
        .map(|k| f64::from(k) * radius / 2000.0)
        .map(|u| (u, step(u)))
        .filter(|(u, v)| u.hypot(*v) < 0.96 * radius)
        .map(|(u, v)| SurfacePoint {
            x: u * cos - v * sin,
            y: u * sin + v * cos,
        })
        .collect();
    let drum = surface_profile::DrumCircle {
        x: 0.0,
        y: 0.0,
        radius,
    };
    let truth = measure(&curve, &drum).unwrap().line;
    let reading = measure_image(&picture, &coarse).unwrap();
    let angle = reading.angle().unwrap_or_else(|| panic!("{reading:?}"));
    let off = (angle.line - truth).to_degrees();
    assert!(off.abs() < 0.5, "{off} of {}", truth.to_degrees());
    assert!(
        (truth.to_degrees() - 62.0).abs() < 3.0,
        "{}",
        truth.to_degrees()
    );
}
