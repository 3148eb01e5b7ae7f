//! What a calibration gives.

use crate::{LoopSettings, NextForParameters, ResidualStudy, Role};
use response_surface::{Fit, Screening};
use serde::Serialize;
use std::collections::BTreeMap;

/// A calibrated parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Symbol.
    pub symbol: String,
    /// Name for the reader.
    pub name: String,
    /// Unit of all values.
    pub unit: String,
    /// Settings of the simulator that it represents.
    pub sets: Vec<String>,
    /// The value in use before.
    pub start: f64,
    /// Estimate.
    pub value: f64,
    /// Standard error; `None` if neither data nor prior fix it.
    pub se: Option<f64>,
    /// 95 % interval, within the limits.
    pub interval95: [f64; 2],
    /// Whether the measurements alone, without any prior, exclude some of what is physically possible.
    pub fixed_by_data: bool,
    /// Whether the estimate lies on a limit.
    pub at_limit: bool,
    /// Lowest and highest value that is physically possible.
    pub limits: [f64; 2],
}

/// An input of the simulator that was stated with an error, and what the measurements make of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputEstimate {
    /// Symbol.
    pub symbol: String,
    /// Name for the reader.
    pub name: String,
    /// Unit of all values.
    pub unit: String,
    /// Settings of the simulator that it represents.
    pub sets: Vec<String>,
    /// Its value as it was stated.
    pub stated: f64,
    /// Standard deviation of that.
    pub sd: f64,
    /// Its value at the estimate.
    pub value: f64,
    /// Standard error of that.
    pub se: f64,
    /// How far it moves from what was stated, in standard deviations of that.
    pub moved: f64,
    /// By how much the estimate of each parameter moves, in its unit, if the input is one standard deviation larger.
    pub moves: BTreeMap<String, f64>,
}

/// A combination of parameters that the measurements leave open.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpenCombination {
    /// Weights by symbol, in units of the widths of the limits; their squares sum to 1.
    pub weights: BTreeMap<String, f64>,
    /// Standard error along it, in widths of the limits; `None` if it is infinite.
    pub se_in_widths: Option<f64>,
}

/// A measurement beside what the simulator shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Scene.
    pub scene: String,
    /// Condition.
    pub condition: BTreeMap<String, String>,
    /// Observable; its ending is its unit.
    pub observable: String,
    /// Use of the measurement.
    pub role: Role,
    /// The measured value.
    pub measured: MeasuredMean,
    /// The simulated value.
    pub simulated: SimulatedMean,
    /// Standard error of the prediction from the uncertainty of the parameters alone; `None` if it is not known.
    pub parameter_se: Option<f64>,
    /// How far the simulated mean can move, at least, if the parameters do within the box of the file; `None` if no surface shows it.
    pub reach: Option<f64>,
    /// Measured minus simulated, in standard errors of both.
    pub z: f64,
    /// Largest |z| with which it counts as met.
    pub z_limit: f64,
    /// Whether it is met.
    pub holds: bool,
    /// How the runs ended up, by number of runs.
    pub regimes: BTreeMap<String, usize>,
    /// Keys of the runs behind it.
    pub keys: Vec<String>,
}

/// A measured mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeasuredMean {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of single values.
    pub sd: f64,
    /// Number of independent values.
    pub n: f64,
}

/// A simulated mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SimulatedMean {
    /// Mean over the runs.
    pub mean: f64,
    /// Its standard error.
    pub se: f64,
    /// Number of runs.
    pub n_runs: usize,
}

/// A box in which a search was made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchBox {
    /// Lower ends, in the order of the parameters.
    pub low: Vec<f64>,
    /// Upper ends.
    pub high: Vec<f64>,
    /// Why it was searched.
    pub why: String,
    /// The best point found in it.
    pub best: Vec<f64>,
    /// Sum of squares of the whitened residual there.
    pub misfit: f64,
    /// Number of new runs in it.
    pub n_runs: usize,
}

/// The surfaces of one model in the last box.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelSurfaces {
    /// Name of the model.
    pub model: String,
    /// Symbols of its parameters.
    pub symbols: Vec<String>,
    /// Design behind it.
    pub design: String,
    /// Runs that entered.
    pub n_runs: usize,
    /// Runs that did not, with the reason.
    pub left_out: Vec<LeftOut>,
    /// The points, natural values, (runs, parameters of the model).
    pub points: Vec<Vec<f64>>,
    /// Keys of the records of the runs, in the order of the points.
    pub keys: Vec<String>,
    /// Values by observable, in the order of the points.
    pub values: BTreeMap<String, Vec<f64>>,
    /// Shift of the surface of each observable by the fresh runs at the estimate, in its unit.
    pub shifts: BTreeMap<String, f64>,
    /// Analysis of the surface of each observable, [shifted](Self::shifts); `None` if the runs are too few for it.
    pub fits: BTreeMap<String, Option<Fit>>,
}

/// A run that entered no surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// Natural values of the parameters of the model.
    pub point: Vec<f64>,
    /// Why: it failed, or it ended up in another regime.
    pub reason: String,
}

/// The screening of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelScreening {
    /// Name of the model.
    pub model: String,
    /// Number of runs.
    pub n_runs: usize,
    /// Analysis by observable.
    pub screenings: BTreeMap<String, Screening>,
    /// Symbols that went on.
    pub kept: Vec<String>,
    /// Symbols that stay at their start in this model.
    pub dropped: Vec<String>,
}

/// How something that was measured changes with the size of the grains at the estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeTrend {
    /// Name of the model.
    pub model: String,
    /// Observable.
    pub observable: String,
    /// Change per real diameter.
    pub slope: f64,
    /// Its standard error.
    pub slope_se: f64,
    /// Diameter of the finest grains over the real one.
    pub finest: f64,
    /// Shift from these to real ones.
    pub shift: f64,
    /// Its standard error.
    pub shift_se: f64,
    /// Standard error of what was measured.
    pub measured_se: f64,
    /// Diameter of the finest grains over the real one up to which the error of the shift stays within what is allowed, the coarsest
    /// as they are.
    pub finest_allowed: f64,
}

/// A round of fresh runs at the estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfirmationRound {
    /// Where, in the order of the parameters.
    pub at: Vec<f64>,
    /// Values of the runs beside those that the surfaces predicted.
    pub rows: Vec<ConfirmationRow>,
    /// Whether they agree.
    pub confirmed: bool,
}

/// One observable of a round.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfirmationRow {
    /// Name of the model.
    pub model: String,
    /// Observable.
    pub observable: String,
    /// Prediction of the surface.
    pub predicted: f64,
    /// Its standard error.
    pub predicted_se: f64,
    /// Mean of the runs.
    pub simulated: SimulatedMean,
    /// Difference in standard errors of both, as a normal score.
    pub z: f64,
    /// Whether it is more than a tenth of the standard error of the measurement: less moves the estimate by next to
    /// nothing.
    pub matters: bool,
}

/// All points that agree with the measurements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolutionSet {
    /// Share of the last box in which every combination agrees with the measurements (95 %).
    pub share_of_box: f64,
    /// Lowest and highest value of each parameter in the set, in the order of the parameters.
    pub extent: Vec<[f64; 2]>,
    /// Separate best points, the best first, in the order of the parameters.
    pub separate: Vec<Vec<f64>>,
    /// Points of the set, drawn evenly from the set, in the order of the parameters; at most 500.
    pub points: Vec<Vec<f64>>,
}

/// Whether the fitted model leaves more than noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FitTest {
    /// Sum of squares of the whitened residual, priors included.
    pub misfit: f64,
    /// Measurements and priors minus parameters; 0 tests nothing.
    pub degrees_of_freedom: usize,
    /// Chance of so large a misfit from noise alone; none without degrees of freedom.
    pub p: Option<f64>,
}

/// The estimate from all measurements, checks included.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointEstimate {
    /// Parameters.
    pub parameters: Vec<Estimate>,
    /// The inputs that have an error.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputEstimate>,
    /// Correlations, (parameters, parameters).
    pub correlation: Vec<Vec<f64>>,
    /// Test of the joint fit.
    pub test: FitTest,
    /// Measurements beside what the linear model predicts at the joint estimate.
    pub predicted: Vec<JointPrediction>,
}

/// A measurement at the joint estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointPrediction {
    /// Scene.
    pub scene: String,
    /// Condition.
    pub condition: BTreeMap<String, String>,
    /// Observable.
    pub observable: String,
    /// Measured mean.
    pub measured: f64,
    /// Predicted mean.
    pub predicted: f64,
    /// Standard error of the prediction.
    pub se: f64,
}

/// The model with the effects that are named, fitted again by real runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WithEffects {
    /// Amplitudes of the runs, by effect.
    pub effects: BTreeMap<String, f64>,
    /// The parameters as they were fitted with them.
    pub parameters: Vec<Estimate>,
    /// Measurements of role fit and check beside what the runs show; the error of the parameters is not in z.
    pub rows: Vec<Comparison>,
    /// Whether all measurements hold and all parameters are known.
    pub holds: bool,
}

/// Result of the diagnosis of the residual.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "state")]
pub enum DiagnosisStage {
    /// It was made.
    Done(Box<ResidualStudy>),
    /// It was left out.
    LeftOut {
        /// Why.
        reason: String,
    },
}

/// Cost of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageCost {
    /// Name of the stage.
    pub stage: String,
    /// Runs that were computed; those found among the records cost nothing.
    pub runs: usize,
    /// Wall time, s; small where records were found again.
    pub wall_s: f64,
}

/// Everything that a calibration found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// Name of the problem.
    pub id: String,
    /// Settings of the loop.
    pub settings: LoopSettings,
    /// The parameters.
    pub parameters: Vec<Estimate>,
    /// The inputs that have an error. Points of all other lists have their values behind those of the parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputEstimate>,
    /// Correlations, (parameters, parameters).
    pub correlation: Vec<Vec<f64>>,
    /// Combinations that the data do not fix.
    pub open_combinations: Vec<OpenCombination>,
    /// Test of the fit.
    pub test: FitTest,
    /// The whole set of solutions.
    pub solutions: SolutionSet,
    /// All measurements with the parameters in use before, in the order of the measurements; empty where it was left
    /// out.
    pub before: Vec<Comparison>,
    /// Measurements of role fit at the estimate, by fresh runs.
    pub fit: Vec<Comparison>,
    /// Measurements of role check.
    pub check: Vec<Comparison>,
    /// Measurements of role show.
    pub show: Vec<Comparison>,
    /// Screenings.
    pub screening: Vec<ModelScreening>,
    /// Boxes in the order of the search.
    pub boxes: Vec<SearchBox>,
    /// Surfaces of the last box.
    pub surfaces: Vec<ModelSurfaces>,
    /// Trends with the size of the grains, if they are coarser than the real ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub size_trends: Vec<SizeTrend>,
    /// Rounds of confirmation.
    pub confirmations: Vec<ConfirmationRound>,
    /// The estimate from all measurements; `None` if it was not asked for, or there is no check.
    pub joint: Option<JointEstimate>,
    /// Diagnosis of the residual.
    pub diagnosis: DiagnosisStage,
    /// What to measure next; `None` if the measurements fix all parameters, or the problem names no candidates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_for_parameters: Option<NextForParameters>,
    /// Measurements and parameters with the missing effects added; `None` if nothing is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_effects: Option<WithEffects>,
    /// Remarks for the reader.
    pub remarks: Vec<String>,
    /// Whether the fit is met and the checks hold, by the model of the file or with the effects that are named.
    pub met: bool,
    /// The same in one sentence.
    pub verdict: String,
    /// Cost by stage.
    pub cost: Vec<StageCost>,
}
