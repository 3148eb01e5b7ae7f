//! The chi-squared distribution. Degrees of freedom need not be whole.

use crate::quantile_search::quantile_of;
use statrs::function::gamma::checked_gamma_ur;

/// P(chi2 >= x) with `df` degrees of freedom; `None` if undefined.
///
/// # Formula
/// `Q(df/2, x/2)`, Q the regularised upper incomplete gamma function.
///
/// # Source
/// `[Abramowitz1964, eq. 26.4.19]`.
pub fn chi_squared_upper_tail(x: f64, df: f64) -> Option<f64> {
    if !(x >= 0.0 && df > 0.0) {
        return None;
    }
    if x == 0.0 {
        return Some(1.0);
    }
    checked_gamma_ur(df / 2.0, x / 2.0).ok()
}

/// The x with P(chi2 >= x) = `tail`, for 0 < `tail` < 1 and finite `df`; `None` if undefined.
pub fn chi_squared_quantile(tail: f64, df: f64) -> Option<f64> {
    if !df.is_finite() {
        return None;
    }
    quantile_of(tail, |x| chi_squared_upper_tail(x, df))
}

#[cfg(test)]
mod tests {
    use super::{chi_squared_quantile, chi_squared_upper_tail};

    /// With 2 degrees of freedom the tail is exp(-x/2). 1e-12 relative covers the rounding of the gamma function.
    #[test]
    fn tail_and_quantile_agree_with_their_closed_forms_far_out() {
        for x in [0.5_f64, 10.0, 90.0, 300.0] {
            let expected = (-0.5 * x).exp();
            let got = chi_squared_upper_tail(x, 2.0).unwrap();
            assert!((got / expected - 1.0).abs() < 1e-12, "{got}, {expected}");
            let back = chi_squared_quantile(expected, 2.0).unwrap();
            assert!((back / x - 1.0).abs() < 1e-12, "{back}, {x}");
        }
        assert_eq!(chi_squared_upper_tail(0.0, 3.0), Some(1.0));
        assert_eq!(chi_squared_upper_tail(-1.0, 3.0), None);
        assert_eq!(chi_squared_quantile(0.05, f64::INFINITY), None);
    }
}
