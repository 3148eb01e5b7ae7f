//! Apparatus and protocol: from a scene to observables.
//!
//! A [`Scene`] is what `SCENE.toml` says: an apparatus, the seeds, materials and contacts, the
//! protocol and the camera. [`run`] fills the apparatus, lets the seeds settle, turns the drum
//! until the surface is steady, takes frames as the camera would see them and measures each with
//! the same code that measures photos. In a heap or a box a wall is lifted instead, and the slope is read
//! from the outline at rest. A bench test (slider, drop, tilt) handles single seeds on a plate. A run is decided by the scene and a seed alone.
//!
//! ```
//! use scene::{Override, Scene};
//! let file = dev_support::fixture_files::fixture("cotton/drum.toml");
//! let faster = Override {
//!     name: "rpm".into(),
//!     value: "20".into(),
//! };
//! let drum = Scene::read(&file, &[faster])?;
//! assert!((drum.apparatus.speed() - 20.0 * std::f64::consts::TAU / 60.0).abs() < 1e-12);
//! # Ok::<(), scene::Error>(())
//! ```

mod apparatus;
mod bed_motion;
mod bench;
mod bonded;
mod build;
mod check;
mod curve;
mod driven_pile;
mod drum_camera;
mod error;
mod extent;
mod factory;
mod filling;
mod flow;
mod frame;
mod health;
mod interactions;
mod keeper;
mod limits;
mod material;
mod memory_order;
mod motion;
mod named_setting;
mod obstacles;
mod other_names;
mod outline;
mod parse;
mod periodic_sides;
mod phase_times;
mod phases;
mod picture;
mod placement;
mod procedure;
mod reduce;
mod rest_load;
mod retry;
mod run;
mod seed;
mod series;
mod settings;
mod sizes;
mod start_slope;
mod steady;
mod surroundings;
mod time_step;

pub use apparatus::{
    Apparatus, BoxCollapse, BulkDensity, Compression, DirectShear, DrawDown, Drop, Drum, Heap,
    Hopper, Ledge, Lifters, Machine, Metering, OBSERVABLES_OF_A_BED, OBSERVABLES_OF_PICTURES,
    Penetration, PouredHeap, Ripple, Slider, Tilt,
};
pub use bed_motion::{BedMotion, MotionEvidence};
pub use bonded::BondedSettings;
pub use curve::{Curve, CurveKind};
pub use drum_camera::DrumCamera;
pub use error::Error;
pub use filling::{FilledShape, FillingLibrary, SeedBody};
pub use flow::{FlowingLayer, avalanche_period, fill_level, flowing_layer};
pub use frame::{Frame, FrameReading, drum_picture, read_frame};
pub use keeper::{Control, Keeper, NoKeeper, RunStage};
pub use material::{MaterialSettings, Stiffness};
pub use memory_order::SORTED_FROM;
pub use motion::Progress;
pub use named_setting::{NamedSetting, SettingKind};
pub use obstacles::{PlacedWall, VibrationSettings, WallSettings, walls_in_frame};
pub use outline::read_pile;
pub use parse::{Override, like_names, setting_at};
pub use phase_times::{PhaseTimes, TimeSpent};
pub use phases::{End, LOAD_CARRIED, Outlet, Passage, Phase, Plan, Sample};
pub use picture::frame_picture;
pub use procedure::{ForeignRun, Procedure, ProcedureWall, Surface, observe_foreign};
pub use retry::{USUAL_RETRIES, run_retrying};
pub use run::{
    Ending, ObservableValues, Regime, RunResult, run, run_on, running_world, settled_world,
    starting_frame,
};
pub use seed::{FillingSettings, SOLID_FRACTION, SeedSettings};
pub use series::SeriesPoint;
pub use settings::{
    CameraSettings, ContactSettings, LiquidSettings, ModelSettings, Protocol, RollingLaw, Scene,
};
pub use sizes::SizeSettings;
pub use steady::{Doubt, SteadyRule, SteadyState, error_of_mean, swing_time};
pub use surroundings::SurroundingsSettings;
