//! Which triangles of a wall are near a point: a tree of boxes, so that a search looks at those nearby alone.

use nalgebra::Vector3;

/// Most triangles in a box that is not divided further.
const LEAF: usize = 4;

/// By how much more than the distance a box may be away, relative: rounding must not hide a triangle at the distance.
const SLACK: f64 = 1.0 + 1e-9;

/// Boxes about triangles, each divided at the median along its longest edge.
#[derive(Debug, Clone, Default)]
pub(crate) struct TriangleTree {
    /// Parents before their children.
    nodes: Vec<Node>,
    /// Numbers of the triangles, those of a box in one run.
    order: Vec<u32>,
}

/// A box about some triangles.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Lower corner, m.
    low: Vector3<f64>,
    /// Upper corner, m.
    high: Vector3<f64>,
    /// First of its triangles in the order.
    first: usize,
    /// Number of its triangles.
    count: usize,
    /// Number of the second child; the first follows its parent. `None` of a box that is not divided.
    second: Option<usize>,
}

impl Node {
    /// Square of the distance of a point, m².
    fn square_distance(&self, point: &Vector3<f64>) -> f64 {
        let outside = (self.low - point).sup(&(point - self.high));
        outside.map(|d| d.max(0.0)).norm_squared()
    }
}

impl TriangleTree {
    /// The tree of triangles, corners in m.
    pub(crate) fn of(triangles: &[[Vector3<f64>; 3]]) -> Self {
        let count = u32::try_from(triangles.len()).unwrap_or(u32::MAX);
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..count).collect(),
        };
        tree.divide(triangles, 0, triangles.len());
        tree
    }

    /// Adds the box of a run of the order, and those within it.
    fn divide(&mut self, triangles: &[[Vector3<f64>; 3]], first: usize, count: usize) {
        let run = &mut self.order[first..first + count];
        let corners = run.iter().flat_map(|t| triangles[*t as usize]);
        let (mut low, mut high) = (
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(f64::NEG_INFINITY),
        );
        for corner in corners {
            (low, high) = (low.inf(&corner), high.sup(&corner));
        }
        let number = self.nodes.len();
        self.nodes.push(Node {
            low,
            high,
            first,
            count,
            second: None,
        });
        if count <= LEAF {
            return;
        }
        let axis = (high - low).imax();
        let middle = |t: u32| triangles[t as usize].iter().map(|c| c[axis]).sum::<f64>();
        let half = count / 2;
        run.select_nth_unstable_by(half, |a, b| {
            middle(*a).total_cmp(&middle(*b)).then(a.cmp(b))
        });
        self.divide(triangles, first, half);
        self.nodes[number].second = Some(self.nodes.len());
        self.divide(triangles, first + half, count - half);
    }

    /// Calls a function with each triangle of the boxes within a distance (m) of a point: all triangles within the distance, and some
    /// others.
    pub(crate) fn visit(&self, point: &Vector3<f64>, distance: f64, mut visit: impl FnMut(u32)) {
        let most = distance * distance * SLACK;
        let mut waiting = Vec::with_capacity(32);
        let mut next = (!self.nodes.is_empty()).then_some(0);
        while let Some(number) = next.or_else(|| waiting.pop()) {
            next = None;
            let node = &self.nodes[number];
            if node.square_distance(point) > most {
                continue;
            }
            match node.second {
                None => self.order[node.first..node.first + node.count]
                    .iter()
                    .for_each(|t| visit(*t)),
                Some(second) => {
                    waiting.push(second);
                    next = Some(number + 1);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::TriangleTree;
    use geometry::triangle::nearest_on_triangle;
    use nalgebra::Vector3;

    /// Triangles of all sizes about points on a spiral: whatever the point and the distance, no triangle within the distance is left out,
    /// and far fewer than all are visited.
    #[test]
    fn no_triangle_nearby_is_left_out() {
        let place = |k: u32| {
            let t = f64::from(k) * 0.37;
            Vector3::new(t.cos(), t.sin(), 0.05 * t) * (1.0 + 0.1 * (3.1 * t).sin())
        };
        let triangles: Vec<_> = (0..1000)
            .map(|k| {
                let size = if k % 97 == 0 { 1.0 } else { 0.05 };
                let edge = |l: u32| place(7 * k + l) * size;
                [place(k), place(k) + edge(1), place(k) + edge(2)]
            })
            .collect();
        let tree = TriangleTree::of(&triangles);
        let mut visited = 0;
        for k in 0..200 {
            let point = place(11 * k) * 1.1;
            let distance = 0.02 + 0.002 * f64::from(k % 50);
            let mut found = Vec::new();
            tree.visit(&point, distance, |t| found.push(t));
            visited += found.len();
            found.sort_unstable();
            for (number, corners) in (0_u32..).zip(&triangles) {
                let is_near = (nearest_on_triangle(&point, corners) - point).norm() < distance;
                assert!(!is_near || found.binary_search(&number).is_ok(), "{number}");
            }
        }
        assert!(visited < 200 * 1000 / 5, "{visited} visits");
        assert!(TriangleTree::of(&[]).nodes.len() <= 1);
    }
}
