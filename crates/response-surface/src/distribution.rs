//! Upper tails and quantiles of the distributions that tests need.
//!
//! Tails come from the incomplete beta and gamma functions themselves, never as 1 - cdf, so a
//! p value of 1e-28 keeps its digits. Beyond a million degrees of freedom about ten digits are
//! left, because the argument of the beta function then lies within 1e-6 of 1.

use statrs::distribution::{ContinuousCDF as _, Normal};
use statrs::function::{beta::checked_beta_reg, gamma::checked_gamma_ur};

/// P(F >= f) of the F distribution with `df1` and `df2` degrees of freedom, which need not be
/// whole; none where it is undefined.
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

/// P(|T| >= |t|) of Student's distribution with `df` degrees of freedom, which need not be whole;
/// none where it is undefined.
///
/// # Source
/// `[Abramowitz1964, eq. 26.7.1]`.
pub fn t_two_sided_tail(t: f64, df: f64) -> Option<f64> {
    f_upper_tail(t * t, 1.0, df)
}

/// The t with P(|T| >= t) = `tail`, for 0 < `tail` < 1; none where it is undefined.
///
/// Found by bisection on the tail to the last bit or two, for any real `df` > 0.
pub fn t_two_sided_quantile(tail: f64, df: f64) -> Option<f64> {
    if !(tail > 0.0 && tail < 1.0 && df > 0.0 && df.is_finite()) {
        return None;
    }
    let mut high = 1.0;
    while t_two_sided_tail(high, df)? > tail {
        high *= 2.0;
        if !f64::is_finite(high * high) {
            return None;
        }
    }
    let mut low = 0.0;
    // Each step halves the bracket; 100 steps exhaust the digits from any start.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if t_two_sided_tail(middle, df)? > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// P(chi2 >= x) with `df` degrees of freedom; none where it is undefined.
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

/// The x with P(chi2 >= x) = `tail`, for 0 < `tail` < 1; none where it is undefined.
pub fn chi_squared_quantile(tail: f64, df: f64) -> Option<f64> {
    if !(tail > 0.0 && tail < 1.0 && df > 0.0 && df.is_finite()) {
        return None;
    }
    let mut high = 1.0;
    while chi_squared_upper_tail(high, df)? > tail {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if chi_squared_upper_tail(middle, df)? > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// The z with P(Z <= z) = `probability` of the standard normal distribution, 0 < `probability` < 1.
pub fn normal_quantile(probability: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0) {
        return None;
    }
    Some(Normal::standard().inverse_cdf(probability))
}

/// P(Z <= z) of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// Density of the standard normal distribution.
pub(crate) fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{
        chi_squared_upper_tail, f_upper_tail, normal_quantile, t_two_sided_quantile,
        t_two_sided_tail,
    };

    fn assert_close(got: Option<f64>, expected: f64) {
        let got = got.unwrap();
        assert!(
            (got / expected - 1.0).abs() < 1e-12,
            "got {got}, expected {expected}"
        );
    }

    /// Closed forms; 1e-12 relative covers the rounding of the incomplete beta function.
    #[test]
    fn tails_agree_with_closed_forms_far_out() {
        // Student with 1 degree of freedom is Cauchy: 2/pi arctan(1/t).
        for t in [0.3_f64, 2.0, 1e6] {
            let expected = 2.0 / std::f64::consts::PI * (1.0 / t).atan();
            assert_close(t_two_sided_tail(t, 1.0), expected);
        }
        // F with 2 and d: (1 + 2 f / d)^(-d/2).
        for f in [0.1_f64, 3.0, 500.0] {
            assert_close(
                f_upper_tail(f, 2.0, 68.0),
                (1.0 + 2.0 * f / 68.0).powf(-34.0),
            );
        }
        // Chi squared with 2: exp(-x/2).
        assert_close(chi_squared_upper_tail(90.0, 2.0), (-45.0_f64).exp());
    }

    #[test]
    fn quantile_inverts_the_tail_for_fractional_degrees_of_freedom() {
        for df in [0.5, 3.6666, 7.0, 300.0] {
            for tail in [0.05, 0.0046, 1e-9] {
                let t = t_two_sided_quantile(tail, df).unwrap();
                assert_close(t_two_sided_tail(t, df), tail);
            }
        }
    }

    #[test]
    fn undefined_tails_are_none() {
        assert_eq!(f_upper_tail(f64::NAN, 1.0, 2.0), None);
        assert_eq!(f_upper_tail(1.0, 1.0, 0.0), None);
        assert_eq!(t_two_sided_quantile(0.0, 3.0), None);
        assert_eq!(t_two_sided_quantile(0.05, 0.0), None);
        assert_eq!(normal_quantile(1.0), None);
    }
}
