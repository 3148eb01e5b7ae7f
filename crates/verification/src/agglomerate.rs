//! Agglomerates whose spheres overlap or touch a wall at several places at once.

use crate::CheckError;
use crate::impact_reference::Impact;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{
    GRAVITY, clipped, cluster, collide, floor, run, settings, soft, soft_surface, thrown, world,
};
use contact_law::material;
use dem_solver::{DashpotMass, Placement, Template};
use geometry::clump::{Clump, MassProperties, Sphere};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Free fall of bodies with 1, 2 and 9 spheres at one place.
pub(crate) fn gravity() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "gravity-overlap",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(1e-12),
        reason: "rounding of 1000 additions",
        source: "v = g t whatever the number of spheres",
    };
    let mut rows = Vec::new();
    for n in [1_usize, 2, 9] {
        // Sphere k lies a little aside, so that the overlaps are unsymmetrical.
        let aside = |k: usize| [1e-4 * k as f64, 5e-5 * (k * k) as f64, 0.0];
        let spheres: Vec<_> = (0..n).map(|k| (aside(k), 1e-3)).collect();
        let template = Template::new(&cluster(&spheres)?, 0, DashpotMass::Sphere);
        let mut world = world(
            settings(1e-4, Vector3::y() * -GRAVITY, 1e-3),
            &soft_surface([0.5, 0.5, 0.0])?,
            vec![template],
            Vec::new(),
            &[Placement::at_rest(
                0,
                Vector3::zeros(),
                UnitQuaternion::identity(),
            )],
        )?;
        run(&mut world, 1000)?;
        let bodies = world.bodies();
        let name = |what| format!("{n} overlapping spheres: {what}");
        rows.push(basis.row(name("speed"), "m/s", 0.1 * GRAVITY, -bodies.velocity[0].y));
        rows.push(basis.row(name("spin"), "rad/s", 0.0, bodies.spin[0].norm()));
    }
    Ok(rows)
}

/// Speed after the rebound of a ball made of two spheres at one place; it comes with 0.2 m/s.
fn twin() -> Result<f64, CheckError> {
    let sphere = Sphere {
        centre: Vector3::zeros(),
        radius: 1e-3,
    };
    let single = Clump::sphere(1e-3, 1000.0)?;
    let properties = MassProperties {
        mass: single.mass(),
        centre: Vector3::zeros(),
        inertia: Matrix3::from_diagonal(&single.inertia()),
    };
    let double = Clump::new(&[sphere, sphere], &properties)?;
    let start = thrown(0, Vector3::y() * 1.001e-3, Vector3::y() * -0.2);
    let mut world = world(
        settings(1e-7, Vector3::zeros(), 1e-3),
        &soft_surface([0.5, 0.2, 0.0])?,
        vec![Template::new(&double, 0, DashpotMass::Sphere)],
        vec![floor()],
        &[start],
    )?;
    collide(&mut world, 100_000)?;
    Ok(world.bodies().velocity[0].y)
}

/// Restitution of a body of n x n spheres in `layers` that falls flat on the floor.
fn flat_fall(n: usize, layers: usize, mass: DashpotMass) -> Result<f64, CheckError> {
    let (radius, spacing) = (0.5e-3, 1.2e-3);
    let at = |k: usize| (k as f64 - 0.5 * (n as f64 - 1.0)) * spacing;
    let mut spheres = Vec::new();
    for layer in 0..layers {
        let height = (layer as f64 - 0.5 * (layers as f64 - 1.0)) * spacing;
        for x in 0..n {
            for z in 0..n {
                spheres.push(Sphere {
                    centre: Vector3::new(at(x), height, at(z)),
                    radius,
                });
            }
        }
    }
    // The same mass for any number, and moments that keep the axes of the grid.
    let properties = MassProperties {
        mass: 1e-5,
        centre: Vector3::zeros(),
        inertia: Matrix3::from_diagonal(&Vector3::new(1.0e-11, 1.1e-11, 1.2e-11)),
    };
    let template = Template::new(&Clump::new(&spheres, &properties)?, 0, mass);
    let low = 0.5 * (layers as f64 - 1.0) * spacing + radius;
    let start = thrown(0, Vector3::y() * (low * 1.0001), Vector3::y() * -0.2);
    let mut world = world(
        settings(5e-7, Vector3::zeros(), 1e-3),
        &clipped(soft_surface([0.3, 0.0, 0.0])?),
        vec![template],
        vec![floor()],
        &[start],
    )?;
    collide(&mut world, 200_000)?;
    Ok(world.bodies().velocity[0].y / 0.2)
}

/// Restitution of one sphere of a flat body as a body of its own, by the reference.
fn alone(n: usize) -> Result<f64, CheckError> {
    let moduli = material::effective_moduli(&soft()?, &soft()?);
    let mass = 1e-5 / (n * n) as f64;
    let impact = Impact {
        radius: 0.5e-3,
        mass,
        tangential_mass: 2.0 / 7.0 * mass,
        young: moduli.young,
        shear: moduli.shear,
        restitution: 0.3,
        friction: 0.0,
        pulls: false,
        approach: 0.2,
        sliding: 0.0,
    };
    Ok(impact.integrate().separation / 0.2)
}

/// Rebound against the number of spheres that touch at once.
pub(crate) fn rebound() -> Result<Vec<Row>, CheckError> {
    let same = Basis {
        check: "rebound-sphere-count",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(2e-3),
        reason: "first order of some 2000 steps a contact",
        source: "n spheres of m/n on n springs are n separate impacts; [Berry2023] list the errors",
    };
    let trend = |tolerance| Basis {
        kind: Kind::Trend,
        tolerance,
        reason: "the side to which the choice errs",
        ..same
    };
    let name = "two spheres at one place, restitution 0.5: speed";
    let mut rows = vec![same.row(name, "m/s", 0.1, twin()?)];
    for n in [1, 2, 4] {
        let got = flat_fall(n, 1, DashpotMass::Sphere)?;
        let name = format!("dashpot_mass sphere, all {} spheres touch", n * n);
        rows.push(same.row(name, "1", alone(n)?, got));
    }
    for n in [2, 4] {
        let got = flat_fall(n, 1, DashpotMass::Body)?;
        let name = format!("dashpot_mass body, all {} spheres touch: too low", n * n);
        rows.push(trend(Tolerance::Below).row(name, "1", alone(n)?, got));
    }
    let got = flat_fall(2, 3, DashpotMass::Sphere)?;
    let name = "dashpot_mass sphere, 4 of 12 spheres touch: too high";
    rows.push(trend(Tolerance::Above).row(name, "1", alone(2)?, got));
    let together = Basis {
        source: "n springs with shares of one mass act as one; [Berry2023]",
        ..same
    };
    for (n, layers) in [(1, 1), (2, 1), (4, 1), (2, 3), (4, 2)] {
        let got = flat_fall(n, layers, DashpotMass::Shared)?;
        let name = format!(
            "dashpot_mass shared, {} of {} spheres touch",
            n * n,
            layers * n * n
        );
        rows.push(together.row(&name, "1", alone(n)?, got));
    }
    Ok(rows)
}
