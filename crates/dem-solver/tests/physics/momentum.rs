//! Linear and angular momentum of bodies that feel only each other.

use crate::scene::{run, scattered, seed_and_block, settings, sticky, world};
use dem_solver::{Placement, World};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// A cloud that falls into its middle.
fn cloud() -> Vec<Placement> {
    let mut starts = scattered([0.0106; 3], 1.0, 0.2, &mut Stream::new(4, "cloud"));
    for start in &mut starts {
        start.velocity -= start.position * 60.0;
    }
    starts
}

/// Linear momentum (kg m/s) and angular momentum about the origin (kg m²/s).
struct Momentum {
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    /// Sums of the sizes of all parts: the scale of rounding.
    sizes: [f64; 2],
}

fn momentum(world: &World) -> Momentum {
    let bodies = world.bodies();
    let mut total = Momentum {
        linear: Vector3::zeros(),
        angular: Vector3::zeros(),
        sizes: [0.0; 2],
    };
    for k in 0..bodies.len() {
        let linear = bodies.velocity[k] * world.templates()[bodies.template[k]].mass();
        let angular = bodies.position[k].cross(&linear) + bodies.angular_momentum[k];
        total.linear += linear;
        total.angular += angular;
        total.sizes[0] += linear.norm();
        total.sizes[1] += angular.norm();
    }
    total
}

/// Each contact gives both bodies opposite forces at one point, and the scheme moves a body along
/// its new velocity, so both momenta are kept by each step but for rounding: 1e-16 of the forces
/// times some thousand steps.
#[test]
fn cloud_keeps_both_momenta() {
    let settings = settings(1e-5, Vector3::zeros());
    let mut world = world(
        settings,
        &sticky(),
        seed_and_block(1.0),
        Vec::new(),
        &cloud(),
    );
    let before = momentum(&world);
    let mut seen = 0;
    for _ in 0..60 {
        run(&mut world, 50);
        seen += world.census().sphere_contacts;
    }
    let after = momentum(&world);
    assert!(seen > 200, "the cloud hardly collides: {seen} contacts");
    let linear = (after.linear - before.linear).norm() / before.sizes[0];
    let angular = (after.angular - before.angular).norm() / before.sizes[1];
    assert!(linear < 1e-12, "linear momentum changes by {linear}");
    assert!(angular < 1e-12, "angular momentum changes by {angular}");
}

/// A turned and moving observer sees the same collision: all laws depend on relative motion only.
/// The bodies stay together for some contacts only, so that rounding (1e-16) grows to less than
/// 1e-9 of the path.
#[test]
fn collision_does_not_depend_on_the_frame() {
    let turn = UnitQuaternion::from_euler_angles(0.4, -1.2, 2.2);
    let boost = Vector3::new(0.3, -0.1, 0.2);
    let starts: Vec<_> = cloud().into_iter().take(2).collect();
    let seen: Vec<_> = starts
        .iter()
        .map(|start| Placement {
            position: turn * start.position,
            orientation: turn * start.orientation,
            velocity: turn * start.velocity + boost,
            spin: turn * start.spin,
            ..*start
        })
        .collect();
    let worlds = [starts, seen].map(|mut starts| {
        // Both fly at each other along their line of centres, and turn.
        let line = (starts[1].position - starts[0].position).normalize();
        starts[0].velocity += line * 0.5;
        let settings = settings(1e-6, Vector3::zeros());
        let mut world = world(
            settings,
            &sticky(),
            seed_and_block(1.0),
            Vec::new(),
            &starts,
        );
        let mut touched = 0;
        for _ in 0..2000 {
            run(&mut world, 5);
            touched += usize::from(world.census().sphere_contacts > 0);
        }
        assert!(touched > 10, "the bodies miss each other");
        world
    });
    let [plain, other] = worlds;
    for k in 0..2 {
        let expected = turn * plain.bodies().position[k] + boost * plain.time();
        let error = (other.bodies().position[k] - expected).norm();
        assert!(error < 1e-9 * 7e-3, "body {k} is off by {error} m");
        let expected = turn * plain.bodies().spin[k];
        let error = (other.bodies().spin[k] - expected).norm();
        assert!(
            error < 1e-9 * expected.norm(),
            "spin of body {k} is off by {error} rad/s"
        );
    }
}
