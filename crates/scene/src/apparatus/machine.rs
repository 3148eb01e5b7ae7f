//! A machine: an apparatus that the scene file describes by walls, phases and probes.

mod phase;
mod probe;
mod wall;

use phase::MachinePhase;
use probe::Probe;
use wall::MachineWall;

use super::compression::GREATEST_SPEED;
use super::device::{Device, PeriodicSides};
use super::{NamedMesh, NamedWall};
use crate::check::bad;
use crate::curve::{CurveKind, DISCHARGE, discharge};
use crate::phases::{Plan, Seen};
use crate::{Error, ObservableValues, Scene};
use input::quantity::{Length, Time};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Time between samples if the scene states none, s.
const INTERVAL: f64 = 2e-3;
/// Time of which the time between samples is a part, s.
const WHOLE: f64 = 0.02;

/// An apparatus of the user's own. The y axis points upwards; seeds begin in a box, settle, and the phases follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Lower and upper corner of the box in which seeds begin; a fill level is a share of its volume.
    pub room: [[Length; 3]; 2],
    /// Whether the lower and the upper z of the room are periodic sides, as if the machine went on beyond them without end.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub periodic: bool,
    /// Lower and upper corner of the box that the picture shows; the room if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<[[Length; 3]; 2]>,
    /// Time between two samples of the probes; 2 ms if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample_interval: Option<Time>,
    /// Walls.
    #[serde(default)]
    pub wall: Vec<MachineWall>,
    /// What is done to the bed once it has settled.
    pub phase: Vec<MachinePhase>,
    /// What is read.
    pub probe: Vec<Probe>,
}

/// A point of the file, m.
fn point(coordinates: &[Length; 3]) -> Vector3<f64> {
    Vector3::from(coordinates.map(Length::si))
}

/// A unit vector along a direction of the file.
fn unit(name: &str, direction: [f64; 3]) -> Result<Vector3<f64>, Error> {
    let refused = || {
        bad(
            name,
            format!("{direction:?}"),
            "a direction, such as [0, -1, 0]",
        )
    };
    let vector = Vector3::from(direction);
    let unit = vector.try_normalize(1e-9).ok_or_else(refused)?;
    unit.iter()
        .all(|c| c.is_finite())
        .then_some(unit)
        .ok_or_else(refused)
}

/// Refuses a box whose upper corner is not above the lower one in each coordinate.
fn check_box(name: &str, corners: &[[Length; 3]; 2]) -> Result<(), Error> {
    let [low, high] = corners;
    for k in 0..3 {
        if !(high[k].si() > low[k].si() && high[k].si() - low[k].si() <= 100.0) {
            let value = format!("{} and {}", low[k], high[k]);
            let axis = ["x", "y", "z"][k];
            let requirement = format!(
                "the lower and then the upper {axis}, at most 100 m apart: [[x, y, z], [x, y, z]]"
            );
            return Err(bad(name, value, &requirement));
        }
    }
    Ok(())
}

/// Refuses the second of two equal names.
fn check_names<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<(), Error> {
    let mut known: Vec<&str> = Vec::new();
    for name in names {
        if name.trim().is_empty() || known.contains(&name) {
            let requirement = "a unique name";
            return Err(bad(what, format!("{name:?}"), requirement));
        }
        known.push(name);
    }
    Ok(())
}

impl Machine {
    /// Time between two samples, s.
    fn interval(&self) -> f64 {
        self.sample_interval.map_or(INTERVAL, Time::si)
    }

    /// Refuses samples that do not meet each time at which the bed is looked at.
    fn check_interval(&self) -> Result<(), Error> {
        let Some(interval) = self.sample_interval else {
            return Ok(());
        };
        let parts = WHOLE / interval.si();
        if interval.si() >= 1e-5 && parts > 0.5 && (parts - parts.round()).abs() < 1e-9 * parts {
            return Ok(());
        }
        let requirement = "20 ms or a whole part of it, such as 5, 2 or 1 ms, at least 0.01 ms";
        Err(bad(
            "apparatus.sample_interval",
            interval.to_string(),
            requirement,
        ))
    }

    /// Whether a wall of this name is a plane.
    fn is_plane(&self, name: &str) -> bool {
        let mut walls = self.wall.iter();
        walls.any(|wall| wall.name == name && !wall.can_move())
    }

    /// The wall of triangles of a name.
    fn own_mesh(&self, name: &str) -> Option<&MachineWall> {
        let walls = self.wall.iter();
        walls.filter(|w| w.can_move()).find(|w| w.name == name)
    }
}

impl Device for Machine {
    fn materials(&self) -> Vec<&str> {
        let mut all = Vec::new();
        for wall in &self.wall {
            if !all.contains(&wall.material.as_str()) {
                all.push(wall.material.as_str());
            }
        }
        all
    }

    fn check(&self) -> Result<(), Error> {
        check_box("apparatus.room", &self.room)?;
        self.view
            .iter()
            .try_for_each(|view| check_box("apparatus.view", view))?;
        self.check_interval()?;
        check_names(
            "apparatus.wall.name",
            self.wall.iter().map(|w| w.name.as_str()),
        )?;
        self.wall.iter().try_for_each(MachineWall::check)?;
        if self.periodic {
            self.wall
                .iter()
                .try_for_each(MachineWall::check_beside_periodic_sides)?;
        }
        if self.phase.is_empty() {
            let requirement =
                "at least one [[apparatus.phase]]: a bed that only settles has none to read";
            return Err(bad("apparatus.phase", "none".into(), requirement));
        }
        let phases = self.phase.iter().map(|p| p.name.as_str());
        check_names(
            "apparatus.phase.name",
            std::iter::once("filling").chain(phases),
        )?;
        self.check_phases()?;
        check_names(
            "apparatus.probe.name",
            self.probe.iter().map(|p| p.name.as_str()),
        )?;
        if self.probe.is_empty() {
            let requirement = "at least one [[apparatus.probe]]: a run without gives nothing";
            return Err(bad("apparatus.probe", "none".into(), requirement));
        }
        self.probe.iter().try_for_each(|probe| probe.check(self))
    }

    fn check_walls(&self, scene: &Scene) -> Result<(), Error> {
        self.check_wall_names(scene)
    }

    fn observables(&self) -> Vec<&str> {
        self.probe.iter().map(|probe| probe.name.as_str()).collect()
    }

    fn walls(&self) -> Vec<NamedWall> {
        self.wall.iter().filter_map(MachineWall::plane).collect()
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        self.wall.iter().filter_map(MachineWall::mesh).collect()
    }

    fn periodic_sides(&self) -> Option<PeriodicSides> {
        let [low, high] = self.room();
        self.periodic.then_some(PeriodicSides {
            setting: "apparatus.room",
            z: [low.z, high.z],
        })
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        self.room.each_ref().map(point)
    }

    fn view(&self) -> [Vector3<f64>; 2] {
        self.view
            .as_ref()
            .unwrap_or(&self.room)
            .each_ref()
            .map(point)
    }

    fn radius(&self) -> f64 {
        let [low, high] = self.room();
        0.5 * (high.x - low.x)
    }

    fn width(&self) -> f64 {
        let [low, high] = self.room();
        high.z - low.z
    }

    fn bed_volume(&self) -> Option<f64> {
        let [low, high] = self.room();
        Some((high - low).product())
    }

    fn has_phases(&self) -> bool {
        true
    }

    fn greatest_stress(&self) -> f64 {
        let forces = self.phase.iter().flat_map(MachinePhase::forces);
        let stress = |(wall, along, force): (&str, Vector3<f64>, f64)| {
            let area = self.own_mesh(wall)?.area_along(&along);
            (area > 0.0).then(|| force / area)
        };
        forces.filter_map(stress).fold(0.0, f64::max)
    }

    fn fastest_wall(&self) -> f64 {
        let [low, high] = self.view();
        let size = (high - low).norm();
        let motions = self.phase.iter().flat_map(|phase| &phase.motion);
        motions
            .map(|motion| motion.fastest(size))
            .fold(0.0, f64::max)
    }

    fn plan(&self, scene: &Scene) -> Option<Plan> {
        let mut plan = Plan::new(self.phases(scene.seed_mass()));
        plan.interval = self.interval();
        Some(plan)
    }

    fn curve(&self) -> Option<CurveKind> {
        let last = self.phase.last()?;
        (!last.outlet.is_empty()).then_some(DISCHARGE)
    }

    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        discharge(seen, &seen.passages(seen.last_phase()))
    }

    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        let read = |probe: &Probe| {
            let value = probe.value(seen);
            ObservableValues::new(probe.name.clone(), probe.unit(), value)
        };
        Ok(self.probe.iter().map(read).collect())
    }
}
