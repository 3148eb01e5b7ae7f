//! A box whose gate is lifted, so that the seeds run out over the floor.

use super::device::Device;
use super::heap::{check_lift, check_size, floor};
use super::{NamedMesh, NamedWall, cover};
use crate::outline::read_run_out;
use crate::phases::{End, Phase, Plan};
use crate::{Error, ObservableValues, Scene};
use dem_solver::{Motion, Shape};
use geometry::clump::Sphere;
use input::quantity::{Length, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The box from x = 0 to `length`, its floor y = 0, its sides at plus and minus half of `width`. The
/// gate closes it at x = `length`; the sides and the floor continue behind the gate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxCollapse {
    /// Length of the box.
    pub length: Length,
    /// Height of the gate.
    pub height: Length,
    /// Distance of the sides.
    pub width: Length,
    /// Speed at which the gate is lifted, once the seeds rest.
    pub lift_speed: Speed,
    /// Material of the floor.
    pub floor: String,
    /// Material of back, sides and gate.
    pub wall: String,
}

impl BoxCollapse {
    /// The gate, lifted when the drive runs.
    fn gate_mesh(&self) -> NamedMesh {
        let (x, height, half) = (self.length.si(), self.height.si(), 0.5 * self.width.si());
        let at = |y: f64, z: f64| Vector3::new(x, y, z);
        let [a, b, c, d] = [
            at(0.0, -half),
            at(0.0, half),
            at(height, half),
            at(height, -half),
        ];
        NamedMesh {
            name: "gate".into(),
            triangles: vec![[a, b, c], [a, c, d]],
            material: self.wall.clone(),
            motion: Motion {
                velocity: Vector3::y() * self.lift_speed.si(),
                ..Motion::default()
            },
        }
    }
}

impl Device for BoxCollapse {
    fn materials(&self) -> Vec<&str> {
        vec![&self.floor, &self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.length", self.length)?;
        check_size("apparatus.height", self.height)?;
        check_size("apparatus.width", self.width)?;
        check_lift("apparatus.lift_speed", self.lift_speed)
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "angle_of_repose_deg",
            "height_mm",
            "runout_mm",
            "length_mm",
            "toe_angle_deg",
            "top_angle_deg",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        let half = 0.5 * self.width.si();
        let back = Shape::Plane {
            point: Vector3::zeros(),
            normal: Vector3::x(),
        };
        let wall = |name: &str, shape| NamedWall {
            name: name.into(),
            shape,
            material: self.wall.clone(),
            spin: 0.0,
        };
        vec![
            floor(&self.floor),
            wall("back", back),
            wall("front side", cover(half)),
            wall("back side", cover(-half)),
        ]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        vec![self.gate_mesh()]
    }

    fn radius(&self) -> f64 {
        0.5 * self.length.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(self.length.si() * self.height.si() * self.width.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, _: &Scene) -> Option<Plan> {
        // The wall must be out of the way before rest can mean anything.
        let lifted = self.height.si() / self.lift_speed.si();
        let motion = self.gate_mesh().motion;
        Some(Plan::new(vec![Phase {
            motions: vec![("gate".into(), motion)],
            end: End::AtRest { after: lifted },
            ..Phase::named("release")
        }]))
    }

    fn leaves_a_heap(&self) -> bool {
        true
    }

    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        read_run_out(spheres, largest_radius)
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let half = 0.5 * self.width.si();
        [
            Vector3::new(0.0, 0.0, -half),
            Vector3::new(self.length.si(), self.height.si(), half),
        ]
    }
}
