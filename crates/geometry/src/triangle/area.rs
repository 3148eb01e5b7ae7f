//! The area of a triangle.

use nalgebra::Vector3;

/// Normal of a triangle by the right-hand rule with its area as length, m².
#[inline]
pub fn area_vector(corners: &[Vector3<f64>; 3]) -> Vector3<f64> {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0])) * 0.5
}
