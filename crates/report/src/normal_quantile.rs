//! Quantiles of the normal distribution, as exactly as a chart needs them.

/// Distribution function of the standard normal distribution.
///
/// # Formula
/// Φ(x) = 1/2 + φ(x) Σ x^(2k+1) / (1·3·5···(2k+1)) `[Abramowitz1964, eq. 26.2.11]`. The series
/// converges for every x; it is used here for |x| below 8 only.
fn normal_distribution(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    let mut odd = 1.0;
    while term.abs() > 1e-17 * sum.abs() {
        odd += 2.0;
        term *= x * x / odd;
        sum += term;
    }
    0.5 + sum * normal_density(x)
}

/// Density of the standard normal distribution.
fn normal_density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

/// Quantile of the half-normal distribution: the z with P(|Z| < z) = `probability` in (0, 1).
///
/// Newton's method on Φ(z) = (1 + p) / 2 from z = 0; the distribution function is concave for
/// z > 0, so the steps approach the root from below without overshooting.
pub(crate) fn half_normal_quantile(probability: f64) -> f64 {
    let wanted = 0.5 * (1.0 + probability);
    let mut z: f64 = 0.0;
    for _ in 0..100 {
        let step = (wanted - normal_distribution(z)) / normal_density(z);
        z += step;
        if step.abs() < 1e-12 * (1.0 + z) || z > 7.5 {
            break;
        }
    }
    z.min(7.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_equal_the_tabulated_ones() {
        // Two-sided normal limits: 50 %, 90 %, 95 %, 99 %, 99.9 %. Tolerance: digits of the table.
        for (probability, quantile) in [
            (0.5, 0.674_489_75),
            (0.9, 1.644_853_63),
            (0.95, 1.959_963_98),
            (0.99, 2.575_829_30),
            (0.999, 3.290_526_73),
        ] {
            let found = half_normal_quantile(probability);
            assert!((found - quantile).abs() < 1e-8, "{found} for {probability}");
        }
        assert_eq!(half_normal_quantile(0.0), 0.0);
    }
}
