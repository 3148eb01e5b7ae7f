//! A ledge: a plate between two gates, over whose ends a bed is discharged, so that a heap stays on it.

use super::device::Device;
use super::heap::check_size;
use super::storeys::{Storeys, check_passage, discharge, discharge_curve};
use super::{NamedMesh, NamedWall};
use crate::curve::{CurveKind, DISCHARGE};
use crate::phases::{Plan, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use geometry::clump::Sphere;
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A plate y = 0 with an opening at each end, between sides that reach down to a floor below `[Zhou2002]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledge {
    /// Length of the plate.
    pub plate: Length,
    /// Width of the opening at each end of it.
    pub outlet: Length,
    /// Distance of front and back.
    pub width: Length,
    /// Height of the box above the plate.
    pub height: Length,
    /// Height of the plate above the floor.
    pub drop: Length,
    /// Material of all walls.
    pub wall: String,
}

impl Ledge {
    fn storeys(&self) -> Storeys<'_> {
        let (end, half) = (0.5 * self.plate.si(), self.radius());
        Storeys {
            half,
            half_depth: 0.5 * self.width.si(),
            drop: self.drop.si(),
            floor: vec![("plate", [-end, end])],
            gates: vec![[-half, -end], [end, half]],
            material: &self.wall,
        }
    }
}

impl Device for Ledge {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.plate", self.plate)?;
        check_size("apparatus.outlet", self.outlet)?;
        check_size("apparatus.width", self.width)?;
        check_size("apparatus.height", self.height)?;
        check_size("apparatus.drop", self.drop)
    }

    fn check_seeds(&self, _: &Scene, bodies: &[Arc<SeedBody>]) -> Result<(), Error> {
        check_passage(self.outlet, bodies)
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "angle_of_repose_deg",
            "angle_below_deg",
            "mass_flow_g_s",
            "discharged_share",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        self.storeys().walls()
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        vec![self.storeys().gate()]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let (half, depth) = (self.radius(), 0.5 * self.width.si());
        [
            Vector3::new(-half, 0.0, -depth),
            Vector3::new(half, self.height.si(), depth),
        ]
    }

    fn view(&self) -> [Vector3<f64>; 2] {
        let [low, high] = self.room();
        [low - Vector3::y() * self.drop.si(), high]
    }

    fn radius(&self) -> f64 {
        0.5 * self.plate.si() + self.outlet.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(2.0 * self.radius() * self.width.si() * self.height.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, scene: &Scene) -> Option<Plan> {
        Some(self.storeys().plan(scene.model.gravity_m_s2))
    }

    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        let storeys = self.storeys();
        let on = storeys.angles(spheres, (true, false), largest_radius);
        let below = storeys.angles(spheres, (false, true), largest_radius);
        vec![
            ObservableValues::new("angle_of_repose_deg", "deg", on),
            ObservableValues::new("angle_below_deg", "deg", below),
        ]
    }

    fn curve(&self) -> Option<CurveKind> {
        Some(DISCHARGE)
    }

    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        discharge_curve(seen)
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let mut all = self.read_pile(&seen.spheres(), seen.largest_radius());
        all.extend(discharge(seen));
        Ok(all)
    }
}
