//! The tilted plate: the tangent of the angle at which a seed starts to roll.

use crate::drop::plate;
use crate::{Error, settings, template};
use dem_solver::{Placement, World};
use nalgebra::{UnitQuaternion, Vector3};
use random_stream::Stream;
use scene::BenchParts;

/// Rate of the tilt, rad/s: 5 degrees a second.
const RATE: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Time for the seed to come to rest on the level plate, s.
const REST: f64 = 0.3;

/// Rolling has begun when the seed has turned by this angle about its long axis, rad.
const TURN: f64 = 0.5;

/// Sliding has begun when it has gone this way in seed radii without turning so far.
const WAY: f64 = 2.0;

/// How a seed left its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// It rolled.
    Rolled,
    /// It slid without rolling: the angle tells the static friction.
    Slid,
}

/// Tangent of the starting angle and the way of starting, for `repeats` seeds.
///
/// The long axis lies across the slope, as on the bench; the seed is turned about it at random and
/// comes to rest before the plate is tilted.
///
/// # Errors
///
/// A solver that stops, a seed that holds on at 80 degrees.
pub fn tilt(parts: &BenchParts, repeats: usize, seed: u64) -> Result<Vec<(f64, Start)>, Error> {
    let mut stream = Stream::new(seed, "tilt test");
    (1..=repeats)
        .map(|repeat| one(parts, stream.between(0.0, std::f64::consts::TAU), repeat))
        .collect()
}

/// One seed, turned by an angle (rad) about its long axis.
fn one(parts: &BenchParts, angle: f64, repeat: usize) -> Result<(f64, Start), Error> {
    // The long axis is the body's x axis; it is laid along z, across the slope.
    let across = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -std::f64::consts::FRAC_PI_2);
    let turn = across * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    let spheres = parts.body.outer.spheres().iter();
    let reach = spheres
        .map(|s| s.radius - (turn * s.centre).y)
        .fold(0.0, f64::max);
    let start = Placement::at_rest(0, Vector3::y() * (reach + 1e-6), turn);
    let mut world = World::new(
        settings(parts, Vector3::zeros()),
        vec![template(parts)],
        parts.interactions.clone(),
        vec![plate()],
        &[start],
    )?;
    let weight = parts.body.clump.mass() * parts.gravity;
    let limit = REST + 80_f64.to_radians() / RATE;
    let mut rested = None;
    while world.time() < limit {
        let tilt = (world.time() - REST).max(0.0) * RATE;
        let pull = Vector3::new(tilt.sin(), -tilt.cos(), 0.0) * weight;
        world.step_with(|bodies| bodies.force[0] += pull)?;
        if world.time() < REST {
            continue;
        }
        let bodies = world.bodies();
        let (position, orientation) = (bodies.position[0], bodies.orientation[0]);
        let (from, before) = *rested.get_or_insert((position, orientation));
        let turned = (orientation * before.inverse()).scaled_axis().z.abs();
        let way = (position - from).norm();
        if turned > TURN {
            return Ok((tilt.tan(), Start::Rolled));
        }
        if way > WAY * parts.body.clump.bounding_radius() {
            return Ok((tilt.tan(), Start::Slid));
        }
    }
    Err(Error::NoEvent {
        repeat,
        what: "the seed does not start to roll",
        limit,
    })
}
