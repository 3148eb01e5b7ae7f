//! The angle over several frames: mean, spread and the uncertainty of the mean.

use crate::Error;
use crate::correlation::correlation_factor;
use serde::{Deserialize, Serialize};

/// Summary of a series in time order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesSummary {
    /// Mean, unit of the values.
    pub mean: f64,
    /// Standard deviation with n - 1, unit of the values; NaN for one value.
    pub sd: f64,
    /// Number of values.
    pub n: usize,
    /// Number of independent values that would fix the mean equally well, 1 to n.
    pub n_effective: f64,
    /// Standard error of the mean, unit of the values; NaN for one value.
    pub standard_error: f64,
}

/// Summarises a series of equally spaced values in time order.
///
/// # Formula
/// `n_effective = n / tau` with the correlation factor `tau` of the lag correlation,
/// `standard_error = sd / sqrt(n_effective)`. Frames far apart in time have `tau = 1`. A series
/// shorter than about 20 frames estimates `tau` poorly.
///
/// # Source
/// `[Geyer1992, section 3.3]`.
///
/// # Errors
/// [`Error::TooFewPoints`] for an empty series, [`Error::NotFinite`] for NaN or infinity.
pub fn summarise(values: &[f64]) -> Result<SeriesSummary, Error> {
    if values.is_empty() {
        return Err(Error::TooFewPoints { n: 0, least: 1 });
    }
    if let Some(index) = values.iter().position(|v| !v.is_finite()) {
        return Err(Error::NotFinite {
            what: "value of the series",
            index,
            value: values[index],
        });
    }
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let residuals: Vec<f64> = values.iter().map(|v| v - mean).collect();
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    let sd = (squares / (n as f64 - 1.0)).sqrt();
    let n_effective = (n as f64 / correlation_factor(&residuals, 1.0)).max(1.0);
    Ok(SeriesSummary {
        mean,
        sd,
        n,
        n_effective,
        standard_error: sd / n_effective.sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::summarise;
    use crate::test_noise::correlated;
    use probability::random_stream::Stream;

    /// Independent values: `n_effective` is at least two thirds of n, as chance correlation only
    /// ever lowers it (its standard deviation is about 10 % for n = 400).
    #[test]
    fn independent_frames_count_in_full() {
        let summary = summarise(&correlated(&mut Stream::new(1, "series"), 400, 0.0)).unwrap();
        assert!(summary.n_effective > 0.67 * 400.0, "{summary:?}");
    }

    /// Lag correlation rho^k has tau = (1 + rho) / (1 - rho) = 9 for 0.8; the estimate from 4000
    /// values has about 10 % of its own, 40 % is four of these.
    #[test]
    fn correlated_frames_count_for_less() {
        let summary = summarise(&correlated(&mut Stream::new(2, "series"), 4000, 0.8)).unwrap();
        let tau = 4000.0 / summary.n_effective;
        assert!((tau / 9.0 - 1.0).abs() < 0.4, "tau {tau}");
        let expected = summary.sd / summary.n_effective.sqrt();
        assert!(
            (summary.standard_error - expected).abs() < 1e-12,
            "{summary:?}"
        );
    }

    #[test]
    fn one_value_has_a_mean_and_no_spread_and_nan_is_refused() {
        let one = summarise(&[0.5]).unwrap();
        assert!(
            one.mean == 0.5 && one.sd.is_nan() && one.n_effective == 1.0,
            "{one:?}"
        );
        assert!(summarise(&[]).is_err(), "nothing has no mean");
        assert!(summarise(&[0.1, f64::NAN]).is_err(), "NaN is refused");
    }
}
