//! Screening, response surface, solutions, validation and residual study over any simulator.
//!
//! Nothing here knows what is simulated: a stage makes a list of [`campaign::RunRequest`]s, has
//! them done by a [`campaign::Campaign`], and analyses what comes back. A toy simulator tests
//! the whole loop in milliseconds.

mod budget;
mod cells;
mod error;
mod laboratory;
mod least_squares;
mod problem;
mod residual_study;
mod result;
mod settings;
mod stages;

pub use budget::{least_budget, runs_needed, within_budget};
pub use cells::{CalibrationFactor, CellRuns, Question, run_cells};
pub use error::Error;
pub use laboratory::Laboratory;
pub use least_squares::{BoundedProblem, bounded_least_squares};
pub use problem::{
    CalibrationProblem, MOST_PARAMETERS, Measurement, Model, Parameter, Prior, Role,
};
pub use residual_study::{
    AddedEffect, DeclaredParameter, EffectProbe, ErrorPair, Observed, RealErrors, ResidualPlan,
    ResidualStudy, StudyCondition, study_residual,
};
pub use result::{
    Calibration, Comparison, ConfirmationRound, ConfirmationRow, DiagnosisStage, Estimate, FitTest,
    JointEstimate, JointPrediction, LeftOut, MeasuredMean, ModelScreening, ModelSurfaces,
    OpenCombination, SearchBox, SimulatedMean, SolutionSet, StageCost,
};
pub use settings::{LoopSettings, ScreeningChoice, SurfaceDesign};
pub use stages::{
    Point, PointResult, ScreeningResult, SurfaceResult, Validation, fit_surface, run_points,
    screen_factors, significant_factors,
};
