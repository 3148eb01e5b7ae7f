//! The F distribution. Degrees of freedom need not be whole.
//!
//! Beyond a million degrees of freedom about ten digits are left, because the argument of the beta function then lies
//! within 1e-6 of 1.

use crate::quantile_search::quantile_of;
use statrs::function::beta::checked_beta_reg;
use statrs::function::gamma::ln_gamma;

/// P(F >= f) with `df1` and `df2` degrees of freedom; `None` if undefined.
///
/// # Formula
/// `I_x(df2/2, df1/2)` at `x = df2 / (df2 + df1 f)`, I the regularised incomplete beta function.
///
/// # Source
/// `[Abramowitz1964, eq. 26.6.2]`.
pub fn f_upper_tail(f: f64, df1: f64, df2: f64) -> Option<f64> {
    if !(f >= 0.0 && df1 > 0.0 && df2 > 0.0) {
        return None;
    }
    checked_beta_reg(df2 / 2.0, df1 / 2.0, df2 / (df2 + df1 * f)).ok()
}

/// The f with P(F >= f) = `tail`, for 0 < `tail` < 1; `None` if undefined.
pub fn f_quantile(tail: f64, df1: f64, df2: f64) -> Option<f64> {
    quantile_of(tail, |f| f_upper_tail(f, df1, df2))
}

/// P(F' >= f) of the noncentral F distribution with 1 and `df` degrees of freedom and noncentrality `lambda`.
///
/// # Formula
/// `sum_j Poisson(j; lambda / 2) I_x(df/2, 1/2 + j)`, `x = df / (df + f)`.
///
/// # Source
/// `[Abramowitz1964, eq. 26.6.20]`.
pub fn noncentral_f_upper_tail(f: f64, df: f64, lambda: f64) -> f64 {
    let half = 0.5 * lambda;
    let x = df / (df + f);
    let tail = |j: f64| checked_beta_reg(df / 2.0, 0.5 + j, x).unwrap_or(0.0);
    // What is farther than 12 standard deviations from the mean weighs less than 1e-30.
    let around = 12.0 * half.sqrt() + 40.0;
    let mut j = (half - around).max(0.0).floor();
    // Each tail is larger than the one before.
    if tail(j) > 1.0 - f64::EPSILON {
        return 1.0;
    }
    let mut sum = 0.0;
    let mut log_weight = j * half.max(f64::MIN_POSITIVE).ln() - half - ln_gamma(j + 1.0);
    while j <= half + around {
        sum += log_weight.exp() * tail(j);
        j += 1.0;
        log_weight += half.max(f64::MIN_POSITIVE).ln() - j.ln();
    }
    sum.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::{checked_beta_reg, f_quantile, f_upper_tail, noncentral_f_upper_tail};

    /// F with 2 and d: (1 + 2 f / d)^(-d/2). 1e-12 relative covers the rounding of the incomplete beta function.
    #[test]
    fn the_tail_agrees_with_its_closed_form_far_out() {
        for f in [0.1_f64, 3.0, 500.0] {
            let expected = (1.0 + 2.0 * f / 68.0).powf(-34.0);
            let got = f_upper_tail(f, 2.0, 68.0).unwrap();
            assert!((got / expected - 1.0).abs() < 1e-12, "{got}, {expected}");
        }
        assert_eq!(f_upper_tail(f64::NAN, 1.0, 2.0), None);
        assert_eq!(f_upper_tail(1.0, 1.0, 0.0), None);
    }

    /// The closed form above, solved for f: (tail^(-2/d) - 1) d / 2.
    #[test]
    fn the_quantile_agrees_with_its_closed_form() {
        for tail in [0.5_f64, 0.025, 1e-9] {
            let expected = 34.0 * (tail.powf(-1.0 / 34.0) - 1.0);
            let got = f_quantile(tail, 2.0, 68.0).unwrap();
            assert!((got / expected - 1.0).abs() < 1e-12, "{got}, {expected}");
        }
        assert_eq!(f_quantile(1.0, 2.0, 3.0), None);
    }

    /// Reference: R 4.2.2, sum(dpois(j, 4) * pbeta(8 / (8 + f), 4, 0.5 + j)), j = 0 to 200; its pf with ncp = 8 differs from
    /// that by 3e-10. Without noncentrality it is F itself.
    #[test]
    fn the_noncentral_tail_is_that_of_r() {
        let by_r = 0.698_459_057_338_846;
        let got = noncentral_f_upper_tail(5.317_655_071_578_714, 8.0, 8.0);
        assert!((got - by_r).abs() < 1e-10, "{got}");
        let central = noncentral_f_upper_tail(5.317_655_071_578_714, 8.0, 0.0);
        assert!((central - 0.05).abs() < 1e-12);
    }

    /// Far from 0 the sum begins near its largest terms: it is that of all terms, and where all tails are 1 it is 1 at once.
    #[test]
    fn a_large_noncentrality_changes_no_sum() {
        let (f, df, half) = (2000.0, 8.0, 1000.0_f64);
        let mut log_weight = -half;
        let mut all = 0.0;
        for j in 0..2000 {
            let tail = checked_beta_reg(df / 2.0, 0.5 + f64::from(j), df / (df + f)).unwrap();
            all += log_weight.exp() * tail;
            log_weight += half.ln() - f64::from(j + 1).ln();
        }
        let got = noncentral_f_upper_tail(f, df, 2.0 * half);
        assert!(
            (0.3..0.7).contains(&all) && (got - all).abs() < 1e-9,
            "{got}, {all}"
        );
        assert_eq!(noncentral_f_upper_tail(5.0, 8.0, 1e9), 1.0);
    }
}
