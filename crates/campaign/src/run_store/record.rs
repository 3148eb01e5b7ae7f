//! Record of a finished run.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

use crate::run_store::{Error, SCHEMA, run_key};

/// One observable of a run: a mean over frames or repeats.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Observation {
    /// Mean, in `unit`.
    pub mean: f64,
    /// Standard deviation of one of the n values, in `unit`; `None` if n is 1.
    pub sd: Option<f64>,
    /// Number of values in the mean.
    pub n: usize,
    /// Unit of mean and standard deviation, such as `deg`; `1` for a pure number.
    pub unit: String,
}

impl Observation {
    /// A single value.
    pub fn of_one(mean: f64, unit: &str) -> Self {
        Self {
            mean,
            sd: None,
            n: 1,
            unit: unit.to_owned(),
        }
    }
}

/// A finished run: everything that it depended on, and its results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Form of the record, see [`SCHEMA`].
    pub(crate) schema: u32,
    /// Content key of version, inputs and seed.
    pub(crate) key: String,
    /// Version of the code that ran.
    pub(crate) version: String,
    /// Seed of the run.
    pub(crate) seed: u64,
    /// Everything else that the run depended on.
    pub(crate) inputs: Value,
    /// Results by name.
    pub(crate) observables: BTreeMap<String, Observation>,
    /// Class of the run, which a smooth surface must not mix; `None` if it has none.
    pub(crate) regime: Option<String>,
    /// Further data (timing, series); not part of the key, null if empty.
    pub(crate) details: Value,
}

impl Record {
    /// Starts the record of a run, without results yet.
    ///
    /// # Errors
    ///
    /// [`Error::NullInput`] when the inputs hold a null (a NaN, an infinity or a gap).
    pub fn new(version: &str, inputs: Value, seed: u64) -> Result<Self, Error> {
        Ok(Self {
            schema: SCHEMA,
            key: run_key(version, &inputs, seed)?,
            version: version.to_owned(),
            seed,
            inputs,
            observables: BTreeMap::new(),
            regime: None,
            details: Value::Null,
        })
    }

    /// Adds a result.
    ///
    /// # Errors
    ///
    /// [`Error::BadObservation`] when the mean or the standard deviation is not finite, or the
    /// latter below 0.
    pub fn with_observable(mut self, name: &str, result: Observation) -> Result<Self, Error> {
        check_observation(name, &result)?;
        self.observables.insert(name.to_owned(), result);
        Ok(self)
    }

    /// Adds all results of a run.
    ///
    /// # Errors
    ///
    /// As [`Record::with_observable`].
    pub fn with_observables(
        mut self,
        results: BTreeMap<String, Observation>,
    ) -> Result<Self, Error> {
        for (name, result) in results {
            self = self.with_observable(&name, result)?;
        }
        Ok(self)
    }

    /// Sets the class of the run, such as `rolling`; it is not part of the key.
    #[must_use]
    pub fn with_regime(mut self, regime: Option<String>) -> Self {
        self.regime = regime;
        self
    }

    /// Adds further data; they are not part of the key.
    #[must_use]
    pub fn with_details(mut self, details: Value) -> Self {
        self.details = details;
        self
    }

    /// Content key: 64 hexadecimal digits.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Version of the code that ran.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Seed of the run.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Everything else that the run depended on.
    pub fn inputs(&self) -> &Value {
        &self.inputs
    }

    /// Results by name.
    pub fn observables(&self) -> &BTreeMap<String, Observation> {
        &self.observables
    }

    /// The result of that name.
    pub fn observable(&self, name: &str) -> Option<&Observation> {
        self.observables.get(name)
    }

    /// Class of the run, such as `rolling`: a smooth surface must not mix runs of
    /// different classes. `None` if the simulator has no classes.
    pub fn regime(&self) -> Option<&str> {
        self.regime.as_deref()
    }

    /// Further data (timing, series); null if there are none.
    pub fn details(&self) -> &Value {
        &self.details
    }
}

/// Refuses numbers that are not finite.
fn check_observation(name: &str, result: &Observation) -> Result<(), Error> {
    let bad = |field, value| Error::BadObservation {
        name: name.to_owned(),
        field,
        value,
    };
    if !result.mean.is_finite() {
        return Err(bad("mean", result.mean));
    }
    match result.sd {
        Some(sd) if !sd.is_finite() || sd < 0.0 => Err(bad("sd", sd)),
        _ => Ok(()),
    }
}
