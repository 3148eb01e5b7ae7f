//! Standard errors of slopes from the roughness of one surface.

use crate::correlation::{correlation_factor, lag_covariance};
use crate::cubic::Cubic;
use crate::stations::Stations;

/// Step of the heights in the derivatives, parts of the half-chord.
const STEP: f64 = 1e-4;

/// Smallest number of degrees of freedom of the residuals. A smooth shape other than a
/// cubic leaves waves that look like fewer; they are a shape and not random.
const LEAST_FREEDOM: f64 = 3.0;

/// Fraction of the degrees of freedom that is left if the correlation factor is estimated from the same
/// residuals. On 3000 surfaces each with 15 and 45 independent pieces the interval of the line holds
/// the truth in 95 % with a third; with a half in 92 and 95 %.
pub(crate) const TAU_PART: f64 = 1.0 / 3.0;

/// Roughness of a surface and its effect on the slope of the line.
pub(crate) struct LineError {
    /// Standard error of the slope, rad.
    pub(crate) slope: f64,
    /// Root mean square residual about the cubic, unit of the caller.
    pub(crate) roughness: f64,
    /// Factor by which few independent pieces and the cubic widen an interval, 1.
    pub(crate) widening: f64,
}

/// Residuals of the stations about the cubic, unit of the caller.
fn residuals(stations: &Stations, whole: &Cubic) -> Vec<f64> {
    stations
        .all
        .iter()
        .map(|s| s.height - whole.at(s.along))
        .collect()
}

/// Standard error of the line from the residuals about the cubic; formula at [`crate::measure`].
pub(crate) fn line_error(stations: &Stations, whole: &Cubic) -> LineError {
    let residuals = residuals(stations, whole);
    let n = residuals.len() as f64;
    let mean_square = residuals.iter().map(|r| r * r).sum::<f64>() / n;
    let tau = correlation_factor(&residuals, 4.0);
    let independent = n / tau;
    let freedom = (independent - 4.0).max(LEAST_FREEDOM);
    let variance = mean_square * (independent / freedom).max(1.0);
    let centre = stations.positions().map(|p| p.0).sum::<f64>() / n;
    let suu: f64 = stations.positions().map(|p| (p.0 - centre).powi(2)).sum();
    LineError {
        slope: (variance * tau / suu).sqrt() * widening((TAU_PART * freedom).max(LEAST_FREEDOM)),
        roughness: mean_square.sqrt(),
        widening: (independent / freedom).max(1.0).sqrt() * widening(freedom),
    }
}

/// The 97.5 % point of Student's distribution over 1.96.
///
/// # Formula
/// `1 + (z^2 + 1) / (4 f) + (5 z^4 + 16 z^2 + 3) / (96 f^2) +
/// (3 z^6 + 19 z^4 + 17 z^2 - 15) / (384 f^3)`, z = 1.96.
///
/// # Source
/// `[Abramowitz1964, eq. 26.7.5]`, three terms: 1 % low at 3 degrees of freedom f.
pub(crate) fn widening(freedom: f64) -> f64 {
    let z2 = 1.96_f64.powi(2);
    1.0 + (z2 + 1.0) / (4.0 * freedom)
        + (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / (96.0 * freedom.powi(2))
        + (3.0 * z2.powi(3) + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / (384.0 * freedom.powi(3))
}

/// A slope as a function of stations and their cubic, rad.
pub(crate) type Slope<'a> = &'a dyn Fn(&Stations, &Cubic) -> f64;

/// Standard errors of slopes that depend on few stations, rad.
///
/// # Formula
/// `sqrt(sum_ij w_i C(i - j) w_j)` times the widening; w by finite differences, C the lag
/// covariance of the residuals up to where their pairs stop being positive.
pub(crate) fn functional_errors<const N: usize>(
    stations: &Stations,
    whole: &Cubic,
    widening: f64,
    slopes: [Slope<'_>; N],
) -> [f64; N] {
    let covariance = lag_covariance(&residuals(stations, whole));
    let step = STEP * stations.half_chord;
    let base = slopes.map(|slope| slope(stations, whole));
    let mut weights = vec![[0.0; N]; stations.all.len()];
    let mut moved = stations.clone();
    for (i, weights) in weights.iter_mut().enumerate() {
        moved.all[i].height += step;
        let cubic = Cubic::fit(moved.all.iter().map(|s| (s.along, s.height, 1.0)));
        for (k, weight) in weights.iter_mut().enumerate() {
            *weight = (slopes[k](&moved, &cubic.unwrap_or(*whole)) - base[k]) / step;
        }
        moved.all[i] = stations.all[i];
    }
    std::array::from_fn(|k| {
        let mut variance = 0.0;
        for (i, first) in weights.iter().enumerate() {
            for (lag, value) in covariance.iter().enumerate().take(weights.len() - i) {
                let twice = if lag == 0 { 1.0 } else { 2.0 };
                variance += twice * value * first[k] * weights[i + lag][k];
            }
        }
        variance.max(0.0).sqrt() * widening
    })
}

#[cfg(test)]
mod tests {
    use super::widening;

    /// Tabulated 97.5 % points: 3.182 for 3 degrees of freedom, 2.228 for 10; the series leaves 1 %.
    #[test]
    fn few_pieces_widen_as_students_distribution_does() {
        for (freedom, point) in [(3.0, 3.182), (10.0, 2.228), (1e9, 1.960)] {
            let ratio = 1.96 * widening(freedom) / point;
            assert!((ratio - 1.0).abs() < 0.01, "{freedom}: {ratio}");
        }
    }
}
