//! A problem that has passed all checks.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::problem_file::{Condition, Level, Sign};

/// A residual to be diagnosed, made of a [`crate::diagnosis::ProblemFile`] that has passed all checks.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    pub(crate) id: String,
    pub(crate) observables: Vec<String>,
    /// Names of the declared parameters.
    pub(crate) declared: Vec<String>,
    pub(crate) candidates: Vec<Candidate>,
    /// What the parameters were fitted to.
    pub(crate) used: Part,
    /// What was kept for the check.
    pub(crate) unused: Option<Part>,
    /// Least and greatest shift of each declared parameter; infinite where it has no limit.
    pub(crate) limits: Vec<[f64; 2]>,
    /// Whether the residual is that of runs at fitted parameters.
    pub(crate) at_fit: bool,
    /// Known data of the declared parameters beforehand.
    pub(crate) prior: Option<Prior>,
    /// Degrees of freedom of the covariances; none when they are known.
    pub(crate) covariance_dof: Option<f64>,
    /// Measurements that could be made next.
    pub(crate) experiments: Vec<Experiment>,
    /// What was odd in the input.
    pub(crate) warnings: Vec<String>,
}

/// An effect of the library.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) name: String,
    /// Physically least and greatest amplitude; none when there is no limit.
    pub(crate) ends: Option<[f64; 2]>,
    /// Physically possible sign of its amplitude.
    pub(crate) sign: Sign,
    /// Whether the simulator could be run where it would explain the residual, or nobody said that it could not.
    pub(crate) was_run: bool,
}

impl Candidate {
    /// Least and greatest amplitude that is possible by its limits and its sign; infinite if there is no limit.
    pub(crate) fn range(&self) -> [f64; 2] {
        let [least, greatest] = self.ends.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        match self.sign {
            Sign::Any => [least, greatest],
            Sign::Positive => [0.0, greatest],
            Sign::Negative => [least, 0.0],
        }
    }
}

/// Where a row of the residual belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) condition: usize,
    pub(crate) observable: usize,
}

/// The rows of some conditions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub(crate) conditions: Vec<Condition>,
    /// Where each row belongs (rows), by condition, then observable.
    pub(crate) rows: Vec<Row>,
    /// Observed minus simulated (rows), in the units of the observables.
    pub(crate) residual: DVector<f64>,
    /// Covariance of measurement and simulator together (rows, rows).
    pub(crate) covariance: Covariance,
    /// Sensitivities to the declared parameters (rows, parameters).
    pub(crate) declared: DMatrix<f64>,
    /// Sensitivities to the library amplitudes (rows, effects).
    pub(crate) library: DMatrix<f64>,
    /// Errors of `declared`, independent of each other; empty when it is exact.
    pub(crate) declared_noise: Vec<SlopeNoise>,
    /// Covariance of each column of `library`; empty when they are exact.
    pub(crate) library_noise: Vec<Covariance>,
}

/// An error of the sensitivities to the declared parameters: a column e of this covariance, of which each parameter has its
/// share.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SlopeNoise {
    /// Shares of the parameters: the error is e times `along` transposed, and what it makes of a shift is e times
    /// `along . shift`.
    pub(crate) along: DVector<f64>,
    pub(crate) covariance: Covariance,
}

impl SlopeNoise {
    pub(crate) fn of_one(parameter: usize, n: usize, covariance: Covariance) -> Self {
        let along = DVector::from_fn(n, |k, _| f64::from(u8::from(k == parameter)));
        Self { along, covariance }
    }
}

/// Prior knowledge of the declared parameters, as rows of a least-squares problem.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prior {
    /// R with R'R the prior precision, without its zero rows (prior rows, parameters).
    pub(crate) root: DMatrix<f64>,
    /// R times (prior mean minus fitted value) (prior rows).
    pub(crate) offset: DVector<f64>,
}

/// An experiment that could be done next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Experiment {
    pub(crate) name: String,
    pub(crate) covariance: Covariance,
    /// Sensitivities to the declared parameters (its rows, parameters).
    pub(crate) declared: DMatrix<f64>,
    /// Sensitivities to the library amplitudes (its rows, effects).
    pub(crate) library: DMatrix<f64>,
    /// Numbers of the effects that it can show; all if none are given.
    pub(crate) effects: Option<Vec<usize>>,
    /// The runs behind its sensitivities; `None` if these are exact.
    pub(crate) runs: Option<RunNoise>,
    pub(crate) cost: f64,
}

/// Noise of sensitivities that are differences of two means of runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunNoise {
    /// Covariance of each mean (rows, rows).
    pub(crate) of_mean: DMatrix<f64>,
    /// One over the step of each declared parameter, and behind them of each effect; 0 where the column is exact.
    pub(crate) inverse_steps: Vec<f64>,
}

impl Experiment {
    pub(crate) fn tells_of(&self, effect: usize) -> bool {
        let told = self.effects.as_ref();
        told.is_none_or(|told| told.contains(&effect))
    }
}

impl Problem {
    /// Names of the effects of the library, in its order.
    pub fn library(&self) -> Vec<&str> {
        self.candidates.iter().map(|c| c.name.as_str()).collect()
    }

    /// Names of the declared parameters.
    pub fn declared(&self) -> &[String] {
        &self.declared
    }

    /// Names of the observables.
    pub fn observables(&self) -> &[String] {
        &self.observables
    }

    /// The same problem with an effect taken out of the library and without experiments to be done.
    pub(crate) fn without_candidate(mut self, effect: usize) -> Self {
        self.candidates.remove(effect);
        for part in std::iter::once(&mut self.used).chain(&mut self.unused) {
            part.library = std::mem::take(&mut part.library).remove_column(effect);
            if !part.library_noise.is_empty() {
                part.library_noise.remove(effect);
            }
        }
        self.experiments.clear();
        self
    }

    /// The same problem with the rows of one observable and without the unused part.
    pub(crate) fn with_observable(&self, observable: usize) -> Self {
        let mut problem = self.clone();
        problem.used = self.used.keep(|row| row.observable == observable);
        problem.unused = None;
        problem
    }

    /// The same problem without one of the used conditions and without the unused part.
    pub(crate) fn without_condition(&self, condition: usize) -> Self {
        let mut problem = self.clone();
        problem.used = self.used.keep(|row| row.condition != condition);
        problem.unused = None;
        problem
    }
}

impl Part {
    pub(crate) fn has_noisy_sensitivities(&self) -> bool {
        !self.declared_noise.is_empty() || !self.library_noise.is_empty()
    }

    /// Keeps the rows that `wanted` accepts.
    pub(crate) fn keep(&self, wanted: impl Fn(&Row) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.rows.len())
            .filter(|&i| wanted(&self.rows[i]))
            .collect();
        let of_slopes = |noise: &SlopeNoise| SlopeNoise {
            along: noise.along.clone(),
            covariance: noise.covariance.keep(&kept),
        };
        Self {
            conditions: self.conditions.clone(),
            rows: kept.iter().map(|&i| self.rows[i]).collect(),
            residual: self.residual.select_rows(&kept),
            covariance: self.covariance.keep(&kept),
            declared: self.declared.select_rows(&kept),
            library: self.library.select_rows(&kept),
            declared_noise: self.declared_noise.iter().map(of_slopes).collect(),
            library_noise: self.library_noise.iter().map(|c| c.keep(&kept)).collect(),
        }
    }

    pub(crate) fn label(&self, condition: usize) -> String {
        self.conditions
            .get(condition)
            .map_or_else(|| format!("condition {condition}"), condition_label)
    }
}

/// Words for a condition, such as `fill 0.18, rpm 4`.
pub(crate) fn condition_label(condition: &Condition) -> String {
    let words: Vec<String> = condition
        .iter()
        .map(|(name, level)| match level {
            Level::Number(x) => format!("{name} {x}"),
            Level::Kind(kind) => format!("{name} {kind}"),
        })
        .collect();
    words.join(", ")
}
