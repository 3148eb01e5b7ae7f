//! What could be measured next: the sensitivities there, by real runs.

use super::fits::{Fits, Visited};
use super::linearisation::Linearisation;
use super::runs::{self, At, Setting};
use super::scatter::Scatter;
use super::{EffectProbe, ResidualPlan, StudyCondition};
use crate::Error;
use crate::diagnosis::{Diagnosis, ExperimentFile, Level, QuestionedEffect, SensitivityRuns};
use campaign::RunRequest;
use campaign::run_store::Record;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most effects in question that are run at a candidate, the best explanations first.
pub(crate) const MOST_IN_QUESTION: usize = 3;
/// Block of seeds of all runs at candidates: those of one candidate share their seeds.
const BLOCK: u64 = 20;

/// A measurement that could be made next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CandidateMeasurement {
    /// Its name.
    pub name: String,
    /// Where it would measure.
    pub condition: StudyCondition,
    /// Standard error that the mean of each observable would have, by its name in a plan.
    pub standard_errors: BTreeMap<String, f64>,
    /// Work in the laboratory, min.
    pub minutes: f64,
}

/// Result of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfferedMeasurement {
    /// Its name.
    pub name: String,
    /// Work in the laboratory, min.
    pub minutes: f64,
    /// Runs that a diagnosis with it does there at least.
    pub runs: usize,
    /// Keys of the runs that gave its sensitivities.
    pub keys: Vec<String>,
    /// Why it cannot be offered; `None` if it is.
    pub left_out: Option<String>,
}

impl ResidualPlan {
    /// As many runs at all candidates as there may be, for r replicates, K declared parameters and M effects r (1 + K + min(M, 3)) for
    /// each.
    pub(crate) fn requests_at_candidates(&self) -> Vec<RunRequest> {
        let columns = self.parameters.len() + MOST_IN_QUESTION.min(self.effects.len());
        let start: Vec<f64> = self.parameters.iter().map(|d| d.start).collect();
        let each = self.candidates.iter().flat_map(|candidate| {
            let own = self.at_candidate(candidate);
            let at = Setting::declared(&own, &start);
            vec![runs::requests(&own, &at, BLOCK, At::Used); 1 + columns].concat()
        });
        each.collect()
    }

    /// The plan of the runs at a candidate.
    fn at_candidate(&self, candidate: &CandidateMeasurement) -> Self {
        Self {
            conditions: vec![StudyCondition {
                used: true,
                ..candidate.condition.clone()
            }],
            observables: candidate.standard_errors.keys().cloned().collect(),
            candidates: Vec::new(),
            ..self.clone()
        }
    }
}

/// A point at a candidate and the step to it from the fitted one.
struct Step {
    /// Parameters and amplitudes.
    setting: Setting,
    /// In the parameter or the amplitude.
    size: f64,
    /// Number of the effect; none for a parameter.
    effect: Option<usize>,
}

/// The fitted point, a step in each parameter, and each effect in question at the amplitude that the data ask for, or its
/// largest.
fn steps(
    plan: &ResidualPlan,
    fit: &Setting,
    asked: &[QuestionedEffect],
    d: &Diagnosis,
) -> Vec<Step> {
    let mut steps = Vec::new();
    for (j, declared) in plan.parameters.iter().enumerate() {
        let mut setting = fit.clone();
        let size = declared.step_from(setting.parameters[j]);
        setting.parameters[j] += size;
        steps.push(Step {
            setting,
            size,
            effect: None,
        });
    }
    let found = asked.iter().filter_map(|q| {
        let j = plan.effects.iter().position(|e| e.name == q.name)?;
        Some((j, q.amplitude.unwrap_or(0.0)))
    });
    for (j, amplitude) in found.take(MOST_IN_QUESTION) {
        let EffectProbe { name, range, .. } = &plan.effects[j];
        let [low, high] = *range;
        let size = if amplitude == 0.0 {
            if high >= -low { high } else { low }
        } else {
            // A quotient over less than what can be seen is noise.
            let candidate = d.candidates.get(name);
            let least = candidate.and_then(|c| c.smallest_detectable).unwrap_or(0.0);
            (amplitude.abs().max(least) * amplitude.signum()).clamp(low, high)
        };
        steps.push(Step {
            setting: fit.clone().with_amplitude(j, size),
            size,
            effect: Some(j),
        });
    }
    steps
}

impl Fits<'_> {
    /// Runs all candidates in one list, and gives the experiments that they are; a candidate that cannot be run at one of
    /// the points is left out, with the reason. Nothing is run if nothing is in question.
    pub(super) fn candidates(
        &self,
        linear: &Linearisation,
        fit: &Visited,
        diagnosis: &Diagnosis,
    ) -> Result<(Vec<ExperimentFile>, Vec<OfferedMeasurement>), Error> {
        let plan = self.plan;
        let asked = diagnosis.in_question();
        if asked.is_empty() || plan.candidates.is_empty() {
            return Ok((Vec::new(), Vec::new()));
        }
        let base = Setting::declared(plan, &fit.setting.parameters);
        let steps = steps(plan, &base, &asked, diagnosis);
        let points: Vec<&Setting> = std::iter::once(&base)
            .chain(steps.iter().map(|s| &s.setting))
            .collect();
        let plans: Vec<ResidualPlan> = plan
            .candidates
            .iter()
            .map(|c| plan.at_candidate(c))
            .collect();
        let each = plans.iter().flat_map(|own| {
            let points = points.iter();
            points.flat_map(move |point| runs::requests(own, point, BLOCK, At::Used))
        });
        let requests: Vec<RunRequest> = each.collect();
        let results = self.worker.each(&requests)?;
        let per_candidate = points.len() * plan.replicates;
        let size = per_candidate.max(1);
        let own = plans.iter().zip(results.chunks(size));
        let results: Vec<_> = own
            .flat_map(|(own, group)| runs::readable(own, At::Used, group.to_vec()))
            .collect();
        let (mut experiments, mut offered) = (Vec::new(), Vec::new());
        let groups = requests.chunks(size).zip(results.chunks(size));
        for ((candidate, own), (asked, group)) in plan.candidates.iter().zip(&plans).zip(groups) {
            let records = self.worker.borne(asked, group, plan.replicates);
            let left_out = records.as_ref().err().map(|short| short.reason.clone());
            let records = records.unwrap_or_default();
            offered.push(OfferedMeasurement {
                name: candidate.name.clone(),
                minutes: candidate.minutes,
                runs: plan.replicates * (2 + plan.parameters.len() + plan.effects.len()),
                keys: (records.iter().flatten())
                    .map(|r| r.key().to_owned())
                    .collect(),
                left_out: left_out.clone(),
            });
            if left_out.is_none() {
                experiments.push(experiment(candidate, own, linear, &steps, &records)?);
            }
        }
        Ok((experiments, offered))
    }
}

/// The experiment that a candidate is, by the runs at it: those at the fitted point, then those of each step.
fn experiment(
    candidate: &CandidateMeasurement,
    own: &ResidualPlan,
    linear: &Linearisation,
    steps: &[Step],
    records: &[Option<&Record>],
) -> Result<ExperimentFile, Error> {
    let r = own.replicates;
    let mut groups = records.chunks(r);
    let at_fit = groups.next().unwrap_or_default();
    let means = runs::means_of(own, at_fit, At::Used)?;
    let mut scatter: Scatter = means.scatter.clone();
    let n = own.observables.len();
    let (mut declared, mut library) = (vec![Vec::new(); n], vec![vec![0.0; own.effects.len()]; n]);
    let (mut steps_declared, mut steps_library) = (Vec::new(), vec![None; own.effects.len()]);
    let mut least = means.least_n();
    for (step, group) in steps.iter().zip(groups) {
        let beside = runs::means_of(own, group, At::Used)?;
        least = least.min(beside.least_n());
        // What is run already when the step changes nothing has no slope, and no noise.
        let differs = runs::differ(at_fit, group);
        let shares = step.effect.is_some_and(|j| linear.shares_noise(j));
        let noisy = (differs && !shares).then_some(step.size);
        if noisy.is_some() {
            scatter.add(&beside.scatter);
        }
        let slope = |k: usize| (beside.values[0][k] - means.values[0][k]) / step.size;
        match step.effect {
            None => {
                (0..n).for_each(|k| declared[k].push(slope(k)));
                steps_declared.push(noisy);
            }
            Some(j) => {
                (0..n).for_each(|k| library[k][j] = slope(k));
                steps_library[j] = noisy;
            }
        }
    }
    let of_run = scatter.pooled();
    let of_mean: Vec<Vec<f64>> = of_run
        .iter()
        .map(|line| line.iter().map(|x| x / least as f64).collect())
        .collect();
    let mut covariance = of_mean.clone();
    for (k, se) in candidate.standard_errors.values().enumerate() {
        covariance[k][k] += se * se;
    }
    let levels = candidate.condition.condition.iter();
    let effects = steps.iter().filter_map(|s| s.effect);
    Ok(ExperimentFile {
        name: Some(candidate.name.clone()),
        condition: levels
            .map(|(name, x)| (name.clone(), Level::Number(*x)))
            .collect(),
        sensitivities_declared: declared,
        sensitivities_library: library,
        covariance,
        effects: Some(effects.map(|j| own.effects[j].name.clone()).collect()),
        runs: Some(SensitivityRuns {
            covariance_of_mean: of_mean,
            steps_declared,
            steps_library,
        }),
        cost: candidate.minutes,
    })
}
