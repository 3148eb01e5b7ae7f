//! Parameters from which a diagnosis starts.

use crate::{Error, Study};
use simulators::scene_simulator::ParameterFile;
use std::collections::BTreeMap;
use std::path::Path;

/// The part of a `result.json` that is read.
#[derive(serde::Deserialize)]
struct ResultFile {
    parameters: Vec<Found>,
    #[serde(default)]
    inputs: Vec<Found>,
}

/// A parameter of a `result.json`.
#[derive(serde::Deserialize)]
struct Found {
    symbol: String,
    unit: String,
    /// Estimate.
    value: f64,
}

impl Study {
    /// The values in use before any calibration, in the order of the parameters.
    pub fn start_values(&self) -> Vec<f64> {
        self.problem.start()
    }

    /// The values of a `result.json` or a `parameters.toml`, in the order of the parameters; inputs that it lacks as they were stated.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, or that lacks a parameter, has it in another unit, or beyond its limits.
    pub fn values_from(&self, file: &Path) -> Result<Vec<f64>, Error> {
        let is_json = file
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("json"));
        let found = if is_json {
            of_result(file)?
        } else {
            of_parameters(file)?
        };
        let wrong = |problem: String| Error::Start {
            file: file.display().to_string(),
            problem,
        };
        let one = |p: &inference::Parameter| {
            let Some((unit, value)) = found.get(&p.symbol) else {
                if p.is_input {
                    return Ok(p.start);
                }
                let known: Vec<&str> = found.keys().map(String::as_str).collect();
                return Err(wrong(format!(
                    "parameter {} is missing; the file has {}",
                    p.symbol,
                    known.join(", ")
                )));
            };
            let [low, high] = p.limits;
            if *unit != p.unit {
                return Err(wrong(format!(
                    "parameter {} is in '{unit}', and in '{}' in the study: use one unit",
                    p.symbol, p.unit
                )));
            }
            if !(low..=high).contains(value) {
                return Err(wrong(format!(
                    "parameter {} = {value} lies outside its limits {low} to {high}: widen them in the study",
                    p.symbol
                )));
            }
            Ok(*value)
        };
        self.problem.parameters.iter().map(one).collect()
    }
}

/// Unit and value by symbol.
type Values = BTreeMap<String, (String, f64)>;

/// Those of a `result.json`.
fn of_result(file: &Path) -> Result<Values, Error> {
    let bytes = input::file::read(file).map_err(|source| Error::Read {
        path: file.to_owned(),
        source,
    })?;
    let wrong = |problem: String| Error::Start {
        file: file.display().to_string(),
        problem,
    };
    let value = campaign::run_store::unseal(&bytes).map_err(|why| {
        wrong(format!(
            "is not the result that a calibration wrote: {why}; give its parameters.toml, or calibrate again with --resume, \
             which repeats no run"
        ))
    })?;
    let result: ResultFile = serde_json::from_value(value)
        .map_err(|why| wrong(format!("is not the result of a calibration: {why}")))?;
    let all = result.parameters.into_iter().chain(result.inputs);
    Ok(all.map(|p| (p.symbol, (p.unit, p.value))).collect())
}

/// Those of a `parameters.toml`.
fn of_parameters(file: &Path) -> Result<Values, Error> {
    let all = ParameterFile::read(file)?.parameter.into_iter();
    let unit = |unit: Option<String>| unit.unwrap_or_else(|| "1".into());
    Ok(all.map(|p| (p.symbol, (unit(p.unit), p.value))).collect())
}
