//! Data as a laboratory would give them: the simulator with a truth that the diagnosis is not told of, other seeds, and
//! noise of reading.

use crate::{AnyError, SEED};
use campaign::run_store::Record;
use campaign::{Campaign, RunRequest, Simulator};
use inference::{CalibrationProblem, Candidate, CandidateMeasurement, Model, Parameter};
use probability::random_stream::Stream;
use std::collections::BTreeMap;
use study::{Study, StudySimulator};

/// First seed of the pilot runs, and of the data; far from those of the diagnoses.
const PILOT_SEEDS: u64 = 20_000_000;
/// See [`PILOT_SEEDS`].
const DATA_SEEDS: u64 = 30_000_000;
/// Seeds of one campaign.
const SEEDS_OF_CAMPAIGN: u64 = 1000;
/// Runs of each model that tell how far single runs scatter: a standard deviation from them is right within 27 %, and
/// that of several models within less.
const PILOT_RUNS: usize = 8;

/// What a campaign hides.
#[derive(Debug, Clone)]
pub(crate) struct Hidden {
    /// Effect and amplitude; none for nothing.
    pub(crate) effect: Option<(String, f64)>,
    /// Multiple of the smallest amplitude that was asked for.
    pub(crate) size: f64,
    /// The one that is physically possible.
    pub(crate) reached: f64,
    /// Number of the campaign, for its seeds.
    pub(crate) number: u64,
}

impl Hidden {
    /// Nothing.
    pub(crate) fn nothing(number: u64) -> Self {
        Self {
            effect: None,
            size: 0.0,
            reached: 0.0,
            number,
        }
    }
}

/// Measures at the models of a study.
pub(crate) struct Laboratory<'a> {
    /// The study; its measured means are placeholders.
    problem: &'a CalibrationProblem,
    /// Its scenes.
    simulator: &'a StudySimulator,
    /// Runs.
    campaign: &'a Campaign<'a>,
    /// Standard deviation of single runs with nothing hidden, by scene and observable.
    scatter: BTreeMap<(String, String), f64>,
}

impl<'a> Laboratory<'a> {
    /// Makes the pilot runs.
    pub(crate) fn new(
        study: &'a Study,
        simulator: &'a StudySimulator,
        campaign: &'a Campaign<'a>,
    ) -> Result<Self, AnyError> {
        let mut laboratory = Self {
            problem: &study.problem,
            simulator,
            campaign,
            scatter: BTreeMap::new(),
        };
        let start = |p: &Parameter| (p.symbol.clone(), p.start);
        let truth = study.problem.parameters.iter().map(start).collect();
        let models = laboratory.pilots();
        let pilot: Vec<RunRequest> = models
            .iter()
            .flat_map(|(model, _)| (0..PILOT_RUNS).map(move |r| (model, r)))
            .map(|(model, r)| {
                laboratory
                    .request_of(&model.name, &truth, None)
                    .with_seed(PILOT_SEEDS + r as u64)
            })
            .collect();
        let records = campaign.run_all(simulator, &pilot)?;
        let mut sums: BTreeMap<(String, String), (f64, f64)> = BTreeMap::new();
        for ((model, names), records) in models.iter().zip(records.chunks(PILOT_RUNS)) {
            for name in names {
                let values = values(records, name)?;
                let mean = mean(&values);
                let of = (model.scene.clone(), (*name).to_owned());
                let (squares, dof) = sums.entry(of).or_default();
                *squares += values.iter().map(|y| (y - mean).powi(2)).sum::<f64>();
                *dof += PILOT_RUNS as f64 - 1.0;
            }
        }
        let each = sums.into_iter();
        laboratory.scatter = each
            .map(|(of, (squares, dof))| (of, (squares / dof).sqrt()))
            .collect();
        Ok(laboratory)
    }

    /// The models that show how single runs scatter, with what is observed there: those measured, and those that could be
    /// in scenes that are not.
    fn pilots(&self) -> Vec<(&'a Model, Vec<&'a str>)> {
        let problem = self.problem;
        let measured = problem.models.iter().enumerate().map(|(k, model)| {
            let here = problem.measurements.iter().filter(|m| m.model == k);
            (model, here.map(|m| m.observable.as_str()).collect())
        });
        let is_new = |c: &&Candidate| problem.models.iter().all(|m| m.scene != c.model.scene);
        let candidates = problem.candidates.iter().filter(is_new);
        let candidates = candidates.map(|c| {
            let names = c.standard_errors.keys().map(String::as_str);
            (&c.model, names.collect())
        });
        measured.chain(candidates).collect()
    }

    /// The scene of a model.
    fn scene(&self, model: usize) -> String {
        self.problem.models[model].scene.clone()
    }

    /// A run of a model with a truth, its effect on where the model can carry it.
    fn request(
        &self,
        model: usize,
        truth: &BTreeMap<String, f64>,
        effect: Option<&(String, f64)>,
    ) -> RunRequest {
        self.request_of(&self.problem.models[model].name, truth, effect)
    }

    /// The same by the name of a model.
    fn request_of(
        &self,
        name: &str,
        truth: &BTreeMap<String, f64>,
        effect: Option<&(String, f64)>,
    ) -> RunRequest {
        let mut request = RunRequest::new(name, 0);
        request.parameters.clone_from(truth);
        let probe = |effect: &str| self.problem.effects.iter().find(|e| e.name == effect);
        if let Some((effect, amplitude)) = effect
            && probe(effect).is_some_and(|e| !e.absent.contains_key(name))
        {
            request = request.with_effect(effect, *amplitude);
        }
        request
    }

    /// What would be run at each model with the parameters at their start; an error where one cannot be run.
    fn inputs(&self, effect: Option<&(String, f64)>) -> Result<Vec<serde_json::Value>, AnyError> {
        let start = |p: &Parameter| (p.symbol.clone(), p.start);
        let start = self.problem.parameters.iter().map(start).collect();
        let models = 0..self.problem.models.len();
        models
            .map(|k| Ok(self.simulator.inputs(&self.request(k, &start, effect))?))
            .collect()
    }

    /// Whether all scenes can carry an effect of this amplitude; without one it is another campaign.
    pub(crate) fn can_be_run(&self, effect: &str, amplitude: f64) -> bool {
        amplitude != 0.0 && self.inputs(Some(&(effect.to_owned(), amplitude))).is_ok()
    }

    /// Whether an effect of this amplitude leaves every scene as it is.
    pub(crate) fn is_unchanged(&self, effect: &str, amplitude: f64) -> Result<bool, AnyError> {
        let on = self.inputs(Some(&(effect.to_owned(), amplitude)))?;
        Ok(on == self.inputs(None)?)
    }

    /// The parameters of a campaign, drawn from their priors.
    fn truth(&self, hidden: &Hidden) -> BTreeMap<String, f64> {
        let mut stream = Stream::new(SEED, &format!("truth {}", hidden.number));
        let drawn = self.problem.parameters.iter().map(|p| {
            let drawn = p
                .prior
                .map_or(p.start, |prior| prior.mean + prior.sd * stream.normal());
            (p.symbol.clone(), drawn.clamp(p.limits[0], p.limits[1]))
        });
        drawn.collect()
    }

    /// The study with measured values in which something is hidden.
    ///
    /// The parameters are drawn from their priors. The mean of a value is that of as many runs as the study states, each
    /// read with the standard deviation that it states; the standard deviation that the diagnosis is told holds the
    /// scatter of the runs too, as it is with nothing hidden.
    pub(crate) fn measure(&self, hidden: &Hidden) -> Result<CalibrationProblem, AnyError> {
        let truth = self.truth(hidden);
        let (mut requests, mut from) = (Vec::new(), Vec::new());
        for model in 0..self.problem.models.len() {
            from.push(requests.len());
            for _ in 0..self.runs(model) {
                let seed = DATA_SEEDS + SEEDS_OF_CAMPAIGN * hidden.number + requests.len() as u64;
                let request = self.request(model, &truth, hidden.effect.as_ref());
                requests.push(request.with_seed(seed));
            }
        }
        let records = self.campaign.run_all(self.simulator, &requests)?;
        let mut stream = Stream::new(SEED, &format!("reading {}", hidden.number));
        let mut problem = self.problem.clone();
        for m in &mut problem.measurements {
            let runs = self.runs(m.model);
            let values = values(&records[from[m.model]..from[m.model] + runs], &m.observable)?;
            let reading = m.sd;
            m.n = runs as f64;
            m.mean = mean(&values) + reading * stream.normal() / m.n.sqrt();
            let scatter = self.scatter[&(self.scene(m.model), m.observable.clone())];
            m.sd = reading.hypot(scatter);
        }
        for candidate in &mut problem.candidates {
            let runs = self.runs_in(&candidate.model.scene) as f64;
            for (name, se) in &mut candidate.standard_errors {
                let of = (candidate.model.scene.clone(), name.clone());
                let scatter = self.scatter.get(&of).copied().unwrap_or(0.0);
                *se = se.hypot(scatter / runs.sqrt());
            }
        }
        Ok(problem)
    }

    /// What a laboratory would find in a campaign where it has not measured yet, by the names of the plan: means of as many
    /// runs as elsewhere in the scene, read with the noise of the candidate in the study.
    pub(crate) fn measure_next(
        &self,
        hidden: &Hidden,
        next: &CandidateMeasurement,
    ) -> Result<BTreeMap<String, f64>, AnyError> {
        let known = &self.problem.candidates;
        let candidate = known.iter().find(|c| c.model.name == next.name);
        let candidate = candidate.ok_or_else(|| format!("no candidate {}", next.name))?;
        let first = DATA_SEEDS + SEEDS_OF_CAMPAIGN * hidden.number + SEEDS_OF_CAMPAIGN / 2;
        let truth = self.truth(hidden);
        let request = self.request_of(&next.name, &truth, hidden.effect.as_ref());
        let runs = 0..self.runs_in(&candidate.model.scene) as u64;
        let requests: Vec<RunRequest> =
            runs.map(|r| request.clone().with_seed(first + r)).collect();
        let records = self.campaign.run_all(self.simulator, &requests)?;
        let mut stream = Stream::new(SEED, &format!("next reading {}", hidden.number));
        let names = next.condition.observables.iter().flatten();
        names
            .map(|(in_plan, name)| {
                let values = values(&records, name)?;
                let reading = candidate.standard_errors[name] * stream.normal();
                Ok((in_plan.clone(), mean(&values) + reading))
            })
            .collect()
    }

    /// Number of runs behind the values measured in a scene, or in any where that one is not measured.
    fn runs_in(&self, scene: &str) -> usize {
        let most = |own: bool| {
            let models = 0..self.problem.models.len();
            let of = models.filter(|&k| !own || self.problem.models[k].scene == scene);
            of.map(|k| self.runs(k)).max()
        };
        most(true).or_else(|| most(false)).unwrap_or(1)
    }

    /// Number of runs behind the values measured on a model: the largest that one of them states.
    fn runs(&self, model: usize) -> usize {
        let of_model = self
            .problem
            .measurements
            .iter()
            .filter(|m| m.model == model);
        let most = of_model.map(|m| m.n).fold(1.0, f64::max);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of runs, 1 or more"
        )]
        let runs = most.round() as usize;
        runs
    }
}

/// An observable in records.
fn values(records: &[Record], name: &str) -> Result<Vec<f64>, AnyError> {
    let value = |record: &Record| {
        let found = record.observable(name).map(|o| o.mean);
        found.ok_or_else(|| format!("run {} gives no {name}", record.key()).into())
    };
    records.iter().map(value).collect()
}

/// Mean of values.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
