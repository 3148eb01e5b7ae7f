//! The point of a triangle that is nearest to a given point.

use nalgebra::Vector3;

/// Part of a triangle on which the nearest point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Within the face.
    Face,
    /// On the side from corner k to corner k + 1.
    Side(usize),
    /// At corner k.
    Corner(usize),
}

/// A nearest point and where it lies.
#[derive(Debug, Clone, Copy)]
pub struct ClosestPoint {
    /// The point, m.
    pub point: Vector3<f64>,
    /// Part of the triangle.
    pub feature: Feature,
}

/// The point of a triangle that is nearest to a given point, and where on the triangle it lies, by the Voronoi regions of corners,
/// sides and face.
///
/// # Source
///
/// `[Ericson2005, section 5.1.5]`.
#[inline]
pub fn closest_point(point: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> ClosestPoint {
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
#[inline]
pub fn nearest_on_triangle(point: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> Vector3<f64> {
    closest_point(point, corners).point
}

#[cfg(test)]
mod tests {
    use super::{Feature, closest_point};
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    /// A point q of a convex body is nearest to p exactly if no corner v lies nearer along the way to p: (p - q)·(v - q) <= 0. Held for
    /// 3000 random triangles and points to rounding, q within the triangle (its barycentric coordinates are not
    /// negative), on the part that is named. All seven parts come up.
    #[test]
    fn the_point_is_nearest_and_lies_where_it_is_said_to() {
        let mut stream = Stream::new(1, "triangles");
        let mut met = [0; 7];
        for _ in 0..3000 {
            let mut random = || Vector3::from_fn(|_, _| stream.between(-1.0, 1.0));
            let (corners, point) = ([random(), random(), random()], random() * 1.5);
            let found = closest_point(&point, &corners);
            let away = point - found.point;
            for corner in corners {
                assert!(away.dot(&(corner - found.point)) < 1e-12, "{found:?}");
            }
            let parts = barycentric(&found.point, &corners);
            assert!(parts.iter().all(|part| *part > -1e-9), "{parts:?}");
            let zeros = parts.map(|part| part.abs() < 1e-9);
            let (expected, number) = match found.feature {
                Feature::Face => ([false; 3], 0),
                Feature::Side(k) => ([0, 1, 2].map(|i| i == (k + 2) % 3), 1 + k),
                Feature::Corner(k) => ([0, 1, 2].map(|i| i != k), 4 + k),
            };
            assert_eq!(zeros, expected, "{found:?}");
            met[number] += 1;
        }
        assert!(met.iter().all(|n| *n > 50), "{met:?}");
    }

    /// Barycentric coordinates of a point in the plane of a triangle, by areas.
    fn barycentric(point: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> [f64; 3] {
        let normal = (b - a).cross(&(c - a));
        let part = |from: &Vector3<f64>, to: &Vector3<f64>| {
            (to - from).cross(&(point - from)).dot(&normal) / normal.norm_squared()
        };
        [part(b, c), part(c, a), part(a, b)]
    }
}
