//! The drop: a seed falls on a plate, and its rebound tells the restitution.

use super::plate::{Plate, lowest, moved};
use super::{BenchParts, Repeat};
use crate::Error;
use clump::Clump;
use dem_solver::{Load, Placement, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use random_stream::Stream;

/// How much finer than a bed it is stepped. The step of a bed puts about three steps into a hard contact, which is not
/// enough for the rebound of a single seed: some came back higher than they fell (restitution up to 1.06 in 40 drops).
pub(super) const FINER: f64 = 20.0;

/// Seeds along each side of a plate of seeds.
const SIDE: usize = 5;

/// Gap to the plate at which a fall is taken up, m.
const GAP: f64 = 1e-5;

/// Time after which a seed that rests, or moves too little to rise higher than before, is let go, s: longer than a contact, which
/// keeps energy in its springs, and than a seed stands still at the top of a rebound.
const REST: f64 = 0.02;

/// Directions in which the least reach of a seed is sought; neighbours are 7 degrees apart.
const DIRECTIONS: u32 = 1000;

/// Restitution of `repeats` drops from a height (m), each in a random orientation; on seeds, on a plate laid
/// anew, over a random place within half a seed of its middle.
///
/// As on the bench: e = sqrt(H2 / H1). H1 is the height from which the seed falls until it first touches
/// the plate. H2 is how far its lowest point rises above where that was at the first touch, at its highest
/// and whatever the seed does in between; 0 where it never comes back so high. On a smooth plate both are
/// heights of the lowest point over the plate. The fall itself is not simulated: the seed starts just
/// above the plate with the speed of its fall. A seed that leaves a plate of seeds sideways comes
/// to lie on the plane below it.
///
/// # Errors
///
/// A solver that stops.
pub(super) fn drop(
    parts: &BenchParts,
    height: f64,
    repeats: usize,
    seed: u64,
) -> Result<Vec<Repeat>, Error> {
    let mut stream = Stream::new(seed, "drop test");
    let reach = least_reach(&parts.body.outer);
    (0..repeats)
        .map(|_| {
            let [w, x, y, z] = stream.rotation();
            let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            let plate = Plate::of(parts, SIDE, SIDE, &mut stream);
            let aside = plate.place(parts, &mut stream);
            let (rebound, world) = one(parts, &plate, (height, reach), (turn, aside))?;
            Ok(Repeat::new((rebound / height).sqrt(), false, &world))
        })
        .collect()
}

/// Least reach of a body from its centre of mass in any direction, m: so high at the least is its centre above its lowest point.
fn least_reach(body: &Clump) -> f64 {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let reach = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = (golden * f64::from(k)).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        let direction = Vector3::new(ring * cos, ring * sin, z);
        let reaches = body.spheres().iter();
        reaches
            .map(|s| s.centre.dot(&direction) + s.radius)
            .fold(0.0, f64::max)
    };
    (0..DIRECTIONS).map(reach).fold(f64::INFINITY, f64::min)
}

/// Height (m) that the lowest point reaches over that of the first touch after a fall from a height (m), for a seed of a least
/// reach (m) in an orientation and at a place aside of the middle (m).
fn one(
    parts: &BenchParts,
    plate: &Plate,
    (height, least_reach): (f64, f64),
    (turn, aside): (UnitQuaternion<f64>, Vector3<f64>),
) -> Result<(f64, World), Error> {
    let spheres = moved(parts.turned(&turn), aside);
    let lift = plate.lift(&spheres);
    let first_touch = lowest(&spheres) + lift;
    let speed = (2.0 * parts.gravity * (height - GAP).max(0.0)).sqrt();
    let start = Placement {
        velocity: Vector3::y() * -speed,
        ..Placement::at_rest(0, aside + Vector3::y() * (lift + GAP), turn)
    };
    let mut world = plate.world(parts, parts.template.clone(), start)?;
    let weight = parts.weight();
    // A flight back to the height of the drop, and as long again for tumbling.
    let limit = 1.0 + 4.0 * speed / parts.gravity;
    let reach = parts.radius;
    let (mut highest, mut moving, mut touched) = (0.0_f64, 0.0, false);
    while world.time() < limit {
        world.step_with(|bodies| bodies.load[0] += Load::of_force(&(-Vector3::y() * weight)))?;
        let at = world.bodies().position[0].y;
        let low = parts.lowest(&world);
        touched |= low <= first_touch;
        if !touched {
            continue;
        }
        highest = highest.max(low - first_touch);
        let rising = world.bodies().velocity[0].y > 0.0;
        // Falling from a height at which no tip can reach the plate any more.
        let is_over = !rising && at > plate.top() + reach;
        // All motion turned into height, and the thinnest side down.
        let in_reach = at + world.kinetic_energy() / weight - least_reach - first_touch;
        if !parts.is_at_rest(&world) && in_reach > highest {
            moving = world.time();
        }
        if is_over || world.time() - moving > REST {
            return Ok((highest, world));
        }
    }
    // It rolls or rocks on where it fell; no later bounce is as high as those before.
    Ok((highest, world))
}
