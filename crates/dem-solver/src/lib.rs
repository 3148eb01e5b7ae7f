//! Contact search, force loop and time integration of rigid agglomerates.
//!
//! A [`World`] holds bodies (copies of a few [`geometry::clump::Clump`] templates), analytic walls, walls of
//! triangles and the contact laws between them, and moves them step by step.
//!
//! ```
//! use geometry::clump::Clump;
//! use contact_law::{Material, NormalForceEnd, PairParameters};
//! use dem_solver::{
//!     DashpotMass, Interaction, InteractionSettings, Placement, Settings, Template, World,
//! };
//! use nalgebra::{UnitQuaternion, Vector3};
//! let surface = InteractionSettings {
//!     materials: [Material::new(0.25, 4e6)?; 2],
//!     parameters: PairParameters {
//!         restitution: 0.5,
//!         static_friction: 0.3,
//!         rolling_friction: 0.0,
//!     },
//!     attraction: 0.0,
//!     end: NormalForceEnd::Clipped,
//! };
//! let settings = Settings {
//!     time_step: 1e-5,
//!     gravity: Vector3::new(0.0, -9.81, 0.0),
//!     skin: 3e-4,
//!     margin: 1e-3,
//! };
//! let ball = Template::new(&Clump::sphere(2e-3, 1000.0)?, 0, DashpotMass::Body);
//! let start = Placement::at_rest(0, Vector3::zeros(), UnitQuaternion::identity());
//! let mut world = World::new(settings, vec![ball], vec![Interaction::new(&surface)?], vec![], &[start])?;
//! for _ in 0..1000 {
//!     world.step()?;
//! }
//! // A free fall of 10 ms.
//! assert!((world.bodies().velocity[0].y + 0.0981).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Invariants:
//!
//! - the same input gives the same bits, whatever the instruction set of the processor and the
//!   number of threads;
//! - a step allocates nothing once the lists have grown to their working size, but for bodies at walls
//!   of triangles;
//! - [`plain`] computes the same forces without any list and is the oracle of the fast path.
//!
//! The search works on three levels: bounding spheres on a grid (`broad_phase`), sphere pairs
//! within a skin for each pair of bodies (`neighbours`, refreshed only when the pair has moved
//! against each other), and the overlap test of those candidates (`pair_force`). A world in which every
//! body is one sphere needs the first level only, and has lists, forces and a motion of its own (`spheres`). [`bonds`] hold
//! agglomerates together that may bend and break.

mod advance;
mod batch;
mod bodies;
pub mod bonds;
mod broad_phase;
mod candidates;
mod census;
mod check;
mod contact;
mod context;
mod error;
mod health;
mod integrate;
mod interaction;
mod kept_contact;
mod lanes;
mod ledger;
mod liquid;
mod load;
mod mesh_force;
mod mesh_wall;
mod neighbours;
mod pair_force;
mod part;
mod periodic;
mod phases;
pub mod plain;
mod pose;
mod settings;
mod shared_mass;
mod snapshot;
mod sphere_contact;
mod spheres;
mod template;
mod transpose;
mod travel;
mod triangle_tree;
mod wall;
mod wall_batch;
mod wall_force;
mod window;
mod workspace;
mod world;

pub use bodies::{Bodies, Placement};
pub use census::Census;
pub use error::Error;
pub use health::HealthLimits;
pub use interaction::{Interaction, InteractionSettings, OptionalLaws};
pub use ledger::{EnergyLedger, EnergyTerms};
pub use load::Load;
pub use mesh_wall::{AxialLoad, MeshPose, MeshWall, Motion, Vibration};

pub use phases::StepPhases;
pub use settings::Settings;
pub use snapshot::Snapshot;
pub use template::{DashpotMass, Template};
pub use wall::{Shape, Wall};
pub use world::World;
