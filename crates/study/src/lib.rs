//! The loop of one study: reads the study file, runs every stage, writes the result folder.
//!
//! This is the only room that joins the calibration to the solver: [`SceneSimulator`] makes a
//! [`campaign::Simulator`] of scenes and effects, and [`run_study`] leads it through screening,
//! response surface, solutions, validation, the metering device, the residual at the bench
//! measurements, and a campaign with a hidden effect. [`run_diagnosis`] does the last part alone, on a
//! user's own measurements.

mod diagnosis_file;
mod diagnosis_run;
mod error;
mod file;
mod hidden;
mod loop_stages;
mod result;
mod simulator;

pub use diagnosis_file::{
    DeclaredEntry, DiagnosisFile, MeasuredEntry, Measurement, PlannedDiagnosis, Prior, Role,
    overrides,
};
pub use diagnosis_run::{DiagnosisResult, run_diagnosis};
pub use error::Error;
pub use file::{Profile, StudyFile};
pub use hidden::probes;
pub use loop_stages::{RunSettings, run_study};
pub use result::{
    FillingSummary, HiddenCampaign, ImageAgainstPosition, MeteringResult, StudyResult, SweepPoint,
};
pub use simulator::{SceneSimulator, outcome_of};
