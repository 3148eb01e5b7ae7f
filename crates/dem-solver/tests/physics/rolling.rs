//! A ball on a level plane: from sliding to rolling, and rolling resistance.

use crate::scene::{GRAVITY, ball, plane, resting_overlap, rough, run, settings, world};
use contact_law::PairParameters;
use dem_solver::{InteractionSettings, Placement, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Radius of the ball, m.
const RADIUS: f64 = 2e-3;

/// Speed of the throw, m/s.
const SPEED: f64 = 0.3;

/// A ball on the plane y = 0, pressed in by its weight, with a velocity along x and a spin.
fn on_the_plane(surface: &InteractionSettings, spin: f64) -> World {
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY);
    let start = Placement {
        velocity: Vector3::x() * SPEED,
        spin: Vector3::z() * spin,
        ..Placement::at_rest(0, Vector3::y() * height, UnitQuaternion::identity())
    };
    let settings = settings(1e-5, Vector3::new(0.0, -GRAVITY, 0.0));
    let walls = vec![plane(Vector3::zeros(), Vector3::y())];
    world(settings, surface, vec![ball(RADIUS)], walls, &[start])
}

/// Friction acts at the arm R - d/2 (d is the overlap) instead of R, which changes each result
/// by about d/R.
fn flattening() -> f64 {
    resting_overlap(RADIUS, GRAVITY) / RADIUS
}

/// Angular momentum about the point of contact is kept: m v R + 0 = m v' R + (2/5) m R² w with
/// v' = w R gives v' = 5/7 v. Sliding lasts 2 v / (7 mu g) = 0.03 s.
#[test]
fn thrown_ball_ends_rolling_at_five_sevenths_of_its_speed() {
    let mut world = on_the_plane(&rough(0.5, 0.3), 0.0);
    run(&mut world, 2000);
    let early = world.bodies().velocity[0].x;
    let expected = SPEED - 0.3 * GRAVITY * world.time();
    assert!(
        (early / expected - 1.0).abs() < 1e-3,
        "sliding: {early} m/s, expected {expected} m/s"
    );
    run(&mut world, 8000);
    let (velocity, spin) = (world.bodies().velocity[0].x, world.bodies().spin[0].z);
    let error = velocity / (5.0 / 7.0 * SPEED) - 1.0;
    assert!(error.abs() < 2.0 * flattening(), "speed off by {error}");
    // A remainder of the tangential vibration swings in the contact: 1e-3.
    let rolling = -spin * RADIUS / velocity - 1.0;
    assert!(
        rolling.abs() < flattening() + 1e-3,
        "not rolling: off by {rolling}"
    );
}

/// Rolling resistance slows the ball by (5/7) `mu_r` g: the torque `mu_r N R` acts against the
/// moment of inertia about the point of contact, (7/5) m R².
#[test]
fn rolling_resistance_slows_by_five_sevenths_of_its_coefficient() {
    let parameters = PairParameters {
        restitution: 0.5,
        static_friction: 0.3,
        rolling_friction: 0.02,
    };
    let surface = InteractionSettings {
        parameters,
        ..rough(0.5, 0.3)
    };
    let mut world = on_the_plane(&surface, -SPEED / RADIUS);
    run(&mut world, 5000);
    let (time, velocity) = (world.time(), world.bodies().velocity[0].x);
    run(&mut world, 10_000);
    let slowing = (velocity - world.bodies().velocity[0].x) / (world.time() - time);
    let error = slowing / (5.0 / 7.0 * 0.02 * GRAVITY) - 1.0;
    assert!(
        error.abs() < 2.0 * flattening() + 1e-3,
        "slowing off by {error}"
    );
}
