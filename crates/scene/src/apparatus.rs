//! The apparatus: walls, drive, room for the seeds.
//!
//! A new apparatus is one file, with its settings and its [`Device`], and one line in the list below.

mod box_collapse;
mod bulk_density;
mod compression;
mod device;
mod direct_shear;
mod draw_down;
mod drop;
mod drum;
mod heap;
mod hopper;
mod ledge;
mod machine;
mod metering;
mod penetration;
mod poured_heap;
mod read;
mod shapes;
mod slider;
mod storeys;
mod tilt;

pub use box_collapse::BoxCollapse;
pub use bulk_density::BulkDensity;
pub use compression::Compression;
pub(crate) use device::{Device, PeriodicSides};
pub use direct_shear::DirectShear;
pub use draw_down::DrawDown;
pub use drop::Drop;
pub use drum::{Drum, Lifters, OBSERVABLES_OF_A_BED, OBSERVABLES_OF_PICTURES, Ripple};
pub use heap::Heap;
pub use hopper::Hopper;
pub use ledge::Ledge;
pub use machine::Machine;
pub use metering::Metering;
pub use penetration::Penetration;
pub use poured_heap::PouredHeap;
pub use slider::Slider;
pub use tilt::Tilt;

use dem_solver::{Motion, Shape};
use input::quantity::AngularSpeed;
use nalgebra::Vector3;
use serde::Serialize;

/// Makes [`Apparatus`] and what depends on the list of its kinds from lines `Settings = "kind in a file"`.
macro_rules! apparatus {
    ($($(#[$doc:meta])* $kind:ident = $name:literal,)*) => {
        /// A device that moves seeds.
        #[derive(Debug, Clone, PartialEq, Serialize)]
        #[serde(tag = "kind")]
        pub enum Apparatus {
            $($(#[$doc])* #[serde(rename = $name)] $kind($kind),)*
        }

        /// Kinds by their names in a file.
        const KINDS: &[&str] = &[$($name),*];

        impl Apparatus {
            /// Name of its kind in a file.
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$kind(_) => $name,)*
                }
            }

            /// What the kinds have in common.
            pub(crate) fn device(&self) -> &dyn Device {
                match self {
                    $(Self::$kind(device) => device,)*
                }
            }

            /// The same to change it.
            fn device_mut(&mut self) -> &mut dyn Device {
                match self {
                    $(Self::$kind(device) => device,)*
                }
            }

            /// Reads the settings of a kind; `None` for an unknown kind.
            fn of_kind(kind: &str, table: toml::Table) -> Option<Result<Self, toml::de::Error>> {
                match kind {
                    $($name => Some(read::settings(table).map(Self::$kind)),)*
                    _ => None,
                }
            }
        }
    };
}

apparatus! {
    /// Rotating drum between two covers.
    Drum = "drum",
    /// Inside-filling seed-metering device.
    Metering = "metering",
    /// Heap on a floor, from a cylinder that is lifted.
    Heap = "heap",
    /// Box whose gate is lifted.
    BoxCollapse = "box-collapse",
    /// Hopper that is emptied through its opening.
    Hopper = "hopper",
    /// Box whose seeds fall through a slot in its floor on a second one.
    DrawDown = "draw-down",
    /// Plate over whose ends a bed is discharged.
    Ledge = "ledge",
    /// Cup that is filled, struck off and tapped.
    BulkDensity = "bulk-density",
    /// Heap on a floor or a disc, poured from above.
    PouredHeap = "poured-heap",
    /// Bed under a piston.
    Compression = "compression",
    /// Bed sheared between two halves of a box.
    DirectShear = "direct-shear",
    /// Probe pressed into a bed.
    Penetration = "penetration",
    /// Walls, phases and probes as the file states them.
    Machine = "machine",
    /// Bench test: a sled of seeds pulled over a plate.
    Slider = "slider",
    /// Bench test: a seed that falls on a plate.
    Drop = "drop",
    /// Bench test: a seed on a plate that is tilted.
    Tilt = "tilt",
}

/// What all bench tests state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BenchTest<'a> {
    /// Material of the plate.
    pub(crate) plate: &'a str,
    /// Name of the kind of seed; the first kind if `None`.
    pub(crate) seed: Option<&'a str>,
    /// Number of repeats.
    pub(crate) repeats: usize,
}

/// A wall of triangles by the name of its material.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedMesh {
    pub(crate) name: String,
    /// Triangles at the start, m.
    pub(crate) triangles: Vec<[Vector3<f64>; 3]>,
    /// Name of the material.
    pub(crate) material: String,
    /// Motion when the drive runs.
    pub(crate) motion: Motion,
}

/// A wall by the name of its material.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedWall {
    pub(crate) name: String,
    pub(crate) shape: Shape,
    /// Name of the material.
    pub(crate) material: String,
    /// Spin when the drive runs, rad/s.
    pub(crate) spin: f64,
}

impl Apparatus {
    /// Whether a run goes through phases until the seeds rest, instead of turning until the bed is steady.
    pub fn has_phases(&self) -> bool {
        self.device().has_phases()
    }

    /// Whether the seeds end as a heap on a floor whose two flanks a photo from the side shows.
    pub fn shows_a_heap(&self) -> bool {
        self.device().leaves_a_heap() && !matches!(self, Self::BoxCollapse(_))
    }

    /// Whether it is a bench test: single seeds on a plate, with repeats instead of frames.
    pub fn is_bench_test(&self) -> bool {
        self.device().bench_test().is_some()
    }

    /// Whether it is a drum or a device that turns, whose bed its camera sees through the front.
    pub(crate) fn is_turned(&self) -> bool {
        self.device().speed().is_some()
    }

    /// Repeats of a bench test; `None` if the apparatus holds a bed.
    pub fn repeats(&self) -> Option<usize> {
        self.device().bench_test().map(|test| test.repeats)
    }

    /// Inner radius, half the length of a box, m; 0 in a bench test, which holds no bed.
    pub fn radius(&self) -> f64 {
        self.device().radius()
    }

    /// Inner width along the axis, m; 0 in a bench test.
    pub fn width(&self) -> f64 {
        self.device().width()
    }

    /// Volume inside, m³, of which a fill level is a share: of drum, cavity, cylinder or box; `None` in a bench test.
    pub fn bed_volume(&self) -> Option<f64> {
        self.device().bed_volume()
    }

    /// Speed, counter-clockwise positive as the camera sees it, rad/s; 0 if nothing turns.
    pub fn speed(&self) -> f64 {
        self.device().speed().map_or(0.0, AngularSpeed::si)
    }

    /// The speed with its unit, for messages.
    pub(crate) fn speed_text(&self) -> String {
        let speed = self.device().speed();
        speed.map_or_else(|| "0".to_owned(), |speed| speed.to_string())
    }

    /// Sets the speed; without effect if nothing turns.
    pub fn set_speed(&mut self, speed: AngularSpeed) {
        self.device_mut().set_speed(speed);
    }

    /// Froude number R w² / g `[CottonStudy, section 2.3]`.
    pub fn froude_number(&self, gravity: f64) -> f64 {
        self.radius() * self.speed().powi(2) / gravity
    }
}

/// Two covers that face each other across the width (m): (normal of the front, of the back).
fn cover(z: f64) -> Shape {
    Shape::Plane {
        point: Vector3::new(0.0, 0.0, z),
        normal: Vector3::new(0.0, 0.0, if z > 0.0 { -1.0 } else { 1.0 }),
    }
}
