//! Periodic sides of a scene, and what walls must be at them.

use crate::apparatus::{NamedMesh, PeriodicSides};
use crate::check::bad;
use crate::{Error, Scene};
use dem_solver::{Motion, World};
use nalgebra::Vector3;

/// Share of a normal along z up to which a triangle is parallel to z.
const PARALLEL: f64 = 1e-9;

/// The new world of a scene between periodic sides.
///
/// # Errors
///
/// Sides too near each other for the seeds; a wall of triangles that ends at a side or moves along z: nothing would hold the seeds that
/// come in at the other side.
pub(crate) fn between(
    world: World,
    sides: &PeriodicSides,
    scene: &Scene,
    meshes: &[NamedMesh],
) -> Result<World, Error> {
    let [low, high] = sides.z;
    let reach = world.reach_of_bodies();
    for mesh in meshes {
        check_extent(mesh, sides, reach)?;
    }
    for mesh in meshes {
        check_motion(&mesh.name, &mesh.motion)?;
    }
    let plan = scene.apparatus.device().plan(scene);
    for phase in plan.iter().flat_map(|plan| &plan.phases) {
        for (wall, motion) in &phase.motions {
            check_motion(wall, motion)?;
        }
    }
    let closed = world.with_periodic_sides(low, high);
    closed.map_err(|error| match error {
        dem_solver::Error::PeriodicSides { length, least } => bad(
            sides.setting,
            format!("{:.3} mm between periodic sides", 1e3 * length),
            &format!("at least {:.3} mm for these seeds", 1e3 * least),
        ),
        other => other.into(),
    })
}

/// Refuses a wall that ends at a side, or is not the same on both of its faces.
fn check_extent(mesh: &NamedMesh, sides: &PeriodicSides, reach: f64) -> Result<(), Error> {
    let [low, high] = sides.z;
    let extent = |corners: &mut dyn Iterator<Item = f64>| {
        corners.fold([f64::INFINITY, f64::NEG_INFINITY], |[first, last], z| {
            [first.min(z), last.max(z)]
        })
    };
    let [first, last] = extent(&mut mesh.triangles.iter().flatten().map(|corner| corner.z));
    let is_through = first <= low - reach && last >= high + reach;
    let is_between = first >= low + reach && last <= high - reach;
    let is_oblique_at_a_side = |triangle: &&[Vector3<f64>; 3]| {
        let [a, b, c] = **triangle;
        let normal = (b - a).cross(&(c - a));
        let [first, last] = extent(&mut triangle.iter().map(|corner| corner.z));
        let mut near = sides
            .z
            .iter()
            .filter(|z| first < *z + reach && last > *z - reach);
        normal.z.abs() > PARALLEL * normal.norm() && near.next().is_some()
    };
    let oblique = mesh.triangles.iter().find(is_oblique_at_a_side);
    let [low, high, reach] = [low, high, reach].map(|z| 1e3 * z);
    let (value, rule) = if let Some([corner, ..]) = oblique {
        let corner = corner * 1e3;
        let value = format!(
            "a triangle at ({:.3}, {:.3}, {:.3}) mm",
            corner.x, corner.y, corner.z
        );
        (value, "parallel to z there")
    } else if is_through || is_between {
        return Ok(());
    } else {
        let value = format!("z from {:.3} to {:.3} mm", 1e3 * first, 1e3 * last);
        (
            value,
            "beyond both by as much, or between them at that distance",
        )
    };
    Err(bad(
        &format!("wall '{}'", mesh.name),
        value,
        &format!(
            "{rule}: within {reach:.3} mm of a periodic side (z = {low:.3} and {high:.3} mm) seeds pass"
        ),
    ))
}

/// Refuses a motion after which a wall is elsewhere along z.
fn check_motion(wall: &str, motion: &Motion) -> Result<(), Error> {
    let swing = motion.vibration.map_or(0.0, |v| v.amplitude.z);
    let loaded = motion.load.map_or(0.0, |load| load.axis.z);
    let along = [
        motion.velocity.z,
        motion.spin.x,
        motion.spin.y,
        swing,
        loaded,
    ];
    if along.iter().all(|part| *part == 0.0) {
        return Ok(());
    }
    let requirement = "across z, and spins about z alone: seeds pass the periodic sides along z";
    Err(bad(
        &format!("motion of wall '{wall}'"),
        "along z".into(),
        requirement,
    ))
}
