//! Where the start-up of a time series ends.

use serde::{Deserialize, Serialize};

/// Where a series is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Truncation {
    /// Number of values to leave out at the start.
    pub cut: usize,
    /// Marginal standard error of the rest, unit of the series.
    pub standard_error: f64,
    /// Whether the cut lies in the first half: otherwise the series is too short to tell.
    pub steady: bool,
}

impl Truncation {
    /// The same with at least so many values left out.
    pub(crate) fn not_before(self, cut: usize) -> Self {
        Self {
            cut: self.cut.max(cut),
            ..self
        }
    }
}

/// The marginal-standard-error rule: leave out so many values that the standard error of the
/// mean of the rest is least.
///
/// # Formula
///
/// minimise over d: `sum over i > d of (x_i - mean of the rest)² / (n - d)²`
///
/// with x the means of batches of `batch` values; d is searched over all batches, but at least
/// four batches stay. Returns none if there are fewer than eight batches.
///
/// # Source
///
/// `[White1997]`; batches of five are usual there (MSER-5).
pub fn marginal_standard_error_rule(series: &[f64], batch: usize) -> Option<Truncation> {
    let batch = batch.max(1);
    let means: Vec<f64> = series
        .chunks_exact(batch)
        .map(|c| c.iter().sum::<f64>() / batch as f64)
        .collect();
    let n = means.len();
    if n < 8 {
        return None;
    }
    let score = |cut: usize| {
        let rest = &means[cut..];
        let m = rest.len() as f64;
        let mean = rest.iter().sum::<f64>() / m;
        rest.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (m * m)
    };
    let best = (0..=n - 4).min_by(|&a, &b| score(a).total_cmp(&score(b)))?;
    Some(Truncation {
        cut: best * batch,
        standard_error: score(best).sqrt(),
        steady: best <= n / 2,
    })
}

#[cfg(test)]
mod tests {
    use super::marginal_standard_error_rule;
    use random_stream::Stream;

    /// A ramp of 40 values that ends on a noisy level: the cut lies within one batch of the end
    /// of the ramp (the last values of the ramp are inside the noise).
    #[test]
    fn the_cut_is_where_a_ramp_ends() {
        let mut stream = Stream::new(4, "ramp");
        let series: Vec<f64> = (0..200)
            .map(|i| f64::from(i.min(40)) + 0.5 * stream.normal())
            .collect();
        let cut = marginal_standard_error_rule(&series, 5).unwrap();
        assert!((35..=45).contains(&cut.cut), "{cut:?}");
        assert!(cut.steady, "{cut:?}");
    }

    #[test]
    fn an_endless_ramp_is_not_steady() {
        let series: Vec<f64> = (0..200).map(f64::from).collect();
        let cut = marginal_standard_error_rule(&series, 5).unwrap();
        assert!(!cut.steady, "{cut:?}");
    }

    #[test]
    fn too_short_a_series_gives_no_answer() {
        assert!(
            marginal_standard_error_rule(&[1.0; 30], 5).is_none(),
            "six batches"
        );
    }
}
