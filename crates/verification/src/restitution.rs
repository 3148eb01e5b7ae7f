//! Restitution against speed and partner, and the restitution trap.

use crate::CheckError;
use crate::impact_reference::Impact;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, RADIUS, ball, clipped, collide, floor, settings, soft, soft_surface, thrown, world,
};
use contact_law::{NormalForceEnd, material};
use nalgebra::Vector3;

/// What a ball meets.
#[derive(Debug, Clone, Copy)]
enum Partner {
    Floor,
    /// Another ball, which comes as fast.
    Ball,
}

/// A rebound: restitution, time of contact (s), and the same impact for the reference.
fn rebound(
    partner: Partner,
    restitution: f64,
    speed: f64,
    end: NormalForceEnd,
) -> Result<([f64; 2], Impact), CheckError> {
    let moduli = material::effective_moduli(&soft()?, &soft()?);
    let mass = DENSITY * geometry::clump::volume_of_sphere(RADIUS);
    let (share, walls) = match partner {
        Partner::Floor => (1.0, vec![floor()]),
        Partner::Ball => (0.5, Vec::new()),
    };
    let reference = Impact {
        radius: share * RADIUS,
        mass: share * mass,
        tangential_mass: 2.0 / 7.0 * share * mass,
        young: moduli.young,
        shear: moduli.shear,
        restitution,
        friction: 0.0,
        pulls: end == NormalForceEnd::Attractive,
        approach: speed,
        sliding: 0.0,
    };
    let surface = soft_surface([restitution, 0.2, 0.0])?;
    let surface = match end {
        NormalForceEnd::Attractive => surface,
        NormalForceEnd::Clipped => clipped(surface),
    };
    let at = |side: f64| {
        let (place, velocity) = (side * RADIUS * 1.0001, -side * share * speed);
        thrown(0, Vector3::y() * place, Vector3::y() * velocity)
    };
    let starts = match partner {
        Partner::Floor => vec![at(1.0)],
        Partner::Ball => vec![at(1.0), at(-1.0)],
    };
    let step = reference.hertz_duration() / 10_000.0;
    let mut world = world(
        settings(step, Vector3::zeros(), RADIUS),
        &surface,
        vec![ball(RADIUS, DENSITY)?],
        walls,
        &starts,
    )?;
    let duration = collide(&mut world, 100_000)?;
    let apart = world.bodies().velocity[0].y / (share * speed);
    Ok(([apart, duration], reference))
}

/// Restitution at speeds from 0.01 m/s to 1 m/s.
pub(crate) fn against_speed() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "restitution-speed",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(1e-3),
        reason: "exact for this law at any speed; first order of 10 000 steps a contact",
        source: "[Tsuji1992]",
    };
    let mut rows = Vec::new();
    for restitution in [0.06, 0.5, 0.9] {
        for speed in [0.01, 0.1, 1.0] {
            let pulls = NormalForceEnd::Attractive;
            let ([got, _], _) = rebound(Partner::Floor, restitution, speed, pulls)?;
            let name = format!("restitution {restitution} at {speed} m/s");
            rows.push(basis.row(name, "1", restitution, got));
        }
    }
    for restitution in [0.06, 0.42, 0.9] {
        let ([got, _], _) = rebound(Partner::Ball, restitution, 0.2, NormalForceEnd::Attractive)?;
        let name = format!("two balls, restitution {restitution} at 0.2 m/s");
        rows.push(basis.row(name, "1", restitution, got));
    }
    let lasts = Basis {
        tolerance: Tolerance::Relative(3e-4),
        reason: "counted in whole steps, 10 000 a contact",
        source: "[Hertz1881]",
        ..basis
    };
    for (partner, name) in [(Partner::Floor, "floor"), (Partner::Ball, "other ball")] {
        let ([got, duration], impact) = rebound(partner, 1.0, 0.2, NormalForceEnd::Attractive)?;
        rows.push(basis.row(format!("restitution 1, {name}"), "1", 1.0, got));
        let name = format!("duration of an elastic contact, {name}");
        rows.push(lasts.row(name, "s", impact.hertz_duration(), duration));
    }
    Ok(rows)
}

/// The trap: what comes out where the dashpot may pull, and where its pull is clipped.
pub(crate) fn trap() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "restitution-trap",
        kind: Kind::CrossCode,
        tolerance: Tolerance::Absolute(1e-3),
        reason: "independent integration; first order of 10 000 steps a contact",
        source: "[ThorntonCumminsCleary2013] discuss both ends",
    };
    let mut rows = Vec::new();
    for restitution in [0.06, 0.13, 0.5] {
        for (end, word) in [
            (NormalForceEnd::Attractive, "attractive"),
            (NormalForceEnd::Clipped, "clipped"),
        ] {
            let ([got, _], reference) = rebound(Partner::Floor, restitution, 0.2, end)?;
            let expected = reference.integrate().separation / 0.2;
            let name = format!("restitution {restitution} put in, {word} end: what comes out");
            rows.push(basis.row(name, "1", expected, got));
        }
    }
    Ok(rows)
}
