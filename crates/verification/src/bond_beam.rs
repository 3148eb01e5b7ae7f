//! A beam of bonded spheres against beam theory.
//!
//! A chain of n bonds of length l = 2 r is clamped at one end and loaded at the other. As a beam it has
//! `E = S_n l`, `G = S_t l`, the cross-section of the bond and the length n l. The bonds sit in the
//! middle between the centres, which is the midpoint rule for the integral of the beam: the
//! deflection is short by 1/(4 n²).

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{DENSITY, ball, settings, soft_surface, world};
use contact_law::bond::{Bond, BondSettings, BondStrength};
use dem_solver::bonds::Bonds;
use dem_solver::{Load, Placement, World};
use nalgebra::{UnitQuaternion, Vector3};

/// Number of bonds.
const N: usize = 10;

/// Radius of spheres and bonds, m.
const RADIUS: f64 = 1e-3;

fn law(strength: Option<BondStrength>) -> BondSettings {
    BondSettings {
        normal_stiffness: 1e10,
        shear_stiffness: 4e9,
        radius: RADIUS,
        damping_ratio: 0.3,
        strength,
    }
}

/// A chain along x whose first sphere is too heavy to move.
fn chain(strength: Option<BondStrength>) -> Result<(World, Bonds), CheckError> {
    // A gap of 1 % keeps the contacts of the spheres out of the bending.
    let at = |k: usize| Vector3::x() * (2.02 * RADIUS * k as f64);
    let starts: Vec<_> = (0..=N)
        .map(|k| Placement::at_rest(usize::from(k > 0), at(k), UnitQuaternion::identity()))
        .collect();
    let templates = vec![ball(RADIUS, 1e15)?, ball(RADIUS, DENSITY)?];
    let surface = soft_surface([1.0, 0.0, 0.0])?;
    let mut world = world(
        settings(1e-6, Vector3::zeros(), RADIUS),
        &surface,
        templates,
        Vec::new(),
        &starts,
    )?;
    let pairs: Vec<_> = (0..N).map(|k| [k, k + 1]).collect();
    let bonds = Bonds::new(&world, &pairs, Bond::new(&law(strength))?)?;
    world.step()?;
    Ok((world, bonds))
}

/// Loads the end with a force (N) and a torque (N m) until it rests; way and turn of the end.
fn loaded(
    force: Vector3<f64>,
    torque: Vector3<f64>,
    strength: Option<BondStrength>,
) -> Result<(Vector3<f64>, Vector3<f64>, usize), CheckError> {
    let (mut world, mut bonds) = chain(strength)?;
    let start = world.bodies().position[N];
    // Drag near the critical one of the lowest mode, 2 x 750 per second, brings the end to rest.
    let drag = 1500.0 * DENSITY * geometry::clump::volume_of_sphere(RADIUS);
    for _ in 0..40_000 {
        world.step_with(|bodies| {
            bonds.add_forces(bodies);
            for k in 1..=N {
                let (velocity, spin) = (bodies.velocity[k], bodies.spin[k]);
                bodies.load[k] +=
                    Load::new(&(-velocity * drag), &(-spin * (drag * RADIUS * RADIUS)));
            }
            bodies.load[N] += Load::new(&force, &torque);
        })?;
    }
    let bodies = world.bodies();
    let turn = bodies.orientation[N].scaled_axis();
    Ok((bodies.position[N] - start, turn, bonds.n_broken()))
}

/// Tension, bending and torsion.
pub(crate) fn beam() -> Result<Vec<Row>, CheckError> {
    let (length, link) = (2.02 * RADIUS * N as f64, 2.02 * RADIUS);
    let area = std::f64::consts::PI * RADIUS.powi(2);
    let polar = 0.5 * std::f64::consts::PI * RADIUS.powi(4);
    let settings = law(None);
    let (young, shear) = (
        settings.normal_stiffness * link,
        settings.shear_stiffness * link,
    );
    let basis = Basis {
        check: "bond-beam",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(5e-3),
        reason: "10 bonds as midpoint rule: 1/(4 n2) = 0.25 %; the rest is what still creeps",
        source: "Timoshenko's beam; [PotyondyCundall2004]",
    };
    let zero = Vector3::zeros();
    let pull = 1.0;
    let (way, _, _) = loaded(Vector3::x() * pull, zero, None)?;
    let mut rows = vec![basis.row(
        "tension: F L / (E A)",
        "m",
        pull * length / (young * area),
        way.x,
    )];
    let side = 1e-4;
    let (way, turn, _) = loaded(Vector3::y() * side, zero, None)?;
    let stiffness = young * 0.5 * polar;
    let bending = side * length.powi(3) / (3.0 * stiffness) + side * length / (shear * area);
    rows.push(basis.row("bending: F L3 / (3 E I) + F L / (G A)", "m", bending, way.y));
    let slope = side * length.powi(2) / (2.0 * stiffness);
    rows.push(basis.row("slope at the end: F L2 / (2 E I)", "rad", slope, turn.z));
    let twist = 1e-5;
    let (_, turn, _) = loaded(zero, Vector3::x() * twist, None)?;
    let turned = twist * length / (shear * polar);
    rows.push(basis.row("torsion: T L / (G J)", "rad", turned, turn.x));
    rows.extend(strength(&basis, area)?);
    Ok(rows)
}

/// Bonds that break below and above the strength of a cross-section (m²).
fn strength(basis: &Basis, area: f64) -> Result<[Row; 2], CheckError> {
    let whole = Basis {
        tolerance: Tolerance::Absolute(0.0),
        reason: "a count",
        source: "sigma_max A",
        ..*basis
    };
    let strength = BondStrength {
        tension: 1e5,
        shear: 1e5,
    };
    let limit = strength.tension * area;
    // Dragged, the load does not overshoot; a twentieth is more than the swings of the bonds.
    let broken_at = |share: f64| -> Result<f64, CheckError> {
        let force = Vector3::x() * (share * limit);
        Ok(loaded(force, Vector3::zeros(), Some(strength))?.2 as f64)
    };
    let broken = Basis {
        tolerance: Tolerance::Above,
        reason: "at least one",
        ..whole
    };
    let name = |share: f64| format!("broken bonds at {share} of the strength");
    Ok([
        whole.row(name(0.4), "1", 0.0, broken_at(0.4)?),
        broken.row(name(1.05), "1", 0.0, broken_at(1.05)?),
    ])
}
