//! Bridges of liquid: rupture, the energy that it costs, squeezing out, drawing apart, sliding.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{DENSITY, RADIUS, ball, floor, run, settings, soft_surface, thrown};
use contact_law::{BridgeForce, CapillaryBridge, ViscousBridge, ViscousForce};
use dem_solver::{Interaction, OptionalLaws, Placement, Wall, World};
use nalgebra::Vector3;
use std::f64::consts::{E, PI};

/// Surface tension of water, N/m.
const TENSION: f64 = 0.072;

/// Angle of contact, rad.
const ANGLE: f64 = 0.2;

/// Volume of the bridge between two balls, m³.
const VOLUME: f64 = 1e-10;

/// Roughness, m.
const ROUGHNESS: f64 = 1e-6;

/// Balls without dashpot and friction, with a bridge; a ball gives `volume` (m³) to each of its bridges.
fn wet(
    [time_step, volume]: [f64; 2],
    gravity: Vector3<f64>,
    bridge: BridgeForce,
    walls: Vec<Wall>,
    starts: &[Placement],
) -> Result<World, CheckError> {
    let further = OptionalLaws {
        bridge: Some(bridge),
        ..OptionalLaws::default()
    };
    let surface = Interaction::new(&soft_surface([1.0, 0.0, 0.0])?)?.with(&further);
    let balls = vec![ball(RADIUS, DENSITY)?.with_liquid(6.0 * volume)];
    let settings = settings(time_step, gravity, RADIUS);
    Ok(World::new(settings, balls, vec![surface], walls, starts)?)
}

/// Two balls with a distance of the centres (m) that move apart with a speed (m/s) against each other.
fn parting(distance: f64, speed: f64) -> [Placement; 2] {
    let at = |sign: f64| {
        let (place, velocity) = (0.5 * sign * distance, 0.5 * sign * speed);
        thrown(0, Vector3::x() * place, Vector3::x() * velocity)
    };
    [at(-1.0), at(1.0)]
}

/// Gap of two balls, m, and their speed apart, m/s.
fn apart(world: &World) -> [f64; 2] {
    let bodies = world.bodies();
    let gap = (bodies.position[1] - bodies.position[0]).norm() - 2.0 * RADIUS;
    [gap, (bodies.velocity[1] - bodies.velocity[0]).x]
}

/// Integral of `1/(1 + 1.05 x + 2.5 x²)` from 0 to an end.
fn integral(end: f64) -> f64 {
    let root = (10.0_f64 - 1.05 * 1.05).sqrt();
    let inverse = |x: f64| (5.0 * x + 1.05).atan2(root);
    2.0 / root * (inverse(end) - inverse(0.0))
}

/// Mass of a ball, kg.
fn mass() -> f64 {
    DENSITY * 4.0 / 3.0 * PI * RADIUS.powi(3)
}

pub(crate) fn bridges() -> Result<Vec<Row>, CheckError> {
    let mut rows = rupture()?;
    rows.push(drawing_apart()?);
    rows.push(drainage()?);
    rows.extend(sliding()?);
    Ok(rows)
}

/// Two balls that meet, touch and part: where the bridge breaks and what it took.
fn rupture() -> Result<Vec<Row>, CheckError> {
    let law = CapillaryBridge::new(TENSION, ANGLE)?.between(RADIUS);
    let (speed, step) = (0.2, 1e-7);
    let starts = parting(2.0 * RADIUS + 1e-5, -speed);
    let volume = 0.5 * VOLUME;
    let mut world = wet([step, volume], Vector3::zeros(), law, vec![], &starts)?;
    let (mut formed, mut gap) = (f64::INFINITY, 0.0);
    for _ in 0..200_000 {
        let before = apart(&world)[0];
        world.step()?;
        let pulls = world.bodies().load[0].force().x > 0.0;
        if formed.is_infinite() && world.bodies().load[0].force().x != 0.0 {
            formed = before;
        }
        if pulls {
            gap = before;
        } else if gap > 0.0 && apart(&world)[0] > 2.0 * gap {
            break;
        }
    }
    let [end, left] = apart(&world);
    if end < 2.0 * gap || gap <= 0.0 {
        return Err(CheckError::NoEvent("the rupture of a bridge"));
    }
    let basis = Basis {
        check: "liquid-bridge",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(2.0 * speed * step),
        reason: "the way of two steps",
        source: "[Lian1993]",
    };
    let longest = (1.0 + 0.5 * ANGLE) * VOLUME.cbrt();
    let mut rows = vec![
        basis.row("gap at which a bridge forms", "m", 0.0, formed),
        basis.row(
            "gap at which it breaks, (1 + t/2) V^(1/3)",
            "m",
            longest,
            gap,
        ),
    ];
    let reduced = 0.5 * mass();
    let lost = 0.5 * reduced * (speed * speed - left * left);
    let scale = (VOLUME / RADIUS).sqrt();
    let touching = 2.0 * PI * RADIUS * TENSION * ANGLE.cos();
    let energy = Basis {
        tolerance: Tolerance::Relative(2e-3),
        reason: "first order of 1e-7 s over a contact, whose energy is twice what is lost",
        source: "integral of [Willett2000] up to the gap of [Lian1993]",
        ..basis
    };
    let work = touching * scale * integral(longest / scale);
    rows.push(energy.row("energy lost in meeting and parting", "J", work, lost));
    Ok(rows)
}

/// A liquid without tension: its resistance and its bridge, between surfaces of a mean radius (m).
fn syrup(viscosity: f64, radius: f64) -> Result<(ViscousForce, BridgeForce), CheckError> {
    let viscous = ViscousBridge::new(viscosity, ROUGHNESS)?.between(radius);
    let bridge = CapillaryBridge::new(0.0, 0.0)?.between(radius);
    let force = viscous.ok_or(CheckError::NoEvent("viscosity"))?;
    Ok((force, bridge.with_viscosity(viscous)))
}

/// Two balls in much liquid that are driven apart from the touch: the speed lost up to a gap.
///
/// `m dv/dD = -6 pi h R*²/max(D, e)`: the speed falls by `k (1 + ln(D/e))` with `k = 6 pi h R*²/m`.
fn drawing_apart() -> Result<Row, CheckError> {
    let (viscosity, step, far) = (0.05, 2e-8, 1e-4);
    let (_, law) = syrup(viscosity, RADIUS)?;
    let starts = parting(2.0 * RADIUS * (1.0 - 1e-8), 0.5);
    // So much liquid that a bridge of it is a sea.
    let mut world = wet([step, 1e-2], Vector3::zeros(), law, vec![], &starts)?;
    let mut last = apart(&world);
    for _ in 0..200_000 {
        world.step()?;
        let now = apart(&world);
        if now[0] > far {
            let share = (far - last[0]) / (now[0] - last[0]);
            let speed = last[1] + share * (now[1] - last[1]);
            let reduced = 0.5 * RADIUS;
            let factor = 6.0 * PI * viscosity * reduced * reduced / (0.5 * mass());
            let basis = Basis {
                check: "liquid-bridge",
                kind: Kind::Analytical,
                tolerance: Tolerance::Relative(2e-3),
                reason: "a step at first is 1 % of the roughness long; a finite bridge takes 1e-4 off",
                source: "[AdamsPerchard1985], integrated over the gap",
            };
            let name = "speed lost from the touch to a gap of 100 roughnesses";
            let expected = factor * (1.0 + (far / ROUGHNESS).ln());
            return Ok(basis.row(name, "m/s", expected, 0.5 - speed));
        }
        last = now;
    }
    Err(CheckError::NoEvent("two balls that come apart"))
}

/// A ball that is drawn off a floor through syrup and then sinks back: `D = D_0 exp(-t m g/(6 pi h R²))`.
fn drainage() -> Result<Row, CheckError> {
    let (viscosity, gravity) = (1.0, 100.0);
    let (_, law) = syrup(viscosity, 2.0 * RADIUS)?;
    let start = thrown(0, Vector3::y() * (RADIUS * (1.0 - 1e-8)), Vector3::y());
    let down = -Vector3::y() * gravity;
    let mut world = wet([5e-7, 1e-2], -down, law, vec![floor()], &[start])?;
    let mut times = [0.0; 2];
    let gap = |world: &World| world.bodies().position[0].y - RADIUS;
    let (high, low) = (2e-5 * E, 2e-5);
    let mut sinks = false;
    for _ in 0..1_000_000 {
        let before = gap(&world);
        world.step()?;
        let now = gap(&world);
        if !sinks && now > 1.5 * high {
            world.set_gravity(down)?;
            sinks = true;
        }
        for (time, level) in times.iter_mut().zip([high, low]) {
            if sinks && before > level && now <= level {
                *time = world.time();
            }
        }
        if times[1] > 0.0 {
            break;
        }
    }
    if times[1] <= times[0] {
        return Err(CheckError::NoEvent("a ball that sinks through syrup"));
    }
    let basis = Basis {
        check: "liquid-bridge",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(2e-3),
        reason: "inertia, 8e-4 of the drag here; a finite bridge takes 1e-4 off",
        source: "[AdamsPerchard1985] with the weight in balance",
    };
    let expected = 6.0 * PI * viscosity * RADIUS * RADIUS / (mass() * gravity);
    let name = "time in which the gap under a sinking ball falls by e";
    Ok(basis.row(name, "s", expected, times[1] - times[0]))
}

/// A ball thrown along a wet floor without friction: it slides until it rolls, and then nothing holds it.
fn sliding() -> Result<Vec<Row>, CheckError> {
    let (_, law) = syrup(1.0, 2.0 * RADIUS)?;
    let start = thrown(
        0,
        Vector3::y() * (RADIUS * (1.0 - 1e-8)),
        Vector3::x() * 0.1,
    );
    let mut world = wet([5e-8, 1e-2], Vector3::zeros(), law, vec![floor()], &[start])?;
    let bracket = 8.0 / 15.0 * (RADIUS / ROUGHNESS).ln() + 0.9588;
    let resistance = 6.0 * PI * RADIUS * bracket;
    let decay = 2.0 / 7.0 * mass() / resistance;
    let slip = |world: &World| {
        let bodies = world.bodies();
        bodies.velocity[0].x + bodies.spin[0].z * RADIUS
    };
    let mut before = slip(&world);
    let mut time = f64::NAN;
    for _ in 0..20_000 {
        world.step()?;
        let now = slip(&world);
        if time.is_nan() && now < 0.1 / E {
            // Within the step in which it happens.
            let late = (0.1 / E - now) / (before - now);
            time = world.time() - late * world.settings().time_step;
        }
        before = now;
    }
    let basis = Basis {
        check: "liquid-bridge",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(2e-3),
        reason: "first order of a step that is a thousandth of the time",
        source: "[GoldmanCoxBrenner1967; Nase2001]; v and w R change as 1 to 5/2",
    };
    let rolls = world.bodies().velocity[0].x;
    run(&mut world, 10_000)?;
    Ok(vec![
        basis.row(
            "time in which sliding on a wet floor falls by e",
            "s",
            decay,
            time,
        ),
        basis.row(
            "speed when the ball rolls, 5/7 of the first",
            "m/s",
            0.5 / 7.0,
            rolls,
        ),
        basis.row(
            "speed after rolling on, over that before",
            "1",
            1.0,
            world.bodies().velocity[0].x / rolls,
        ),
    ])
}
