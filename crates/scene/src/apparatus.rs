//! The machines: walls, drive, room for the seeds.

mod drum;
mod metering;

pub use drum::Drum;
pub use metering::Metering;

use crate::Error;
use dem_solver::Shape;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A machine that moves seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Apparatus {
    /// Rotating drum between two covers.
    Drum(Drum),
    /// Inside-filling seed-metering device.
    Metering(Metering),
}

/// A wall by the name of its material.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedWall {
    /// Name.
    pub(crate) name: &'static str,
    /// Shape.
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
            Self::Drum(drum) => vec![&drum.shell, &drum.cover],
            Self::Metering(device) => vec![&device.plate, &device.front, &device.board],
        }
    }

    /// Refuses sizes that cannot be meant.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Drum(_) => Ok(()),
            Self::Metering(device) => device.check(),
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
        }
    }

    /// Inner radius, m.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Drum(drum) => 0.5 * drum.inner_diameter.si(),
            Self::Metering(device) => 0.5 * device.inner_diameter.si(),
        }
    }

    /// Inner width along the axis, m.
    pub fn width(&self) -> f64 {
        match self {
            Self::Drum(drum) => drum.width.si(),
            Self::Metering(device) => device.width.si(),
        }
    }

    /// Speed, counter-clockwise positive as the camera sees it, rad/s.
    pub fn speed(&self) -> f64 {
        match self {
            Self::Drum(drum) => drum.speed.si(),
            Self::Metering(device) => device.speed.si(),
        }
    }

    /// Sets the speed, rad/s.
    pub fn set_speed(&mut self, speed: quantity::AngularSpeed) {
        match self {
            Self::Drum(drum) => drum.speed = speed,
            Self::Metering(device) => device.speed = speed,
        }
    }

    /// Froude number R w² / g `[CottonStudy, section 2.3]`.
    pub fn froude_number(&self, gravity: f64) -> f64 {
        self.radius() * self.speed().powi(2) / gravity
    }

    /// Whether a ball (centre and radius, m) is clear of all walls.
    pub(crate) fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let inside = centre.xy().norm() + radius < self.radius()
            && centre.z.abs() + radius < 0.5 * self.width();
        match self {
            Self::Drum(_) => inside,
            Self::Metering(device) => inside && device.is_clear_of_board(centre, radius),
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
