//! Quantiles of positive statistics by bisection of their upper tail.

/// The x > 0 with `upper_tail(x)` = `tail`, for 0 < `tail` < 1; `None` if the tail is undefined.
///
/// The bracket doubles until it holds x. Each step halves it; 100 steps exhaust the digits from any start.
pub(crate) fn quantile_of(tail: f64, upper_tail: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    if !(tail > 0.0 && tail < 1.0) {
        return None;
    }
    let mut high = 1.0;
    while upper_tail(high)? > tail {
        high *= 2.0;
        if !f64::is_finite(high * high) {
            return None;
        }
    }
    let mut low = 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if upper_tail(middle)? > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}
