//! What a calibration is asked: parameters, models and measurements.

use crate::correlated::check_correlations;
use crate::{EffectProbe, Error};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A quantity of the simulator that may be tuned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Short name; also the name in [`campaign::RunRequest::parameters`].
    pub symbol: String,
    /// What it is, in words.
    pub name: String,
    /// Unit of all values below; `1` where dimensionless.
    pub unit: String,
    /// What it stands for in the simulator, for the reader; one number sets all of them.
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
    /// What distinguishes it from other models of the scene, by setting, for the reader.
    pub condition: BTreeMap<String, String>,
    /// Numbers of the parameters on which its runs depend, in rising order.
    pub parameters: Vec<usize>,
}

/// What a measurement serves for; decided before anyone looks at a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The estimate may use it.
    Fit,
    /// No fit and no choice sees it; the estimate is judged by it.
    Check,
    /// Simulated at the estimate and printed beside the measurement; nothing is judged by it.
    Show,
}

/// A measured mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Number of the model.
    pub model: usize,
    /// Name of the observable.
    pub observable: String,
    /// What it serves for.
    pub role: Role,
    /// Mean, in the unit of the observable.
    pub mean: f64,
    /// Standard deviation of the single values.
    pub sd: f64,
    /// Number of independent values; not whole where it is an effective number of correlated ones.
    pub n: f64,
}

impl Measurement {
    /// Variance of the mean: sd² / n.
    pub fn variance(&self) -> f64 {
        self.sd * self.sd / self.n
    }

    /// Degrees of freedom of that variance: n - 1; without end where a single value came with a standard deviation
    /// that is known otherwise.
    pub fn degrees_of_freedom(&self) -> f64 {
        if self.n > 1.0 {
            self.n - 1.0
        } else {
            f64::INFINITY
        }
    }
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

/// A measurement that could be made next, to answer what a diagnosis leaves open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// The experiment; none of [`CalibrationProblem::models`].
    pub model: Model,
    /// Standard error that the mean of each of its observables would have, in its unit.
    pub standard_errors: BTreeMap<String, f64>,
    /// Work in the laboratory, min.
    pub minutes: f64,
}

/// Everything that a calibration needs besides a simulator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibrationProblem {
    /// Name.
    pub id: String,
    /// What may be tuned, 1 to 12, and behind them the [inputs](Parameter::is_input) that have an error, 12 at most.
    pub parameters: Vec<Parameter>,
    /// The experiments.
    pub models: Vec<Model>,
    /// What was measured, in the order of the file.
    pub measurements: Vec<Measurement>,
    /// Which measured means are correlated; all others are independent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<Correlation>,
    /// Effects to search in the residual; none where nothing is to be diagnosed.
    pub effects: Vec<EffectProbe>,
    /// What could be measured next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<Candidate>,
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

    /// The parameters of a model that are tuned.
    pub(crate) fn tuned_of(&self, model: usize) -> Vec<usize> {
        let all = self.models[model].parameters.iter().copied();
        all.filter(|&j| !self.parameters[j].is_input).collect()
    }

    /// The inputs on which a model depends.
    pub(crate) fn inputs_of(&self, model: usize) -> Vec<usize> {
        let all = self.models[model].parameters.iter().copied();
        all.filter(|&j| self.parameters[j].is_input).collect()
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
                    "parameter {}: the symbol stands twice",
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
                    "measured {} of {} stands there {roles}: give each measurement once",
                    m.observable, self.models[m.model].name
                ));
            }
        }
    }
}

impl Parameter {
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
