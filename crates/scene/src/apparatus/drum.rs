//! Rotating drum between two covers.

use super::device::{Device, PeriodicSides};
use super::heap::check_size;
use super::{NamedMesh, NamedWall, cover};
use crate::Error;
use dem_solver::{Motion, Shape};
use input::quantity::{Angle, AngularSpeed, Length, Time};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Observables of a drum; the first 19 need no more than where the spheres lie from moment to moment.
const DRUM_OBSERVABLES: [&str; 26] = [
    "angle_deg",
    "angle_by_position_deg",
    "image_minus_position_deg",
    "curvature",
    "s_shape",
    "shape_4",
    "shape_5",
    "fill_level",
    "toe_position_deg",
    "top_position_deg",
    "fluctuation_deg",
    "angle_correlation_time_s",
    "avalanche_size_deg",
    "avalanche_waiting_time_s",
    "centre_of_mass_deg",
    "centre_of_mass_fluctuation_deg",
    "shell_slip",
    "carried_share",
    "waiting_time_s",
    "airborne_share",
    "kinetic_energy_mj",
    "drive_power_mw",
    "flowing_layer_depth_mm",
    "surface_speed_mm_s",
    "fill_level_by_position",
    "avalanche_period_s",
];

/// Observables of a drum that pictures give whose times are not known.
pub const OBSERVABLES_OF_PICTURES: [&str; 9] = [
    "angle_deg",
    "curvature",
    "s_shape",
    "shape_4",
    "shape_5",
    "fill_level",
    "toe_position_deg",
    "top_position_deg",
    "fluctuation_deg",
];

/// Observables of a drum that follow from the positions of its spheres alone. Without velocities there is no slip of seeds, and
/// no waiting time if the bed is never carried along.
pub const OBSERVABLES_OF_A_BED: &[&str] = DRUM_OBSERVABLES.split_at(19).0;

/// A shell and two covers, which turn together by default; in the study about a level axis at one speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    /// Inner diameter.
    pub inner_diameter: Length,
    /// Width between the covers.
    pub width: Length,
    /// Speed, counter-clockwise positive as the camera sees it.
    pub speed: AngularSpeed,
    /// Material of the shell.
    pub shell: String,
    /// Material of the covers; `periodic` for a drum without covers whose ends are periodic sides, as if it had no end.
    pub cover: String,
    /// Whether the covers stand still while the shell turns; they turn with it where absent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub covers_at_rest: bool,
    /// Tilt of the axis: positive when the front end, which the camera faces, is the lower one.
    /// Level where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt: Option<Angle>,
    /// Time in which the speed rises evenly from 0; at once where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ramp: Option<Time>,
    /// Time after which the drum turns the other way, again and again; never where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reverse_every: Option<Time>,
    /// Unsteadiness of the drive; `None` if the speed is steady.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ripple: Option<Ripple>,
    /// Radial plates on the shell; `None` if it is smooth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lifters: Option<Lifters>,
}

/// A speed that swings about its mean, as behind an eccentric roller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ripple {
    /// Half of the swing over the mean speed, 0 to 1.
    pub share: f64,
    /// Swings in one revolution of the drum.
    pub cycles: f64,
}

/// Radial plates on the inside of the shell, evenly spread, over the whole width.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lifters {
    /// Number of plates.
    pub count: usize,
    /// Height of a plate from the shell towards the axis.
    pub height: Length,
    /// Material.
    pub material: String,
}

/// What a scene names instead of the material of covers if the ends of the drum are periodic.
const PERIODIC: &str = "periodic";

impl Drum {
    /// Whether its ends are periodic sides instead of covers.
    pub fn has_periodic_ends(&self) -> bool {
        self.cover == PERIODIC
    }

    /// Share of the speed at a time after the start of the drive (s).
    ///
    /// # Formula
    ///
    /// `rise(t) (1 + share sin(cycles w t))`, with the sign of the direction, w the mean speed.
    pub(crate) fn share_of_speed(&self, time: f64) -> f64 {
        let rise = self.ramp.map_or(1.0, |ramp| {
            if ramp.si() > 0.0 {
                (time / ramp.si()).min(1.0)
            } else {
                1.0
            }
        });
        let reversed = self
            .reverse_every
            .is_some_and(|every| (time / every.si()).rem_euclid(2.0) >= 1.0);
        let swing = self.ripple.map_or(1.0, |ripple| {
            1.0 + ripple.share * (ripple.cycles * self.speed.si() * time).sin()
        });
        if reversed {
            -rise * swing
        } else {
            rise * swing
        }
    }

    /// Whether the speed changes with time.
    pub(crate) fn has_schedule(&self) -> bool {
        self.ramp.is_some() || self.reverse_every.is_some() || self.ripple.is_some()
    }

    /// Triangles of the lifters, m.
    pub(crate) fn lifter_triangles(&self) -> Vec<[Vector3<f64>; 3]> {
        let Some(lifters) = &self.lifters else {
            return Vec::new();
        };
        let outer = 0.5 * self.inner_diameter.si();
        // A seed that passes a periodic end stays at the plate.
        let beyond = if self.has_periodic_ends() { 2.0 } else { 1.0 };
        let half = 0.5 * beyond * self.width.si();
        let inner = outer - lifters.height.si();
        let plate = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / lifters.count as f64;
            let at = |r: f64, z: f64| Vector3::new(r * angle.cos(), r * angle.sin(), z);
            let [a, b] = [at(outer, -half), at(outer, half)];
            let [c, d] = [at(inner, half), at(inner, -half)];
            [[a, b, c], [a, c, d]]
        };
        (0..lifters.count).flat_map(plate).collect()
    }
}

impl Device for Drum {
    fn materials(&self) -> Vec<&str> {
        let lifters = self.lifters.iter().map(|l| l.material.as_str());
        let cover = (!self.has_periodic_ends()).then_some(self.cover.as_str());
        std::iter::once(self.shell.as_str())
            .chain(cover)
            .chain(lifters)
            .collect()
    }

    fn check(&self) -> Result<(), Error> {
        let bad = |name: &str, value: String, requirement: &str| {
            Err(Error::BadValue {
                name: name.into(),
                value,
                requirement: requirement.into(),
            })
        };
        if let Some(tilt) = self.tilt
            && tilt.si().abs() >= std::f64::consts::FRAC_PI_2
        {
            return bad(
                "apparatus.tilt",
                tilt.to_string(),
                "between -90 deg and 90 deg",
            );
        }
        if self.has_periodic_ends() && (self.tilt.is_some() || self.covers_at_rest) {
            let requirement =
                "the material of the covers, if the drum is tilted or its covers stand still";
            return bad("apparatus.cover", self.cover.clone(), requirement);
        }
        // The speed is set anew every 0.02 s: five times in the shortest turn.
        if let Some(every) = self.reverse_every
            && every.si() < 0.1
        {
            return bad(
                "apparatus.reverse_every",
                every.to_string(),
                "at least 0.1 s",
            );
        }
        if let Some(Ripple { share, cycles }) = self.ripple {
            if !(0.0..=1.0).contains(&share) {
                return bad("apparatus.ripple.share", share.to_string(), "0 to 1");
            }
            // The speed is set anew every 0.02 s: five times in the shortest swing.
            let swings = cycles * self.speed.si().abs() / std::f64::consts::TAU;
            if !(cycles > 0.0 && swings <= 10.0) {
                let requirement = "above 0, and at most 10 swings in a second";
                return bad("apparatus.ripple.cycles", cycles.to_string(), requirement);
            }
        }
        if let Some(lifters) = &self.lifters {
            let height = lifters.height.si();
            if height <= 0.0 || height >= 0.5 * self.inner_diameter.si() {
                let requirement = "above 0 and below the inner radius";
                return bad(
                    "apparatus.lifters.height",
                    lifters.height.to_string(),
                    requirement,
                );
            }
            if lifters.count == 0 || lifters.count > 1000 {
                return bad(
                    "apparatus.lifters.count",
                    lifters.count.to_string(),
                    "1 to 1000",
                );
            }
        }
        check_turned(self.inner_diameter, self.width)
    }

    fn observables(&self) -> Vec<&str> {
        DRUM_OBSERVABLES.to_vec()
    }

    fn walls(&self) -> Vec<NamedWall> {
        let (half, spin) = (0.5 * self.width.si(), self.speed.si());
        let radius = 0.5 * self.inner_diameter.si();
        let of_covers = if self.covers_at_rest { 0.0 } else { spin };
        let wall = |name: &str, shape, material: &String, spin| NamedWall {
            name: name.into(),
            shape,
            material: material.clone(),
            spin,
        };
        let shell = wall("shell", Shape::Cylinder { radius }, &self.shell, spin);
        if self.has_periodic_ends() {
            return vec![shell];
        }
        vec![
            shell,
            wall("front cover", cover(half), &self.cover, of_covers),
            wall("back cover", cover(-half), &self.cover, of_covers),
        ]
    }

    fn mesh_walls(&self) -> Vec<NamedMesh> {
        let lifters = self.lifters.iter().map(|lifters| NamedMesh {
            name: "lifters".into(),
            triangles: self.lifter_triangles(),
            material: lifters.material.clone(),
            motion: Motion {
                spin: Vector3::z() * self.speed.si(),
                ..Motion::default()
            },
        });
        lifters.collect()
    }

    fn periodic_sides(&self) -> Option<PeriodicSides> {
        let sides = PeriodicSides::about_zero("apparatus.width", self.width());
        self.has_periodic_ends().then_some(sides)
    }

    fn room(&self) -> [Vector3<f64>; 2] {
        turned_room(self.radius(), self.width())
    }

    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        is_inside(centre, radius, self.radius(), self.width())
    }

    fn is_out_of_reach(&self, x: f64, y: f64, radius: f64) -> bool {
        x.hypot(y) + radius >= self.radius()
    }

    fn radius(&self) -> f64 {
        0.5 * self.inner_diameter.si()
    }

    fn width(&self) -> f64 {
        self.width.si()
    }

    fn bed_volume(&self) -> Option<f64> {
        Some(std::f64::consts::PI * self.radius().powi(2) * self.width())
    }

    fn gravity(&self, size: f64) -> Vector3<f64> {
        match self.tilt {
            Some(tilt) => Vector3::new(0.0, -tilt.si().cos(), tilt.si().sin()) * size,
            None => Vector3::new(0.0, -size, 0.0),
        }
    }

    fn speed(&self) -> Option<AngularSpeed> {
        Some(self.speed)
    }

    fn set_speed(&mut self, speed: AngularSpeed) {
        self.speed = speed;
    }

    fn ramp(&self) -> Option<f64> {
        self.ramp.map(Time::si)
    }

    fn share_of_speed(&self, time: f64) -> Option<f64> {
        self.has_schedule().then(|| self.share_of_speed(time))
    }

    fn lower_cover(&self) -> Option<f64> {
        let slope = self.tilt?.si().sin();
        (slope != 0.0).then(|| slope.signum())
    }
}

/// Refuses sizes that no drum or device has.
pub(super) fn check_turned(inner_diameter: Length, width: Length) -> Result<(), Error> {
    check_size("apparatus.inner_diameter", inner_diameter)?;
    check_size("apparatus.width", width)
}

/// Region in which seeds may start in a drum of a radius and a width, m.
pub(super) fn turned_room(radius: f64, width: f64) -> [Vector3<f64>; 2] {
    let corner = Vector3::new(radius, radius, 0.5 * width);
    [-corner, corner]
}

/// Whether a ball is inside a drum of an inner radius and a width, m.
pub(super) fn is_inside(centre: &Vector3<f64>, radius: f64, inner: f64, width: f64) -> bool {
    centre.xy().norm() + radius < inner && centre.z.abs() + radius < 0.5 * width
}

#[cfg(test)]
mod tests {
    use super::{Drum, Ripple};
    use input::quantity::{AngularSpeed, Length};

    /// Over one revolution the drum turns as far with ripple as without, and the speed swings by the
    /// share to either side. Rounding only: the sum runs over whole swings.
    #[test]
    fn ripple_keeps_the_mean_speed() {
        let drum = Drum {
            inner_diameter: Length::parse("140 mm").unwrap(),
            width: Length::parse("46 mm").unwrap(),
            speed: AngularSpeed::parse("10 rpm").unwrap(),
            shell: "resin".into(),
            cover: "resin".into(),
            tilt: None,
            ramp: None,
            reverse_every: None,
            covers_at_rest: false,
            ripple: Some(Ripple {
                share: 0.2,
                cycles: 6.0,
            }),
            lifters: None,
        };
        let shares: Vec<f64> = (0..600)
            .map(|k| drum.share_of_speed(f64::from(k) * 0.01))
            .collect();
        let mean = shares.iter().sum::<f64>() / 600.0;
        assert!((mean - 1.0).abs() < 1e-12, "mean {mean}");
        let largest = shares.iter().copied().fold(0.0, f64::max);
        assert!((largest - 1.2).abs() < 1e-12, "largest {largest}");
        assert!(drum.has_schedule(), "the run must follow the ripple");
    }
}
