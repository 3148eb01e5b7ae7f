//! A simulator in closed form, problems about it, and the loop over both.

use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use inference::{
    Calibration, CalibrationProblem, Error, LoopSettings, Measurement, Model, Parameter, Role,
    calibrate,
};
use probability::random_stream::Stream;
use std::collections::BTreeMap;

/// What a run shows without noise: values by name, and how it ended up; or why it failed.
pub(crate) type Law = fn(&str, &dyn Fn(&str) -> f64) -> Result<Shown, String>;

/// What a run shows.
pub(crate) struct Shown {
    pub(crate) values: Vec<(&'static str, f64)>,
    pub(crate) regime: &'static str,
}

/// One value without a regime, as a law gives it.
#[expect(clippy::unnecessary_wraps, reason = "it is what a law returns")]
pub(crate) fn shown(name: &'static str, value: f64) -> Result<Shown, String> {
    Ok(Shown {
        values: vec![(name, value)],
        regime: "",
    })
}

/// A law with noise.
pub(crate) struct Toy {
    pub(crate) law: Law,
    /// Standard deviation of each value of a run.
    pub(crate) noise: f64,
}

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        // A law may ask for the seed too: what ends up in one state or the other by chance depends on it.
        let parameter = |name: &str| match name {
            "seed" => request.seed as f64,
            _ => request.parameters.get(name).copied().unwrap_or(0.0),
        };
        let shown = (self.law)(&request.model, &parameter)
            .map_err(|reason| SimulatorError::Failed { reason })?;
        let mut stream = Stream::new(request.seed, &format!("noise of {request}"));
        let mut outcome = RunOutcome::default();
        for (name, value) in shown.values {
            let observation = Observation::of_one(value + self.noise * stream.normal(), "1");
            outcome = outcome.with_observable(name, observation);
        }
        if !shown.regime.is_empty() {
            outcome.regime = Some(shown.regime.to_owned());
        }
        Ok(outcome)
    }
}

/// A parameter with limits as wide as its range.
pub(crate) fn parameter(symbol: &str, range: [f64; 2]) -> Parameter {
    Parameter {
        name: format!("parameter {symbol}"),
        sets: vec![symbol.into()],
        ..Parameter::new(symbol, range)
    }
}

/// A model that depends on parameters by number.
pub(crate) fn model(name: &str, parameters: &[usize]) -> Model {
    Model {
        name: name.into(),
        scene: name.into(),
        condition: BTreeMap::new(),
        parameters: parameters.to_vec(),
    }
}

/// A measured mean of ten values.
pub(crate) fn measured(
    model: usize,
    observable: &str,
    role: Role,
    (mean, sd): (f64, f64),
) -> Measurement {
    Measurement {
        model,
        observable: observable.into(),
        role,
        mean,
        sd,
        n: 10.0,
        is_scatter: false,
    }
}

/// A problem without effects.
pub(crate) fn problem(
    parameters: Vec<Parameter>,
    models: Vec<Model>,
    measurements: Vec<Measurement>,
) -> CalibrationProblem {
    CalibrationProblem {
        id: "toy".into(),
        parameters,
        models,
        measurements,
        ..CalibrationProblem::default()
    }
}

/// A problem of parameters from 0 to 1, one letter each, on which every model depends, with one measured y of each model.
pub(crate) fn of_y(symbols: &str, rows: &[(&str, Role, (f64, f64))]) -> CalibrationProblem {
    let symbols: Vec<String> = symbols.chars().map(String::from).collect();
    let all: Vec<usize> = (0..symbols.len()).collect();
    let each = rows.iter().enumerate();
    problem(
        symbols.iter().map(|s| parameter(s, [0.0, 1.0])).collect(),
        rows.iter().map(|(name, ..)| model(name, &all)).collect(),
        each.map(|(i, (_, role, y))| measured(i, "y", *role, *y))
            .collect(),
    )
}

/// The loop with the usual settings.
pub(crate) fn run(toy: &Toy, problem: &CalibrationProblem) -> Result<Calibration, Error> {
    run_with(toy, problem, &LoopSettings::default())
}

/// The settings of one of many drawn studies: its runs share no seed with those of another.
pub(crate) fn settings_of(study: u64) -> LoopSettings {
    LoopSettings {
        seed: 10_000_000 * (study + 1),
        before_runs: 0,
        ..LoopSettings::default()
    }
}

/// The loop in a store of its own.
pub(crate) fn run_with(
    toy: &Toy,
    problem: &CalibrationProblem,
    settings: &LoopSettings,
) -> Result<Calibration, Error> {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 1, &Silent);
    calibrate(&campaign, toy, problem, settings, &|_| {})
}

/// Value of a parameter in a result.
pub(crate) fn value(result: &Calibration, symbol: &str) -> f64 {
    let found = result.parameters.iter().find(|p| p.symbol == symbol);
    found.expect("a parameter of the problem").value
}
