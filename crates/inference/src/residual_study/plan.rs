//! A problem as its residual is studied: conditions with what was measured, parameters, effects.

use super::candidates::CandidateMeasurement;
use super::runs::{self, At, Means};
use crate::diagnosis::{CovarianceMatrix, Largest, Sign};
use crate::measurement::scatter_ratio;
use crate::{Error, Parameter};
use campaign::RunRequest;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A condition of the measurements.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyCondition {
    /// Name of the model that represents this condition, coordinates and all; that of [`ResidualPlan::base`] under the
    /// coordinates below where absent.
    pub model: Option<String>,
    /// Coordinates, as in [`RunRequest::condition`].
    pub condition: BTreeMap<String, f64>,
    /// What is read of its runs: pairs of a name in [`ResidualPlan::observables`] and the name that the run gives it;
    /// all of them under their own names where absent.
    pub observables: Option<BTreeMap<String, String>>,
    /// Declared parameters on which its runs depend, by name; all where absent. A run does not receive others: an input of one scene is
    /// none of another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameters: Option<BTreeSet<String>>,
    /// Whether the fit may use it; otherwise it is kept for the check.
    pub used: bool,
    /// Measured means, (observables); `None` for one that was not measured.
    #[serde(default)]
    pub values: Vec<Option<f64>>,
    /// Their covariance, (observables, observables); rows and columns of what was not measured are not read.
    #[serde(default)]
    pub covariance: CovarianceMatrix,
    /// Observables whose measured value is a standard deviation: their error is a share of the simulated value, see
    /// [`Measurement::variance_at`](crate::Measurement::variance_at), and `covariance` is that for the measured one.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub scatters: BTreeSet<String>,
}

impl StudyCondition {
    /// What the runs give under the name of an observable of the plan; `None` if it is not read here.
    pub fn name_of<'a>(&'a self, observable: &'a str) -> Option<&'a str> {
        match &self.observables {
            None => Some(observable),
            Some(names) => names.get(observable).map(String::as_str),
        }
    }

    /// Whether its runs depend on a declared parameter.
    pub(super) fn depends_on(&self, parameter: &str) -> bool {
        let own = self.parameters.as_ref();
        own.is_none_or(|own| own.contains(parameter))
    }

    /// Its name: that of its model, or of the model of a plan with the coordinates.
    pub(super) fn name(&self, of_plan: &str) -> String {
        let coordinates = self.condition.iter();
        self.model.clone().unwrap_or_else(|| {
            coordinates.fold(of_plan.to_owned(), |text, (name, x)| {
                format!("{text} {name}={x}")
            })
        })
    }
}

/// Step of a difference quotient, as a share of the range of a parameter.
const STEP: f64 = 0.3;

impl Parameter {
    /// Step of the difference quotient at its start, inside its limits.
    pub(super) fn step(&self) -> f64 {
        let size = STEP * (self.range[1] - self.range[0]);
        if self.start + size <= self.limits[1] {
            size
        } else {
            -size.min(self.start - self.limits[0])
        }
    }

    /// That step from another value, or back where that would leave the limits.
    pub(super) fn step_from(&self, at: f64) -> f64 {
        let (step, [least, most]) = (self.step(), self.limits);
        let is_inside = (least..=most).contains(&(at + step));
        if is_inside { step } else { -step }
    }
}

/// An effect of the library.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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

/// A [problem](crate::CalibrationProblem) about a point, as its residual is studied.
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
    /// Parameters, each with the value at which the simulator is linearised as its start.
    pub parameters: Vec<Parameter>,
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
    /// The plan with the errors of measured standard deviations as they are where these means are true; conditions without means
    /// keep theirs.
    pub(super) fn with_errors_at(&self, means: &Means) -> Self {
        let mut plan = self.clone();
        for (c, simulated) in plan.conditions.iter_mut().zip(&means.values) {
            for (k, name) in self.observables.iter().enumerate() {
                let (Some(value), Some(Some(measured))) = (simulated.get(k), c.values.get(k))
                else {
                    continue;
                };
                if c.scatters.contains(name) {
                    let factor = scatter_ratio(*value, *measured);
                    for row in &mut c.covariance {
                        row[k] *= factor;
                    }
                    c.covariance[k].iter_mut().for_each(|x| *x *= factor);
                }
            }
        }
        plan
    }

    /// Number of conditions that the fit uses, or that are kept for the check.
    pub fn count(&self, used: bool) -> usize {
        self.conditions.iter().filter(|c| c.used == used).count()
    }

    /// Number of measured values that the fit uses.
    pub(crate) fn values_of_fit(&self) -> usize {
        self.rows(At::Used).len()
    }

    /// Condition and observable of each value that was measured at the used or the kept conditions.
    pub(super) fn rows(&self, at: At) -> Vec<(usize, usize)> {
        let of = |c: usize| self.measured(c).into_iter().map(move |k| (c, k));
        runs::numbers(self, at).into_iter().flat_map(of).collect()
    }

    /// Numbers of the observables that were measured at a condition.
    pub fn measured(&self, condition: usize) -> Vec<usize> {
        let values = self.conditions[condition].values.iter().enumerate();
        values.filter_map(|(k, y)| y.map(|_| k)).collect()
    }

    /// Standard error of a measured mean, in its unit.
    pub fn standard_error(&self, condition: usize, observable: usize) -> f64 {
        self.conditions[condition].covariance[observable][observable].sqrt()
    }

    /// Refuses numbers that do not fit together.
    pub(super) fn check(&self) -> Result<(), Error> {
        let n = self.observables.len();
        let replicates = self.replicates;
        let mut counts = vec![
            ("observables", n, n > 0, "at least one"),
            ("replicates", replicates, replicates >= 2, "two or more"),
        ];
        for c in &self.conditions {
            let (values, rows) = (c.values.len(), c.covariance.len());
            let square = rows == n && c.covariance.iter().all(|row| row.len() == n);
            let each = "one for each observable";
            counts.push(("observed values", values, values == n, each));
            counts.push(("rows of a covariance", rows, square, each));
        }
        let wrong = counts.into_iter().find(|(.., fits, _)| !fits);
        wrong.map_or(Ok(()), |(what, got, _, expected)| {
            Err(Error::Count {
                what,
                got,
                expected,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::runs::Means;
    use super::{ResidualPlan, StudyCondition};
    use campaign::RunRequest;
    use std::collections::BTreeSet;

    /// A mean of 40 and a standard deviation of 0.5 with errors of 1 and 0.1 and a correlation of 0.3. Runs that show 41 and 1.0 double
    /// the error of the standard deviation, and with it the covariance of the two; a condition without runs keeps its errors.
    #[test]
    fn the_error_of_a_scatter_is_taken_at_the_simulated_one() {
        let condition = StudyCondition {
            used: true,
            values: vec![Some(40.0), Some(0.5)],
            covariance: vec![vec![1.0, 0.03], vec![0.03, 0.01]],
            scatters: BTreeSet::from(["fluctuation".to_owned()]),
            ..StudyCondition::default()
        };
        let plan = ResidualPlan {
            id: "drum".into(),
            base: RunRequest::new("drum", 1),
            conditions: vec![condition.clone(), condition],
            observables: vec!["angle".into(), "fluctuation".into()],
            parameters: Vec::new(),
            effects: Vec::new(),
            replicates: 2,
            seed: 1,
            candidates: Vec::new(),
        };
        let means = Means {
            values: vec![vec![41.0, 1.0], Vec::new()],
            ..Means::of(&[], 2)
        };
        let at = plan.with_errors_at(&means);
        assert_eq!(at.conditions[0].covariance, [[1.0, 0.06], [0.06, 0.04]]);
        assert_eq!(at.conditions[1], plan.conditions[1]);
    }
}
