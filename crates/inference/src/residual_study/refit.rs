//! Fits of parameters and amplitudes by the linear model, inside their bounds.

use super::ResidualPlan;
use super::linearisation::Linearisation;
use super::runs::{At, Means, Setting};
use super::whitened::{covariance, of_runs, residual};
use crate::diagnosis::least_squares_step;
use crate::{Error, Prior};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Fits parameters and the amplitudes of some effects together to the used conditions and the priors, about the means
/// of runs at a point.
pub(super) fn with_effects(
    plan: &ResidualPlan,
    linear: &Linearisation,
    effects: &[String],
    (point, means): (&Setting, &Means),
) -> Result<Setting, Error> {
    let (taken, at) = unknowns(plan, effects, point);
    let (matrix, target) = linear_problem(plan, linear, &taken, (&at, means))?;
    let amplitudes = |end: usize| taken.iter().map(move |&j| plan.effects[j].range[end]);
    let bounds = |end: usize| plan.parameters.iter().map(move |d| d.limits[end]);
    let bounds = [0, 1].map(|end| bounds(end).chain(amplitudes(end)).collect::<Vec<f64>>());
    // A point that rounding put outside begins on its bound.
    let at: Vec<f64> = (0..at.len())
        .map(|j| at[j].clamp(bounds[0][j], bounds[1][j]))
        .collect();
    let ways = [0, 1].map(|end: usize| {
        let ways = bounds[end].iter().zip(&at);
        ways.map(|(bound, at)| bound - at).collect::<Vec<f64>>()
    });
    let step = least_squares_step(&matrix, &target, &ways[0], &ways[1]);
    let solution: Vec<f64> = (0..at.len())
        .map(|j| (at[j] + step[j]).clamp(bounds[0][j], bounds[1][j]))
        .collect();
    let (parameters, amplitudes) = solution.split_at(plan.parameters.len());
    let mut setting = Setting::declared(plan, parameters);
    for (&j, amplitude) in taken.iter().zip(amplitudes) {
        setting.effects[j] = *amplitude;
    }
    Ok(setting)
}

/// Standard errors of the parameters, fitted together with the amplitudes of some effects by the slopes at a point; `None` if these do not identify them.
///
/// # Formula
///
/// The roots of the diagonal of `M^-1 A' A M^-1` with `M = A' A - s N`: A are the whitened slopes with the rows of the priors,
/// and N is what their noise adds to `A' A` on average. By `A' A` alone a slope that is half noise would seem to tell twice of
/// what it tells `[Fuller1987, section 2.2]`. The s is 1, or less where M would not be positive definite: the least
/// eigenvalue of `A' A` over N, less one part in the number of rows.
pub(super) fn standard_errors(
    plan: &ResidualPlan,
    linear: &Linearisation,
    effects: &[String],
    (point, means): (&Setting, &Means),
) -> Result<Vec<Option<f64>>, Error> {
    let (taken, at) = unknowns(plan, effects, point);
    let (matrix, _) = linear_problem(plan, linear, &taken, (&at, means))?;
    let whole = matrix.tr_mul(&matrix);
    let noise = noise_of_slopes(plan, linear, &taken, means)?;
    let covariance = covariance_of(&whole, &noise, matrix.nrows());
    let error = |j: usize| {
        let square = covariance.as_ref()?[(j, j)];
        (square > 0.0 && square.is_finite()).then(|| square.sqrt())
    };
    Ok((0..plan.parameters.len()).map(error).collect())
}

/// Covariance of a fit by slopes of which so much is noise; `None` if even the noisy ones do not identify all unknowns.
fn covariance_of(whole: &DMatrix<f64>, noise: &DMatrix<f64>, rows: usize) -> Option<DMatrix<f64>> {
    let root = Cholesky::new(whole.clone())?.l();
    let half = root.solve_lower_triangular(noise)?;
    let share = root.solve_lower_triangular(&half.transpose())?;
    let largest = share.symmetric_eigenvalues().max();
    let part = (1.0 / largest - 1.0 / rows as f64).clamp(0.0, 1.0);
    let part = if largest > 0.0 { part } else { 0.0 };
    let signal = Cholesky::new(whole - noise * part)?.inverse();
    Some(&signal * whole * &signal)
}

/// What the noise of the slopes adds on average to the products of the whitened slopes, (parameters, then amplitudes) squared.
fn noise_of_slopes(
    plan: &ResidualPlan,
    linear: &Linearisation,
    taken: &[usize],
    means: &Means,
) -> Result<DMatrix<f64>, Error> {
    let p = plan.parameters.len();
    let n = p + taken.len();
    let mut noise = DMatrix::zeros(n, n);
    let whitener = covariance(plan, linear, At::Used, |c| 1.0 / means.n[c] as f64).whitener()?;
    let of_run = of_runs(plan, linear, At::Used, |_| 1.0).whole();
    let of_run = whitener.whiten_covariance(&of_run);
    for (row, (c, _)) in plan.rows(At::Used).into_iter().enumerate() {
        let run = of_run[(row, row)];
        for error in linear.declared_errors.iter().filter(|error| error.at[c]) {
            let along = DVector::from_column_slice(&error.along);
            let mut of_declared = noise.view_mut((0, 0), (p, p));
            of_declared += &along * along.transpose() * run;
        }
        for (i, &j) in taken.iter().enumerate() {
            if linear.moves[p + j][c] {
                noise[(p + i, p + i)] += run * linear.library_variance[j];
            }
        }
    }
    Ok(noise)
}

/// The numbers of some effects, and the parameters and their amplitudes at a point.
fn unknowns(plan: &ResidualPlan, effects: &[String], point: &Setting) -> (Vec<usize>, Vec<f64>) {
    let numbers = effects
        .iter()
        .filter_map(|name| plan.effects.iter().position(|e| e.name == *name));
    let taken: Vec<usize> = numbers.collect();
    let at = values_at(&taken, point);
    (taken, at)
}

/// The parameters and the amplitudes of some effects at a point.
pub(super) fn values_at(effects: &[usize], point: &Setting) -> Vec<f64> {
    let amplitudes = effects.iter().map(|&j| point.effects[j]);
    point.parameters.iter().copied().chain(amplitudes).collect()
}

/// Whitened rows of the used conditions and of the priors, and what a step from a point (parameters, then amplitudes) should
/// make of them.
pub(super) fn linear_problem(
    plan: &ResidualPlan,
    linear: &Linearisation,
    taken: &[usize],
    (at, means): (&[f64], &Means),
) -> Result<(DMatrix<f64>, DVector<f64>), Error> {
    let (p, n) = (plan.parameters.len(), plan.parameters.len() + taken.len());
    let whitener = covariance(plan, linear, At::Used, |c| 1.0 / means.n[c] as f64).whitener()?;
    let rows = plan.rows(At::Used);
    let slopes = DMatrix::from_fn(rows.len(), n, |row, j| {
        let (c, k) = rows[row];
        match j.checked_sub(p) {
            None => linear.declared[c][k][j],
            Some(e) => linear.library[c][k][taken[e]],
        }
    });
    let residual = DVector::from_vec(residual(plan, At::Used, &means.values));
    let known = plan.parameters.iter().enumerate();
    let priors: Vec<(usize, Prior)> = known.filter_map(|(j, d)| Some((j, d.prior?))).collect();
    let all = rows.len() + priors.len();
    let mut matrix = whitener.whiten(&slopes).resize_vertically(all, 0.0);
    let mut target = whitener
        .whiten_vector(&residual)
        .resize_vertically(all, 0.0);
    for (i, (j, Prior { mean, sd })) in (rows.len()..).zip(priors) {
        matrix[(i, j)] = 1.0 / sd;
        target[i] = (mean - at[j]) / sd;
    }
    Ok((matrix, target))
}
