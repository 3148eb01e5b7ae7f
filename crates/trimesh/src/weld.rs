//! Joining the corners of separate triangles to shared vertices.

use nalgebra::Vector3;
use rustc_hash::{FxHashMap, FxHasher};
use std::hash::{Hash as _, Hasher as _};

/// Mark of a vertex that is the last of its cube.
const LAST: u32 = u32::MAX;

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
    let mut cubes = Cubes {
        tolerance,
        side: 64.0 * tolerance,
        first: FxHashMap::default(),
        next: Vec::new(),
        vertices: Vec::new(),
    };
    let mut triangles = Vec::with_capacity(soup.len());
    for corners in soup {
        triangles.push([0, 1, 2].map(|k| cubes.index_of(&corners[k])));
    }
    Welded {
        vertices: cubes.vertices,
        triangles,
    }
}

/// Vertices by the cube that holds them.
struct Cubes {
    /// Joining distance, m.
    tolerance: f64,
    /// Side of a cube, m.
    side: f64,
    /// Newest vertex of a cube, by the hash of the cube: two cubes of one hash share a list,
    /// which costs a comparison and changes nothing.
    first: FxHashMap<u64, u32>,
    /// The vertex listed before each vertex in the same list.
    next: Vec<u32>,
    /// The vertices, m.
    vertices: Vec<Vector3<f64>>,
}

impl Cubes {
    /// Vertex that a corner is, a new one if no other is near.
    fn index_of(&mut self, corner: &Vector3<f64>) -> usize {
        let own = cube_of(corner, self.side);
        let low = cube_of(&corner.add_scalar(-self.tolerance), self.side);
        let high = cube_of(&corner.add_scalar(self.tolerance), self.side);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    if let Some(found) = self.find(hash_of([x, y, z]), corner) {
                        return found;
                    }
                }
            }
        }
        let index = self.vertices.len();
        // The number of triangles is limited before, so that every index has 32 bits.
        let name = u32::try_from(index).unwrap_or(LAST);
        let older = self.first.insert(hash_of(own), name);
        self.next.push(older.unwrap_or(LAST));
        self.vertices.push(*corner);
        index
    }

    /// The vertex of a list that lies within the tolerance.
    fn find(&self, list: u64, corner: &Vector3<f64>) -> Option<usize> {
        let mut name = *self.first.get(&list)?;
        while name != LAST {
            let index = name as usize;
            if (self.vertices[index] - corner).norm_squared() <= self.tolerance.powi(2) {
                return Some(index);
            }
            name = self.next[index];
        }
        None
    }
}

/// Hash of a cube.
fn hash_of(cube: [i64; 3]) -> u64 {
    let mut hasher = FxHasher::default();
    cube.hash(&mut hasher);
    hasher.finish()
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
