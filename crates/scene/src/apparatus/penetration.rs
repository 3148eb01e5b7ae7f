//! A probe that is pressed into a bed in a round cup.

use super::device::Device;
use super::heap::{check_size, floor};
use super::shapes::{
    at_rest, between_circles, is_in_cylinder, of_equal_area, room_of_cylinder, within_prism,
};
use super::{NamedMesh, NamedWall};
use crate::check::bad;
use crate::curve::CurveKind;
use crate::phases::{End, Phase, Plan, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use dem_solver::Motion;
use input::quantity::{Angle, Length, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Time between samples, s.
const INTERVAL: f64 = 2e-3;
/// Fraction of the depth at its end over which the force is averaged.
const END: f64 = 0.1;

/// A cup on y = 0; the probe starts at its rim with its lowest point on the y axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Penetration {
    /// Inner diameter of the cup.
    pub inner_diameter: Length,
    /// Height of the cup.
    pub height: Length,
    /// Diameter of the probe.
    pub probe_diameter: Length,
    /// Angle of a conical probe with the vertical; 90 deg, a flat probe, if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_angle: Option<Angle>,
    /// Speed of the probe downwards.
    pub speed: Speed,
    /// Depth at the end, from the first contact.
    pub depth: Length,
    /// Material of the cup.
    pub wall: String,
    /// Material of the probe.
    pub probe: String,
}

impl Penetration {
    /// Radius of the cup, m.
    fn circle(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }
}

/// Depths (m) since the bed first pushed the probe up, and the forces (N) there.
fn pressed(seen: &Seen<'_>) -> Vec<[f64; 2]> {
    let force = |sample| seen.force(sample, &["probe"]).y;
    let depth = |sample| -seen.displacement(sample, "probe").y;
    let samples = seen.samples("penetration").into_iter();
    let touched = samples.skip_while(|sample| force(sample) <= 0.0);
    let pressed: Vec<_> = touched.map(|s| [depth(s), force(s)]).collect();
    let start = pressed.first().map_or(0.0, |first| first[0]);
    let from_start = pressed.into_iter().map(|[d, f]| [d - start, f]);
    from_start.collect()
}

impl Device for Penetration {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall, &self.probe]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.inner_diameter", self.inner_diameter)?;
        check_size("apparatus.height", self.height)?;
        check_size("apparatus.probe_diameter", self.probe_diameter)?;
        if self.probe_diameter.si() >= self.inner_diameter.si() {
            let requirement = "below apparatus.inner_diameter";
            let value = self.probe_diameter.to_string();
            return Err(bad("apparatus.probe_diameter", value, requirement));
        }
        if let Some(angle) = self.half_angle
            && !(angle.si() >= 0.1 && angle.si() <= FRAC_PI_2)
        {
            let requirement = "6 to 90 deg; leave it out for a flat probe";
            return Err(bad("apparatus.half_angle", angle.to_string(), requirement));
        }
        if !(self.depth.si() > 0.0 && self.depth.si() < self.height.si()) {
            let requirement = "above 0 and below apparatus.height";
            return Err(bad("apparatus.depth", self.depth.to_string(), requirement));
        }
        if !(self.speed.si() > 0.0 && self.speed.si() <= 0.5) {
            let requirement = "above 0, at most 0.5 m/s";
            return Err(bad("apparatus.speed", self.speed.to_string(), requirement));
        }
        Ok(())
    }

    /// Refuses a probe that cannot come down within the limit of a phase.
    fn check_seeds(&self, scene: &Scene, _: &[Arc<SeedBody>]) -> Result<(), Error> {
        let limit = scene.protocol.rotation_limit.si();
        if self.height.si() / self.speed.si() <= limit {
            return Ok(());
        }
        let requirement = format!(
            "fast enough for the height of the cup within protocol.rotation_limit, {limit} s; raise one of them"
        );
        Err(bad("apparatus.speed", self.speed.to_string(), &requirement))
    }

    fn observables(&self) -> Vec<&str> {
        vec!["penetration_force_n", "penetration_energy_mj"]
    }

    fn walls(&self) -> Vec<NamedWall> {
        vec![floor(&self.wall)]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let (radius, height) = (of_equal_area(self.circle()), self.height.si());
        let cup = between_circles([radius, 0.0], [radius, height]);
        let outer = of_equal_area(0.5 * self.probe_diameter.si());
        // A flat probe is not left to the rounding of a tangent.
        let tip = self.half_angle.map_or(0.0, |angle| {
            if angle.si() < FRAC_PI_2 {
                outer / angle.si().tan()
            } else {
                0.0
            }
        });
        let mut probe = between_circles([0.0, height], [outer, height + tip]);
        let shaft = height + tip + self.depth.si();
        probe.extend(between_circles([outer, height + tip], [outer, shaft]));
        vec![
            at_rest("cup", &self.wall, cup),
            at_rest("probe", &self.probe, probe),
        ]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        room_of_cylinder(self.circle(), self.height.si())
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        is_in_cylinder(
            (centre, radius),
            within_prism(of_equal_area(self.circle())),
            self.height.si(),
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
        let down = Motion {
            velocity: -Vector3::y() * self.speed.si(),
            ..Motion::default()
        };
        let mut plan = Plan::new(vec![Phase {
            motions: vec![("probe".into(), down)],
            end: End::Pressed {
                wall: "probe".into(),
                depth: self.depth.si(),
            },
            ..Phase::named("penetration")
        }]);
        plan.interval = INTERVAL;
        Some(plan)
    }

    /// # Formula
    ///
    /// From the first contact: the mean force over the last tenth of the depth, and the work `sum of F v dt`.
    fn curve(&self) -> Option<CurveKind> {
        Some(CurveKind {
            name: "penetration",
            along: "depth_mm",
            values: &["force_n"],
            is_kept: false,
        })
    }

    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        let rows = pressed(seen).into_iter();
        rows.map(|[depth, force]| vec![1e3 * depth, force])
            .collect()
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let pressed = pressed(seen);
        let end = (1.0 - END) * self.depth.si();
        let last = pressed.iter().filter(|[depth, _]| *depth >= end);
        let last: Vec<f64> = last.map(|[_, force]| *force).collect();
        let mean = (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64);
        let work = pressed.windows(2).map(|pair| {
            let [[d0, f0], [d1, f1]] = [pair[0], pair[1]];
            0.5 * (f0 + f1) * (d1 - d0)
        });
        let work = mean.map(|_| 1e3 * work.sum::<f64>());
        let value = |name, unit, value: Option<f64>| {
            ObservableValues::new(name, unit, value.into_iter().collect())
        };
        Ok(vec![
            value("penetration_force_n", "N", mean),
            value("penetration_energy_mj", "mJ", work),
        ])
    }
}
