//! Small grains between large ones: do they stick where they must fall?
//!
//! Three large spheres that touch leave a hole that lets spheres of up to 0.1547 of their radius
//! through. With the velocity of the half step and the normal of the full step, some schemes hold a
//! small frictional grain in contacts that should let it slide `[Vyas2025]`. A grain of 1/7 of the
//! radius is dropped onto the hole from many places.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{DENSITY, GRAVITY, ball, clipped, settings, soft_surface, thrown, world};
use dem_solver::Load;
use nalgebra::Vector3;
use probability::random_stream::Stream;

/// Radius of the large spheres, m.
const LARGE: f64 = 5e-3;

/// Number of grains dropped.
const DROPS: usize = 12;

/// Number of grains of a radius (m) that pass the hole within a time (s).
fn passes(small: f64, friction: f64, limit: f64) -> Result<usize, CheckError> {
    let side = 2.0 / 3.0_f64.sqrt() * LARGE;
    let at = |k: f64| {
        let angle = std::f64::consts::TAU * k / 3.0;
        Vector3::new(angle.cos(), 0.0, angle.sin()) * side
    };
    let mut stream = Stream::new(11, "size ratio");
    let mut passed = 0;
    for _ in 0..DROPS {
        let aside = Vector3::new(stream.between(-1.0, 1.0), 0.0, stream.between(-1.0, 1.0));
        let start = aside * (0.4 * LARGE) + Vector3::y() * (1.2 * LARGE);
        let still = |k: f64| thrown(0, at(k), Vector3::zeros());
        let starts = [
            still(0.0),
            still(1.0),
            still(2.0),
            thrown(1, start, Vector3::zeros()),
        ];
        // The large spheres are too heavy to move, and feel no gravity here.
        let templates = vec![ball(LARGE, 1e15)?, ball(small, DENSITY)?];
        let mut world = world(
            settings(1e-5, Vector3::zeros(), small),
            &clipped(soft_surface([0.3, friction, 0.0])?),
            templates,
            Vec::new(),
            &starts,
        )?;
        let weight = Vector3::y() * (-GRAVITY * DENSITY * geometry::clump::volume_of_sphere(small));
        while world.time() < limit && world.bodies().position[3].y > -LARGE {
            world.step_with(|bodies| bodies.load[3] += Load::of_force(&weight))?;
        }
        passed += usize::from(world.bodies().position[3].y <= -LARGE);
    }
    Ok(passed)
}

/// Grains that pass, and grains that are too large.
pub(crate) fn three_spheres() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "size-ratio",
        kind: Kind::Trend,
        tolerance: Tolerance::Absolute(0.0),
        reason: "a count",
        source: "[Vyas2025]; a hole of 0.1547 R",
    };
    let rough = passes(LARGE / 7.0, 0.5, 1.0)?;
    let large = passes(LARGE / 6.0, 0.5, 0.3)?;
    Ok(vec![
        basis.row(
            "grains of R/7 with friction 0.5 that pass",
            "1",
            DROPS as f64,
            rough as f64,
        ),
        basis.row("grains of R/6 that pass", "1", 0.0, large as f64),
    ])
}
