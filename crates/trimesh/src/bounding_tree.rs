//! A tree of boxes over triangles, for nearest-triangle queries.

use crate::closest_point::{ClosestPoint, closest_point};
use crate::{BoundingBox, TriMesh};
use nalgebra::Vector3;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// A box with either two children or a run of triangles.
#[derive(Debug, Clone)]
struct Node {
    /// Box round all triangles below, m.
    bounds: BoundingBox,
    /// First triangle of a leaf, or the right child (the left one is the next node).
    start: usize,
    /// Triangles of a leaf; 0 for a branch.
    count: usize,
}

/// The tree.
#[derive(Debug, Clone)]
pub(crate) struct BoundingTree {
    /// Nodes, the root first.
    nodes: Vec<Node>,
    /// Corners of the triangles in tree order, m.
    corners: Vec<[Vector3<f64>; 3]>,
    /// Triangle index in the mesh, in tree order.
    triangles: Vec<usize>,
    /// Place in tree order of each triangle of the mesh.
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
        let middles: Vec<_> = (0..n)
            .map(|t| mesh.corners(t).iter().sum::<Vector3<f64>>() / 3.0)
            .collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(n),
            corners: Vec::new(),
            triangles: (0..n).collect(),
            place_of: vec![0; n],
        };
        tree.split(mesh, &middles, 0, n);
        tree.corners = tree.triangles.iter().map(|&t| mesh.corners(t)).collect();
        for (place, &triangle) in tree.triangles.iter().enumerate() {
            tree.place_of[triangle] = place;
        }
        tree
    }

    /// Makes the node over `triangles[start..end]` and all below it.
    fn split(&mut self, mesh: &TriMesh, middles: &[Vector3<f64>], start: usize, end: usize) {
        let run = &mut self.triangles[start..end];
        let vertices = run.iter().flat_map(|&t| mesh.triangles()[t]);
        let bounds = BoundingBox::of(vertices.map(|vertex| &mesh.vertices()[vertex]));
        let node = self.nodes.len();
        let count = if run.len() <= LEAF { run.len() } else { 0 };
        if count == 0 {
            let axis = BoundingBox::of(run.iter().map(|&t| &middles[t]))
                .size()
                .imax();
            let half = run.len() / 2;
            run.select_nth_unstable_by(half, |&s, &t| {
                middles[s][axis]
                    .total_cmp(&middles[t][axis])
                    .then(s.cmp(&t))
            });
            self.nodes.push(Node {
                bounds,
                start,
                count,
            });
            self.split(mesh, middles, start, start + half);
            self.nodes[node].start = self.nodes.len();
            self.split(mesh, middles, start + half, end);
        } else {
            self.nodes.push(Node {
                bounds,
                start,
                count,
            });
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
