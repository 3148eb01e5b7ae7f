//! What the residual at the estimate says: which effect, if any, the model lacks.

use crate::budget::lists_of;
use crate::correlated::correlation_of;
use crate::{
    CalibrationProblem, Candidate, CandidateMeasurement, DiagnosisStage, Error, LoopSettings,
    Measurement, Model, Parameter, ResidualPlan, Role, RunList, StudyCondition, runs_needed,
    study_residual,
};
use campaign::{Campaign, RunRequest, Simulator};
use std::collections::BTreeMap;

/// Stage number: sets the seeds.
const STAGE: u64 = 80;

/// Looks for what the model lacks at given values of the parameters; the last stage of a calibration alone.
///
/// It is left out, with the reason, if no effect is to be searched, the measurements are as many as the parameters, or runs
/// failed at all conditions.
///
/// # Errors
///
/// An invalid problem, a campaign that was stopped, a covariance that cannot be used.
pub fn diagnose_at(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    at: &[f64],
) -> Result<DiagnosisStage, Error> {
    if problem.effects.is_empty() {
        return Ok(left_out("no effect is to be searched"));
    }
    let plan = plan(problem, settings, at);
    let (values, free) = (plan.values_of_fit(), problem.n_tuned());
    if values <= free {
        return Ok(left_out(&format!(
            "{values} measurements of role fit and {free} parameters: what {free} parameters can always meet tests nothing; measure \
             more observables or conditions"
        )));
    }
    let length = |lists: &[RunList]| length_of(campaign, simulator, lists);
    let (certain, further) = lists_of(&plan);
    let least = length(&certain);
    campaign.expect([least, least + length(&further)], [0.0; 2]);
    match study_residual(campaign, simulator, &plan) {
        Ok(study) => Ok(DiagnosisStage::Done(Box::new(study))),
        // What the other stages found stands without it.
        Err(error @ Error::Cell { .. }) => Ok(left_out(&error.to_string())),
        Err(error) => Err(error),
    }
}

/// The lists of runs of a diagnosis: those that are certain if nothing fails, and further ones, at most. `None` if
/// [`diagnose_at`] leaves it out.
pub(crate) fn lists_of_diagnosis(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
) -> (Vec<RunList>, Vec<RunList>) {
    let plan = plan(problem, settings, &problem.start());
    if problem.effects.is_empty() || plan.values_of_fit() <= problem.n_tuned() {
        return (Vec::new(), Vec::new());
    }
    lists_of(&plan)
}

/// Length of lists of runs behind each other, see [`Campaign::length_of`].
pub(crate) fn length_of(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    lists: &[RunList],
) -> f64 {
    let length = |list: &RunList| {
        let cost = |request| simulator.prepare(request).map_or(1.0, |run| run.cost());
        list.times as f64 * campaign.length_of(list.requests.iter().map(cost))
    };
    lists.iter().map(length).sum()
}

/// The problem that a budget allows to diagnose after so many runs: without what to measure next if only that is too much.
///
/// # Errors
///
/// Why the diagnosis is left out: the budget does not allow all the runs that it may need.
pub(crate) fn within_budget(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    spent: usize,
) -> Result<CalibrationProblem, String> {
    let Some(most) = settings.most_runs.filter(|_| !problem.effects.is_empty()) else {
        return Ok(problem.clone());
    };
    let needed = most_runs_of_diagnosis(problem, settings);
    if spent + needed > most {
        return Err(format!(
            "it may need {needed} runs, and the budget of {most} leaves {}: raise it to {}, or search fewer effects",
            most.saturating_sub(spent),
            spent + needed
        ));
    }
    if spent + needed + most_runs_of_candidates(problem, settings) > most {
        return Ok(problem.without_candidates());
    }
    Ok(problem.clone())
}

fn left_out(reason: &str) -> DiagnosisStage {
    DiagnosisStage::LeftOut {
        reason: reason.to_owned(),
    }
}

/// Most runs at the candidates for the next measurement, beyond those of the diagnosis; they are done only where it leaves
/// a question.
pub fn most_runs_of_candidates(problem: &CalibrationProblem, settings: &LoopSettings) -> usize {
    if problem.effects.is_empty() {
        return 0;
    }
    let start = problem.start();
    plan(problem, settings, &start)
        .requests_at_candidates()
        .len()
}

/// Most runs that the diagnosis of a problem may need, without those at candidates; `None` if no effect is to be searched.
pub fn most_runs_of_diagnosis(problem: &CalibrationProblem, settings: &LoopSettings) -> usize {
    if problem.effects.is_empty() {
        return 0;
    }
    let start = problem.start();
    runs_needed(&plan(problem, settings, &start))
}

/// The residual study of a problem about a point.
///
/// An observable of the plan belongs to one scene, so that runs of one scene under several conditions share the scatter
/// of their noise, and those of different scenes do not.
pub(crate) fn plan(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    at: &[f64],
) -> ResidualPlan {
    let judged = |m: &&Measurement| m.role != Role::Show;
    let mut observables: Vec<String> = problem
        .measurements
        .iter()
        .filter(judged)
        .map(|m| name_in_plan(problem, m))
        .collect();
    observables.sort();
    observables.dedup();
    let mut conditions = Vec::new();
    for role in [Role::Fit, Role::Check] {
        for k in problem.models_of(role) {
            let all = problem.measurements.iter().enumerate();
            let here: Vec<(usize, &Measurement)> = all
                .filter(|(_, m)| m.model == k && m.role == role)
                .collect();
            let of = |name: &String| {
                let mut here = here.iter();
                here.find(|(_, m)| name_in_plan(problem, m) == *name)
            };
            let measured: Vec<_> = observables.iter().map(of).collect();
            let names = here
                .iter()
                .map(|(_, m)| (name_in_plan(problem, m), m.observable.clone()));
            let scatters = here.iter().filter(|(_, m)| m.is_scatter);
            conditions.push(StudyCondition {
                observables: Some(names.collect()),
                used: role == Role::Fit,
                values: measured.iter().map(|m| m.map(|(_, m)| m.mean)).collect(),
                covariance: block(problem, &measured),
                scatters: scatters.map(|(_, m)| name_in_plan(problem, m)).collect(),
                ..condition(problem, &problem.models[k])
            });
        }
    }
    ResidualPlan {
        id: problem.id.clone(),
        base: RunRequest::new("", settings.seed + 100_000 * STAGE),
        conditions,
        observables,
        parameters: (problem.parameters.iter().zip(at))
            .map(|(p, &start)| Parameter { start, ..p.clone() })
            .collect(),
        effects: problem.effects.clone(),
        replicates: settings.diagnosis_replicates.max(2),
        seed: settings.seed,
        candidates: problem
            .candidates
            .iter()
            .map(|c| candidate(problem, c))
            .collect(),
    }
}

/// Covariance of the measured means of one condition, each with its number; 0 for what was not measured there.
fn block(
    problem: &CalibrationProblem,
    measured: &[Option<&(usize, &Measurement)>],
) -> Vec<Vec<f64>> {
    let covariance = |a: Option<&(usize, &Measurement)>, b: Option<&(usize, &Measurement)>| {
        let (Some((i, a)), Some((j, b))) = (a, b) else {
            return 0.0;
        };
        if i == j {
            return a.variance();
        }
        correlation_of(problem, *i, *j) * (a.variance() * b.variance()).sqrt()
    };
    let row = |a: &Option<_>| measured.iter().map(|b| covariance(*a, *b)).collect();
    measured.iter().map(row).collect()
}

/// The name of a measured observable in the plan: with its scene where the problem has several.
pub(crate) fn name_in_plan(problem: &CalibrationProblem, m: &Measurement) -> String {
    name_at(problem, &problem.models[m.model].scene, &m.observable)
}

fn name_at(problem: &CalibrationProblem, scene: &str, observable: &str) -> String {
    if problem.models.iter().all(|other| other.scene == scene) {
        observable.to_owned()
    } else {
        format!("{scene}: {observable}")
    }
}

/// Numbers of the condition of a model are its coordinates.
fn coordinates(model: &Model) -> BTreeMap<String, f64> {
    let number = |text: &String| {
        let first = text.split_whitespace().next()?;
        first.parse::<f64>().ok().filter(|x| x.is_finite())
    };
    let all = model.condition.iter();
    all.filter_map(|(name, value)| Some((name.clone(), number(value)?)))
        .collect()
}

/// A candidate as the plan knows it.
fn candidate(problem: &CalibrationProblem, candidate: &Candidate) -> CandidateMeasurement {
    let Candidate {
        model,
        standard_errors,
        minutes,
        ..
    } = candidate;
    let in_plan = |name: &String| name_at(problem, &model.scene, name);
    let names = standard_errors.keys();
    CandidateMeasurement {
        name: model.name.clone(),
        condition: StudyCondition {
            observables: Some(names.map(|name| (in_plan(name), name.clone())).collect()),
            ..condition(problem, model)
        },
        standard_errors: standard_errors
            .iter()
            .map(|(name, se)| (in_plan(name), *se))
            .collect(),
        minutes: *minutes,
    }
}

/// A model as a condition at which nothing is measured.
fn condition(problem: &CalibrationProblem, model: &Model) -> StudyCondition {
    StudyCondition {
        model: Some(model.name.clone()),
        condition: coordinates(model),
        parameters: Some(problem.symbols(&model.parameters).into_iter().collect()),
        ..StudyCondition::default()
    }
}
