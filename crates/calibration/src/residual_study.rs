//! The residual of several conditions: fit, linearise, diagnose, add the effect, fit again.
//!
//! The linear prediction only proposes: every error in the result comes from real runs.

mod assemble;
mod refit;
mod runs;

use crate::Error;
use campaign::{Campaign, RunRequest, Simulator};
use residual_diagnosis::{Diagnosis, Options, Problem, Sign, diagnose};
use runs::{Linearisation, Means};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A condition of the measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyCondition {
    /// Coordinates, as in [`RunRequest::condition`].
    pub condition: BTreeMap<String, f64>,
    /// Whether the fit may use it; otherwise it is kept for the check.
    pub used: bool,
}

/// A declared parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeclaredParameter {
    /// Name in [`RunRequest::parameters`].
    pub name: String,
    /// Value at which the simulator is linearised.
    pub start: f64,
    /// Step of the finite difference.
    pub step: f64,
    /// Lower and upper bound.
    pub bounds: [f64; 2],
    /// Mean and standard error of a bench measurement; none where it is free.
    pub prior: Option<[f64; 2]>,
}

/// An effect of the library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectProbe {
    /// Name in [`RunRequest::effects`].
    pub name: String,
    /// Amplitude at which its sensitivity is measured.
    pub probe: f64,
    /// Largest physical size of its amplitude.
    pub largest: f64,
    /// Physical sign of its amplitude.
    pub sign: Sign,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    /// Values, (conditions, observables).
    pub values: Vec<Vec<f64>>,
    /// Covariance of the values of one condition, the same for all, (observables, observables).
    pub covariance: Vec<Vec<f64>>,
}

/// Everything that a residual study needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualPlan {
    /// Name.
    pub id: String,
    /// The run with everything that does not vary; its seed is the first of the study.
    pub base: RunRequest,
    /// Conditions, used and kept ones.
    pub conditions: Vec<StudyCondition>,
    /// Names of the observables.
    pub observables: Vec<String>,
    /// Declared parameters.
    pub declared: Vec<DeclaredParameter>,
    /// Library.
    pub effects: Vec<EffectProbe>,
    /// Runs for each nominal mean: 2 or more, they give the noise of the simulator.
    pub replicates: usize,
    /// Seed of the simulated distributions of the diagnosis.
    pub seed: u64,
}

/// Root mean square error by observable, and the whitened mean square, from real runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RealErrors {
    /// Root mean square of observed minus simulated, by observable, in its unit.
    pub rmse: BTreeMap<String, f64>,
    /// Mean square of the whitened residual; 1 where the model is right.
    pub whitened_mse: f64,
}

/// Errors of one model on the used and the kept conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorPair {
    /// On the conditions that the fit used.
    pub used: RealErrors,
    /// On those kept for the check; none if there are none.
    pub kept: Option<RealErrors>,
}

/// The outcome of a residual study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualStudy {
    /// The plan.
    pub plan: ResidualPlan,
    /// What was measured.
    pub observed: Observed,
    /// Degrees of freedom of the simulator's noise.
    pub noise_dof: usize,
    /// Standard deviation of one run, by observable.
    pub run_sd: BTreeMap<String, f64>,
    /// Declared parameters after the fit without any effect.
    pub fitted: BTreeMap<String, f64>,
    /// Simulated means at the fitted parameters, (conditions, observables).
    pub simulated_before: Vec<Vec<f64>>,
    /// Errors of the fitted model, by real runs.
    pub errors_before: ErrorPair,
    /// Diagnosis of the residual.
    pub diagnosis: Diagnosis,
    /// The model with the effect added; none where no effect was named.
    pub after: Option<AddedEffect>,
}

/// The model with an effect added, by real runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AddedEffect {
    /// Amplitudes by effect.
    pub effects: BTreeMap<String, f64>,
    /// Declared parameters after the fit with the effect on.
    pub fitted: BTreeMap<String, f64>,
    /// Simulated means, (conditions, observables).
    pub simulated: Vec<Vec<f64>>,
    /// Errors.
    pub errors: ErrorPair,
}

/// Finds what the model lacks to explain the observations.
///
/// # Errors
///
/// A plan whose numbers do not fit, runs that failed, a covariance that cannot be used.
pub fn study_residual(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
) -> Result<ResidualStudy, Error> {
    check(plan, observed)?;
    let linear = Linearisation::run(campaign, simulator, plan)?;
    let (fitted, at_fit) = fit_declared(campaign, simulator, plan, observed, &linear)?;
    let linear = linear.with_scatter(&at_fit);
    let file = assemble::problem(plan, observed, &linear, &fitted, &at_fit);
    let diagnosis = diagnose(&Problem::try_from(file)?, &Options::new(plan.seed))?;
    let errors_before = assemble::errors(plan, observed, &linear, &at_fit)?;
    let after =
        if diagnosis.effects.is_empty() || !diagnosis.tie_groups.iter().all(|g| g.len() == 1) {
            None
        } else {
            Some(add_effects(
                campaign,
                simulator,
                plan,
                observed,
                &linear,
                &diagnosis.effects,
            )?)
        };
    let names = || plan.declared.iter().map(|d| d.name.clone());
    Ok(ResidualStudy {
        plan: plan.clone(),
        observed: observed.clone(),
        noise_dof: linear.noise_dof,
        run_sd: plan
            .observables
            .iter()
            .enumerate()
            .map(|(k, name)| (name.clone(), linear.run_covariance[k][k].sqrt()))
            .collect(),
        fitted: names().zip(fitted).collect(),
        simulated_before: at_fit.values,
        errors_before,
        diagnosis,
        after,
    })
}

/// Fits the declared parameters and runs there; corrects up to twice where that misses.
///
/// The slopes stay those of the start. A correction is kept only where real runs on the used
/// conditions say that it helps.
fn fit_declared(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
) -> Result<(Vec<f64>, Means), Error> {
    let start: Vec<f64> = plan.declared.iter().map(|d| d.start).collect();
    let run = |point: &[f64], block: u64| {
        runs::means(
            campaign,
            simulator,
            plan,
            &runs::Setting::declared(plan, point),
            block,
        )
    };
    let misfit =
        |m: &Means| assemble::errors(plan, observed, linear, m).map(|e| e.used.whitened_mse);
    let mut fitted = refit::declared(plan, observed, linear, &start, &linear.nominal)?;
    let mut means = run(&fitted, 1)?;
    for block in [4, 5] {
        if misfit(&means)? <= likely_mean_square(plan) {
            break;
        }
        let corrected = refit::declared(plan, observed, linear, &fitted, &means)?;
        let again = run(&corrected, block)?;
        if misfit(&again)? >= misfit(&means)? {
            break;
        }
        (fitted, means) = (corrected, again);
    }
    Ok((fitted, means))
}

/// Whitened mean square that a right model exceeds in 1 of 40 cases: 1 + 2 sqrt(2/n) for n rows.
fn likely_mean_square(plan: &ResidualPlan) -> f64 {
    let rows = plan.conditions.iter().filter(|c| c.used).count() * plan.observables.len();
    1.0 + 2.0 * (2.0 / rows as f64).sqrt()
}

/// Fits parameters and amplitudes together and runs there; corrects once where that misses.
fn add_effects(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    effects: &[String],
) -> Result<AddedEffect, Error> {
    let mut point = refit::with_effects(plan, observed, linear, effects, None)?;
    let mut means: Means = runs::means(campaign, simulator, plan, &point, 2)?;
    let used = |m: &Means| assemble::errors(plan, observed, linear, m).map(|e| e.used.whitened_mse);
    let first = used(&means)?;
    if first > likely_mean_square(plan) {
        let about = Some((&point, &means));
        let corrected = refit::with_effects(plan, observed, linear, effects, about)?;
        let again = runs::means(campaign, simulator, plan, &corrected, 3)?;
        if used(&again)? < first {
            point = corrected;
            means = again;
        }
    }
    Ok(AddedEffect {
        errors: assemble::errors(plan, observed, linear, &means)?,
        effects: point.effects.clone(),
        fitted: point.parameters.clone(),
        simulated: means.values,
    })
}

/// Refuses numbers that do not fit together.
fn check(plan: &ResidualPlan, observed: &Observed) -> Result<(), Error> {
    let count = |what, got: usize, fits: bool, expected| {
        if fits {
            Ok(())
        } else {
            Err(Error::Count {
                what,
                got,
                expected,
            })
        }
    };
    let n = plan.observables.len();
    count("observables", n, n > 0, "at least one")?;
    count(
        "replicates",
        plan.replicates,
        plan.replicates >= 2,
        "two or more",
    )?;
    let rows = observed.values.len();
    count(
        "observed conditions",
        rows,
        rows == plan.conditions.len(),
        "one for each condition",
    )?;
    for row in &observed.values {
        count(
            "observed values",
            row.len(),
            row.len() == n,
            "one for each observable",
        )?;
    }
    let square = observed.covariance.len() == n && observed.covariance.iter().all(|r| r.len() == n);
    count(
        "rows of the covariance",
        observed.covariance.len(),
        square,
        "one for each observable",
    )
}

#[cfg(test)]
mod tests;
