//! Tests with surfaces of known angle.

use crate::test_noise::correlated;
use crate::{Definition, DrumCircle, Error, HighSide, SurfacePoint, measure, read_surface};
use probability::random_stream::Stream;

const DRUM: DrumCircle = DrumCircle {
    x: 3.0,
    y: -2.0,
    radius: 100.0,
};

/// The surface v = height(t) along a line with signed inclination, t = u / half-chord from -1
/// (left) to 1, drawn rim to rim.
fn surface(inclination: f64, n: i32, height: impl Fn(f64) -> f64) -> Vec<SurfacePoint> {
    let (sin, cos) = inclination.sin_cos();
    (-n..=n)
        .map(|k| {
            let t = f64::from(k) / f64::from(n);
            let (u, v) = (100.0 * t, height(t));
            SurfacePoint {
                x: DRUM.x + u * cos - v * sin,
                y: DRUM.y + u * sin + v * cos,
            }
        })
        .collect()
}

/// The same with a roughness added, one value for each of its 2 n + 1 points.
fn rough_surface(
    inclination: f64,
    rough: &[f64],
    height: impl Fn(f64) -> f64,
) -> Vec<SurfacePoint> {
    let n = i32::try_from(rough.len() / 2).unwrap();
    let (sin, cos) = inclination.sin_cos();
    let mut points = surface(inclination, n, height);
    for (p, v) in points.iter_mut().zip(rough) {
        *p = SurfacePoint {
            x: p.x - v * sin,
            y: p.y + v * cos,
        };
    }
    points
}

fn mirrored(points: &[SurfacePoint]) -> Vec<SurfacePoint> {
    points
        .iter()
        .map(|p| SurfacePoint {
            x: 2.0 * DRUM.x - p.x,
            y: p.y,
        })
        .collect()
}

/// All three definitions agree on a straight line; 1e-9 rad is rounding.
#[test]
fn a_straight_surface_has_its_inclination_by_every_definition() {
    for k in -7..=7_i32 {
        let inclination = f64::from(k) * 0.2;
        let angle = measure(&surface(inclination, 150, |_| 20.0), &DRUM).unwrap();
        for value in [angle.line, angle.mid, angle.chord] {
            assert!(
                (value - inclination.abs()).abs() < 1e-9,
                "{value} for {inclination}"
            );
        }
        let side = if k > 0 {
            HighSide::Right
        } else {
            HighSide::Left
        };
        assert!(k == 0 || angle.high_side == side, "side at {inclination}");
        assert!(
            angle.standard_error < 1e-9 && angle.curvature.abs() < 1e-9,
            "no roughness"
        );
        assert_eq!(angle.n_rejected, 0);
    }
}

/// A mirror changes the side only; 1e-9 is rounding.
#[test]
fn a_mirrored_surface_has_the_same_angle_and_the_other_side() {
    let mut noise = Stream::new(1, "roughness");
    let rough = correlated(&mut noise, 301, 0.9);
    let points = rough_surface(0.6, &rough, |t| 8.0 * t * t + 6.0 * t * t * t);
    let (one, other) = (
        measure(&points, &DRUM).unwrap(),
        measure(&mirrored(&points), &DRUM).unwrap(),
    );
    assert_eq!(
        (one.high_side, other.high_side),
        (HighSide::Right, HighSide::Left)
    );
    for (a, b) in [
        (one.line, other.line),
        (one.mid, other.mid),
        (one.chord, other.chord),
        (one.standard_error, other.standard_error),
        (one.curvature, other.curvature),
        (one.s_shape, other.s_shape),
    ] {
        assert!((a - b).abs() < 1e-9, "{a} is not {b}");
    }
}

/// The line is one of normal distances, so it turns with the surface; 1e-9 rad is rounding.
#[test]
fn a_turned_surface_has_the_turned_angle() {
    let shape = |t: f64| 10.0 * t * t - 5.0 * t * t * t;
    let first = measure(&surface(-0.4, 150, shape), &DRUM).unwrap();
    let turned = measure(&surface(-0.9, 150, shape), &DRUM).unwrap();
    for (a, b) in [
        (first.line, turned.line),
        (first.mid, turned.mid),
        (first.chord, turned.chord),
    ] {
        assert!((b - a - 0.5).abs() < 1e-9, "{a} turned to {b}");
    }
    assert!(
        (first.curvature - turned.curvature).abs() < 1e-9,
        "shape does not turn"
    );
}

/// Curvature and S of a surface that is exactly such a cubic. The line is not quite the axis the
/// cubic was drawn on, which changes the coefficients by squares of 0.1: 3 % of each.
#[test]
fn shape_coefficients_come_back_with_their_signs() {
    // Falls to the right: downhill is +t. Steep middle: v falls through the middle.
    let points = surface(-0.6, 200, |t| 10.0 * t * t + 20.0 * (t * t * t - 0.6 * t));
    let angle = measure(&points, &DRUM).unwrap();
    assert!(
        (angle.curvature - 0.1).abs() < 0.003 + 0.01,
        "curvature {}",
        angle.curvature
    );
    assert!((angle.s_shape - 0.2).abs() < 0.02, "s {}", angle.s_shape);
    assert!(
        angle.mid > angle.line && angle.line > angle.chord,
        "S: {angle:?}"
    );
}

/// A surface drawn as a cubic over the whole chord, on which u is level by construction: `v / c = 0.1 (t^2 - 1/3) +
/// 0.2 (t^3 - 0.6 t)`. Its coefficients are `2 / (3 sqrt 5) 0.1`, `2 / (5 sqrt 7) 0.2`, 0 and 0, that is the same quantities as
/// curvature and S-shape in another unit. The height is that over a line that lies 6e-3 beside the one it was drawn on, since
/// stations end at 0.94; second order in the height of 0.1: 1e-3.
#[test]
fn a_cubic_surface_has_its_legendre_coefficients() {
    let height = |t: f64| 10.0 * (t * t - 1.0 / 3.0) + 20.0 * (t * t * t - 0.6 * t);
    for inclination in [-0.6, 0.6] {
        let angle = measure(&surface(inclination, 400, height), &DRUM).unwrap();
        let shape = angle.shape.unwrap();
        // Drawn for a surface that falls to the right; t runs downhill there.
        let side = if inclination < 0.0 { 1.0 } else { -1.0 };
        let expected = [
            0.2 / (3.0 * 5.0_f64.sqrt()),
            side * 0.4 / (5.0 * 7.0_f64.sqrt()),
            0.0,
            0.0,
        ];
        for (got, expected) in shape.iter().zip(expected) {
            assert!((got - expected).abs() < 2e-3, "{shape:?} {expected}");
        }
        let ratio = shape[0] / angle.curvature / (2.0 / (3.0 * 5.0_f64.sqrt()));
        assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
    }
}

/// Surfaces drawn with one orthonormal shape of degree 4 or 5 and an amplitude of 0.02 radii: the coefficient comes back, the
/// others stay at 0, and a mirror changes none. The polynomials of Legendre in their closed forms; 1e-3 is second order in
/// the slope of 0.2 that degree 5 has at the rim.
#[test]
fn a_shape_of_higher_degree_is_told_from_curvature_and_s() {
    let p4 = |t: f64| (35.0 * t.powi(4) - 30.0 * t * t + 3.0) / 8.0 * 3.0;
    let p5 = |t: f64| (63.0 * t.powi(5) - 70.0 * t.powi(3) + 15.0 * t) / 8.0 * 11.0_f64.sqrt();
    let shapes: [(&dyn Fn(f64) -> f64, usize); 2] = [(&p4, 2), (&p5, 3)];
    for (height, degree) in shapes {
        let points = surface(-0.6, 400, |t| 2.0 * height(t));
        let shape = measure(&points, &DRUM).unwrap().shape.unwrap();
        for (k, value) in shape.iter().enumerate() {
            let expected = if k == degree { 0.02 } else { 0.0 };
            assert!((value - expected).abs() < 1e-3, "{shape:?}");
        }
        let other = measure(&mirrored(&points), &DRUM).unwrap().shape.unwrap();
        for (a, b) in shape.iter().zip(other) {
            assert!((a - b).abs() < 1e-9, "{shape:?} mirrored {other:?}");
        }
    }
}

/// A surface of which the lower fifth is hidden tells its angle, and no shape of the whole.
#[test]
fn a_surface_that_ends_early_has_no_shape_of_the_whole() {
    let points: Vec<SurfacePoint> = surface(-0.6, 200, |_| 0.0)
        .into_iter()
        .filter(|p| p.x - DRUM.x < 60.0)
        .collect();
    let angle = measure(&points, &DRUM).unwrap();
    assert!((angle.line - 0.6).abs() < 1e-6, "{angle:?}");
    assert_eq!(angle.shape, None);
}

/// On the S above, v = 20 (t^3 - 0.6 t): the middle slope over |t| <= 0.2 is that of the least
/// squares, 20 (0.6 * 0.04 - 0.6) / 100 = -0.1152; the chord is 20 * 0.4 / 100 = +0.08. The ends
/// lie on the circle of the tilted line, not of the axis the S was drawn on: squares of 0.1 of
/// 0.08, 1e-3. The middle is off by station edges, 1e-3.
#[test]
fn middle_and_chord_are_the_slopes_of_their_own_parts() {
    let angle = measure(&surface(-0.6, 400, |t| 20.0 * (t * t * t - 0.6 * t)), &DRUM).unwrap();
    assert!(
        (angle.mid - 0.6 - 0.1152_f64.atan()).abs() < 1.5e-3,
        "mid {}",
        angle.mid
    );
    assert!(
        (angle.chord - 0.6 + 0.08_f64.atan()).abs() < 6e-3,
        "chord {}",
        angle.chord
    );
}

/// Where points are dense must not matter: the right half ten times as dense moves the line of an
/// S by less than the step of a station, 2e-3 rad; plain least squares over the points moves by
/// more than 0.02 rad.
#[test]
fn the_density_of_points_does_not_weigh() {
    let shape = |t: f64| 10.0 * t * t;
    let even = surface(-0.5, 200, shape);
    let mut uneven = even.clone();
    uneven.extend(
        surface(-0.5, 2000, shape)
            .into_iter()
            .filter(|p| p.x > DRUM.x),
    );
    let (a, b) = (
        measure(&even, &DRUM).unwrap().line,
        measure(&uneven, &DRUM).unwrap().line,
    );
    assert!((a - b).abs() < 2e-3, "{a} became {b}");
}

/// A seed stuck above the bed over a tenth of the chord and a curl at the rim are set aside; with
/// them the line would be off by 1.8 degrees. The curl's first 4 hundredths of the radius stay in
/// and lift one end by less than 0.1 degrees.
#[test]
fn a_flying_seed_and_a_rim_curl_are_set_aside() {
    let mut noise = Stream::new(2, "roughness");
    let rough: Vec<f64> = correlated(&mut noise, 401, 0.8)
        .iter()
        .map(|v| 0.3 * v)
        .collect();
    let points = rough_surface(-0.6, &rough, |t| {
        let seed = if (0.3..0.45).contains(&t) { 25.0 } else { 0.0 };
        let curl = if t > 0.9 { 400.0 * (t - 0.9) } else { 0.0 };
        seed + curl
    });
    let reading = read_surface(&points, &DRUM).unwrap();
    assert!(
        (reading.angle.line - 0.6).abs() < 0.1_f64.to_radians(),
        "{:?}",
        reading.angle
    );
    assert!(
        reading.angle.n_rejected >= 30,
        "{} set aside",
        reading.angle.n_rejected
    );
    assert!(
        !reading.used[265],
        "the seed's own points are the ones set aside"
    );
}

/// 1.96 stated standard errors against the truth on 400 rough surfaces, with correlation lengths
/// from none to a fifteenth of the chord. The share of 400 has 1.1 % of its own; the roughness of
/// one surface, 10 to 100 independent pieces, is known to a quarter only, which the error states. Over
/// 3000 surfaces the line was held 96.9, 95.6 and 95 % of the time.
#[test]
fn the_interval_of_each_definition_holds_the_truth_as_often_as_it_says() {
    for rho in [0.0_f64, 0.8, 0.93] {
        let mut noise = Stream::new(3, "roughness");
        let mut held = [0.0; 3];
        for _ in 0..400 {
            let rough = correlated(&mut noise, 401, rho)
                .iter()
                .map(|v| 2.0 * v)
                .collect::<Vec<f64>>();
            let angle = measure(&rough_surface(-0.6, &rough, |_| 0.0), &DRUM).unwrap();
            let definitions = [Definition::Line, Definition::Mid, Definition::Chord];
            for (held, definition) in held.iter_mut().zip(definitions) {
                let off = (angle.by(definition) - 0.6).abs();
                *held += f64::from(u8::from(off <= 1.96 * angle.error_by(definition))) / 400.0;
            }
        }
        for share in held {
            assert!((0.91..0.99).contains(&share), "{held:?} at rho {rho}");
        }
    }
}

#[test]
fn what_is_no_surface_is_refused() {
    let good = surface(0.3, 20, |_| 0.0);
    let mut nan = good.clone();
    nan[5].y = f64::NAN;
    assert!(matches!(
        measure(&nan, &DRUM),
        Err(Error::NotFinitePoint { index: 5, .. })
    ));
    assert!(matches!(
        measure(&good[..5], &DRUM),
        Err(Error::TooFewPoints { n: 5, .. })
    ));
    let short = surface(0.3, 200, |_| 0.0)[150..250].to_vec();
    assert!(matches!(
        measure(&short, &DRUM),
        Err(Error::TooShort { .. })
    ));
    let outside = surface(0.3, 20, |_| 120.0);
    assert!(matches!(
        measure(&outside, &DRUM),
        Err(Error::OutsideDrum { .. })
    ));
    let same = vec![SurfacePoint { x: 1.0, y: 1.0 }; 50];
    assert!(
        measure(&same, &DRUM).is_err(),
        "a single point gives no surface"
    );
    let bad = DrumCircle {
        radius: f64::INFINITY,
        ..DRUM
    };
    assert!(matches!(measure(&good, &bad), Err(Error::BadDrum { .. })));
}

/// A hump beside the wall, low enough to stay in, turns the chord by 0.7 degrees. The data cannot
/// show whether it is surface; the stated error of the chord holds a third of the turn, its roughness alone
/// a tenth.
#[test]
fn a_hump_beside_the_wall_is_in_the_error_of_the_chord() {
    let points = surface(
        -0.6,
        400,
        |t| if t > 0.85 { 20.0 * (t - 0.85) } else { 0.0 },
    );
    let angle = measure(&points, &DRUM).unwrap();
    let off = (angle.chord - 0.6).abs();
    assert!(off.to_degrees() > 0.4, "{angle:?}");
    assert!(off < 3.0 * angle.chord_standard_error, "{angle:?}");
}
