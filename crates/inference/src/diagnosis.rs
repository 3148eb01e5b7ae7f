//! Whether a residual is noise or structure, and which effect explains it.
//!
//! A calibrated simulator leaves a residual against the measurements. This crate asks, in this
//! order: can anything be tested at all; is there structure that re-tuning the declared
//! parameters cannot absorb; does one effect of a library stand out; is what remains then noise;
//! does the effect beat an unknown one; which other effects would do as well; and what to
//! measure next. It never names one of two effects that the data cannot distinguish.
//!
//! ```
//! use inference::diagnosis::{CovarianceInput, Options, Problem, ProblemFile, Verdict, diagnose};
//! // One angle and three parameters: nothing can be tested.
//! let file = ProblemFile {
//!     conditions: vec![Default::default()],
//!     observables: vec!["angle_deg".into()],
//!     residual_obs_minus_sim: vec![Some(1.2)],
//!     cov_measurement: Some(CovarianceInput::Matrix(vec![vec![0.04]])),
//!     cov_simulator: Some(CovarianceInput::Matrix(vec![vec![0.2]])),
//!     sensitivities_declared: vec![vec![10.0, -3.0, 8.0]],
//!     ..ProblemFile::default()
//! };
//! let diagnosis = diagnose(&Problem::try_from(file)?, &Options::new(1))?;
//! assert_eq!(diagnosis.verdict, Verdict::Refused);
//! # Ok::<(), inference::diagnosis::Error>(())
//! ```
//!
//! Invariants:
//! - an effect that could not be seen is listed as not testable, never as absent;
//! - a tie set is reported whole;
//! - the same problem and seed give the same bits.
//!
//! The model is linear around the fitted point: the last word on a named effect is a run of the
//! simulator with it switched on.

#![expect(
    clippy::doc_markdown,
    reason = "formulas stand in plain text, with the symbols of their source"
)]

mod bayes_factor;
mod before_after;
mod box_least_squares;
mod checks;
mod covariance;
mod decision;
mod detectability;
mod diagnose;
mod error;
mod fit;
mod gates;
mod kept_conditions;
mod max_test;
mod next_measurement;
mod outcome;
mod power;
mod problem;
mod problem_file;
mod refits;
mod smooth_basis;
mod space;
mod summary;
mod tails;
mod telling_rows;
mod trials;

pub use before_after::{BeforeAfter, Change, Contrast, PartErrors, Stages};
pub use box_least_squares::least_squares_step;
pub(crate) use covariance::{Covariance, Whitener};
pub use diagnose::{Options, diagnose};
pub use error::Error;
pub use kept_conditions::{KeptCondition, ln_over_unknown};
pub(crate) use next_measurement::SEPARATION_TO_REACH;
pub use next_measurement::{NextMeasurement, PlannedExperiment, Purpose, QuestionedEffect};
pub use outcome::{
    Amplitude, CandidateResult, CheckedModel, ConditionShare, DeclaredResult, Diagnosis, Evidence,
    Limit, ObservableSupport, StructuredResidual, Unseen, Verdict,
};
pub use power::{Power, PowerDesign, power};
pub use problem::Problem;
pub use problem_file::{
    Condition, CovarianceInput, CovarianceMatrix, ExperimentFile, Largest, Level, PriorPrecision,
    ProblemFile, SensitivityRuns, Sign,
};
pub use refits::{Refit, RefittedModel, odds};
pub use trials::{NearestEffect, TrialRow, Truth, UnusedErrors, trials, usual_truths};
