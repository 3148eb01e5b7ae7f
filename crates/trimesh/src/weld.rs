//! Joining the corners of separate triangles to shared vertices.

use nalgebra::Vector3;
use std::collections::HashMap;

/// Corners closer than this part of the mesh's diagonal are one vertex.
///
/// Single-precision coordinates repeat to about 6e-8 of their size, and printed ones to the
/// digits printed; a scan's shortest edges are about 1e-3 of the diagonal. 1e-6 lies between;
/// doubling it changes nothing for either.
const RELATIVE_TOLERANCE: f64 = 1e-6;

/// Vertices and the triangles that use them.
pub(crate) struct Welded {
    /// Vertices, m.
    pub(crate) vertices: Vec<Vector3<f64>>,
    /// Indices of the corners.
    pub(crate) triangles: Vec<[usize; 3]>,
}

/// Joins corners that lie within the tolerance of each other; the first one met stays.
///
/// Corners are sorted into cubes much larger than the tolerance, so nearly always one cube has
/// to be searched; only a corner near a cube's face looks next door.
pub(crate) fn weld(soup: &[[Vector3<f64>; 3]]) -> Welded {
    let tolerance = tolerance_of(soup);
    let cube = 64.0 * tolerance;
    let mut cubes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut vertices: Vec<Vector3<f64>> = Vec::new();
    let mut index_of = |corner: &Vector3<f64>| {
        let low = cube_of(&corner.add_scalar(-tolerance), cube);
        let high = cube_of(&corner.add_scalar(tolerance), cube);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cubes.get(&[x, y, z]).into_iter().flatten();
                    let mut same = near.filter(|&&i| (vertices[i] - corner).norm() <= tolerance);
                    if let Some(&found) = same.next() {
                        return found;
                    }
                }
            }
        }
        vertices.push(*corner);
        cubes
            .entry(cube_of(corner, cube))
            .or_default()
            .push(vertices.len() - 1);
        vertices.len() - 1
    };
    let triangles = soup
        .iter()
        .map(|corners| [0, 1, 2].map(|k| index_of(&corners[k])))
        .collect();
    Welded {
        vertices,
        triangles,
    }
}

/// Joining distance, m: relative to the diagonal, but not below single-precision rounding.
fn tolerance_of(soup: &[[Vector3<f64>; 3]]) -> f64 {
    let corners = || soup.iter().flatten();
    let low = corners().fold(Vector3::repeat(f64::INFINITY), |m, c| m.inf(c));
    let high = corners().fold(Vector3::repeat(f64::NEG_INFINITY), |m, c| m.sup(c));
    let rounding = 2.0 * f64::from(f32::EPSILON) * low.amax().max(high.amax());
    (RELATIVE_TOLERANCE * (high - low).norm())
        .max(rounding)
        .max(f64::MIN_POSITIVE)
}

/// Cube that holds a point. The tolerance bounds the quotient to about 1e8: no overflow.
fn cube_of(point: &Vector3<f64>, cube: f64) -> [i64; 3] {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a float cast saturates, and the quotient is below 1e8"
    )]
    [0, 1, 2].map(|k| (point[k] / cube).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::weld;
    use nalgebra::Vector3;

    fn square(z_of_second: f64) -> Vec<[Vector3<f64>; 3]> {
        let p = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        vec![
            [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0)],
            [
                p(-0.0, 0.0, z_of_second),
                p(1.0, 1.0, -0.0),
                p(0.0, 1.0, 0.0),
            ],
        ]
    }

    #[test]
    fn plus_and_minus_zero_are_one_vertex() {
        assert_eq!(weld(&square(-0.0)).vertices.len(), 4);
    }

    /// The tolerance is 1e-6 of the diagonal 1.414: 1.3e-6 joins and 1.5e-6 does not.
    #[test]
    fn corners_join_within_a_millionth_of_the_diagonal() {
        assert_eq!(weld(&square(1.3e-6)).vertices.len(), 4);
        assert_eq!(weld(&square(1.5e-6)).vertices.len(), 5);
    }
}
