//! Points to be run, and their results.

use crate::{CalibrationProblem, CoarseGraining, Error, LoopSettings};
use campaign::run_store::Record;
use campaign::{Campaign, RunRequest, Simulator};
use std::collections::BTreeMap;

/// Seeds that a stage may use: a stage has so many behind each other.
const SEEDS_OF_STAGE: u64 = 100_000;
/// Seeds that one model may use in a stage.
const SEEDS_OF_MODEL: u64 = 1_000;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) model: usize,
    /// Values of all parameters of the problem.
    pub(crate) at: Vec<f64>,
    /// Diameter of the grains over the real one.
    pub(crate) factor: f64,
    pub(crate) seed: u64,
}

/// A run that was done.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sample {
    /// Its place among the runs of its model in the list that asked for it.
    pub(crate) place: usize,
    /// Values of all parameters of the problem.
    pub(crate) at: Vec<f64>,
    /// Diameter of the grains over the real one.
    pub(crate) factor: f64,
    /// Means of the observables by name.
    pub(crate) values: BTreeMap<String, f64>,
    /// How it ended up; empty if the simulator has none.
    pub(crate) regime: String,
    pub(crate) key: String,
}

/// Result of the runs of one model.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Samples {
    /// Runs that gave all measured observables.
    pub(crate) done: Vec<Sample>,
    /// Points that gave no result, with the reason.
    pub(crate) failed: Vec<(Vec<f64>, String)>,
}

/// What is asked, and how large the answer may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) problem: &'a CalibrationProblem,
    pub(crate) settings: &'a LoopSettings,
}

/// What the runs of a loop share.
#[derive(Clone, Copy)]
pub(crate) struct Runner<'a> {
    pub(crate) campaign: Campaign<'a>,
    pub(crate) simulator: &'a dyn Simulator,
    pub(crate) asked: Asked<'a>,
}

impl<'a> std::ops::Deref for Runner<'a> {
    type Target = Asked<'a>;

    fn deref(&self) -> &Asked<'a> {
        &self.asked
    }
}

/// Seeds of a stage for one model: no other stage or model uses them.
pub(crate) fn first_seed(settings: &LoopSettings, stage: u64, model: usize) -> u64 {
    settings.seed + SEEDS_OF_STAGE * stage + SEEDS_OF_MODEL * model as u64
}

/// Runs of a model at points with grains of a size, each with a seed of its own.
pub(crate) fn wanted(
    first_seed: u64,
    (model, factor): (usize, f64),
    points: &[Vec<f64>],
) -> Vec<Wanted> {
    let seeds = first_seed..;
    let each = points.iter().zip(seeds);
    each.map(|(at, seed)| Wanted {
        model,
        at: at.clone(),
        factor,
        seed,
    })
    .collect()
}

/// The request that a wanted run represents: it names the parameters on which the model depends, so that the same run
/// has the same key whatever the other parameters are.
pub(crate) fn request(problem: &CalibrationProblem, wanted: &Wanted) -> RunRequest {
    let model = &problem.models[wanted.model];
    let mut request = RunRequest::new(&model.name, wanted.seed);
    if wanted.factor != 1.0 {
        request = request.with_parameter(CoarseGraining::SYMBOL, wanted.factor);
    }
    model.parameters.iter().fold(request, |request, &j| {
        request.with_parameter(&problem.parameters[j].symbol, wanted.at[j])
    })
}

/// Names of the observables that were measured of a model, in alphabetical order.
pub(crate) fn observables(problem: &CalibrationProblem, model: usize) -> Vec<String> {
    let of_model = problem.measurements.iter().filter(|m| m.model == model);
    let mut names: Vec<String> = of_model.map(|m| m.observable.clone()).collect();
    names.sort();
    names
}

impl Runner<'_> {
    /// Does all runs in one list, so that no core waits, and gives their results by model.
    ///
    /// A run that fails costs its own point only.
    ///
    /// # Errors
    ///
    /// A campaign that was stopped, or whose store cannot be used.
    pub(crate) fn run(&self, wanted: &[Wanted]) -> Result<BTreeMap<usize, Samples>, Error> {
        let [all, _] = self.run_parts(wanted, wanted.len())?;
        Ok(all)
    }

    /// The same for the first `n` runs and for the others apart.
    ///
    /// # Errors
    ///
    /// As [`Self::run`].
    pub(crate) fn run_parts(
        &self,
        wanted: &[Wanted],
        n: usize,
    ) -> Result<[BTreeMap<usize, Samples>; 2], Error> {
        let requests: Vec<_> = wanted.iter().map(|w| request(self.problem, w)).collect();
        let results = self.campaign.run_each(self.simulator, &requests)?;
        let mut parts = [BTreeMap::new(), BTreeMap::new()];
        for (i, (wanted, result)) in wanted.iter().zip(results).enumerate() {
            let part = &mut parts[usize::from(i >= n)];
            let samples: &mut Samples = part.entry(wanted.model).or_default();
            let names = observables(self.problem, wanted.model);
            let place = samples.done.len() + samples.failed.len();
            match result.and_then(|record| sample((place, wanted), &record, &names)) {
                Ok(sample) => samples.done.push(sample),
                Err(reason) => samples.failed.push((wanted.at.clone(), reason)),
            }
        }
        Ok(parts)
    }
}

/// The measured observables of a record.
fn sample(
    (place, wanted): (usize, &Wanted),
    record: &Record,
    names: &[String],
) -> Result<Sample, String> {
    let mut values = BTreeMap::new();
    for name in names {
        let Some(observation) = record.observable(name) else {
            let given: Vec<_> = record.observables().keys().cloned().collect();
            return Err(format!(
                "it gave no observable '{name}'; it gave {}",
                given.join(", ")
            ));
        };
        values.insert(name.clone(), observation.mean);
    }
    Ok(Sample {
        place,
        at: wanted.at.clone(),
        factor: wanted.factor,
        values,
        regime: record.regime().unwrap_or_default().to_owned(),
        key: record.key().to_owned(),
    })
}

/// Runs of one regime, and those of others with the reason why they stay out.
pub(crate) fn of_regime<'a>(
    samples: &'a [Sample],
    regime: &str,
) -> (Vec<&'a Sample>, Vec<(&'a Sample, String)>) {
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for sample in samples {
        if sample.regime == regime {
            inside.push(sample);
        } else {
            let reason = format!(
                "it ended up {}, while the surface describes {regime}",
                sample.regime
            );
            outside.push((sample, reason));
        }
    }
    (inside, outside)
}

/// The regime of most runs; of equally many the one that comes first.
pub(crate) fn usual_regime(samples: &[Sample]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for sample in samples {
        *counts.entry(&sample.regime).or_default() += 1;
    }
    let most = counts.values().copied().max().unwrap_or(0);
    let first = samples.iter().find(|s| counts[s.regime.as_str()] == most);
    first.map_or_else(String::new, |s| s.regime.clone())
}
