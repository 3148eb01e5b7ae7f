//! What the measurements of a problem can be expected to detect, before any run.

use crate::diagnosis::{Level, Power, PowerDesign, power};
use crate::diagnosis_stage::{name_in_plan, plan};
use crate::{CalibrationProblem, Error, LoopSettings, Role};
use serde::Serialize;

/// Sizes of the hidden effect, in standard errors of its amplitude.
const SIZES: [f64; 3] = [3.0, 6.0, 12.0];
/// Size at which designs with one more of something are compared.
const COMPARED_AT: f64 = 6.0;
/// Drawn campaigns of each size: the standard error of a share is at most 0.05.
const CAMPAIGNS: usize = 100;

/// The power of a design, and of the same with one more of something.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PowerTable {
    /// Values that the fit uses.
    pub values: usize,
    /// Declared parameters.
    pub parameters: usize,
    /// Effects to search.
    pub effects: usize,
    /// By size.
    pub rows: Vec<Power>,
    /// Possible additions, as text, with the power at six standard errors.
    pub with_more: Vec<(String, Power)>,
}

/// The power of the measurements of a problem by campaigns with random shapes; `None` if no effect is to be searched.
///
/// A run is taken to scatter as the single measured values do, and inputs are taken to be right. Parameters and effects act where the models say.
///
/// # Errors
///
/// A covariance that cannot be used.
pub fn power_of_design(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
) -> Result<Option<PowerTable>, Error> {
    if problem.effects.is_empty() {
        return Ok(None);
    }
    let design = design(problem, settings);
    let seed = settings.seed;
    let rows = power(&design, &SIZES, CAMPAIGNS, seed)?;
    let more = [
        ("a condition", design.with_condition()),
        ("an observable", design.with_observable()),
        ("a scene", design.with_scene()),
    ];
    let mut with_more = Vec::new();
    for (words, design) in more {
        let row = power(&design, &[COMPARED_AT], CAMPAIGNS, seed)?;
        with_more.extend(row.into_iter().map(|row| (words.to_owned(), row)));
    }
    Ok(Some(PowerTable {
        values: design.rows.len(),
        parameters: problem.n_tuned(),
        effects: problem.effects.len(),
        rows,
        with_more,
    }))
}

/// The values that the fit uses, with what acts on them.
fn design(problem: &CalibrationProblem, settings: &LoopSettings) -> PowerDesign {
    let start = problem.start();
    let plan = plan(problem, settings, &start);
    let used: Vec<usize> = (0..plan.conditions.len())
        .filter(|&c| plan.conditions[c].used)
        .collect();
    let model_of = |c: usize| {
        let name = plan.conditions[c].model.as_deref();
        problem
            .models
            .iter()
            .position(|m| Some(m.name.as_str()) == name)
    };
    let (mut rows, mut simulated_variance) = (Vec::new(), Vec::new());
    for (at, &c) in used.iter().enumerate() {
        for k in plan.measured(c) {
            let mut all = problem.measurements.iter();
            let measurement = all.find(|m| {
                Some(m.model) == model_of(c)
                    && m.role == Role::Fit
                    && name_in_plan(problem, m) == plan.observables[k]
            });
            rows.push([at, k]);
            simulated_variance.push(measurement.map_or(1.0, |m| m.n / plan.replicates as f64));
        }
    }
    let moves = |j: usize| {
        let models = used.iter().map(|&c| model_of(c));
        let acts = models.map(|k| k.is_some_and(|k| problem.models[k].parameters.contains(&j)));
        acts.collect()
    };
    let levels = |c: &usize| {
        let levels = plan.conditions[*c].condition.iter();
        levels
            .map(|(name, x)| (name.clone(), Level::Number(*x)))
            .collect()
    };
    PowerDesign {
        conditions: used.iter().map(levels).collect(),
        rows,
        simulated_variance,
        declared: (0..problem.n_tuned()).map(moves).collect(),
        effects: plan
            .effects
            .iter()
            .map(|e| {
                used.iter()
                    .map(|&c| e.acts_on(&plan.conditions[c]))
                    .collect()
            })
            .collect(),
    }
}
