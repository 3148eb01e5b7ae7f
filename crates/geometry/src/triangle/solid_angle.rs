//! The solid angle of a triangle.

use nalgebra::Vector3;

/// Solid angle of a triangle seen from a point, sr; positive where its normal points away from the point.
///
/// # Formula
///
/// tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b) with the corners a, b, c seen from the point
/// `[Oosterom1983, eq. 8]`.
#[inline]
pub fn solid_angle(point: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let above = a.dot(&b.cross(&c));
    let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
    2.0 * above.atan2(below)
}

#[cfg(test)]
mod tests {
    use super::solid_angle;
    use nalgebra::Vector3;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The triangle between the unit vectors covers an eighth of the sphere about the origin, and the same with the other sign where
    /// its corners run the other way round; the four faces of a tetrahedron cover the whole sphere about a point within,
    /// and nothing about one outside. Rounding alone is allowed.
    #[test]
    fn an_octant_and_a_closed_surface() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let at = |corners| solid_angle(&Vector3::zeros(), &corners);
        assert!((at([x, y, z]) - FRAC_PI_2).abs() < 1e-15);
        assert!((at([x, z, y]) + FRAC_PI_2).abs() < 1e-15);
        let o = Vector3::zeros();
        let faces = [[o, y, x], [o, z, y], [o, x, z], [x, y, z]];
        let around = |point: Vector3<f64>| -> f64 {
            faces.iter().map(|face| solid_angle(&point, face)).sum()
        };
        assert!((around(Vector3::new(0.2, 0.1, 0.3)) - 4.0 * PI).abs() < 1e-14);
        assert!(around(Vector3::new(0.6, 0.5, 0.4)).abs() < 1e-14);
    }
}
