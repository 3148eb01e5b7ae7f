//! The bed from moment to moment: centre of mass, slip at the shell, power and energy.

use crate::build::Built;
use crate::{Frame, Scene};
use dem_solver::World;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Seeds at the shell count for the slip within this angle of the centre of mass, rad.
const MIDDLE_OF_BED: f64 = PI / 6.0;

/// State of the bed at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// Time since the drive started, s.
    pub time_s: f64,
    /// Direction of the centre of mass from straight down, counter-clockwise positive, deg.
    pub centre_of_mass_deg: f64,
    /// 1 minus the speed of the seeds at the shell over the speed of the shell, within 30 deg of
    /// the centre of mass: at the edges of the bed seeds come to rest or turn back.
    pub shell_slip: f64,
    /// Power of the moving walls on the seeds, W. Over a time in which the bed is steady, its
    /// mean is what friction and dashpots take.
    pub drive_power_w: f64,
    /// Kinetic energy of all seeds, J.
    pub kinetic_energy_j: f64,
    /// Share of the seeds that touch nothing; none of bonded seeds.
    pub airborne_share: Option<f64>,
}

/// Share of the shell's speed that the bed must keep to count as rolling; below, it slides.
pub(crate) const SLIDING_BELOW: f64 = 0.5;

impl SeriesPoint {
    /// Whether the bed turns with the shell.
    pub fn rolls(&self) -> bool {
        self.shell_slip <= SLIDING_BELOW
    }
}

/// Direction of the centre of mass and slip at the shell.
pub(crate) fn series_point(scene: &Scene, built: &Built, seeds: &Frame, share: f64) -> SeriesPoint {
    let (radius, spin) = (scene.apparatus.radius(), scene.apparatus.speed());
    let mut centre = Vector3::zeros();
    for p in &seeds.position {
        centre += p;
    }
    let lowest = centre.x.atan2(-centre.y);
    let (mut speed, mut n) = (0.0, 0_usize);
    for (i, p) in seeds.position.iter().enumerate() {
        let from_axis = p.xy().norm();
        let aside = (p.x.atan2(-p.y) - lowest + PI).rem_euclid(TAU) - PI;
        let body = &built.bodies[seeds.kind[i]].clump;
        let at_shell = from_axis > radius - body.bounding_radius();
        if at_shell && aside.abs() < MIDDLE_OF_BED {
            let v = seeds.velocity[i];
            speed += (p.x * v.y - p.y * v.x) / from_axis;
            n += 1;
        }
    }
    let surface_speed = spin * share * radius;
    let slip = if n > 0 && surface_speed != 0.0 {
        1.0 - speed / n as f64 / surface_speed
    } else {
        0.0
    };
    SeriesPoint {
        time_s: seeds.time,
        centre_of_mass_deg: lowest.to_degrees(),
        shell_slip: slip,
        drive_power_w: drive_power(&built.world),
        kinetic_energy_j: built.world.kinetic_energy(),
        airborne_share: built.bonds.is_none().then(|| airborne(&built.world)),
    }
}

/// Share of the bodies on which no contact acted in the last step.
fn airborne(world: &World) -> f64 {
    let loads = &world.bodies().load;
    let free = loads.iter().filter(|load| load.force() == Vector3::zeros());
    free.count() as f64 / loads.len().max(1) as f64
}

/// Power of the moving walls on the seeds in the last step, W; vibrations are left out.
fn drive_power(world: &World) -> f64 {
    let torques = world.wall_torque().iter();
    let turning = world.walls().iter().zip(torques);
    let meshes = world.mesh_walls().zip(world.mesh_loads());
    turning
        .map(|(wall, torque)| -torque * wall.spin)
        .sum::<f64>()
        - meshes
            .map(|(wall, (force, torque))| {
                force.dot(&wall.motion.velocity) + torque.dot(&wall.motion.spin)
            })
            .sum::<f64>()
}
