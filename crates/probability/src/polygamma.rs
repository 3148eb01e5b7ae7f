//! Derivatives of ln Gamma: effect of few degrees of freedom on the logarithm of a variance.

/// First derivative of ln Gamma at x > 0.
pub fn digamma(x: f64) -> f64 {
    statrs::function::gamma::digamma(x)
}

/// Second derivative of ln Gamma for x > 0: the recurrence up to 10, then the asymptotic series
/// `[Abramowitz1964, 6.4.6 and 6.4.12]`.
pub fn trigamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = 1.0 / 6.0 - y * (1.0 / 30.0 - y * (1.0 / 42.0 - y / 30.0));
    sum + 1.0 / x + y / 2.0 + y / x * series
}

/// The x > 0 with this trigamma, by bisection of its logarithm: trigamma falls from infinity to 0.
pub fn inverse_trigamma(value: f64) -> f64 {
    let (mut low, mut high) = (-20.0_f64, 20.0_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if trigamma(middle.exp()) > value {
            low = middle;
        } else {
            high = middle;
        }
    }
    low.exp()
}

#[cfg(test)]
mod tests {
    use super::{digamma, inverse_trigamma, trigamma};

    /// -gamma and -gamma - 2 ln 2, exact; the slope is trigamma, by central differences whose error is 1e-9.
    #[test]
    fn digamma_has_its_known_values_and_its_slope() {
        let euler = 0.577_215_664_901_532_9;
        assert!((digamma(1.0) + euler).abs() < 1e-12);
        assert!((digamma(0.5) + euler + 2.0 * std::f64::consts::LN_2).abs() < 1e-12);
        let slope = (digamma(3.5 + 1e-5) - digamma(3.5 - 1e-5)) / 2e-5;
        assert!((slope - trigamma(3.5)).abs() < 1e-7);
    }

    /// pi^2/6 and pi^2/2, exact; the inverse gives the argument back. Tolerance: the series ends at 1e-10.
    #[test]
    fn trigamma_has_its_known_values() {
        let square = std::f64::consts::PI.powi(2);
        assert!((trigamma(1.0) - square / 6.0).abs() < 1e-9);
        assert!((trigamma(0.5) - square / 2.0).abs() < 1e-9);
        for x in [0.02, 1.3, 400.0] {
            assert!((inverse_trigamma(trigamma(x)) / x - 1.0).abs() < 1e-6);
        }
    }
}
