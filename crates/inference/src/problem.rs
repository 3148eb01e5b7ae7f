//! What a calibration is asked: parameters, models and measurements.

use crate::correlated::check_correlations;
use crate::{EffectProbe, Error, Measurement, Role};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A quantity of the simulator that may be tuned.
///
/// ```
/// use inference::{Parameter, Prior};
/// let friction = Parameter {
///     name: "static friction seed-steel".into(),
///     limits: [0.0, 1.0],
///     prior: Some(Prior { mean: 0.32, sd: 0.05 }),
///     ..Parameter::new("B", [0.2, 0.6])
/// };
/// assert!((friction.start - 0.4).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Short name; also the name in [`campaign::RunRequest::parameters`].
    pub symbol: String,
    /// Description for the reader.
    pub name: String,
    /// Unit of all values below; `1` where dimensionless.
    pub unit: String,
    /// Settings of the simulator that it represents, for the reader; one number sets all of them.
    pub sets: Vec<String>,
    /// Lower and upper end of the box in which the search begins.
    pub range: [f64; 2],
    /// Lowest and highest value that is physically possible; the search never leaves them.
    pub limits: [f64; 2],
    /// The value in use before the calibration.
    pub start: f64,
    /// Knowledge that is not among the measurements.
    pub prior: Option<Prior>,
    /// Whether it is an input of the simulator that somebody weighed, counted or measured, and not tuned: its prior is what it was
    /// stated to be, with the error. The loop lets it move within that error, since a wrong input moves every estimate.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_input: bool,
}

/// A normal prior of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// Mean, unit of the parameter.
    pub mean: f64,
    /// Standard deviation, unit of the parameter.
    pub sd: f64,
}

/// One experiment as the simulator knows it: a scene under one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Name in [`campaign::RunRequest::model`].
    pub name: String,
    /// Name of the scene, for the reader.
    pub scene: String,
    /// Settings that distinguish it from other models of the scene, for the reader.
    pub condition: BTreeMap<String, String>,
    /// Numbers of the parameters on which its runs depend, in rising order.
    pub parameters: Vec<usize>,
}

/// The correlation of two measured means that were read from the same frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// Number of the one measurement.
    pub a: usize,
    /// Number of the other, of the same model and role.
    pub b: usize,
    /// The correlation, between -1 and 1.
    pub value: f64,
}

/// A measurement that could be made next, to answer what a fit or a diagnosis leaves open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// The experiment; none of [`CalibrationProblem::models`].
    pub model: Model,
    /// Standard error that the mean of each of its observables would have, in its unit.
    pub standard_errors: BTreeMap<String, f64>,
    /// Number of repeats of which these are the means.
    #[serde(default = "one")]
    pub repeats: f64,
    /// Work in the laboratory, min.
    pub minutes: f64,
    /// Whether nobody named it: it follows from the conditions that are measured, and is run for a diagnosis alone.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_suggested: bool,
}

/// A single one.
fn one() -> f64 {
    1.0
}

/// Everything that a calibration needs besides a simulator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CalibrationProblem {
    /// Name.
    pub id: String,
    /// Parameters to be tuned, 1 to 12, followed by at most 12 [inputs](Parameter::is_input) that have an error.
    pub parameters: Vec<Parameter>,
    /// The experiments.
    pub models: Vec<Model>,
    /// The measurements, in the order of the file.
    pub measurements: Vec<Measurement>,
    /// Which measured means are correlated; all others are independent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<Correlation>,
    /// Effects to search in the residual; `None` if nothing is to be diagnosed.
    pub effects: Vec<EffectProbe>,
    /// Measurements that could be made next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<Candidate>,
    /// Models whose runs have coarser grains than the real ones; none if all grains have their real size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coarse_graining: Option<CoarseGraining>,
}

/// Runs of some models are made with grains that are so many times coarser than the real ones. A trend with the size, straight in the
/// diameter, is part of each of their surfaces and carries everything to the real size, where the factor is 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoarseGraining {
    /// Numbers of the models, in rising order.
    pub models: Vec<usize>,
    /// Diameter of the grains over the real one, two or more different ones above 1, the coarsest first.
    pub factors: Vec<f64>,
    /// Largest standard error that carrying a mean from the finest grains to the real size may have, in standard errors of what
    /// was measured.
    pub error: f64,
}

impl CoarseGraining {
    /// Name of the factor in [`campaign::RunRequest::parameters`].
    pub const SYMBOL: &str = "coarse_graining";

    /// Refuses factors that show no trend.
    fn check(&self, problem: &CalibrationProblem, wrong: &mut Vec<String>) {
        let factors = &self.factors;
        if let Some(factor) = factors.iter().find(|f| !(f.is_finite() && **f > 1.0)) {
            wrong.push(format!(
                "coarse graining: the factor {factor} must be above 1, how many times coarser than the real grains those of the runs are"
            ));
        } else if factors.windows(2).any(|pair| pair[0] <= pair[1]) {
            wrong.push(format!(
                "coarse graining: the factors {factors:?} must differ, the largest first"
            ));
        } else if factors.len() < 2 {
            wrong.push(format!(
                "coarse graining: {} factors: a trend needs two or more",
                factors.len()
            ));
        }
        if !(self.error.is_finite() && self.error > 0.0) {
            wrong.push(format!(
                "coarse graining: the largest error {} must be above 0, in standard errors of what was measured",
                self.error
            ));
        }
        if !problem.effects.is_empty() {
            wrong.push(
                "coarse graining: the diagnosis does not carry its runs to the real size: set search = [] in [effects]".into(),
            );
        }
        if self.models.iter().any(|k| *k >= problem.models.len()) {
            wrong.push("coarse graining: there is no such model".into());
        }
        if problem.parameters.iter().any(|p| p.symbol == Self::SYMBOL) {
            wrong.push(format!(
                "parameter {}: the symbol is that of the coarse graining: choose another",
                Self::SYMBOL
            ));
        }
    }
}

/// Most parameters of a calibration.
pub const MOST_PARAMETERS: usize = 12;

impl CalibrationProblem {
    /// The same with nothing that could be measured next.
    #[must_use]
    pub fn without_candidates(&self) -> Self {
        Self {
            candidates: Vec::new(),
            ..self.clone()
        }
    }

    /// The values in use before, in the order of the parameters.
    pub fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.start).collect()
    }

    /// The parameters that are tuned.
    pub fn tuned(&self) -> &[Parameter] {
        &self.parameters[..self.n_tuned()]
    }

    /// Number of the parameters that are tuned; those behind them are inputs.
    pub fn n_tuned(&self) -> usize {
        self.parameters.iter().filter(|p| !p.is_input).count()
    }

    pub(crate) fn tuned_of(&self, model: usize) -> Vec<usize> {
        let all = self.models[model].parameters.iter().copied();
        all.filter(|&j| !self.parameters[j].is_input).collect()
    }

    pub(crate) fn inputs_of(&self, model: usize) -> Vec<usize> {
        let all = self.models[model].parameters.iter().copied();
        all.filter(|&j| self.parameters[j].is_input).collect()
    }

    /// Symbols of some parameters.
    pub(crate) fn symbols(&self, parameters: &[usize]) -> Vec<String> {
        let symbol = |&j: &usize| self.parameters[j].symbol.clone();
        parameters.iter().map(symbol).collect()
    }

    /// How many times coarser than the real ones the grains of a model are in its runs, the coarsest first: 1 alone if they are not.
    pub(crate) fn factors_of(&self, model: usize) -> &[f64] {
        match &self.coarse_graining {
            Some(coarse) if coarse.models.contains(&model) => &coarse.factors,
            _ => &[1.0],
        }
    }

    /// The coarsest grains of the runs of a model, over the real ones.
    pub(crate) fn coarsest_of(&self, model: usize) -> f64 {
        self.factors_of(model)[0]
    }

    /// The finest grains of the runs of a model, over the real ones.
    pub(crate) fn finest_of(&self, model: usize) -> f64 {
        self.factors_of(model).last().copied().unwrap_or(1.0)
    }

    /// Numbers of the measurements of a role.
    pub fn measurements_of(&self, role: Role) -> Vec<usize> {
        let all = self.measurements.iter().enumerate();
        all.filter_map(|(i, m)| (m.role == role).then_some(i))
            .collect()
    }

    /// Numbers of the models that have a measurement of a role, in rising order.
    pub fn models_of(&self, role: Role) -> Vec<usize> {
        let has = |k: &usize| {
            let mut all = self.measurements.iter();
            all.any(|m| m.model == *k && m.role == role)
        };
        (0..self.models.len()).filter(has).collect()
    }

    /// Refuses numbers that do not fit together, all of them at once.
    ///
    /// # Errors
    ///
    /// [`Error::Problem`] with one line for each.
    pub fn check(&self) -> Result<(), Error> {
        let mut wrong = Vec::new();
        self.check_counts(&mut wrong);
        for parameter in &self.parameters {
            parameter.check(&mut wrong);
        }
        if let Some(coarse) = &self.coarse_graining {
            coarse.check(self, &mut wrong);
        }
        for m in &self.measurements {
            let at = self.models.get(m.model).map_or("?", |model| &model.name);
            if !(m.mean.is_finite() && m.sd.is_finite() && m.sd > 0.0 && m.n >= 1.0) {
                wrong.push(format!(
                    "measured {} of {at}: mean {}, sd {}, n {}: a finite mean, an sd above 0 and n of 1 or more are \
                     needed",
                    m.observable, m.mean, m.sd, m.n
                ));
            }
        }
        // Numbers of measurements that are not there, and means without a variance, have no correlation to check.
        if wrong.is_empty() {
            check_correlations(self, &mut wrong);
        }
        if wrong.is_empty() {
            Ok(())
        } else {
            Err(Error::Problem { lines: wrong })
        }
    }

    /// Refuses numbers of things that are invalid.
    fn check_counts(&self, wrong: &mut Vec<String>) {
        let n = self.n_tuned();
        let n_inputs = self.parameters.len() - n;
        if !(1..=MOST_PARAMETERS).contains(&n) || n_inputs > MOST_PARAMETERS {
            wrong.push(format!(
                "{n} parameters and {n_inputs} inputs: 1 to {MOST_PARAMETERS} can be calibrated, beside {MOST_PARAMETERS} inputs at \
                 most"
            ));
        }
        if self.tuned().iter().any(|p| p.is_input) {
            wrong.push("inputs must stand behind the parameters that are tuned".into());
        }
        if self.measurements_of(Role::Fit).is_empty() {
            wrong.push("no measurement has the role fit: an estimate needs one".into());
        }
        for (j, parameter) in self.parameters.iter().enumerate() {
            let fit_models = self.models_of(Role::Fit);
            let acts = |k: &usize| self.models[*k].parameters.contains(&j);
            if !fit_models.iter().any(acts) && parameter.prior.is_none() {
                wrong.push(format!(
                    "parameter {}: no measurement of role fit depends on it, and it has no prior: nothing can fix it",
                    parameter.symbol
                ));
            }
            let twice = |other: &Parameter| other.symbol == parameter.symbol;
            if self.parameters[..j].iter().any(twice) {
                wrong.push(format!(
                    "parameter {}: duplicate symbol; rename one",
                    parameter.symbol
                ));
            }
        }
        for (i, m) in self.measurements.iter().enumerate() {
            let same = |o: &Measurement| o.model == m.model && o.observable == m.observable;
            if m.model >= self.models.len() {
                wrong.push(format!("measurement {i}: there is no model {}", m.model));
            } else if let Some(other) = self.measurements[..i].iter().find(|o| same(o)) {
                let roles = if other.role == m.role {
                    "twice"
                } else {
                    "in two roles"
                };
                wrong.push(format!(
                    "measured {} of {} is given {roles}: give each measurement once",
                    m.observable, self.models[m.model].name
                ));
            }
        }
    }
}

impl Parameter {
    /// A tuned number without a unit: its limits are its range, it starts in the middle, and it has no prior.
    pub fn new(symbol: &str, range: [f64; 2]) -> Self {
        Self {
            symbol: symbol.to_owned(),
            name: String::new(),
            unit: "1".to_owned(),
            sets: Vec::new(),
            range,
            limits: range,
            start: 0.5 * (range[0] + range[1]),
            prior: None,
            is_input: false,
        }
    }

    /// Refuses values that are out of order.
    fn check(&self, wrong: &mut Vec<String>) {
        let [low, high] = self.range;
        let [least, most] = self.limits;
        let finite = [low, high, least, most, self.start]
            .iter()
            .all(|x| x.is_finite());
        if !(finite && least <= low && low < high && high <= most) {
            wrong.push(format!(
                "parameter {}: low {low} and high {high} must rise and lie within the limits {least} to {most}",
                self.symbol
            ));
        }
        if finite && !(least..=most).contains(&self.start) {
            wrong.push(format!(
                "parameter {}: the start {} lies outside its limits {least} to {most}",
                self.symbol, self.start
            ));
        }
        if self.is_input && self.prior.is_none_or(|prior| prior.mean != self.start) {
            wrong.push(format!(
                "input {}: its prior must have the value in use, {}, as its mean",
                self.symbol, self.start
            ));
        }
        if let Some(Prior { mean, sd }) = self.prior
            && !(mean.is_finite() && sd.is_finite() && sd > 0.0)
        {
            wrong.push(format!(
                "parameter {}: the prior {mean} +- {sd} needs a finite mean and an sd above 0",
                self.symbol
            ));
        }
    }
}
