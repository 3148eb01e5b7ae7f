//! From runs to the residual problem, and to errors.

use super::runs::{Linearisation, Means};
use super::{DeclaredParameter, ErrorPair, Observed, RealErrors, ResidualPlan};
use crate::Error;
use nalgebra::{Cholesky, DMatrix, DVector};
use residual_diagnosis::{CovarianceInput, Level, PriorPrecision, ProblemFile};

/// Sum of two covariances, the second scaled.
pub(super) fn added(a: &[Vec<f64>], b: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.iter().zip(b).map(|(x, y)| x + factor * y).collect())
        .collect()
}

/// Covariance scaled.
fn scaled(a: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    a.iter()
        .map(|row| row.iter().map(|x| x * factor).collect())
        .collect()
}

/// The problem file of a study at the fitted parameters.
///
/// The observation noise goes in as known. The noise of the simulator enters three times: in the
/// residual (mean of n runs), and in each sensitivity (difference of two means of n runs). What an
/// effect does to the conditions kept apart is not predicted here: real runs tell it.
pub(super) fn problem(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    fitted: &[f64],
    at_fit: &Means,
) -> ProblemFile {
    let used = || (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    let condition = |c: usize| {
        let levels = plan.conditions[c].condition.iter();
        levels
            .map(|(name, value)| (name.clone(), Level::Number(*value)))
            .collect()
    };
    let residual = used().flat_map(|c| {
        let pairs = observed.values[c].iter().zip(&at_fit.values[c]);
        pairs.map(|(y, f)| Some(y - f)).collect::<Vec<_>>()
    });
    let slope_noise = |step: f64| {
        let runs = 2.0 / linear.nominal.n as f64;
        CovarianceInput::Matrix(scaled(&linear.run_covariance, runs / (step * step)))
    };
    let simulator = scaled(&linear.run_covariance, 1.0 / at_fit.n as f64);
    let any_prior = plan.declared.iter().any(|d| d.prior.is_some());
    ProblemFile {
        id: plan.id.clone(),
        conditions: used().map(condition).collect(),
        observables: plan.observables.clone(),
        residual_obs_minus_sim: residual.collect(),
        cov_measurement: Some(CovarianceInput::Matrix(observed.covariance.clone())),
        cov_simulator: Some(CovarianceInput::Matrix(simulator)),
        covariance_dof: Some(linear.noise_dof as f64),
        declared: plan.declared.iter().map(|d| d.name.clone()).collect(),
        sensitivities_declared: linear.declared.concat(),
        cov_sensitivities_declared: plan.declared.iter().map(|d| slope_noise(d.step)).collect(),
        prior_precision: any_prior.then(|| {
            let precision = |sd: f64| 1.0 / (sd * sd);
            let each = plan
                .declared
                .iter()
                .map(|d| d.prior.map_or(0.0, |p| precision(p[1])));
            PriorPrecision::Diagonal(each.collect())
        }),
        prior_offset: if any_prior {
            offsets(plan, fitted)
        } else {
            Vec::new()
        },
        library: plan.effects.iter().map(|e| e.name.clone()).collect(),
        sensitivities_library: linear.library.concat(),
        cov_sensitivities_library: plan.effects.iter().map(|e| slope_noise(e.probe)).collect(),
        largest_amplitudes: plan
            .effects
            .iter()
            .map(|e| (e.name.clone(), e.largest))
            .collect(),
        signs: plan
            .effects
            .iter()
            .map(|e| (e.name.clone(), e.sign))
            .collect(),
        ..ProblemFile::default()
    }
}

/// Prior mean minus fitted value of each parameter; 0 where it is free.
fn offsets(plan: &ResidualPlan, fitted: &[f64]) -> Vec<f64> {
    let offset = |(d, x): (&DeclaredParameter, &f64)| d.prior.map_or(0.0, |p| p[0] - x);
    plan.declared.iter().zip(fitted).map(offset).collect()
}

/// Root of the inverse covariance of one condition: whitens its residual.
pub(super) fn whitener(
    observed: &Observed,
    linear: &Linearisation,
    n_runs: usize,
) -> Result<Cholesky<f64, nalgebra::Dyn>, Error> {
    let total = added(
        &observed.covariance,
        &linear.run_covariance,
        1.0 / n_runs as f64,
    );
    let n = total.len();
    let matrix = DMatrix::from_fn(n, n, |a, b| total[a][b]);
    Cholesky::new(matrix).ok_or(Error::Search {
        what: "the root of the covariance",
        reason: "it is not positive definite: are two observables the same?".into(),
    })
}

/// Errors of simulated means against the observations.
pub(super) fn errors(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    simulated: &Means,
) -> Result<ErrorPair, Error> {
    let root = whitener(observed, linear, simulated.n)?;
    let part = |used: bool| {
        let conditions: Vec<usize> = (0..plan.conditions.len())
            .filter(|&c| plan.conditions[c].used == used)
            .collect();
        let residual = |c: usize, k: usize| observed.values[c][k] - simulated.values[c][k];
        let n = conditions.len() as f64;
        let rmse = plan.observables.iter().enumerate().map(|(k, name)| {
            let sum: f64 = conditions.iter().map(|&c| residual(c, k).powi(2)).sum();
            (name.clone(), (sum / n).sqrt())
        });
        let rmse = rmse.collect();
        let width = plan.observables.len();
        let whitened: f64 = conditions
            .iter()
            .map(|&c| {
                let r = DVector::from_fn(width, |k, _| residual(c, k));
                let solved = root.l().solve_lower_triangular(&r);
                solved.map_or(f64::NAN, |w| w.norm_squared())
            })
            .sum();
        (!conditions.is_empty()).then(|| RealErrors {
            rmse,
            whitened_mse: whitened / (n * width as f64),
        })
    };
    let used = part(true).ok_or(Error::Count {
        what: "used conditions",
        got: 0,
        expected: "at least one",
    })?;
    Ok(ErrorPair {
        used,
        kept: part(false),
    })
}
