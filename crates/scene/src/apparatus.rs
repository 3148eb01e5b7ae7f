//! The machines: walls, drive, room for the seeds.

mod box_collapse;
mod drop;
mod drum;
mod heap;
mod metering;
mod read;
mod slider;
mod tilt;

pub use box_collapse::BoxCollapse;
pub use drop::Drop;
pub use drum::{Drum, Lifters, Ripple};
pub use heap::Heap;
pub use metering::Metering;
pub use slider::Slider;
pub use tilt::Tilt;

use crate::Error;
use dem_solver::{Motion, Shape};
use nalgebra::Vector3;
use serde::Serialize;

/// Observables of a drum; the first 19 need no more than where the spheres lie from moment to moment.
const DRUM_OBSERVABLES: [&str; 26] = [
    "angle_deg",
    "angle_by_position_deg",
    "image_minus_position_deg",
    "curvature",
    "s_shape",
    "shape_4",
    "shape_5",
    "fill_level",
    "toe_position_deg",
    "top_position_deg",
    "fluctuation_deg",
    "angle_correlation_time_s",
    "avalanche_size_deg",
    "avalanche_waiting_time_s",
    "centre_of_mass_deg",
    "centre_of_mass_fluctuation_deg",
    "shell_slip",
    "carried_share",
    "waiting_time_s",
    "airborne_share",
    "kinetic_energy_mj",
    "drive_power_mw",
    "flowing_layer_depth_mm",
    "surface_speed_mm_s",
    "fill_level_by_position",
    "avalanche_period_s",
];

/// Observables of a drum that pictures give whose times are not known.
pub const OBSERVABLES_OF_PICTURES: [&str; 9] = [
    "angle_deg",
    "curvature",
    "s_shape",
    "shape_4",
    "shape_5",
    "fill_level",
    "toe_position_deg",
    "top_position_deg",
    "fluctuation_deg",
];

/// Observables of a drum that the places of its spheres give, velocities unknown: without these there is no slip of seeds, and
/// where the bed is never carried along no time of waiting.
pub const OBSERVABLES_OF_A_BED: &[&str] = DRUM_OBSERVABLES.split_at(19).0;

/// A machine that moves seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Apparatus {
    /// Rotating drum between two covers.
    Drum(Drum),
    /// Inside-filling seed-metering device.
    Metering(Metering),
    /// Heap on a floor, from a cylinder that is lifted.
    Heap(Heap),
    /// Box whose gate is lifted.
    BoxCollapse(BoxCollapse),
    /// Bench test: a sled of seeds pulled over a plate.
    Slider(Slider),
    /// Bench test: a seed that falls on a plate.
    Drop(Drop),
    /// Bench test: a seed on a plate that is tilted.
    Tilt(Tilt),
}

/// What all bench tests state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BenchTest<'a> {
    /// Material of the plate.
    pub(crate) plate: &'a str,
    /// Name of the kind of seed; the first where none is named.
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
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    /// Name of the material.
    pub(crate) material: String,
    /// Spin when the drive runs, rad/s.
    pub(crate) spin: f64,
}

impl Apparatus {
    /// Names of the wall materials.
    pub(crate) fn materials(&self) -> Vec<&str> {
        match self {
            Self::Drum(drum) => {
                let lifters = drum.lifters.iter().map(|l| l.material.as_str());
                [drum.shell.as_str(), &drum.cover]
                    .into_iter()
                    .chain(lifters)
                    .collect()
            }
            Self::Metering(device) => vec![&device.plate, &device.front, &device.board],
            Self::Heap(heap) => vec![&heap.floor, &heap.cylinder],
            Self::BoxCollapse(body) => vec![&body.floor, &body.wall],
            Self::Slider(Slider { plate, .. })
            | Self::Drop(Drop { plate, .. })
            | Self::Tilt(Tilt { plate, .. }) => vec![plate],
        }
    }

    /// Refuses invalid sizes.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Drum(drum) => drum.check(),
            Self::Metering(device) => device.check(),
            Self::Heap(heap) => return heap.check(),
            Self::BoxCollapse(body) => return body.check(),
            Self::Drop(test) => return test.check(),
            Self::Slider(_) | Self::Tilt(_) => return Ok(()),
        }?;
        for (name, length) in [
            ("apparatus.inner_diameter", 2.0 * self.radius()),
            ("apparatus.width", self.width()),
        ] {
            if !(1e-3..=10.0).contains(&length) {
                return Err(Error::BadValue {
                    name: format!("{name} in m"),
                    value: length.to_string(),
                    requirement: "between 0.001 and 10".into(),
                });
            }
        }
        Ok(())
    }

    /// Walls with the spins of the running drive.
    pub(crate) fn walls(&self) -> Vec<NamedWall> {
        match self {
            Self::Drum(drum) => drum.walls(),
            Self::Metering(device) => device.walls(),
            Self::Heap(heap) => heap.walls(),
            Self::BoxCollapse(body) => body.walls(),
            // A test makes its own plate.
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => Vec::new(),
        }
    }

    /// Walls of triangles: lifters, cylinder, gate.
    pub(crate) fn mesh_walls(&self) -> Vec<NamedMesh> {
        match self {
            Self::Drum(drum) => match &drum.lifters {
                Some(lifters) => vec![NamedMesh {
                    name: "lifters".into(),
                    triangles: drum.lifter_triangles(),
                    material: lifters.material.clone(),
                    motion: Motion {
                        spin: Vector3::z() * drum.speed.si(),
                        ..Motion::default()
                    },
                }],
                None => Vec::new(),
            },
            Self::Metering(_) | Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => Vec::new(),
            Self::Heap(heap) => vec![heap.cylinder_mesh()],
            Self::BoxCollapse(body) => vec![body.gate_mesh()],
        }
    }

    /// Names of the observables that a run can give.
    pub(crate) fn observables(&self) -> &'static [&'static str] {
        match self {
            Self::Drum(_) => &DRUM_OBSERVABLES,
            Self::Metering(_) => &[
                "filling_angle_deg",
                "filling_angle_by_position_deg",
                "centre_of_mass_deg",
                "centre_of_mass_fluctuation_deg",
                "shell_slip",
                "carried_share",
                "waiting_time_s",
                "airborne_share",
                "kinetic_energy_mj",
                "drive_power_mw",
            ],
            Self::Heap(_) => &["angle_of_repose_deg", "height_mm", "base_radius_mm"],
            Self::BoxCollapse(_) => &[
                "angle_of_repose_deg",
                "height_mm",
                "runout_mm",
                "length_mm",
                "toe_angle_deg",
                "top_angle_deg",
            ],
            Self::Slider(_) => &["shown_static_friction"],
            Self::Drop(_) => &["shown_restitution"],
            Self::Tilt(_) => &["shown_rolling_friction", "slid_share", "held_share"],
        }
    }

    /// Whether the seeds are let go by a wall that is lifted.
    pub fn is_release(&self) -> bool {
        matches!(self, Self::Heap(_) | Self::BoxCollapse(_))
    }

    /// Gravity, m/s².
    pub(crate) fn gravity(&self, size: f64) -> Vector3<f64> {
        match self {
            Self::Drum(Drum {
                tilt: Some(tilt), ..
            }) => Vector3::new(0.0, -tilt.si().cos(), tilt.si().sin()) * size,
            _ => Vector3::new(0.0, -size, 0.0),
        }
    }

    /// On which side the lower cover of a tilted drum lies: 1 at the front, towards the camera, -1 at the back; none elsewhere.
    pub(crate) fn lower_cover(&self) -> Option<f64> {
        let Self::Drum(Drum {
            tilt: Some(tilt), ..
        }) = self
        else {
            return None;
        };
        let slope = tilt.si().sin();
        (slope != 0.0).then(|| slope.signum())
    }

    /// Share of the speed at a time after the start of the drive (s); none where it is constant.
    pub(crate) fn share_of_speed(&self, time: f64) -> Option<f64> {
        match self {
            Self::Drum(drum) if drum.has_schedule() => Some(drum.share_of_speed(time)),
            _ => None,
        }
    }

    /// What a bench test states; none where the apparatus holds a bed of seeds.
    pub(crate) fn bench_test(&self) -> Option<BenchTest<'_>> {
        let (plate, seed, repeats) = match self {
            Self::Slider(test) => (&test.plate, &test.seed, test.repeats),
            Self::Drop(test) => (&test.plate, &test.seed, test.repeats),
            Self::Tilt(test) => (&test.plate, &test.seed, test.repeats),
            Self::Drum(_) | Self::Metering(_) | Self::Heap(_) | Self::BoxCollapse(_) => {
                return None;
            }
        };
        Some(BenchTest {
            plate,
            seed: seed.as_deref(),
            repeats,
        })
    }

    /// Whether it is a bench test: single seeds on a plate, with repeats instead of frames.
    pub fn is_bench_test(&self) -> bool {
        self.bench_test().is_some()
    }

    /// Repeats of a bench test; none where the apparatus holds a bed.
    pub fn repeats(&self) -> Option<usize> {
        self.bench_test().map(|test| test.repeats)
    }

    /// Inner radius, half the length of a box, m; 0 in a bench test, which holds no bed.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Drum(drum) => 0.5 * drum.inner_diameter.si(),
            Self::Metering(device) => 0.5 * device.inner_diameter.si(),
            Self::Heap(heap) => 0.5 * heap.inner_diameter.si(),
            Self::BoxCollapse(body) => 0.5 * body.length.si(),
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => 0.0,
        }
    }

    /// Inner width along the axis, m; 0 in a bench test.
    pub fn width(&self) -> f64 {
        match self {
            Self::Drum(drum) => drum.width.si(),
            Self::Metering(device) => device.width.si(),
            Self::Heap(heap) => heap.inner_diameter.si(),
            Self::BoxCollapse(body) => body.width.si(),
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => 0.0,
        }
    }

    /// Volume inside, m³, of which a fill level is a share: of drum, cavity, cylinder or box; none in a bench test.
    pub fn bed_volume(&self) -> Option<f64> {
        let disc = std::f64::consts::PI * self.radius().powi(2);
        match self {
            Self::Drum(_) | Self::Metering(_) => Some(disc * self.width()),
            Self::Heap(heap) => Some(disc * heap.height.si()),
            Self::BoxCollapse(body) => Some(body.length.si() * body.height.si() * body.width.si()),
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => None,
        }
    }

    /// Speed, counter-clockwise positive as the camera sees it, rad/s; 0 where nothing turns.
    pub fn speed(&self) -> f64 {
        match self {
            Self::Drum(drum) => drum.speed.si(),
            Self::Metering(device) => device.speed.si(),
            _ => 0.0,
        }
    }

    /// Time in which the speed rises to its full, s; none where it has it at once.
    pub(crate) fn ramp(&self) -> Option<f64> {
        match self {
            Self::Drum(drum) => drum.ramp.map(input::quantity::Time::si),
            _ => None,
        }
    }

    /// The speed with its unit, for messages.
    pub(crate) fn speed_text(&self) -> String {
        match self {
            Self::Drum(drum) => drum.speed.to_string(),
            Self::Metering(device) => device.speed.to_string(),
            _ => "0".to_owned(),
        }
    }

    /// Sets the speed; nothing happens where nothing turns.
    pub fn set_speed(&mut self, speed: input::quantity::AngularSpeed) {
        match self {
            Self::Drum(drum) => drum.speed = speed,
            Self::Metering(device) => device.speed = speed,
            _ => {}
        }
    }

    /// Froude number R w² / g `[CottonStudy, section 2.3]`.
    pub fn froude_number(&self, gravity: f64) -> f64 {
        self.radius() * self.speed().powi(2) / gravity
    }

    /// Whether a ball (centre and radius, m) is clear of all walls.
    pub(crate) fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let inside = || {
            centre.xy().norm() + radius < self.radius()
                && centre.z.abs() + radius < 0.5 * self.width()
        };
        match self {
            Self::Drum(_) => inside(),
            Self::Metering(device) => inside() && device.is_clear_of_board(centre, radius),
            Self::Heap(heap) => heap.has_room(centre, radius),
            Self::BoxCollapse(body) => body.has_room(centre, radius),
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => false,
        }
    }

    /// Whether no ball of a radius (m) at these coordinates (m) can be inside.
    pub(crate) fn is_out_of_reach(&self, x: f64, y: f64, radius: f64) -> bool {
        match self {
            Self::Drum(_) | Self::Metering(_) => x.hypot(y) + radius >= self.radius(),
            _ => false,
        }
    }

    /// Region in which seeds may start: lower and upper corner, m; without extent in a bench test.
    pub(crate) fn room(&self) -> [Vector3<f64>; 2] {
        match self {
            Self::Heap(heap) => heap.room(),
            Self::BoxCollapse(body) => body.room(),
            Self::Slider(_) | Self::Drop(_) | Self::Tilt(_) => [Vector3::zeros(); 2],
            Self::Drum(_) | Self::Metering(_) => {
                let (radius, half) = (self.radius(), 0.5 * self.width());
                [
                    Vector3::new(-radius, -radius, -half),
                    Vector3::new(radius, radius, half),
                ]
            }
        }
    }
}

/// Two covers that face each other across the width (m): (normal of the front, of the back).
fn cover(z: f64) -> Shape {
    Shape::Plane {
        point: Vector3::new(0.0, 0.0, z),
        normal: Vector3::new(0.0, 0.0, if z > 0.0 { -1.0 } else { 1.0 }),
    }
}
