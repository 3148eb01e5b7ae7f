//! A step in the flow takes no memory.

use contact_law::{Material, NormalForceEnd, PairParameters};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, Placement, Settings, Shape, Template, Wall,
    World,
};
use geometry::clump::{Clump, Sphere, properties_of_spheres};
use nalgebra::{UnitQuaternion, Vector3};

/// Half of the side of the box, m.
const HALF: f64 = 0.0125;

/// 64 seeds of two spheres in a box that is shaken by gravity along its diagonal, which turns about an axis.
fn world() -> World {
    let material = Material::new(0.25, 4e6).expect("the constants are possible");
    let surface = InteractionSettings {
        materials: [material; 2],
        parameters: PairParameters {
            restitution: 0.4,
            static_friction: 0.4,
            rolling_friction: 0.05,
        },
        attraction: 0.0,
        end: NormalForceEnd::Clipped,
    };
    let surface = Interaction::new(&surface).expect("the parameters are possible");
    let spheres = [-0.5e-3, 0.5e-3].map(|x| Sphere {
        centre: Vector3::new(x, 0.0, 0.0),
        radius: 1.5e-3,
    });
    let clump = Clump::new(&spheres, &properties_of_spheres(&spheres, 1000.0));
    let seed = Template::new(&clump.expect("a body"), 0, DashpotMass::Body);
    let planes = [-1.0, 1.0].into_iter().flat_map(|side| {
        (0..3).map(move |axis| {
            let mut inward = Vector3::zeros();
            inward[axis] = -side;
            (side, axis, inward)
        })
    });
    let walls = planes.map(|(side, axis, inward)| {
        let mut point = Vector3::zeros();
        point[axis] = side * HALF;
        Wall {
            name: format!("{axis}{side}"),
            shape: Shape::Plane {
                point,
                normal: inward,
            },
            material: 0,
            spin: 0.0,
        }
    });
    let starts = (0..64).map(|i| {
        let place = |k: u32| (f64::from(i / 4_i32.pow(k) % 4) - 1.5) * 5e-3;
        let centre = Vector3::new(place(0), place(1), place(2));
        Placement::at_rest(0, centre, UnitQuaternion::identity())
    });
    let settings = Settings {
        time_step: 2e-5,
        gravity: Vector3::zeros(),
        skin: 3e-4,
        margin: 1e-3,
    };
    let starts: Vec<_> = starts.collect();
    World::new(
        settings,
        vec![seed],
        vec![surface],
        walls.collect(),
        &starts,
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
