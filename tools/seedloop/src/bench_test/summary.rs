//! Mean, spread and interval of repeated measurements.

use super::measured::Error;
use probability::t_two_sided_quantile;
use serde::Serialize;

/// Repeated measurements of one coefficient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Summary {
    /// Number of values.
    pub(crate) n: usize,
    /// Mean.
    pub(crate) mean: f64,
    /// Standard deviation of single values.
    pub(crate) sd: f64,
    /// Standard error of the mean.
    pub(crate) se: f64,
    /// Lowest value.
    pub(crate) min: f64,
    /// Highest value.
    pub(crate) max: f64,
    /// 95 % interval of the mean by Student's t.
    pub(crate) interval: [f64; 2],
    /// The values.
    pub(crate) values: Vec<f64>,
}

/// Summarises values.
///
/// # Errors
///
/// Fewer than two values.
pub(crate) fn summarise(values: &[f64]) -> Result<Summary, Error> {
    let n = values.len();
    if n < 2 {
        return Err(Error::TooFew { count: n });
    }
    let mean = values.iter().sum::<f64>() / n as f64;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let sd = (square / (n - 1) as f64).sqrt();
    let se = sd / (n as f64).sqrt();
    // It exists for every positive number of degrees of freedom.
    let quantile = t_two_sided_quantile(0.05, (n - 1) as f64).unwrap_or(f64::NAN);
    Ok(Summary {
        n,
        mean,
        sd,
        se,
        min: values.iter().copied().fold(f64::INFINITY, f64::min),
        max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        interval: [mean - quantile * se, mean + quantile * se],
        values: values.to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::summarise;

    /// Values 1 to 5: mean 3, sd sqrt(2.5), and t(0.975, 4) = 2.776445 as tables print it.
    #[test]
    fn interval_is_that_of_student() {
        let s = summarise(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        assert_eq!((s.n, s.mean, s.min, s.max), (5, 3.0, 1.0, 5.0));
        assert!((s.sd - 2.5_f64.sqrt()).abs() < 1e-15, "{s:?}");
        let half = 2.776445 * (0.5_f64).sqrt();
        assert!((s.interval[1] - 3.0 - half).abs() < 1e-5, "{s:?}");
        assert!(summarise(&[1.0]).is_err(), "one value has no spread");
    }
}
