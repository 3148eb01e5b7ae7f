//! A bed at one moment as spheres, from another code or from a frame here, and what it shows.

use geometry::clump::Sphere;
use nalgebra::{Rotation3, Vector3};
use scene::{Frame, SeedBody};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use surface_profile::{
    DensitySettings, Disc, DrumCircle, SurfaceAngle, measure, profile_from_discs,
};

/// Spheres count for the slip within this angle of the centre of all, as seen from the axis, rad.
const MIDDLE_OF_BED: f64 = PI / 6.0;

/// A sphere of a bed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BedSphere {
    /// Number of the seed that it belongs to; its own number if the file has none.
    pub body: usize,
    /// Where it is and how large, m.
    pub sphere: Sphere,
    /// Velocity of its centre, m/s; `None` if the file does not contain it.
    pub velocity: Option<Vector3<f64>>,
}

/// The spheres at the surface of all seeds at one moment.
///
/// ```
/// // A dump of LAMMPS or LIGGGHTS with one sphere of a radius of 2 mm.
/// let dump = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n\
///             0 1\n0 1\n0 1\nITEM: ATOMS id x y z radius\n1 0.1 0.2 0.3 0.002\n";
/// let moments = simulators::exchange::dump::read(dump, "bed.dump", 1)?;
/// assert_eq!(moments[0].step, Some(100));
/// assert_eq!(moments[0].spheres[0].sphere.radius, 0.002);
/// # Ok::<(), simulators::exchange::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moment {
    /// Number of the step; `None` if the file does not contain it.
    pub step: Option<u64>,
    /// Time, s; `None` if the file does not contain it.
    pub time: Option<f64>,
    /// The spheres.
    pub spheres: Vec<BedSphere>,
}

impl Moment {
    /// The spheres of a frame.
    pub fn of(frame: &Frame, bodies: &[Arc<SeedBody>]) -> Self {
        let mut spheres = Vec::new();
        for body in 0..frame.position.len() {
            for sphere in bodies[frame.kind[body]].outer.spheres() {
                let arm = frame.orientation[body] * sphere.centre;
                spheres.push(BedSphere {
                    body,
                    sphere: Sphere {
                        centre: frame.position[body] + arm,
                        radius: sphere.radius,
                    },
                    velocity: Some(frame.velocity[body] + frame.spin[body].cross(&arm)),
                });
            }
        }
        Self {
            step: None,
            time: Some(frame.time),
            spheres,
        }
    }

    /// The same bed as seen from a point of the drum's axis halfway between the covers (m), after a turn of the axes.
    #[must_use]
    pub fn seen_from(mut self, origin: &Vector3<f64>, turn: &Rotation3<f64>) -> Self {
        for s in &mut self.spheres {
            s.sphere.centre = turn * (s.sphere.centre - origin);
            s.velocity = s.velocity.map(|v| turn * v);
        }
        self
    }

    /// The surface of the bed in a drum of a radius (m) about the origin; `None` if it cannot be measured.
    pub fn surface(&self, radius: f64) -> Option<SurfaceAngle> {
        let drum = DrumCircle {
            x: 0.0,
            y: 0.0,
            radius,
        };
        let disc = |s: &BedSphere| Disc {
            x: s.sphere.centre.x,
            y: s.sphere.centre.y,
            radius: s.sphere.radius,
        };
        let discs: Vec<Disc> = self.spheres.iter().map(disc).collect();
        let points = profile_from_discs(&discs, &drum, &DensitySettings::for_drum(&drum)).ok()?;
        measure(&points, &drum).ok()
    }

    /// 1 less the mean speed along the shell of the spheres that lie within their diameter of it and within 30 deg of the
    /// middle of the bed, over the speed of a shell of a radius (m) that turns with `spin` (rad/s); `None` if no such
    /// sphere has a velocity, or the shell has none.
    pub fn shell_slip(&self, radius: f64, spin: f64) -> Option<f64> {
        let direction = self.direction();
        let (mut speed, mut count) = (0.0, 0.0);
        for s in &self.spheres {
            let c = s.sphere.centre;
            let from_axis = c.x.hypot(c.y);
            let aside = (c.x.atan2(-c.y) - direction + PI).rem_euclid(TAU) - PI;
            if let Some(v) = s.velocity
                && from_axis > radius - 2.0 * s.sphere.radius
                && aside.abs() < MIDDLE_OF_BED
            {
                speed += (c.x * v.y - c.y * v.x) / from_axis;
                count += 1.0;
            }
        }
        (count > 0.0 && spin != 0.0).then(|| 1.0 - speed / count / (spin * radius))
    }

    /// Kinetic energy of the spheres over their mass, all alike: `mean v^2 / 2`, J/kg; `None` if a velocity is missing.
    pub fn kinetic_energy(&self) -> Option<f64> {
        let squares: Option<Vec<f64>> = self
            .spheres
            .iter()
            .map(|s| s.velocity.map(|v| v.norm_squared()))
            .collect();
        Some(0.5 * squares?.iter().sum::<f64>() / self.spheres.len() as f64)
    }

    /// Mean height of the spheres over the axis, m.
    pub fn height(&self) -> f64 {
        self.centre().y
    }

    /// Direction of the centre of all spheres from straight down, counter-clockwise positive, rad.
    pub fn direction(&self) -> f64 {
        let centre = self.centre();
        centre.x.atan2(-centre.y)
    }

    /// Distance of the centre of all spheres from the axis, m, and their mean square distance from it, m².
    pub fn arm_and_square(&self) -> (f64, f64) {
        let squares = self
            .spheres
            .iter()
            .map(|s| s.sphere.centre.xy().norm_squared());
        let mean = squares.sum::<f64>() / self.spheres.len() as f64;
        (self.centre().xy().norm(), mean)
    }

    /// Mean of the centres, m; the origin if there are none.
    fn centre(&self) -> Vector3<f64> {
        let sum: Vector3<f64> = self.spheres.iter().map(|s| s.sphere.centre).sum();
        sum / self.spheres.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::{BedSphere, Moment};
    use geometry::clump::Sphere;
    use nalgebra::{Rotation3, Vector3};

    /// Spheres of 1 cm at an angle from straight down and a distance from the axis, m.
    fn bed(
        places: &[(f64, f64)],
        velocity: impl Fn(usize, Vector3<f64>) -> Vector3<f64>,
    ) -> Moment {
        let spheres = places.iter().enumerate().map(|(body, (angle, from_axis))| {
            let centre = Vector3::new(from_axis * angle.sin(), -from_axis * angle.cos(), 0.0);
            BedSphere {
                body,
                sphere: Sphere {
                    centre,
                    radius: 0.01,
                },
                velocity: Some(velocity(body, centre)),
            }
        });
        Moment {
            spheres: spheres.collect(),
            ..Moment::default()
        }
    }

    /// A bed that turns with its shell slips 0, one at half of its speed slips 0.5; energy by hand. Only spheres at the
    /// shell and near the middle of the bed count.
    #[test]
    fn slip_and_energy_are_those_of_the_spheres() {
        // Two at the shell near the middle, one inside, one far up the shell on either side.
        let places = [
            (0.1, 0.99),
            (-0.1, 0.985),
            (0.0, 0.5),
            (1.2, 0.99),
            (-1.2, 0.99),
        ];
        let turning = |share: f64| {
            bed(&places, |k, c| {
                let speed = if k < 2 { share * 3.0 } else { 7.0 };
                Vector3::new(-c.y, c.x, 0.0) * (speed / c.norm())
            })
        };
        let slip = |share| turning(share).shell_slip(1.0, 3.0).unwrap();
        assert!(slip(1.0).abs() < 1e-12, "with the shell");
        assert!((slip(0.5) - 0.5).abs() < 1e-12, "half");
        let energy = 0.5 * (2.0 * 9.0 + 3.0 * 49.0) / 5.0;
        let found = turning(1.0).kinetic_energy().unwrap();
        assert!((found - energy).abs() < 1e-12, "energy");
        let mut silent = turning(1.0);
        silent.spheres[0].velocity = None;
        assert_eq!(silent.kinetic_energy(), None);
    }

    /// Three spheres that lie to the right of the lowest point: the centre is at their mean. Seen with the axes turned by a
    /// quarter, about another point, the same bed is the same.
    #[test]
    fn the_centre_does_not_depend_on_how_another_code_lays_its_axes() {
        let here = bed(&[(0.2, 0.5), (0.4, 0.5), (0.6, 0.5)], |_, _| Vector3::x());
        assert!((here.direction() - 0.4).abs() < 1e-12);
        let (arm, square) = here.arm_and_square();
        assert!((square - 0.25).abs() < 1e-12 && arm < 0.5);
        // Elsewhere: axis x, z up.
        let turn = Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
            0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0,
        ));
        let origin = Vector3::new(3.0, -2.0, 1.0);
        let mut there = here.clone();
        for s in &mut there.spheres {
            s.sphere.centre = turn.inverse() * s.sphere.centre + origin;
            s.velocity = s.velocity.map(|v| turn.inverse() * v);
        }
        let back = there.seen_from(&origin, &turn);
        for (a, b) in here.spheres.iter().zip(&back.spheres) {
            assert!((a.sphere.centre - b.sphere.centre).norm() < 1e-14);
            assert_eq!(a.velocity, b.velocity);
        }
    }
}
