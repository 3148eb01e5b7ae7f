//! Upper tails and quantiles of the reference distributions.

use statrs::function::beta::checked_beta_reg;
use statrs::function::erf::{erfc, erfc_inv};
use statrs::function::gamma::checked_gamma_ur;

/// Upper tail of a sum of `df` squares at `t`; none when there is nothing to sum.
///
/// # Formula
///
/// With a known covariance chi2: Q(df/2, t/2), the regularised upper incomplete gamma function
/// `[Abramowitz1964, eq. 26.4.19]`. With a covariance estimated with nu degrees of freedom
/// t/df is referred to F(df, nu): I_x(nu/2, df/2) with x = nu / (nu + t)
/// `[Abramowitz1964, eq. 26.6.2]`. Both are the tail itself, not 1 minus the body.
pub(crate) fn upper_tail(t: f64, df: usize, covariance_dof: Option<f64>) -> Option<f64> {
    if df == 0 || !t.is_finite() {
        return None;
    }
    let half = df as f64 / 2.0;
    let t = t.max(0.0);
    match covariance_dof {
        None if t == 0.0 => Some(1.0),
        None => checked_gamma_ur(half, t / 2.0).ok(),
        Some(dof) => checked_beta_reg(dof / 2.0, half, dof / (dof + t)).ok(),
    }
}

/// Standard normal quantile: z with P(Z > z) = `upper`.
pub(crate) fn normal_upper_quantile(upper: f64) -> f64 {
    std::f64::consts::SQRT_2 * erfc_inv(2.0 * upper)
}

/// ln P(Z < z) for a standard normal Z, also far in the lower tail.
pub(crate) fn ln_normal_below(z: f64) -> f64 {
    if z > -30.0 {
        (0.5 * erfc(-z / std::f64::consts::SQRT_2)).ln()
    } else {
        // First term of the asymptotic series, relative error below 1/900.
        -0.5 * z * z - (-z).ln() - 0.5 * std::f64::consts::TAU.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::{normal_upper_quantile, upper_tail};

    /// chi2 with 2 degrees of freedom has the tail exp(-t/2) exactly.
    #[test]
    fn chi_squared_tail_with_two_degrees_of_freedom_is_exponential() {
        for t in [0.5, 10.0, 300.0] {
            let p = upper_tail(t, 2, None).unwrap();
            assert!((p / (-t / 2.0).exp() - 1.0).abs() < 1e-12, "{t}: {p}");
        }
    }

    /// F(2, nu) has the tail (1 + t/nu)^(-nu/2) with t = 2 f.
    #[test]
    fn f_tail_with_two_degrees_of_freedom_is_a_power() {
        for t in [0.5_f64, 10.0, 300.0] {
            let p = upper_tail(t, 2, Some(8.0)).unwrap();
            let exact = (1.0 + t / 8.0).powi(-4);
            assert!((p / exact - 1.0).abs() < 1e-12, "{t}: {p}");
        }
    }

    /// 2.5758293035489004 is the two-sided 1 % point of the normal tables.
    #[test]
    fn normal_quantile_agrees_with_the_tables() {
        assert!((normal_upper_quantile(0.005) - 2.575_829_303_548_900_4).abs() < 1e-13);
    }
}
