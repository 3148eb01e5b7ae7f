//! An oedometer: a bed in a rectangular cell under a piston that carries one stress after another.

use super::device::Device;
use super::heap::{check_size, floor};
use super::shapes::{at_rest, level};
use super::{NamedMesh, NamedWall, cover};
use crate::check::bad;
use crate::curve::CurveKind;
use crate::phases::{End, Phase, Plan, Seen};
use crate::{Error, ObservableValues, Scene};
use dem_solver::{AxialLoad, Motion, Shape};
use input::quantity::{Length, Pressure, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Time between samples, s.
const INTERVAL: f64 = 2e-3;
/// Mass of a loaded wall over that of all seeds: more than one layer, so that the contacts of the seeds rule the time step.
const WALL_OVER_BED: f64 = 0.5;
/// Time in which a loaded wall loses its speed, s.
const DAMPING_TIME: f64 = 5e-3;
/// Greatest speed of a loaded wall if the scene states none, m/s: half of that at which contacts count as hard.
pub(super) const GREATEST_SPEED: f64 = 0.2;

/// The cell from x = 0 to `length`, y = 0 upwards, z within half of `width`; the piston starts at `height`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compression {
    /// Length of the cell.
    pub length: Length,
    /// Width of the cell.
    pub width: Length,
    /// Height of the cell while it is filled.
    pub height: Length,
    /// Stresses on the piston, rising. From the last it goes back to the first.
    pub stresses: Vec<Pressure>,
    /// Greatest speed of the piston; 0.2 m/s if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub greatest_speed: Option<Speed>,
    /// Material of the cell.
    pub wall: String,
    /// Material of the piston.
    pub piston: String,
}

impl Compression {
    /// Height of the piston at the end of a phase, m; `None` if the run did not come so far.
    fn height_at_end(&self, seen: &Seen<'_>, phase: &str) -> Option<f64> {
        let sample = seen.end_of(phase)?;
        Some(self.height.si() + seen.displacement(sample, "piston").y)
    }

    /// Cross-section, m².
    fn area(&self) -> f64 {
        self.length.si() * self.width.si()
    }

    /// Names of the phases of loading, with their stresses, Pa.
    fn loading(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let stresses = self.stresses.iter().enumerate();
        stresses.map(|(k, stress)| (format!("load {k}"), stress.si()))
    }
}

/// Motion of a wall that presses along a unit vector with a force (N) on a bed of a mass (kg).
pub(super) fn pressing(axis: Vector3<f64>, force: f64, bed: f64, greatest_speed: f64) -> Motion {
    Motion {
        load: Some(AxialLoad {
            axis,
            force,
            mass: WALL_OVER_BED * bed,
            damping_time: DAMPING_TIME,
            greatest_speed,
        }),
        ..Motion::default()
    }
}

/// Refuses stresses that are not positive, or that do not rise.
pub(super) fn check_stresses(name: &str, stresses: &[Pressure]) -> Result<(), Error> {
    let mut below = 0.0;
    for stress in stresses {
        if !(stress.si() > below && stress.si() <= 1e9) {
            let requirement = "above 0, above the one before, and at most 1 GPa";
            return Err(bad(name, stress.to_string(), requirement));
        }
        below = stress.si();
    }
    Ok(())
}

/// Refuses a speed of a loaded wall that is not positive, or so high that it hits the seeds hard.
pub(super) fn check_greatest_speed(speed: Option<Speed>) -> Result<(), Error> {
    match speed {
        Some(speed) if !(speed.si() > 0.0 && speed.si() <= 0.5) => Err(bad(
            "apparatus.greatest_speed",
            speed.to_string(),
            "above 0, at most 0.5 m/s",
        )),
        _ => Ok(()),
    }
}

impl Device for Compression {
    fn materials(&self) -> Vec<&str> {
        vec![&self.wall, &self.piston]
    }

    fn check(&self) -> Result<(), Error> {
        check_size("apparatus.length", self.length)?;
        check_size("apparatus.width", self.width)?;
        check_size("apparatus.height", self.height)?;
        if self.stresses.len() < 2 || self.stresses.len() > 100 {
            let value = format!("{} values", self.stresses.len());
            let requirement = "2 to 100 values: a modulus needs two stresses";
            return Err(bad("apparatus.stresses", value, requirement));
        }
        check_stresses("apparatus.stresses", &self.stresses)?;
        check_greatest_speed(self.greatest_speed)
    }

    fn observables(&self) -> Vec<&str> {
        vec![
            "strain",
            "loading_modulus_kpa",
            "unloading_modulus_kpa",
            "wall_stress_ratio",
            "bottom_load_share",
        ]
    }

    fn walls(&self) -> Vec<NamedWall> {
        let half = 0.5 * self.width.si();
        let wall = |name: &str, shape| NamedWall {
            name: name.into(),
            shape,
            material: self.wall.clone(),
            spin: 0.0,
        };
        let end = |x: f64, sign: f64| Shape::Plane {
            point: Vector3::x() * x,
            normal: Vector3::x() * sign,
        };
        vec![
            floor(&self.wall),
            wall("left end", end(0.0, 1.0)),
            wall("right end", end(self.length.si(), -1.0)),
            wall("front side", cover(half)),
            wall("back side", cover(-half)),
        ]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let half = 0.5 * self.width.si();
        let plate = level([0.0, self.length.si()], self.height.si(), [-half, half]);
        vec![at_rest("piston", &self.piston, plate)]
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        let half = 0.5 * self.width.si();
        [
            Vector3::new(0.0, 0.0, -half),
            Vector3::new(self.length.si(), self.height.si(), half),
        ]
    }

    fn radius(&self) -> f64 {
        0.5 * self.length.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(self.area() * self.height.si())
    }

    fn greatest_stress(&self) -> f64 {
        self.stresses.last().map_or(0.0, |stress| stress.si())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn plan(&self, scene: &Scene) -> Option<Plan> {
        let (bed, speed) = (
            scene.seed_mass(),
            self.greatest_speed.map_or(GREATEST_SPEED, Speed::si),
        );
        let press = |name: String, stress: f64| Phase {
            motions: vec![(
                "piston".into(),
                pressing(-Vector3::y(), stress * self.area(), bed, speed),
            )],
            // The piston must have begun to move before rest can mean anything.
            end: End::AtRest {
                after: 10.0 * INTERVAL,
            },
            ..Phase::named(&name)
        };
        let mut phases: Vec<_> = self.loading().map(|(name, s)| press(name, s)).collect();
        phases.push(press("unload".into(), self.stresses.first()?.si()));
        let mut plan = Plan::new(phases);
        plan.interval = INTERVAL;
        Some(plan)
    }

    fn curve(&self) -> Option<CurveKind> {
        Some(CurveKind {
            name: "compression",
            along: "stress_kpa",
            values: &["strain"],
            is_kept: false,
        })
    }

    /// Strain at rest under each stress of the loading, 0 under the first.
    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        let height = |phase: &str| self.height_at_end(seen, phase);
        let first = self.loading().next().and_then(|(phase, _)| height(&phase));
        let row = |(phase, stress): (String, f64)| {
            Some(vec![1e-3 * stress, 1.0 - height(&phase)? / first?])
        };
        self.loading().filter_map(row).collect()
    }

    /// # Formula
    ///
    /// With the heights h of the piston at rest under the first (1) and the last two stresses (m, n), and after unloading (u):
    /// strain `1 - h_n/h_1`; loading modulus `(s_n - s_m) h_1 / (h_m - h_n)`; unloading modulus `(s_n - s_1) h_1 / (h_u - h_n)`, both of
    /// one-dimensional strain. The stress ratio is the mean stress on the four sides over that on the piston.
    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let height = |phase: &str| self.height_at_end(seen, phase);
        let loads: Vec<_> = self.loading().collect();
        let (first, last) = (&loads[0], &loads[loads.len() - 1]);
        let before = &loads[loads.len() - 2];
        let start = height(&first.0);
        let end = height(&last.0);
        let strain = start.zip(end).map(|(start, end)| 1.0 - end / start);
        let modulus = |from: Option<f64>, stress: f64| {
            let compressed = from? - end?;
            (compressed > 0.0).then_some(1e-3 * stress * start? / compressed)
        };
        let loading = modulus(height(&before.0), last.1 - before.1);
        let unloading = modulus(height("unload"), last.1 - first.1);
        let sides = seen.end_of(&last.0).zip(end).map(|(sample, end)| {
            let force = |name: &str| seen.force(sample, &[name]);
            let across = force("right end").x - force("left end").x;
            let along = force("front side").z - force("back side").z;
            let area = 2.0 * (self.length.si() + self.width.si()) * end;
            let piston = seen.force(sample, &["piston"]).y / self.area();
            (across + along) / area / piston
        });
        let bottom = seen.end_of(&last.0).map(|sample| {
            let weight = sample.mass * seen.scene.model.gravity_m_s2;
            let piston = seen.force(sample, &["piston"]).y;
            -seen.force(sample, &["floor"]).y / (piston + weight)
        });
        let value = |name, unit, value: Option<f64>| {
            ObservableValues::new(name, unit, value.into_iter().collect())
        };
        Ok(vec![
            value("strain", "1", strain),
            value("loading_modulus_kpa", "kPa", loading),
            value("unloading_modulus_kpa", "kPa", unloading),
            value("wall_stress_ratio", "1", sides),
            value("bottom_load_share", "1", bottom),
        ])
    }
}
