//! Attraction by the area of contact: rest, pull-off, energy.
//!
//! The force of a contact of the overlap d is `h d^(3/2) - c d`, with `h = 4/3 E* sqrt(R*)` and `c = 2 pi R* k` for a cohesion
//! energy density k. Its largest pull is `4 c³ / (27 h²)`, at `d = (2 c / (3 h))²`.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    DENSITY, GRAVITY, ball, clipped, floor, plane, run, settings, soft, soft_surface, thrown,
    touches,
};
use contact_law::LinearCohesion;
use contact_law::material::effective_moduli;
use dem_solver::{EnergyLedger, Interaction, OptionalLaws, Placement, Wall, World};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Radius of the balls, m.
const RADIUS: f64 = 1e-3;

/// Cohesion energy density, J/m³: an attraction near the weight of the ball at its overlap.
const COHESION: f64 = 1e4;

/// A basis of these rows.
fn basis(tolerance: Tolerance, reason: &'static str) -> Basis {
    Basis {
        check: "cohesion-by-area",
        kind: Kind::Analytical,
        tolerance,
        reason,
        source: "h d^(3/2) - c d",
    }
}

/// Balls with cohesion; `parameters` are restitution, static and rolling friction.
fn sticky(
    (parameters, time_step, gravity): ([f64; 3], f64, f64),
    wall: Wall,
    starts: &[Placement],
) -> Result<World, CheckError> {
    let further = OptionalLaws {
        linear_cohesion: Some(LinearCohesion::new(COHESION)?),
        ..OptionalLaws::default()
    };
    let surface = Interaction::new(&clipped(soft_surface(parameters)?))?.with(&further);
    let settings = settings(time_step, Vector3::y() * -gravity, 2.0 * RADIUS);
    let balls = vec![ball(RADIUS, DENSITY)?];
    Ok(World::new(
        settings,
        balls,
        vec![surface],
        vec![wall],
        starts,
    )?)
}

/// A ball at rest at a height, m.
fn at(height: f64) -> Placement {
    thrown(0, Vector3::y() * height, Vector3::zeros())
}

/// Restitution, static and rolling friction of balls that come to rest.
const DAMPED: [f64; 3] = [0.4, 0.4, 0.05];

/// The constants h and c of a contact of a reduced radius (m).
fn constants(reduced_radius: f64) -> Result<[f64; 2], CheckError> {
    let young = effective_moduli(&soft()?, &soft()?).young;
    let h = 4.0 / 3.0 * young * reduced_radius.sqrt();
    Ok([h, 2.0 * PI * reduced_radius * COHESION])
}

/// All rows of cohesion by the area.
pub(crate) fn cohesion() -> Result<Vec<Row>, CheckError> {
    let mut rows = rest()?;
    rows.extend(pull_off()?);
    rows.extend(energy()?);
    Ok(rows)
}

/// A ball on another on a floor: each contact carries the weight above it by Hertz's force less the attraction.
fn rest() -> Result<Vec<Row>, CheckError> {
    let starts = [at(RADIUS), at(3.0 * RADIUS)];
    let mut world = sticky((DAMPED, 2e-6, GRAVITY), floor(), &starts)?;
    run(&mut world, 250_000)?;
    let weight = world.templates()[0].mass() * GRAVITY;
    let [low, high] = [0, 1].map(|k| world.bodies().position[k].y);
    let carries = basis(
        Tolerance::Relative(1e-6),
        "0.5 s: rounding of a sum over the steps",
    );
    let attracts = Basis {
        kind: Kind::Trend,
        ..basis(Tolerance::Above, "an attraction that matters")
    };
    let mut rows = Vec::new();
    for (name, overlap, reduced_radius, load) in [
        ("floor", RADIUS - low, RADIUS, 2.0 * weight),
        ("ball", 2.0 * RADIUS - (high - low), 0.5 * RADIUS, weight),
    ] {
        let [h, c] = constants(reduced_radius)?;
        let carried = h * overlap.powf(1.5) - c * overlap;
        rows.push(carries.row(format!("force of a {name} at rest"), "N", load, carried));
        let name = format!("attraction of a {name} above 0.2 of its load");
        rows.push(attracts.row(name, "N", 0.2 * load, c * overlap));
    }
    Ok(rows)
}

/// A ball hangs from a ceiling against nine tenths of the largest pull, and falls from eleven.
fn pull_off() -> Result<Vec<Row>, CheckError> {
    let [h, c] = constants(RADIUS)?;
    let most = 4.0 * c.powi(3) / (27.0 * h * h);
    let deepest = (2.0 * c / (3.0 * h)).powi(2);
    let count = basis(Tolerance::Absolute(0.0), "a count");
    let mut rows = Vec::new();
    for (share, expected) in [(0.9, 1.0), (1.1, 0.0)] {
        let gravity = share * most / ball(RADIUS, DENSITY)?.mass();
        let ceiling = plane(Vector3::zeros(), -Vector3::y());
        let mut world = sticky((DAMPED, 2e-6, gravity), ceiling, &[at(deepest - RADIUS)])?;
        run(&mut world, 500_000)?;
        let name = format!("contacts that hold {share} of the largest pull");
        rows.push(count.row(name, "1", expected, world.n_wall_contacts() as f64));
    }
    Ok(rows)
}

/// The attraction belongs to the energy of a contact: a ball without damping meets a floor, slowly enough for the attraction to be a
/// good part of the force.
fn energy() -> Result<[Row; 2], CheckError> {
    let start = thrown(0, Vector3::y() * (1.000_01 * RADIUS), Vector3::y() * -0.01);
    let mut world = sticky(([1.0, 0.0, 0.0], 5e-7, 0.0), floor(), &[start])?;
    let mut ledger = EnergyLedger::default();
    ledger.step(&mut world)?;
    let first = ledger.terms().kinetic;
    let (mut most, mut n) = (0.0_f64, 0_u32);
    for _ in 0..4000 {
        ledger.step(&mut world)?;
        let terms = ledger.terms();
        most = most.max((terms.kinetic + terms.elastic - first).abs() / first);
        n += u32::from(touches(&world));
    }
    let kept = basis(
        Tolerance::Absolute(1e-5),
        "second order of a thousand steps in a contact",
    );
    let long = Basis {
        kind: Kind::Trend,
        ..basis(Tolerance::Above, "a contact of many steps")
    };
    Ok([
        kept.row("elastic impact: change of the energy", "1", 0.0, most),
        long.row("its steps of contact", "1", 500.0, f64::from(n)),
    ])
}
