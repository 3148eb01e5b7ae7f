//! What a run must keep to.

use crate::{Apparatus, Scene, SeedBody};
use dem_solver::HealthLimits;
use nalgebra::Vector3;
use std::sync::Arc;

/// Largest overlap over the radius of the smaller sphere. The laws hold for small overlaps; a hard
/// contact of the study's seeds reaches about a tenth.
const OVERLAP: f64 = 0.5;

/// Limits for a scene: the seeds stay in the apparatus, and none is faster than a fall across it and
/// the walls together would make it, five times over.
pub(crate) fn limits(scene: &Scene, bodies: &[Arc<SeedBody>]) -> HealthLimits {
    let [low, high] = scene.apparatus.room();
    let (size, gravity) = ((high - low).norm(), scene.model.gravity_m_s2);
    let wall = scene.apparatus.speed().abs() * scene.apparatus.radius();
    let meshes = scene.wall.iter().map(|w| w.fastest(size));
    let fall = (2.0 * gravity * size).sqrt();
    let length = bodies
        .iter()
        .map(|b| b.clump.bounding_radius())
        .fold(0.0, f64::max);
    // On an open floor seeds may roll away; a drum or a device must hold them.
    let open = match scene.apparatus {
        Apparatus::Heap(_) | Apparatus::BoxCollapse(_) => 100.0 * size,
        _ => length,
    };
    HealthLimits {
        low: low - Vector3::repeat(open),
        high: high + Vector3::repeat(open),
        speed: 5.0 * (fall + wall + meshes.fold(0.0, f64::max)),
        overlap: OVERLAP,
    }
}
