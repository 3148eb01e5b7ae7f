//! From runs to the residual problem, and to errors.

use super::linearisation::Linearisation;
use super::runs::{Means, Setting};
use super::{DeclaredParameter, ErrorPair, RealErrors, ResidualPlan};
use crate::Error;
use crate::diagnosis::{
    Condition, CovarianceInput, KeptCondition, Level, PriorPrecision, ProblemFile,
};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::collections::BTreeMap;

/// Beyond so many degrees of freedom a variance is as good as known.
const MANY: f64 = 1e6;

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
/// effect does to the conditions kept apart is not predicted here: real runs tell it.
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
        of_run(*variance, &|c| linear.moves[plan.declared.len() + j][c])
    };
    let name_of = |&effect: &usize| plan.effects[effect].name.clone();
    let any_prior = plan.declared.iter().any(|d| d.prior.is_some());
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
        declared: plan.declared.iter().map(|d| d.name.clone()).collect(),
        sensitivities_declared: linear.declared.concat(),
        cov_sensitivities_declared: slope_errors
            .clone()
            .map(|error| of_run(1.0, &|c| error.at[c]))
            .collect(),
        cov_sensitivities_declared_along: slope_errors.map(|error| error.along.clone()).collect(),
        shift_limits: plan
            .declared
            .iter()
            .zip(fitted)
            .map(|(d, at)| [0, 1].map(|end| Some(d.bounds[end] - at)))
            // A fit that ends on a bound may be beside it by rounding.
            .map(|[least, greatest]| [least.map(|x| x.min(0.0)), greatest.map(|x| x.max(0.0))])
            .collect(),
        at_fitted_parameters: true,
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
        cov_sensitivities_library: linear
            .library_variance
            .iter()
            .enumerate()
            .map(of_effect)
            .collect(),
        largest_amplitudes: plan
            .effects
            .iter()
            .map(|e| (e.name.clone(), e.largest()))
            .collect(),
        signs: plan
            .effects
            .iter()
            .map(|e| (e.name.clone(), e.sign()))
            .collect(),
        not_run: linear.not_run.iter().map(name_of).collect(),
        ..ProblemFile::default()
    }
}

/// The coordinates of a condition.
fn coordinates(plan: &ResidualPlan, condition: usize) -> Condition {
    let levels = plan.conditions[condition].condition.iter();
    levels
        .map(|(name, value)| (name.clone(), Level::Number(*value)))
        .collect()
}

/// Whether anything was measured at a condition kept from the fit.
pub(super) fn any_kept(plan: &ResidualPlan) -> bool {
    let mut all = plan.conditions.iter().enumerate();
    all.any(|(c, condition)| !condition.used && !plan.measured(c).is_empty())
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
            covariance: of_measured(plan, &total, c),
            without: left(&without.values[c]),
            with: left(&with[c]),
        }
    };
    each.map(of).collect()
}

/// Prior mean minus fitted value of each parameter; 0 where it is free.
fn offsets(plan: &ResidualPlan, fitted: &[f64]) -> Vec<f64> {
    let offset = |(d, x): (&DeclaredParameter, &f64)| d.prior.map_or(0.0, |p| p[0] - x);
    plan.declared.iter().zip(fitted).map(offset).collect()
}

/// Root of the covariance of the measured observables of a condition and of so many times that of a run.
pub(super) fn root(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: f64,
    condition: usize,
) -> Result<DMatrix<f64>, Error> {
    let total = added(
        &plan.conditions[condition].covariance,
        &linear.run_covariance[condition],
        runs,
    );
    let root = Cholesky::new(of_measured(plan, &total, condition)).ok_or(Error::Search {
        what: "the root of the covariance",
        reason: "it is not positive definite: are two observables the same?".into(),
    })?;
    Ok(root.l())
}

/// Degrees of freedom of the variance of a residual that is known worst: a measurement is known, and runs tell only the rest.
///
/// # Formula
///
/// Of a sum of a known variance a and an estimated one b with d degrees of freedom: `d ((a + b) / b)²` `[Satterthwaite1946]`.
pub(super) fn covariance_dof(plan: &ResidualPlan, linear: &Linearisation, at_fit: &Means) -> f64 {
    let used = (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    let each = used.flat_map(|c| {
        let measured = plan.measured(c).into_iter();
        measured.map(move |k| {
            let known = plan.conditions[c].covariance[k][k];
            let of_runs = linear.run_covariance[c][k][k] / at_fit.n[c] as f64;
            linear.noise_dof[k] * ((known + of_runs) / of_runs).powi(2)
        })
    });
    each.fold(MANY, f64::min)
}

/// Root of so many times the covariance of a run, over the observables that were measured at a condition; with that of
/// the measurements where the runs are too few to tell it.
pub(super) fn root_of_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: f64,
    condition: usize,
) -> Result<DMatrix<f64>, Error> {
    let covariance = scaled(&linear.run_covariance[condition], runs);
    let known = linear.least_dof() >= (RUNS_TO_KNOW * plan.measured(condition).len()) as f64;
    match Cholesky::new(of_measured(plan, &covariance, condition)).filter(|_| known) {
        Some(of_runs) => Ok(of_runs.l()),
        None => root(plan, linear, runs, condition),
    }
}

/// Trace of the covariance of a run at a condition, whitened by [`root`] for so many times that of a run.
pub(super) fn share_of_run(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: f64,
    condition: usize,
) -> Result<f64, Error> {
    let root = root(plan, linear, runs, condition)?;
    let of_run = of_measured(plan, &linear.run_covariance[condition], condition);
    let half = root.solve_lower_triangular(&of_run);
    let whole = half.and_then(|half| root.solve_lower_triangular(&half.transpose()));
    Ok(whole.map_or(0.0, |whole| whole.trace()))
}

/// Covariance of the means of the runs at the used conditions, whitened by [`root`], in so many rows: 0 behind these.
pub(super) fn whitened_runs(
    plan: &ResidualPlan,
    linear: &Linearisation,
    means: &Means,
    rows: usize,
) -> Result<DMatrix<f64>, Error> {
    let mut whole = DMatrix::zeros(rows, rows);
    let mut first = 0;
    for c in (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used) {
        let share = 1.0 / means.n[c] as f64;
        let root = root(plan, linear, share, c)?;
        let of_run = of_measured(plan, &linear.run_covariance[c], c) * share;
        let half = root.solve_lower_triangular(&of_run);
        let both = half.and_then(|half| root.solve_lower_triangular(&half.transpose()));
        let n = of_run.nrows();
        if let Some(both) = both {
            whole.view_mut((first, first), (n, n)).copy_from(&both);
        }
        first += n;
    }
    Ok(whole)
}

/// Degrees of freedom for each observable from which on the scatter of the runs tells their covariance.
const RUNS_TO_KNOW: usize = 3;

/// The rows and columns of a covariance whose observables were measured at a condition.
fn of_measured(plan: &ResidualPlan, covariance: &[Vec<f64>], condition: usize) -> DMatrix<f64> {
    let measured = plan.measured(condition);
    let n = measured.len();
    DMatrix::from_fn(n, n, |a, b| covariance[measured[a]][measured[b]])
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
    let used = part(plan, linear, simulated, true)?;
    used.map(|e| e.whitened_mse).ok_or(NOTHING_USED)
}

/// Sum of squares of the difference of two means on the used conditions, in standard deviations of their noise.
pub(super) fn change(
    plan: &ResidualPlan,
    linear: &Linearisation,
    from: &Means,
    to: &Means,
) -> Result<f64, Error> {
    let mut sum = 0.0;
    for c in (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used) {
        let measured = plan.measured(c);
        let moved = measured
            .iter()
            .map(|&k| to.values[c][k] - from.values[c][k]);
        let moved = DVector::from_iterator(measured.len(), moved);
        let runs = 1.0 / from.n[c] as f64 + 1.0 / to.n[c] as f64;
        let white = root_of_runs(plan, linear, runs, c)?.solve_lower_triangular(&moved);
        sum += white.map_or(0.0, |white| white.norm_squared());
    }
    Ok(sum)
}

/// Whitened residual of means on the used or on the kept conditions, by so many runs at each; and the sum of the variances that the
/// runs have in it.
pub(super) fn whitened(
    plan: &ResidualPlan,
    linear: &Linearisation,
    runs: &[usize],
    (simulated, used): (&[Vec<f64>], bool),
) -> Result<(Vec<f64>, f64), Error> {
    let (mut residual, mut noise) = (Vec::new(), 0.0);
    for c in (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used == used) {
        let share = 1.0 / runs[c] as f64;
        let off = |k: usize| plan.conditions[c].values[k].map(|y| y - simulated[c][k]);
        let values: Vec<f64> = plan.measured(c).into_iter().filter_map(off).collect();
        let values = DVector::from_vec(values);
        let white = root(plan, linear, share, c)?.solve_lower_triangular(&values);
        residual.extend(white.iter().flat_map(|white| white.iter().copied()));
        noise += share * share_of_run(plan, linear, share, c)?;
    }
    Ok((residual, noise))
}

/// Distances of the parameters from their bench means, in standard errors.
pub(super) fn from_priors<'a>(
    plan: &'a ResidualPlan,
    setting: &'a Setting,
) -> impl Iterator<Item = f64> {
    plan.declared.iter().filter_map(|d| {
        let [mean, sd] = d.prior?;
        Some((setting.parameters[&d.name] - mean) / sd)
    })
}

/// Number of values at the used conditions.
pub(super) fn used_values(plan: &ResidualPlan) -> usize {
    let used = (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    used.map(|c| plan.measured(c).len()).sum()
}

/// What a fit makes small: sum of squares of the whitened residual on the used conditions, and of the distances of the
/// parameters from their bench means in standard errors.
pub(super) fn cost(
    plan: &ResidualPlan,
    linear: &Linearisation,
    setting: &Setting,
    simulated: &Means,
) -> Result<f64, Error> {
    let rows = used_values(plan);
    let priors = from_priors(plan, setting);
    let misfit = misfit(plan, linear, simulated)?;
    Ok(misfit * rows as f64 + priors.map(|z| z * z).sum::<f64>())
}

/// What a fit without a value is told.
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
    let of = |used: bool| part(plan, linear, simulated, used);
    Ok(ErrorPair {
        used: of(true)?.ok_or(NOTHING_USED)?,
        kept: of(false)?,
    })
}

/// Errors on the used or on the kept conditions; none where nothing was measured there.
fn part(
    plan: &ResidualPlan,
    linear: &Linearisation,
    simulated: &Means,
    used: bool,
) -> Result<Option<RealErrors>, Error> {
    let residual =
        |c: usize, k: usize| plan.conditions[c].values[k].map(|y| y - simulated.values[c][k]);
    let conditions: Vec<usize> = (0..plan.conditions.len())
        .filter(|&c| plan.conditions[c].used == used)
        .collect();
    let mut rmse = BTreeMap::new();
    for (k, name) in plan.observables.iter().enumerate() {
        let squares: Vec<f64> = conditions
            .iter()
            .filter_map(|&c| residual(c, k).map(|r| r * r))
            .collect();
        if !squares.is_empty() {
            let mean = squares.iter().sum::<f64>() / squares.len() as f64;
            rmse.insert(name.clone(), mean.sqrt());
        }
    }
    let (mut whitened, mut rows) = (0.0, 0);
    for &c in &conditions {
        let values = (0..plan.observables.len()).filter_map(|k| residual(c, k));
        let vector = DVector::from_iterator(plan.measured(c).len(), values);
        let white =
            root(plan, linear, 1.0 / simulated.n[c] as f64, c)?.solve_lower_triangular(&vector);
        whitened += white.map_or(f64::NAN, |w| w.norm_squared());
        rows += vector.len();
    }
    Ok((rows > 0).then(|| RealErrors {
        rmse,
        whitened_mse: whitened / rows as f64,
    }))
}
