//! A step in the flow takes no memory.

use dem_solver::{DashpotMass, Placement, Template, World};
use nalgebra::{UnitQuaternion, Vector3};
use verification::worlds::{self, box_of_planes, clipped, cluster, settings, soft_surface};

/// 64 seeds of two spheres in a box that is shaken by gravity along its diagonal, which turns about an axis.
fn world() -> World {
    let seed = cluster(&[-0.5e-3, 0.5e-3].map(|x| ([x, 0.0, 0.0], 1.5e-3))).expect("a body");
    let starts = (0..64).map(|i| {
        let place = |k: u32| (f64::from(i / 4_i32.pow(k) % 4) - 1.5) * 5e-3;
        let centre = Vector3::new(place(0), place(1), place(2));
        Placement::at_rest(0, centre, UnitQuaternion::identity())
    });
    worlds::world(
        settings(2e-5, Vector3::zeros(), 2e-3),
        &clipped(soft_surface([0.4, 0.4, 0.05]).expect("possible")),
        vec![Template::new(&seed, 0, DashpotMass::Body)],
        box_of_planes(0.0125),
        &starts.collect::<Vec<_>>(),
    )
    .expect("possible")
}

/// Gravity turns twice in a second about the diagonal of the box, so that all seeds tumble and pairs meet and part in every
/// turn; after 16 turns, when the longest list has been seen, 10 000 steps take no memory at all.
#[test]
fn a_step_in_the_flow_takes_no_memory() {
    let mut world = world();
    let mut step = 0_u32;
    let mut turn = |world: &mut World, steps: u32| {
        for _ in 0..steps {
            let angle = f64::from(step) * 2e-5 * 4.0 * std::f64::consts::PI;
            let gravity = Vector3::new(angle.cos(), angle.sin(), 0.5) * 9.81;
            world.set_gravity(gravity).expect("a finite vector");
            world.step().expect("steps");
            step += 1;
        }
    };
    turn(&mut world, 400_000);
    let before = world.bodies().position.clone();
    let taken = allocation_counter::measure(|| turn(&mut world, 10_000));
    let moved = world.bodies().position.iter().zip(&before);
    let moved = moved
        .map(|(to, from)| (to - from).norm())
        .fold(f64::INFINITY, f64::min);
    assert!(moved > 1e-4, "a seed lies still: {moved} m");
    assert_eq!(taken.count_total, 0, "{} bytes", taken.bytes_total);
}
