//! Weighted least squares of a linear model inside bounds.

use crate::Error;
use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;

/// Minimise |b - A x|² with low <= x <= high; rows of A and b are already whitened.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundedProblem {
    /// A, (rows, parameters).
    pub matrix: Vec<Vec<f64>>,
    /// b, (rows).
    pub target: Vec<f64>,
    /// Lower bounds (parameters).
    pub low: Vec<f64>,
    /// Upper bounds (parameters).
    pub high: Vec<f64>,
}

/// The same in free variables: x = low + (high - low) (1 + sin u) / 2 keeps every x inside.
struct Free<'a>(&'a BoundedProblem);

impl BoundedProblem {
    /// Sum of squares at x.
    pub fn sum_of_squares(&self, x: &[f64]) -> f64 {
        let row = |a: &Vec<f64>| a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        self.matrix
            .iter()
            .zip(&self.target)
            .map(|(a, b)| (b - row(a)).powi(2))
            .sum()
    }
}

impl Free<'_> {
    /// Parameters that belong to free variables.
    fn inside(&self, free: &[f64]) -> Vec<f64> {
        let bounds = self.0.low.iter().zip(&self.0.high);
        free.iter()
            .zip(bounds)
            .map(|(u, (low, high))| low + (high - low) * 0.5 * (1.0 + u.sin()))
            .collect()
    }
}

impl CostFunction for Free<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, free: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.0.sum_of_squares(&self.inside(free)))
    }
}

/// Solves the problem by Nelder and Mead's simplex in free variables, restarted from its own
/// result until a restart no longer gains; without parameters there is nothing to search.
///
/// # Errors
///
/// An optimiser that gives up.
pub fn bounded_least_squares(problem: &BoundedProblem, start: &[f64]) -> Result<Vec<f64>, Error> {
    let failed = |reason: String| Error::Search {
        what: "the declared parameters",
        reason,
    };
    if start.is_empty() {
        return Ok(Vec::new());
    }
    let cost = Free(problem);
    let mut best: Vec<f64> = start
        .iter()
        .zip(problem.low.iter().zip(&problem.high))
        .map(|(x, (low, high))| {
            let share = if high > low {
                (x - low) / (high - low)
            } else {
                0.5
            };
            (2.0 * share.clamp(1e-6, 1.0 - 1e-6) - 1.0).asin()
        })
        .collect();
    let mut least = f64::INFINITY;
    for restart in 0..50 {
        let size = if restart % 2 == 0 { 0.4 } else { 0.05 };
        let mut simplex = vec![best.clone()];
        for k in 0..best.len() {
            let mut corner = best.clone();
            corner[k] += size;
            simplex.push(corner);
        }
        let solver = NelderMead::new(simplex)
            .with_sd_tolerance(1e-14)
            .map_err(|e| failed(e.to_string()))?;
        let result = Executor::new(Free(problem), solver)
            .configure(|state| state.max_iters(4000))
            .run()
            .map_err(|e| failed(e.to_string()))?;
        let found = result.state().get_best_cost();
        if let Some(parameters) = result.state().get_best_param() {
            best.clone_from(parameters);
        }
        if restart > 1 && least - found <= 1e-12 * (1.0 + least.abs()) {
            break;
        }
        least = least.min(found);
    }
    Ok(cost.inside(&best))
}

#[cfg(test)]
mod tests {
    use super::{BoundedProblem, bounded_least_squares};

    fn problem(high: f64) -> BoundedProblem {
        BoundedProblem {
            matrix: vec![vec![1.0, 0.0], vec![0.0, 2.0], vec![1.0, 1.0]],
            target: vec![0.3, 1.0, 0.8],
            low: vec![0.0, 0.0],
            high: vec![1.0, high],
        }
    }

    /// A model without parameters fits as it is.
    #[test]
    fn no_parameters_are_no_search() {
        let problem = BoundedProblem {
            matrix: vec![Vec::new()],
            target: vec![1.0],
            low: Vec::new(),
            high: Vec::new(),
        };
        let none = bounded_least_squares(&problem, &[]).unwrap();
        assert!(none.is_empty());
    }

    /// Consistent equations with the solution (0.3, 0.5) inside the bounds.
    #[test]
    fn a_solution_inside_the_bounds_is_found() {
        let x = bounded_least_squares(&problem(1.0), &[0.9, 0.1]).unwrap();
        assert!(
            (x[0] - 0.3).abs() < 1e-6 && (x[1] - 0.5).abs() < 1e-6,
            "{x:?}"
        );
    }

    /// With x2 <= 0.2 the best x1 solves 2 x1 = 0.3 + 0.6, so x1 = 0.45.
    #[test]
    fn a_solution_on_a_bound_is_found() {
        let x = bounded_least_squares(&problem(0.2), &[0.5, 0.1]).unwrap();
        assert!(
            (x[0] - 0.45).abs() < 1e-5 && (x[1] - 0.2).abs() < 1e-6,
            "{x:?}"
        );
    }
}
