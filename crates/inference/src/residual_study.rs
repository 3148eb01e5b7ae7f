//! The residual of several conditions: fit, linearise, diagnose, add the effect, fit again.
//!
//! The linear prediction only proposes: every error in the result comes from real runs.

pub(crate) mod amplitude;
mod amplitude_curve;
pub(crate) mod amplitude_search;
mod assemble;
mod candidates;
pub(crate) mod fits;
mod linearisation;
mod plan;
mod refit;
pub(crate) mod rivals;
mod runs;
mod scatter;
mod slopes;
mod whitened;
mod worker;

use crate::Error;
use crate::diagnosis::{
    Amplitude, CheckedModel, Contrast, Diagnosis, Options, Problem, ProblemFile, RefittedModel,
    Verdict, diagnose, ln_over_unknown,
};
use amplitude_search::worth_a_search;
use campaign::{Campaign, RunRequest, Simulator};
pub use candidates::{CandidateMeasurement, OfferedMeasurement};
use fits::{BLOCKS_OF_FIT, FIRST_BLOCK_ANEW, FIRST_BLOCK_OF_NOISY, Fits, Remeasured, Visited};
use linearisation::Linearisation;
pub use plan::{EffectProbe, ResidualPlan, StudyCondition};
use rivals::{Decided, after_and_rivals};
use runs::At;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use worker::Worker;

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
    /// The model with the effect added; `None` if no effect was named. It stays here when real runs contradict it and the
    /// naming is withdrawn.
    pub after: Option<AddedEffect>,
    /// The other models that real runs have fitted again and that the best of them does not refute, the best first. They stay here
    /// when the kept conditions speak against them.
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
    /// Amplitudes by effect, of the runs.
    pub effects: BTreeMap<String, f64>,
    /// Amplitudes that the data ask for, by the runs at these and other ones, with their 95 % intervals.
    pub estimates: BTreeMap<String, Amplitude>,
    /// Declared parameters after the fit with the effect on.
    pub fitted: BTreeMap<String, f64>,
    /// Their standard errors; without those that the slopes do not identify.
    pub fitted_se: BTreeMap<String, f64>,
    /// Simulated means, (conditions, observables).
    pub simulated: Vec<Vec<f64>>,
    /// Number of runs behind the means of each condition.
    pub runs: Vec<usize>,
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
) -> Result<ResidualStudy, Error> {
    plan.check()?;
    let worker = Worker::new(campaign, simulator);
    let mut plan = plan.clone();
    let mut left_out_conditions = BTreeMap::new();
    loop {
        let error = match studied(&worker, &plan) {
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
                leave_out_unmeasured(&mut plan);
            }
            _ => return Err(error),
        }
    }
}

/// Leaves out the observables that were measured at no condition: nothing would show how their runs scatter.
fn leave_out_unmeasured(plan: &mut ResidualPlan) {
    let measured = |k: &usize| plan.conditions.iter().any(|c| c.values[*k].is_some());
    let kept: Vec<usize> = (0..plan.observables.len()).filter(measured).collect();
    let of_kept = |row: &Vec<f64>| kept.iter().map(|&k| row[k]).collect();
    for c in &mut plan.conditions {
        c.values = kept.iter().map(|&k| c.values[k]).collect();
        c.covariance = kept.iter().map(|&k| of_kept(&c.covariance[k])).collect();
    }
    plan.observables = kept.iter().map(|&k| plan.observables[k].clone()).collect();
}

/// The lists of runs of a study that are certain if nothing fails: the start and the steps beside it, the first fit at the used
/// conditions, and its end at the kept ones.
pub(crate) fn certain_lists(plan: &ResidualPlan) -> [Vec<RunRequest>; 3] {
    let settings = linearisation::start_and_steps(plan);
    let mut start: Vec<RunRequest> = Vec::new();
    for request in settings
        .iter()
        .flat_map(|(point, _)| runs::requests(plan, point, 0, At::Used))
    {
        // An effect that a condition cannot carry is the start there.
        if !start.contains(&request) {
            start.push(request);
        }
    }
    let (at, block) = (&settings[0].0, BLOCKS_OF_FIT[0]);
    let [used, kept] = [At::Used, At::Kept].map(|at_all| runs::requests(plan, at, block, at_all));
    [start, used, kept]
}

/// How many times as many runs the kept conditions get if an answer was withdrawn for what few runs show there.
pub(crate) const MORE_AT_KEPT: usize = 3;
/// Least share of the runs in the variance of a kept value for which more runs may change the answer.
const NOISE_OF_RUNS: f64 = 0.1;

/// The study of a plan whose conditions can all be run. An answer that the kept conditions withdraw is checked once more with more
/// runs there, if their noise may have decided.
fn studied(worker: &Worker<'_>, plan: &ResidualPlan) -> Result<ResidualStudy, Error> {
    let first = study_of_all(worker, plan, plan.replicates)?;
    if first.runs_may_change_it {
        // The runs so far are records, and are not done again.
        return Ok(study_of_all(worker, plan, MORE_AT_KEPT * plan.replicates)?.study);
    }
    Ok(first.study)
}

/// A study, and whether it withdrew an answer that more runs at the kept conditions may bring back.
struct StudyOfRuns {
    study: ResidualStudy,
    runs_may_change_it: bool,
}

/// The declared parameters fitted to the used conditions, and the runs at the kept ones where the fit has ended.
fn fitted(
    worker: &Worker<'_>,
    stated: &ResidualPlan,
    linear: Linearisation,
    runs_at_kept: usize,
) -> Result<(Linearisation, Visited), Error> {
    let at_start = stated.with_errors_at(&linear.nominal);
    let fits = Fits::new(worker, &at_start, runs_at_kept);
    let (mut fit, visited) = fits.declared(&linear)?;
    let kept = fits.run(&fit.setting, fit.block, At::Kept)?;
    let linear = linear.with_points(&visited).with_scatter(&kept);
    fit.means = fit.means.with_kept(kept);
    Ok((linear, fit))
}

/// The study with so many runs of each mean at the kept conditions.
fn study_of_all(
    worker: &Worker<'_>,
    plan: &ResidualPlan,
    runs_at_kept: usize,
) -> Result<StudyOfRuns, Error> {
    let (linear, left_out) = Linearisation::run(worker, plan)?;
    let mut stated = plan.clone();
    stated.effects.retain(|e| !left_out.contains_key(&e.name));
    let (linear, fit) = fitted(worker, &stated, linear, runs_at_kept)?;
    let plan = &stated.with_errors_at(&fit.means);
    let fits = Fits::new(worker, plan, runs_at_kept);
    let Diagnosed {
        linear,
        mut file,
        mut diagnosis,
        mut remeasured,
    } = remeasured_and_diagnosed(&fits, linear, &fit)?;
    // At the conditions of the fit an unknown effect may do as well; what the kept ones say is asked then.
    let by_kept = !diagnosis.proposal.is_empty() && !plan.rows(At::Kept).is_empty();
    if by_kept {
        diagnosis = diagnosis.with_proposal_named();
    }
    let errors_before = assemble::errors(plan, &linear, &fit.means)?;
    let Decided {
        mut diagnosis,
        added,
        all_could_be_run,
    } = fits.decided(&linear, &fit, diagnosis, &mut remeasured)?;
    diagnosis.warnings.append(&mut remeasured.warnings);
    let had_answer = !diagnosis.effects.is_empty();
    if all_could_be_run && !diagnosis.effects.is_empty() {
        // What could not be run was not refuted.
        diagnosis = checked(&fits, &linear, &fit, (&errors_before, &added), diagnosis)?;
    }
    if by_kept && !diagnosis.effects.is_empty() {
        diagnosis = over_unknown(&fits, &linear, &fit, (&file, &added), diagnosis)?;
    }
    let runs_may_change_it = had_answer
        && diagnosis.effects.is_empty()
        && assemble::share_of_runs(plan, &linear, &fit.means, At::Kept) > NOISE_OF_RUNS;
    let (experiments, offered) = fits.candidates(&linear, &fit, &diagnosis)?;
    if !experiments.is_empty() {
        file.candidate_experiments = experiments;
        diagnosis = diagnosis.with_next_measurement(&Problem::try_from(file.clone())?)?;
    }
    let (after, rivals) = after_and_rivals(&diagnosis, added);
    let study = ResidualStudy {
        plan: plan.clone(),
        left_out,
        left_out_conditions: BTreeMap::new(),
        noise_dof: linear.least_dof(),
        run_sd: linear.scatter_of_runs(plan),
        fitted: fit.setting.by_name(plan),
        simulated_before: fit.means.values,
        errors_before,
        problem: file,
        diagnosis,
        after,
        rivals,
        offered,
    };
    Ok(StudyOfRuns {
        study,
        runs_may_change_it,
    })
}

/// A diagnosis of the linear problem, and what it was made of.
struct Diagnosed {
    /// The slopes behind it.
    linear: Linearisation,
    file: ProblemFile,
    diagnosis: Diagnosis,
    /// Which effects were looked at again.
    remeasured: Remeasured,
}

/// Diagnoses the residual at the fit; what the answer depends on is measured with further runs first: slopes that are noise,
/// slopes of the suspects, and amplitudes that no straight line tells.
fn remeasured_and_diagnosed(
    fits: &Fits<'_>,
    mut linear: Linearisation,
    fit: &Visited,
) -> Result<Diagnosed, Error> {
    let plan = fits.plan;
    let fitted = &fit.setting.parameters;
    let diagnosed = |linear: &Linearisation| -> Result<(ProblemFile, Diagnosis), Error> {
        let file = assemble::problem(plan, linear, fitted, &fit.means);
        let diagnosis = diagnose(&Problem::try_from(file.clone())?, &Options::new(plan.seed))?;
        Ok((file, diagnosis))
    };
    let (mut file, mut diagnosis) = diagnosed(&linear)?;
    let mut remeasured = Remeasured::default();
    let noisy = fits.noisy(fit, &diagnosis);
    if !noisy.is_empty() && diagnosis.verdict != Verdict::Refused {
        let runs = noisy.into_iter().zip(FIRST_BLOCK_OF_NOISY..);
        linear = fits.measured_anew(linear, fit, runs, &mut remeasured)?;
        (file, diagnosis) = diagnosed(&linear)?;
    }
    let quiet = [Verdict::None, Verdict::Refused, Verdict::NotTestable];
    if !quiet.contains(&diagnosis.verdict) {
        let suspects = fits.suspects(&linear, fit, &diagnosis)?;
        if !suspects.is_empty() {
            let suspects = suspects.into_iter().map(|(j, setting)| (j, vec![setting]));
            let runs = suspects.zip(FIRST_BLOCK_ANEW..);
            linear = fits.measured_anew(linear, fit, runs, &mut remeasured)?;
            (file, diagnosis) = diagnosed(&linear)?;
        }
    }
    // By its slopes no single effect leaves only noise; with a bent response one may.
    if diagnosis.verdict == Verdict::Unknown || diagnosis.tie_groups.len() > 1 {
        let suspects = fits.suspects(&linear, fit, &diagnosis)?;
        let suspects = worth_a_search(&diagnosis, plan, suspects);
        if !suspects.is_empty() {
            linear = fits.searched(linear, fit, &suspects, &mut remeasured)?;
            (file, diagnosis) = diagnosed(&linear)?;
        }
    }
    Ok(Diagnosed {
        linear,
        file,
        diagnosis,
        remeasured,
    })
}

/// The amplitudes that the data ask for, with their intervals: of an effect in several models that in the first.
fn amplitudes_of(added: &[AddedEffect]) -> BTreeMap<String, Amplitude> {
    let mut all = BTreeMap::new();
    for (name, estimate) in added.iter().flat_map(|model| &model.estimates) {
        all.entry(name.clone()).or_insert(*estimate);
    }
    all
}

/// Holds a diagnosis against the kept conditions, by the real runs of the models that it proposes.
fn checked(
    fits: &Fits<'_>,
    linear: &Linearisation,
    fit: &Visited,
    (before, added): (&ErrorPair, &[AddedEffect]),
    diagnosis: Diagnosis,
) -> Result<Diagnosis, Error> {
    let plan = fits.plan;
    let Some(before) = &before.kept else {
        return Ok(diagnosis);
    };
    let on_kept =
        |values: &[Vec<f64>]| whitened::whitened(plan, linear, &fit.means.n, (values, At::Kept));
    let (without, _) = on_kept(&fit.means.values)?;
    let mut models = Vec::new();
    for model in added {
        let (residual, noise) = on_kept(&model.simulated)?;
        models.extend(model.errors.kept.as_ref().map(|errors| CheckedModel {
            whitened_mse: errors.whitened_mse,
            contrast: Contrast::new(&residual, &without, noise),
            model: RefittedModel {
                effects: model.effects.keys().cloned().collect(),
                residual,
                noise,
            },
        }));
    }
    let values = plan.rows(At::Kept).len();
    Ok(diagnosis.checked_by_runs(before.whitened_mse, &models, values))
}

/// Keeps a name that the conditions of the fit did not give only where those kept from it make it a hundred times as likely as an
/// unknown effect.
fn over_unknown(
    fits: &Fits<'_>,
    linear: &Linearisation,
    fit: &Visited,
    (file, added): (&ProblemFile, &[AddedEffect]),
    diagnosis: Diagnosis,
) -> Result<Diagnosis, Error> {
    let plan = fits.plan;
    let problem = Problem::try_from(file.clone())?;
    let of_best = added.iter().find_map(|model| {
        let name = model.effects.keys().next()?;
        diagnosis.effects.contains(name).then_some((name, model))
    });
    let ln_factor = of_best.map(|(name, model)| {
        let means = (&fit.means, &model.simulated[..]);
        let kept = assemble::kept(plan, linear, means);
        ln_over_unknown(&problem, name, &kept)
    });
    Ok(diagnosis.against_unknown(ln_factor.transpose()?))
}

#[cfg(test)]
mod amplitude_tests;
#[cfg(test)]
mod candidate_tests;
#[cfg(test)]
mod estimate_tests;
#[cfg(test)]
mod failure_tests;
#[cfg(test)]
mod nonlinear_tests;
#[cfg(test)]
mod rival_tests;
#[cfg(test)]
mod slope_tests;
#[cfg(test)]
mod tests;
