//! Restitution against speed, and the restitution trap.

use crate::CheckError;
use crate::impact_reference::Impact;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, RADIUS, ball, clipped, collide, floor, settings, soft, soft_surface, thrown, world,
};
use contact_law::{NormalForceEnd, material};
use nalgebra::Vector3;

/// Rebound of a ball from the floor, and the same impact for the reference.
fn rebound(restitution: f64, speed: f64, end: NormalForceEnd) -> Result<(f64, Impact), CheckError> {
    let moduli = material::effective_moduli(&soft()?, &soft()?);
    let mass = DENSITY * geometry::clump::volume_of_sphere(RADIUS);
    let reference = Impact {
        radius: RADIUS,
        mass,
        tangential_mass: 2.0 / 7.0 * mass,
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
    let start = thrown(0, Vector3::y() * (RADIUS * 1.0001), Vector3::y() * -speed);
    let step = reference.hertz_duration() / 10_000.0;
    let mut world = world(
        settings(step, Vector3::zeros(), RADIUS),
        &surface,
        vec![ball(RADIUS, DENSITY)?],
        vec![floor()],
        &[start],
    )?;
    collide(&mut world, 100_000)?;
    Ok((world.bodies().velocity[0].y / speed, reference))
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
            let (got, _) = rebound(restitution, speed, NormalForceEnd::Attractive)?;
            let name = format!("restitution {restitution} at {speed} m/s");
            rows.push(basis.row(name, "1", restitution, got));
        }
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
            let (got, reference) = rebound(restitution, 0.2, end)?;
            let expected = reference.integrate().separation / 0.2;
            let name = format!("restitution {restitution} put in, {word} end: what comes out");
            rows.push(basis.row(name, "1", expected, got));
        }
    }
    Ok(rows)
}
