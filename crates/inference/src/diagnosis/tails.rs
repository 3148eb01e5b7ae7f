//! What a sum of squares of noise exceeds by chance.

use probability::{chi_squared_upper_tail, f_upper_tail};

/// Upper tail of a sum of `df` squares at `t`; none when there is nothing to sum.
///
/// # Formula
///
/// With a known covariance chi2 with `df` degrees of freedom. With a covariance estimated with nu degrees of freedom t/df is
/// referred to F(df, nu).
pub(crate) fn upper_tail(t: f64, df: usize, covariance_dof: Option<f64>) -> Option<f64> {
    if df == 0 || !t.is_finite() {
        return None;
    }
    let (t, df) = (t.max(0.0), df as f64);
    match covariance_dof {
        None => chi_squared_upper_tail(t, df),
        Some(dof) => f_upper_tail(t / df, df, dof),
    }
}

#[cfg(test)]
mod tests {
    use super::upper_tail;

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
}
