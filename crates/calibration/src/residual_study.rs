//! The residual of several conditions: fit, linearise, diagnose, add the effect, fit again.
//!
//! The linear prediction only proposes: every error in the result comes from real runs.

pub(crate) mod amplitude_search;
mod assemble;
mod candidates;
pub(crate) mod fits;
mod linearisation;
mod refit;
mod runs;
mod scatter;
mod slopes;
mod worker;

use crate::Error;
use amplitude_search::worth_a_search;
use campaign::{Campaign, RunRequest, Simulator};
pub use candidates::{CandidateMeasurement, OfferedMeasurement};
use fits::{FIRST_BLOCK_ANEW, FIRST_BLOCK_OF_NOISY, Fits, Looks, Visited, sets_to_add};
use linearisation::Linearisation;
use residual_diagnosis::{
    CheckedModel, CovarianceMatrix, Diagnosis, Largest, Options, Problem, ProblemFile, Sign,
    Verdict, diagnose,
};
use runs::At;
pub(crate) use runs::value;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use worker::Worker;

/// A condition of the measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyCondition {
    /// Name of the model that stands for this condition, coordinates and all; that of [`ResidualPlan::base`] under the
    /// coordinates below where absent.
    pub model: Option<String>,
    /// Coordinates, as in [`RunRequest::condition`].
    pub condition: BTreeMap<String, f64>,
    /// What is read of its runs: pairs of a name in [`ResidualPlan::observables`] and the name that the run gives it;
    /// all of them under their own names where absent.
    pub observables: Option<BTreeMap<String, String>>,
    /// Whether the fit may use it; otherwise it is kept for the check.
    pub used: bool,
}

impl StudyCondition {
    /// What the runs give under the name of an observable of the plan; none where it is not read here.
    fn name_of<'a>(&'a self, observable: &'a str) -> Option<&'a str> {
        match &self.observables {
            None => Some(observable),
            Some(names) => names.get(observable).map(String::as_str),
        }
    }

    /// Its name: that of its model, or of the model of a plan with the coordinates.
    fn name(&self, of_plan: &str) -> String {
        let coordinates = self.condition.iter();
        self.model.clone().unwrap_or_else(|| {
            coordinates.fold(of_plan.to_owned(), |text, (name, x)| {
                format!("{text} {name}={x}")
            })
        })
    }
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
    /// Least and largest amplitude that is physically possible.
    pub range: [f64; 2],
    /// Models that cannot carry it, by name, with the reason: it changes nothing there.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<String, String>,
}

impl EffectProbe {
    /// Whether it can change anything at a condition.
    pub(crate) fn acts_on(&self, condition: &StudyCondition) -> bool {
        let model = condition.model.as_ref();
        model.is_none_or(|name| !self.absent.contains_key(name))
    }

    /// How far its amplitude can go.
    pub fn largest(&self) -> Largest {
        let [low, high] = self.range;
        if self.sign() == Sign::Any && low != -high {
            Largest::Ends(self.range)
        } else {
            Largest::Size(high.max(-low))
        }
    }

    /// Signs that its amplitude can have.
    pub fn sign(&self) -> Sign {
        match self.range {
            [low, high] if low < 0.0 && high > 0.0 => Sign::Any,
            [low, _] if low < 0.0 => Sign::Negative,
            _ => Sign::Positive,
        }
    }
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    /// Values, (conditions, observables); none where an observable was not measured.
    pub values: Vec<Vec<Option<f64>>>,
    /// Covariance of the values of each condition, (conditions, observables, observables); rows
    /// and columns of what was not measured are not read.
    pub covariance: Vec<CovarianceMatrix>,
}

impl Observed {
    /// Numbers of the observables that were measured at a condition.
    pub fn measured(&self, condition: usize) -> Vec<usize> {
        let values = self.values[condition].iter().enumerate();
        values.filter_map(|(k, y)| y.map(|_| k)).collect()
    }

    /// Standard error of a value, in its unit.
    pub fn standard_error(&self, condition: usize, observable: usize) -> f64 {
        self.covariance[condition][observable][observable].sqrt()
    }
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
    /// What could be measured next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<CandidateMeasurement>,
}

impl ResidualPlan {
    /// Number of conditions that the fit uses, or that are kept for the check.
    pub fn count(&self, used: bool) -> usize {
        self.conditions.iter().filter(|c| c.used == used).count()
    }
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
    /// The plan, with the effects that could be run.
    pub plan: ResidualPlan,
    /// Effects that could not be run, with the reason.
    pub left_out: BTreeMap<String, String>,
    /// Conditions that could not be run, with the reason; the plan and what was measured are without them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub left_out_conditions: BTreeMap<String, String>,
    /// What was measured.
    pub observed: Observed,
    /// Degrees of freedom of the simulator's noise.
    pub noise_dof: f64,
    /// Standard deviation of one run, by observable, pooled over the conditions.
    pub run_sd: BTreeMap<String, f64>,
    /// Declared parameters after the fit without any effect.
    pub fitted: BTreeMap<String, f64>,
    /// Simulated means at the fitted parameters, (conditions, observables).
    pub simulated_before: Vec<Vec<f64>>,
    /// Errors of the fitted model, by real runs.
    pub errors_before: ErrorPair,
    /// The residual, covariances and sensitivities that the diagnosis was made of, and the experiments on offer.
    pub problem: ProblemFile,
    /// Diagnosis of the residual.
    pub diagnosis: Diagnosis,
    /// The model with the effect added; none where no effect was named. It stays here when the kept
    /// conditions speak against it and the naming is withdrawn.
    pub after: Option<AddedEffect>,
    /// The models in question where they are several, as with each of the tied effects in turn: up to three, the best
    /// explanation first. They stay here when the kept conditions speak against all of them.
    pub rivals: Vec<AddedEffect>,
    /// The candidates for the next measurement, where the diagnosis leaves a question; empty otherwise.
    pub offered: Vec<OfferedMeasurement>,
}

impl ResidualStudy {
    /// All models with effects added: the one after, or those in question.
    pub fn models(&self) -> impl Iterator<Item = &AddedEffect> {
        self.after.iter().chain(&self.rivals)
    }
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
/// A run that fails is left out of the mean of its condition as long as two others remain; a condition without such a mean
/// at the start, at a step in a parameter, or at the fit where it is kept, is left out of the study. Both are among the
/// warnings of the diagnosis.
///
/// # Errors
///
/// A plan whose numbers do not fit, runs that failed at all used conditions, a covariance that cannot be used.
pub fn study_residual(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
) -> Result<ResidualStudy, Error> {
    check(plan, observed)?;
    let worker = Worker::new(campaign, simulator);
    let (mut plan, mut observed) = (plan.clone(), observed.clone());
    let mut left_out_conditions = BTreeMap::new();
    loop {
        let error = match study_of_all(&worker, &plan, &observed) {
            Ok(mut study) => {
                let warnings = &mut study.diagnosis.warnings;
                warnings.extend(worker.left_out());
                for (name, reason) in &left_out_conditions {
                    warnings.push(format!("{name} is left out of the study: {reason}"));
                }
                study.left_out_conditions = left_out_conditions;
                return Ok(study);
            }
            Err(error) => error,
        };
        // What was run is found again, and what failed is not run again.
        match &error {
            Error::Cell {
                condition, name, ..
            } if !plan.conditions[*condition].used || plan.count(true) > 1 => {
                left_out_conditions.insert(name.clone(), error.to_string());
                plan.conditions.remove(*condition);
                observed.values.remove(*condition);
                observed.covariance.remove(*condition);
            }
            _ => return Err(error),
        }
    }
}

/// The study of a plan whose conditions can all be run.
fn study_of_all(
    worker: &Worker<'_>,
    plan: &ResidualPlan,
    observed: &Observed,
) -> Result<ResidualStudy, Error> {
    let (linear, left_out) = Linearisation::run(worker, plan)?;
    let mut plan = plan.clone();
    plan.effects.retain(|e| !left_out.contains_key(&e.name));
    let plan = &plan;
    let fits = Fits {
        worker,
        plan,
        observed,
    };
    let (mut fit, visited) = fits.declared(&linear)?;
    // The kept conditions are run once, where the fit has ended.
    let kept = fits.run(&fit.setting, fit.block, At::Kept)?;
    let linear = linear.with_points(plan, &visited).with_scatter(&kept);
    fit.means = fit.means.with_kept(kept);
    let Looked {
        linear,
        mut file,
        mut diagnosis,
        looks,
    } = looked_at(&fits, linear, &fit)?;
    let at_fit = &fit.means;
    let errors_before = assemble::errors(plan, observed, &linear, at_fit)?;
    let sets = sets_to_add(&diagnosis);
    let (mut added, failed) = fits.with_each(&linear, &sets, &fit, &looks)?;
    diagnosis.warnings.extend(failed);
    if added.len() == sets.len() {
        // What could not be run was not refuted.
        diagnosis = checked(&fits, &linear, &fit, (&errors_before, &added), diagnosis)?;
    }
    let (experiments, offered) = fits.candidates(&linear, &fit, &diagnosis)?;
    if !experiments.is_empty() {
        file.candidate_experiments = experiments;
        diagnosis = diagnosis.with_next_measurement(&Problem::try_from(file.clone())?)?;
    }
    let (after, rivals) = match sets.len() {
        0 | 1 => (added.pop(), Vec::new()),
        _ => (None, added),
    };
    let pooled = linear.pooled_covariance();
    let sds = (0..pooled.len()).map(|k| pooled[k][k].sqrt());
    let names = plan.observables.iter().cloned();
    let declared = plan.declared.iter().map(|d| d.name.clone());
    let fitted = fit.setting.declared_values(plan);
    Ok(ResidualStudy {
        plan: plan.clone(),
        left_out,
        left_out_conditions: BTreeMap::new(),
        observed: observed.clone(),
        noise_dof: linear.noise_dof,
        run_sd: names.zip(sds).collect(),
        fitted: declared.zip(fitted).collect(),
        simulated_before: fit.means.values,
        errors_before,
        problem: file,
        diagnosis,
        after,
        rivals,
        offered,
    })
}

/// A diagnosis of the linear problem, and what it was made of.
struct Looked {
    /// The slopes behind it.
    linear: Linearisation,
    /// Its problem.
    file: ProblemFile,
    /// What it says.
    diagnosis: Diagnosis,
    /// Which effects were looked at again.
    looks: Looks,
}

/// Diagnoses the residual at the fit; what the answer hangs on is measured with further runs first: slopes that are noise,
/// slopes of the suspects, and amplitudes that no straight line tells.
fn looked_at(fits: &Fits<'_>, mut linear: Linearisation, fit: &Visited) -> Result<Looked, Error> {
    let (plan, observed) = (fits.plan, fits.observed);
    let fitted = fit.setting.declared_values(plan);
    let diagnosed = |linear: &Linearisation| -> Result<(ProblemFile, Diagnosis), Error> {
        let file = assemble::problem(plan, observed, linear, &fitted, &fit.means);
        let diagnosis = diagnose(&Problem::try_from(file.clone())?, &Options::new(plan.seed))?;
        Ok((file, diagnosis))
    };
    let (mut file, mut diagnosis) = diagnosed(&linear)?;
    let mut looks = Looks::default();
    let noisy = fits.noisy(fit, &diagnosis);
    if !noisy.is_empty() && diagnosis.verdict != Verdict::Refused {
        let runs = noisy.into_iter().zip(FIRST_BLOCK_OF_NOISY..);
        linear = fits.measured_anew(linear, fit, runs, &mut looks)?;
        (file, diagnosis) = diagnosed(&linear)?;
    }
    let quiet = [Verdict::None, Verdict::Refused, Verdict::NotTestable];
    if !quiet.contains(&diagnosis.verdict) {
        let suspects = fits.suspects(&linear, fit, &diagnosis)?;
        if !suspects.is_empty() {
            let runs = suspects.into_iter().zip(FIRST_BLOCK_ANEW..);
            linear = fits.measured_anew(linear, fit, runs, &mut looks)?;
            (file, diagnosis) = diagnosed(&linear)?;
        }
    }
    if matches!(diagnosis.verdict, Verdict::Unknown | Verdict::Partial) {
        let suspects = fits.suspects(&linear, fit, &diagnosis)?;
        let suspects = worth_a_search(&diagnosis, plan, suspects);
        if !suspects.is_empty() {
            linear = fits.searched(linear, fit, &suspects, &mut looks)?;
            (file, diagnosis) = diagnosed(&linear)?;
        }
    }
    diagnosis.warnings.append(&mut looks.warnings);
    Ok(Looked {
        linear,
        file,
        diagnosis,
        looks,
    })
}

/// Holds a diagnosis against the kept conditions, by the real runs of the models that it proposes.
fn checked(
    fits: &Fits<'_>,
    linear: &Linearisation,
    fit: &Visited,
    (before, added): (&ErrorPair, &[AddedEffect]),
    diagnosis: Diagnosis,
) -> Result<Diagnosis, Error> {
    let (plan, observed) = (fits.plan, fits.observed);
    let Some(before) = &before.kept else {
        return Ok(diagnosis);
    };
    let mut models = Vec::new();
    for model in added {
        let means = (&fit.means.values[..], &model.simulated[..]);
        let contrast = assemble::contrast_on_kept(plan, observed, linear, means, &fit.means.n)?;
        let names: Vec<&str> = model.effects.keys().map(String::as_str).collect();
        let checked = model.errors.kept.as_ref().zip(contrast);
        models.extend(checked.map(|(errors, contrast)| CheckedModel {
            name: names.join(" and "),
            whitened_mse: errors.whitened_mse,
            contrast,
        }));
    }
    let unused = (0..plan.conditions.len()).filter(|&c| !plan.conditions[c].used);
    let values = unused.map(|c| observed.measured(c).len()).sum();
    Ok(diagnosis.checked_by_runs(before.whitened_mse, &models, values))
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
    count(
        "covariances",
        observed.covariance.len(),
        observed.covariance.len() == rows,
        "one for each condition",
    )?;
    for block in &observed.covariance {
        let square = block.len() == n && block.iter().all(|row| row.len() == n);
        count(
            "rows of a covariance",
            block.len(),
            square,
            "one for each observable",
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod candidate_tests;
#[cfg(test)]
mod failure_tests;
#[cfg(test)]
mod nonlinear_tests;
#[cfg(test)]
mod slope_tests;
#[cfg(test)]
mod tests;
