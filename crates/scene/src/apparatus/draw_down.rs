//! A draw-down box: seeds that fall through a slot in their floor on a second one, and leave two slopes above and a heap below.

use super::device::Device;
use super::heap::check_size;
use super::storeys::{Storeys, check_passage, discharge, discharge_curve};
use super::{NamedMesh, NamedWall};
use crate::check::bad;
use crate::curve::{CurveKind, DISCHARGE};
use crate::phases::{Plan, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use geometry::clump::Sphere;
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The upper floor y = 0 with its slot at x = 0, between sides that reach down to the lower floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawDown {
    /// Length of the box, across the slot.
    pub length: Length,
    /// Distance of front and back, along the slot.
    pub width: Length,
    /// Height of the upper box.
    pub height: Length,
    /// Width of the slot.
    pub outlet: Length,
    /// Height of the upper floor above the lower one.
    pub drop: Length,
    /// Material of all walls.
    pub wall: String,
}

impl DrawDown {
    fn storeys(&self) -> Storeys<'_> {
        let (half, opening) = (0.5 * self.length.si(), 0.5 * self.outlet.si());
        Storeys {
            half,
            half_depth: 0.5 * self.width.si(),
            drop: self.drop.si(),
            floor: vec![
                ("left bottom", [-half, -opening]),
                ("right bottom", [opening, half]),
            ],
            gates: vec![[-opening, opening]],
            material: &self.wall,
        }
    }
}

impl Device for DrawDown {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.length", self.length)?;
        check_size("apparatus.width", self.width)?;
        check_size("apparatus.height", self.height)?;
        check_size("apparatus.drop", self.drop)?;
        if self.outlet.si() > 0.0 && self.outlet.si() < self.length.si() {
            return Ok(());
        }
        let requirement = "above 0 and below apparatus.length";
        Err(bad(
            "apparatus.outlet",
            self.outlet.to_string(),
            requirement,
        ))
    }

    fn check_seeds(&self, _: &Scene, bodies: &[Arc<SeedBody>]) -> Result<(), Error> {
        check_passage(self.outlet, bodies)
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "shear_angle_deg",
            "angle_of_repose_deg",
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
        let (half, depth) = (0.5 * self.length.si(), 0.5 * self.width.si());
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
        0.5 * self.length.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(self.length.si() * self.width.si() * self.height.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, scene: &Scene) -> Option<Plan> {
        Some(self.storeys().plan(scene.model.gravity_m_s2))
    }

    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        let storeys = self.storeys();
        let above = storeys.angles(spheres, (true, true), largest_radius);
        let below = storeys.angles(spheres, (false, false), largest_radius);
        vec![
            ObservableValues::new("shear_angle_deg", "deg", above),
            ObservableValues::new("angle_of_repose_deg", "deg", below),
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

#[cfg(test)]
mod tests {
    use super::DrawDown;
    use crate::apparatus::Device;
    use geometry::clump::Sphere;
    use input::quantity::Length;
    use nalgebra::Vector3;

    /// Small spheres in two slopes of 35 deg that fall to the slot, and in a roof of 25 deg on the lower floor: each angle is read on its
    /// own floor, on both sides. Half a degree is the roughness of the spheres.
    #[test]
    fn slopes_above_and_heap_below_have_their_own_angles() {
        let length = |text: &str| Length::parse(text).expect("a length");
        let device = DrawDown {
            length: length("200 mm"),
            width: length("20 mm"),
            height: length("100 mm"),
            outlet: length("20 mm"),
            drop: length("80 mm"),
            wall: "acrylic".into(),
        };
        let (steep, flat) = (35_f64.to_radians().tan(), 25_f64.to_radians().tan());
        let mut spheres = Vec::new();
        for k in -99..=99_i32 {
            let x = f64::from(k) * 1e-3;
            let above = steep * (x.abs() - 0.01);
            let below = flat * (0.09 - x.abs());
            let heights = [(above, 0.0), (below, -0.08)];
            for (height, floor) in heights.into_iter().filter(|(h, _)| *h > 0.0) {
                spheres.push(Sphere {
                    centre: Vector3::new(x, floor + height, 0.0),
                    radius: 0.6e-3,
                });
            }
        }
        let read = device.read_pile(&spheres, 1e-3);
        for (values, expected) in read.iter().zip([35.0, 25.0]) {
            assert_eq!(values.values.len(), 2, "{values:?}");
            for angle in &values.values {
                assert!((angle - expected).abs() < 0.5, "{values:?}");
            }
        }
    }
}
