//! The whole surface as a few orthonormal shapes.

use crate::stations::Stations;
use nalgebra::{SMatrix, SVector};

/// Shapes that are fitted together: the degrees 0 to 5.
const SHAPES: usize = 6;
/// Least part of the half-chord that the stations must reach on both sides. Polynomials of degree 5 that are carried on over
/// more than a fifth of the half-chord say nothing of it.
const LEAST_REACH: f64 = 0.8;

/// Coefficients of the degrees 2 to 5 of a surface; `None` if its stations do not reach far enough on both sides.
///
/// # Formula
///
/// Least squares over the stations of `v / R = sum_k a_k sqrt(2 k + 1) P_k(u / c)`, k = 0 to 5, with the Legendre polynomials
/// `P_k`, u downhill along the surface line, v its upward normal from the drum axis, c the half-chord and R the drum radius.
/// The mean square of each shape over the chord is 1: a coefficient is the root mean square height that its shape has on
/// the chord. Degree 0 is the height of the bed, and degree 1 vanishes but for the weights, since u lies along the line.
///
/// # Source
///
/// `[Abramowitz1964, eq. 22.7.10]`, the recurrence of the Legendre polynomials.
pub(crate) fn shape_of(stations: &Stations, radius: f64) -> Option<[f64; 4]> {
    let along = stations.all.iter().map(|s| s.along);
    let low = along.clone().fold(f64::INFINITY, f64::min);
    let high = along.fold(f64::NEG_INFINITY, f64::max);
    if low > -LEAST_REACH || high < LEAST_REACH {
        return None;
    }
    let mut matrix = SMatrix::<f64, SHAPES, SHAPES>::zeros();
    let mut right = SVector::<f64, SHAPES>::zeros();
    for station in &stations.all {
        let row = SVector::from(shapes_at(station.along));
        matrix += row * row.transpose();
        right += row * (station.height / radius);
    }
    let found = matrix.cholesky()?.solve(&right);
    let shape = [found[2], found[3], found[4], found[5]];
    shape.iter().all(|a| a.is_finite()).then_some(shape)
}

/// The shapes at a place along the chord, -1 to 1.
fn shapes_at(t: f64) -> [f64; SHAPES] {
    let mut p = [1.0, t, 0.0, 0.0, 0.0, 0.0];
    for k in 2..SHAPES {
        let n = k as f64;
        p[k] = ((2.0 * n - 1.0) * t * p[k - 1] - (n - 1.0) * p[k - 2]) / n;
    }
    for (k, value) in p.iter_mut().enumerate() {
        *value *= (2.0 * k as f64 + 1.0).sqrt();
    }
    p
}

#[cfg(test)]
mod tests {
    use super::shapes_at;

    /// Means of products over the chord, by Simpson's rule on 2000 steps: its error for degree 10 is below 1e-9.
    #[test]
    fn the_shapes_are_orthonormal() {
        let n = 2000;
        let mean = |i: usize, j: usize| {
            let weight = |k: i32| match k {
                0 => 1.0,
                k if k == n => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let product = |k: i32| {
                let p = shapes_at(-1.0 + 2.0 * f64::from(k) / f64::from(n));
                weight(k) * p[i] * p[j]
            };
            (0..=n).map(product).sum::<f64>() / (3.0 * f64::from(n))
        };
        for (i, j) in (0..6).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let expected = f64::from(u8::from(i == j));
            assert!((mean(i, j) - expected).abs() < 1e-9, "{i} {j}");
        }
    }
}
