//! Screening, response surface, solutions, validation and residual study over any simulator.
//!
//! Nothing here knows what is simulated: a stage makes a list of [`campaign::RunRequest`]s, has
//! them done by a [`campaign::Campaign`], and analyses what comes back. A toy simulator tests
//! the whole loop in milliseconds:
//!
//! ```
//! use inference::{
//!     CalibrationProblem, LoopSettings, Measurement, Model, Parameter, Role, calibrate,
//! };
//! use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
//! use probability::random_stream::Stream;
//! use campaign::run_store::{Observation, Store};
//!
//! /// A bed whose angle is 20 deg + 40 deg times its friction; runs scatter by 0.2 deg.
//! struct Bed;
//!
//! impl Simulator for Bed {
//!     fn version(&self) -> String {
//!         "1".into()
//!     }
//!
//!     fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
//!         let noise = Stream::new(request.seed, &request.to_string()).normal();
//!         let friction = request.parameters.get("F").unwrap_or(&0.5);
//!         let mean = 20.0 + 40.0 * friction + 0.2 * noise;
//!         let angle = Observation::of_one(mean, "deg");
//!         Ok(RunOutcome::default().with_observable("angle_deg", angle))
//!     }
//! }
//!
//! let friction = Parameter {
//!     name: "friction".into(),
//!     limits: [0.0, 1.0],
//!     ..Parameter::new("F", [0.1, 0.9])
//! };
//! let drum = Model {
//!     name: "drum".into(),
//!     scene: "drum".into(),
//!     condition: Default::default(),
//!     parameters: vec![0],
//! };
//! let measured = Measurement {
//!     model: 0,
//!     observable: "angle_deg".into(),
//!     role: Role::Fit,
//!     mean: 36.0,
//!     sd: 0.5,
//!     n: 10.0,
//!     is_scatter: false,
//! };
//! let problem = CalibrationProblem {
//!     id: "bed".into(),
//!     parameters: vec![friction],
//!     models: vec![drum],
//!     measurements: vec![measured],
//!     ..CalibrationProblem::default()
//! };
//! let store = Store::in_memory();
//! let campaign = Campaign::new(&store, 1, &Silent);
//! let settings = LoopSettings { confirmation_runs: 12, ..LoopSettings::default() };
//! let found = calibrate(&campaign, &Bed, &problem, &settings, &|_| {})?;
//! // 36 deg are a friction of 0.4. The scatter of a run is 0.2 deg or 0.005 of it; the surface is shifted to the mean of twelve fresh
//! // runs, whose standard error is 0.0014.
//! let value = found.parameters[0].value;
//! assert!((value - 0.4).abs() < 0.005, "{value}");
//! # Ok::<(), inference::Error>(())
//! ```

mod before_any_run;
mod budget;
mod calibrate;
mod coarse_graining;
mod comparison;
mod confirmation;
mod correlated;
mod designs;
pub mod diagnosis;
mod diagnosis_stage;
mod error;
mod information;
mod intervals;
mod joint;
mod joint_fit;
mod lack_of_fit;
mod measurement;
mod next_for_parameters;
mod noisy_slopes;
mod planned;
mod power;
mod problem;
mod region;
mod remarks;
mod residual_study;
mod result;
mod samples;
mod screening;
mod search;
mod settings;
mod solution_set;
mod surface;
mod timer;
mod verdict;
mod with_effects;

pub use budget::runs_needed;
pub use calibrate::{calibrate, within_budget};
pub use diagnosis_stage::{diagnose_at, most_runs_of_candidates, most_runs_of_diagnosis};
pub use error::Error;
pub use measurement::{Measurement, Role};
pub use next_for_parameters::{NextForParameters, RankedMeasurement};
pub use planned::{PlannedStage, RunList, planned, planned_diagnosis};
pub use power::{PowerTable, power_of_design};
pub use problem::{
    CalibrationProblem, Candidate, CoarseGraining, Correlation, MOST_PARAMETERS, Model, Parameter,
    Prior,
};
pub use residual_study::{
    AddedEffect, CandidateMeasurement, EffectProbe, ErrorPair, OfferedMeasurement, RealErrors,
    ResidualPlan, ResidualStudy, StudyCondition, study_residual,
};
pub use result::{
    Calibration, Comparison, ConfirmationRound, ConfirmationRow, DiagnosisStage, Estimate, FitTest,
    InputEstimate, JointEstimate, JointPrediction, LeftOut, MeasuredMean, ModelScreening,
    ModelSurfaces, OpenCombination, SearchBox, SimulatedMean, SizeTrend, SolutionSet, StageCost,
    WithEffects,
};
pub use settings::{LoopSettings, ScreeningChoice, SurfaceDesign};
