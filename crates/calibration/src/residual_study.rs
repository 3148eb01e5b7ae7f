//! The residual of several conditions: fit, linearise, diagnose, add the effect, fit again.
//!
//! The linear prediction only proposes: every error in the result comes from real runs.

mod assemble;
mod refit;
mod runs;

use crate::Error;
use campaign::{Campaign, RunRequest, Simulator};
use residual_diagnosis::{
    CandidateResult, Diagnosis, Options, Problem, ProblemFile, Sign, Verdict, diagnose,
};
use runs::{At, Linearisation, Means};
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
    /// Least and largest amplitude that is physically possible.
    pub range: [f64; 2],
}

impl EffectProbe {
    /// Largest size of its amplitude.
    pub fn largest(&self) -> f64 {
        self.range[1].max(-self.range[0])
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
    pub covariance: Vec<Vec<Vec<f64>>>,
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
    /// The residual, covariances and sensitivities that the diagnosis was made of.
    pub problem: ProblemFile,
    /// Diagnosis of the residual.
    pub diagnosis: Diagnosis,
    /// The model with the effect added; none where no effect was named. It stays here when the kept
    /// conditions speak against it and the naming is withdrawn.
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
    let (linear, left_out) = Linearisation::run(campaign, simulator, plan)?;
    let mut plan = plan.clone();
    plan.effects.retain(|e| !left_out.contains_key(&e.name));
    let plan = &plan;
    let (fitted, at_fit, block) = fit_declared(campaign, simulator, plan, observed, &linear)?;
    let mut linear = linear.with_scatter(&at_fit);
    let diagnosed = |linear: &Linearisation| -> Result<(ProblemFile, Diagnosis), Error> {
        let file = assemble::problem(plan, observed, linear, &fitted, &at_fit);
        let diagnosis = diagnose(&Problem::try_from(file.clone())?, &Options::new(plan.seed))?;
        Ok((file, diagnosis))
    };
    let (mut file, mut diagnosis) = diagnosed(&linear)?;
    let mut warnings = Vec::new();
    for look in 0..LOOKS {
        let settings = match diagnosis.verdict {
            Verdict::None | Verdict::Refused | Verdict::NotTestable => break,
            Verdict::Named | Verdict::Tie if look > 0 => break,
            _ => suspects(plan, observed, &linear, (&fitted, &at_fit), &diagnosis)?,
        };
        if settings.is_empty() {
            break;
        }
        let fit = (fitted.as_slice(), &at_fit, block);
        let blocks = FIRST_BLOCK + (look * MOST_SUSPECTS) as u64..;
        let runs = settings.into_iter().zip(blocks);
        let failed;
        (linear, failed) = measured_anew(campaign, simulator, plan, linear, fit, runs)?;
        warnings.extend(failed);
        (file, diagnosis) = diagnosed(&linear)?;
    }
    diagnosis.warnings.extend(warnings);
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
                (&fitted, &at_fit),
                &diagnosis.effects,
            )?)
        };
    let kept = |errors: &ErrorPair| errors.kept.as_ref().map(|e| e.whitened_mse);
    let on_kept = |a: &AddedEffect| kept(&errors_before).zip(kept(&a.errors));
    if let Some((before, after)) = after.as_ref().and_then(on_kept) {
        let unused = (0..plan.conditions.len()).filter(|&c| !plan.conditions[c].used);
        let values = unused.map(|c| observed.measured(c).len()).sum();
        diagnosis = diagnosis.checked_by_runs(before, after, values);
    }
    let names = || plan.declared.iter().map(|d| d.name.clone());
    Ok(ResidualStudy {
        plan: plan.clone(),
        left_out,
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
        problem: file,
        diagnosis,
        after,
    })
}

/// Largest number of effects whose sensitivity is measured anew at a time.
const MOST_SUSPECTS: usize = 3;
/// How often that is done: wherever something stands out, and again where no effect is adequate then, or none
/// beats an unknown one.
const LOOKS: usize = 2;
/// First block of seeds of these runs.
const FIRST_BLOCK: u64 = 6;

/// Effects whose sensitivity decides, the best explanations of what remains, each with the setting that fits best
/// with it.
///
/// A sensitivity is a difference quotient at the start, with a step of its own choice. Parameters and amplitudes end
/// elsewhere: a real effect that the parameters have partly taken up, or that does not grow in proportion to
/// its amplitude, is not to be judged by that straight line. What leaves the motion alone, as a camera does, keeps
/// the fitted parameters, at which it shares their noise. No amplitude is below the smallest that can be seen, for a
/// quotient over less is noise.
fn suspects(
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    (fitted, at_fit): (&[f64], &Means),
    diagnosis: &Diagnosis,
) -> Result<Vec<(usize, runs::Setting)>, Error> {
    let mut suspects = Vec::new();
    for (j, effect) in plan.effects.iter().enumerate() {
        let candidate = diagnosis.candidates.get(&effect.name);
        let helps = candidate.filter(|c| c.testable && c.z.is_some_and(|z| z.abs() > 2.0));
        let amplitude = helps.and_then(|c| Some((c, c.amplitude.filter(|a| *a != 0.0)?)));
        suspects.extend(amplitude.map(|(c, amplitude)| (c, j, amplitude)));
    }
    suspects.sort_by(|a, b| a.0.t_after.total_cmp(&b.0.t_after));
    suspects.truncate(MOST_SUSPECTS);
    let setting = |(candidate, j, amplitude): (&CandidateResult, usize, f64)| {
        let EffectProbe { name, range, .. } = &plan.effects[j];
        let mut setting = runs::Setting::declared(plan, fitted);
        setting.effects.insert(name.clone(), 0.0);
        let mut amplitude = amplitude;
        if !linear.shares_noise(j) {
            let about = (&setting, at_fit);
            setting =
                refit::with_effects(plan, observed, linear, std::slice::from_ref(name), about)?;
            if setting.effects[name] != 0.0 {
                amplitude = setting.effects[name];
            }
        }
        let least = candidate.smallest_detectable.unwrap_or(0.0);
        let size = amplitude.abs().max(least);
        let amplitude = (size * amplitude.signum()).clamp(range[0], range[1]);
        setting.effects.insert(name.clone(), amplitude);
        Ok((j, setting))
    };
    suspects.into_iter().map(setting).collect()
}

/// Runs each suspect at its setting and takes its sensitivity from there; a warning for each that cannot be run.
///
/// An effect that shares the noise of the runs without it gets their seeds, the others those of their own block.
fn measured_anew(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    mut linear: Linearisation,
    (fitted, at_fit, block): (&[f64], &Means, u64),
    suspects: impl Iterator<Item = ((usize, runs::Setting), u64)>,
) -> Result<(Linearisation, Vec<String>), Error> {
    let (mut effects, mut settings) = (Vec::new(), Vec::new());
    for ((effect, setting), own) in suspects {
        let shares = linear.shares_noise(effect);
        effects.push(effect);
        settings.push((setting, if shares { block } else { own }));
    }
    let means = runs::means_of_each(campaign, simulator, plan, &settings)?;
    let mut warnings = Vec::new();
    for ((effect, (setting, _)), means) in effects.into_iter().zip(&settings).zip(means) {
        let name = &plan.effects[effect].name;
        match means {
            Ok(means) => {
                let from = (runs::Setting::declared(plan, fitted), at_fit);
                linear = linear.with_secant(plan, effect, (&from.0, from.1), (setting, &means));
            }
            Err(reason) => warnings.push(format!(
                "{name} could not be run at the amplitude {:.3} that the data ask for, so that it is \
                 judged by its sensitivity further away: {reason}",
                setting.effects[name]
            )),
        }
    }
    Ok((linear, warnings))
}

/// Fits the declared parameters and runs there; corrects up to twice where that misses.
///
/// The slopes stay those of the start. A correction is kept only where real runs on the used
/// conditions say that it helps. Also returns the block of seeds of the runs at the end.
fn fit_declared(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
) -> Result<(Vec<f64>, Means, u64), Error> {
    let start: Vec<f64> = plan.declared.iter().map(|d| d.start).collect();
    let run = |point: &[f64], block: u64, at: At| {
        let setting = runs::Setting::declared(plan, point);
        runs::means(campaign, simulator, plan, &setting, block, at)
    };
    let misfit = |m: &Means| assemble::misfit(plan, observed, linear, m);
    let mut fitted = refit::declared(plan, observed, linear, &start, &linear.nominal)?;
    let mut means = run(&fitted, 1, At::Used)?;
    let mut taken = 1;
    for block in [4, 5] {
        if misfit(&means)? <= likely_mean_square(plan, observed) {
            break;
        }
        let corrected = refit::declared(plan, observed, linear, &fitted, &means)?;
        let again = run(&corrected, block, At::Used)?;
        if misfit(&again)? >= misfit(&means)? {
            break;
        }
        (fitted, means, taken) = (corrected, again, block);
    }
    // The kept conditions are run once, where the fit has ended.
    let kept = run(&fitted, taken, At::Kept)?;
    Ok((fitted, means.with_kept(kept), taken))
}

/// Whitened mean square that a right model exceeds in 1 of 40 cases: 1 + 2 sqrt(2/n) for n rows.
fn likely_mean_square(plan: &ResidualPlan, observed: &Observed) -> f64 {
    let used = (0..plan.conditions.len()).filter(|&c| plan.conditions[c].used);
    let rows: usize = used.map(|c| observed.measured(c).len()).sum();
    1.0 + 2.0 * (2.0 / rows as f64).sqrt()
}

/// Fits parameters and amplitudes together and runs there; corrects once where that misses.
fn add_effects(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    observed: &Observed,
    linear: &Linearisation,
    (fitted, at_fit): (&[f64], &Means),
    effects: &[String],
) -> Result<AddedEffect, Error> {
    let mut start = runs::Setting::declared(plan, fitted);
    start
        .effects
        .extend(effects.iter().map(|name| (name.clone(), 0.0)));
    let mut point = refit::with_effects(plan, observed, linear, effects, (&start, at_fit))?;
    let run = |point: &runs::Setting, block: u64, at: At| {
        runs::means(campaign, simulator, plan, point, block, at)
    };
    let (mut means, mut taken) = (run(&point, 2, At::Used)?, 2);
    let first = assemble::misfit(plan, observed, linear, &means)?;
    if first > likely_mean_square(plan, observed) {
        let about = (&point, &means);
        let corrected = refit::with_effects(plan, observed, linear, effects, about)?;
        let again = run(&corrected, 3, At::Used)?;
        if assemble::misfit(plan, observed, linear, &again)? < first {
            (point, means, taken) = (corrected, again, 3);
        }
    }
    let means = means.with_kept(run(&point, taken, At::Kept)?);
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
mod tests;
