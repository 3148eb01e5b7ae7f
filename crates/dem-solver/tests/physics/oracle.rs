//! The fast force loop against the plain one.
//!
//! Before each step the plain loop computes the loads from the state of the world; the step then
//! uses its own. Both sum the same contacts, the fast one in another order, so that only rounding
//! may separate them; a contact that a list misses, or a slip that is lost or mixed up when a
//! list is rebuilt, separates them by the size of a contact force.

use crate::scene::{
    ball, box_of_planes, cluster, every_law, interaction, rough, run, scattered, seed_and_block,
    seed_and_block_with, smooth, sticky, wet_bridge, wetted, world,
};
use dem_solver::{
    DashpotMass, MeshWall, Motion, OptionalLaws, Placement, Settings, Shape, Template, Vibration,
    Wall, World, plain,
};
use nalgebra::Vector3;
use probability::random_stream::Stream;

/// Half width of the drum, m.
const HALF_WIDTH: f64 = 0.0075;

/// Radius of the drum, m.
const RADIUS: f64 = 0.028;

/// A drum between two covers, `size` times 56 mm wide.
pub(crate) fn drum(size: f64) -> Vec<Wall> {
    let cover = |sign: f64| Wall {
        name: "cover".into(),
        shape: Shape::Plane {
            point: Vector3::z() * (sign * size * HALF_WIDTH),
            normal: Vector3::z() * -sign,
        },
        material: 0,
        spin: 0.0,
    };
    let shape = Shape::Cylinder {
        radius: size * RADIUS,
    };
    let shell = Wall {
        name: "shell".into(),
        shape,
        material: 0,
        spin: 0.0,
    };
    vec![shell, cover(1.0), cover(-1.0)]
}

/// A plate that stands into the bed.
pub(crate) fn plate() -> Wall {
    let half_edges = [Vector3::new(0.004, -0.003, 0.0), Vector3::z() * 0.006];
    let shape = Shape::Rectangle {
        centre: Vector3::new(0.004, -0.016, 0.0),
        half_edges,
    };
    Wall {
        name: "plate".into(),
        shape,
        material: 0,
        spin: 0.0,
    }
}

/// A paddle of triangles that lies across the drum, above the bed, and turns about the drum's axis.
pub(crate) fn paddle() -> MeshWall {
    let half_edges = [Vector3::x() * 0.022, Vector3::z() * 0.006];
    let n = 4_u8;
    let corner = |i: u8, k: u8| {
        let [along, across] = [i, k].map(|place| f64::from(2 * place) / f64::from(n) - 1.0);
        half_edges[0] * along + half_edges[1] * across
    };
    let cells = (0..n).flat_map(|i| (0..n).map(move |k| (i, k)));
    let triangles = cells.flat_map(|(i, k)| {
        let [a, b, c, d] =
            [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)].map(|(i, k)| corner(i, k));
        [[a, b, c], [a, c, d]]
    });
    MeshWall {
        name: "paddle".into(),
        triangles: triangles.collect(),
        material: 0,
        motion: Motion::default(),
    }
}

/// Bodies that have fallen into the drum, and still move a little.
pub(crate) fn fallen(size: f64, walls: Vec<Wall>) -> Vec<Placement> {
    let halves = [0.0185, 0.0185, HALF_WIDTH - 0.2e-3].map(|half| half * size);
    let starts = scattered(
        halves,
        size,
        0.4 * size.sqrt(),
        &mut Stream::new(3, "oracle"),
    );
    let mut world = world_of(size, settings_of(size), walls, &starts);
    run(&mut world, 5000);
    let bodies = world.bodies();
    let start = |k: usize| Placement {
        template: bodies.template[k],
        position: bodies.position[k],
        orientation: bodies.orientation[k],
        velocity: bodies.velocity[k],
        spin: bodies.spin[k],
    };
    (0..bodies.len()).map(start).collect()
}

/// Settings for bodies of a size: times grow as its root, in the same gravity.
pub(crate) fn settings_of(size: f64) -> Settings {
    let gravity = Vector3::new(0.0, -9.81, 0.0);
    Settings {
        time_step: 4e-5 * size.sqrt(),
        gravity,
        skin: 3e-4 * size,
        margin: 1e-3 * size,
    }
}

/// A world of the templates of a size, with another surface between unlike bodies and at the
/// blocks' walls than between like ones.
fn world_of(size: f64, settings: Settings, walls: Vec<Wall>, starts: &[Placement]) -> World {
    let [like, unlike] = [sticky(), rough(0.8, 0.15)].map(|surface| interaction(&surface));
    let interactions = vec![like, unlike, unlike, like];
    World::new(settings, seed_and_block(size), interactions, walls, starts)
        .expect("the scene is possible")
}

/// Steps the world and compares loads and numbers of contacts at each step; returns the largest
/// number of contacts of spheres seen, between bodies and with walls.
pub(crate) fn hold_to_the_plain_loop(
    world: &mut World,
    history: &mut plain::History,
    n: usize,
) -> [usize; 2] {
    let mut most = [0; 2];
    for _ in 0..n {
        let expected = plain::loads(world, history);
        world.step().expect("the time step is small enough");
        let (bodies, time) = (world.bodies(), world.time());
        // A body has some ten contacts, each known to a few units of rounding (1e-16) of the
        // coordinates over the overlap (1e3): 1e-12 of the largest load.
        let largest = expected
            .iter()
            .map(|load| load.force().norm())
            .fold(0.0, f64::max);
        let lever = world.templates()[0].smallest_radius() * 8.0;
        for (k, load) in expected.iter().enumerate() {
            let force = (bodies.load[k].force() - load.force()).norm();
            let torque = (bodies.load[k].torque() - load.torque()).norm();
            assert!(
                force <= 1e-11 * largest,
                "force on body {k} at {time} s: {force}"
            );
            assert!(
                torque <= 1e-11 * largest * lever,
                "torque on body {k} at {time} s: {torque}"
            );
        }
        let contacts = [world.census().sphere_contacts, world.n_wall_contacts()];
        assert_eq!(
            contacts,
            [history.n_contacts(), history.n_wall_contacts()],
            "at {time} s"
        );
        most = [most[0].max(contacts[0]), most[1].max(contacts[1])];
    }
    most
}

/// A drum whose spin changes on the way: the lists count ways in a turning frame.
#[test]
fn loads_are_those_of_the_plain_loop_in_a_drum() {
    let starts = fallen(1.0, drum(1.0));
    let mut world = world_of(1.0, settings_of(1.0), drum(1.0), &starts);
    let mut history = plain::History::default();
    let mut most = [0; 2];
    for spin in [0.0, 12.0, -20.0, 3.0] {
        for name in ["shell", "cover"] {
            world.set_wall_spin(name, spin).expect("named");
        }
        let now = hold_to_the_plain_loop(&mut world, &mut history, 300);
        most = [most[0].max(now[0]), most[1].max(now[1])];
    }
    assert!(
        most[0] > 60 && most[1] > 30,
        "too few contacts to mean anything: {most:?}"
    );
    let census = world.census();
    assert!(
        census.rebuilds > 1000,
        "the lists were hardly rebuilt: {census:?}"
    );
}

/// All further laws at once: a list that ends at the contact would lose a bridge.
#[test]
fn loads_are_those_of_the_plain_loop_with_every_law() {
    let further = OptionalLaws {
        pull: 0.5,
        ..every_law()
    };
    let surface = interaction(&sticky()).with(&further);
    let starts = fallen(1.0, drum(1.0));
    let dry = world_of(1.0, settings_of(1.0), drum(1.0), &starts);
    let wet = |interactions: Vec<_>| {
        let settings = settings_of(1.0);
        let templates = wetted(seed_and_block_with(1.0, DashpotMass::Shared));
        World::new(settings, templates, interactions, drum(1.0), &starts).expect("possible")
    };
    let mut world = wet(vec![surface; 4]);
    let mut history = plain::History::default();
    let mut most = [0; 2];
    for spin in [12.0, -20.0] {
        for name in ["shell", "cover"] {
            world.set_wall_spin(name, spin).expect("named");
        }
        let now = hold_to_the_plain_loop(&mut world, &mut history, 300);
        most = [most[0].max(now[0]), most[1].max(now[1])];
    }
    let mut dry = dry;
    let without = hold_to_the_plain_loop(&mut dry, &mut plain::History::default(), 300);
    assert!(
        most[0] > without[0] && most[1] > 30,
        "bridges add contacts to {without:?}: {most:?}"
    );
}

/// Plain spheres of two sizes, among seeds and alone, dry and with every law: two spheres have no list
/// of their own, and a bridge outlives the touch for them too.
#[test]
fn loads_are_those_of_the_plain_loop_for_plain_spheres() {
    let wet = every_law();
    let places = fallen(1.0, drum(1.0));
    // Of two materials, so that neighbours in a list have different laws.
    let small = cluster(&[([0.0; 3], 1e-3)], 1, DashpotMass::Body);
    let balls = vec![ball(1.3e-3), small];
    let settings = Settings {
        time_step: 2e-5,
        ..settings_of(1.0)
    };
    // Balls fit in the places of the fallen bodies; in a mixture, every fourth stays a seed.
    let most = |seeds: bool, further: OptionalLaws| {
        let mut starts = places.clone();
        for (k, start) in starts.iter_mut().enumerate() {
            start.template = if seeds && k % 4 == 0 { 2 } else { k % 2 };
        }
        // A world that has no seed takes the path of plain spheres.
        let mut templates = balls.clone();
        templates.extend(seeds.then(|| seed_and_block(1.0).swap_remove(0)));
        let [own, other] = [sticky(), rough(0.4, 0.2)].map(|s| interaction(&s).with(&further));
        let laws = vec![own, other, other, own];
        let mut world =
            World::new(settings, wetted(templates), laws, drum(1.0), &starts).expect("possible");
        world
            .set_wall_spin("shell", 4.0)
            .expect("the shell may turn");
        hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 8000)[0]
    };
    assert!(most(true, OptionalLaws::default()) > 20, "few contacts");
    assert!(most(true, wet) > 20, "few contacts");
    let balls = [OptionalLaws::default(), wet].map(|further| most(false, further));
    assert!(
        balls[0] > 10 && balls[1] > balls[0],
        "too few contacts of balls to mean anything, or no bridge: {balls:?}"
    );
}

/// A paddle of triangles that throws the bed, dry and with bridges, which pass from one triangle to the next: it
/// turns, then goes and trembles as well, and stands while the bed falls on it. The lists count the ways of body and wall;
/// searches are rare, so that lists must be rebuilt between them.
#[test]
fn loads_are_those_of_the_plain_loop_at_a_moving_mesh() {
    let starts = fallen(1.0, drum(1.0));
    let wet = OptionalLaws {
        bridge: Some(wet_bridge()),
        ..OptionalLaws::default()
    };
    let stands = Motion::default();
    let turns = Motion {
        spin: Vector3::z() * -60.0,
        ..stands
    };
    let goes_and_trembles = Motion {
        velocity: Vector3::x() * 0.1,
        vibration: Some(Vibration {
            amplitude: Vector3::new(1e-4, 2e-4, 0.0),
            angular_frequency: 400.0,
        }),
        ..turns
    };
    for further in [OptionalLaws::default(), wet] {
        let laws = vec![interaction(&sticky()).with(&further); 4];
        let settings = Settings {
            margin: 5e-3,
            ..settings_of(1.0)
        };
        let mut world = World::new(
            settings,
            wetted(seed_and_block(1.0)),
            laws,
            drum(1.0),
            &starts,
        )
        .expect("possible");
        world.add_mesh_wall(paddle()).expect("a paddle");
        let mut history = plain::History::default();
        let mut pushed = 0_usize;
        for (motion, parts) in [(turns, 25), (goes_and_trembles, 20), (stands, 10)] {
            world.set_mesh_motion("paddle", &motion).expect("named");
            for _ in 0..parts {
                hold_to_the_plain_loop(&mut world, &mut history, 40);
                let (force, _) = world.mesh_loads().next().expect("one mesh");
                pushed += usize::from(force.norm() > 0.0);
            }
        }
        assert!(pushed > 10, "the paddle hardly touches: {pushed}");
    }
}

/// Walls of which one is not a surface of revolution: a plate in the bed.
#[test]
fn loads_are_those_of_the_plain_loop_at_a_plate() {
    let mut walls = drum(1.0);
    walls.push(plate());
    let starts = fallen(1.0, walls.clone());
    let mut world = world_of(1.0, settings_of(1.0), walls, &starts);
    world
        .set_wall_spin("shell", 10.0)
        .expect("the shell may turn");
    let most = hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 600);
    assert!(
        most[0] > 50 && most[1] > 30,
        "too few contacts to mean anything: {most:?}"
    );
    assert!(
        world.wall_load()[3].norm() > 0.0,
        "nothing rests on the plate"
    );
}

/// Skin and margin decide the speed only: no choice, however odd, may lose a contact.
#[test]
fn no_skin_or_margin_loses_a_contact() {
    let starts = fallen(1.0, drum(1.0));
    for (skin, margin) in [(1e-6, 1e-5), (5e-3, 1e-4), (1e-5, 2e-2), (3e-3, 3e-3)] {
        let settings = Settings {
            skin,
            margin,
            ..settings_of(1.0)
        };
        let mut world = world_of(1.0, settings, drum(1.0), &starts);
        world
            .set_wall_spin("shell", 12.0)
            .expect("the shell may turn");
        let most = hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 200);
        assert!(most[0] > 50, "too few contacts to mean anything: {most:?}");
    }
}

/// Bodies of 1 m: the slack for single precision must follow the size of the scene.
#[test]
fn no_contact_is_lost_between_large_bodies() {
    let size = 150.0;
    let starts = fallen(size, drum(size));
    let mut world = world_of(size, settings_of(size), drum(size), &starts);
    world
        .set_wall_spin("shell", 1.0)
        .expect("the shell may turn");
    let most = hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 600);
    assert!(
        most[0] > 50 && most[1] > 30,
        "too few contacts to mean anything: {most:?}"
    );
}

/// Bodies that meet and part: pairs stay listed throughout, while their candidates and contacts
/// come and go, down to none at all.
#[test]
fn no_contact_is_lost_when_all_bodies_part_and_meet_again() {
    let settings = Settings {
        skin: 1e-5,
        margin: 2e-2,
        gravity: Vector3::zeros(),
        ..settings_of(1.0)
    };
    let starts = scattered(
        [0.011, 0.011, 0.004],
        1.0,
        1.0,
        &mut Stream::new(8, "parting"),
    );
    let mut world = world_of(1.0, settings, box_of_planes(0.0125), &starts);
    let mut history = plain::History::default();
    let (mut n_none, mut n_some) = (0, 0);
    for _ in 0..1500 {
        let now = hold_to_the_plain_loop(&mut world, &mut history, 1);
        n_none += usize::from(now[0] == 0);
        n_some += usize::from(now[0] > 0);
    }
    assert!(
        n_none > 50 && n_some > 50,
        "{n_none} steps without contact, {n_some} with"
    );
}

/// Smooth balls do not turn, so that the ways counted are the true ones and the lists have
/// nothing to spare: a pair that is looked at a little late loses the contact. Balls of one sphere have
/// no list; those of two spheres, a hundredth of a millimetre apart, have one.
#[test]
fn balls_are_looked_at_in_time() {
    let double = |radius: f64| {
        let spheres = [1.0, -1.0].map(|side| ([side * 5e-6, 0.0, 0.0], radius));
        cluster(&spheres, 0, DashpotMass::Body)
    };
    for templates in [
        vec![ball(1.5e-3), ball(2.5e-3)],
        vec![double(1.5e-3), double(2.5e-3)],
    ] {
        hold_balls_in_a_box(templates);
    }
}

/// Two kinds of balls that fly about in a box.
fn hold_balls_in_a_box(templates: Vec<Template>) {
    let settings = Settings {
        time_step: 1e-5,
        skin: 1e-5,
        margin: 5e-3,
        gravity: Vector3::zeros(),
    };
    let starts = scattered([0.018; 3], 1.0, 2.0, &mut Stream::new(9, "balls"));
    let mut world = world(
        settings,
        &smooth(),
        templates,
        box_of_planes(0.0205),
        &starts,
    );
    let most = hold_to_the_plain_loop(&mut world, &mut plain::History::default(), 2000);
    assert!(
        most[0] > 10 && most[1] > 5,
        "too few contacts to mean anything: {most:?}"
    );
}
