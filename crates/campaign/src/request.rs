//! Request and result of a run.

use crate::run_store::Observation;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt;

use crate::SimulatorError;

/// One run: everything that its result may depend on, besides the version of the simulator.
///
/// Units are those that the simulator states for its names.
///
/// ```
/// use campaign::RunRequest;
/// let run = RunRequest::new("drum", 1)
///     .with_condition("rpm", 20.0)
///     .with_parameter("static_friction", 0.4);
/// // The seed is not among the inputs: repeats of a run have the same ones.
/// assert_eq!(run.inputs(), run.clone().with_seed(2).inputs());
/// assert_eq!(run.to_string(), "drum rpm=20 static_friction=0.4 seed=1");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRequest {
    /// Name of the simulated model, such as a scene or a profile.
    pub model: String,
    /// Declared parameters by name; the simulator's own value if one is absent.
    pub parameters: BTreeMap<String, f64>,
    /// Conditions of the experiment by name, such as speed or filling.
    pub condition: BTreeMap<String, f64>,
    /// Amplitudes of effects by name; absent or 0 is off.
    pub effects: BTreeMap<String, f64>,
    /// Seed of all randomness of the run.
    pub seed: u64,
}

impl RunRequest {
    /// Requests a run of a model with nothing changed.
    pub fn new(model: &str, seed: u64) -> Self {
        Self {
            model: model.to_owned(),
            parameters: BTreeMap::new(),
            condition: BTreeMap::new(),
            effects: BTreeMap::new(),
            seed,
        }
    }

    /// Sets a declared parameter.
    #[must_use]
    pub fn with_parameter(mut self, name: &str, value: f64) -> Self {
        self.parameters.insert(name.to_owned(), value);
        self
    }

    /// Sets a condition of the experiment.
    #[must_use]
    pub fn with_condition(mut self, name: &str, value: f64) -> Self {
        self.condition.insert(name.to_owned(), value);
        self
    }

    /// Sets the amplitude of an effect; 0 switches it off.
    #[must_use]
    pub fn with_effect(mut self, name: &str, amplitude: f64) -> Self {
        self.effects.insert(name.to_owned(), amplitude);
        self
    }

    /// Sets the seed.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Gives a declared parameter that the simulator needs.
    ///
    /// # Errors
    ///
    /// [`SimulatorError::Refused`] when the request does not have it.
    pub fn parameter(&self, name: &str) -> Result<f64, SimulatorError> {
        needed(&self.parameters, "parameter", name)
    }

    /// Gives a condition that the simulator needs.
    ///
    /// # Errors
    ///
    /// [`SimulatorError::Refused`] when the request does not have it.
    pub fn condition(&self, name: &str) -> Result<f64, SimulatorError> {
        needed(&self.condition, "condition", name)
    }

    /// Gives the amplitude of an effect, 0 if it is off.
    pub fn effect(&self, name: &str) -> f64 {
        self.effects.get(name).copied().unwrap_or(0.0)
    }

    /// The same run without effects of amplitude 0, so that it has one key.
    pub(crate) fn normalised(&self) -> Self {
        let mut request = self.clone();
        request.effects.retain(|_, amplitude| *amplitude != 0.0);
        request
    }

    /// Everything of the request but its seed, as JSON: the content of the key of its run, besides version
    /// and seed, unless the simulator defines its own ([`crate::Simulator::prepare`]).
    pub fn inputs(&self) -> Value {
        serde_json::json!({
            "model": self.model,
            "parameters": self.parameters,
            "condition": self.condition,
            "effects": self.effects,
        })
    }
}

impl fmt::Display for RunRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.model)?;
        for (name, value) in self
            .condition
            .iter()
            .chain(&self.parameters)
            .chain(&self.effects)
        {
            write!(f, " {name}={value}")?;
        }
        write!(f, " seed={}", self.seed)
    }
}

/// Result of a run.
///
/// ```
/// use campaign::{RunOutcome, run_store::Observation};
/// let angle = Observation { mean: 36.4, sd: Some(0.6), n: 12, unit: "deg".into() };
/// let outcome = RunOutcome::default().with_observable("angle_deg", angle);
/// assert_eq!(outcome.observables["angle_deg"].n, 12);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunOutcome {
    /// Results by name.
    pub observables: BTreeMap<String, Observation>,
    /// Class of the run, such as `rolling`, which a smooth surface must not mix; `None` if
    /// the simulator has no classes.
    pub regime: Option<String>,
    /// Further data to keep (timing, series); null if there are none.
    pub details: Value,
}

impl RunOutcome {
    /// Adds a result.
    #[must_use]
    pub fn with_observable(mut self, name: &str, result: Observation) -> Self {
        self.observables.insert(name.to_owned(), result);
        self
    }
}

/// Looks up a required value.
fn needed(
    values: &BTreeMap<String, f64>,
    kind: &'static str,
    name: &str,
) -> Result<f64, SimulatorError> {
    values
        .get(name)
        .copied()
        .ok_or_else(|| SimulatorError::Refused {
            reason: format!("{kind} '{name}' is missing; set it in the request"),
        })
}
