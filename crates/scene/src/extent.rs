//! How far spheres reach.

use geometry::clump::Sphere;

/// Ends of spheres along an axis, m.
pub(crate) fn extent(spheres: &[Sphere], axis: usize) -> [f64; 2] {
    let low = spheres.iter().map(|s| s.centre[axis] - s.radius);
    let high = spheres.iter().map(|s| s.centre[axis] + s.radius);
    [
        low.fold(f64::INFINITY, f64::min),
        high.fold(f64::NEG_INFINITY, f64::max),
    ]
}
