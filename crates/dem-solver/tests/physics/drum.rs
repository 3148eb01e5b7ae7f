//! Walls that spin: what they drag, and which way.

use crate::scene::{GRAVITY, ball, material, plane, resting_overlap, rough, run, settings, world};
use contact_law::PairParameters;
use dem_solver::{InteractionSettings, Placement, Settings, Shape, Wall, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Radius of the ball, m.
const RADIUS: f64 = 2e-3;

/// Inner radius of the drum, m.
const DRUM: f64 = 0.05;

/// A drum that lies along z, gravity along -y, with one ball.
fn ball_in_a_drum(start: Placement, spin: f64, rolling_friction: f64) -> World {
    let shape = Shape::Cylinder { radius: DRUM };
    let shell = Wall {
        name: "shell".into(),
        shape,
        material: 0,
        spin,
    };
    let parameters = PairParameters {
        restitution: 0.3,
        static_friction: 0.4,
        rolling_friction,
    };
    let surface = InteractionSettings {
        parameters,
        materials: [material(); 2],
        ..rough(0.3, 0.4)
    };
    let settings = settings(2e-5, Vector3::new(0.0, -GRAVITY, 0.0));
    world(
        settings,
        &surface,
        vec![ball(RADIUS)],
        vec![shell],
        &[start],
    )
}

/// A ball that rests on the shell at an angle from the bottom (rad).
fn resting(angle: f64) -> Placement {
    let radius = DRUM - RADIUS + resting_overlap(RADIUS, GRAVITY);
    let position = Vector3::new(angle.sin(), -angle.cos(), 0.0) * radius;
    Placement::at_rest(0, position, UnitQuaternion::identity())
}

/// A positive spin is counter-clockwise about z: the bottom of the drum moves towards +x, drags
/// the ball there with mu g, and lifts it.
#[test]
fn drum_lifts_a_ball_to_the_side_to_which_its_bottom_moves() {
    for sign in [1.0, -1.0] {
        let mut world = ball_in_a_drum(resting(0.0), sign * 5.0, 0.0);
        let bottom = world.bodies().position[0].y;
        run(&mut world, 500);
        let velocity = world.bodies().velocity[0].x * sign;
        // Sliding still: mu g t, less the curvature of the wall and the first loading.
        let expected = 0.4 * GRAVITY * world.time();
        assert!(
            (velocity / expected - 1.0).abs() < 0.02,
            "{velocity} m/s, expected {expected} m/s"
        );
        assert!(
            world.bodies().position[0].y > bottom,
            "the ball does not rise"
        );
        assert!(
            world.wall_load()[0].x * sign < 0.0,
            "the drum feels the opposite force"
        );
    }
}

/// A ball that rolls on the spot in a turning drum hangs where gravity along the wall balances
/// the friction that the rolling resistance calls for: tan(phi) = `mu_r`, on the rising side.
///
/// Put there, it stays for two periods of its swinging, 2 pi sqrt(7/5 (`R_drum` - R) / g) = 0.5 s.
/// 1 % covers the overlap (0.3 % of R) and the first loading of the tangential spring.
#[test]
fn rolling_ball_hangs_at_the_angle_of_its_rolling_resistance() {
    let spin = Vector3::z() * (4.0 * DRUM / RADIUS);
    let start = Placement {
        spin,
        ..resting(0.1_f64.atan())
    };
    let mut world = ball_in_a_drum(start, 4.0, 0.1);
    for _ in 0..50 {
        run(&mut world, 1000);
        let position = world.bodies().position[0];
        let tangent = position.x / -position.y;
        assert!(
            (tangent / 0.1 - 1.0).abs() < 0.01,
            "tangent {tangent} at {} s",
            world.time()
        );
    }
    let turn = world.bodies().spin[0].z / spin.z;
    assert!(
        (turn - 1.0).abs() < 0.01,
        "the ball does not roll: {turn} of the spin"
    );
}

/// A turntable drags a ball along its own surface velocity, spin times z times position.
#[test]
fn turntable_drags_a_ball_along_its_surface() {
    let mut table = plane(Vector3::zeros(), Vector3::z());
    table.spin = 10.0;
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY);
    let position = Vector3::new(0.03, 0.04, height);
    let start = Placement::at_rest(0, position, UnitQuaternion::identity());
    let settings = settings(1e-5, Vector3::z() * -GRAVITY);
    let mut world = world(
        settings,
        &rough(0.3, 0.2),
        vec![ball(RADIUS)],
        vec![table],
        &[start],
    );
    run(&mut world, 500);
    let drag = world.bodies().velocity[0] / (0.2 * GRAVITY * world.time());
    let error = (drag - Vector3::new(-0.8, 0.6, 0.0)).norm();
    // The spring loads within some 1e-6 m at 0.5 m/s, and the direction turns by 0.2 %.
    assert!(error < 0.01, "drag {drag}");
}

/// A body pushed through the wall is pushed back in, however deep its spheres are.
#[test]
fn ball_far_through_the_shell_comes_back() {
    let deep = Placement {
        position: Vector3::y() * -(DRUM - 1e-6),
        ..resting(0.0)
    };
    let mut world = ball_in_a_drum(deep, 0.0, 0.0);
    run(&mut world, 1);
    assert!(
        world.bodies().velocity[0].y > 0.0,
        "{}",
        world.bodies().velocity[0]
    );
}

/// A ball that flies along with the drum stands nearly still in the frame of the drum, but not
/// in that of a plate across its way.
#[test]
fn ball_that_flies_along_with_the_drum_hits_a_plate_at_rest() {
    let shape = Shape::Cylinder { radius: DRUM };
    let shell = Wall {
        name: "shell".into(),
        shape,
        material: 0,
        spin: 10.0,
    };
    let gap = 1e-3;
    let shape = Shape::Rectangle {
        centre: Vector3::new(0.03, RADIUS + gap, 0.0),
        half_edges: [Vector3::x() * 5e-3, Vector3::z() * 5e-3],
    };
    let plate = Wall {
        name: "plate".into(),
        shape,
        material: 0,
        spin: 0.0,
    };
    let position = Vector3::x() * 0.03;
    let velocity = Vector3::y() * (0.03 * 10.0);
    let start = Placement::at_rest(0, position, UnitQuaternion::identity());
    let start = Placement {
        velocity,
        spin: Vector3::z() * 10.0,
        ..start
    };
    let settings = Settings {
        margin: 5e-3,
        ..settings(2e-5, Vector3::zeros())
    };
    let walls = vec![shell, plate];
    let mut world = world(
        settings,
        &rough(0.5, 0.0),
        vec![ball(RADIUS)],
        walls,
        &[start],
    );
    run(&mut world, 300);
    let velocity = world.bodies().velocity[0].y;
    assert!(velocity < 0.0, "the ball flies on with {velocity} m/s");
}

/// Rolling resistance acts against the spin relative to the wall: a ball on the axis of a
/// turntable is taken along, within 2 R spin / (5 `mu_r` g) = 8 ms, and then turns with it. What
/// is left after 50 ms fades with 2500 per second.
#[test]
fn turntable_takes_a_ball_on_its_axis_along() {
    let mut table = plane(Vector3::zeros(), Vector3::z());
    table.spin = 10.0;
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY);
    let start = Placement::at_rest(0, Vector3::z() * height, UnitQuaternion::identity());
    let parameters = PairParameters {
        restitution: 0.3,
        static_friction: 0.2,
        rolling_friction: 0.1,
    };
    let surface = InteractionSettings {
        parameters,
        ..rough(0.3, 0.2)
    };
    let settings = settings(1e-5, Vector3::z() * -GRAVITY);
    let mut world = world(
        settings,
        &surface,
        vec![ball(RADIUS)],
        vec![table],
        &[start],
    );
    run(&mut world, 400);
    let spin = world.bodies().spin[0].z / (2.5 * 0.1 * GRAVITY / RADIUS * world.time());
    assert!(
        (spin - 1.0).abs() < 0.01,
        "{spin} of the spin expected at 4 ms"
    );
    run(&mut world, 4600);
    let error = (world.bodies().spin[0] - Vector3::z() * 10.0).norm();
    assert!(error < 1e-6, "off by {error} rad/s");
}
