//! What was measured of one observable, and how well it is known.

use serde::{Deserialize, Serialize};

/// Use of a measurement; decided before anyone looks at a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The estimate may use it.
    Fit,
    /// No fit and no choice sees it; the estimate is judged by it.
    Check,
    /// Simulated at the estimate and printed beside the measurement; nothing is judged by it.
    Show,
}

/// A measured mean, or a measured standard deviation.
///
/// ```
/// use inference::{Measurement, Role};
/// // The drum was photographed 16 times.
/// let angle = Measurement {
///     model: 0,
///     observable: "angle_deg".into(),
///     role: Role::Fit,
///     mean: 36.0,
///     sd: 0.8,
///     n: 16.0,
///     is_scatter: false,
/// };
/// assert!((angle.variance().sqrt() - 0.2).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Number of the model.
    pub model: usize,
    /// Name of the observable.
    pub observable: String,
    /// Its use.
    pub role: Role,
    /// Mean, in the unit of the observable.
    pub mean: f64,
    /// Standard deviation of the single values.
    pub sd: f64,
    /// Number of independent values; not whole where it is an effective number of correlated ones.
    pub n: f64,
    /// Whether the value is itself a standard deviation s: `mean` is s, `sd` is s / sqrt(2), and `n` is one less than the number of
    /// values behind it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_scatter: bool,
}

/// Least value that a standard deviation is expected to have, as a share of the measured one: a surface may fall to 0 and below.
const LEAST_SCATTER: f64 = 0.1;

/// Standard error of a measured standard deviation if the simulated one is true, over that if the measured one is.
pub(crate) fn scatter_ratio(simulated: f64, measured: f64) -> f64 {
    (simulated / measured).max(LEAST_SCATTER)
}

impl Measurement {
    /// Variance of the mean: sd² / n.
    pub fn variance(&self) -> f64 {
        self.sd * self.sd / self.n
    }

    /// Variance of the measured value if what is simulated is true.
    ///
    /// # Formula
    ///
    /// Of a mean: `sd² / n`. Of a standard deviation: that times the square of simulated over measured value, which is
    /// `sigma² / (2 (N - 1))` for N values and the simulated sigma. The error of a standard deviation is a share of the true one; a share
    /// of the one that was found would make a sample that scatters little by chance look well known.
    pub fn variance_at(&self, simulated: f64) -> f64 {
        if self.is_scatter {
            self.variance() * scatter_ratio(simulated, self.mean).powi(2)
        } else {
            self.variance()
        }
    }

    /// Degrees of freedom of that variance: n - 1; infinite for a single value with a standard deviation that is known otherwise, and
    /// for a measured standard deviation, whose error follows from the simulated value.
    pub fn degrees_of_freedom(&self) -> f64 {
        if self.n > 1.0 && !self.is_scatter {
            self.n - 1.0
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Measurement, Role};
    use probability::{chi_squared_quantile, normal_quantile};

    /// A standard deviation of ten values, 0.59.
    fn scatter() -> Measurement {
        Measurement {
            model: 0,
            observable: "fluctuation_deg".into(),
            role: Role::Check,
            mean: 0.59,
            sd: 0.59 / 2.0_f64.sqrt(),
            n: 9.0,
            is_scatter: true,
        }
    }

    /// (N - 1) s² / sigma² is chi-squared on N - 1 degrees of freedom: for a sigma at which the found s is a quantile of tail p,
    /// (s - sigma) / error must be the normal quantile of that tail. The distribution of s is a little skewed, and its median lies 4 %
    /// below sigma: by hand 0.16 at most. With the error at the found s the quantile of 1 % would lie 4.6 errors off, and that of 99 % 1.5.
    #[test]
    fn the_error_of_a_standard_deviation_follows_from_the_simulated_one() {
        let measured = scatter();
        for tail in [0.01, 0.05, 0.5, 0.95, 0.99] {
            let quantile = chi_squared_quantile(1.0 - tail, 9.0).unwrap();
            let sigma = measured.mean * (9.0 / quantile).sqrt();
            let z = (measured.mean - sigma) / measured.variance_at(sigma).sqrt();
            let exact = normal_quantile(tail).unwrap();
            assert!((z - exact).abs() < 0.17, "{tail}: {z} for {exact}");
        }
    }

    /// The variance of a mean does not depend on what is simulated.
    #[test]
    fn the_error_of_a_mean_is_that_of_its_values() {
        let mean = Measurement {
            is_scatter: false,
            ..scatter()
        };
        assert_eq!(mean.variance_at(5.0), mean.variance());
        assert_eq!(mean.degrees_of_freedom(), 8.0);
        assert_eq!(scatter().degrees_of_freedom(), f64::INFINITY);
    }
}
