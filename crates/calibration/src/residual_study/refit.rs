//! Fits of parameters and amplitudes by the linear model, inside their bounds.

use super::runs::{Linearisation, Means, Setting};
use super::{Observed, ResidualPlan, assemble};
use crate::Error;
use crate::least_squares::{BoundedProblem, bounded_least_squares};
use nalgebra::{DMatrix, DVector};
use residual_diagnosis::Sign;

/// Fits the declared parameters to the used conditions and the priors, about means at a point.
pub(super) fn declared(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    point: &[f64],
    means: &Means,
) -> Result<Vec<f64>, Error> {
    let problem = linear_problem(plan, observed, linear, &[], (point, &[]), means)?;
    bounded_least_squares(&problem, point)
}

/// Fits parameters and amplitudes of some effects together.
///
/// Without runs the model is that of the linearisation; with the means of runs at a point, these
/// replace its constant part.
pub(super) fn with_effects(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    effects: &[String],
    runs: Option<(&Setting, &Means)>,
) -> Result<Setting, Error> {
    let taken: Vec<usize> = effects
        .iter()
        .filter_map(|name| plan.effects.iter().position(|e| e.name == *name))
        .collect();
    let (parameters, amplitudes): (Vec<f64>, Vec<f64>) = match runs {
        None => (
            plan.declared.iter().map(|d| d.start).collect(),
            vec![0.0; taken.len()],
        ),
        Some((point, _)) => (
            plan.declared
                .iter()
                .map(|d| point.parameters[&d.name])
                .collect(),
            taken
                .iter()
                .map(|&j| point.effects[&plan.effects[j].name])
                .collect(),
        ),
    };
    let means = runs.map_or(&linear.nominal, |r| r.1);
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
    let root = assemble::whitener(observed, linear, means.n)?.l();
    let (n, width) = (plan.declared.len() + taken.len(), plan.observables.len());
    let at: Vec<f64> = point.0.iter().chain(point.1).copied().collect();
    let (mut matrix, mut target) = (Vec::new(), Vec::new());
    for c in (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used) {
        let slopes = DMatrix::from_fn(width, n, |k, j| match j.checked_sub(plan.declared.len()) {
            None => linear.declared[c][k][j],
            Some(e) => linear.library[c][k][taken[e]],
        });
        let residual = DVector::from_fn(width, |k, _| observed.values[c][k] - means.values[c][k]);
        let residual = residual + &slopes * DVector::from_column_slice(&at);
        let unsolved = || Error::Search {
            what: "whitened rows",
            reason: "the covariance has a zero on its diagonal".into(),
        };
        let white = root.solve_lower_triangular(&slopes).ok_or_else(unsolved)?;
        let right = root
            .solve_lower_triangular(&residual)
            .ok_or_else(unsolved)?;
        for k in 0..width {
            matrix.push(white.row(k).iter().copied().collect());
            target.push(right[k]);
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
    let effect = |&j: &usize| &plan.effects[j];
    let least = |e: &super::EffectProbe| {
        if e.sign == Sign::Positive {
            0.0
        } else {
            -e.largest
        }
    };
    let most = |e: &super::EffectProbe| {
        if e.sign == Sign::Negative {
            0.0
        } else {
            e.largest
        }
    };
    let bounds = |end: usize| plan.declared.iter().map(move |d| d.bounds[end]);
    Ok(BoundedProblem {
        matrix,
        target,
        low: bounds(0)
            .chain(taken.iter().map(effect).map(least))
            .collect(),
        high: bounds(1)
            .chain(taken.iter().map(effect).map(most))
            .collect(),
    })
}
