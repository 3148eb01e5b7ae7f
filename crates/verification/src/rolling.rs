//! Bodies on planes: from sliding to rolling, rolling and sliding down an incline, rolling resistance.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, GRAVITY, RADIUS, ball, cluster, floor, resting_overlap, run, settings, soft_surface,
    thrown, world,
};
use contact_law::RollingLever;
use dem_solver::{DashpotMass, Interaction, OptionalLaws, Placement, Template, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Time step, a hundredth of a contact, s.
const STEP: f64 = 1e-5;

/// A body on the floor; gravity is tilted by an angle (rad) towards +x.
fn on_the_floor(
    body: Template,
    parameters: [f64; 3],
    tilt: f64,
    start: Placement,
) -> Result<World, CheckError> {
    let gravity = Vector3::new(tilt.sin(), -tilt.cos(), 0.0) * GRAVITY;
    world(
        settings(STEP, gravity, RADIUS),
        &soft_surface(parameters)?,
        vec![body],
        vec![floor()],
        &[start],
    )
}

/// A ball on the floor, pressed in by its weight, and its overlap over its radius.
fn ball_on_the_floor(
    parameters: [f64; 3],
    tilt: f64,
    speed: f64,
    spin: f64,
) -> Result<(World, f64), CheckError> {
    let overlap = resting_overlap(RADIUS, GRAVITY * tilt.cos())?;
    let start = Placement {
        spin: Vector3::z() * spin,
        ..thrown(0, Vector3::y() * (RADIUS - overlap), Vector3::x() * speed)
    };
    let world = on_the_floor(ball(RADIUS, DENSITY)?, parameters, tilt, start)?;
    Ok((world, overlap / RADIUS))
}

/// Mean acceleration along x over some steps, m/s².
fn acceleration(world: &mut World, n_steps: usize) -> Result<f64, CheckError> {
    let (time, velocity) = (world.time(), world.bodies().velocity[0].x);
    run(world, n_steps)?;
    Ok((world.bodies().velocity[0].x - velocity) / (world.time() - time))
}

/// A ball thrown along a level floor.
pub(crate) fn slip_to_roll() -> Result<Vec<Row>, CheckError> {
    let (mut world, flattening) = ball_on_the_floor([0.5, 0.3, 0.0], 0.0, 0.3, 0.0)?;
    let basis = |tolerance, reason| Basis {
        check: "slip-to-roll",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(tolerance),
        reason,
        source: "angular momentum about the point of contact is kept",
    };
    let slides = basis(1e-3, "the spring loads within 1e-3 of the time");
    let slows = basis(2.0 * flattening, "friction acts at the arm R - d/2, not R");
    let rolls = basis(
        flattening + 1e-3,
        "arm as above; a tangential vibration remains in the contact",
    );
    run(&mut world, 2000)?;
    let sliding = world.bodies().velocity[0].x;
    let expected = 0.3 - 0.3 * GRAVITY * world.time();
    run(&mut world, 8000)?;
    let (velocity, spin) = (world.bodies().velocity[0].x, world.bodies().spin[0].z);
    Ok(vec![
        slides.row("speed while sliding, v - mu g t", "m/s", expected, sliding),
        slows.row(
            "speed when rolling, 5/7 v",
            "m/s",
            5.0 / 7.0 * 0.3,
            velocity,
        ),
        rolls.row(
            "spin when rolling, v / R",
            "rad/s",
            velocity / RADIUS,
            -spin,
        ),
    ])
}

/// A dumb-bell that rolls on the floor about its axis, slowed down by rolling resistance: its two spheres of radius R
/// lie at 2 R from its centre, so that a contact is R from the centre of its sphere and sqrt(5) R from that of the body.
pub(crate) fn dumb_bell() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "rolling-lever",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(3e-3),
        reason: "arm R - d/2 (d/R up to 6e-4) and the first loading of the tangential spring",
        source: "5/7 mu_r g L/R with L = R or sqrt(5) R",
    };
    let mut rows = Vec::new();
    for (lever, name, share) in [
        (RollingLever::Sphere, "sphere", 1.0),
        (RollingLever::Centre, "centre", 5.0_f64.sqrt()),
    ] {
        let body = cluster(&[
            ([0.0, 0.0, -2.0 * RADIUS], RADIUS),
            ([0.0, 0.0, 2.0 * RADIUS], RADIUS),
        ])?;
        let further = OptionalLaws {
            rolling_lever: lever,
            ..OptionalLaws::default()
        };
        let surface = Interaction::new(&soft_surface([0.5, 0.3, 0.02])?)?.with(&further);
        let overlap = resting_overlap(RADIUS, GRAVITY)?;
        // The frame of a body follows its moments of inertia.
        let axis = body.spheres()[0].centre;
        let along_z = UnitQuaternion::rotation_between(&axis, &Vector3::z());
        let start = Placement {
            orientation: along_z.unwrap_or_default(),
            spin: Vector3::z() * (-0.3 / RADIUS),
            ..thrown(0, Vector3::y() * (RADIUS - overlap), Vector3::x() * 0.3)
        };
        let mut world = World::new(
            settings(STEP, -Vector3::y() * GRAVITY, RADIUS),
            vec![Template::new(&body, 0, DashpotMass::Body)],
            vec![surface],
            vec![floor()],
            &[start],
        )?;
        run(&mut world, 5000)?;
        let got = -acceleration(&mut world, 10_000)?;
        let expected = 5.0 / 7.0 * 0.02 * GRAVITY * share;
        rows.push(basis.row(
            format!("slowing of a dumb-bell, arm of the {name}"),
            "m/s2",
            expected,
            got,
        ));
    }
    Ok(rows)
}

/// A ball and a block on inclines, and a ball slowed down by rolling resistance.
pub(crate) fn inclines() -> Result<Vec<Row>, CheckError> {
    let within = |tolerance, reason| Basis {
        check: "incline",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(tolerance),
        reason,
        source: "5/7 g sin; g (sin - mu cos) above tan = 7/2 mu; 5/7 mu_r g",
    };
    let basis = |flattening: f64| {
        within(
            1e-3 + 2.0 * flattening,
            "arm R - d/2 (d/R up to 6e-4) and the first loading of the tangential spring",
        )
    };
    let mut rows = Vec::new();
    for degrees in [5.0_f64, 20.0, 40.0] {
        let angle = degrees.to_radians();
        let (mut world, flattening) = ball_on_the_floor([0.3, 0.5, 0.0], angle, 0.0, 0.0)?;
        run(&mut world, 10_000)?;
        let got = acceleration(&mut world, 10_000)?;
        let expected = 5.0 / 7.0 * GRAVITY * angle.sin();
        let name = format!("rolling down {degrees} deg");
        rows.push(basis(flattening).row(name, "m/s2", expected, got));
    }
    let angle = 70.0_f64.to_radians();
    let (mut world, flattening) = ball_on_the_floor([0.3, 0.5, 0.0], angle, 0.0, 0.0)?;
    run(&mut world, 2000)?;
    let got = acceleration(&mut world, 8000)?;
    let expected = sliding(angle);
    rows.push(basis(flattening).row("sliding down 70 deg", "m/s2", expected, got));

    let (mut world, flattening) = ball_on_the_floor([0.5, 0.3, 0.02], 0.0, 0.3, -0.3 / RADIUS)?;
    run(&mut world, 5000)?;
    let got = -acceleration(&mut world, 10_000)?;
    let expected = 5.0 / 7.0 * 0.02 * GRAVITY;
    rows.push(basis(flattening).row("slowing by rolling friction 0.02", "m/s2", expected, got));

    let angle = 1.2 * 0.5_f64.atan();
    let mut world = block_on_the_floor(angle)?;
    run(&mut world, 5000)?;
    let got = acceleration(&mut world, 10_000)?;
    let loads = within(0.01, "friction loads the lower spheres more, which swing");
    let name = "a block sliding down 1.2 of the friction angle";
    rows.push(loads.row(name, "m/s2", sliding(angle), got));

    let mut world = block_on_the_floor(0.9 * 0.5_f64.atan())?;
    run(&mut world, 20_000)?;
    let overlap = resting_overlap(RADIUS, GRAVITY)?;
    let before = world.bodies().position[0].x;
    run(&mut world, 20_000)?;
    let creep = world.bodies().position[0].x - before;
    let sticks = |overlaps, reason| Basis {
        tolerance: Tolerance::Absolute(overlaps * overlap),
        source: "Coulomb: a block below the friction angle rests",
        ..within(0.0, reason)
    };
    let name = |what| format!("a block at 0.9 of the friction angle: {what}");
    let slip = sticks(5.0, "the slip of its springs, a few overlaps");
    rows.push(slip.row(name("displacement"), "m", 0.0, before));
    let rest = sticks(1e-3, "what still swings, in overlaps");
    rows.push(rest.row(name("creep in 0.2 s"), "m", 0.0, creep));
    Ok(rows)
}

/// Acceleration of a body that slides down an incline (rad) with a friction of 0.5, m/s².
fn sliding(angle: f64) -> f64 {
    GRAVITY * (angle.sin() - 0.5 * angle.cos())
}

/// Four spheres on the corners of a flat square of 8 mm, which cannot roll.
fn block_on_the_floor(angle: f64) -> Result<World, CheckError> {
    let corners = [[-4e-3, -4e-3], [-4e-3, 4e-3], [4e-3, -4e-3], [4e-3, 4e-3]];
    let body = cluster(&corners.map(|[x, y]| ([x, y, 0.0], RADIUS)))?;
    // The principal axes come in the order of the moments: the thin axis of the square is z.
    let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    // Each of the four spheres carries the weight of one.
    let height = RADIUS - resting_overlap(RADIUS, GRAVITY * angle.cos())?;
    let start = Placement::at_rest(0, Vector3::y() * height, upright);
    let template = Template::new(&body, 0, DashpotMass::Body);
    on_the_floor(template, [0.3, 0.5, 0.0], angle, start)
}
