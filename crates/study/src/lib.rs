//! Studies and design tables, read and checked against their scenes, and what is run on them.
//!
//! [`Study::read`] reads the one file of `calibrate` and `diagnose` and refuses all that is wrong with it at once.
//! [`run_study`] leads the calibration through it; [`run_diagnosis`] asks what is missing at given parameters.
//! [`write_hand_over`] writes the parameters as a file of settings, and the drums as decks for other codes.
//! [`DesignTable`] turns a table of runs into requests, and their records into a table of results.
//!
//! A commented example of every key is `fixtures/study-example/study.toml`.

mod candidates;
mod command_study;
mod compare;
mod correlated;
mod curves;
mod defaults;
mod design_table;
mod document;
mod effects;
mod error;
mod file;
mod hand_over;
mod init;
mod inputs;
mod limits;
mod measured;
mod next;
mod parameters;
mod photo_values;
mod photos;
mod plausible;
mod price;
mod problem;
mod result;
mod run;
mod run_remarks;
mod scenes;
mod setting;
mod simulator;
mod spent;
mod start;
mod study;

pub use compare::ComparedValue;
pub use defaults::DefaultUsed;
pub use design_table::{DesignChoices, DesignPlan, DesignRun, DesignTable};
pub use error::Error;
pub use file::{Budget, CompareEntry, MeasuredCorrelation, MeasuredValue, StudyFile};
pub use hand_over::{parameter_file, write_hand_over, write_json, write_result};
pub use init::{STARTERS, Starter, StarterFile};
pub use next::NextRow;
pub use photos::PhotoSeries;
pub use price::{Price, StagePrice};
pub use problem::Problem;
pub use result::{DiagnosisResult, StudyResult};
pub use run::{DiagnosisPrice, RunSettings, plan_diagnosis, plan_study, run_diagnosis, run_study};
pub use simulator::StudySimulator;
pub use study::Study;
