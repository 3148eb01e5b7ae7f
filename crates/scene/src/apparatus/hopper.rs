//! A hopper: seeds on a gate that is taken away.

use super::device::{Device, PeriodicSides};
use super::heap::check_size;
use super::shapes::{at_rest, between_circles, level, within_prism};
use super::storeys::check_passage;
use super::{NamedMesh, NamedWall, cover};
use crate::check::bad;
use crate::curve::{CurveKind, DISCHARGE, discharge};
use crate::phases::{End, Outlet, Phase, Plan, Sample, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use dem_solver::Shape;
use input::quantity::{Angle, Length};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Fractions of the discharged mass between which the flow counts as steady: our choice, clear of the start and of the last layers.
const STEADY: [f64; 2] = [0.2, 0.6];
/// Time between samples, s.
const INTERVAL: f64 = 5e-3;
/// Time before the gate is taken away over which the force on it is averaged, s.
const REST: f64 = 0.1;
/// Shortest time of a discharge, s: seeds above an open gate have then begun to fall.
const SHORTEST: f64 = 0.1;

/// Upright walls above a cone or a wedge; the opening is at y = 0, the axis of a round hopper is the y axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hopper {
    /// Inner diameter of the upright walls; of a slot, their distance across it.
    pub inner_diameter: Length,
    /// Distance of front and back along a slot; the hopper is round if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<Length>,
    /// Whether front and back of a slot are periodic sides, as if it had no end.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub periodic: bool,
    /// Diameter of the opening, or width of the slot.
    pub outlet: Length,
    /// Angle of cone or wedge with the vertical; 90 deg, a flat bottom, if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_angle: Option<Angle>,
    /// Height of the upright walls.
    pub height: Length,
    /// Material of all walls.
    pub wall: String,
}

impl Hopper {
    /// Half of the opening, m.
    fn opening(&self) -> f64 {
        0.5 * self.outlet.si()
    }

    /// Angle with the vertical, rad.
    fn angle(&self) -> f64 {
        self.half_angle.map_or(FRAC_PI_2, Angle::si)
    }

    /// Height of cone or wedge, m.
    fn lower_height(&self) -> f64 {
        let across = self.radius() - self.opening();
        // A level bottom is not left to the rounding of its tangent.
        if self.angle() >= FRAC_PI_2 {
            0.0
        } else {
            across / self.angle().tan()
        }
    }

    /// Half of the length of the walls along a slot, m: beyond periodic sides, so that a seed that passes stays at them.
    fn half_length_of_walls(&self) -> f64 {
        let half = 0.5 * self.width();
        if self.periodic { 2.0 * half } else { half }
    }

    /// Height of the upper rim, m.
    fn rim(&self) -> f64 {
        self.lower_height() + self.height.si()
    }
}

impl Device for Hopper {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.inner_diameter", self.inner_diameter)?;
        check_size("apparatus.height", self.height)?;
        if let Some(depth) = self.depth {
            check_size("apparatus.depth", depth)?;
        }
        if self.periodic && self.depth.is_none() {
            let requirement = "beside apparatus.depth: a round hopper has no plane sides";
            return Err(bad("apparatus.periodic", "true".into(), requirement));
        }
        if !(self.opening() > 0.0 && self.opening() < self.radius()) {
            let requirement = "above 0 and below apparatus.inner_diameter";
            return Err(bad(
                "apparatus.outlet",
                self.outlet.to_string(),
                requirement,
            ));
        }
        match self.half_angle {
            // A steeper cone is higher than ten of its diameters.
            Some(angle) if !(angle.si() >= 0.05 && angle.si() <= FRAC_PI_2) => Err(bad(
                "apparatus.half_angle",
                angle.to_string(),
                "3 to 90 deg with the vertical; leave it out for a flat bottom",
            )),
            _ => Ok(()),
        }
    }

    fn check_seeds(&self, _: &Scene, bodies: &[Arc<SeedBody>]) -> Result<(), Error> {
        check_passage(self.outlet, bodies)
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "mass_flow_g_s",
            "discharge_time_s",
            "left_behind_g",
            "bottom_load_share",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        let Some(depth) = self.depth else {
            return Vec::new();
        };
        let (half, radius) = (self.half_length_of_walls(), self.radius());
        let side = |sign: f64| Shape::Plane {
            point: Vector3::x() * (sign * radius),
            normal: Vector3::x() * -sign,
        };
        let bottom = |sign: f64| {
            let [inner, outer] = [
                Vector3::new(sign * self.opening(), 0.0, 0.0),
                Vector3::new(sign * radius, self.lower_height(), 0.0),
            ];
            Shape::Rectangle {
                centre: 0.5 * (inner + outer),
                half_edges: [0.5 * (outer - inner), Vector3::z() * half],
            }
        };
        let wall = |name: &str, shape| NamedWall {
            name: name.into(),
            shape,
            material: self.wall.clone(),
            spin: 0.0,
        };
        let mut walls = vec![wall("left side", side(-1.0)), wall("right side", side(1.0))];
        if !self.periodic {
            let half = 0.5 * depth.si();
            walls.push(wall("front side", cover(half)));
            walls.push(wall("back side", cover(-half)));
        }
        walls.push(wall("left bottom", bottom(-1.0)));
        walls.push(wall("right bottom", bottom(1.0)));
        walls
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let (opening, radius) = (self.opening(), self.radius());
        let mesh = |name, triangles| at_rest(name, &self.wall, triangles);
        match self.depth {
            Some(_) => {
                let half = self.half_length_of_walls();
                vec![mesh("gate", level([-opening, opening], 0.0, [-half, half]))]
            }
            None => vec![
                mesh("gate", between_circles([0.0, 0.0], [opening, 0.0])),
                mesh(
                    "bottom",
                    between_circles([opening, 0.0], [radius, self.lower_height()]),
                ),
                mesh(
                    "side",
                    between_circles([radius, self.lower_height()], [radius, self.rim()]),
                ),
            ],
        }
    }

    fn periodic_sides(&self) -> Option<PeriodicSides> {
        let sides = PeriodicSides::about_zero("apparatus.depth", self.width());
        self.periodic.then_some(sides)
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let (radius, half) = (self.radius(), 0.5 * self.width());
        [
            Vector3::new(-radius, 0.0, -half),
            Vector3::new(radius, self.rim(), half),
        ]
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        if centre.y <= radius || centre.y + radius >= self.rim() {
            return false;
        }
        let (across, outer) = match self.depth {
            Some(depth) if centre.z.abs() + radius >= 0.5 * depth.si() => return false,
            Some(_) => (centre.x.abs(), self.radius()),
            None => (centre.x.hypot(centre.z), within_prism(self.radius())),
        };
        if across + radius >= outer {
            return false;
        }
        let at_height = self.opening() + centre.y * self.angle().tan();
        let from_cone = (at_height - across) * self.angle().cos();
        centre.y - radius >= self.lower_height() || from_cone > radius
    }

    fn radius(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }

    fn width(&self) -> f64 {
        self.depth.unwrap_or(self.inner_diameter).si()
    }

    fn bed_volume(&self) -> Option<f64> {
        let (outer, inner) = (self.radius(), self.opening());
        let (low, high) = (self.lower_height(), self.height.si());
        Some(if let Some(depth) = self.depth {
            depth.si() * (2.0 * outer * high + (outer + inner) * low)
        } else {
            let squares = outer * outer + outer * inner + inner * inner;
            PI * (outer * outer * high + squares * low / 3.0)
        })
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, _: &Scene) -> Option<Plan> {
        let rest = Phase {
            end: End::After(REST),
            ..Phase::named("rest")
        };
        let discharge = Phase {
            removed: vec!["gate".into()],
            // Seeds that have fallen by the width of the opening act on no seed in it any more.
            outlets: vec![Outlet::below(-self.outlet.si())],
            end: End::AtRest { after: SHORTEST },
            ..Phase::named("discharge")
        };
        let mut plan = Plan::new(vec![rest, discharge]);
        plan.interval = INTERVAL;
        Some(plan)
    }

    fn curve(&self) -> Option<CurveKind> {
        Some(DISCHARGE)
    }

    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        discharge(seen, &seen.passages("discharge"))
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let passages = seen.passages("discharge");
        let value = |name, unit, value: Option<f64>| {
            ObservableValues::new(name, unit, value.into_iter().collect())
        };
        let share = |sample: &&Sample| {
            let bottom = ["gate", "bottom", "left bottom", "right bottom"];
            let weight = sample.mass * seen.scene.model.gravity_m_s2;
            -seen.force(sample, &bottom).y / weight
        };
        let shares: Vec<f64> = seen.samples("rest").iter().map(share).collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let share = (!shares.is_empty()).then_some(mean);
        let left = seen.end_of("discharge").map(|sample| 1e3 * sample.mass);
        Ok(vec![
            value(
                "mass_flow_g_s",
                "g/s",
                steady_flow(&passages).map(|f| 1e3 * f),
            ),
            value("discharge_time_s", "s", passages.last().map(|p| p[0])),
            value("left_behind_g", "g", left),
            value("bottom_load_share", "1", share),
        ])
    }
}

/// Mass flow (kg/s) of passages (time in s, mass in kg) in order of time, between two fractions of the whole mass; `None` of too few.
pub(super) fn steady_flow(passages: &[[f64; 2]]) -> Option<f64> {
    let all: f64 = passages.iter().map(|p| p[1]).sum();
    let mut sum = 0.0;
    let mut ends = [None; 2];
    for &[time, mass] in passages {
        sum += mass;
        for (end, share) in ends.iter_mut().zip(STEADY) {
            if end.is_none() && sum >= share * all {
                *end = Some([time, sum]);
            }
        }
    }
    let [[t0, m0], [t1, m1]] = [ends[0]?, ends[1]?];
    (t1 > t0).then(|| (m1 - m0) / (t1 - t0))
}

#[cfg(test)]
mod tests {
    use super::{Hopper, steady_flow};
    use crate::apparatus::Device;
    use input::quantity::{Angle, Length};
    use nalgebra::Vector3;

    /// A gram every 10 ms, behind a slow start and before a slow end: 100 g/s.
    #[test]
    fn the_flow_is_that_of_the_middle() {
        let at = |time: f64| [time, 1e-3];
        let start = (0..10).map(|k| at(0.1 * f64::from(k)));
        let middle = (0..80).map(|k| at(1.0 + 0.01 * f64::from(k)));
        let end = (0..10).map(|k| at(2.0 + 0.1 * f64::from(k)));
        let passages: Vec<_> = start.chain(middle).chain(end).collect();
        let flow = steady_flow(&passages).unwrap();
        assert!((flow - 0.1).abs() < 1e-9, "{flow} kg/s");
        assert_eq!(steady_flow(&passages[..1]), None);
    }

    /// A cone of 45 deg from 10 mm to 40 mm across is 15 mm high and has the volume `pi/3 (R² + R r + r²) h`; a ball of 3 mm has room where its
    /// distance from the cone, (5 + y - rho) cos 45 deg, exceeds its radius.
    #[test]
    fn a_cone_leaves_room_above_itself() {
        let hopper = Hopper {
            inner_diameter: Length::parse("40 mm").unwrap(),
            depth: None,
            periodic: false,
            outlet: Length::parse("10 mm").unwrap(),
            half_angle: Some(Angle::parse("45 deg").unwrap()),
            height: Length::parse("50 mm").unwrap(),
            wall: "glass".into(),
        };
        let cone = std::f64::consts::PI / 3.0 * (4e-4 + 1e-4 + 2.5e-5) * 0.015;
        let volume = hopper.bed_volume().unwrap() - std::f64::consts::PI * 4e-4 * 0.05;
        assert!((volume / cone - 1.0).abs() < 1e-9, "{volume} m3");
        let has_room = |x: f64, y: f64| hopper.has_room(&Vector3::new(x, y, 0.0), 3e-3);
        // (5 + 10 - x) / sqrt(2) = 3 at x = 10.757 mm.
        assert!(has_room(0.0107, 0.01) && !has_room(0.0108, 0.01));
        assert!(has_room(0.0, 0.0031) && !has_room(0.0, 0.0029), "gate");
        assert!(has_room(0.0169, 0.04) && !has_room(0.0171, 0.04), "side");
    }
}
