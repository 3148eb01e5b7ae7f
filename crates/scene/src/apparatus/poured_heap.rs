//! A heap that seeds build as they are poured on a floor or a disc.

use super::device::Device;
use super::heap::{check_size, floor};
use super::shapes::{at_rest, between_circles, of_equal_area};
use super::{NamedMesh, NamedWall};
use crate::check::bad;
use crate::factory::lowest_place;
use crate::outline::read_round_heap;
use crate::phases::{Outlet, Phase, Plan, Seen};
use crate::picture::heap_angles;
use crate::{Error, ObservableValues, Scene};
use geometry::clump::Sphere;
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Height over width of the region in which the seeds appear.
const INLET: f64 = 2.0;

/// A floor y = 0, or a disc at that height whose edge seeds fall over, below an inlet on the y axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PouredHeap {
    /// Diameter of the inlet, in which seeds appear at random places at `protocol.insertion_rate`.
    pub inlet: Length,
    /// Height of the inlet above the floor.
    pub fall_height: Length,
    /// Diameter of a disc; an endless floor if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disc: Option<Length>,
    /// Material of floor or disc.
    pub floor: String,
}

impl Device for PouredHeap {
    fn materials(&self) -> Vec<&str> {
        vec![&self.floor]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.inlet", self.inlet)?;
        check_size("apparatus.fall_height", self.fall_height)?;
        if let Some(disc) = self.disc {
            check_size("apparatus.disc", disc)?;
            if disc.si() < self.inlet.si() {
                let requirement = "at least as wide as apparatus.inlet";
                return Err(bad("apparatus.disc", disc.to_string(), requirement));
            }
        }
        Ok(())
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "angle_of_repose_deg",
            "angle_by_position_deg",
            "height_mm",
            "base_radius_mm",
            "heap_mass_g",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        match self.disc {
            Some(_) => Vec::new(),
            None => vec![floor(&self.floor)],
        }
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let disc = self.disc.map(|disc| {
            let radius = of_equal_area(0.5 * disc.si());
            let triangles = between_circles([0.0, 0.0], [radius, 0.0]);
            at_rest("disc", &self.floor, triangles)
        });
        disc.into_iter().collect()
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let (radius, low) = (0.5 * self.inlet.si(), self.fall_height.si());
        [
            Vector3::new(-radius, low, -radius),
            Vector3::new(radius, low + INLET * self.inlet.si(), radius),
        ]
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let [low, high] = self.room();
        centre.x.hypot(centre.z) + radius < high.x
            && centre.y - radius > low.y
            && centre.y + radius < high.y
    }

    fn radius(&self) -> f64 {
        // On an endless floor a heap is hardly wider than the height from which it was poured.
        match self.disc {
            Some(disc) => 0.5 * disc.si(),
            None => self.fall_height.si(),
        }
    }

    fn width(&self) -> f64 {
        2.0 * self.radius()
    }

    fn needs_insertion_rate(&self) -> bool {
        true
    }

    fn inlet(&self) -> Option<[f64; 3]> {
        let [low, high] = self.room();
        Some([high.x, lowest_place(low.y, high.y), high.y])
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, _: &Scene) -> Option<Plan> {
        let mut plan = Plan::new(vec![Phase::named("rest")]);
        if self.disc.is_some() {
            // Far enough below the disc that a seed is not taken out while it hangs on its edge.
            let outlet = Outlet::below(-0.5 * self.inlet.si());
            for phase in &mut plan.phases {
                phase.outlets = vec![outlet];
            }
        }
        Some(plan)
    }

    fn is_photographed(&self) -> bool {
        true
    }

    fn leaves_a_heap(&self) -> bool {
        true
    }

    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        let mut all = read_round_heap(spheres, largest_radius);
        for values in &mut all {
            if values.name == "angle_of_repose_deg" {
                values.name = "angle_by_position_deg".into();
            }
        }
        all
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let mut all = self.read_pile(&seen.spheres(), seen.largest_radius());
        let angles = heap_angles(seen.scene, seen.bodies, seen.frame)?;
        let degrees = angles.into_iter().map(f64::to_degrees).collect();
        all.push(ObservableValues::new("angle_of_repose_deg", "deg", degrees));
        let mass = seen.end_of("rest").map(|sample| 1e3 * sample.mass);
        let mass = mass.into_iter().collect();
        all.push(ObservableValues::new("heap_mass_g", "g", mass));
        Ok(all)
    }
}
