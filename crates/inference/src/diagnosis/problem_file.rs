//! The raw form of a problem: what `problem.json` holds, and what programs fill in.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A coordinate of a condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Level {
    /// A number in the unit of its name, such as rpm.
    Number(f64),
    /// A kind, such as a wall material.
    Kind(String),
}

/// A condition of the experiment: coordinates by name.
pub type Condition = BTreeMap<String, Level>;

/// A covariance matrix by rows, units as of the products of its observables.
pub type CovarianceMatrix = Vec<Vec<f64>>;

/// A covariance in one of its forms; units are products of the observables' units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum CovarianceInput {
    /// One block per condition, each (observables, observables).
    Blocks(Vec<CovarianceMatrix>),
    /// Either one block (observables, observables) that all conditions share, or the whole
    /// matrix (rows, rows) with correlations between conditions.
    Matrix(CovarianceMatrix),
}

/// Prior precision of the declared parameters, in 1 / (unit of the parameter) squared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PriorPrecision {
    /// 1 / sd^2 of each parameter; 0 where it is free.
    Diagonal(Vec<f64>),
    /// The whole matrix (parameters, parameters).
    Matrix(Vec<Vec<f64>>),
}

/// How far the amplitude of an effect can go physically.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Largest {
    /// The same size on both sides of zero.
    Size(f64),
    /// Least and greatest amplitude, at most and at least 0.
    Ends([f64; 2]),
}

impl Largest {
    /// Least and greatest amplitude.
    pub(crate) fn ends(self) -> [f64; 2] {
        match self {
            Self::Size(size) => [-size, size],
            Self::Ends(ends) => ends,
        }
    }
}

/// The sign that the amplitude of an effect can have physically.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sign {
    /// Both.
    #[default]
    Any,
    /// Not below zero.
    Positive,
    /// Not above zero.
    Negative,
}

/// An experiment that could be done next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExperimentFile {
    /// Its name; made of the condition where it is absent.
    #[serde(default)]
    pub name: Option<String>,
    /// Where it would measure.
    pub condition: Condition,
    /// d observable / d declared parameter (its rows, parameters).
    pub sensitivities_declared: Vec<Vec<f64>>,
    /// d observable / d amplitude of each library effect (its rows, effects).
    pub sensitivities_library: Vec<Vec<f64>>,
    /// Covariance of its rows, measurement and simulator together (its rows, its rows).
    pub covariance: Vec<Vec<f64>>,
    /// Effects that it can show: those whose columns of `sensitivities_library` are known; all if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effects: Option<Vec<String>>,
    /// The runs behind its sensitivities; absent where these are exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runs: Option<SensitivityRuns>,
    /// Cost relative to the other experiments.
    #[serde(default = "one")]
    pub cost: f64,
}

/// Runs behind sensitivities: a mean at a point, and one a step beside it in each column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensitivityRuns {
    /// Covariance of each mean (rows, rows).
    pub covariance_of_mean: Vec<Vec<f64>>,
    /// Step of each declared parameter; null where the column is exact.
    pub steps_declared: Vec<Option<f64>>,
    /// Amplitude at which each effect was run; null where it was not, or has the noise of the runs without it.
    pub steps_library: Vec<Option<f64>>,
}

/// Cost if none is given.
fn one() -> f64 {
    1.0
}

/// A residual with its covariances and sensitivities, as read from `problem.json`.
///
/// Rows are ordered by condition, then observable: the row number is the condition index times the
/// number of observables, plus the observable index. An observable that was not measured has the
/// residual null; its row is left out everywhere. Units: residuals in the unit of their
/// observable; sensitivities in unit of the observable per unit of the parameter or amplitude.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ProblemFile {
    /// A name for the problem.
    pub id: String,
    /// Conditions that the declared parameters were fitted to.
    pub conditions: Vec<Condition>,
    /// Names of the observables, with their unit in the name.
    pub observables: Vec<String>,
    /// A word on the order of the rows, for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ordering: Option<String>,
    /// Observed minus simulated (rows).
    pub residual_obs_minus_sim: Vec<Option<f64>>,
    /// Covariance of the measurement.
    #[serde(alias = "cov_measurement_block")]
    pub cov_measurement: Option<CovarianceInput>,
    /// Covariance of the simulator's mean (of its replicates), never to be left out.
    #[serde(alias = "cov_simulator_block")]
    pub cov_simulator: Option<CovarianceInput>,
    /// A word on the covariances, for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cov_note: Option<String>,
    /// Degrees of freedom of the covariances where they were estimated; absent when known.
    pub covariance_dof: Option<f64>,
    /// Names of the declared parameters; P1, P2 ... if omitted.
    pub declared: Vec<String>,
    /// d simulated / d declared parameter (rows, parameters).
    pub sensitivities_declared: Vec<Vec<f64>>,
    /// Covariance of each column of `sensitivities_declared`, where it came from noisy runs.
    pub cov_sensitivities_declared: Vec<CovarianceInput>,
    /// What the entries of `cov_sensitivities_declared` belong to where the errors of the columns are correlated (entries,
    /// parameters): each is then an error independent of the others, of which the column of parameter k has so many
    /// times.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cov_sensitivities_declared_along: Vec<Vec<f64>>,
    /// Least and greatest shift of each declared parameter from the value at which the residual was taken, at most and at
    /// least 0, in its unit; null if there is no limit, and absent if there is none at all.
    pub shift_limits: Vec<[Option<f64>; 2]>,
    /// Whether the residual is that of runs at parameters that were fitted to these conditions: what re-tuning seems to
    /// take off it then is what no run has shown.
    pub at_fitted_parameters: bool,
    /// Prior precision of the declared parameters; absent when all are free.
    pub prior_precision: Option<PriorPrecision>,
    /// Prior mean minus fitted value of the declared parameters; 0 if omitted.
    pub prior_offset: Vec<f64>,
    /// Names of the library effects.
    pub library: Vec<String>,
    /// d simulated / d amplitude of each library effect (rows, effects).
    pub sensitivities_library: Vec<Vec<f64>>,
    /// Covariance of each column of `sensitivities_library`, where it came from noisy runs.
    pub cov_sensitivities_library: Vec<CovarianceInput>,
    /// Physically largest amplitude, by effect: a size, or `[least, greatest]`; absent when there is no limit.
    pub largest_amplitudes: BTreeMap<String, Largest>,
    /// Physically possible sign of an amplitude, by effect; any if omitted.
    pub signs: BTreeMap<String, Sign>,
    /// Effects that the simulator could not be run with at the amplitude that would explain the residual: their sensitivities
    /// are of elsewhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_run: Vec<String>,
    /// Conditions kept for the check, never used in the fit.
    pub unused_conditions: Vec<Condition>,
    /// Observed minus simulated on the unused conditions (unused rows).
    pub unused_residual_obs_minus_sim: Vec<Option<f64>>,
    /// Covariance of the measurement there; if omitted, the shared block of the used ones.
    pub unused_cov_measurement: Option<CovarianceInput>,
    /// Covariance of the simulator there; if omitted, the shared block of the used ones.
    pub unused_cov_simulator: Option<CovarianceInput>,
    /// d simulated / d declared parameter there (unused rows, parameters).
    pub unused_sensitivities_declared: Vec<Vec<f64>>,
    /// d simulated / d amplitude there (unused rows, effects).
    pub unused_sensitivities_library: Vec<Vec<f64>>,
    /// Experiments that could be done next; if there are none, the unused conditions serve.
    pub candidate_experiments: Vec<ExperimentFile>,
    /// Keys that mean nothing here; each gives a warning.
    #[serde(flatten, skip_serializing)]
    #[expect(
        clippy::zero_sized_map_values,
        reason = "the reader fills maps, not sets, with what is left over"
    )]
    pub other: BTreeMap<String, IgnoredAny>,
}
