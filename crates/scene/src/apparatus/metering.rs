//! Inside-filling seed-metering device, reduced to the parts that the seeds touch.
//!
//! The seeding plate is a cup: its rim and its back turn. The front shell and the seed
//! protection board stand still. The study gives no dimensions of its device; those of a scene
//! are declared inputs.

use super::device::Device;
use super::drum::{check_turned, is_inside, turned_room};
use super::{NamedWall, cover};
use crate::Error;
use dem_solver::Shape;
use input::quantity::{Angle, AngularSpeed, Length};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metering {
    /// Inner diameter of the cavity in the seeding plate.
    pub inner_diameter: Length,
    /// Width of the cavity.
    pub width: Length,
    /// Speed of the seeding plate, counter-clockwise positive as the camera sees it.
    pub speed: AngularSpeed,
    /// Material of the seeding plate (rim and back).
    pub plate: String,
    /// Material of the front shell.
    pub front: String,
    /// Material of the seed protection board.
    pub board: String,
    /// Place of the lowest end of the board on the rim, from straight down, counter-clockwise
    /// positive.
    pub board_angle: Angle,
    /// Length of the board from the rim towards the axis.
    pub board_length: Length,
}

impl Metering {
    /// Direction from the axis to the lowest end of the board.
    fn outward(&self) -> Vector3<f64> {
        let angle = self.board_angle.si();
        Vector3::new(angle.sin(), -angle.cos(), 0.0)
    }

    /// The board: radial, over the whole width.
    fn board_shape(&self) -> Shape {
        let (radius, length) = (0.5 * self.inner_diameter.si(), self.board_length.si());
        Shape::Rectangle {
            centre: self.outward() * (radius - 0.5 * length),
            half_edges: [
                self.outward() * (0.5 * length),
                Vector3::z() * (0.5 * self.width.si()),
            ],
        }
    }

    /// Whether a ball is clear of the board, on the side to which the plate carries the seeds: they
    /// are filled in there, and the board keeps them from the other side.
    fn is_clear_of_board(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let outward = self.outward();
        if outward.cross(centre).z <= 0.0 {
            return false;
        }
        let inner = 0.5 * self.inner_diameter.si() - self.board_length.si();
        let along = centre.dot(&outward);
        let beside = (centre - outward * along).xy().norm();
        let before = (inner - along).max(0.0);
        beside * beside + before * before > radius * radius
    }

    /// Filling angle: from the lowest end of the board to the highest seed at the rim, rad.
    ///
    /// `at_rim` are the angles from straight down (counter-clockwise positive, rad) of the seeds
    /// that touch the rim. The highest point of the group is where the group ends: the first gap
    /// wider than `gap` (rad) when going up from the board.
    pub(crate) fn filling_angle(&self, at_rim: &[f64], gap: f64) -> f64 {
        let start = self.board_angle.si();
        let full = std::f64::consts::TAU;
        let mut ahead: Vec<f64> = at_rim
            .iter()
            .map(|a| (a - start).rem_euclid(full))
            .collect();
        ahead.sort_by(f64::total_cmp);
        let mut end = 0.0;
        for angle in ahead {
            if angle - end > gap {
                break;
            }
            end = angle;
        }
        end
    }
}

impl Device for Metering {
    fn materials(&self) -> Vec<&str> {
        vec![&self.plate, &self.front, &self.board]
    }

    fn check(&self) -> Result<(), Error> {
        let length = self.board_length.si();
        if length > 0.0 && length < 0.5 * self.inner_diameter.si() {
            return check_turned(self.inner_diameter, self.width);
        }
        Err(Error::BadValue {
            name: "apparatus.board_length".into(),
            value: self.board_length.to_string(),
            requirement: "above 0 and below the inner radius".into(),
        })
    }

    fn observables(&self) -> Vec<&str> {
        vec![
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
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        let (half, spin) = (0.5 * self.width.si(), self.speed.si());
        let radius = 0.5 * self.inner_diameter.si();
        let wall = |name: &str, shape, material: &String, spin| NamedWall {
            name: name.into(),
            shape,
            material: material.clone(),
            spin,
        };
        vec![
            wall("rim", Shape::Cylinder { radius }, &self.plate, spin),
            wall("plate", cover(-half), &self.plate, spin),
            wall("front shell", cover(half), &self.front, 0.0),
            wall("board", self.board_shape(), &self.board, 0.0),
        ]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        turned_room(self.radius(), self.width())
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        is_inside(centre, radius, self.radius(), self.width())
            && self.is_clear_of_board(centre, radius)
    }

    fn is_out_of_reach(&self, x: f64, y: f64, radius: f64) -> bool {
        x.hypot(y) + radius >= self.radius()
    }

    fn radius(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(std::f64::consts::PI * self.radius().powi(2) * self.width())
    }

    fn speed(&self) -> Option<AngularSpeed> {
        Some(self.speed)
    }

    fn set_speed(&mut self, speed: AngularSpeed) {
        self.speed = speed;
    }
}

#[cfg(test)]
mod tests {
    use super::Metering;
    use input::quantity::{Angle, AngularSpeed, Length};

    /// Seeds at every degree from 0 to 90 behind a board at -10: 100 degrees; a single seed
    /// carried to 150 is not part of the group.
    #[test]
    fn filling_angle_ends_at_the_first_gap() -> Result<(), input::quantity::Error> {
        let device = Metering {
            inner_diameter: Length::parse("180 mm")?,
            width: Length::parse("46 mm")?,
            speed: AngularSpeed::parse("10 rpm")?,
            plate: "a".into(),
            front: "b".into(),
            board: "b".into(),
            board_angle: Angle::parse("-10 deg")?,
            board_length: Length::parse("50 mm")?,
        };
        let mut at_rim: Vec<f64> = (-9..=90).map(|d| f64::from(d).to_radians()).collect();
        at_rim.push(150_f64.to_radians());
        let angle = device.filling_angle(&at_rim, 0.2).to_degrees();
        assert!((angle - 100.0).abs() < 1e-9, "{angle}");
        Ok(())
    }
}
