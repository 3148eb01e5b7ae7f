//! What acts on the seeds beside gravity and contacts: air, charge, a rig that shakes.
//!
//! # Formula
//!
//! ```text
//! air        F = -k (pi/8) rho d^2 C v |v|      C = 24/Re (1 + 0.15 Re^0.687), 0.44 above Re 1000
//! charge     F = q^2 / (16 pi eps0 s^2)         towards each wall, s its distance from the centre
//! vibration  F = m A w^2 sin(w t)               in the frame of the rig
//! ```
//!
//! d is the diameter of the sphere with the volume of the seed, Re = rho v d / eta, v the velocity
//! against still air at 20 degrees Celsius. Forces act on the centre of mass.
//!
//! # Source
//!
//! Air: `[SchillerNaumann1933]`. Charge: the image force of a plane conductor `[Jackson1998, section
//! 2.1]`; shell and covers count as planes, and s counts as at least a quarter of d/2. The charges are
//! taken as of both signs in equal number, so that forces between seeds cancel in the mean and are left
//! out. Vibration: the inertial force in the frame of the rig, whose strength is measured by A w^2 / g
//! `[Jaeger1996]`; the camera is taken as moving with the rig.

use crate::{Apparatus, Error, Scene, SeedBody, VibrationSettings};
use dem_solver::{Bodies, Load};
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_8, PI, TAU};
use std::sync::Arc;

/// Density of air at 20 degrees Celsius and 1013 hPa, kg/m³ (ideal gas, 0.028965 kg/mol).
const AIR_DENSITY: f64 = 1.204;
/// Viscosity of air at 20 degrees Celsius, Pa s.
const AIR_VISCOSITY: f64 = 1.82e-5;
/// Electric constant, F/m.
const ELECTRIC_CONSTANT: f64 = 8.854_187_8e-12;
/// Smallest distance from a wall that counts for the image force, over the radius of the seed.
const CLOSEST: f64 = 0.25;

/// Forces on the seeds besides gravity and contacts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurroundingsSettings {
    /// Drag of the air over that of the sphere with the volume of the seed; no drag if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub air_drag: Option<f64>,
    /// Size of the charge of each seed, nC, in a drum with conducting walls; no charge if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub charge_nc: Option<f64>,
    /// Vibration of the whole apparatus from the start of the drive on; no vibration if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration: Option<VibrationSettings>,
}

impl SurroundingsSettings {
    /// Whether nothing acts.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses what is invalid.
    pub(crate) fn check(&self, apparatus: &Apparatus) -> Result<(), Error> {
        let bad = |name: &str, value: f64, requirement: &str| {
            Err(Error::BadValue {
                name: format!("surroundings.{name}"),
                value: value.to_string(),
                requirement: requirement.into(),
            })
        };
        match (self.air_drag, self.charge_nc) {
            (Some(drag), _) if !(0.0..=1000.0).contains(&drag) => {
                bad("air_drag", drag, "0 to 1000")
            }
            (_, Some(charge)) if !(0.0..=1000.0).contains(&charge) => {
                bad("charge_nc", charge, "0 to 1000")
            }
            (_, Some(charge)) if !matches!(apparatus, Apparatus::Drum(drum) if !drum.has_periodic_ends()) => {
                bad(
                    "charge_nc",
                    charge,
                    "absent: only a drum with covers has walls for it",
                )
            }
            _ => Ok(()),
        }
    }
}

/// What the force on one kind of seed depends on.
#[derive(Debug, Clone, Copy)]
struct Kind {
    /// Mass, kg.
    mass: f64,
    /// Radius of the sphere of the same volume, m.
    radius: f64,
}

/// The forces of the surroundings of a world.
#[derive(Debug, Clone)]
pub(crate) struct Surroundings {
    /// Kinds of seeds.
    kinds: Vec<Kind>,
    /// Drag over that of a sphere.
    air_drag: f64,
    /// Charge, C.
    charge: f64,
    /// Radius of the shell and half of the width of the drum, m.
    drum: [f64; 2],
    /// Amplitude (m) and angular frequency (rad/s) of the rig.
    vibration: Option<(Vector3<f64>, f64)>,
    /// Start of the drive, s.
    start: Option<f64>,
}

impl Surroundings {
    /// The surroundings of a scene; `None` if they exert no force.
    pub(crate) fn of(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Option<Self> {
        let settings = &scene.surroundings;
        let kind = |body: &Arc<SeedBody>| Kind {
            mass: body.clump.mass(),
            radius: body.volume_radius(),
        };
        let vibration = settings.vibration.as_ref().map(|v| {
            let amplitude = Vector3::from(v.amplitude.map(Length::si));
            (amplitude, TAU * v.frequency.si())
        });
        (!settings.is_empty()).then(|| Self {
            kinds: bodies.iter().map(kind).collect(),
            air_drag: settings.air_drag.unwrap_or(0.0),
            charge: 1e-9 * settings.charge_nc.unwrap_or(0.0),
            drum: [scene.apparatus.radius(), 0.5 * scene.apparatus.width()],
            vibration,
            start: None,
        })
    }

    /// Tells when the drive starts, s.
    pub(crate) fn start(&mut self, time: f64) {
        self.start = Some(time);
    }

    /// Adds the forces at a time (s).
    pub(crate) fn add_forces(&self, time: f64, bodies: &mut Bodies) {
        let shaking = self.acceleration(time);
        for i in 0..bodies.len() {
            let kind = self.kinds[bodies.template[i]];
            let mut force = shaking * kind.mass;
            if self.air_drag > 0.0 {
                force += drag(&bodies.velocity[i], kind.radius) * self.air_drag;
            }
            if self.charge > 0.0 {
                force += self.towards_walls(&bodies.position[i], kind.radius);
            }
            bodies.load[i] += Load::of_force(&force);
        }
    }

    /// Inertial acceleration in the frame of the rig, m/s².
    fn acceleration(&self, time: f64) -> Vector3<f64> {
        match (&self.vibration, self.start) {
            (Some((amplitude, w)), Some(start)) => amplitude * (w * w * (w * (time - start)).sin()),
            _ => Vector3::zeros(),
        }
    }

    /// Image force of shell and covers on a charge, N.
    fn towards_walls(&self, position: &Vector3<f64>, radius: f64) -> Vector3<f64> {
        let size = |distance: f64| image_force(self.charge, distance.max(CLOSEST * radius));
        let [shell, half] = self.drum;
        let from_axis = position.xy().norm();
        let mut force = Vector3::z() * (size(half - position.z) - size(half + position.z));
        if from_axis > 0.0 {
            let outward = size(shell - from_axis) / from_axis;
            force += Vector3::new(position.x, position.y, 0.0) * outward;
        }
        force
    }
}

/// Attraction of a charge (C) by a plane conductor at a distance (m), N.
fn image_force(charge: f64, distance: f64) -> f64 {
    charge * charge / (16.0 * PI * ELECTRIC_CONSTANT * distance * distance)
}

/// Drag of a sphere of a radius (m) that moves at a velocity (m/s) through still air, N.
fn drag(velocity: &Vector3<f64>, radius: f64) -> Vector3<f64> {
    let (speed, diameter) = (velocity.norm(), 2.0 * radius);
    let reynolds = AIR_DENSITY * speed * diameter / AIR_VISCOSITY;
    if reynolds == 0.0 {
        return Vector3::zeros();
    }
    let coefficient = if reynolds < 1000.0 {
        24.0 / reynolds * (1.0 + 0.15 * reynolds.powf(0.687))
    } else {
        0.44
    };
    -velocity * (FRAC_PI_8 * AIR_DENSITY * diameter * diameter * coefficient * speed)
}

#[cfg(test)]
mod tests;
