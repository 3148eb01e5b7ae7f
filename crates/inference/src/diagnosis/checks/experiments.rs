//! Checks of experiments that could be done next.

use super::entries::{check_finite, check_length, check_positive, matrix, symmetric};
use crate::diagnosis::Error;
use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::problem::{Experiment, RunNoise, condition_label};
use crate::diagnosis::problem_file::{ExperimentFile, SensitivityRuns};

/// Checks an experiment that could be done next.
pub(super) fn experiment(
    raw: &ExperimentFile,
    n_declared: usize,
    library: &[String],
) -> Result<Experiment, Error> {
    let name = raw
        .name
        .clone()
        .unwrap_or_else(|| condition_label(&raw.condition));
    let rows = raw.covariance.len();
    let key = |part: &str| format!("candidate_experiments '{name}' {part}");
    let block = symmetric(&raw.covariance, &key("covariance"), rows)?;
    let covariance = Covariance::new(vec![block], vec![name.clone()]);
    covariance.whitener()?;
    check_positive(raw.cost, &key("cost"))?;
    let reason = "the rows of its covariance";
    let number = |effect: &String| {
        let at = library.iter().position(|known| known == effect);
        at.ok_or_else(|| Error::BadName {
            name: effect.clone(),
            place: "candidate_experiments effects",
            problem: "is not an effect of the library",
        })
    };
    let effects = raw.effects.as_ref().map(|names| {
        let numbers = names.iter().map(number);
        numbers.collect::<Result<Vec<_>, Error>>()
    });
    let runs = raw.runs.as_ref();
    let runs = runs.map(|runs| run_noise(runs, (rows, n_declared, library.len()), &key));
    Ok(Experiment {
        declared: matrix(
            &raw.sensitivities_declared,
            &key("sensitivities_declared"),
            (rows, n_declared),
            reason,
        )?,
        library: matrix(
            &raw.sensitivities_library,
            &key("sensitivities_library"),
            (rows, library.len()),
            reason,
        )?,
        effects: effects.transpose()?,
        runs: runs.transpose()?,
        cost: raw.cost,
        covariance,
        name,
    })
}

/// Checks the runs behind the sensitivities of an experiment with so many rows, parameters and effects.
fn run_noise(
    raw: &SensitivityRuns,
    (rows, n_declared, n_library): (usize, usize, usize),
    key: &impl Fn(&str) -> String,
) -> Result<RunNoise, Error> {
    let covariance = key("runs covariance_of_mean");
    let of_mean = symmetric(&raw.covariance_of_mean, &covariance, rows)?;
    let declared = key("runs steps_declared");
    let (steps, n) = (&raw.steps_declared, n_declared);
    check_length(&declared, steps.len(), n, "one per parameter")?;
    let library = key("runs steps_library");
    let (amplitudes, n) = (&raw.steps_library, n_library);
    check_length(&library, amplitudes.len(), n, "one per effect")?;
    let all = steps.iter().chain(amplitudes);
    let inverse = |step: &Option<f64>| {
        let inverse = step.map_or(0.0, f64::recip);
        check_finite(inverse, || key("runs: one over a step"))?;
        Ok(inverse)
    };
    Ok(RunNoise {
        of_mean,
        inverse_steps: all.map(inverse).collect::<Result<_, Error>>()?,
    })
}
