//! Likelihood of a fit, with the penalties that models are compared by.

use serde::{Deserialize, Serialize};

use super::anova::Sums;

/// Likelihood and information criteria; smaller is better. Only their differences between models
/// of the same data mean something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Information {
    /// -2 ln of the greatest likelihood.
    pub minus_2_log_likelihood: f64,
    /// Akaike's criterion.
    pub aic: f64,
    /// The same corrected for few observations; none unless n > p + 2.
    pub aicc: Option<f64>,
    /// Schwarz's criterion.
    pub bic: f64,
}

/// The criteria of a fit; none if it leaves no residuals.
///
/// # Formula
/// `-2 ln L = n ln(2 pi sse / n) + n - sum ln w`; with m = p + 1 parameters (the variance is one):
/// `AIC = -2 ln L + 2 m`, `AICc = AIC + 2 m (m + 1) / (n - m - 1)`, `BIC = -2 ln L + m ln n`.
///
/// # Source
/// `AICc`: `[HurvichTsai1989]`; BIC: `[Schwarz1978]`.
pub(crate) fn information(sums: &Sums, weights: &[f64], p: usize) -> Option<Information> {
    let n = weights.len() as f64;
    let logs: f64 = weights.iter().map(|w| w.ln()).sum();
    let base = n * (2.0 * std::f64::consts::PI * sums.sse / n).ln() + n - logs;
    if !base.is_finite() {
        return None;
    }
    let m = (p + 1) as f64;
    let aic = base + 2.0 * m;
    let left = n - m - 1.0;
    Some(Information {
        minus_2_log_likelihood: base,
        aic,
        aicc: (left > 0.0).then(|| aic + 2.0 * m * (m + 1.0) / left),
        bic: base + m * n.ln(),
    })
}
