//! A heap on a floor: seeds in a cylinder that is lifted.

use super::device::Device;
use super::shapes::{between_circles, is_in_cylinder, room_of_cylinder, within_prism};
use super::{NamedMesh, NamedWall};
use crate::outline::read_round_heap;
use crate::phases::{End, Phase, Plan};
use crate::{Error, ObservableValues, Scene};
use dem_solver::{Motion, Shape};
use geometry::clump::Sphere;
use input::quantity::{Length, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Floor and cylinder; the axis of the cylinder is the y axis, the floor is y = 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heap {
    /// Inner diameter of the cylinder.
    pub inner_diameter: Length,
    /// Height of the cylinder.
    pub height: Length,
    /// Speed at which it is lifted, once the seeds rest.
    pub lift_speed: Speed,
    /// Material of the floor.
    pub floor: String,
    /// Material of the cylinder.
    pub cylinder: String,
}

impl Heap {
    /// The cylinder, lifted when the drive runs.
    fn cylinder_mesh(&self) -> NamedMesh {
        let (radius, height) = (0.5 * self.inner_diameter.si(), self.height.si());
        NamedMesh {
            name: "cylinder".into(),
            triangles: between_circles([radius, 0.0], [radius, height]),
            material: self.cylinder.clone(),
            motion: Motion {
                velocity: Vector3::y() * self.lift_speed.si(),
                ..Motion::default()
            },
        }
    }
}

impl Device for Heap {
    fn materials(&self) -> Vec<&str> {
        vec![&self.floor, &self.cylinder]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.inner_diameter", self.inner_diameter)?;
        check_size("apparatus.height", self.height)?;
        check_lift("apparatus.lift_speed", self.lift_speed)
    }

    fn observables(&self) -> Vec<&str> {
        vec!["angle_of_repose_deg", "height_mm", "base_radius_mm"]
    }

    fn walls(&self) -> Vec<NamedWall> {
        vec![floor(&self.floor)]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        vec![self.cylinder_mesh()]
    }

    fn radius(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }

    fn width(&self) -> f64 {
        self.inner_diameter.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(std::f64::consts::PI * self.radius().powi(2) * self.height.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, _: &Scene) -> Option<Plan> {
        // The wall must be out of the way before rest can mean anything.
        let lifted = self.height.si() / self.lift_speed.si();
        let motion = self.cylinder_mesh().motion;
        Some(Plan::new(vec![Phase {
            motions: vec![("cylinder".into(), motion)],
            end: End::AtRest { after: lifted },
            ..Phase::named("release")
        }]))
    }

    fn leaves_a_heap(&self) -> bool {
        true
    }

    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        read_round_heap(spheres, largest_radius)
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        is_in_cylinder(
            (centre, radius),
            within_prism(0.5 * self.inner_diameter.si()),
            self.height.si(),
        )
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        room_of_cylinder(0.5 * self.inner_diameter.si(), self.height.si())
    }
}

/// The floor y = 0.
pub(super) fn floor(material: &str) -> NamedWall {
    NamedWall {
        name: "floor".into(),
        shape: Shape::Plane {
            point: Vector3::zeros(),
            normal: Vector3::y(),
        },
        material: material.to_owned(),
        spin: 0.0,
    }
}

/// Refuses a length that no apparatus has.
pub(super) fn check_size(name: &str, length: Length) -> Result<(), Error> {
    if (1e-3..=10.0).contains(&length.si()) {
        return Ok(());
    }
    Err(Error::BadValue {
        name: format!("{name} in m"),
        value: length.to_string(),
        requirement: "between 0.001 and 10".into(),
    })
}

/// Refuses a speed of lifting that is not upwards.
pub(super) fn check_lift(name: &str, speed: Speed) -> Result<(), Error> {
    if speed.si() > 0.0 && speed.si() <= 10.0 {
        return Ok(());
    }
    Err(Error::BadValue {
        name: name.into(),
        value: speed.to_string(),
        requirement: "above 0 m/s, at most 10 m/s".into(),
    })
}
