//! A shear box: its lower half moves under the upper half and a lid that carries a normal stress.

use super::compression::{GREATEST_SPEED, check_greatest_speed, check_stresses, pressing};
use super::device::Device;
use super::heap::check_size;
use super::shapes::{at_rest, level, upright};
use super::{NamedMesh, NamedWall, cover};
use crate::check::bad;
use crate::curve::CurveKind;
use crate::phases::{End, Phase, Plan, Sample, Seen};
use crate::{Error, ObservableValues, Scene};
use dem_solver::Motion;
use input::quantity::{Length, Pressure, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Time between samples, s.
const INTERVAL: f64 = 2e-3;
/// Fraction of the displacement over which a stress is averaged for its peak.
const WINDOW: f64 = 0.05;
/// Fraction of the displacement after which the stress counts as steady.
const STEADY_FROM: f64 = 2.0 / 3.0;
/// Greatest displacement over the length of the box.
const LONGEST: f64 = 0.5;

/// The box from x = 0 to `length`, z within half of `width`, sheared at half of `height`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectShear {
    /// Length of the box along the shear.
    pub length: Length,
    /// Width of the box.
    pub width: Length,
    /// Height of the box while it is filled; the lid starts there.
    pub height: Length,
    /// Height of the plane of shear.
    pub shear_height: Length,
    /// Normal stress on the lid before the shear.
    pub normal_stress: Pressure,
    /// Speed of the lower half.
    pub speed: Speed,
    /// Displacement of the lower half at the end.
    pub displacement: Length,
    /// Material of box and lid.
    pub wall: String,
}

impl DirectShear {
    /// Shear stress and normal stress in a sample, Pa: the forces on upper half and lid over the area that both halves share.
    fn stresses(&self, seen: &Seen<'_>, sample: &Sample) -> [f64; 2] {
        let moved = seen.displacement(sample, "lower half").x;
        let area = (self.length.si() - moved) * self.width.si();
        let lid = seen.force(sample, &["lid"]);
        let shear = seen.force(sample, &["upper half"]).x + lid.x;
        [shear / area, lid.y / area]
    }
}

impl Device for DirectShear {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.length", self.length)?;
        check_size("apparatus.width", self.width)?;
        check_size("apparatus.height", self.height)?;
        check_stresses("apparatus.normal_stress", &[self.normal_stress])?;
        check_greatest_speed(Some(self.speed))?;
        let plane = self.shear_height.si();
        if !(plane > 0.0 && plane < self.height.si()) {
            let requirement = "above 0 and below apparatus.height";
            let value = self.shear_height.to_string();
            return Err(bad("apparatus.shear_height", value, requirement));
        }
        let moved = self.displacement.si();
        if !(moved > 0.0 && moved <= LONGEST * self.length.si()) {
            let requirement = "above 0, at most half of apparatus.length";
            let value = self.displacement.to_string();
            return Err(bad("apparatus.displacement", value, requirement));
        }
        Ok(())
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "peak_shear_stress_kpa",
            "steady_shear_stress_kpa",
            "steady_stress_ratio",
            "dilation_mm",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        let half = 0.5 * self.width.si();
        let wall = |name: &str, z| NamedWall {
            name: name.into(),
            shape: cover(z),
            material: self.wall.clone(),
            spin: 0.0,
        };
        vec![wall("front side", half), wall("back side", -half)]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let (length, height, half) = (self.length.si(), self.height.si(), 0.5 * self.width.si());
        let (plane, moved) = (self.shear_height.si(), self.displacement.si());
        let across = [-half, half];
        // Each half has a flange that covers the other where it is left open.
        let mut lower = level([0.0, length], 0.0, across);
        lower.extend(upright(0.0, [0.0, plane], across));
        lower.extend(upright(length, [0.0, plane], across));
        lower.extend(level([-moved, 0.0], plane, across));
        let mut upper = upright(0.0, [plane, height], across);
        upper.extend(upright(length, [plane, height], across));
        upper.extend(level([length, length + moved], plane, across));
        let lid = level([0.0, length], height, across);
        vec![
            at_rest("lower half", &self.wall, lower),
            at_rest("upper half", &self.wall, upper),
            at_rest("lid", &self.wall, lid),
        ]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let half = 0.5 * self.width.si();
        [
            Vector3::new(0.0, 0.0, -half),
            Vector3::new(self.length.si(), self.height.si(), half),
        ]
    }

    fn view(&self) -> [Vector3<f64>; 2] {
        let [low, high] = self.room();
        [low, high + Vector3::x() * self.displacement.si()]
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

    fn greatest_stress(&self) -> f64 {
        self.normal_stress.si()
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, scene: &Scene) -> Option<Plan> {
        let force = self.normal_stress.si() * self.length.si() * self.width.si();
        let lid = pressing(-Vector3::y(), force, scene.seed_mass(), GREATEST_SPEED);
        let drive = Motion {
            velocity: Vector3::x() * self.speed.si(),
            ..Motion::default()
        };
        let mut plan = Plan::new(vec![
            Phase {
                motions: vec![("lid".into(), lid)],
                end: End::AtRest {
                    after: 10.0 * INTERVAL,
                },
                ..Phase::named("load")
            },
            Phase {
                motions: vec![("lower half".into(), drive)],
                end: End::After(self.displacement.si() / self.speed.si()),
                ..Phase::named("shear")
            },
        ]);
        plan.interval = INTERVAL;
        Some(plan)
    }

    fn curve(&self) -> Option<CurveKind> {
        Some(CurveKind {
            name: "shear",
            along: "displacement_mm",
            values: &["shear_stress_kpa"],
            is_kept: false,
        })
    }

    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        let row = |sample: &Sample| {
            let moved = seen.displacement(sample, "lower half").x;
            let [shear, _] = self.stresses(seen, sample);
            vec![1e3 * moved, 1e-3 * shear]
        };
        seen.samples("shear").into_iter().map(row).collect()
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let samples = seen.samples("shear");
        let stresses: Vec<_> = samples.iter().map(|s| self.stresses(seen, s)).collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "fractions of a length"
        )]
        let part = |share: f64| (share * stresses.len() as f64).ceil() as usize;
        let mean = |part: &[[f64; 2]]| {
            let sums = part
                .iter()
                .fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]);
            sums.map(|sum| sum / part.len() as f64)
        };
        let windows = stresses.windows(part(WINDOW).max(1)).map(|w| mean(w)[0]);
        let peak = windows.reduce(f64::max);
        let steady = &stresses[part(STEADY_FROM).min(stresses.len())..];
        let steady = (!steady.is_empty()).then(|| mean(steady));
        let rise = seen
            .end_of("load")
            .zip(samples.last())
            .map(|(before, end)| {
                let lid = |sample| seen.displacement(sample, "lid").y;
                1e3 * (lid(end) - lid(before))
            });
        let value = |name, unit, value: Option<f64>| {
            ObservableValues::new(name, unit, value.into_iter().collect())
        };
        Ok(vec![
            value("peak_shear_stress_kpa", "kPa", peak.map(|s| 1e-3 * s)),
            value(
                "steady_shear_stress_kpa",
                "kPa",
                steady.map(|s| 1e-3 * s[0]),
            ),
            value("steady_stress_ratio", "1", steady.map(|s| s[0] / s[1])),
            value("dilation_mm", "mm", rise),
        ])
    }
}
