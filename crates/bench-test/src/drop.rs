//! The drop: a seed falls on a plate, and its rebound tells the restitution.

use crate::{Error, in_range, lowest, settings, template};
use dem_solver::{Placement, Shape, Wall, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use random_stream::Stream;
use scene::BenchParts;

/// Longest time from the first touch to the top of the rebound, s.
const LIMIT: f64 = 1.0;

/// The plate y = 0 of material 1.
pub(crate) fn plate() -> Wall {
    Wall {
        name: "plate".into(),
        shape: Shape::Plane {
            point: Vector3::zeros(),
            normal: Vector3::y(),
        },
        material: 1,
        spin: 0.0,
    }
}

/// Restitution of `repeats` drops from a height (m), each in a random orientation.
///
/// As on the bench: e = sqrt(H2 / H1), H1 the height from which the lowest point of the seed falls, H2
/// the highest that the lowest point reaches after the first touch, whatever the seed does in
/// between. The fall itself is not simulated: the seed starts just above the plate with the speed
/// of its fall.
///
/// # Errors
///
/// A height outside 1 mm to 10 m, a solver that stops, a seed that does not come to the top of its
/// rebound.
pub fn drop(parts: &BenchParts, height: f64, repeats: usize, seed: u64) -> Result<Vec<f64>, Error> {
    in_range("drop height in m", height, 1e-3..=10.0, "0.001 to 10")?;
    let mut stream = Stream::new(seed, "drop test");
    (1..=repeats)
        .map(|repeat| {
            let [w, x, y, z] = stream.rotation();
            let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            let rebound = one(parts, height, turn, repeat)?;
            Ok((rebound / height).sqrt())
        })
        .collect()
}

/// Height that the lowest point reaches after the first touch, m.
fn one(
    parts: &BenchParts,
    height: f64,
    turn: UnitQuaternion<f64>,
    repeat: usize,
) -> Result<f64, Error> {
    let below = parts.body.outer.spheres().iter();
    let reach = below
        .map(|s| s.radius - (turn * s.centre).y)
        .fold(0.0, f64::max);
    let gap = 1e-5;
    let speed = (2.0 * parts.gravity * (height - gap).max(0.0)).sqrt();
    let start = Placement {
        velocity: Vector3::y() * -speed,
        ..Placement::at_rest(0, Vector3::y() * (reach + gap), turn)
    };
    let mut world = World::new(
        settings(parts, Vector3::y() * -parts.gravity),
        vec![template(parts)],
        parts.interactions.clone(),
        vec![plate()],
        &[start],
    )?;
    let (mut touched, mut highest) = (false, 0.0_f64);
    while world.time() < LIMIT {
        world.step()?;
        let now = world.n_wall_contacts() > 0;
        touched |= now;
        if touched && !now {
            let rising = world.bodies().velocity[0].y > 0.0;
            highest = highest.max(lowest(&world, parts));
            // Falling again from a height at which no tip can reach the plate any more.
            let clear = world.bodies().position[0].y > parts.body.clump.bounding_radius();
            if !rising && clear {
                return Ok(highest);
            }
        }
        if touched && at_rest(&world, parts) {
            return Ok(highest);
        }
    }
    Err(Error::NoEvent {
        repeat,
        what: "the seed neither rebounds nor rests",
        limit: LIMIT,
    })
}

/// Whether the seed has too little energy to rise by a hundredth of its size.
fn at_rest(world: &World, parts: &BenchParts) -> bool {
    let clump = &parts.body.clump;
    world.kinetic_energy() < 0.01 * clump.mass() * parts.gravity * clump.bounding_radius()
}
