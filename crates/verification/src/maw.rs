//! Oblique elastic impact in the variables of `[MawBarberFawcett1976]`.
//!
//! # Formula
//!
//! ```text
//! psi = K v_t / (mu v_n)     K = 2 (1 - nu) / (2 - nu)     chi = 7 K / 4
//! ```
//!
//! `psi_1` before, `psi_2` after the impact, both at the point of contact. Where the contact slides
//! throughout (`psi_1 > 4 chi - 1`), `psi_2 = psi_1 - 4 chi`. Below, a stored tangential displacement
//! turns the point of contact back: `psi_2 < 0` over the middle range. The law of the solver has no
//! partial slip within the contact, so there the comparison is with an integration of the same law.

use crate::CheckError;
use crate::impact_reference::Impact;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{DENSITY, RADIUS, ball, clipped, collide, elastic, floor, settings, surface};
use crate::worlds::{thrown, world};
use contact_law::material;
use nalgebra::Vector3;

/// Poisson's ratio of the published curves.
const POISSON: f64 = 0.3;

/// Friction; the variables make the result independent of it.
const FRICTION: f64 = 0.1;

/// Speed of approach, m/s.
const APPROACH: f64 = 0.2;

/// `psi_2` by the solver and by the reference, and the kinetic energy after over that before.
fn turned_back(psi: f64) -> Result<([f64; 2], f64), CheckError> {
    let ratio = 2.0 * (1.0 - POISSON) / (2.0 - POISSON);
    let own = elastic(1e8, POISSON)?;
    let moduli = material::effective_moduli(&own, &own);
    let mass = DENSITY * geometry::clump::volume_of_sphere(RADIUS);
    let sliding = psi * FRICTION * APPROACH / ratio;
    let impact = Impact {
        radius: RADIUS,
        mass,
        tangential_mass: 2.0 / 7.0 * mass,
        young: moduli.young,
        shear: moduli.shear,
        restitution: 1.0,
        friction: FRICTION,
        pulls: false,
        approach: APPROACH,
        sliding,
    };
    let velocity = Vector3::new(sliding, -APPROACH, 0.0);
    let start = thrown(0, Vector3::y() * (RADIUS * 1.00001), velocity);
    let step = impact.hertz_duration() / 4000.0;
    let mut world = world(
        settings(step, Vector3::zeros(), RADIUS),
        &clipped(surface([own; 2], [1.0, FRICTION, 0.0])),
        vec![ball(RADIUS, DENSITY)?],
        vec![floor()],
        &[start],
    )?;
    let before = world.kinetic_energy();
    collide(&mut world, 100_000)?;
    let bodies = world.bodies();
    let after = bodies.velocity[0].x + bodies.spin[0].z * RADIUS;
    let scale = ratio / (FRICTION * APPROACH);
    let reference = impact.integrate().sliding;
    let energy = world.kinetic_energy() / before;
    Ok(([after * scale, reference * scale], energy))
}

/// The curve at a few places.
pub(crate) fn curve() -> Result<Vec<Row>, CheckError> {
    let chi = 7.0 / 4.0 * 2.0 * (1.0 - POISSON) / (2.0 - POISSON);
    let slides = Basis {
        check: "maw",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(0.02),
        reason: "overlap over radius 2e-3, arm R - d/2, of psi_1 up to 10",
        source: "psi_2 = psi_1 - 4 chi; [MawBarberFawcett1976]",
    };
    let sticks = Basis {
        kind: Kind::CrossCode,
        source: "the law's formulas integrated apart",
        ..slides
    };
    let negative = Basis {
        kind: Kind::Trend,
        tolerance: Tolerance::Below,
        reason: "sign only",
        source: "sign of the curve; [MawBarberFawcett1976]",
        ..slides
    };
    let energy = Basis {
        kind: Kind::Analytical,
        tolerance: Tolerance::Below,
        reason: "friction can only take energy; 1e-6 for the time step",
        source: "conservation of energy",
        ..slides
    };
    let mut rows = Vec::new();
    for psi in [0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0] {
        let ([got, reference], left) = turned_back(psi)?;
        let name = format!("psi_1 = {psi}: psi_2");
        rows.push(if psi > 4.0 * chi - 1.0 {
            slides.row(name, "1", psi - 4.0 * chi, got)
        } else {
            sticks.row(name, "1", reference, got)
        });
        if psi == 2.0 || psi == 4.0 {
            rows.push(negative.row(format!("psi_1 = {psi}: psi_2 is negative"), "1", 0.0, got));
        }
        let name = format!("psi_1 = {psi}: kinetic energy left");
        rows.push(energy.row(name, "1", 1.0 + 1e-6, left));
    }
    Ok(rows)
}
