//! Fits of parameters and amplitudes by the linear model, inside their bounds.

use super::runs::{Linearisation, Means, Setting};
use super::{Observed, ResidualPlan, assemble};
use crate::Error;
use crate::least_squares::{BoundedProblem, bounded_least_squares};
use nalgebra::{DMatrix, DVector};

/// Fits parameters and the amplitudes of some effects together to the used conditions and the priors, about the means
/// of runs at a point.
pub(super) fn with_effects(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    effects: &[String],
    (point, means): (&Setting, &Means),
) -> Result<Setting, Error> {
    let taken: Vec<usize> = effects
        .iter()
        .filter_map(|name| plan.effects.iter().position(|e| e.name == *name))
        .collect();
    let parameter = |d: &super::DeclaredParameter| point.parameters[&d.name];
    let parameters: Vec<f64> = plan.declared.iter().map(parameter).collect();
    let amplitude = |&j: &usize| point.effects[&plan.effects[j].name];
    let amplitudes: Vec<f64> = taken.iter().map(amplitude).collect();
    let problem = linear_problem(
        plan,
        observed,
        linear,
        &taken,
        (&parameters, &amplitudes),
        means,
    )?;
    let start: Vec<f64> = parameters.iter().chain(&amplitudes).copied().collect();
    let solution = bounded_least_squares(&problem, &start)?;
    let (parameters, amplitudes) = solution.split_at(plan.declared.len());
    let mut setting = Setting::declared(plan, parameters);
    for (&j, amplitude) in taken.iter().zip(amplitudes) {
        setting
            .effects
            .insert(plan.effects[j].name.clone(), *amplitude);
    }
    Ok(setting)
}

/// Whitened rows of the used conditions and of the priors, about a point.
fn linear_problem(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    taken: &[usize],
    point: (&[f64], &[f64]),
    means: &Means,
) -> Result<BoundedProblem, Error> {
    let n = plan.declared.len() + taken.len();
    let at: Vec<f64> = point.0.iter().chain(point.1).copied().collect();
    let (mut matrix, mut target) = (Vec::new(), Vec::new());
    for c in (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used) {
        let measured = observed.measured(c);
        let root = assemble::root(observed, linear, 1.0 / means.n[c] as f64, c)?;
        let slope = |k: usize, j: usize| match j.checked_sub(plan.declared.len()) {
            None => linear.declared[c][k][j],
            Some(e) => linear.library[c][k][taken[e]],
        };
        let slopes = DMatrix::from_fn(measured.len(), n, |row, j| slope(measured[row], j));
        let pairs = observed.values[c].iter().zip(&means.values[c]);
        let residuals = pairs.filter_map(|(y, f)| y.map(|y| y - f));
        let residual = DVector::from_iterator(measured.len(), residuals)
            + &slopes * DVector::from_column_slice(&at);
        let unsolved = || Error::Search {
            what: "whitened rows",
            reason: "the covariance has a zero on its diagonal".into(),
        };
        let white = root.solve_lower_triangular(&slopes).ok_or_else(unsolved)?;
        let right = root
            .solve_lower_triangular(&residual)
            .ok_or_else(unsolved)?;
        for (row, value) in white.row_iter().zip(right.iter()) {
            matrix.push(row.iter().copied().collect());
            target.push(*value);
        }
    }
    for (j, declared) in plan.declared.iter().enumerate() {
        if let Some([mean, sd]) = declared.prior {
            matrix.push(
                (0..n)
                    .map(|i| if i == j { 1.0 / sd } else { 0.0 })
                    .collect(),
            );
            target.push(mean / sd);
        }
    }
    let amplitudes = |end: usize| taken.iter().map(move |&j| plan.effects[j].range[end]);
    let bounds = |end: usize| plan.declared.iter().map(move |d| d.bounds[end]);
    Ok(BoundedProblem {
        matrix,
        target,
        low: bounds(0).chain(amplitudes(0)).collect(),
        high: bounds(1).chain(amplitudes(1)).collect(),
    })
}
