//! How often a surface goes round a point: the plain inside test.

use crate::TriMesh;
use nalgebra::Vector3;

/// Winding number of the mesh round a point: 1 inside a closed body, 0 outside.
///
/// The exact sum over all triangles; slow, and right also for meshes that touch themselves.
///
/// # Formula
///
/// w = (1/4π) Σ Ω, tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b) with the corners a, b,
/// c seen from the point `[Oosterom1983, eq. 8]`.
pub fn winding_number(mesh: &TriMesh, point: &Vector3<f64>) -> f64 {
    let corners = (0..mesh.triangles().len()).map(|t| mesh.corners(t));
    solid_angle_sum(point, corners) / (4.0 * std::f64::consts::PI)
}

/// Sum of the signed solid angles of triangles seen from a point, sr.
pub(crate) fn solid_angle_sum(
    point: &Vector3<f64>,
    triangles: impl Iterator<Item = [Vector3<f64>; 3]>,
) -> f64 {
    triangles
        .map(|corners| {
            let [a, b, c] = corners.map(|corner| corner - point);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let above = a.dot(&b.cross(&c));
            let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * above.atan2(below)
        })
        .sum()
}
