//! What the picture adds to the standard error of its angle.

use crate::rim::Rim;
use surface_profile::{
    DrumCircle, Field, SurfaceAngle, SurfacePoint, SurfaceReading, bulk_level, free_surface,
    read_surface,
};

/// Part of the radius by which two people may set the same circle apart (rim, glass, seal).
const CIRCLE_CHOICE: f64 = 0.008;
/// A circle given by the caller is known to so many pixels.
const GIVEN: f64 = 0.5;
/// Of the distance to a rival ring, what counts as standard deviation: the rim is the one ring or the
/// other, and a distribution of two equally likely values has half of their distance.
const RIVAL_PART: f64 = 0.5;
/// Part of the level by which it is moved up and down.
const LEVEL_STEP: f64 = 0.3;
/// Of the change by the light, what counts as standard deviation: a light of second degree leaves
/// about a fifth of it.
const LIGHT_PART: f64 = 0.2;
/// Flattening that the rim of an upright drum shows by chance.
const CHANCE_FLATTENING: f64 = 0.001;

/// Widens the standard errors of a reading by what depends on drum, threshold and camera.
///
/// # Formula
/// `sqrt(roughness^2 + sum drum^2 + level^2 + light^2 + tilt^2)`, each the change of the angle
/// with one standard deviation of centre and radius (the larger one of both directions), threshold
/// level, light and flattening f;
/// `light` is a fifth of the change from one threshold for all to one that follows the light; `tilt = f / 2`, the
/// largest turn by an ellipse, for f above what chance gives.
pub(crate) fn widened(
    [field, plain]: [&Field; 2],
    level: f64,
    points: &[SurfacePoint],
    surface: &SurfaceReading,
    (circle, reach): (&DrumCircle, f64),
    rim: Option<&Rim>,
) -> SurfaceAngle {
    let at = surface.angle;
    let mut squares = [
        at.standard_error.powi(2),
        at.mid_standard_error.powi(2),
        at.chord_standard_error.powi(2),
    ];
    let mut add = |changes: [f64; 3]| {
        for (square, change) in squares.iter_mut().zip(changes) {
            *square += change * change;
        }
    };
    for pair in moved_circles(circle, rim) {
        let mut most = [0.0_f64; 3];
        for moved in pair {
            if let Ok(other) = read_surface(points, &moved) {
                let changed = changes(&at, &other.angle).map(f64::abs);
                most = [0, 1, 2].map(|k| most[k].max(changed[k]));
            }
        }
        add(most);
    }
    let ends = [1.0 - LEVEL_STEP, 1.0 + LEVEL_STEP].map(|part| {
        free_surface(field, part * level, circle, reach)
            .and_then(|points| read_surface(&points, circle))
    });
    if let [Ok(low), Ok(high)] = ends {
        add(changes(&low.angle, &high.angle).map(|c| 0.5 * c));
    }
    let by_plain = free_surface(plain, bulk_level(plain, circle), circle, reach)
        .and_then(|points| read_surface(&points, circle));
    if let Ok(other) = by_plain {
        add(changes(&at, &other.angle).map(|c| LIGHT_PART * c));
    }
    let flattening = rim.map_or(0.0, |rim| rim.flattening);
    let excess = (flattening.powi(2) - CHANCE_FLATTENING.powi(2)).max(0.0);
    add([0.5 * excess.sqrt(); 3]);
    let [line, mid, chord] = squares.map(f64::sqrt);
    SurfaceAngle {
        standard_error: line,
        mid_standard_error: mid,
        chord_standard_error: chord,
        ..at
    }
}

/// The circle moved by one standard deviation right and left, up and down, outwards and inwards.
fn moved_circles(circle: &DrumCircle, rim: Option<&Rim>) -> [[DrumCircle; 2]; 3] {
    let (place, radius) = rim.map_or((GIVEN, GIVEN), |rim| {
        (rim.error, rim.error.hypot(RIVAL_PART * rim.rival))
    });
    let radius = radius.hypot(CIRCLE_CHOICE * circle.radius);
    let moved = |x: f64, y: f64, radius: f64| DrumCircle {
        x: circle.x + x,
        y: circle.y + y,
        radius: circle.radius + radius,
    };
    [
        [place, -place].map(|d| moved(d, 0.0, 0.0)),
        [place, -place].map(|d| moved(0.0, d, 0.0)),
        [radius, -radius].map(|d| moved(0.0, 0.0, d)),
    ]
}

/// Change of line, middle and chord from one reading to another, rad.
fn changes(one: &SurfaceAngle, other: &SurfaceAngle) -> [f64; 3] {
    [
        other.line - one.line,
        other.mid - one.mid,
        other.chord - one.chord,
    ]
}
