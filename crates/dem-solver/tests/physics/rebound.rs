//! Rebound of spheres: restitution and duration of the law come out of the world.

use crate::scene::{DENSITY, ball, material, plane, rough, run, settings, world};
use contact_law::material::effective_moduli;
use dem_solver::{Placement, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Radius of the spheres, m.
const RADIUS: f64 = 2e-3;

/// Speed of approach, m/s.
const SPEED: f64 = 0.2;

/// Time step, a ten-thousandth of the contact, s.
const STEP: f64 = 5e-8;

/// How a collision ended.
struct Rebound {
    /// Speed of separation over speed of approach.
    restitution: f64,
    /// Duration of the contact, s.
    duration: f64,
}

/// Runs until the contact that `touches` sees has come and gone.
fn collide(world: &mut World, touches: fn(&World) -> bool) -> f64 {
    let mut n_touching = 0;
    for _ in 0..60_000 {
        run(world, 1);
        if touches(world) {
            n_touching += 1;
        } else if n_touching > 0 {
            break;
        }
    }
    assert!(n_touching > 0 && !touches(world), "no complete contact");
    f64::from(n_touching) * STEP
}

fn thrown(x: f64, speed: f64) -> Placement {
    let start = Placement::at_rest(0, Vector3::new(x, 0.0, 0.0), UnitQuaternion::identity());
    Placement {
        velocity: Vector3::x() * speed,
        ..start
    }
}

fn against_a_plane(restitution: f64) -> Rebound {
    let walls = vec![plane(Vector3::zeros(), Vector3::x())];
    let settings = settings(STEP, Vector3::zeros());
    let start = thrown(RADIUS * 1.0001, -SPEED);
    let mut world = world(
        settings,
        &rough(restitution, 0.2),
        vec![ball(RADIUS)],
        walls,
        &[start],
    );
    let duration = collide(&mut world, |world| world.n_wall_contacts() > 0);
    Rebound {
        restitution: world.bodies().velocity[0].x / SPEED,
        duration,
    }
}

fn against_each_other(restitution: f64) -> Rebound {
    let settings = settings(STEP, Vector3::zeros());
    let starts = [
        thrown(-RADIUS * 1.0001, 0.5 * SPEED),
        thrown(RADIUS * 1.0001, -0.5 * SPEED),
    ];
    let surface = rough(restitution, 0.2);
    let mut world = world(settings, &surface, vec![ball(RADIUS)], Vec::new(), &starts);
    let duration = collide(&mut world, |world| world.census().sphere_contacts > 0);
    let velocity = &world.bodies().velocity;
    Rebound {
        restitution: (velocity[1].x - velocity[0].x) / SPEED,
        duration,
    }
}

/// With an attractive end the damping formula returns the restitution that was put in. The
/// formula is exact for this law; 0.001 covers the first order of the step in the dashpot.
#[test]
fn rebound_has_the_restitution_of_the_law() {
    for e in [0.06, 0.42, 0.9, 1.0] {
        for rebound in [against_a_plane(e), against_each_other(e)] {
            let error = (rebound.restitution - e).abs();
            assert!(error < 0.001, "in {e}, out {}", rebound.restitution);
        }
    }
}

/// Hertz: 2.9432 (15 m* / (16 E* sqrt(R*)))^(2/5) v^(-1/5); two steps of 10 000 cover that a
/// contact is counted in whole steps.
#[test]
fn elastic_contact_lasts_as_long_as_hertz_says() {
    let young = effective_moduli(&material(), &material()).young;
    let mass = DENSITY * geometry::clump::volume_of_sphere(RADIUS);
    let hertz = |mass: f64, radius: f64| {
        2.9432 * (15.0 * mass / (16.0 * young * radius.sqrt())).powf(0.4) * SPEED.powf(-0.2)
    };
    let wall = against_a_plane(1.0).duration / hertz(mass, RADIUS) - 1.0;
    let pair = against_each_other(1.0).duration / hertz(0.5 * mass, 0.5 * RADIUS) - 1.0;
    assert!(wall.abs() < 3e-4, "wall: off by {wall}");
    assert!(pair.abs() < 3e-4, "pair: off by {pair}");
}
