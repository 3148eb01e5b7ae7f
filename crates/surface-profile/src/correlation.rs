//! The correlation factor of an ordered sequence.

/// Largest part of the variance that the fit may have absorbed; beyond, the sequence is
/// too short.
const MOST_ABSORBED: f64 = 0.6;

/// Factor by which correlation between neighbours inflates the variance of a mean.
///
/// # Formula
/// `tau = 1 + 2 sum rho(k)`, summed over pairs `rho(2m) + rho(2m + 1)` as long as a pair is
/// positive; at least 1. The lag correlation `r(k)` of residuals about a fit of p parameters is
/// too small by about the part `d = p tau / n` of the variance that the fit absorbed; it is put
/// back, `rho(k) = (1 - d) r(k) + d`, by repetition from d = 0.
///
/// # Source
/// `[Geyer1992, section 3.3]`, initial positive sequence. Ours are the lower limit of 1 (never
/// more information than values) and the correction for p, which for p = 1 is the known bias
/// of the lag covariance about the sample mean, `-variance * tau / n` `[Marriott1954]`.
pub(crate) fn correlation_factor(residuals: &[f64], n_fitted: f64) -> f64 {
    correlation(residuals, n_fitted).factor
}

/// Autocorrelation of an ordered sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Correlation {
    /// The correlation factor, see [`correlation_factor`].
    pub(crate) factor: f64,
    /// Number of the last lag that it holds.
    pub(crate) last_lag: usize,
}

/// The correlation factor of a sequence and how many lags it holds; see [`correlation_factor`].
pub(crate) fn correlation(residuals: &[f64], n_fitted: f64) -> Correlation {
    let none = Correlation {
        factor: 1.0,
        last_lag: 0,
    };
    let n = residuals.len();
    let variance: f64 = residuals.iter().map(|r| r * r).sum();
    if n < 4 || variance <= 0.0 {
        return none;
    }
    let lags: Vec<f64> = (0..=n / 2)
        .map(|lag| {
            let later = residuals.iter().skip(lag);
            let sum: f64 = residuals.iter().zip(later).map(|(a, b)| a * b).sum();
            sum / variance
        })
        .collect();
    let mut tau: f64 = 1.0;
    let mut last_lag = 0;
    for _ in 0..10 {
        let absorbed = (n_fitted * tau / n as f64).min(MOST_ABSORBED);
        let mut sum = 0.0;
        last_lag = 0;
        for (k, pair) in lags.chunks_exact(2).enumerate() {
            let pair = (1.0 - absorbed) * (pair[0] + pair[1]) + 2.0 * absorbed;
            if pair <= 2.0 * absorbed {
                break;
            }
            sum += pair;
            last_lag = 2 * k + 1;
        }
        tau = (2.0 * sum - 1.0).max(1.0);
    }
    Correlation {
        factor: tau,
        last_lag,
    }
}

/// Lag covariance of residuals, up to the first pair of lags that is not positive.
///
/// # Source
/// `[Geyer1992, section 3.3]`, initial positive sequence.
pub(crate) fn lag_covariance(residuals: &[f64]) -> Vec<f64> {
    let n = residuals.len();
    let mut kept = Vec::new();
    for pair in 0..n / 4 {
        let lags = [2 * pair, 2 * pair + 1].map(|lag| {
            let later = residuals.iter().skip(lag);
            residuals.iter().zip(later).map(|(a, b)| a * b).sum::<f64>() / n as f64
        });
        if lags[0] + lags[1] <= 0.0 {
            break;
        }
        kept.extend(lags);
    }
    kept
}
