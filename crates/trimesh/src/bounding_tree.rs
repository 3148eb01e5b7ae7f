//! A tree of boxes over triangles, for nearest-triangle queries.
//!
//! A long thin triangle that lies askew fills little of its box, and a fan of such triangles has
//! boxes that all overlap: a query would look at each of them. Such triangles are listed in
//! pieces, each with a box of its own, before the tree is built `[ErnstGreiner2007]`. What is
//! measured is always the whole triangle, so that the pieces decide the speed only.

use crate::{BoundingBox, TriMesh};
use geometry::triangle::area_vector;
use geometry::triangle::{ClosestPoint, closest_point};
use nalgebra::Vector3;

/// Pieces in a leaf.
const LEAF: usize = 4;

/// Area of half a box over that of the triangle in it beyond which the triangle is cut. It is 3.5 for
/// the cut through three corners of a cube, and grows as length over width of a thin triangle.
const WASTE: f64 = 16.0;

/// Halvings of one triangle at most.
const MOST_HALVINGS: u32 = 5;

/// Pieces of a mesh at most, or one a triangle if it has more triangles.
const MOST_PIECES: usize = 400_000;

/// A triangle or a piece of one, as the tree sees it.
#[derive(Debug, Clone)]
struct Piece {
    /// Triangle of the mesh.
    triangle: usize,
    /// Box round the piece, m.
    bounds: BoundingBox,
    /// Mean of its corners, m.
    middle: Vector3<f64>,
}

/// A box with either two children or a run of pieces.
#[derive(Debug, Clone)]
struct Node {
    /// Box round all pieces below, m.
    bounds: BoundingBox,
    /// First piece of a leaf, or the right child (the left one is the next node).
    start: usize,
    /// Pieces of a leaf; 0 for a branch.
    count: usize,
}

#[derive(Debug, Clone)]
pub(crate) struct BoundingTree {
    /// Nodes, the root first.
    nodes: Vec<Node>,
    /// Corners of the triangle of each piece in tree order, m.
    corners: Vec<[Vector3<f64>; 3]>,
    /// Triangle of the mesh of each piece, in tree order.
    triangles: Vec<usize>,
    /// Place in tree order of a piece of each triangle of the mesh.
    place_of: Vec<usize>,
}

/// Nearest triangle of a query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    /// Triangle of the mesh.
    pub(crate) triangle: usize,
    /// Nearest point on it.
    pub(crate) closest: ClosestPoint,
    /// Squared distance, m².
    pub(crate) distance_squared: f64,
}

impl BoundingTree {
    /// Builds the tree by halving at the median of the longest extent.
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let n = mesh.triangles().len();
        let mut pieces = Vec::with_capacity(n);
        // Each halving doubles the pieces of the triangles that are cut.
        let halvings = (MOST_PIECES / n.max(1)).checked_ilog2().unwrap_or(0);
        for triangle in 0..n {
            let corners = mesh.corners(triangle);
            cut(triangle, corners, halvings.min(MOST_HALVINGS), &mut pieces);
        }
        let mut tree = Self {
            nodes: Vec::with_capacity(pieces.len()),
            corners: Vec::new(),
            triangles: Vec::new(),
            place_of: vec![0; n],
        };
        tree.split(&mut pieces, 0);
        tree.triangles = pieces.iter().map(|piece| piece.triangle).collect();
        let corners = tree.triangles.iter().map(|&t| mesh.corners(t));
        tree.corners = corners.collect();
        for (place, &triangle) in tree.triangles.iter().enumerate() {
            tree.place_of[triangle] = place;
        }
        tree
    }

    /// Makes the node over a run of pieces, the first of which has place `start`, and all below
    /// it.
    fn split(&mut self, run: &mut [Piece], start: usize) {
        let ends = run.iter().flat_map(|p| [&p.bounds.low, &p.bounds.high]);
        let bounds = BoundingBox::of(ends);
        let node = self.nodes.len();
        let count = if run.len() <= LEAF { run.len() } else { 0 };
        self.nodes.push(Node {
            bounds,
            start,
            count,
        });
        if count == 0 {
            let axis = BoundingBox::of(run.iter().map(|p| &p.middle)).size().imax();
            let half = run.len() / 2;
            run.select_nth_unstable_by(half, |a, b| {
                let along = a.middle[axis].total_cmp(&b.middle[axis]);
                along.then(a.triangle.cmp(&b.triangle))
            });
            let (left, right) = run.split_at_mut(half);
            self.split(left, start);
            self.nodes[node].start = self.nodes.len();
            self.split(right, start + half);
        }
    }

    /// Nearest triangle to a point, starting from a guess (any triangle; a near one is faster).
    pub(crate) fn nearest(&self, point: &Vector3<f64>, guess: usize) -> Nearest {
        let mut best = self.measure(point, self.place_of[guess]);
        let mut stack = [(0_usize, 0.0_f64); 64];
        stack[0].1 = distance_squared(point, &self.nodes[0].bounds);
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (index, bound) = stack[height];
            if bound >= best.distance_squared {
                continue;
            }
            let node = &self.nodes[index];
            if node.count > 0 {
                for place in node.start..node.start + node.count {
                    if self.triangles[place] == best.triangle {
                        continue;
                    }
                    let found = self.measure(point, place);
                    if found.distance_squared < best.distance_squared {
                        best = found;
                    }
                }
                continue;
            }
            let child = |i: usize| (i, distance_squared(point, &self.nodes[i].bounds));
            let (left, right) = (child(index + 1), child(node.start));
            // The nearer child is taken first: it is pushed last.
            let (near, far) = if left.1 <= right.1 {
                (left, right)
            } else {
                (right, left)
            };
            // Halving keeps the height below log2(n) + 1, and each level leaves one entry.
            stack[height] = far;
            stack[height + 1] = near;
            height += 2;
        }
        best
    }

    /// Nearest point of one triangle.
    fn measure(&self, point: &Vector3<f64>, place: usize) -> Nearest {
        let closest = closest_point(point, &self.corners[place]);
        Nearest {
            triangle: self.triangles[place],
            closest,
            distance_squared: (point - closest.point).norm_squared(),
        }
    }
}

/// Lists a triangle, cut at the middle of its longest side as often as its box wastes much room, but
/// at most `halvings` times.
fn cut(triangle: usize, corners: [Vector3<f64>; 3], halvings: u32, pieces: &mut Vec<Piece>) {
    let bounds = BoundingBox::of(corners.iter());
    let [x, y, z]: [f64; 3] = bounds.size().into();
    let half_box = x * y + y * z + z * x;
    if halvings == 0 || half_box <= WASTE * area_vector(&corners).norm() {
        let middle = corners.iter().sum::<Vector3<f64>>() / 3.0;
        pieces.push(Piece {
            triangle,
            bounds,
            middle,
        });
        return;
    }
    let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm_squared();
    let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b)));
    let k = longest.unwrap_or(0);
    let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    // The rounding of the middle, 1e-16 of the coordinates, is far below that of a distance.
    let middle = (a + b) * 0.5;
    cut(triangle, [a, middle, c], halvings - 1, pieces);
    cut(triangle, [middle, b, c], halvings - 1, pieces);
}

/// Squared distance from a point to a box, 0 inside, m².
fn distance_squared(point: &Vector3<f64>, bounds: &BoundingBox) -> f64 {
    let mut sum = 0.0;
    for k in 0..3 {
        let outside = (bounds.low[k] - point[k])
            .max(point[k] - bounds.high[k])
            .max(0.0);
        sum += outside * outside;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{MOST_HALVINGS, Piece, cut};
    use nalgebra::Vector3;

    fn pieces(corners: [[f64; 3]; 3]) -> Vec<Piece> {
        let mut pieces = Vec::new();
        cut(0, corners.map(Vector3::from), MOST_HALVINGS, &mut pieces);
        pieces
    }

    /// A sliver askew is cut as often as allowed, and its pieces still reach from end to end; one
    /// along an axis fills its box and stays whole, as does a triangle that is not thin.
    #[test]
    fn only_slivers_askew_are_cut() {
        let sliver = pieces([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1e-4, 0.0]]);
        assert_eq!(sliver.len(), 1 << MOST_HALVINGS);
        let longest = sliver.iter().map(|p| p.bounds.size().norm());
        // Two halvings shorten both long sides: five leave pieces of at most a quarter of the length.
        assert!(longest.fold(0.0, f64::max) < 3.0_f64.sqrt() / 4.0 + 2e-4);
        let ends = [
            sliver
                .iter()
                .map(|p| p.bounds.low.min())
                .fold(1.0, f64::min),
            sliver
                .iter()
                .map(|p| p.bounds.high.max())
                .fold(0.0, f64::max),
        ];
        assert_eq!(ends, [0.0, 1.0]);
        let along = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1e-4, 0.0]];
        let corner = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!([along, corner].map(|c| pieces(c).len()), [1, 1]);
    }
}
