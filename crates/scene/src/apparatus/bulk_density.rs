//! A cup that is overfilled, struck off and tapped.

use super::NamedMesh;
use super::device::Device;
use super::heap::check_size;
use super::shapes::{
    at_rest, between_circles, is_in_cylinder, of_equal_area, room_of_cylinder, within_prism,
};
use crate::check::bad;
use crate::phases::{End, Outlet, Phase, Plan, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use dem_solver::{Motion, Vibration};
use input::quantity::{Frequency, Length};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Volume of the seeds over that of the cup below which no bed fills it: loose beds have 0.5 or more.
const LEAST_SOLID: f64 = 0.5;
/// Time between samples, s.
const INTERVAL: f64 = 5e-3;

/// A round cup on y = 0 with a collar of the same height on it while it is filled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BulkDensity {
    /// Inner diameter.
    pub inner_diameter: Length,
    /// Height of the cup.
    pub height: Length,
    /// Number of taps; none if omitted.
    #[serde(default)]
    pub taps: u32,
    /// Height of a tap, from its lowest to its highest point; 3 mm, as in `[USP616]`, if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tap_height: Option<Length>,
    /// Taps in a second; 10 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tap_frequency: Option<Frequency>,
    /// Material of cup and collar.
    pub wall: String,
}

impl BulkDensity {
    /// Radius of the circle, m.
    fn circle(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }

    /// Taps in a second.
    fn frequency(&self) -> f64 {
        self.tap_frequency.map_or(10.0, Frequency::si)
    }
}

/// The refusal of seeds that do not fill the cup.
fn too_few(scene: &Scene) -> Error {
    bad(
        "number of seeds",
        scene.seed_count().to_string(),
        "enough to fill the cup above its rim; take more seeds or a smaller cup",
    )
}

impl Device for BulkDensity {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.inner_diameter", self.inner_diameter)?;
        check_size("apparatus.height", self.height)?;
        let frequency = self.frequency();
        if !(1.0..=100.0).contains(&frequency) {
            let requirement = "1 to 100 taps in a second";
            let value = format!("{frequency} 1/s");
            return Err(bad("apparatus.tap_frequency", value, requirement));
        }
        if self.taps > 10_000 {
            let value = self.taps.to_string();
            return Err(bad("apparatus.taps", value, "at most 10000"));
        }
        match self.tap_height {
            Some(height) if !(height.si() > 0.0 && height.si() <= 0.05) => Err(bad(
                "apparatus.tap_height",
                height.to_string(),
                "above 0, at most 50 mm",
            )),
            _ => Ok(()),
        }
    }

    /// Refuses seeds that cannot fill the cup however densely they pack.
    fn check_seeds(&self, scene: &Scene, _: &[Arc<SeedBody>]) -> Result<(), Error> {
        match scene.solid_share() {
            Some(solid) if solid < LEAST_SOLID => Err(too_few(scene)),
            _ => Ok(()),
        }
    }

    fn observables(&self) -> Vec<&str> {
        let mut all = vec!["bulk_density_kg_m3", "porosity"];
        if self.taps > 0 {
            all.extend(["tapped_density_kg_m3", "hausner_ratio"]);
        }
        all
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let (radius, height) = (of_equal_area(self.circle()), self.height.si());
        let mut cup = between_circles([0.0, 0.0], [radius, 0.0]);
        cup.extend(between_circles([radius, 0.0], [radius, height]));
        let collar = between_circles([radius, height], [radius, 2.0 * height]);
        vec![
            at_rest("cup", &self.wall, cup),
            at_rest("collar", &self.wall, collar),
        ]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        room_of_cylinder(self.circle(), 2.0 * self.height.si())
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        is_in_cylinder(
            (centre, radius),
            within_prism(of_equal_area(self.circle())),
            2.0 * self.height.si(),
        )
    }

    fn radius(&self) -> f64 {
        self.circle()
    }

    fn width(&self) -> f64 {
        self.inner_diameter.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(PI * self.circle().powi(2) * self.height.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, _: &Scene) -> Option<Plan> {
        let struck = Outlet {
            point: Vector3::y() * self.height.si(),
            normal: Vector3::y(),
        };
        let mut phases = vec![Phase {
            removed: vec!["collar".into()],
            outlets: vec![struck],
            ..Phase::named("strike off")
        }];
        if self.taps > 0 {
            let height = self.tap_height.map_or(3e-3, Length::si);
            let tapping = Motion {
                vibration: Some(Vibration {
                    amplitude: Vector3::y() * (0.5 * height),
                    angular_frequency: TAU * self.frequency(),
                }),
                ..Motion::default()
            };
            phases.push(Phase {
                motions: vec![("cup".into(), tapping)],
                end: End::After(f64::from(self.taps) / self.frequency()),
                ..Phase::named("tapping")
            });
            phases.push(Phase {
                motions: vec![("cup".into(), Motion::default())],
                ..Phase::named("rest")
            });
        }
        let mut plan = Plan::new(phases);
        plan.interval = INTERVAL;
        Some(plan)
    }

    /// # Formula
    ///
    /// Bulk density `m / V` with the mass in the struck cup and its volume. A bed of one density has its centre of mass at half of its
    /// height, so that tapping changes the density by `H = y_before / y_after`, the Hausner ratio, if no seed is lost.
    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let volume = self.bed_volume().unwrap_or(f64::NAN);
        let struck = seen.end_of("strike off");
        let filled = seen.end_of("filling");
        // Less than a full cup has no bulk density: nothing was struck off.
        let full = match (filled, struck) {
            (Some(filled), Some(struck)) => struck.mass < filled.mass,
            _ => false,
        };
        if !full {
            return Err(too_few(seen.scene));
        }
        let density = struck.map(|sample| sample.mass / volume);
        let solid = seen.solid_density();
        let hausner = struck
            .zip(seen.end_of("rest"))
            .map(|(before, after)| before.centre / after.centre);
        let value = |name, unit, value: Option<f64>| {
            ObservableValues::new(name, unit, value.into_iter().collect())
        };
        let tapped = density.zip(hausner).map(|(density, ratio)| density * ratio);
        Ok(vec![
            value("bulk_density_kg_m3", "kg/m3", density),
            value(
                "porosity",
                "1",
                density.map(|density| 1.0 - density / solid),
            ),
            value("tapped_density_kg_m3", "kg/m3", tapped),
            value("hausner_ratio", "1", hausner),
        ])
    }
}
