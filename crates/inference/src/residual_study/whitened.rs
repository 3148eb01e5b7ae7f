//! Measured values of a plan in standard deviations of their noise, that of the measurements and of the runs.

use super::linearisation::Linearisation;
use super::runs::{At, Means, numbers};
use super::{ResidualPlan, assemble};
use crate::Error;
use crate::diagnosis::Covariance;
use nalgebra::{DMatrix, DVector};

/// Degrees of freedom for each observable from which on the scatter of the runs gives their covariance.
const RUNS_TO_KNOW: usize = 3;

/// The rows and columns of a covariance whose observables were measured at a condition.
pub(super) fn of_measured(plan: &ResidualPlan, c: usize, covariance: &[Vec<f64>]) -> DMatrix<f64> {
    let measured = plan.measured(c);
    let n = measured.len();
    DMatrix::from_fn(n, n, |a, b| covariance[measured[a]][measured[b]])
}

/// A covariance of the measured values with one block a condition.
fn blocks(plan: &ResidualPlan, at: At, block: impl Fn(usize) -> DMatrix<f64>) -> Covariance {
    let conditions = numbers(plan, at);
    let name = |&c: &usize| plan.conditions[c].name(&plan.base.model);
    let names = conditions.iter().map(name).collect();
    Covariance::new(conditions.into_iter().map(block).collect(), names)
}

/// Covariance of the measured values and of so many times a run at each condition.
pub(super) fn covariance(
    plan: &ResidualPlan,
    linear: &Linearisation,
    at: At,
    runs: impl Fn(usize) -> f64,
) -> Covariance {
    blocks(plan, at, |c| {
        let (own, of_run) = (&plan.conditions[c].covariance, &linear.run_covariance[c]);
        of_measured(plan, c, &assemble::added(own, of_run, runs(c)))
    })
}

/// That of so many times a run alone.
pub(super) fn of_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    at: At,
    runs: impl Fn(usize) -> f64,
) -> Covariance {
    blocks(plan, at, |c| {
        of_measured(plan, c, &linear.run_covariance[c]) * runs(c)
    })
}

/// The difference of two means at the used conditions, or another of so many runs, in standard deviations of the runs; of those of the
/// measurements too if the runs are too few for their covariance.
pub(super) fn difference(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: impl Fn(usize) -> f64,
    value: impl Fn(usize, usize) -> f64,
) -> Result<DVector<f64>, Error> {
    let of_block = |c: usize| {
        let block = of_measured(plan, c, &linear.run_covariance[c]) * runs(c);
        let known = linear.least_dof() >= (RUNS_TO_KNOW * block.nrows()) as f64;
        let alone = Covariance::new(vec![block.clone()], vec![String::new()]);
        if known && alone.whitener().is_ok() {
            return block;
        }
        block + of_measured(plan, c, &plan.conditions[c].covariance)
    };
    let rows = plan.rows(At::Used).into_iter().map(|(c, k)| value(c, k));
    let whitener = blocks(plan, At::Used, of_block).whitener()?;
    Ok(whitener.whiten_vector(&DVector::from_vec(rows.collect())))
}

/// Measured minus simulated.
pub(super) fn residual(plan: &ResidualPlan, at: At, simulated: &[Vec<f64>]) -> Vec<f64> {
    let rows = plan.rows(at).into_iter();
    let off = |(c, k): (usize, usize)| Some(plan.conditions[c].values[k]? - simulated[c][k]);
    rows.filter_map(off).collect()
}

/// The residual of means of so many runs at each condition, whitened; and the sum of the variances that the runs have in it.
pub(super) fn whitened(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: &[usize],
    (simulated, at): (&[Vec<f64>], At),
) -> Result<(Vec<f64>, f64), Error> {
    let share = |c: usize| 1.0 / runs[c] as f64;
    let whitener = covariance(plan, linear, at, share).whitener()?;
    let residual = DVector::from_vec(residual(plan, at, simulated));
    let noise = whitener.whiten_covariance(&of_runs(plan, linear, at, share).whole());
    let white = whitener.whiten_vector(&residual);
    Ok((white.as_slice().to_vec(), noise.trace()))
}

/// Covariance of the means of the runs at the used conditions, whitened as their residual is, in so many rows: 0 behind these.
pub(super) fn whitened_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    means: &Means,
    rows: usize,
) -> Result<DMatrix<f64>, Error> {
    let share = |c: usize| 1.0 / means.n[c] as f64;
    let whitener = covariance(plan, linear, At::Used, share).whitener()?;
    let runs = of_runs(plan, linear, At::Used, share).whole();
    Ok(whitener.whiten_covariance(&runs).resize(rows, rows, 0.0))
}
