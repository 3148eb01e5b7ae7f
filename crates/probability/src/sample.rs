//! Quantiles of samples.

/// Quantile of a sample, 0 <= `p` <= 1, linear between order statistics, as R's type 7; NaN for an empty sample.
///
/// # Source
/// `[HyndmanFan1996, definition 7]`.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = p.clamp(0.0, 1.0) * last as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of values"
    )]
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The median: the middle value, or the mean of the middle two; NaN for an empty sample.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::{median, quantile};

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&[3.0, 1.0, 9.0]), 3.0);
        assert_eq!(median(&[3.0, 1.0, 9.0, 4.0]), 3.5);
        assert!(median(&[]).is_nan());
    }

    /// R: quantile(c(10, 20, 40, 80), c(0, 0.1, 0.9, 1)) is 10, 13, 68, 80.
    #[test]
    fn quantiles_are_those_of_r() {
        let of = |p| quantile(&[40.0, 10.0, 80.0, 20.0], p);
        for (p, expected) in [(0.0, 10.0), (0.1, 13.0), (0.9, 68.0), (1.0, 80.0)] {
            assert!((of(p) - expected).abs() < 1e-12, "{p}: {}", of(p));
        }
    }
}
