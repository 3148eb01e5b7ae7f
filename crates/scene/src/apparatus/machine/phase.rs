//! Phases of a machine: what moves, what is loaded, where seeds are taken out, and when it ends.

use super::{GREATEST_SPEED, Machine, point, unit};
use crate::Error;
use crate::Scene;
use crate::apparatus::compression::{check_greatest_speed, pressing};
use crate::check::bad;
use crate::obstacles::{VibrationSettings, fastest, prescribed};
use crate::phases::{End, Outlet, Phase};
use dem_solver::Motion;
use input::quantity::{AngularSpeed, Fraction, Length, Speed, Time};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A time with one set of motions and loads. What a wall is given by `motion` ends with the phase; a load stays until a later phase gives
/// the wall another load, a motion, or holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachinePhase {
    /// Name, to which probes refer.
    pub name: String,
    /// Walls that are taken away at its start.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remove: Vec<String>,
    /// Walls that are held where they are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hold: Vec<String>,
    /// Walls that move in a prescribed way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<WallMotion>,
    /// Walls that carry a force.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load: Vec<WallLoad>,
    /// Planes behind which seeds are taken out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outlet: Vec<Outflow>,
    /// When it ends.
    pub end: PhaseEnd,
}

/// A prescribed motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallMotion {
    /// Name of the wall.
    pub wall: String,
    /// Velocity: x, y, z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<[Speed; 3]>,
    /// Angular velocity about its own point: x, y, z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spin: Option<[AngularSpeed; 3]>,
    /// Vibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration: Option<VibrationSettings>,
}

impl WallMotion {
    /// The motion.
    fn motion(&self) -> Motion {
        prescribed(self.velocity, self.spin, self.vibration.as_ref())
    }

    /// Greatest speed that the wall can have within so many metres, m/s.
    pub(super) fn fastest(&self, size: f64) -> f64 {
        fastest(self.velocity, self.spin, self.vibration.as_ref(), size)
    }
}

/// A force on a wall along an axis, the only one along which the wall then moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallLoad {
    /// Name of the wall.
    pub wall: String,
    /// Force, N.
    pub force_n: f64,
    /// Direction; downwards if omitted.
    #[serde(default = "downwards")]
    pub direction: [f64; 3],
    /// Greatest speed of the wall; 0.2 m/s if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub greatest_speed: Option<Speed>,
}

/// The direction of gravity.
fn downwards() -> [f64; 3] {
    [0.0, -1.0, 0.0]
}

impl WallLoad {
    /// Unit vector along the load.
    fn direction(&self) -> Vector3<f64> {
        Vector3::from(self.direction).normalize()
    }
}

/// A plane that takes out the seeds whose centres pass it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outflow {
    /// A point of the plane.
    pub point: [Length; 3],
    /// Direction in which seeds leave; downwards if omitted.
    #[serde(default = "downwards")]
    pub normal: [f64; 3],
}

/// When a phase ends. All but `after` end at the latest after `protocol.rotation_limit`; the run then ends, and reports the reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum PhaseEnd {
    /// After a time.
    After(Time),
    /// When all seeds rest and all loads are carried, not before a time.
    AtRest(Time),
    /// When the bed pushes a wall with a force.
    Force {
        /// Name of the wall.
        wall: String,
        /// Force, N.
        force_n: f64,
        /// Direction in which the bed pushes; upwards if omitted.
        #[serde(default = "upwards")]
        direction: [f64; 3],
    },
    /// When a wall has gone down by a depth since the bed first pushed it up.
    Depth {
        /// Name of the wall.
        wall: String,
        /// Depth.
        depth: Length,
    },
    /// When a fraction of the mass of the bed has been taken out in the phase.
    Discharged(Fraction),
}

/// The direction against gravity.
fn upwards() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

impl PhaseEnd {
    fn end(&self) -> End {
        match self {
            Self::After(time) => End::After(time.si()),
            Self::AtRest(time) => End::AtRest { after: time.si() },
            Self::Force {
                wall,
                force_n,
                direction,
            } => End::Pushed {
                wall: wall.clone(),
                along: Vector3::from(*direction).normalize(),
                force: *force_n,
            },
            Self::Depth { wall, depth } => End::Pressed {
                wall: wall.clone(),
                depth: depth.si(),
            },
            Self::Discharged(fraction) => End::Discharged(fraction.get()),
        }
    }

    /// Name of the wall that it looks at.
    fn wall(&self) -> Option<&str> {
        match self {
            Self::Force { wall, .. } | Self::Depth { wall, .. } => Some(wall),
            _ => None,
        }
    }
}

impl MachinePhase {
    /// Names of the walls that it gives something to.
    fn acts_on(&self) -> impl Iterator<Item = &str> {
        let moved = self.motion.iter().map(|m| &m.wall);
        let loaded = self.load.iter().map(|l| &l.wall);
        let all = moved.chain(loaded).chain(&self.hold).chain(&self.remove);
        all.map(String::as_str)
    }

    /// Forces that walls carry, and at which it ends: wall, direction, N.
    pub(super) fn forces(&self) -> impl Iterator<Item = (&str, Vector3<f64>, f64)> {
        let loads = self.load.iter();
        let loads = loads.map(|l| (l.wall.as_str(), l.direction(), l.force_n));
        let end = match &self.end {
            PhaseEnd::Force {
                wall,
                force_n,
                direction,
            } => Some((
                wall.as_str(),
                Vector3::from(*direction).normalize(),
                *force_n,
            )),
            _ => None,
        };
        loads.chain(end)
    }

    /// Refuses numbers that make no sense.
    fn check(&self) -> Result<(), Error> {
        let name = |key: &str| format!("apparatus.phase '{}': {key}", self.name);
        for load in &self.load {
            if !(load.force_n > 0.0 && load.force_n <= 1e9) {
                let requirement = "above 0 N, at most 1e9 N; state the direction by load.direction";
                return Err(bad(
                    &name("load.force_n"),
                    load.force_n.to_string(),
                    requirement,
                ));
            }
            unit(&name("load.direction"), load.direction)?;
            check_greatest_speed(load.greatest_speed)?;
        }
        let positive = |key: &str, value: f64, text: String| {
            let refused = || bad(&name(key), text, "above 0");
            (value > 0.0).then_some(()).ok_or_else(refused)
        };
        match &self.end {
            PhaseEnd::After(time) => positive("end.after", time.si(), time.to_string()),
            PhaseEnd::AtRest(_) => Ok(()),
            PhaseEnd::Force {
                force_n, direction, ..
            } => {
                unit(&name("end.force.direction"), *direction)?;
                positive("end.force.force_n", *force_n, force_n.to_string())
            }
            PhaseEnd::Depth { depth, .. } => {
                positive("end.depth.depth", depth.si(), depth.to_string())
            }
            PhaseEnd::Discharged(fraction) => {
                positive("end.discharged", fraction.get(), fraction.to_string())?;
                if !self.outlet.is_empty() {
                    return Ok(());
                }
                let requirement = "beside an outlet in the same phase, through which seeds leave";
                Err(bad(
                    &name("end.discharged"),
                    fraction.to_string(),
                    requirement,
                ))
            }
        }
    }
}

impl Machine {
    /// The phases of a bed of a mass, kg.
    pub(super) fn phases(&self, bed: f64) -> Vec<Phase> {
        let mut moving: Vec<&str> = Vec::new();
        let mut all = Vec::new();
        for phase in &self.phase {
            let mut motions: Vec<(String, Motion)> = Vec::new();
            let ended = moving
                .iter()
                .filter(|wall| !phase.acts_on().any(|w| w == **wall));
            let still = phase.hold.iter().map(String::as_str).chain(ended.copied());
            motions.extend(still.map(|wall| (wall.to_owned(), Motion::default())));
            let moved = phase.motion.iter();
            motions.extend(moved.map(|motion| (motion.wall.clone(), motion.motion())));
            motions.extend(phase.load.iter().map(|load| {
                let speed = load.greatest_speed.map_or(GREATEST_SPEED, Speed::si);
                let pressing = pressing(load.direction(), load.force_n, bed, speed);
                (load.wall.clone(), pressing)
            }));
            moving = phase.motion.iter().map(|m| m.wall.as_str()).collect();
            let outlet = |outlet: &Outflow| Outlet {
                point: point(&outlet.point),
                normal: Vector3::from(outlet.normal).normalize(),
            };
            all.push(Phase {
                motions,
                removed: phase.remove.clone(),
                outlets: phase.outlet.iter().map(outlet).collect(),
                end: phase.end.end(),
                ..Phase::named(&phase.name)
            });
        }
        all
    }

    /// Refuses phases that act twice on a wall, on one that is gone, or on none.
    pub(super) fn check_phases(&self) -> Result<(), Error> {
        let mut gone: Vec<&str> = Vec::new();
        for phase in &self.phase {
            phase.check()?;
            let name = |what: &str| format!("apparatus.phase '{}': {what}", phase.name);
            let mut here: Vec<&str> = Vec::new();
            for wall in phase.acts_on().chain(phase.end.wall()) {
                if gone.contains(&wall) {
                    let requirement = "a wall that no earlier phase takes away";
                    return Err(bad(&name("wall"), format!("'{wall}'"), requirement));
                }
            }
            for wall in phase.acts_on() {
                if here.contains(&wall) {
                    let requirement = "named once in a phase: by motion, load, hold or remove";
                    return Err(bad(&name("wall"), format!("'{wall}'"), requirement));
                }
                here.push(wall);
                if self.is_plane(wall) {
                    let requirement = "another shape, such as a rectangle: a plane cannot move";
                    return Err(bad(&name("wall"), format!("'{wall}'"), requirement));
                }
            }
            if let PhaseEnd::Depth { wall, .. } = &phase.end
                && self.is_plane(wall)
            {
                let requirement = "a wall that moves: a plane cannot";
                return Err(bad(
                    &name("end.depth.wall"),
                    format!("'{wall}'"),
                    requirement,
                ));
            }
            for outlet in &phase.outlet {
                self.check_outlet(outlet, &name("outlet"))?;
            }
            for load in &phase.load {
                let shown = self
                    .own_mesh(&load.wall)
                    .map(|wall| wall.area_along(&load.direction()));
                if shown.is_none_or(|area| area <= 0.0) {
                    let requirement =
                        "a wall of [[apparatus.wall]] that shows some area along its load";
                    return Err(bad(
                        &name("load.wall"),
                        format!("'{}'", load.wall),
                        requirement,
                    ));
                }
            }
            gone.extend(phase.remove.iter().map(String::as_str));
        }
        Ok(())
    }

    /// Refuses a plane in front of which no part of the room is: it would take out all seeds at once.
    fn check_outlet(&self, outlet: &Outflow, name: &str) -> Result<(), Error> {
        let normal = unit(name, outlet.normal)?;
        let [low, high] = self.room.each_ref().map(point);
        // The part of the room that is farthest in front.
        let corner = Vector3::from_fn(|k, _| if normal[k] > 0.0 { low[k] } else { high[k] });
        if (corner - point(&outlet.point)).dot(&normal) < 0.0 {
            return Ok(());
        }
        let value = format!(
            "{} {} {}",
            outlet.point[0], outlet.point[1], outlet.point[2]
        );
        let requirement =
            "a point with the room in front of it: normal is the direction in which seeds leave";
        Err(bad(&format!("{name}.point"), value, requirement))
    }

    /// Refuses names of walls that neither the machine nor `[[wall]]` has.
    pub(super) fn check_wall_names(&self, scene: &Scene) -> Result<(), Error> {
        let own = self.wall.iter().map(|wall| wall.name.as_str());
        let known: Vec<&str> = own
            .chain(scene.wall.iter().map(|w| w.name.as_str()))
            .collect();
        let of_phases = self
            .phase
            .iter()
            .flat_map(|phase| phase.acts_on().chain(phase.end.wall()));
        let of_probes = self.probe.iter().flat_map(|probe| probe.walls());
        for wall in of_phases.chain(of_probes) {
            if !known.contains(&wall) {
                let requirement = format!("one of {}", known.join(", "));
                return Err(bad("name of a wall", format!("'{wall}'"), &requirement));
            }
        }
        Ok(())
    }
}
