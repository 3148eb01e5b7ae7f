//! Winding numbers of many points: far triangles are summed together.

use crate::winding::solid_angle_sum;
use geometry::triangle::area_vector;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Triangles of a leaf, which are summed one by one.
const LEAF: usize = 8;

/// Triangles are summed together for points farther away than this many of their radii: an error of 0.03 at most on a lens.
const FAR: f64 = 3.0;

/// Triangles that are summed together from afar.
#[derive(Debug, Clone)]
struct Cluster {
    /// Their middle, weighted by area, m.
    middle: Vector3<f64>,
    /// Largest distance of a corner from the middle, m.
    radius: f64,
    /// Sum of their area vectors, m².
    area: Vector3<f64>,
    /// First of its triangles.
    start: usize,
    /// Number of its triangles.
    count: usize,
    /// The second child; the first is the next cluster. None of a leaf.
    second: Option<usize>,
}

/// The triangles of a mesh as clusters of clusters.
///
/// # Source
///
/// `[Barill2018, section 4]`, its expansion up to the first order (dipoles).
#[derive(Debug, Clone)]
pub(crate) struct WindingTree {
    /// Clusters, the root first.
    clusters: Vec<Cluster>,
    /// Corners of the triangles in the order of the leaves, m.
    corners: Vec<[Vector3<f64>; 3]>,
}

impl WindingTree {
    /// Halves the triangles at the median of their longest extent, and again.
    pub(crate) fn new(corners: Vec<[Vector3<f64>; 3]>) -> Self {
        let mut tree = Self {
            clusters: Vec::new(),
            corners,
        };
        if !tree.corners.is_empty() {
            tree.split(0, tree.corners.len());
        }
        tree
    }

    /// Adds the cluster of some triangles, and those below it.
    fn split(&mut self, start: usize, count: usize) {
        let some = &mut self.corners[start..start + count];
        let place = self.clusters.len();
        self.clusters.push(cluster(some, start));
        if count <= LEAF {
            return;
        }
        let middle = |corners: &[Vector3<f64>; 3]| corners.iter().sum::<Vector3<f64>>();
        let (mut low, mut high) = (middle(&some[0]), middle(&some[0]));
        for corners in some.iter() {
            low = low.inf(&middle(corners));
            high = high.sup(&middle(corners));
        }
        let axis = (high - low).imax();
        let half = count / 2;
        some.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        self.split(start, half);
        self.clusters[place].second = Some(self.clusters.len());
        self.split(start + half, count - half);
    }

    /// Winding number of the mesh round a point.
    ///
    /// # Formula
    ///
    /// Near triangles as in [`crate::winding_number`]; far ones A·d / (4π |d|³) with their area vector A and the way d to their
    /// middle.
    pub(crate) fn winding_number(&self, point: &Vector3<f64>) -> f64 {
        let mut sum = 0.0;
        let mut waiting = vec![0];
        while let Some(place) = waiting.pop() {
            let Some(cluster) = self.clusters.get(place) else {
                continue;
            };
            let way = cluster.middle - point;
            let distance = way.norm();
            if distance > FAR * cluster.radius {
                sum += cluster.area.dot(&way) / distance.powi(3);
            } else if let Some(second) = cluster.second {
                waiting.extend([second, place + 1]);
            } else {
                let range = cluster.start..cluster.start + cluster.count;
                sum += solid_angle_sum(point, self.corners[range].iter().copied());
            }
        }
        sum / (4.0 * PI)
    }
}

/// What some triangles are from afar.
fn cluster(corners: &[[Vector3<f64>; 3]], start: usize) -> Cluster {
    let mut area = Vector3::zeros();
    let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
    for triangle in corners {
        let vector = area_vector(triangle);
        area += vector;
        sum += triangle.iter().sum::<Vector3<f64>>() / 3.0 * vector.norm();
        weight += vector.norm();
    }
    let middle = if weight > 0.0 {
        sum / weight
    } else {
        corners[0][0]
    };
    let far = corners
        .iter()
        .flatten()
        .map(|corner| (corner - middle).norm());
    Cluster {
        middle,
        radius: far.fold(0.0, f64::max),
        area,
        start,
        count: corners.len(),
        second: None,
    }
}

#[cfg(test)]
mod tests {
    use super::WindingTree;
    use crate::{shapes, winding_number};
    use nalgebra::Vector3;

    /// The sum by clusters is that over all triangles, within 0.03: in a lens and outside of it, near and far; the
    /// winding number of a closed body is 1 inside and 0 outside.
    #[test]
    fn far_triangles_may_be_summed_together() {
        let lens = shapes::ellipsoid([4e-3, 3e-3, 1e-3], 24).unwrap();
        let tree = WindingTree::new(
            (0..lens.triangles().len())
                .map(|t| lens.corners(t))
                .collect(),
        );
        let mut worst = 0.0_f64;
        for k in 0..400 {
            let at = |scale: f64, n: u32| scale * (f64::from(k * n % 401) / 200.5 - 1.0);
            let point = Vector3::new(at(6e-3, 7), at(5e-3, 11), at(2e-3, 17));
            let (exact, found) = (winding_number(&lens, &point), tree.winding_number(&point));
            worst = worst.max((exact - found).abs());
            assert!((exact - exact.round()).abs() < 1e-9);
        }
        assert!(worst < 0.03, "{worst}");
    }
}
