//! Tests of the density path with beds of known surface.

use crate::{
    DensitySettings, Disc, DrumCircle, Error, HighSide, bulk_level, density_of_discs, measure,
    profile_from_discs,
};
use probability::random_stream::Stream;

const DRUM: DrumCircle = DrumCircle {
    x: 0.01,
    y: -0.02,
    radius: 0.07,
};

/// Spheres of 2 mm radius at random places under a line with signed inclination through the axis
/// shifted by `height` along the normal; `n` in the whole drum.
fn bed(inclination: f64, height: f64, n: usize, seed: u64) -> Vec<Disc> {
    let mut noise = Stream::new(seed, "bed");
    let (sin, cos) = inclination.sin_cos();
    let mut discs = Vec::new();
    for _ in 0..n {
        let (r, turn) = (
            0.068 * noise.uniform().sqrt(),
            std::f64::consts::TAU * noise.uniform(),
        );
        let (x, y) = (r * turn.cos(), r * turn.sin());
        if y * cos - x * sin < height {
            discs.push(Disc {
                x: DRUM.x + x,
                y: DRUM.y + y,
                radius: 0.002,
            });
        }
    }
    discs
}

fn angle_of(discs: &[Disc]) -> crate::SurfaceAngle {
    let points = profile_from_discs(discs, &DRUM, &DensitySettings::for_drum(&DRUM)).unwrap();
    measure(&points, &DRUM).unwrap()
}

/// Beds of 20 000 random spheres: no bias beyond four standard errors of the mean of 12 beds, and
/// each within five of its own stated errors, at any side, slope and filling.
#[test]
fn the_angle_of_a_random_bed_is_the_angle_of_its_line() {
    let (mut sum, mut squares) = (0.0, 0.0);
    let cases = [(0.3, 0.0), (-0.7, 0.01), (0.9, -0.02), (-0.5, -0.035)];
    for (i, (inclination, height)) in cases.iter().cycle().take(12).enumerate() {
        let angle = angle_of(&bed(*inclination, *height, 20_000, i as u64));
        let error = angle.line - f64::abs(*inclination);
        let side = if *inclination > 0.0 {
            HighSide::Right
        } else {
            HighSide::Left
        };
        assert_eq!(angle.high_side, side);
        assert!(
            error.abs() < 5.0 * angle.standard_error + 1e-3,
            "{error} at {inclination}"
        );
        sum += error;
        squares += error * error;
    }
    let mean = sum / 12.0;
    let own = (squares / 12.0 / 12.0).sqrt();
    assert!(
        mean.abs() < 4.0 * own + 2e-4,
        "bias {mean} against {own} rad"
    );
}

/// The grid is symmetric about the axis, so a mirrored bed gives the mirrored density; 1e-6 rad
/// is the rounding of a density kept as f32.
#[test]
fn a_mirrored_bed_has_the_same_angle() {
    let discs = bed(0.6, 0.0, 4000, 7);
    let mirror: Vec<Disc> = discs
        .iter()
        .map(|d| Disc {
            x: 2.0 * DRUM.x - d.x,
            ..*d
        })
        .collect();
    let (one, other) = (angle_of(&discs), angle_of(&mirror));
    assert!(
        (one.line - other.line).abs() < 1e-6,
        "{} and {}",
        one.line,
        other.line
    );
    assert_ne!(one.high_side, other.high_side);
}

/// One clump of five spheres in free flight is a short run on its rays, which the cut with the
/// fewest wrong samples passes over: nothing changes beyond the f32 rounding of the bulk level.
#[test]
fn a_seed_in_flight_does_not_move_the_surface() {
    let mut discs = bed(0.6, 0.0, 20_000, 8);
    let before = angle_of(&discs);
    for k in 0..5 {
        let x = DRUM.x - 0.02 + 0.001 * f64::from(k);
        discs.extend(
            [Disc {
                x,
                y: DRUM.y + 0.03,
                radius: 0.002,
            }; 30],
        );
    }
    let after = angle_of(&discs);
    assert!(
        (before.line - after.line).abs() < 1e-3,
        "{} to {}",
        before.line,
        after.line
    );
}

/// The unit of length is free: metres and millimetres agree to the f32 rounding of the density.
#[test]
fn the_unit_of_length_does_not_matter() {
    let discs = bed(-0.6, 0.0, 4000, 9);
    let big: Vec<Disc> = discs
        .iter()
        .map(|d| Disc {
            x: 1e3 * d.x,
            y: 1e3 * d.y,
            radius: 1e3 * d.radius,
        })
        .collect();
    let drum = DrumCircle {
        x: 1e3 * DRUM.x,
        y: 1e3 * DRUM.y,
        radius: 1e3 * DRUM.radius,
    };
    let points = profile_from_discs(&big, &drum, &DensitySettings::for_drum(&drum)).unwrap();
    let (one, other) = (angle_of(&discs).line, measure(&points, &drum).unwrap().line);
    assert!((one - other).abs() < 1e-5, "{one} and {other}");
}

#[test]
fn empty_full_and_broken_beds_are_refused() {
    let settings = DensitySettings::for_drum(&DRUM);
    let profile = |discs: &[Disc]| profile_from_discs(discs, &DRUM, &settings);
    assert!(matches!(profile(&[]), Err(Error::NoSurface { .. })));
    assert!(
        profile(&bed(0.3, 1.0, 20_000, 3)).is_err(),
        "a full drum has no surface"
    );
    let nan = Disc {
        x: f64::NAN,
        y: 0.0,
        radius: 0.002,
    };
    assert!(matches!(profile(&[nan]), Err(Error::NotFinite { .. })));
    let huge = Disc {
        x: 0.0,
        y: 0.0,
        radius: 2.0,
    };
    assert!(matches!(profile(&[huge]), Err(Error::BadSetting { .. })));
    let fine = DensitySettings {
        cell: 1e-9,
        ..settings
    };
    assert!(
        profile_from_discs(&[], &DRUM, &fine).is_err(),
        "a nanometre grid is a slip"
    );
}

/// Beds of random spheres under a level line at a height h (in radii, from below the axis to above it) fill the segment of
/// the circle, `1/2 + (h sqrt(1 - h²) + asin h) / pi`, of the drum that the spheres reach (0.068 of 0.07 m). The edge is
/// smoothed over 2 mm, which the shell cuts off: 0.03 are allowed. Halving the level once more gives 0.1 more.
#[test]
fn the_filled_share_is_that_of_the_segment() {
    for (seed, height) in [(1, -0.4), (2, 0.0), (3, 0.3)] {
        let discs = bed(0.0, height * DRUM.radius, 20_000, seed);
        let field = density_of_discs(&discs, &DRUM, &DensitySettings::for_drum(&DRUM)).unwrap();
        let level = bulk_level(&field, &DRUM);
        let share = field.share_above(level, &DRUM, 1.0);
        let segment = 0.5
            + (height * f64::sqrt(1.0 - height * height) + f64::asin(height))
                / std::f64::consts::PI;
        assert!(
            (share - segment).abs() < 0.03,
            "{height}: {share} for {segment}"
        );
    }
}
