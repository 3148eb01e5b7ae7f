//! The distribution of the studentized range: largest minus smallest of k means, over their standard error.

use crate::normal::{normal_cdf, normal_density};
use statrs::function::gamma::ln_gamma;

/// Nodes and weights of Gauss's rule of eight points on -1..+1, those above zero `[Abramowitz1964, table 25.4]`.
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// P(Q >= q) of the studentized range of `k` means with `df` degrees of freedom of their standard error; `None` for
/// fewer than two means, no degrees of freedom, or a negative q.
///
/// # Formula
/// `integral of f(s) W(q s) ds` over s > 0, f the density of `sqrt(chi^2 / df)`, W the upper tail of the range of k
/// standard normal values, `W(w) = k integral of phi(z) [Phi(z)^(k-1) - (Phi(z) - Phi(z - w))^(k-1)] dz`. Both by Gauss's
/// rule in panels; the difference of powers is taken without cancellation, so that small tails keep their digits.
///
/// # Source
/// `[CopenhaverHolland1988]`.
pub fn studentized_range_upper_tail(q: f64, k: usize, df: f64) -> Option<f64> {
    if !(q >= 0.0 && q.is_finite() && k >= 2 && df >= 1.0) {
        return None;
    }
    // The density of s has its bulk at 1 +- 1/sqrt(2 df); ten such widths on either side hold all but 1e-20 for many
    // degrees of freedom, and one degree has a normal tail, gone at 9.
    let width = 1.0 / (2.0 * df).sqrt();
    let (low, high) = ((1.0 - 10.0 * width).max(0.0), 1.0 + 12.0 * width);
    let half = 0.5 * df;
    let log_scale = half * half.ln() + std::f64::consts::LN_2 - ln_gamma(half);
    let density = |s: f64| {
        let power = if df == 1.0 { 0.0 } else { (df - 1.0) * s.ln() };
        (log_scale + power - half * s * s).exp()
    };
    let tail = integral(low, high, 40, &|s| density(s) * range_upper_tail(q * s, k));
    Some(tail.clamp(0.0, 1.0))
}

/// The q with P(Q >= q) = `tail`, for 0 < `tail` < 1; `None` if undefined.
pub fn studentized_range_quantile(tail: f64, k: usize, df: f64) -> Option<f64> {
    if !(tail > 0.0 && tail < 1.0) {
        return None;
    }
    let (mut low, mut high) = (0.0, 2.0);
    while studentized_range_upper_tail(high, k, df)? > tail {
        (low, high) = (high, 2.0 * high);
        if high > 1e6 {
            return None;
        }
    }
    // Each step halves the bracket, to 1e-13 of its width.
    for _ in 0..44 {
        let middle = 0.5 * (low + high);
        if studentized_range_upper_tail(middle, k, df)? > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// P(W >= w) of the range of `k` standard normal values.
fn range_upper_tail(w: f64, k: usize) -> f64 {
    let others = (k - 1) as f64;
    let value = |z: f64| {
        let all = normal_cdf(z);
        if all <= 0.0 {
            return 0.0;
        }
        // a^m - (a - b)^m = -a^m expm1(m ln(1 - b / a)).
        let share = (normal_cdf(z - w) / all).min(1.0);
        let less = -(others * (-share).ln_1p()).exp_m1();
        normal_density(z) * all.powf(others) * less
    };
    (k as f64 * integral(-8.5, 8.5 + w.min(9.0), 24, &value)).min(1.0)
}

/// The integral of a smooth function by Gauss's rule in equal panels.
fn integral(low: f64, high: f64, panels: usize, f: &dyn Fn(f64) -> f64) -> f64 {
    let half = 0.5 * (high - low) / panels as f64;
    let panel = |i: usize| {
        let middle = low + half * (2 * i + 1) as f64;
        let pair =
            |(x, weight): &(f64, f64)| weight * (f(middle - half * x) + f(middle + half * x));
        RULE.iter().map(pair).sum::<f64>()
    };
    half * (0..panels).map(panel).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::{studentized_range_quantile, studentized_range_upper_tail};
    use crate::student::t_two_sided_tail;

    /// Of two means the range is sqrt(2) |t|, for any degrees of freedom; Gauss's rule in panels leaves 1e-9 at one degree,
    /// where the density does not vanish at zero.
    #[test]
    fn the_range_of_two_means_is_students_t() {
        for df in [1.0, 3.0, 20.0, 500.0] {
            for t in [0.3, 1.0, 2.5, 6.0] {
                let got = studentized_range_upper_tail(t * 2.0_f64.sqrt(), 2, df).unwrap();
                let expected = t_two_sided_tail(t, df).unwrap();
                assert!(
                    (got / expected - 1.0).abs() < 1e-8,
                    "{t}, {df}: {got} against {expected}"
                );
            }
        }
    }

    #[test]
    fn the_quantile_inverts_the_tail() {
        let q = studentized_range_quantile(0.05, 4, 12.0).unwrap();
        let tail = studentized_range_upper_tail(q, 4, 12.0).unwrap();
        assert!((tail - 0.05).abs() < 1e-12, "{q}: {tail}");
        assert_eq!(studentized_range_upper_tail(1.0, 1, 5.0), None);
        assert_eq!(studentized_range_quantile(1.5, 3, 5.0), None);
    }
}
