//! The drop: a seed falls on a plate, and the height of its rebound gives the restitution.

use super::plate::{Plate, lowest, moved, of_tape};
use super::{BenchParts, Repeat};
use crate::Error;
use dem_solver::{Load, Placement, World};
use geometry::clump::Clump;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// How much finer than a bed it is stepped. The step of a bed puts about three steps into a hard contact, which is not
/// enough for the rebound of a single seed: some came back higher than they fell (restitution up to 1.06 in 40 drops). The mean of 40
/// drops of the study's seeds on resin is within 0.003 of that at a sixth of the step (docs/time-step.md).
pub(super) const FINER: f64 = 10.0;

/// Seeds along each side of a plate of seeds.
const SIDE: usize = 5;

/// Gap to the plate at which a fall is taken up, m.
const GAP: f64 = 1e-5;

/// Time after which a seed that rests, or moves too little to rise higher than before, is let go, s: longer than a contact, which
/// keeps energy in its springs, and than a seed stands still at the top of a rebound.
const REST: f64 = 0.02;

/// Directions in which the least reach of a seed is sought; neighbours are 7 degrees apart.
const DIRECTIONS: u32 = 1000;

/// Restitution of `repeats` drops from a height (m), each in a random orientation. A plate of seeds is laid
/// again for each drop, and the seed falls at a random place within half a seed of its middle.
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
        world.step_with(|bodies| {
            bodies.load[0] += Load::of_force(&(-Vector3::y() * weight));
            if parts.on_seeds {
                let force = of_tape(parts, &bodies.position[1], &bodies.velocity[1]);
                bodies.load[1] += Load::of_force(&force);
            }
        })?;
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

#[cfg(test)]
mod tests {
    use super::{least_reach, one};
    use crate::bench::BenchParts;
    use crate::bench::plate::Plate;
    use crate::{FillingLibrary, Override, Scene};
    use dev_support::fixture_files::fixture;
    use geometry::clump::Sphere;
    use nalgebra::{UnitQuaternion, Vector3};

    const TEXT: &str = r#"
        [apparatus]
        kind = "drop"
        plate = "pea"
        height = "200 mm"
        [[seed]]
        name = "ball"
        sphere = "6 mm"
        density = "1250 kg/m3"
        material = "pea"
        [material.pea]
        poisson_ratio = 0.3
        shear_modulus = "50 MPa"
        [contact.pea-pea]
        restitution = 0.4
        static_friction = 0.2
        [model]
        normal_force_end = "attractive"
    "#;

    /// A ball that falls on the top of one ball, which gives way with the mass of the ball over g: from the momentum of two bodies and
    /// the restitution of their velocities `e' = (e - g)/(1 + g)`, 0 if that is below it. The tape slows the plate by `2 100/s` over half
    /// of the contact of 0.2 ms, thus by 2 % of the 0.06 to 0.25 that it takes; steps of 1/45 of a contact err by 0.008.
    #[test]
    fn a_plate_that_gives_way_takes_momentum() {
        let shown = |give: f64| {
            let give = Override {
                name: "apparatus.plate_give".into(),
                value: give.to_string(),
            };
            let scene = Scene::from_text(TEXT, "ball.toml", &fixture("cotton"), &[give]).unwrap();
            let test = scene.apparatus.device().bench_test().unwrap();
            let parts = BenchParts::new(&scene, &FillingLibrary::default(), test).unwrap();
            let reach = least_reach(&parts.body.outer);
            assert!((reach - 3e-3).abs() < 1e-12, "{reach}");
            let below = Sphere {
                centre: Vector3::zeros(),
                radius: 3e-3,
            };
            let plate = Plate::Seeds(vec![below]);
            let straight = (UnitQuaternion::identity(), Vector3::zeros());
            let (rebound, _) = one(&parts, &plate, (0.2, reach), straight).unwrap();
            (rebound / 0.2).sqrt()
        };
        for give in [0.0, 0.05, 0.2, 0.6] {
            let expected = ((0.4_f64 - give) / (1.0 + give)).max(0.0);
            let found = shown(give);
            assert!(
                (found - expected).abs() < 0.01,
                "{give}: {found} for {expected}"
            );
        }
    }

    /// A body of two spheres of radius r whose centres are 2 a apart reaches r across at the least and r + a along: found to the 7 degrees
    /// between two directions, 1 - cos of half of it.
    #[test]
    fn the_least_reach_is_that_of_the_thin_side() {
        let spheres = [-1.0, 1.0].map(|x| Sphere {
            centre: Vector3::new(x * 2e-3, 0.0, 0.0),
            radius: 1e-3,
        });
        let properties = geometry::clump::properties_of_spheres(&spheres, 1000.0);
        let body = geometry::clump::Clump::new(&spheres, &properties).unwrap();
        let reach = least_reach(&body);
        assert!((1e-3..1.15e-3).contains(&reach), "{reach}");
    }
}
