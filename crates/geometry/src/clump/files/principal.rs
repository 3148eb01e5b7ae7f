//! A body moved to its centroid and turned to its principal axes.

use super::Body;
use crate::clump::{Clump, MassProperties, Sphere};
use nalgebra::Vector3;

/// Spheres in the principal frame, and the principal moments at unit density in rising order.
///
/// A body with an impossible inertia is only moved, and keeps the diagonal of its inertia.
pub(crate) fn in_principal_frame(body: &Body<'_>) -> (Vec<Sphere>, Vector3<f64>) {
    let properties = MassProperties {
        mass: body.volume,
        centre: body.centroid,
        inertia: body.inertia,
    };
    if let Ok(clump) = Clump::new(body.spheres, &properties) {
        return (clump.spheres().to_vec(), clump.inertia());
    }
    let moved = |sphere: &Sphere| Sphere {
        centre: sphere.centre - body.centroid,
        ..*sphere
    };
    (
        body.spheres.iter().map(moved).collect(),
        body.inertia.diagonal(),
    )
}
