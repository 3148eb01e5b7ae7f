//! The same input gives the same bits.

use crate::scene::{
    ball, box_of_planes, every_law, interaction, run, scattered, seed_and_block, settings, sticky,
    wet_bridge, wetted, world,
};
use contact_law::RollingLever;
use dem_solver::{MeshWall, Motion, OptionalLaws, Placement, Template, World};
use nalgebra::Vector3;
use probability::random_stream::Stream;

/// Seeds, blocks and plain spheres, and where they start: every third body is a sphere.
fn mixture() -> (Vec<Template>, Vec<Placement>) {
    let mut templates = seed_and_block(1.0);
    templates.push(ball(2e-3));
    let mut starts = scattered([0.011; 3], 1.0, 0.5, &mut Stream::new(5, "bits"));
    for start in starts.iter_mut().step_by(3) {
        start.template = 2;
    }
    (templates, starts)
}

/// Plain spheres of two sizes alone, which have lists and a motion of their own.
fn balls() -> (Vec<Template>, Vec<Placement>) {
    let mut starts = scattered([0.011; 3], 1.0, 0.5, &mut Stream::new(5, "bits"));
    for (k, start) in starts.iter_mut().enumerate() {
        start.template = k % 2;
    }
    (vec![ball(3e-3), ball(2.5e-3)], starts)
}

/// Body types, and where the bodies start.
type Filling = fn() -> (Vec<Template>, Vec<Placement>);

/// What is shaken: a mixture, and spheres alone.
const FILLINGS: [Filling; 2] = [mixture, balls];

fn shaken(filling: Filling) -> World {
    let (templates, starts) = filling();
    let settings = settings(2e-5, Vector3::new(0.0, -9.81, 0.0));
    world(
        settings,
        &sticky(),
        templates,
        box_of_planes(0.0125),
        &starts,
    )
}

/// The same with bridges of liquid.
fn shaken_wet(filling: Filling) -> World {
    let (templates, starts) = filling();
    let settings = settings(2e-5, Vector3::new(0.0, -9.81, 0.0));
    let further = OptionalLaws {
        bridge: Some(wet_bridge()),
        ..OptionalLaws::default()
    };
    let surfaces = vec![interaction(&sticky()).with(&further); 4];
    let walls = box_of_planes(0.0125);
    World::new(settings, wetted(templates), surfaces, walls, &starts)
        .expect("the settings are possible")
}

/// Bits of all positions and spins.
fn bits(world: &World) -> Vec<u64> {
    let bodies = world.bodies();
    let vectors = bodies.position.iter().chain(&bodies.spin);
    vectors
        .flat_map(|v| v.iter().map(|c| c.to_bits()).collect::<Vec<_>>())
        .collect()
}

/// A copy carries everything that decides the future: lists, slips, and the way since the search.
#[test]
fn copy_of_a_world_has_the_same_future() {
    for filling in FILLINGS {
        let mut world = shaken(filling);
        run(&mut world, 1503);
        let mut copy = world.clone();
        run(&mut world, 1500);
        run(&mut copy, 1500);
        assert_eq!(bits(&world), bits(&copy));
    }
}

/// Wide registers hold more spheres at a time and round the search for candidates otherwise, but what touches
/// is decided in one arithmetic: the widest instructions of this processor and the basic ones of its kind
/// give the same bits.
#[test]
fn instruction_sets_change_no_bit() {
    for filling in FILLINGS {
        let mut worlds = [shaken(filling), shaken(filling).on_basic_instructions()];
        for world in &mut worlds {
            run(world, 3000);
        }
        assert_eq!(bits(&worlds[0]), bits(&worlds[1]));
    }
}

/// The sums of forces do not depend on who found them, nor what the bodies give to their bridges of liquid: one, two and
/// three threads, whose bodies are cut into 1, 8 and 12 parts, give the same bits, and so does a number that changes on the way.
#[test]
fn threads_change_no_bit() {
    let worlds = [shaken, shaken_wet].map(|start| FILLINGS.map(|filling| (start, filling)));
    for (start, filling) in worlds.into_iter().flatten() {
        let [one, two, three] = [1, 2, 3].map(|threads| {
            let mut world = start(filling).on_threads(threads).unwrap();
            run(&mut world, 10_000);
            let (pairs, walls) = (world.census().touching_pairs, world.n_wall_contacts());
            // The order matters only to a body with three loads or more; half a box full has many.
            let mean = (2 * pairs + walls) as f64 / world.bodies().len() as f64;
            assert!(mean > 2.5, "the bodies have only {mean} contacts each");
            bits(&world)
        });
        let mut changing = start(filling);
        for threads in [1, 3, 2, 1] {
            changing.set_threads(threads).unwrap();
            run(&mut changing, 2500);
        }
        assert_eq!(one, two);
        assert_eq!(one, three);
        assert_eq!(one, bits(&changing));
    }
}

/// A world with every law on, and a wall of triangles on its way.
fn with_all_laws(filling: Filling) -> World {
    let further = OptionalLaws {
        rolling_lever: RollingLever::Centre,
        ..every_law()
    };
    let (templates, starts) = filling();
    let settings = settings(2e-5, Vector3::new(0.0, -9.81, 0.0));
    let surface = interaction(&sticky()).with(&further);
    let walls = box_of_planes(0.0125);
    let surfaces = vec![surface; 4];
    let templates = wetted(templates);
    let mut world = World::new(settings, templates, surfaces, walls, &starts)
        .expect("the settings are possible");
    let corner = |x, z| Vector3::new(x, -0.008, z);
    let plate = MeshWall {
        name: "plate".into(),
        // Bridges pass from one to the other.
        triangles: vec![
            [
                corner(-0.01, -0.01),
                corner(0.01, -0.01),
                corner(-0.01, 0.01),
            ],
            [corner(0.01, 0.01), corner(-0.01, 0.01), corner(0.01, -0.01)],
        ],
        material: 0,
        motion: Motion {
            spin: Vector3::y() * 3.0,
            ..Motion::default()
        },
    };
    world.add_mesh_wall(plate).expect("a plate");
    world
}

/// A snapshot, taken on the way and given to a world that has not moved, has the same future: with every law on,
/// and a wall of triangles on its way. Lists are rebuilt there, on other threads.
#[test]
fn a_world_goes_on_from_a_snapshot_with_the_same_bits() {
    for filling in FILLINGS {
        let mut world = with_all_laws(filling);
        run(&mut world, 10_003);
        let kept = world.snapshot();
        let mut continued = with_all_laws(filling).on_threads(2).unwrap();
        continued.resume(kept.clone()).unwrap();
        assert!(continued.snapshot() == kept, "something is lost on the way");
        run(&mut world, 3000);
        run(&mut continued, 3000);
        assert_eq!(bits(&world), bits(&continued));
        let (census, bodies) = (world.census(), world.bodies().len());
        let meeting = census.sphere_contacts + world.n_wall_contacts();
        assert!(
            meeting > bodies,
            "the bodies hardly meet: {meeting} contacts of {bodies}"
        );
        let error = continued.resume(kept).unwrap_err();
        assert!(error.to_string().contains("another world"), "{error}");
    }
}

/// Where the bodies stand in memory does not change the physics: sorted, or backwards, which exchanges the sides of every pair, each
/// feels the same force and torque in the next step, with every law on. Sums in another order differ by rounding: some
/// 1e-16 for each of ten contacts, of forces up to a thousand times the one that is left.
#[test]
fn the_order_of_the_bodies_changes_rounding_alone() {
    for filling in FILLINGS {
        let mut world = with_all_laws(filling);
        run(&mut world, 10_003);
        let kept = world.snapshot();
        let n = world.bodies().len();
        let backwards: Vec<usize> = (0..n).rev().collect();
        let mut sorted = world.clone();
        let order = sorted.sort_bodies().unwrap();
        assert!(!order.is_sorted(), "the bodies stand sorted already");
        let mut turned = world.clone();
        turned.reorder(&backwards).unwrap();
        let mut back = turned.clone();
        back.reorder(&backwards).unwrap();
        assert!(back.snapshot() == kept, "something is lost on the way");
        run(&mut world, 1);
        let (before, loads) = (world.bodies(), &world.bodies().load);
        let largest = loads
            .iter()
            .map(|load| load.force().norm())
            .fold(0.0, f64::max);
        for (other, order) in [(&mut sorted, order), (&mut turned, backwards)] {
            run(other, 1);
            let after = other.bodies();
            for (place, &former) in order.iter().enumerate() {
                let force = (after.load[place].force() - before.load[former].force()).norm();
                assert!(force < 1e-12 * largest, "{force} N of {largest}");
                let torque = (after.load[place].torque() - before.load[former].torque()).norm();
                assert!(torque < 1e-14 * largest, "{torque} N m");
                let way = (after.position[place] - before.position[former]).norm();
                assert!(way < 1e-15, "{way} m");
            }
        }
        // So little moves in a step that the order stays.
        let order = sorted.sort_bodies().unwrap();
        assert!(order.is_sorted(), "a sorted bed is sorted");
        let refused = turned.reorder(&vec![0; n]).unwrap_err().to_string();
        assert!(
            refused.contains(&format!("each of the {n} bodies once")),
            "{refused}"
        );
    }
}

/// A world whose bodies were sorted on the way continues from a snapshot in one that was built like it and put into the same
/// order.
#[test]
fn a_sorted_world_goes_on_from_a_snapshot_with_the_same_bits() {
    for filling in FILLINGS {
        let mut world = with_all_laws(filling);
        run(&mut world, 5003);
        let order = world.sort_bodies().unwrap();
        run(&mut world, 5000);
        let kept = world.snapshot();
        let mut continued = with_all_laws(filling).on_threads(2).unwrap();
        continued.reorder(&order).unwrap();
        continued.resume(kept).unwrap();
        run(&mut world, 3000);
        run(&mut continued, 3000);
        assert_eq!(bits(&world), bits(&continued));
    }
}

/// More bodies than one part holds (16 384): one thread with two parts and two threads with eight give the same bits.
/// The bodies meet across the parts, as each step of the lattice along its last axis changes the number of a body by
/// hundreds.
#[test]
fn parts_of_one_thread_change_no_bit() {
    let start = || {
        let balls = scattered([0.1, 0.1, 0.09], 1.0, 1.5, &mut Stream::new(7, "many"));
        let balls: Vec<_> = balls
            .into_iter()
            .map(|start| Placement {
                template: 0,
                ..start
            })
            .collect();
        assert!(balls.len() > 1 << 14, "only {} bodies", balls.len());
        let settings = settings(2e-5, Vector3::new(0.0, -9.81, 0.0));
        world(
            settings,
            &sticky(),
            vec![ball(3e-3)],
            box_of_planes(0.2),
            &balls,
        )
    };
    let (mut one, mut two) = (start(), start().on_threads(2).unwrap());
    run(&mut one, 150);
    run(&mut two, 150);
    let touching = one.census().touching_pairs;
    assert!(touching > 1000, "only {touching} pairs touch");
    assert_eq!(bits(&one), bits(&two));
}

/// Threads chosen after bodies were added lose no contact: two balls pressed into each other part.
#[test]
fn threads_chosen_after_an_insertion_keep_the_contacts() {
    let settings = settings(2e-5, Vector3::zeros());
    let at = |x: f64| Placement::at_rest(0, Vector3::x() * x, nalgebra::UnitQuaternion::identity());
    let mut world = world(
        settings,
        &sticky(),
        vec![ball(2e-3)],
        Vec::new(),
        &[at(0.0)],
    );
    world.insert(&[at(3.9e-3)]).unwrap();
    let mut world = world.on_threads(2).unwrap();
    world.step().unwrap();
    assert!(world.bodies().velocity[1].x > 0.0, "no force");
}

/// The phases of the steps are counted only where that is asked for, add up to no more than the clock shows, and change
/// nothing: after 200 steps both worlds hold the same bits.
#[test]
fn counting_phases_changes_nothing() {
    for filling in FILLINGS {
        let (mut plain, mut counted) = (shaken(filling), shaken(filling));
        counted.count_phases();
        let start = std::time::Instant::now();
        run(&mut counted, 200);
        let elapsed = start.elapsed().as_secs_f64();
        run(&mut plain, 200);
        assert_eq!(counted.bodies(), plain.bodies());
        assert_eq!(plain.phases(), None);
        let phases = counted.phases().unwrap();
        assert!(phases.search > 0.0 && phases.contacts > 0.0 && phases.motion > 0.0);
        assert!(phases.total() <= elapsed, "{phases:?} in {elapsed} s");
    }
}
