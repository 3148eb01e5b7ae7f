//! A heap on a floor: seeds in a cylinder that is lifted.

use super::device::Device;
use super::{NamedMesh, NamedWall};
use crate::Error;
use dem_solver::{Motion, Shape};
use input::quantity::{Length, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Sides of the prism that stands for the cylinder; it lies within 0.3 % of its radius.
const SIDES: usize = 48;

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
        let at = |k: usize, y: f64| {
            let angle = std::f64::consts::TAU * (k % SIDES) as f64 / SIDES as f64;
            Vector3::new(radius * angle.cos(), y, radius * angle.sin())
        };
        // Rows twice as high as a side is wide: compact triangles keep the contact search short.
        let n_rows = (height * SIDES as f64 / (2.0 * std::f64::consts::TAU * radius)).ceil();
        let rows: Vec<f64> = std::iter::successors(Some(0.0), |r| Some(r + 1.0))
            .take_while(|r| *r < n_rows)
            .collect();
        let side = |k: usize| {
            let panel = move |row: &f64| {
                let [low, high] = [0.0, 1.0].map(|up| height * (row + up) / n_rows);
                let [a, b] = [at(k, low), at(k + 1, low)];
                let [c, d] = [at(k + 1, high), at(k, high)];
                [[a, b, c], [a, c, d]]
            };
            rows.iter().flat_map(panel).collect::<Vec<_>>()
        };
        NamedMesh {
            name: "cylinder".into(),
            triangles: (0..SIDES).flat_map(side).collect(),
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

    fn observables(&self) -> &'static [&'static str] {
        &["angle_of_repose_deg", "height_mm", "base_radius_mm"]
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

    fn releases_after(&self) -> Option<f64> {
        Some(self.height.si() / self.lift_speed.si())
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        // The sides of the prism lie a little within the circle.
        let inner = 0.5 * self.inner_diameter.si() * (std::f64::consts::PI / SIDES as f64).cos();
        centre.x.hypot(centre.z) + radius < inner
            && centre.y > radius
            && centre.y + radius < self.height.si()
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let radius = 0.5 * self.inner_diameter.si();
        [
            Vector3::new(-radius, 0.0, -radius),
            Vector3::new(radius, self.height.si(), radius),
        ]
    }
}

/// The floor y = 0.
pub(super) fn floor(material: &str) -> NamedWall {
    NamedWall {
        name: "floor",
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
