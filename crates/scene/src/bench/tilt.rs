//! The tilted plate: the tangent of the angle at which a seed starts to roll.

use super::plate::{Plate, moved};
use super::{BenchParts, Repeat};
use crate::Error;
use contact_law::rolling_constant_torque::SMALL_SPIN;
use dem_solver::{Load, Placement};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// How much finer than a bed it is stepped, as the [sled](super::slider) is and for its reason. On a plate of seeds a seed
/// first rolls into a hollow, and which one it finds changes with the step as with its starting place.
pub(super) const FINER: f64 = 4.0;

/// Seeds along each side of a plate of seeds.
const SIDE: usize = 5;

/// Rate of the tilt, rad/s: 5 degrees a second.
const RATE: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Time of the tilt, to 80 degrees, s.
const TILTING: f64 = 80.0 / 5.0;

/// Time for the seed to come to rest on the level plate, s.
const REST: f64 = 0.3;

/// Longest time for it on a plate of seeds, where it first rolls into a hollow, s.
const LONGEST_REST: f64 = 2.0;

/// Time without motion after which it rests there, s.
const STILL: f64 = 0.1;

/// Rolling has begun when the seed has turned by this angle about its long axis without a stop, rad.
const TURN: f64 = 0.5;

/// Sliding has begun when it has gone this way in seed radii without a stop and without turning so far.
const WAY: f64 = 2.0;

/// Seeds put on plates of seeds until one starts, at most.
const TRIES: usize = 10;

/// Spin up to which a seed has not started, rad/s; at its bounding radius this is the speed. So fast a seed can creep under
/// rolling friction of type A, which holds nothing at rest: what it resists at most is overcome at this spin.
const CREEP: f64 = SMALL_SPIN;

/// Tangent of the starting angle for `repeats` seeds, and whether each slid instead of rolling, in which case the angle
/// gives the static friction. The starting angle is the last at which the seed crept or rested before it rolled or slid
/// away, not the angle at which the motion is detected.
///
/// The long axis lies across the slope, as on the bench; the seed is turned about it at random and
/// comes to rest before the plate is tilted. A plate of seeds is laid again for each repeat, and the
/// seed put on it at a random place within half a seed of its middle. A seed that still rests at 80 degrees, wedged between
/// others, is placed again, as one would on the bench; the repeat counts it.
///
/// # Errors
///
/// A solver that stops; a seed that never starts on a smooth plate, or ten in a row on a plate of seeds.
pub(super) fn tilt(parts: &BenchParts, repeats: usize, seed: u64) -> Result<Vec<Repeat>, Error> {
    let mut stream = Stream::new(seed, "tilt test");
    let mut one_that_starts = |repeat| {
        // On a smooth plate all places are alike.
        for n_held in 0..if parts.on_seeds { TRIES } else { 1 } {
            let angle = stream.between(0.0, std::f64::consts::TAU);
            let plate = Plate::of(parts, SIDE, SIDE, &mut stream);
            let aside = plate.place(parts, &mut stream);
            if let Some(found) = one(parts, &plate, (angle, aside))? {
                return Ok(Repeat { n_held, ..found });
            }
        }
        Err(Error::NoEvent {
            repeat,
            what: "no seed starts to roll",
            limit: TILTING,
        })
    };
    (1..=repeats).map(&mut one_that_starts).collect()
}

/// One seed, turned by an angle (rad) about its long axis, aside of the middle of the plate (m); `None` if it
/// never starts.
fn one(
    parts: &BenchParts,
    plate: &Plate,
    (angle, aside): (f64, Vector3<f64>),
) -> Result<Option<Repeat>, Error> {
    // The long axis is the body's x axis; it is laid along z, across the slope.
    let across = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -std::f64::consts::FRAC_PI_2);
    let turn = across * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    let lift = plate.lift(&moved(parts.turned(&turn), aside));
    let start = Placement::at_rest(0, aside + Vector3::y() * (lift + 1e-6), turn);
    let mut world = plate.world(parts, parts.template.clone(), start)?;
    let weight = parts.weight();
    let (mut moving, mut rested_at) = (0.0, None);
    let mut begun = None;
    while rested_at.is_none_or(|since| world.time() - since < TILTING) {
        let now = world.time();
        let tilt = rested_at.map_or(0.0, |since| now - since) * RATE;
        let pull = Vector3::new(tilt.sin(), -tilt.cos(), 0.0) * weight;
        world.step_with(|bodies| bodies.load[0] += Load::of_force(&pull))?;
        if rested_at.is_none() {
            if !parts.is_at_rest(&world) {
                moving = now;
            }
            let is_still = !parts.on_seeds || now - moving > STILL || now > LONGEST_REST;
            if now >= REST && is_still {
                rested_at = Some(world.time());
            }
            continue;
        }
        let bodies = world.bodies();
        let (position, orientation) = (bodies.position[0], bodies.orientation[0]);
        let creeps =
            bodies.spin[0].norm() <= CREEP && bodies.velocity[0].norm() <= CREEP * parts.radius;
        let here = (position, orientation, tilt);
        if creeps {
            begun = Some(here);
        }
        let (from, before, started_at) = *begun.get_or_insert(here);
        let rolled = has_rolled(&(orientation * before.inverse()));
        let way = (position - from).norm();
        let slid = way > WAY * parts.radius;
        if rolled || slid {
            return Ok(Some(Repeat::new(started_at.tan(), !rolled, &world)));
        }
    }
    Ok(None)
}

/// Whether a turn since the start goes by [`TURN`] about the long axis, which lies along z. Asked in each step: no angle is more
/// than pi times the length of the vector part, which is far cheaper to find.
fn has_rolled(turn: &UnitQuaternion<f64>) -> bool {
    let may_have = turn.imag().norm() > TURN / std::f64::consts::PI;
    may_have && turn.scaled_axis().z.abs() > TURN
}

#[cfg(test)]
mod tests {
    use super::{TURN, has_rolled};
    use nalgebra::{UnitQuaternion, UnitVector3, Vector3};

    /// Turns of up to half a revolution, both ways, about the long axis and about one that leans by 37 degrees: what counts is
    /// the part along the long axis, 1 and 0.8 of the angle. A thousandth beside the limit decides.
    #[test]
    fn rolling_begins_at_its_turn_about_the_long_axis() {
        for (axis, part) in [
            (Vector3::z(), 1.0),
            (Vector3::new(0.6, 0.0, 0.8), 0.8),
            (Vector3::x(), 0.0),
        ] {
            let axis = UnitVector3::new_normalize(axis);
            for share in [0.0, 0.3, 0.999, 1.001, 1.5, 4.0] {
                for limit in [TURN, -TURN, TURN / 0.8, -TURN / 0.8] {
                    let angle = share * limit;
                    let turn = UnitQuaternion::from_axis_angle(&axis, angle);
                    let expected = angle.abs() * part > TURN;
                    assert_eq!(has_rolled(&turn), expected, "{angle} about {axis:?}");
                }
            }
        }
    }
}
