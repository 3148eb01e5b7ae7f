//! Worlds that can no longer be believed are named with body, place and time.

use crate::scene::{ball, plane, rough, run, settings, world};
use dem_solver::{Error, HealthLimits, Placement, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Radius of the balls, m.
const RADIUS: f64 = 2e-3;

fn limits() -> HealthLimits {
    HealthLimits {
        low: Vector3::repeat(-0.1),
        high: Vector3::repeat(0.1),
        speed: 2.0,
        overlap: 0.2,
    }
}

/// Two balls over a plane, the second at a place (m) with a velocity (m/s).
fn two_balls(position: Vector3<f64>, velocity: Vector3<f64>) -> World {
    let first = Placement::at_rest(0, Vector3::y() * 0.05, UnitQuaternion::identity());
    let second = Placement {
        position,
        velocity,
        ..first
    };
    let walls = vec![plane(Vector3::zeros(), Vector3::y())];
    let settings = settings(1e-5, Vector3::zeros());
    let starts = [first, second];
    world(
        settings,
        &rough(0.5, 0.3),
        vec![ball(RADIUS)],
        walls,
        &starts,
    )
}

fn complaint(world: &World) -> Error {
    world
        .check_health(&limits())
        .expect_err("something is wrong")
}

#[test]
fn healthy_world_is_left_alone() {
    let mut world = two_balls(Vector3::new(0.03, 0.05, 0.0), Vector3::zeros());
    run(&mut world, 100);
    assert_eq!(world.check_health(&limits()), Ok(()));
}

#[test]
fn lost_body_is_named_with_its_place_and_time() {
    let mut world = two_balls(Vector3::new(0.0999, 0.05, 0.0), Vector3::x());
    run(&mut world, 100);
    let error = complaint(&world);
    let Error::Lost {
        body: 1, position, ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(position, "(0.10090, 0.05000, 0.00000)");
}

#[test]
fn flying_body_is_named_with_its_speed_and_the_time_step() {
    let mut world = two_balls(Vector3::new(0.03, 0.05, 0.0), Vector3::y() * 3.0);
    run(&mut world, 10);
    let error = complaint(&world);
    let Error::Flying {
        body: 1,
        speed,
        time_step,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((speed, time_step), (3.0, 1e-5));
}

/// Centres at 3.2 mm: the overlap is 0.8 mm, 0.4 of the radius.
#[test]
fn deep_overlap_is_named_with_both_bodies() {
    let mut world = two_balls(Vector3::new(3.2e-3, 0.05, 0.0), Vector3::zeros());
    run(&mut world, 1);
    let error = complaint(&world);
    assert!(
        matches!(error, Error::TooDeep { i: 0, j: 1, .. }),
        "{error}"
    );
}
