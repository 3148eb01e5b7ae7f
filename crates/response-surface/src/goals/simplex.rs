//! Minimum of a function without derivatives.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::neldermead::NelderMead;

/// Spread of the values of the simplex at which the search ends.
const TOLERANCE: f64 = 1e-10;
/// Most steps.
const STEPS: u64 = 2000;
/// A function as argmin takes it.
struct Function<'a>(&'a dyn Fn(&[f64]) -> f64);

impl CostFunction for Function<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, Error> {
        Ok((self.0)(at))
    }
}

/// The least value that is found from `start`, where the function must be finite, and its place. It may be infinite
/// elsewhere.
///
/// # Source
/// The simplex of `[NelderMead1965]`, with sides of `side` at first.
pub(crate) fn minimum(
    start: &[f64],
    side: f64,
    function: &dyn Fn(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let corner = |j: usize| {
        let moved = |by: f64| {
            let mut at = start.to_vec();
            at[j] += by;
            at
        };
        // Away from a wall of infinite values.
        let ahead = moved(side);
        if function(&ahead).is_finite() {
            ahead
        } else {
            moved(-side)
        }
    };
    let simplex = std::iter::once(start.to_vec()).chain((0..start.len()).map(corner));
    let found = NelderMead::new(simplex.collect())
        .with_sd_tolerance(TOLERANCE)
        .and_then(|solver| {
            let executor = Executor::new(Function(function), solver);
            executor.configure(|state| state.max_iters(STEPS)).run()
        });
    // It fails where the function is infinite all round, and then the start is the answer.
    let best = found.ok().and_then(|found| {
        let state = found.state();
        Some((state.get_best_cost(), state.get_best_param()?.clone()))
    });
    best.unwrap_or_else(|| (function(start), start.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::minimum;

    /// Rosenbrock's valley, cut off by a wall of infinite values beside its minimum (1, 1): found to 1e-4.
    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let valley = |x: &[f64]| {
            if x[0] > 1.2 {
                return f64::INFINITY;
            }
            100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2)
        };
        let (value, place) = minimum(&[-1.2, 1.0], 0.5, &valley);
        assert!(value < 1e-8, "{value}");
        assert!(place.iter().all(|x| (x - 1.0).abs() < 1e-4), "{place:?}");
    }
}
