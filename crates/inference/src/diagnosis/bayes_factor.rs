//! An effect of the library against an unknown smooth effect.

use crate::diagnosis::fit::Fit;
use crate::diagnosis::problem_file::Sign;
use nalgebra::{DMatrix, DVector};
use probability::ln_normal_cdf;

/// Prior standard deviations of the detectability s = |a||u|, averaged: an effect that matters is
/// a few to some ten standard errors large. Doubling them lowers every factor by about ln 2, for
/// effect and rival alike. [statistics of this project, section 4.2, step 6]
const PRIOR_SIZES: [f64; 3] = [2.0, 5.0, 10.0];

/// ln of the Bayes factor of an effect with this score against no effect.
///
/// # Formula
///
/// ln mean over tau of (1 + tau^2)^(-1/2) exp(z^2 tau^2 / (2 (1 + tau^2))); with one sign only,
/// a half-normal prior: times 2 Phi(z tau / sqrt(1 + tau^2)).
pub(crate) fn ln_factor_of_effect(z: f64, sign: Sign) -> f64 {
    let towards = match sign {
        Sign::Any => None,
        Sign::Positive => Some(z),
        Sign::Negative => Some(-z),
    };
    ln_mean(PRIOR_SIZES.iter().map(|tau| {
        let gain = tau * tau / (1.0 + tau * tau);
        let half = towards.map_or(0.0, |z| {
            std::f64::consts::LN_2 + ln_normal_cdf(z * gain.sqrt())
        });
        -0.5 * (tau * tau).ln_1p() + 0.5 * z * z * gain + half
    }))
}

/// ln of the Bayes factor of an unknown smooth effect, beyond what the fit has on, against none.
///
/// # Formula
///
/// r~ ~ N(0, Q + k W W'), W = Q L^-1 G = U D V': ln factor = sum over i of
/// -0.5 ln(1 + k d_i^2) + 0.5 (u_i'r~)^2 k d_i^2 / (1 + k d_i^2). It is averaged over k with
/// k sum d_i^2 = tau^2, so that the unknown effect is expected to be as large as a library effect
/// with the same tau. 0 when there is no smooth column left.
pub(crate) fn ln_factor_of_unknown(fit: &Fit) -> f64 {
    let smooth = fit.smooth_outside();
    ln_factor_of_unknown_in(&smooth, fit.remaining(), smooth.norm_squared())
}

/// The same in columns W with a residual r~ of their rows; `total` is the sum of squares of the columns where the unknown effect is
/// expected to be as large as one of the library.
pub(crate) fn ln_factor_of_unknown_in(
    smooth: &DMatrix<f64>,
    residual: &DVector<f64>,
    total: f64,
) -> f64 {
    if smooth.ncols() == 0 || smooth.nrows() == 0 {
        return 0.0;
    }
    let svd = smooth.clone().svd(true, false);
    let u = svd.u.expect("this factor was asked for");
    let squares: Vec<f64> = svd.singular_values.iter().map(|d| d * d).collect();
    if total <= f64::MIN_POSITIVE {
        return 0.0;
    }
    let coordinates = u.tr_mul(residual);
    ln_mean(PRIOR_SIZES.iter().map(|tau| {
        let k = tau * tau / total;
        squares
            .iter()
            .zip(coordinates.iter())
            .map(|(d2, c)| {
                let variance = k * d2;
                -0.5 * variance.ln_1p() + 0.5 * c * c * variance / (1.0 + variance)
            })
            .sum()
    }))
}

/// ln of the mean of the exponentials, without overflow.
fn ln_mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = values.iter().map(|v| (v - largest).exp()).sum();
    largest + (sum / values.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::{PRIOR_SIZES, ln_factor_of_effect};
    use crate::diagnosis::problem_file::Sign;

    /// The factor is the ratio of the densities of z under N(0, 1 + tau^2) and N(0, 1), averaged:
    /// integrated over z with the null density it gives 1. Trapezoids over -60..60, their error
    /// falls below 1e-9 for these smooth integrands.
    #[test]
    fn factor_averages_to_one_under_the_null_hypothesis() {
        for sign in [Sign::Any, Sign::Positive, Sign::Negative] {
            let step = 0.01;
            let sum: f64 = (-6000..=6000)
                .map(|i| {
                    let z = f64::from(i) * step;
                    let ln_density = -0.5 * z * z - 0.5 * std::f64::consts::TAU.ln();
                    (ln_density + ln_factor_of_effect(z, sign)).exp() * step
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-6, "{sign:?}: {sum}");
        }
    }

    #[test]
    fn no_signal_speaks_against_an_effect_by_its_prior_size() {
        let mean: f64 = PRIOR_SIZES
            .iter()
            .map(|tau| (1.0 + tau * tau).sqrt().recip())
            .sum::<f64>()
            / 3.0;
        assert!((ln_factor_of_effect(0.0, Sign::Any) - mean.ln()).abs() < 1e-14);
    }
}
