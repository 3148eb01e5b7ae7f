//! Joining the corners of separate triangles to shared vertices.

use crate::BoundingBox;
use nalgebra::Vector3;
use rustc_hash::{FxHashMap, FxHasher};
use std::hash::{Hash as _, Hasher as _};

/// Mark of a vertex that is the last of its cube.
const LAST: u32 = u32::MAX;

/// Corners closer than this part of the mesh's diagonal are one vertex.
///
/// The corners of one vertex are mostly equal to the last bit, wherever the mesh lies: each is
/// the same point, rounded alike. Programs that compute them again differ by about 6e-8 of the
/// size; a scan's shortest edges are about 1e-3 of the diagonal. 1e-6 lies between; doubling it
/// changes nothing for either.
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
    let bounds = BoundingBox::of(soup.iter().flatten());
    let tolerance = (RELATIVE_TOLERANCE * bounds.size().norm()).max(f64::MIN_POSITIVE);
    let mut cubes = Cubes::new(bounds.low, tolerance);
    let mut triangles = Vec::with_capacity(soup.len());
    for corners in soup {
        triangles.push([0, 1, 2].map(|k| cubes.index_of(&corners[k])));
    }
    Welded {
        vertices: cubes.vertices,
        triangles,
    }
}

/// Joins some of the vertices that lie within a distance (m) of each other; the first one stays.
///
/// Gives the name of each vertex after that, in the old numbers.
pub(crate) fn joined(
    vertices: &[Vector3<f64>],
    some: impl Iterator<Item = usize>,
    distance: f64,
) -> Vec<usize> {
    let bounds = BoundingBox::of(vertices.iter());
    let mut cubes = Cubes::new(bounds.low, distance);
    let mut names: Vec<usize> = (0..vertices.len()).collect();
    let mut first_met = Vec::new();
    for vertex in some {
        let index = cubes.index_of(&vertices[vertex]);
        if index == first_met.len() {
            first_met.push(vertex);
        }
        names[vertex] = first_met[index];
    }
    names
}

/// Vertices by the cube that holds them.
struct Cubes {
    /// Where the cubes begin, m: near the vertices, so that no cube has a large number.
    origin: Vector3<f64>,
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
    /// No vertices yet.
    fn new(origin: Vector3<f64>, tolerance: f64) -> Self {
        Self {
            origin,
            tolerance,
            side: 64.0 * tolerance,
            first: FxHashMap::default(),
            next: Vec::new(),
            vertices: Vec::new(),
        }
    }

    /// Vertex that a corner is, a new one if no other is near.
    fn index_of(&mut self, corner: &Vector3<f64>) -> usize {
        let place = corner - self.origin;
        let own = cube_of(&place, self.side);
        let low = cube_of(&place.add_scalar(-self.tolerance), self.side);
        let high = cube_of(&place.add_scalar(self.tolerance), self.side);
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

fn hash_of(cube: [i64; 3]) -> u64 {
    let mut hasher = FxHasher::default();
    cube.hash(&mut hasher);
    hasher.finish()
}

/// Cube that holds a point. A quotient is below 1e6 unless the mesh has no extent.
fn cube_of(point: &Vector3<f64>, cube: f64) -> [i64; 3] {
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    [0, 1, 2].map(|k| (point[k] / cube).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::{joined, weld};
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

    /// Far from the origin the same corners join, and no others: coordinates of single precision
    /// are there 2⁻⁴ apart, ten thousand times the tolerance, and equal to the last bit.
    #[test]
    fn corners_join_by_the_size_of_the_mesh_wherever_it_lies() {
        for (z, vertices) in [(0.0, 4), (0.0625, 5)] {
            let far = square(z)
                .iter()
                .map(|t| t.map(|c| c.add_scalar(1e6)))
                .collect::<Vec<_>>();
            assert_eq!(weld(&far).vertices.len(), vertices);
        }
    }

    /// Of four points in a row the ends are not asked for; the middle ones lie 0.1 apart.
    #[test]
    fn only_the_vertices_asked_for_join() {
        let row = [0.0, 0.05, 0.15, 0.2].map(|x| Vector3::new(x, 0.0, 0.0));
        assert_eq!(joined(&row, [1, 2].into_iter(), 0.11), [0, 1, 1, 3]);
        assert_eq!(joined(&row, [1, 2].into_iter(), 0.09), [0, 1, 2, 3]);
    }
}
