//! The measurements with what was missing added to the model, by real runs.

use crate::comparison::{Simulated, compared, tails_of};
use crate::diagnosis::Verdict;
use crate::diagnosis_stage::name_in_plan;
use crate::intervals::quantile_of;
use crate::{
    AddedEffect, CalibrationProblem, DiagnosisStage, Estimate, Measurement, ResidualStudy, Role,
    SimulatedMean, WithEffects,
};

/// Chance that an interval misses its parameter.
const MISSES: f64 = 0.05;

/// A verdict that is not met, with the effects that are named, if any: whether all is met with them, and the sentence.
pub(crate) fn judged_with(
    problem: &CalibrationProblem,
    diagnosis: &DiagnosisStage,
    (met, verdict): (bool, String),
) -> (Option<WithEffects>, bool, String) {
    match with_effects(problem, diagnosis).filter(|_| !met) {
        None => (None, met, verdict),
        Some(with) => {
            let verdict = verdict + &in_words(&with, problem);
            let met = with.holds;
            (Some(with), met, verdict)
        }
    }
}

/// The measurements and parameters with the named effects; `None` if none is named.
fn with_effects(problem: &CalibrationProblem, diagnosis: &DiagnosisStage) -> Option<WithEffects> {
    let DiagnosisStage::Done(study) = diagnosis else {
        return None;
    };
    let added = study.after.as_ref();
    let added = added.filter(|_| study.diagnosis.verdict == Verdict::Named)?;
    let judged = problem.measurements.iter().filter(|m| m.role != Role::Show);
    let rows: Vec<_> = judged
        .clone()
        .filter_map(|m| {
            let simulated = simulated(problem, study, added, m)?;
            Some(compared(problem, m, simulated, tails_of(problem, m.role)))
        })
        .collect();
    let parameters = estimates(problem, study, added);
    let is_fixed = |estimate: &Estimate| estimate.se.is_some();
    Some(WithEffects {
        effects: added.effects.clone(),
        holds: rows.len() == judged.count()
            && rows.iter().all(|row| row.holds)
            && parameters.iter().all(is_fixed),
        parameters,
        rows,
    })
}

/// What the runs with the effects show of a measurement; `None` if its condition was left out.
fn simulated(
    problem: &CalibrationProblem,
    study: &ResidualStudy,
    added: &AddedEffect,
    m: &Measurement,
) -> Option<Simulated> {
    let model = &problem.models[m.model].name;
    let (plan, used) = (&study.plan, m.role == Role::Fit);
    let is_own = |c: &crate::StudyCondition| c.used == used && c.model.as_ref() == Some(model);
    let c = plan.conditions.iter().position(is_own)?;
    let name = name_in_plan(problem, m);
    let k = plan.observables.iter().position(|o| *o == name)?;
    let runs = added.runs[c];
    let of_run = study.run_sd.get(&name).copied().unwrap_or(0.0);
    Some(Simulated {
        mean: SimulatedMean {
            mean: *added.simulated[c].get(k)?,
            se: of_run / (runs as f64).sqrt(),
            n_runs: runs,
        },
        dof: study.noise_dof,
        parameter_variance: None,
    })
}

/// The tuned parameters as they were fitted with the effects.
fn estimates(
    problem: &CalibrationProblem,
    study: &ResidualStudy,
    added: &AddedEffect,
) -> Vec<Estimate> {
    let reach = quantile_of(MISSES, study.noise_dof);
    let tuned = problem.parameters[..problem.n_tuned()].iter();
    let one = |p: &crate::Parameter| {
        let value = added.fitted.get(&p.symbol).copied().unwrap_or(p.start);
        let se = added.fitted_se.get(&p.symbol).copied();
        let [low, high] = p.limits;
        let interval95 = se.map_or(p.limits, |se| {
            [value - reach * se, value + reach * se].map(|end| end.clamp(low, high))
        });
        Estimate {
            symbol: p.symbol.clone(),
            name: p.name.clone(),
            unit: p.unit.clone(),
            sets: p.sets.clone(),
            start: p.start,
            value,
            se,
            interval95,
            fixed_by_data: interval95 != p.limits,
            at_limit: value <= low || value >= high,
            limits: p.limits,
        }
    };
    tuned.map(one).collect()
}

/// The sentence behind a verdict that was not met without the effects.
fn in_words(with: &WithEffects, problem: &CalibrationProblem) -> String {
    let names: Vec<&str> = with.effects.keys().map(String::as_str).collect();
    let names = names.join(" and ");
    let missed: Vec<String> = with
        .rows
        .iter()
        .filter(|row| !row.holds)
        .map(crate::verdict::name)
        .collect();
    if !missed.is_empty() {
        return format!("; with {names} added it misses {}", missed.join(", "));
    }
    let kept = problem.measurements_of(Role::Check).len();
    format!(
        "; with {names} added all {} measurements hold, {kept} of them seen by no fit",
        with.rows.len()
    )
}
