//! Apparatus and protocol: from a scene to observables.
//!
//! A [`Scene`] is what `SCENE.toml` says: an apparatus, the seeds, materials and contacts, the
//! protocol and the camera. [`run`] fills the apparatus, lets the seeds settle, turns the drum
//! until the surface is steady, takes frames as the camera would see them and measures each with
//! the same code that measures photos. A run is decided by the scene and a seed alone.

mod apparatus;
mod error;
mod filling;
mod frame;
mod parse;
mod placement;
mod run;
mod settings;
mod steady;

pub use apparatus::{Apparatus, Drum, Metering};
pub use error::Error;
pub use filling::{FillingLibrary, SeedBody};
pub use frame::{Frame, FrameReading, drum_picture, read_frame};
pub use parse::Override;
pub use run::{Regime, RunResult, SeriesPoint, run};
pub use settings::{
    CameraSettings, ContactSettings, FillingSettings, MaterialSettings, ModelSettings, Protocol,
    Scene, SeedSettings,
};
pub use steady::{Truncation, marginal_standard_error_rule};
