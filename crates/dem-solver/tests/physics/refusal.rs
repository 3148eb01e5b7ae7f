//! What a world refuses, and how a hopeless one ends.

use crate::scene::{
    ball, box_of_planes, cluster, interaction, plane, rough, scattered, seed_and_block, settings,
    smooth, sticky,
};
use dem_solver::{
    DashpotMass, Error, Interaction, Motion, Placement, Settings, Shape, Template, Wall, World,
};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Parts of a world, one of which a test spoils.
struct Parts {
    settings: Settings,
    templates: Vec<Template>,
    interactions: Vec<Interaction>,
    walls: Vec<Wall>,
    starts: Vec<Placement>,
}

fn good() -> Parts {
    let position = Vector3::new(0.0, 0.01, 0.0);
    Parts {
        settings: settings(1e-5, Vector3::new(0.0, -9.81, 0.0)),
        templates: vec![ball(2e-3)],
        interactions: vec![interaction(&smooth())],
        walls: vec![plane(Vector3::zeros(), Vector3::y())],
        starts: vec![Placement::at_rest(0, position, UnitQuaternion::identity())],
    }
}

fn build(parts: Parts) -> Result<World, Error> {
    let Parts {
        settings,
        templates,
        interactions,
        walls,
        starts,
    } = parts;
    World::new(settings, templates, interactions, walls, &starts)
}

/// Asserts that spoiled parts are refused with an error of a pattern.
macro_rules! refused {
    ($pattern:pat $(if $guard:expr)?, $spoil:expr) => {{
        let mut parts = good();
        let spoil: &dyn Fn(&mut Parts) = &$spoil;
        spoil(&mut parts);
        let error = build(parts).expect_err("the parts are spoiled");
        assert!(matches!(&error, $pattern $(if $guard)?), "{error:?}");
    }};
}

fn wall(shape: Shape, spin: f64) -> Wall {
    Wall {
        name: "spoiled".into(),
        shape,
        material: 0,
        spin,
    }
}

#[test]
fn good_parts_are_accepted() {
    assert!(build(good()).is_ok(), "the parts are good");
}

/// Spoils one setting by a value.
type SpoiledSetting = fn(&mut Settings, f64);

/// Spoils one part of a start.
type SpoiledStart = fn(&mut Placement);

#[test]
fn impossible_settings_are_refused() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let spoils: [(&str, SpoiledSetting); 3] = [
            ("time step in s", |settings, value| {
                settings.time_step = value;
            }),
            ("skin in m", |settings, value| settings.skin = value),
            ("margin in m", |settings, value| settings.margin = value),
        ];
        for (expected, spoil) in spoils {
            refused!(Error::NotPositive { name, .. } if *name == expected, |parts| {
                spoil(&mut parts.settings, value);
            });
        }
    }
    refused!(Error::NotFinite { .. }, |parts| parts.settings.gravity.z =
        f64::NAN);
}

#[test]
fn index_that_points_to_nothing_is_refused() {
    refused!(
        Error::NoSuch {
            what: "body type",
            index: 1,
            count: 1
        },
        |parts| {
            parts.starts[0].template = 1;
        }
    );
    refused!(
        Error::NoSuch {
            what: "material",
            index: 3,
            count: 1
        },
        |parts| {
            parts.walls[0].material = 3;
        }
    );
    refused!(
        Error::NoSuch {
            what: "material",
            index: 0,
            count: 0
        },
        |parts| {
            parts.interactions.clear();
        }
    );
}

#[test]
fn table_of_interactions_must_be_square_and_even_handed() {
    refused!(
        Error::Interactions {
            got: 2,
            expected: 4
        },
        |parts| {
            parts.interactions = vec![interaction(&smooth()); 2];
        }
    );
    let [own, other] = [rough(0.5, 0.1), rough(0.5, 0.2)].map(|surface| interaction(&surface));
    let mixed = |parts: &mut Parts, interactions: [Interaction; 4]| {
        let sphere = ([0.0; 3], 1e-3);
        parts
            .templates
            .push(cluster(&[sphere], 1, DashpotMass::Body));
        parts.interactions = interactions.to_vec();
    };
    refused!(Error::OneSidedInteraction { a: 0, b: 1 }, |parts| {
        mixed(parts, [own, own, other, own]);
    });
    let mut parts = good();
    mixed(&mut parts, [own, other, other, own]);
    assert!(build(parts).is_ok(), "an even-handed table");
}

#[test]
fn shape_that_its_numbers_do_not_describe_is_refused() {
    let point = Vector3::zeros();
    let edges = |a, b| Shape::Rectangle {
        centre: Vector3::zeros(),
        half_edges: [a, b],
    };
    let plane = |point, normal| Shape::Plane { point, normal };
    let (x, y) = (Vector3::x(), Vector3::y());
    let spoiled = [
        ("radius", Shape::Cylinder { radius: -1.0 }),
        ("radius", Shape::Cylinder { radius: f64::NAN }),
        ("length 1", plane(point, y * 2.0)),
        ("length 1", plane(point, Vector3::zeros())),
        ("length 1", plane(point, Vector3::repeat(f64::NAN))),
        ("point in m", plane(Vector3::repeat(f64::NAN), y)),
        ("perpendicular", edges(x, x + y)),
        ("perpendicular", edges(x, Vector3::zeros())),
        ("half edges", edges(x, y * f64::INFINITY)),
    ];
    for (words, shape) in spoiled {
        let mut parts = good();
        parts.walls.push(wall(shape, 0.0));
        let error = build(parts).expect_err("the shape is spoiled");
        let found = match &error {
            Error::Shape { rule, .. } => *rule,
            Error::NotFinite { what } => what.as_str(),
            other => panic!("{other}"),
        };
        assert!(found.contains(words), "'{words}' is not in '{found}'");
    }
}

#[test]
fn only_a_surface_of_revolution_may_spin() {
    refused!(Error::SpinningShape { .. }, |parts| parts.walls[0].spin =
        1.0);
    refused!(Error::NotFinite { .. }, |parts| parts.walls[0].spin =
        f64::NAN);
    let mut parts = good();
    parts.walls.push(wall(Shape::Cylinder { radius: 0.1 }, 1.0));
    let mut world = build(parts).expect("a cylinder may spin");
    let mut refusal = |name: &str, spin: f64| {
        let set = world.set_wall_spin(name, spin);
        set.expect_err("it is invalid")
    };
    let error = refusal("spoiled", f64::NAN);
    assert!(matches!(error, Error::NotFinite { .. }), "{error}");
    let error = refusal("plane", 2.0);
    assert!(matches!(error, Error::SpinningShape { .. }), "{error}");
    let error = refusal("nothing", 2.0);
    assert!(matches!(error, Error::NoWall { .. }), "{error}");
    world.set_wall_spin("plane", 0.0).expect("it stands anyway");
    world.set_wall_spin("spoiled", 2.0).expect("a cylinder may");
    assert_eq!([world.walls()[0].spin, world.walls()[1].spin], [0.0, 2.0]);
}

/// An error leaves the settings as they were.
#[test]
fn gravity_steps_and_motions_that_cannot_be_meant_are_errors() {
    let mut world = build(good()).expect("a world");
    let before = *world.settings();
    let gravity = world.set_gravity(Vector3::new(0.0, f64::NAN, 0.0));
    assert!(matches!(gravity, Err(Error::NotFinite { .. })));
    for step in [0.0, -1e-4, f64::INFINITY] {
        let set = world.set_time_step(step);
        assert!(matches!(set, Err(Error::NotPositive { .. })), "{step}");
    }
    let none = world.set_mesh_motion("paddle", &Motion::default());
    assert!(matches!(none, Err(Error::NoWall { .. })));
    assert_eq!(*world.settings(), before);
}

#[test]
fn impossible_start_is_refused() {
    let spoils: [(&str, SpoiledStart); 3] = [
        ("position", |start| start.position.x = f64::NAN),
        ("velocity", |start| start.velocity.y = f64::INFINITY),
        ("spin", |start| start.spin.z = f64::NAN),
    ];
    for (expected, spoil) in spoils {
        refused!(Error::NotFinite { what } if what.starts_with(expected), |parts| {
            spoil(&mut parts.starts[0]);
        });
    }
    refused!(
        Error::BehindWall {
            body: 0,
            depth: 0.5,
            ..
        },
        |parts| {
            parts.starts[0].position.y = -0.5;
        }
    );
    refused!(Error::BehindWall { wall, .. } if wall == "spoiled", |parts| {
        parts.starts[0].position.x = -0.2;
        parts.walls.push(wall(Shape::Cylinder { radius: 0.1 }, 0.0));
    });
}

#[test]
fn negative_attraction_is_refused() {
    let settings = dem_solver::InteractionSettings {
        attraction: -1e-3,
        ..smooth()
    };
    let contact_law::Error::OutOfRange { name, value, .. } =
        Interaction::new(&settings).expect_err("repulsion")
    else {
        panic!("another error");
    };
    assert_eq!((name, value), ("attraction in N", -1e-3));
}

#[test]
fn world_without_bodies_or_walls_steps() {
    let mut parts = good();
    parts.starts.clear();
    parts.walls.clear();
    let mut world = build(parts).expect("an empty world is possible");
    for _ in 0..10 {
        world.step().expect("nothing can go wrong");
    }
    assert_eq!((world.n_steps(), world.kinetic_energy()), (10, 0.0));
}

/// Steps until the world gives up; the number of steps at most 100 000.
fn end_of(world: &mut World) -> Option<Error> {
    (0..100_000).find_map(|_| world.step().err())
}

/// A time step a thousand times the contact blows the bodies apart; the world says so, in
/// however many bodies and whichever of them goes first.
#[test]
fn hopeless_time_step_ends_in_an_error() {
    for (time_step, seed) in [(1e-2, 1), (3e-2, 2), (1.0, 3), (1e3, 4)] {
        let starts = scattered([0.0106; 3], 1.0, 0.5, &mut Stream::new(seed, "hopeless"));
        let settings = settings(time_step, Vector3::new(0.0, -9.81, 0.0));
        let templates = seed_and_block(1.0);
        let walls = box_of_planes(0.0125);
        let mut world = World::new(
            settings,
            templates,
            vec![interaction(&sticky()); 4],
            walls,
            &starts,
        )
        .expect("the start is possible");
        let error = end_of(&mut world).expect("such a step cannot go well");
        assert!(matches!(error, Error::Diverged { .. }), "{error}");
    }
}

/// A single body that becomes no number is noticed too, with nobody else to start a search.
#[test]
fn lone_body_that_is_lost_is_noticed() {
    let mut parts = good();
    parts.settings.time_step = 1e160;
    let mut world = build(parts).expect("the start is possible");
    let error = end_of(&mut world).expect("such a step cannot go well");
    assert!(matches!(error, Error::Diverged { body: 0, .. }), "{error}");
}

/// A body that flies away for good costs the others neither memory nor time.
#[test]
fn body_that_flies_away_does_not_stop_the_others() {
    let mut parts = good();
    let mut away = parts.starts[0];
    away.position.x = 1.0;
    away.velocity = Vector3::new(1e9, 1e9, 1e9);
    parts.starts.push(away);
    let mut world = build(parts).expect("the start is possible");
    for _ in 0..20_000 {
        world.step().expect("the others continue");
    }
    let height = world.bodies().position[0].y;
    assert!(
        height > 0.0 && height < 0.011,
        "the other body is at {height} m"
    );
}
