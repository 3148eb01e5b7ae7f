//! How often a surface goes round a point: the plain inside test.

use crate::TriMesh;
use geometry::triangle::solid_angle;
use nalgebra::Vector3;

/// Winding number of the mesh round a point: 1 inside a closed body, 0 outside.
///
/// The exact sum over all triangles; slow, and right also for meshes that touch themselves.
///
/// # Formula
///
/// w = (1/4π) Σ Ω with the solid angles Ω of [`geometry::triangle::solid_angle`].
pub fn winding_number(mesh: &TriMesh, point: &Vector3<f64>) -> f64 {
    let corners = (0..mesh.triangles().len()).map(|t| mesh.corners(t));
    solid_angle_sum(point, corners) / (4.0 * std::f64::consts::PI)
}

/// Sum of the signed solid angles of triangles seen from a point, sr.
pub(crate) fn solid_angle_sum(
    point: &Vector3<f64>,
    triangles: impl Iterator<Item = [Vector3<f64>; 3]>,
) -> f64 {
    triangles.map(|t| solid_angle(point, &t)).sum()
}
