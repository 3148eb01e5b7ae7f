//! Published values beside results.
//!
//! A result is named by one of three forms:
//!
//! - `SYMBOL`: the estimate of a parameter;
//! - `OBSERVABLE of SCENE` or `OBSERVABLE of SCENE at CONDITION`: what the scene shows at the estimate, for a measured
//!   observable of any role; the condition as in the table of the measurement, `apparatus.speed = 15 rpm`, and left out
//!   where the observable is measured under one condition only;
//! - `effect of SYMBOL on OBSERVABLE of SCENE` (or `... at CONDITION`): mean at the high level minus mean at the low
//!   level of the screening.

use crate::file::CompareEntry;
use crate::scenes::model_name;
use inference::{Calibration, CalibrationProblem, Comparison, Model};
use serde::Serialize;
use std::collections::BTreeMap;

/// A published value beside the result of its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedValue {
    /// Name of the result.
    pub result: String,
    /// The published value.
    pub published: f64,
    /// Its standard deviation.
    pub published_sd: Option<f64>,
    /// Where it was published.
    pub source: String,
    /// Value found here; `None` if no stage gave it.
    pub found: Option<f64>,
    /// Its standard error.
    pub se: Option<f64>,
    /// Found minus published.
    pub difference: Option<f64>,
}

/// A name of a result that was understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ResultName {
    /// The estimate of a parameter.
    Parameter(String),
    /// An observable of a model.
    Observable {
        /// Name of the observable.
        observable: String,
        /// Number of the model.
        model: usize,
    },
    /// An effect in a screening.
    Effect {
        /// Symbol of the parameter.
        symbol: String,
        /// Name of the observable.
        observable: String,
        /// Number of the model.
        model: usize,
    },
}

/// Understands a name, or says what there is.
pub(crate) fn resolve(name: &str, problem: &CalibrationProblem) -> Result<ResultName, String> {
    let known = |symbol: &str| problem.parameters.iter().any(|p| p.symbol == symbol);
    if known(name.trim()) {
        return Ok(ResultName::Parameter(name.trim().to_owned()));
    }
    let effect = name.trim().strip_prefix("effect of ");
    let effect = effect.and_then(|rest| rest.split_once(" on "));
    let found = match effect {
        Some((symbol, of)) if known(symbol.trim()) => {
            observable(of, problem).map(|(observable, model)| ResultName::Effect {
                symbol: symbol.trim().to_owned(),
                observable,
                model,
            })
        }
        Some(_) => None,
        None => observable(name, problem)
            .map(|(observable, model)| ResultName::Observable { observable, model }),
    };
    found.ok_or_else(|| {
        let symbols: Vec<&str> = problem
            .parameters
            .iter()
            .map(|p| p.symbol.as_str())
            .collect();
        let measured = problem.measurements.iter().map(|m| {
            let model = &problem.models[m.model];
            name_of(&m.observable, model)
        });
        format!(
            "not a result; the results are {}; and 'effect of SYMBOL on ...' any of the latter",
            symbols
                .into_iter()
                .map(str::to_owned)
                .chain(measured)
                .collect::<Vec<_>>()
                .join("; ")
        )
    })
}

/// The full name of an observable.
fn name_of(observable: &str, model: &Model) -> String {
    let name = model_name(&model.scene, &model.condition);
    format!("{observable} of {}", name.replacen(" @ ", " at ", 1))
}

/// The observable and the number of its model; `None` if nothing fits, or several do.
fn observable(name: &str, problem: &CalibrationProblem) -> Option<(String, usize)> {
    let name = name.trim();
    let (observable, place) = name.split_once(" of ")?;
    let of_name = problem
        .measurements
        .iter()
        .filter(|m| m.observable == observable.trim());
    let scene = |model: usize| problem.models[model].scene == place.trim();
    let exact = of_name
        .clone()
        .find(|m| name_of(&m.observable, &problem.models[m.model]) == name);
    let only = || {
        let mut of_scene = of_name.clone().filter(|m| scene(m.model));
        of_scene.next().filter(|_| of_scene.next().is_none())
    };
    let found = exact.or_else(only)?;
    Some((found.observable.clone(), found.model))
}

/// Puts the published values beside what was found.
pub(crate) fn compare(
    entries: &[CompareEntry],
    problem: &CalibrationProblem,
    found: &Calibration,
) -> Vec<ComparedValue> {
    let one = |entry: &CompareEntry| {
        let value = resolve(&entry.result, problem)
            .ok()
            .and_then(|name| value_of(&name, problem, found));
        ComparedValue {
            result: entry.result.clone(),
            published: entry.value,
            published_sd: entry.sd,
            source: entry.source.clone(),
            found: value.map(|v| v.0),
            se: value.and_then(|v| v.1),
            difference: value.map(|v| v.0 - entry.value),
        }
    };
    entries.iter().map(one).collect()
}

/// A result with its standard error.
fn value_of(
    name: &ResultName,
    problem: &CalibrationProblem,
    found: &Calibration,
) -> Option<(f64, Option<f64>)> {
    match name {
        ResultName::Parameter(symbol) => {
            let estimate = found.parameters.iter().find(|p| p.symbol == *symbol)?;
            Some((estimate.value, estimate.se))
        }
        ResultName::Observable { observable, model } => {
            let model = &problem.models[*model];
            let same = |c: &&Comparison| {
                let condition: &BTreeMap<String, String> = &c.condition;
                c.scene == model.scene
                    && *condition == model.condition
                    && c.observable == *observable
            };
            let mut all = found.fit.iter().chain(&found.check).chain(&found.show);
            let simulated = all.find(same)?.simulated;
            Some((simulated.mean, Some(simulated.se)))
        }
        ResultName::Effect {
            symbol,
            observable,
            model,
        } => {
            let model = &problem.models[*model].name;
            let screening = found.screening.iter().find(|s| s.model == *model)?;
            let factors = &screening.screenings.get(observable)?.factors;
            let factor = factors.iter().find(|f| f.factor == *symbol)?;
            Some((factor.effect, None))
        }
    }
}
