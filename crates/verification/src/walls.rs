//! Walls of triangles against analytic walls, and walls that move.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, GRAVITY, RADIUS, ball, floor, resting_overlap, run, settings, soft_surface, thrown,
    world,
};
use dem_solver::{MeshWall, Motion, Placement, Shape, Vibration, Wall, World};
use nalgebra::{UnitQuaternion, Vector3};

/// A rectangle y = 0 about the origin as two triangles; half edges in m.
fn rectangle(half_x: f64, half_z: f64, motion: Motion) -> MeshWall {
    let corner = |x: f64, z: f64| Vector3::new(x * half_x, 0.0, z * half_z);
    let [a, b, c, d] = [
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    ];
    MeshWall {
        name: "mesh".into(),
        triangles: vec![[a, b, c], [a, c, d]],
        material: 0,
        motion,
    }
}

/// A rectangle as of [`rectangle`], of eight triangles, six of which share the origin; their angles there are acute.
fn fan(half_x: f64, half_z: f64) -> MeshWall {
    let quarters = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    let quarter = |[x, z]: [f64; 2]| {
        let middle = Vector3::new(x * half_x, 0.0, z * half_z);
        let own = rectangle(0.5 * half_x, 0.5 * half_z, Motion::default());
        let triangles = own.triangles.into_iter();
        triangles.map(move |corners| corners.map(|corner| corner + middle))
    };
    MeshWall {
        triangles: quarters.into_iter().flat_map(quarter).collect(),
        ..rectangle(half_x, half_z, Motion::default())
    }
}

/// A world with one ball and these walls.
fn with_ball(
    start: Placement,
    walls: Vec<Wall>,
    meshes: Vec<MeshWall>,
    gravity: f64,
) -> Result<World, CheckError> {
    let mut world = world(
        settings(1e-6, Vector3::y() * -gravity, RADIUS),
        &soft_surface([0.4, 0.3, 0.02])?,
        vec![ball(RADIUS, DENSITY)?],
        walls,
        &[start],
    )?;
    for mesh in meshes {
        world.add_mesh_wall(mesh)?;
    }
    Ok(world)
}

/// Largest difference of velocity (m/s) and of spin times radius (m/s).
fn difference(a: &World, b: &World) -> f64 {
    let (a, b) = (a.bodies(), b.bodies());
    let spin = (a.spin[0] - b.spin[0]).norm() * RADIUS;
    (a.velocity[0] - b.velocity[0]).norm().max(spin)
}

/// The same impact on both kinds of wall, of which the triangles may share corners within.
fn impact(x: f64, z: f64, with_edges: bool, mesh: MeshWall) -> Result<f64, CheckError> {
    let start = Placement {
        spin: Vector3::new(20.0, -30.0, 10.0),
        ..thrown(
            0,
            Vector3::new(x, RADIUS * 1.01, z),
            Vector3::new(0.15, -0.3, 0.05),
        )
    };
    let analytic = if with_edges {
        Wall {
            shape: Shape::Rectangle {
                centre: Vector3::zeros(),
                half_edges: [Vector3::x() * 0.01, Vector3::z() * 0.01],
            },
            ..floor()
        }
    } else {
        floor()
    };
    let mut one = with_ball(start, vec![analytic], Vec::new(), 0.0)?;
    let mut other = with_ball(start, Vec::new(), vec![mesh], 0.0)?;
    run(&mut one, 4000)?;
    run(&mut other, 4000)?;
    Ok(difference(&one, &other))
}

/// Analytic walls and walls of triangles.
pub(crate) fn mesh_and_analytic() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "mesh-wall",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(1e-9),
        reason: "rounding only, over some thousand steps",
        source: "both are the same surface",
    };
    let two = || rectangle(0.01, 0.01, Motion::default());
    let name = |what: &str| format!("impact {what}: largest difference of velocity and spin R");
    let mut rows = vec![
        basis.row(
            name("inside a triangle"),
            "m/s",
            0.0,
            impact(-4e-3, 3e-3, false, two())?,
        ),
        basis.row(
            name("on the edge between two"),
            "m/s",
            0.0,
            impact(0.0, 0.0, false, two())?,
        ),
        basis.row(
            name("beside a corner that six triangles share"),
            "m/s",
            0.0,
            impact(4e-5, 7e-5, false, fan(0.01, 0.02))?,
        ),
        basis.row(
            name("on a free edge"),
            "m/s",
            0.0,
            impact(9.5e-3, 2e-3, true, two())?,
        ),
        basis.row(
            name("beyond a free edge"),
            "m/s",
            0.0,
            impact(0.0109, 2e-3, true, two())?,
        ),
        basis.row(
            name("beyond a corner"),
            "m/s",
            0.0,
            impact(0.0106, 0.0106, true, two())?,
        ),
    ];
    // A ball that rolls across the edge between two triangles.
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY)?;
    let start = Placement {
        spin: Vector3::z() * (-0.1 / RADIUS),
        ..thrown(0, Vector3::new(-2e-3, height, 1e-4), Vector3::x() * 0.1)
    };
    let mut one = with_ball(start, vec![floor()], Vec::new(), GRAVITY)?;
    let mesh = rectangle(0.01, 0.01, Motion::default());
    let mut other = with_ball(start, Vec::new(), vec![mesh], GRAVITY)?;
    run(&mut one, 40_000)?;
    run(&mut other, 40_000)?;
    let off = difference(&one, &other);
    rows.push(basis.row("rolling across the edge: the same", "m/s", 0.0, off));
    Ok(rows)
}

/// Walls with prescribed motion.
pub(crate) fn moving() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "moving-wall",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(5e-3),
        reason: "first loading of the springs, and swings that are not yet damped out",
        source: "kinematics of a body carried by a wall",
    };
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY)?;
    let resting =
        |x: f64| Placement::at_rest(0, Vector3::new(x, height, 1e-4), UnitQuaternion::identity());
    let mut rows = Vec::new();

    // A floor that rises with 0.05 m/s carries the ball up at that speed.
    let motion = Motion {
        velocity: Vector3::y() * 0.05,
        ..Motion::default()
    };
    let mesh = rectangle(0.05, 0.05, motion);
    let mut world = with_ball(resting(0.0), Vec::new(), vec![mesh], GRAVITY)?;
    run(&mut world, 100_000)?;
    let rise = world.bodies().position[0].y - height;
    rows.push(basis.row("rise of a ball on a lifted floor, 0.1 s", "m", 5e-3, rise));

    // A turntable drags a ball with mu g across the way of its surface.
    let motion = Motion {
        spin: Vector3::y() * 10.0,
        ..Motion::default()
    };
    let mesh = rectangle(0.05, 0.05, motion);
    let mut world = with_ball(resting(0.03), Vec::new(), vec![mesh], GRAVITY)?;
    run(&mut world, 5000)?;
    let drag = -world.bodies().velocity[0].z / world.time();
    let drag_row = Basis {
        tolerance: Tolerance::Relative(0.02),
        reason: "the spring loads within 3 % of the time",
        ..basis
    };
    rows.push(drag_row.row("drag of a turntable, mu g", "m/s2", 0.3 * GRAVITY, drag));

    // A vibrating floor: below g a ball stays on it, and follows its highest speed.
    let vibration = Vibration {
        amplitude: Vector3::y() * 1e-3,
        angular_frequency: 60.0,
    };
    let motion = Motion {
        vibration: Some(vibration),
        ..Motion::default()
    };
    let mesh = rectangle(0.05, 0.05, motion);
    let mut world = with_ball(resting(0.0), Vec::new(), vec![mesh], GRAVITY)?;
    run(&mut world, 200_000)?;
    let mut fastest = 0.0_f64;
    for _ in 0..110_000 {
        world.step()?;
        fastest = fastest.max(world.bodies().velocity[0].y);
    }
    rows.push(basis.row("highest speed on a vibrating floor", "m/s", 0.06, fastest));
    Ok(rows)
}
