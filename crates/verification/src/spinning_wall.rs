//! Analytic walls that spin: which way they drag a ball, and where it stays.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, GRAVITY, RADIUS, ball, floor, plane, resting_overlap, run, settings, soft_surface,
    thrown, world,
};
use dem_solver::{Placement, Settings, Shape, Wall, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Inner radius of the drum, m.
const DRUM: f64 = 0.05;

/// A basis of these rows.
fn basis(tolerance: Tolerance, reason: &'static str) -> Basis {
    Basis {
        check: "spinning-wall",
        kind: Kind::Analytical,
        tolerance,
        reason,
        source: "a wall moves with spin times position",
    }
}

/// The shell of a drum that lies along z.
fn shell(spin: f64) -> Wall {
    Wall {
        shape: Shape::Cylinder { radius: DRUM },
        spin,
        ..floor()
    }
}

/// One ball and its walls; `parameters` are restitution, static and rolling friction.
fn one_ball(
    settings: Settings,
    parameters: [f64; 3],
    walls: Vec<Wall>,
    start: Placement,
) -> Result<World, CheckError> {
    let surface = soft_surface(parameters)?;
    world(
        settings,
        &surface,
        vec![ball(RADIUS, DENSITY)?],
        walls,
        &[start],
    )
}

/// A ball in a turning drum, gravity along -y.
fn in_a_drum(start: Placement, spin: f64, rolling_friction: f64) -> Result<World, CheckError> {
    let settings = settings(2e-5, Vector3::y() * -GRAVITY, RADIUS);
    one_ball(
        settings,
        [0.3, 0.4, rolling_friction],
        vec![shell(spin)],
        start,
    )
}

/// A ball that rests on the shell at an angle from the bottom (rad).
fn resting(angle: f64) -> Result<Placement, CheckError> {
    let radius = DRUM - RADIUS + resting_overlap(RADIUS, GRAVITY)?;
    let position = Vector3::new(angle.sin(), -angle.cos(), 0.0) * radius;
    Ok(Placement::at_rest(0, position, UnitQuaternion::identity()))
}

/// A ball at a place on the turntable z = 0, which turns with 10 rad/s.
fn on_a_turntable(rolling_friction: f64, [x, y]: [f64; 2]) -> Result<World, CheckError> {
    let table = Wall {
        spin: 10.0,
        ..plane(Vector3::zeros(), Vector3::z())
    };
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY)?;
    let start = Placement::at_rest(0, Vector3::new(x, y, height), UnitQuaternion::identity());
    let settings = settings(1e-5, Vector3::z() * -GRAVITY, RADIUS);
    one_ball(settings, [0.3, 0.2, rolling_friction], vec![table], start)
}

/// All rows of walls that spin.
pub(crate) fn spinning() -> Result<Vec<Row>, CheckError> {
    let mut rows = Vec::new();
    for sign in [1.0, -1.0] {
        rows.extend(lifted(sign)?);
    }
    rows.extend(hanging()?);
    rows.extend(turntable()?);
    rows.extend(sides()?);
    Ok(rows)
}

/// A positive spin is counter-clockwise about z: the bottom of the drum moves towards +x, drags the ball there with
/// mu g, and lifts it.
fn lifted(sign: f64) -> Result<[Row; 3], CheckError> {
    let mut world = in_a_drum(resting(0.0)?, sign * 5.0, 0.0)?;
    let bottom = world.bodies().position[0].y;
    run(&mut world, 500)?;
    let name = |what| format!("drum with {} rad/s: {what}", sign * 5.0);
    let drag = basis(
        Tolerance::Relative(0.02),
        "curvature of the wall and the first loading of the spring",
    );
    let trend = Basis {
        kind: Kind::Trend,
        ..basis(Tolerance::Above, "sign only")
    };
    let bodies = world.bodies();
    let expected = sign * 0.4 * GRAVITY * world.time();
    let opposite = -sign * world.wall_load()[0].x;
    Ok([
        drag.row(
            name("speed of a ball, mu g t"),
            "m/s",
            expected,
            bodies.velocity[0].x,
        ),
        trend.row(
            name("rise of the ball"),
            "m",
            0.0,
            bodies.position[0].y - bottom,
        ),
        trend.row(
            name("force on the drum against its motion"),
            "N",
            0.0,
            opposite,
        ),
    ])
}

/// A ball that rolls on the spot in a turning drum hangs where gravity along the wall balances the friction that the rolling
/// resistance calls for: `tan(phi) = mu_r`, on the rising side. Put there, it stays for two periods of its swinging,
/// `2 pi sqrt(7/5 (R_drum - R) / g)` = 0.5 s.
fn hanging() -> Result<[Row; 2], CheckError> {
    let spin = 4.0 * DRUM / RADIUS;
    let start = Placement {
        spin: Vector3::z() * spin,
        ..resting(0.1_f64.atan())?
    };
    let mut world = in_a_drum(start, 4.0, 0.1)?;
    let mut tangent = 0.1_f64;
    for _ in 0..50 {
        run(&mut world, 1000)?;
        let position = world.bodies().position[0];
        let now = position.x / -position.y;
        if (now - 0.1).abs() >= (tangent - 0.1).abs() {
            tangent = now;
        }
    }
    let basis = basis(
        Tolerance::Relative(0.01),
        "the overlap, 0.3 % of R, and the first loading of the spring",
    );
    let name = "rolling ball in a drum: worst tangent in 1 s, mu_r";
    Ok([
        basis.row(name, "1", 0.1, tangent),
        basis.row(
            "its spin after 1 s",
            "rad/s",
            spin,
            world.bodies().spin[0].z,
        ),
    ])
}

/// A turntable drags a ball across the radius; rolling resistance takes a ball on its axis along within
/// `2 R w / (5 mu_r g)` = 8 ms.
fn turntable() -> Result<[Row; 3], CheckError> {
    let mut world = on_a_turntable(0.0, [0.03, 0.04])?;
    run(&mut world, 500)?;
    let drag = world.bodies().velocity[0] / (0.2 * GRAVITY * world.time());
    let off = (drag - Vector3::new(-0.8, 0.6, 0.0)).norm();
    let direction = basis(
        Tolerance::Absolute(0.01),
        "the spring loads within 1e-6 m at 0.5 m/s; the direction turns by 0.2 %",
    );
    let mut rests = on_a_turntable(0.1, [0.0, 0.0])?;
    run(&mut rests, 400)?;
    let early = rests.bodies().spin[0].z;
    let expected = 2.5 * 0.1 * GRAVITY / RADIUS * rests.time();
    run(&mut rests, 4600)?;
    let late = (rests.bodies().spin[0] - Vector3::z() * 10.0).norm();
    let torque = basis(
        Tolerance::Relative(0.01),
        "the first loading of the contact",
    );
    let fades = basis(Tolerance::Absolute(1e-6), "fades with 2500 per second");
    let name = |what| format!("turntable: {what}");
    Ok([
        direction.row(
            name("drag of a ball off mu g across the radius"),
            "1",
            0.0,
            off,
        ),
        torque.row(
            name("spin of a ball on the axis, 5/2 mu_r g t / R"),
            "rad/s",
            expected,
            early,
        ),
        fades.row(
            name("its spin off that of the table, 50 ms"),
            "rad/s",
            0.0,
            late,
        ),
    ])
}

/// Walls that a ball must not pass: the shell pushes a ball back whose centre is nearly outside, and a plate at rest stops a ball
/// that moves with the drum, although this ball is nearly at rest in the frame of the lists.
fn sides() -> Result<[Row; 2], CheckError> {
    let sign = |tolerance| Basis {
        kind: Kind::Trend,
        ..basis(tolerance, "sign only")
    };
    let deep = thrown(0, Vector3::y() * -(DRUM - 1e-6), Vector3::zeros());
    let mut world = in_a_drum(deep, 0.0, 0.0)?;
    run(&mut world, 1)?;
    let inwards = world.bodies().velocity[0].y;

    let half_edges = [Vector3::x() * 5e-3, Vector3::z() * 5e-3];
    let centre = Vector3::new(0.03, RADIUS + 1e-3, 0.0);
    let plate = Wall {
        shape: Shape::Rectangle { centre, half_edges },
        ..floor()
    };
    let start = Placement {
        spin: Vector3::z() * 10.0,
        ..thrown(0, Vector3::x() * 0.03, Vector3::y() * (0.03 * 10.0))
    };
    let settings = Settings {
        margin: 5e-3,
        ..settings(2e-5, Vector3::zeros(), RADIUS)
    };
    let mut world = one_ball(settings, [0.5, 0.0, 0.0], vec![shell(10.0), plate], start)?;
    run(&mut world, 300)?;
    let back = world.bodies().velocity[0].y;
    Ok([
        sign(Tolerance::Above).row("ball through the shell: speed inwards", "m/s", 0.0, inwards),
        sign(Tolerance::Below).row("ball along with the drum, after a plate", "m/s", 0.0, back),
    ])
}
