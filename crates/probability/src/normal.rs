//! The standard normal distribution.

use statrs::function::erf::{erfc, erfc_inv};
use std::f64::consts::{SQRT_2, TAU};

/// P(Z <= z).
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z / SQRT_2)
}

/// ln P(Z <= z), also far in the lower tail.
pub fn ln_normal_cdf(z: f64) -> f64 {
    if z > -30.0 {
        normal_cdf(z).ln()
    } else {
        // First term of the asymptotic series, relative error below 1/900.
        -0.5 * z * z - (-z).ln() - 0.5 * TAU.ln()
    }
}

/// Density at z.
pub fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / TAU.sqrt()
}

/// The z with P(Z <= z) = `probability`, for 0 < `probability` < 1.
pub fn normal_quantile(probability: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0) {
        return None;
    }
    Some(-normal_upper_quantile(probability))
}

/// The z with P(Z > z) = `upper`; infinite for 0 and, with its sign, for 1.
pub fn normal_upper_quantile(upper: f64) -> f64 {
    SQRT_2 * erfc_inv(2.0 * upper)
}

#[cfg(test)]
mod tests {
    use super::{
        ln_normal_cdf, normal_cdf, normal_density, normal_quantile, normal_upper_quantile,
    };

    /// 2.5758293035489004 is the two-sided 1 % point of the normal tables.
    #[test]
    fn quantiles_agree_with_the_tables() {
        assert!((normal_upper_quantile(0.005) - 2.575_829_303_548_900_4).abs() < 1e-13);
        assert!((normal_quantile(0.005).unwrap() + 2.575_829_303_548_900_4).abs() < 1e-13);
        assert_eq!(normal_quantile(1.0), None);
    }

    /// The derivative of ln Phi is phi over Phi; by central differences, whose error is 1e-9 here. Beyond -30 the slope of
    /// the series is -z - 1/z, that of the function within 2/z^3 of it.
    #[test]
    fn the_logarithm_of_the_lower_tail_has_its_slope() {
        let slope = |z: f64| (ln_normal_cdf(z + 1e-5) - ln_normal_cdf(z - 1e-5)) / 2e-5;
        for z in [-8.0, -1.0, 0.3, 4.0] {
            let expected = normal_density(z) / normal_cdf(z);
            assert!((slope(z) - expected).abs() < 1e-6, "{z}: {}", slope(z));
        }
        assert!((slope(-40.0) - 40.0 - 1.0 / 40.0).abs() < 2.0 / 40.0_f64.powi(3) + 1e-6);
        // The two forms meet at -30.
        assert!((ln_normal_cdf(-29.999_999) - ln_normal_cdf(-30.000_001)).abs() < 2e-3);
    }
}
