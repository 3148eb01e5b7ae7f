//! Minimum of a function without derivatives.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::neldermead::NelderMead;

/// Spread of the values of the simplex at which a descent ends.
const TOLERANCE: f64 = 1e-10;
/// Most steps of a descent.
const STEPS: u64 = 2000;
/// Most descents, each from where the one before ended.
const DESCENTS: usize = 10;

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
/// The simplex of `[NelderMead1965]`, started again at its end with sides of `side` until that gains nothing.
pub(crate) fn minimum(
    start: &[f64],
    side: f64,
    function: &dyn Fn(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let mut best = (function(start), start.to_vec());
    for _ in 0..DESCENTS {
        let corner = |j: usize| {
            let moved = |by: f64| {
                let mut at = best.1.clone();
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
        let simplex = std::iter::once(best.1.clone()).chain((0..start.len()).map(corner));
        let found = NelderMead::new(simplex.collect())
            .with_sd_tolerance(TOLERANCE)
            .and_then(|solver| {
                let executor = Executor::new(Function(function), solver);
                executor.configure(|state| state.max_iters(STEPS)).run()
            });
        // It fails where the function is infinite all round, and then the start is the answer.
        let Ok(found) = found else { break };
        let value = found.state().get_best_cost();
        let Some(place) = found.state().get_best_param() else {
            break;
        };
        let gain = best.0 - value;
        if gain > 0.0 {
            best = (value, place.clone());
        }
        if gain.is_nan() || gain < 1e-8 {
            break;
        }
    }
    best
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
