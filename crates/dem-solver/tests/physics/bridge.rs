//! Bridges of liquid between bodies, and rolling springs.

use crate::scene::{
    ball, box_of_planes, interaction, plane, rough, run, scattered, settings, smooth, wet_bridge,
};
use contact_law::{BridgeForce, CapillaryBridge, RollingSpringDashpot, ViscousBridge};
use dem_solver::{MeshWall, Motion, OptionalLaws, Placement, World};
use nalgebra::{UnitQuaternion, Vector3};
use verification::worlds::floor;

/// Radius of the balls, m.
const RADIUS: f64 = 1e-3;

/// Volume of the bridges between two balls with little company, m³.
const VOLUME: f64 = 1e-12;

/// Two balls that touch by a ten-thousandth of their radius and part with a speed (m/s) of each. A sixth of the
/// liquid of both is the volume of their bridge.
fn parting(bridge: BridgeForce, speed: f64) -> World {
    let start = |sign: f64| {
        let mut placement = Placement::at_rest(
            0,
            Vector3::x() * (sign * RADIUS * (1.0 - 5e-5)),
            UnitQuaternion::identity(),
        );
        placement.velocity = Vector3::x() * (sign * speed);
        placement
    };
    let further = OptionalLaws {
        bridge: Some(bridge),
        ..OptionalLaws::default()
    };
    let surface = interaction(&smooth()).with(&further);
    let starts = [start(-1.0), start(1.0)];
    let settings = settings(1e-7, Vector3::zeros());
    let balls = vec![ball(RADIUS).with_liquid(3.0 * VOLUME)];
    World::new(settings, balls, vec![surface], vec![], &starts).expect("possible")
}

/// Steps a world and compares the pull on body 0 along an axis with the law at the gap and the speed before each step, which are
/// known to rounding, wherever the law gives a value: at least so many times beyond the contact. Beyond the rupture the
/// pull is zero.
fn follows(
    mut world: World,
    steps: usize,
    gap: impl Fn(&World) -> [f64; 2],
    axis: usize,
    law: impl Fn(f64, f64) -> Option<f64>,
    least: [usize; 2],
) {
    let mut seen = [0, 0];
    for _ in 0..steps {
        let [gap, speed] = gap(&world);
        world.step().expect("steps");
        let pull = world.bodies().load[0].force()[axis];
        match law(gap, speed) {
            Some(0.0) => {
                assert_eq!(pull, 0.0, "gap {gap}");
                seen[1] += 1;
            }
            Some(expected) => {
                let error = (pull / expected - 1.0).abs();
                assert!(error < 1e-9, "gap {gap}: {pull} N, not {expected}");
                seen[0] += 1;
            }
            None => {}
        }
    }
    assert!(seen[0] > least[0] && seen[1] >= least[1], "{seen:?} steps");
}

/// Gap of two balls (m), and their speed apart (m/s).
fn apart(world: &World) -> [f64; 2] {
    let bodies = world.bodies();
    let gap = (bodies.position[1] - bodies.position[0]).norm() - 2.0 * RADIUS;
    [gap, (bodies.velocity[1] - bodies.velocity[0]).x]
}

/// The attraction of a bridge up to its rupture, and none beyond; nothing is said of contacts.
fn capillary(bridge: &BridgeForce, gap: f64) -> Option<f64> {
    if gap > bridge.rupture_gap(VOLUME) {
        Some(0.0)
    } else {
        (gap > 1e-9).then(|| bridge.attraction(gap, VOLUME))
    }
}

/// Two balls leave each other so fast that their speed hardly changes: no bridge forms again beyond the rupture.
#[test]
fn a_bridge_pulls_by_its_law_until_it_breaks() {
    let bridge = CapillaryBridge::new(0.072, 0.2).expect("water");
    let bridge = bridge.between(RADIUS);
    let world = parting(bridge, 0.5);
    follows(
        world,
        2000,
        apart,
        0,
        |gap, _| capillary(&bridge, gap),
        [500, 101],
    );
}

/// The bridge of a liquid without surface tension holds two parting balls by its viscosity alone.
#[test]
fn a_viscous_bridge_resists_parting_by_its_law() {
    let viscous = ViscousBridge::new(0.1, 1e-6)
        .expect("syrup")
        .between(RADIUS);
    let bridge = CapillaryBridge::new(0.0, 0.0).expect("no tension");
    let world = parting(bridge.between(RADIUS).with_viscosity(viscous), 0.5);
    let viscous = viscous.expect("viscosity");
    let law = |gap: f64, speed: f64| {
        let near = gap > 1e-9 && gap < 1e-4;
        near.then(|| viscous.resistance(gap, VOLUME)[0] * speed)
    };
    follows(world, 800, apart, 0, law, [500, 0]);
}

/// Balls that fall in a box, each with a volume of liquid (m³).
fn heap(liquid: f64) -> World {
    let further = OptionalLaws {
        bridge: Some(wet_bridge()),
        ..OptionalLaws::default()
    };
    let surface = interaction(&rough(0.3, 0.3)).with(&further);
    let mut stream = probability::random_stream::Stream::new(3, "pour");
    let mut starts = scattered([0.009; 3], 0.35, 0.3, &mut stream);
    for start in &mut starts {
        start.template = 0;
    }
    let walls = box_of_planes(0.01);
    let balls = vec![ball(RADIUS).with_liquid(liquid)];
    let settings = settings(1e-5, -Vector3::y() * 9.81);
    World::new(settings, balls, vec![surface], walls, &starts).expect("possible")
}

/// Balls that fall into a heap and are poured over: in every step the bridges and the films hold the liquid that
/// was there, no body has given more than its own, and some bodies have more than the six bridges among which they share
/// all of it. Rounding of some hundred sums.
#[test]
fn bridges_and_films_hold_the_liquid_that_is_there() {
    let liquid = 3e-11;
    let mut world = heap(liquid);
    let total = liquid * world.bodies().len() as f64;
    let mut emptied = 0;
    for step in 0..6000 {
        if step == 4000 {
            world
                .set_gravity(Vector3::new(9.81, -3.0, 0.0))
                .expect("gravity");
        }
        world.step().expect("steps");
        let films = world.films();
        let held = world.bridge_volumes().iter().sum::<f64>() + films.iter().sum::<f64>();
        assert!(
            (held / total - 1.0).abs() < 1e-12,
            "{held} m³ of {total} in step {step}"
        );
        let least = films.iter().copied().fold(total, f64::min);
        assert!(least > -1e-12 * liquid, "a film of {least} m³");
        emptied = films.iter().filter(|film| **film < 1e-12 * liquid).count();
    }
    assert!(emptied > 10, "{emptied} bodies with six bridges or more");
}

/// A ball that gets a second bridge does not take from its first: nobody has more than six. Rounding only.
#[test]
fn few_bridges_do_not_drain_each_other() {
    let bridge = CapillaryBridge::new(0.05, 0.0).expect("water");
    let mut world = parting(bridge.between(RADIUS), 0.0);
    run(&mut world, 10);
    let volumes = world.bridge_volumes();
    assert_eq!(volumes.len(), 1);
    assert!((volumes[0] / VOLUME - 1.0).abs() < 1e-12, "{volumes:?}");
    let beside = Placement::at_rest(
        0,
        Vector3::new(RADIUS, 1.9999 * RADIUS, 0.0),
        UnitQuaternion::identity(),
    );
    world.insert(&[beside]).expect("room");
    run(&mut world, 10);
    let volumes = world.bridge_volumes();
    assert_eq!(volumes.len(), 2);
    assert!(
        volumes.iter().all(|v| (v / VOLUME - 1.0).abs() < 1e-12),
        "{volumes:?}"
    );
}

/// A wall holds a ball twice as hard as another ball does: the mean radius is that of the ball doubled. The ball
/// hangs under the wall on a bridge stronger than its weight (41 uN), and falls from a weaker one.
#[test]
fn a_ball_hangs_from_a_wet_wall() {
    let hangs = |tension: f64| {
        let bridge = CapillaryBridge::new(tension, 0.0).expect("liquid");
        let further = OptionalLaws {
            bridge: Some(bridge.between(2.0 * RADIUS)),
            ..OptionalLaws::default()
        };
        let surface = interaction(&rough(0.3, 0.3)).with(&further);
        let ceiling = plane(Vector3::zeros(), -Vector3::y());
        let start = Placement::at_rest(
            0,
            -Vector3::y() * (RADIUS * 0.9999),
            UnitQuaternion::identity(),
        );
        let settings = settings(2e-6, -Vector3::y() * 9.81);
        let mut world = World::new(
            settings,
            vec![ball(RADIUS).with_liquid(6.0 * VOLUME)],
            vec![surface],
            vec![ceiling],
            &[start],
        )
        .expect("possible");
        run(&mut world, 50_000);
        world.bodies().position[0].y > -2.0 * RADIUS
    };
    // 2 pi (2 R) g = weight at g = 3.27 mN/m.
    assert!(hangs(0.0040), "a bridge of 50 uN holds");
    assert!(!hangs(0.0026), "a bridge of 33 uN does not");
}

/// A ball that falls from a ceiling of triangles: the pull is that of the law with the sixth of the ball's liquid, as at a plane.
#[test]
fn a_bridge_at_triangles_has_the_liquid_that_the_ball_gives() {
    let bridge = CapillaryBridge::new(0.072, 0.2).expect("water");
    let bridge = bridge.between(2.0 * RADIUS);
    let further = OptionalLaws {
        bridge: Some(bridge),
        ..OptionalLaws::default()
    };
    let surface = interaction(&smooth()).with(&further);
    let start = Placement {
        velocity: -Vector3::y() * 0.5,
        ..Placement::at_rest(
            0,
            -Vector3::y() * (RADIUS * (1.0 - 1e-4)),
            UnitQuaternion::identity(),
        )
    };
    let settings = settings(1e-7, Vector3::zeros());
    let balls = vec![ball(RADIUS).with_liquid(6.0 * VOLUME)];
    let mut world = World::new(settings, balls, vec![surface], vec![], &[start]).expect("possible");
    let corner = |x: f64, z: f64| Vector3::new(x, 0.0, z);
    let ceiling = MeshWall {
        name: "ceiling".into(),
        triangles: vec![[
            corner(-0.01, -0.01),
            corner(0.02, -0.01),
            corner(-0.01, 0.02),
        ]],
        material: 0,
        motion: Motion::default(),
    };
    world.add_mesh_wall(ceiling).expect("a triangle");
    let gap = |world: &World| [-world.bodies().position[0].y - RADIUS, 0.0];
    follows(
        world,
        3000,
        gap,
        1,
        |gap, _| capillary(&bridge, gap),
        [500, 101],
    );
}

/// A heap in which balls have more than six bridges continues from a snapshot with the same bits: what each gives follows from
/// the contacts, which the snapshot holds.
#[test]
fn a_heap_of_wet_balls_goes_on_from_a_snapshot() {
    let fresh = || heap(3e-11);
    let mut world = fresh();
    run(&mut world, 4000);
    let fewest = world.films().into_iter().fold(1.0, f64::min);
    assert!(fewest < 1e-23, "no ball has given all: {fewest} m³");
    let mut continued = fresh();
    continued.resume(world.snapshot()).expect("the same heap");
    assert_eq!(continued.bridge_volumes(), world.bridge_volumes());
    run(&mut world, 200);
    run(&mut continued, 200);
    assert_eq!(continued.bodies().position, world.bodies().position);
}

/// A ball with rolling resistance of type C on a plane tilted below `tan = mu_r` comes to rest, and above
/// it rolls away with the acceleration of the torque `mu_r F_n R`: a = (5/7) g (sin - `mu_r` cos). With type A
/// it would creep on the gentle plane.
#[test]
fn a_rolling_spring_holds_a_ball_on_a_gentle_slope() {
    let rolling_friction = 0.1;
    let way = |slope: f64, steps: usize| {
        let further = OptionalLaws {
            rolling_spring: RollingSpringDashpot::new(rolling_friction, 0.3, 2.25).ok(),
            ..OptionalLaws::default()
        };
        let surface = interaction(&rough(0.3, 0.8)).with(&further);
        let floor = floor();
        let start = Placement::at_rest(
            0,
            Vector3::y() * (RADIUS * 0.9999),
            UnitQuaternion::identity(),
        );
        let gravity = 9.81 * Vector3::new(slope.sin(), -slope.cos(), 0.0);
        let mut world = World::new(
            settings(2e-6, gravity),
            vec![ball(RADIUS)],
            vec![surface],
            vec![floor],
            &[start],
        )
        .expect("possible");
        run(&mut world, steps);
        (world.bodies().position[0].x, world.bodies().velocity[0].x)
    };
    let (_, creeping) = way(0.08_f64.atan(), 200_000);
    assert!(
        creeping.abs() < 1e-6,
        "rests, but moves with {creeping} m/s"
    );
    let slope = 0.3_f64.atan();
    let (_, speed) = way(slope, 50_000);
    let expected = 5.0 / 7.0 * 9.81 * (slope.sin() - rolling_friction * slope.cos()) * 0.1;
    // The ball starts at rest with its springs slack: they take about 1 ms of the 100 ms to load.
    assert!(
        (speed / expected - 1.0).abs() < 0.02,
        "{speed} m/s, not {expected}"
    );
}

/// Balls in a box that a thick liquid holds together come to rest with the time step `m / (24 c)` that a scene takes for
/// them: c is the greatest resistance between two balls.
#[test]
fn viscous_bridges_are_stable_up_to_a_step() {
    let viscous = ViscousBridge::new(1.0, 1e-5).expect("syrup");
    let between = |radius: f64| {
        let bridge = CapillaryBridge::new(0.07, 0.0).expect("water");
        let bridge = bridge.between(radius);
        bridge.with_viscosity(viscous.between(radius))
    };
    let [resistance, _] = viscous.between(RADIUS).expect("viscosity").most();
    let calm = |share: f64| {
        let balls = vec![ball(RADIUS).with_liquid(3e-10)];
        let step = share * balls[0].mass() / (24.0 * resistance);
        let laws = [RADIUS, 2.0 * RADIUS].map(|radius| {
            let further = OptionalLaws {
                bridge: Some(between(radius)),
                ..OptionalLaws::default()
            };
            interaction(&rough(0.3, 0.3)).with(&further)
        });
        let mut stream = probability::random_stream::Stream::new(3, "syrup");
        let mut starts = scattered([0.004; 3], 0.29, 0.3, &mut stream);
        for start in &mut starts {
            start.template = 0;
        }
        let mut walls = box_of_planes(0.004);
        for wall in &mut walls {
            wall.material = 1;
        }
        let table = vec![laws[0], laws[1], laws[1], laws[1]];
        let settings = settings(step, -Vector3::y() * 9.81);
        let mut world = World::new(settings, balls, table, walls, &starts).expect("possible");
        while world.time() < 0.05 {
            if world.step().is_err() {
                return false;
            }
        }
        let speeds = world.bodies().velocity.iter().map(Vector3::norm);
        speeds.fold(0.0, f64::max) < 0.05
    };
    assert!(calm(1.0), "the step of a scene");
    assert!(!calm(200.0), "a step 200 times as long");
}
