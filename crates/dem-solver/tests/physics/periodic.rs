//! Periodic sides: a bed that nothing bounds along z, so that no place along z is special.

use crate::oracle::{drum, fallen, hold_to_the_plain_loop, paddle, plate, settings_of};
use crate::scene::{
    ball, cluster, every_law, interaction, run, seed_and_block, settings, smooth, sticky, wetted,
    world,
};
use dem_solver::{
    DashpotMass, Error, MeshWall, OptionalLaws, Placement, Settings, Shape, Template, Wall, World,
    plain,
};
use nalgebra::{UnitQuaternion, Vector3};

/// Places of the sides, m.
const SIDES: [f64; 2] = [-8.5e-3, 8.5e-3];
const LENGTH: f64 = 17e-3;

/// What is in a turning shell.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Filling {
    /// Seeds and blocks.
    Seeds,
    /// Seeds, blocks and balls with all laws.
    WetMixture,
    /// Balls alone, of two sizes.
    Balls,
    /// Balls with all laws.
    WetBalls,
}

const FILLINGS: [Filling; 4] = [
    Filling::Seeds,
    Filling::WetMixture,
    Filling::Balls,
    Filling::WetBalls,
];

/// Body types; the first two are those of the bodies.
fn templates(filling: Filling) -> Vec<Template> {
    let other = cluster(&[([0.0; 3], 2e-3)], 1, DashpotMass::Body);
    let balls = vec![ball(1.4e-3), other];
    match filling {
        Filling::Seeds => seed_and_block(1.0),
        Filling::WetMixture => {
            let mut all = wetted(seed_and_block(1.0));
            all.extend(wetted(balls));
            all
        }
        Filling::Balls => balls,
        Filling::WetBalls => wetted(balls),
    }
}

/// A plate from one side to the other, and as far beyond as bodies reach, deep in the bed.
fn long_plate() -> Wall {
    let mut plate = plate();
    if let Shape::Rectangle { centre, half_edges } = &mut plate.shape {
        centre.y = -0.020;
        half_edges[1] = Vector3::z() * LENGTH;
    }
    plate
}

/// A paddle as long, on the other half of the bed.
fn long_paddle() -> MeshWall {
    let mut paddle = paddle();
    for corner in paddle.triangles.iter_mut().flatten() {
        *corner = Vector3::new(0.4 * corner.x - 0.007, -0.0225, LENGTH / 6e-3 * corner.z);
    }
    paddle
}

/// A bed in a turning shell with a plate and a paddle, all bodies moved along z by a share of the distance of the sides.
fn bed(filling: Filling, share: f64) -> World {
    let walls = vec![drum(1.0).swap_remove(0), long_plate()];
    let mut starts = fallen(1.0, [drum(1.0), vec![long_plate()]].concat());
    for (k, start) in starts.iter_mut().enumerate() {
        start.position.z += share * LENGTH;
        // Nothing else drives them through the sides.
        start.velocity.z += 0.2;
        if filling == Filling::WetMixture {
            start.template = k % 4;
        }
    }
    let further = match filling {
        Filling::WetMixture | Filling::WetBalls => every_law(),
        _ => OptionalLaws::default(),
    };
    let laws = vec![interaction(&sticky()).with(&further); 4];
    let settings = Settings {
        time_step: 2e-5,
        ..settings_of(1.0)
    };
    let world = World::new(settings, templates(filling), laws, walls, &starts).expect("possible");
    let [low, high] = SIDES;
    let mut world = world.with_periodic_sides(low, high).expect("far apart");
    world.add_mesh_wall(long_paddle()).expect("a paddle");
    world.set_wall_spin("shell", 6.0).expect("it may turn");
    world
}

/// Contacts across the sides are found as all others are, by the lists of each kind of body; some bodies pass a side meanwhile.
#[test]
fn loads_are_those_of_the_plain_loop_between_periodic_sides() {
    for filling in FILLINGS {
        let mut world = bed(filling, 0.5);
        let image = |p: &Vector3<f64>| ((p.z - SIDES[0]) / LENGTH).floor();
        let images = |world: &World| {
            world
                .bodies()
                .position
                .iter()
                .map(image)
                .collect::<Vec<_>>()
        };
        let before = images(&world);
        let most = hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 2500);
        assert!(most[0] > 10, "{filling:?}: too few contacts: {most:?}");
        let after = images(&world);
        let passed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
        assert!(passed > 2, "{filling:?}: only {passed} have passed a side");
        let positions = world.bodies().position.iter();
        let places = positions.map(|p| world.between_sides(p).z);
        assert!(
            places
                .into_iter()
                .all(|z| (SIDES[0]..SIDES[1]).contains(&z))
        );
    }
}

/// A bed that is moved along z by any share of the period moves as before: nothing happens at the sides. Rounding (1e-16)
/// grows with each contact; in 60 steps it stays below a millionth of a radius.
#[test]
fn sides_are_nowhere() {
    for filling in FILLINGS {
        let mut beds = [0.0, 0.41, 7.3].map(|share| (share, bed(filling, share)));
        let (mut seen, mut felt) = (0, [0; 2]);
        for _ in 0..20 {
            for (_, world) in &mut beds {
                run(world, 3);
            }
            let world = &beds[0].1;
            seen += world.census().sphere_contacts;
            let at_mesh = world.mesh_loads().next().expect("the paddle").0;
            for (felt, force) in felt.iter_mut().zip([world.wall_load()[1], at_mesh]) {
                *felt += usize::from(force.norm() > 0.0);
            }
        }
        let places = |(share, world): &(f64, World)| {
            let back = Vector3::z() * (share * LENGTH);
            let positions = world.bodies().position.iter();
            positions.map(|p| p - back).collect::<Vec<_>>()
        };
        let first = places(&beds[0]);
        assert!(seen > 10, "{filling:?}: {seen} contacts");
        assert!(
            felt.iter().all(|n| *n > 5),
            "{filling:?} at plates: {felt:?}"
        );
        for moved in &beds[1..] {
            let off = first.iter().zip(places(moved)).map(|(a, b)| (a - b).norm());
            let farthest = off.fold(0.0, f64::max);
            assert!(farthest < 1e-9, "{filling:?} by {}: {farthest} m", moved.0);
        }
    }
}

/// Two smooth balls that meet through a side exchange their velocities, and a third one between them feels nothing; as single spheres, and
/// as two spheres each side by side across the way, which have lists.
#[test]
fn balls_meet_through_a_side() {
    let at = |z: f64, velocity: f64| Placement {
        velocity: Vector3::z() * velocity,
        ..Placement::at_rest(0, Vector3::z() * z, UnitQuaternion::identity())
    };
    let starts = [at(-6.5e-3, -0.1), at(0.0, 0.0), at(6.5e-3, 0.1)];
    let none = settings(2e-6, Vector3::zeros());
    let double = [1.0, -1.0].map(|side| ([side * 5e-6, 0.0, 0.0], 1.5e-3));
    for template in [ball(1.5e-3), cluster(&double, 0, DashpotMass::Body)] {
        let world = world(none, &smooth(), vec![template], Vec::new(), &starts);
        let mut world = world
            .with_periodic_sides(SIDES[0], SIDES[1])
            .expect("far apart");
        // The gap of 17 - 13 - 3 mm closes at 0.2 m/s in 5 ms.
        run(&mut world, 10_000);
        let speeds: Vec<f64> = world.bodies().velocity.iter().map(|v| v.z).collect();
        for (speed, expected) in speeds.iter().zip([0.1, 0.0, -0.1]) {
            assert!((speed - expected).abs() < 1e-6, "{speeds:?} m/s");
        }
    }
}

/// Threads, and a stop in between, change no bit of a run.
#[test]
fn threads_and_snapshots_change_no_bit_between_periodic_sides() {
    for filling in FILLINGS {
        let mut whole = bed(filling, 0.0);
        run(&mut whole, 600);
        let mut threaded = bed(filling, 0.0).on_threads(3).expect("three threads");
        run(&mut threaded, 600);
        let mut begun = bed(filling, 0.0);
        run(&mut begun, 307);
        let mut resumed = bed(filling, 0.0);
        resumed.resume(begun.snapshot()).expect("the same world");
        run(&mut resumed, 293);
        for other in [threaded, resumed] {
            let bits = |world: &World| {
                let all = world.bodies().position.iter().chain(&world.bodies().spin);
                all.flat_map(|v| v.map(f64::to_bits).data.0[0])
                    .collect::<Vec<_>>()
            };
            assert!(bits(&other) == bits(&whole), "{filling:?}");
        }
    }
}

/// Two diameters suffice for balls: at half of it none can touch two images. Bodies of several spheres have lists that look farther.
#[test]
fn sides_that_are_too_near_are_refused() {
    let alone = |template: Template, length: f64| {
        let starts = [Placement::at_rest(
            0,
            Vector3::zeros(),
            UnitQuaternion::identity(),
        )];
        let none = settings(2e-6, Vector3::zeros());
        let world = world(none, &smooth(), vec![template], Vec::new(), &starts);
        world.with_periodic_sides(0.0, length).map(|_| ())
    };
    assert_eq!(alone(ball(1e-3), 4e-3), Ok(()));
    for (template, length) in [
        (ball(1e-3), 3.9e-3),
        (ball(1e-3), f64::NAN),
        (ball(1e-3), f64::INFINITY),
        (seed_and_block(1.0).swap_remove(0), 14e-3),
    ] {
        let refused = alone(template, length);
        assert!(
            matches!(refused, Err(Error::PeriodicSides { .. })),
            "{length}: {refused:?}"
        );
    }
    // Two diameters are too near for balls with bridges, which hold beyond the touch.
    let wet = |length: f64| {
        let starts = [Placement::at_rest(
            0,
            Vector3::zeros(),
            UnitQuaternion::identity(),
        )];
        let laws = vec![interaction(&smooth()).with(&every_law())];
        let balls = wetted(vec![ball(1e-3)]);
        let none = settings(2e-6, Vector3::zeros());
        let world = World::new(none, balls, laws, Vec::new(), &starts).expect("possible");
        world.with_periodic_sides(0.0, length).map(|_| ())
    };
    assert!(matches!(wet(4e-3), Err(Error::PeriodicSides { .. })));
    assert_eq!(wet(5e-3), Ok(()));
}
