//! From runs to the residual problem, and to errors.

use super::linearisation::Linearisation;
use super::runs::{At, Means, Setting};
use super::whitened::{of_measured, residual, whitened};
use super::{ErrorPair, RealErrors, ResidualPlan};
use crate::diagnosis::{
    Condition, CovarianceInput, KeptCondition, Level, PriorPrecision, ProblemFile,
};
use crate::{Error, Parameter, Prior};
use std::collections::BTreeMap;

/// Beyond so many degrees of freedom a variance is nearly known.
const MANY: f64 = 1e6;

/// Sum of two covariances, the second scaled.
pub(super) fn added(a: &[Vec<f64>], b: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.iter().zip(b).map(|(x, y)| x + factor * y).collect())
        .collect()
}

fn scaled(a: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    a.iter()
        .map(|row| row.iter().map(|x| x * factor).collect())
        .collect()
}

/// So many times the covariance of a run at each used condition.
fn of_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    times: &dyn Fn(usize) -> f64,
) -> CovarianceInput {
    let used = (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    let block = |c: usize| scaled(&linear.run_covariance[c], times(c));
    CovarianceInput::Blocks(used.map(block).collect())
}

/// The problem file of a study at the fitted parameters.
///
/// The observation noise goes in as known. The noise of the simulator enters three times: in the
/// residual (mean of the runs of a condition), and in each sensitivity (difference of two such means). What an
/// effect does to the conditions kept apart is not predicted here: real runs show it.
pub(super) fn problem(
    plan: &ResidualPlan,
    linear: &Linearisation,
    fitted: &[f64],
    at_fit: &Means,
) -> ProblemFile {
    let used = || (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    let residual = used().flat_map(|c| {
        let pairs = plan.conditions[c].values.iter().zip(&at_fit.values[c]);
        pairs.map(|(y, f)| y.map(|y| y - f)).collect::<Vec<_>>()
    });
    let of_run = |variance: f64, at: &dyn Fn(usize) -> bool| {
        of_runs(plan, linear, &|c| if at(c) { variance } else { 0.0 })
    };
    let slope_errors = linear.declared_errors.iter();
    // An effect that moves nothing at a condition has the slope 0 there, without noise.
    let of_effect = |(j, variance): (usize, &f64)| {
        of_run(*variance, &|c| linear.moves[plan.parameters.len() + j][c])
    };
    let name_of = |&effect: &usize| plan.effects[effect].name.clone();
    let effects = || plan.effects.iter();
    let (prior_precision, prior_offset) = priors(plan, fitted);
    ProblemFile {
        id: plan.id.clone(),
        conditions: used().map(|c| coordinates(plan, c)).collect(),
        observables: plan.observables.clone(),
        residual_obs_minus_sim: residual.collect(),
        cov_measurement: Some(CovarianceInput::Blocks(
            used()
                .map(|c| plan.conditions[c].covariance.clone())
                .collect(),
        )),
        cov_simulator: Some(of_runs(plan, linear, &|c| 1.0 / at_fit.n[c] as f64)),
        covariance_dof: Some(covariance_dof(plan, linear, at_fit)),
        declared: plan.parameters.iter().map(|d| d.symbol.clone()).collect(),
        sensitivities_declared: linear.declared.concat(),
        cov_sensitivities_declared: slope_errors
            .clone()
            .map(|error| of_run(1.0, &|c| error.at[c]))
            .collect(),
        cov_sensitivities_declared_along: slope_errors.map(|error| error.along.clone()).collect(),
        shift_limits: shift_limits(plan, fitted),
        at_fitted_parameters: true,
        prior_precision,
        prior_offset,
        library: effects().map(|e| e.name.clone()).collect(),
        sensitivities_library: linear.library.concat(),
        cov_sensitivities_library: linear
            .library_variance
            .iter()
            .enumerate()
            .map(of_effect)
            .collect(),
        largest_amplitudes: effects().map(|e| (e.name.clone(), e.largest())).collect(),
        signs: effects().map(|e| (e.name.clone(), e.sign())).collect(),
        not_run: linear.not_run.iter().map(name_of).collect(),
        ..ProblemFile::default()
    }
}

/// How far each parameter may move from its fitted value, down and up.
fn shift_limits(plan: &ResidualPlan, fitted: &[f64]) -> Vec<[Option<f64>; 2]> {
    let each = plan.parameters.iter().zip(fitted);
    each.map(|(d, at)| [0, 1].map(|end| d.limits[end] - at))
        // A fit that ends on a bound may be beside it by rounding.
        .map(|[least, greatest]| [Some(least.min(0.0)), Some(greatest.max(0.0))])
        .collect()
}

/// Precision of the priors and their distance from the fit; nothing if no parameter has a prior.
fn priors(plan: &ResidualPlan, fitted: &[f64]) -> (Option<PriorPrecision>, Vec<f64>) {
    if plan.parameters.iter().all(|d| d.prior.is_none()) {
        return (None, Vec::new());
    }
    let precision = |sd: f64| 1.0 / (sd * sd);
    let each = plan.parameters.iter();
    let each = each.map(|d| d.prior.map_or(0.0, |p| precision(p.sd)));
    let precisions = PriorPrecision::Diagonal(each.collect());
    (Some(precisions), offsets(plan, fitted))
}

fn coordinates(plan: &ResidualPlan, condition: usize) -> Condition {
    let levels = plan.conditions[condition].condition.iter();
    levels
        .map(|(name, value)| (name.clone(), Level::Number(*value)))
        .collect()
}

/// The conditions kept from the fit, by the runs without effects and by the means with an effect.
pub(super) fn kept(
    plan: &ResidualPlan,
    linear: &Linearisation,
    (without, with): (&Means, &[Vec<f64>]),
) -> Vec<KeptCondition> {
    let is_kept = |c: &usize| !plan.conditions[*c].used && !plan.measured(*c).is_empty();
    let each = (0..plan.conditions.len()).filter(is_kept);
    let of = |c: usize| {
        let left = |simulated: &[f64]| {
            let pairs = plan.conditions[c].values.iter().zip(simulated);
            pairs.filter_map(|(y, f)| y.map(|y| y - f)).collect()
        };
        let share = 1.0 / without.n[c] as f64;
        let total = added(
            &plan.conditions[c].covariance,
            &linear.run_covariance[c],
            share,
        );
        KeptCondition {
            condition: coordinates(plan, c),
            observables: plan.measured(c),
            covariance: of_measured(plan, c, &total),
            without: left(&without.values[c]),
            with: left(&with[c]),
        }
    };
    each.map(of).collect()
}

/// Prior mean minus fitted value of each parameter; 0 where it is free.
fn offsets(plan: &ResidualPlan, fitted: &[f64]) -> Vec<f64> {
    let offset = |(d, x): (&Parameter, &f64)| d.prior.map_or(0.0, |p| p.mean - x);
    plan.parameters.iter().zip(fitted).map(offset).collect()
}

/// Degrees of freedom of the variance of a residual that is known worst: a measurement is known, and runs give only the rest.
///
/// # Formula
///
/// Of a sum of a known variance a and an estimated one b with d degrees of freedom: `d ((a + b) / b)²` `[Satterthwaite1946]`.
pub(super) fn covariance_dof(plan: &ResidualPlan, linear: &Linearisation, at_fit: &Means) -> f64 {
    let each = plan.rows(At::Used).into_iter().map(|(c, k)| {
        let known = plan.conditions[c].covariance[k][k];
        let of_runs = linear.run_covariance[c][k][k] / at_fit.n[c] as f64;
        linear.noise_dof[k] * ((known + of_runs) / of_runs).powi(2)
    });
    each.fold(MANY, f64::min)
}

/// Greatest share of the runs in the variance of a measured value minus the mean of its runs, at the used or the kept conditions.
pub(super) fn share_of_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    means: &Means,
    at: At,
) -> f64 {
    let share = |(c, k): (usize, usize)| {
        let of_runs = linear.run_covariance[c][k][k] / means.n[c] as f64;
        of_runs / (plan.conditions[c].covariance[k][k] + of_runs)
    };
    plan.rows(at).into_iter().map(share).fold(0.0, f64::max)
}

/// Whitened mean square of so many values that noise alone exceeds in 1 of 40 cases where they are many:
/// 1 + 2 sqrt(2/n).
pub(super) fn likely_mean_square(values: usize) -> f64 {
    1.0 + 2.0 * (2.0 / values as f64).sqrt()
}

/// Whitened mean square of observed minus simulated on the used conditions.
pub(super) fn misfit(
    plan: &ResidualPlan,
    linear: &Linearisation,
    simulated: &Means,
) -> Result<f64, Error> {
    let used = part(plan, linear, simulated, At::Used)?;
    used.map(|e| e.whitened_mse).ok_or(NOTHING_USED)
}

/// Distances of the parameters from their bench means, in standard errors.
pub(super) fn from_priors<'a>(
    plan: &'a ResidualPlan,
    setting: &'a Setting,
) -> impl Iterator<Item = f64> {
    let values = plan.parameters.iter().zip(&setting.parameters);
    values.filter_map(|(d, x)| {
        let Prior { mean, sd } = d.prior?;
        Some((x - mean) / sd)
    })
}

/// What a fit makes small: sum of squares of the whitened residual on the used conditions, and of the distances of the
/// parameters from their bench means in standard errors.
pub(super) fn cost(
    plan: &ResidualPlan,
    linear: &Linearisation,
    setting: &Setting,
    simulated: &Means,
) -> Result<f64, Error> {
    let priors = from_priors(plan, setting);
    let (residual, _) = whitened(plan, linear, &simulated.n, (&simulated.values, At::Used))?;
    let squares = residual.into_iter().chain(priors);
    Ok(squares.map(|z| z * z).sum())
}

/// Message of a fit without a value.
const NOTHING_USED: Error = Error::Count {
    what: "values at used conditions",
    got: 0,
    expected: "at least one",
};

/// Errors of simulated means against the observations.
pub(super) fn errors(
    plan: &ResidualPlan,
    linear: &Linearisation,
    simulated: &Means,
) -> Result<ErrorPair, Error> {
    let of = |at| part(plan, linear, simulated, at);
    Ok(ErrorPair {
        used: of(At::Used)?.ok_or(NOTHING_USED)?,
        kept: of(At::Kept)?,
    })
}

/// Errors on the used or on the kept conditions; `None` if nothing was measured there.
fn part(
    plan: &ResidualPlan,
    linear: &Linearisation,
    simulated: &Means,
    at: At,
) -> Result<Option<RealErrors>, Error> {
    let rows = plan.rows(at);
    let (white, _) = whitened(plan, linear, &simulated.n, (&simulated.values, at))?;
    let residual = residual(plan, at, &simulated.values);
    let mut rmse = BTreeMap::new();
    for (k, name) in plan.observables.iter().enumerate() {
        let own = rows.iter().zip(&residual).filter(|((_, o), _)| *o == k);
        let squares: Vec<f64> = own.map(|(_, r)| r * r).collect();
        if !squares.is_empty() {
            let mean = squares.iter().sum::<f64>() / squares.len() as f64;
            rmse.insert(name.clone(), mean.sqrt());
        }
    }
    let square: f64 = white.iter().map(|r| r * r).sum();
    Ok((!rows.is_empty()).then(|| RealErrors {
        rmse,
        whitened_mse: square / rows.len() as f64,
    }))
}
