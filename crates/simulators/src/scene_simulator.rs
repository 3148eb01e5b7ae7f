//! Scenes with parameters and effects as a simulator.
//!
//! [`SceneSimulator`] makes a [`campaign::Simulator`] of named scenes: a request names a scene, sets parameters
//! by their symbols, conditions and amplitudes of effects, and gets observables. A [`Binding`] says which settings
//! of a scene a symbol represents. [`RunDetails`] is what a record keeps beside the observables, and a
//! [`ParameterFile`] hands calibrated values from one command to the next.
//!
//! Invariants:
//! - the inputs of a request are the scene as it is run and the bytes of its meshes, and nothing else: requests
//!   that stand for the same run have one key, whatever else they set and whatever their scene is called;
//! - an invalid request is refused before anything is run.

mod binding;
mod body_details;
mod cost;
mod details;
mod error;
mod outcome;
mod parameter_file;
mod scene_run;
mod simulator;
mod surface;

pub use binding::Binding;
pub use body_details::BodyDetails;
pub use cost::SECONDS_PER_COST;
pub use details::{
    CurveDetails, FrameDetails, RunDetails, SeriesDetails, TimingDetails, effective_number,
    error_over_swings, no_surface, no_surface_of, png_in_base64,
};
pub use error::Error;
pub use outcome::{Effort, NOT_STEADY, outcome_of, word};
pub use parameter_file::{
    CalibratedEffect, CalibratedParameter, ParameterFile, ReadScene, read_scene,
};
pub use scene_run::SceneRun;
pub use simulator::SceneSimulator;
pub use surface::{SurfaceReadings, over_frames, scatter_of, unread_frames};
