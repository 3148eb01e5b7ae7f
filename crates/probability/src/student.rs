//! Student's t distribution. Degrees of freedom need not be whole.

use crate::f::f_upper_tail;
use crate::quantile_search::quantile_of;

/// P(|T| >= |t|) with `df` degrees of freedom; `None` if undefined.
///
/// # Source
/// `[Abramowitz1964, eq. 26.7.1]`.
pub fn t_two_sided_tail(t: f64, df: f64) -> Option<f64> {
    f_upper_tail(t * t, 1.0, df)
}

/// The t with P(|T| >= t) = `tail`, for 0 < `tail` < 1 and finite `df`; `None` if undefined.
pub fn t_two_sided_quantile(tail: f64, df: f64) -> Option<f64> {
    if !df.is_finite() {
        return None;
    }
    quantile_of(tail, |t| t_two_sided_tail(t, df))
}

#[cfg(test)]
mod tests {
    use super::{t_two_sided_quantile, t_two_sided_tail};

    /// Student with 1 degree of freedom is Cauchy: 2/pi arctan(1/t). 1e-12 relative covers the rounding of the
    /// incomplete beta function.
    #[test]
    fn the_tail_agrees_with_its_closed_form_far_out() {
        for t in [0.3_f64, 2.0, 1e6] {
            let expected = 2.0 / std::f64::consts::PI * (1.0 / t).atan();
            let got = t_two_sided_tail(t, 1.0).unwrap();
            assert!((got / expected - 1.0).abs() < 1e-12, "{got}, {expected}");
        }
    }

    #[test]
    fn the_quantile_inverts_the_tail_for_fractional_degrees_of_freedom() {
        for df in [0.5, 3.6666, 7.0, 300.0] {
            for tail in [0.05, 0.0046, 1e-9] {
                let t = t_two_sided_quantile(tail, df).unwrap();
                let got = t_two_sided_tail(t, df).unwrap();
                assert!((got / tail - 1.0).abs() < 1e-12, "{got}, {tail}");
            }
        }
        assert_eq!(t_two_sided_quantile(0.0, 3.0), None);
        assert_eq!(t_two_sided_quantile(0.05, 0.0), None);
        assert_eq!(t_two_sided_quantile(0.05, f64::INFINITY), None);
    }
}
