//! Walls under a load, walls that are taken away, bodies that are taken out, and the momentum that all walls give.

use crate::scene::{
    ball, box_of_planes, plane, rough, run, scattered, seed_and_block, settings, sticky, world,
};
use dem_solver::{AxialLoad, Error, MeshWall, Motion, Placement, World};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// A square plate about a place on the y axis (m), with a motion.
fn plate(name: &str, height: f64, motion: Motion) -> MeshWall {
    let corner = |x: f64, z: f64| Vector3::new(0.02 * x, height, 0.02 * z);
    let [a, b, c, d] = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    MeshWall {
        name: name.into(),
        triangles: vec![[a, b, c], [a, c, d]],
        material: 0,
        motion,
    }
}

/// A load downwards (N) on a plate of a mass (kg).
fn load(force: f64, mass: f64) -> Motion {
    Motion {
        load: Some(AxialLoad {
            axis: -Vector3::y(),
            force,
            mass,
            damping_time: 2e-3,
            greatest_speed: 0.1,
        }),
        ..Motion::default()
    }
}

/// Seeds and blocks in a box under a plate with a load, on a plate that turns.
fn pressed() -> World {
    let starts = scattered([0.011; 3], 1.0, 0.3, &mut Stream::new(8, "pressed"));
    let mut world = world(
        settings(2e-5, Vector3::new(0.0, -9.81, 0.0)),
        &sticky(),
        seed_and_block(1.0),
        box_of_planes(0.0125),
        &starts,
    );
    let turning = Motion {
        spin: Vector3::y() * 3.0,
        ..Motion::default()
    };
    for wall in [
        plate("table", -0.012, turning),
        plate("lid", 0.013, load(0.3, 0.01)),
    ] {
        world.add_mesh_wall(wall).expect("a plate");
    }
    world
}

/// Force of the bodies on all walls in the last step, N.
fn on_walls(world: &World) -> Vector3<f64> {
    let analytic = world.wall_load().iter().sum::<Vector3<f64>>();
    analytic
        + world
            .mesh_loads()
            .map(|(force, _)| force)
            .sum::<Vector3<f64>>()
}

/// Momentum of all bodies (kg m/s) and their weight (N).
fn momentum_and_weight(world: &World) -> [Vector3<f64>; 2] {
    let bodies = world.bodies();
    let mass = |k: usize| world.templates()[bodies.template[k]].mass();
    let all = 0..bodies.len();
    [
        all.clone().map(|k| bodies.velocity[k] * mass(k)).sum(),
        all.map(|k| world.settings().gravity * mass(k)).sum(),
    ]
}

/// `sum of forces on walls = weight - d(momentum)/dt` in every step, whatever the bodies do to each other: planes, a turning table
/// and a lid under a load. The rest is rounding: momenta of 1e-4 kg m/s, known to 1e-19, over a step of 2e-5 s, and a
/// hundred forces of 0.1 N.
#[test]
fn walls_carry_weight_and_change_of_momentum() {
    let mut world = pressed();
    let mut largest: f64 = 0.0;
    for _ in 0..8000 {
        let [before, weight] = momentum_and_weight(&world);
        world.step().expect("a stable step");
        let [after, _] = momentum_and_weight(&world);
        let change = (after - before) / world.settings().time_step;
        let open = on_walls(&world) - (weight - change);
        assert!(open.norm() < 1e-12, "{open:?} N at {} s", world.time());
        largest = largest.max(on_walls(&world).norm());
    }
    assert!(largest > 0.05, "the walls feel only {largest} N");
}

/// A lid under 0.05 N on one sphere without gravity: at rest it carries its load, and has come down by the gap and two overlaps
/// `(3 F / (4 E* sqrt(R)))^(2/3)` `[Hertz1881]`. Speeds fall by e in 2 ms, so that 0.2 s leave rounding.
#[test]
fn a_loaded_plate_rests_on_a_sphere_as_hertz_says() {
    let (radius, gap, force) = (2e-3, 1e-4, 0.05);
    let start = Placement::at_rest(
        0,
        Vector3::new(0.0, radius, 0.0),
        UnitQuaternion::identity(),
    );
    let floor = plane(Vector3::zeros(), Vector3::y());
    let surface = rough(0.3, 0.0);
    let mut world = world(
        settings(1e-5, Vector3::zeros()),
        &surface,
        vec![ball(radius)],
        vec![floor],
        &[start],
    );
    let mass = world.templates()[0].mass();
    let lid = plate("lid", 2.0 * radius + gap, load(force, 2.0 * mass));
    world.add_mesh_wall(lid).expect("a lid");
    run(&mut world, 40_000);
    let (carried, _) = world.mesh_loads().next().expect("a lid");
    assert!((carried.y - force).abs() < 1e-9 * force, "{} N", carried.y);
    let [a, b] = surface.materials;
    let young = contact_law::material::effective_moduli(&a, &b).young;
    let overlap = (0.75 * force / (young * radius.sqrt())).powf(2.0 / 3.0);
    let way = -world.mesh_displacements().next().expect("a lid").y;
    let expected = gap + 2.0 * overlap;
    assert!(
        (way / expected - 1.0).abs() < 1e-9,
        "{way} m, not {expected}"
    );
}

/// On a bed that has settled, the mean force on the lid is its load, with a mass and a damping that differ by factors of four: what the
/// servo is made of does not change what it holds. A lid that still creeps by 1 um/s changes its momentum by less than 1e-8 N.
#[test]
fn a_loaded_plate_carries_its_load_on_a_bed() {
    for (mass, damping_time) in [(0.01, 2e-3), (0.04, 8e-3)] {
        let starts = scattered([0.011; 3], 1.0, 0.1, &mut Stream::new(8, "bed"));
        let mut world = world(
            settings(2e-5, Vector3::new(0.0, -9.81, 0.0)),
            &rough(0.3, 0.3),
            seed_and_block(1.0),
            box_of_planes(0.0125),
            &starts,
        );
        let mut motion = load(0.4, mass);
        if let Some(load) = &mut motion.load {
            load.damping_time = damping_time;
        }
        let lid = plate("lid", 0.0124, motion);
        world.add_mesh_wall(lid).expect("a lid");
        run(&mut world, 40_000);
        let mut sum = 0.0;
        for _ in 0..1000 {
            run(&mut world, 1);
            sum += world.mesh_loads().map(|(force, _)| force.y).sum::<f64>();
        }
        let mean = sum / 1000.0;
        assert!((mean / 0.4 - 1.0).abs() < 1e-3, "{mean} N for {mass} kg");
    }
}

/// A ball that rests on a plate falls freely once the plate is taken away, also in a world that continues from a snapshot.
#[test]
fn nothing_rests_on_a_wall_that_was_taken_away() {
    let start = Placement::at_rest(0, Vector3::new(0.0, 2e-3, 0.0), UnitQuaternion::identity());
    let build = || {
        let gravity = Vector3::new(0.0, -9.81, 0.0);
        let mut world = world(
            settings(1e-5, gravity),
            &rough(0.3, 0.3),
            vec![ball(2e-3)],
            Vec::new(),
            &[start],
        );
        let plate = plate("plate", 0.0, Motion::default());
        world.add_mesh_wall(plate).expect("a plate");
        world
    };
    let mut world = build();
    run(&mut world, 20_000);
    let speed = world.bodies().velocity[0].norm();
    assert!(speed < 1e-5, "the ball rests at {speed} m/s");
    let unknown = world.remove_mesh_wall("lid");
    assert!(matches!(unknown, Err(Error::NoWall { .. })), "{unknown:?}");
    world.remove_mesh_wall("plate").expect("it is there");
    let mut continued = build();
    continued.resume(world.snapshot()).expect("the same world");
    for world in [&mut world, &mut continued] {
        run(world, 1000);
        // v = g t, from 1e-5 m/s at the most.
        let fall = -world.bodies().velocity[0].y;
        assert!((fall - 9.81 * 0.01).abs() < 2e-5, "{fall} m/s");
        assert_eq!(world.n_wall_contacts(), 0);
    }
}

/// Two clouds of seeds in two boxes that never meet: taking one out in the middle of the run leaves every bit of the other as it
/// is, slips at contacts included. Bodies of both stand in turn, so that all numbers change.
#[test]
fn bodies_that_are_taken_out_leave_the_others_alone() {
    let starts = scattered([0.011; 3], 1.0, 0.05, &mut Stream::new(9, "two clouds"));
    let shift = Vector3::x() * 0.1;
    let both: Vec<_> = starts
        .iter()
        .flat_map(|start| {
            let beside = Placement {
                position: start.position + shift,
                ..*start
            };
            [*start, beside]
        })
        .collect();
    let mut walls = box_of_planes(0.0125);
    // The box of the second cloud is a floor alone, wide enough for both.
    walls.retain(
        |wall| !matches!(wall.shape, dem_solver::Shape::Plane { normal, .. } if normal.x != 0.0),
    );
    let mut alone = world(
        settings(2e-5, Vector3::new(0.0, -9.81, 0.0)),
        &rough(0.3, 0.4),
        seed_and_block(1.0),
        walls.clone(),
        &both,
    );
    let floor = plate("table", -0.0122, Motion::default());
    alone.add_mesh_wall(floor).expect("a table");
    run(&mut alone, 4000);
    let mut kept = alone.clone();
    let second: Vec<_> = (0..both.len()).skip(1).step_by(2).collect();
    alone.remove(&second).expect("they are there");
    for world in [&mut alone, &mut kept] {
        run(world, 4000);
    }
    assert_eq!(alone.bodies().len(), starts.len());
    let contacts = alone.census().touching_pairs;
    assert!(contacts > 3, "the seeds hardly meet: {contacts}");
    for (k, position) in alone.bodies().position.iter().enumerate() {
        let bits = |v: &Vector3<f64>| v.map(f64::to_bits);
        assert_eq!(bits(position), bits(&kept.bodies().position[2 * k]), "{k}");
    }
    let beyond = alone.remove(&[starts.len()]);
    assert!(matches!(beyond, Err(Error::NoSuch { .. })), "{beyond:?}");
}
