//! Effect of the smoothing of a field on a curved surface, and its correction.

use crate::{DrumCircle, Field, SurfacePoint, bulk_level, free_surface, measure};

const DRUM: DrumCircle = DrumCircle {
    x: 0.0,
    y: 0.0,
    radius: 1.0,
};

/// The normal distribution function, to 1.5e-7 `[Abramowitz1964, eq. 7.1.26]`.
fn normal(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = [
        0.254_829_592,
        -0.284_496_736,
        1.421_413_741,
        -1.453_152_027,
        1.061_405_429,
    ];
    let tail = series.iter().rev().fold(0.0, |sum, a| (sum + a) * t) * (-x * x).exp() / 2.0;
    if z > 0.0 { 1.0 - tail } else { tail }
}

/// An S over the drum: its middle falls to the right at 0.4, its ends are level.
fn height(x: f64) -> f64 {
    0.4 * (x * x * x / 3.0 - x)
}

/// Everything under the S, smoothed by a Gaussian of standard deviation `sd`: along y in closed form,
/// along x by 61 nodes.
fn smoothed(sd: f64) -> Field {
    let (n, cell) = (481_usize, 0.005);
    let first = -1.2;
    let nodes: Vec<(f64, f64)> = (-30..=30)
        .map(|k| f64::from(k) / 6.0)
        .map(|z| (z, (-0.5 * z * z).exp() / 6.0 / std::f64::consts::TAU.sqrt()))
        .collect();
    let mut values = Vec::new();
    for j in 0..n {
        let y = first + j as f64 * cell;
        for i in 0..n {
            let x = first + i as f64 * cell;
            let under = |z: f64| normal((height(x - sd * z) - y) / sd);
            let share: f64 = nodes.iter().map(|(z, weight)| weight * under(*z)).sum();
            #[expect(clippy::cast_possible_truncation, reason = "a field holds f32")]
            values.push(share as f32);
        }
    }
    Field::new(SurfacePoint { x: first, y: first }, cell, n, values).unwrap()
}

/// The line of an S that was smoothed over 0.06 radii is that of the sharp S to 0.01 degrees, the
/// next order of the curvature; without the correction it is 0.08 degrees too flat. The sharp
/// S has the smoothing of a cell and the same rays.
#[test]
fn the_smoothing_of_a_bent_surface_is_taken_off() {
    let sd = 0.06;
    let line = |field: &Field| {
        let points = free_surface(field, bulk_level(field, &DRUM), &DRUM, 0.95).unwrap();
        measure(&points, &DRUM).unwrap().line
    };
    let exact = line(&smoothed(0.005));
    let field = smoothed(sd);
    let as_it_stands = (line(&field) - exact).to_degrees();
    let taken_off = (line(&field.smoothed_by(sd).unwrap()) - exact).to_degrees();
    assert!(as_it_stands < -0.06, "{as_it_stands} {taken_off}");
    assert!(taken_off.abs() < 0.01, "{taken_off}");
}
