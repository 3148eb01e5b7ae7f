//! The point of a triangle that is nearest to a given point.

use nalgebra::Vector3;

/// Part of a triangle on which the nearest point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
    /// Within the face.
    Face,
    /// On the side from corner k to corner k + 1.
    Side(usize),
    /// At corner k.
    Corner(usize),
}

/// A nearest point and where it lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClosestPoint {
    /// The point, m.
    pub(crate) point: Vector3<f64>,
    /// Part of the triangle.
    pub(crate) feature: Feature,
}

/// Finds the nearest point by the Voronoi regions of corners, sides and face.
///
/// # Source
///
/// `[Ericson2005, section 5.1.5]`.
#[inline]
pub(crate) fn closest_point(point: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> ClosestPoint {
    let at = |point: Vector3<f64>, feature| ClosestPoint { point, feature };
    let (ab, ac) = (b - a, c - a);
    let from_a = point - a;
    let (d1, d2) = (ab.dot(&from_a), ac.dot(&from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(*a, Feature::Corner(0));
    }
    let from_b = point - b;
    let (d3, d4) = (ab.dot(&from_b), ac.dot(&from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return at(*b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return at(a + ab * (d1 / (d1 - d3)), Feature::Side(0));
    }
    let from_c = point - c;
    let (d5, d6) = (ab.dot(&from_c), ac.dot(&from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return at(*c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return at(a + ac * (d2 / (d2 - d6)), Feature::Side(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return at(b + (c - b) * share, Feature::Side(1));
    }
    let total = va + vb + vc;
    if total <= 0.0 {
        // A triangle without area: rounding led past its sides.
        return at(*a, Feature::Corner(0));
    }
    at(a + ab * (vb / total) + ac * (vc / total), Feature::Face)
}

/// The point of a triangle that is nearest to a given point, m `[Ericson2005, section 5.1.5]`.
pub fn nearest_on_triangle(point: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> Vector3<f64> {
    closest_point(point, corners).point
}
