//! The sled (`slider`): seeds glued to a sled that is pulled over a plate; the pull over the weight is the
//! coefficient of friction.

use super::plate::{Plate, flat, glued, rigid};
use super::{BenchParts, Repeat};
use crate::Error;
use crate::extent::extent;
use dem_solver::{DashpotMass, Load, Placement};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// How much finer than a bed it is stepped. Nothing is hit: with the step of a bed the friction is the same to four digits,
/// and the longest step that `protocol.step_share` allows is still shorter than the usual one of a bed.
pub(super) const FINER: f64 = 4.0;

/// Seeds along each side of the sled.
const SIDE: usize = 3;

/// Speed of the pull, m/s. The study pulls with 100 mm/min; six times the speed saves that part of the work. Half of it shows the
/// same, twice as much 0.001 more with the seeds of the study and 0.002 more with balls of 6 mm, which come down harder.
const SPEED: f64 = 0.01;

/// Time of loading before, and of measuring while sliding, s.
const TIMES: [f64; 2] = [0.15, 0.6];

/// Friction of `repeats` pulls, each with other orientations of the glued seeds: mean pull over weight
/// while sliding.
///
/// The seeds lie flat (their shortest axis upright) and touch each other, turned at random about the
/// vertical. The sled cannot turn and moves at constant speed: a tractor holds it, as on the bench. It weighs ten times its seeds.
/// Nothing but contacts and friction takes energy.
///
/// # Formula
///
/// `sum(F_x) / (n W) - (y_2 - y_1) / (x_2 - x_1)`: the pull over the weight in the steps of the measured way, less what lifts the
/// sled from its beginning to its end. Over an endless way it ends as high as it began.
///
/// # Errors
///
/// A body that cannot be made, a solver that stops.
pub(super) fn slider(parts: &BenchParts, repeats: usize, seed: u64) -> Result<Vec<Repeat>, Error> {
    let mut stream = Stream::new(seed, "slider test");
    (0..repeats).map(|_| one(parts, &mut stream)).collect()
}

/// One pull.
fn one(parts: &BenchParts, stream: &mut Stream) -> Result<Repeat, Error> {
    let sled = glued(parts, SIDE, SIDE, stream);
    let mass = 10.0 * parts.body.clump.mass() * (SIDE * SIDE) as f64;
    let plate = Plate::of(parts, SIDE + along(parts), SIDE + 2, stream);
    let at = Vector3::y() * (plate.lift(&sled) + 1e-5);
    let start = Placement {
        velocity: Vector3::x() * SPEED,
        ..Placement::at_rest(0, at, UnitQuaternion::identity())
    };
    let mut world = plate.world(
        parts,
        rigid(parts, &sled, [mass; 2], DashpotMass::Sphere)?,
        start,
    )?;
    let weight = mass * parts.gravity;
    let (mut sum, mut n) = (0.0, 0_u32);
    let (mut began, mut ended) = (None, at);
    while world.time() < TIMES[0] + TIMES[1] {
        let is_loaded = world.time() > TIMES[0];
        world.step_with(|bodies| {
            // The tractor keeps the sled upright and straight and moves it evenly; up and down it is free.
            let force = bodies.load[0].force();
            if is_loaded {
                sum -= force.x / weight;
                n += 1;
                ended = bodies.position[0];
                began.get_or_insert(ended);
            }
            bodies.load[0] = Load::of_force(&(Vector3::y() * (force.y - weight)));
        })?;
    }
    let way = ended - began.unwrap_or(at);
    let climbed = if way.x > 0.0 { way.y / way.x } else { 0.0 };
    let shown = sum / f64::from(n.max(1)) - climbed;
    Ok(Repeat::new(shown, false, &world))
}

/// Seeds along the plate that the sled needs beside those under it: one at each end, and what it goes.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small number that is not negative"
)]
fn along(parts: &BenchParts) -> usize {
    let seed = parts.turned(&flat());
    let breadth = [0, 2].map(|axis| {
        let [from, to] = extent(&seed, axis);
        to - from
    });
    let way = SPEED * (TIMES[0] + TIMES[1]);
    // The sled starts in the middle: the plate is longer at both ends.
    2 + 2 * (way / breadth[0].min(breadth[1])).ceil().min(50.0) as usize
}
