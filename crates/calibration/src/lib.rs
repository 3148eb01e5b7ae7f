//! Screening, response surface, solutions, validation and residual study over any simulator.
//!
//! Nothing here knows what is simulated: a stage makes a list of [`campaign::RunRequest`]s, has
//! them done by a [`campaign::Campaign`], and analyses what comes back. A toy simulator tests
//! the whole loop in milliseconds.

mod budget;
mod calibrate;
mod comparison;
mod confirmation;
mod correlated;
mod designs;
mod diagnosis_stage;
mod error;
mod intervals;
mod joint;
mod joint_fit;
mod laboratory;
mod planned;
mod power;
mod problem;
mod region;
mod residual_study;
mod result;
mod samples;
mod screening;
mod search;
mod settings;
mod solution_set;
mod surface;
mod verdict;

pub use budget::runs_needed;
pub use calibrate::calibrate;
pub use diagnosis_stage::{diagnose_at, most_runs_of_candidates, most_runs_of_diagnosis};
pub use error::Error;
pub use laboratory::Laboratory;
pub use planned::{PlannedStage, planned};
pub use power::{PowerTable, power_of_design};
pub use problem::{
    CalibrationProblem, Candidate, Correlation, MOST_PARAMETERS, Measurement, Model, Parameter,
    Prior, Role,
};
pub use residual_study::{
    AddedEffect, CandidateMeasurement, DeclaredParameter, EffectProbe, ErrorPair, Observed,
    OfferedMeasurement, RealErrors, ResidualPlan, ResidualStudy, StudyCondition, study_residual,
};
pub use result::{
    Calibration, Comparison, ConfirmationRound, ConfirmationRow, DiagnosisStage, Estimate, FitTest,
    JointEstimate, JointPrediction, LeftOut, MeasuredMean, ModelScreening, ModelSurfaces,
    OpenCombination, SearchBox, SimulatedMean, SolutionSet, StageCost,
};
pub use settings::{LoopSettings, ScreeningChoice, SurfaceDesign};
