//! Bodies on an inclined plane.
//!
//! The plane is y = 0; gravity is tilted by the angle of the incline towards +x.

use crate::scene::{GRAVITY, ball, cluster, plane, resting_overlap, rough, run, settings, world};
use dem_solver::{DashpotMass, Placement, Settings, Template, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Radius of all spheres, m.
const RADIUS: f64 = 2e-3;

/// Static friction.
const FRICTION: f64 = 0.5;

fn tilted(angle: f64) -> Settings {
    settings(1e-5, Vector3::new(angle.sin(), -angle.cos(), 0.0) * GRAVITY)
}

fn on_the_plane(template: Template, angle: f64, height: f64) -> World {
    let start = Placement::at_rest(0, Vector3::y() * height, UnitQuaternion::identity());
    let walls = vec![plane(Vector3::zeros(), Vector3::y())];
    world(
        tilted(angle),
        &rough(0.3, FRICTION),
        vec![template],
        walls,
        &[start],
    )
}

/// Four spheres on the corners of a flat square of 8 mm, which cannot roll.
fn block() -> Template {
    let corners = [[-4e-3, -4e-3], [-4e-3, 4e-3], [4e-3, -4e-3], [4e-3, 4e-3]];
    // The principal axes come in the order of the moments: the thin axis of the square is z.
    cluster(
        &corners.map(|[x, y]| ([x, y, 0.0], RADIUS)),
        0,
        DashpotMass::Body,
    )
}

/// The block lies on the plane with its thin axis upright.
fn block_on_the_plane(angle: f64) -> World {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    // Each of the four spheres carries the weight of one.
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY * angle.cos());
    let start = Placement::at_rest(0, Vector3::y() * height, turn);
    let walls = vec![plane(Vector3::zeros(), Vector3::y())];
    world(
        tilted(angle),
        &rough(0.3, FRICTION),
        vec![block()],
        walls,
        &[start],
    )
}

/// A rolling ball has 7/5 of its mass as inertia: a = 5/7 g sin(theta), as long as
/// tan(theta) < 7/2 mu. The arm R - d/2 and the tangential spring, which first takes up
/// a slip of about d mu, leave an error of the order of d/R.
#[test]
fn ball_rolls_down_with_five_sevenths_of_the_pull() {
    for degrees in [5.0_f64, 20.0, 40.0] {
        let angle = degrees.to_radians();
        let overlap = resting_overlap(RADIUS, GRAVITY * angle.cos());
        let mut world = on_the_plane(ball(RADIUS), angle, RADIUS - overlap);
        run(&mut world, 10_000);
        let (time, velocity) = (world.time(), world.bodies().velocity[0].x);
        run(&mut world, 10_000);
        let pull = (world.bodies().velocity[0].x - velocity) / (world.time() - time);
        let error = pull / (5.0 / 7.0 * GRAVITY * angle.sin()) - 1.0;
        assert!(
            error.abs() < 2.0 * overlap / RADIUS + 1e-3,
            "at {degrees} deg off by {error}"
        );
    }
}

/// Above tan(theta) = 7/2 mu the ball slides: a = g (sin(theta) - mu cos(theta)).
#[test]
fn ball_slides_down_a_steep_plane() {
    let angle = 70.0_f64.to_radians();
    let overlap = resting_overlap(RADIUS, GRAVITY * angle.cos());
    let mut world = on_the_plane(ball(RADIUS), angle, RADIUS - overlap);
    run(&mut world, 10_000);
    let expected = GRAVITY * (angle.sin() - FRICTION * angle.cos()) * world.time();
    let error = world.bodies().velocity[0].x / expected - 1.0;
    // The spring yields for the first of about 10 000 steps only.
    assert!(error.abs() < 5e-3, "off by {error}");
}

/// Below the friction angle the block comes to rest within the slip of its springs, a few
/// overlaps, and stays there for good.
#[test]
fn block_sticks_below_the_friction_angle() {
    let angle = 0.9 * FRICTION.atan();
    let mut world = block_on_the_plane(angle);
    run(&mut world, 20_000);
    let overlap = resting_overlap(RADIUS, GRAVITY);
    let before = world.bodies().position[0].x;
    assert!(before.abs() < 5.0 * overlap, "slid by {before} m");
    run(&mut world, 20_000);
    let creep = world.bodies().position[0].x - before;
    assert!(creep.abs() < 1e-3 * overlap, "creeps by {creep} m in 0.2 s");
}

/// Above the friction angle the block slides with g (sin(theta) - mu cos(theta)); the tilting
/// moment of the friction loads the lower spheres more, which leaves the sum as it is.
#[test]
fn block_slides_above_the_friction_angle() {
    let angle = 1.2 * FRICTION.atan();
    let mut world = block_on_the_plane(angle);
    run(&mut world, 5000);
    let (time, velocity) = (world.time(), world.bodies().velocity[0].x);
    run(&mut world, 10_000);
    let pull = (world.bodies().velocity[0].x - velocity) / (world.time() - time);
    let error = pull / (GRAVITY * (angle.sin() - FRICTION * angle.cos())) - 1.0;
    assert!(error.abs() < 0.01, "off by {error}");
}
