//! The signed distance of a body on a grid, for fast repeated queries.

use nalgebra::Vector3;
use trimesh::{BoundingBox, SignedDistance};

/// Spacing of the fine nodes, radii.
///
/// The trilinear error near a wall of curvature κ is about κ h²/4: 0.3 % of the radius for the
/// tip of a seed; doubling the spacing makes it 1.2 %, which the final exact relaxation would
/// no longer repair reliably.
const SPACING: f64 = 0.25;

/// Nodes that a grid may have; beyond, it is made coarser (memory: 8 bytes a node).
const MOST_NODES: f64 = 2e7;

/// Least number of cells along the shortest extent of the body.
const FEWEST_CELLS: f64 = 24.0;

/// Nodes beyond which a thin body gets no finer ones than others.
const MOST_NODES_FOR_THIN: f64 = 1e6;

/// Distances (radii) between which the fine nodes must be exact: that of touching spheres.
const BAND: [f64; 2] = [-1.3, -0.7];

/// Signed distance to a body's surface, trilinear between the nodes of a cubic grid.
///
/// Lengths are in units of the sphere radius.
#[derive(Debug, Clone)]
pub(crate) struct DistanceGrid {
    /// Nodes at `SPACING`: exact in the band, interpolated from the coarse ones elsewhere.
    fine: Nodes,
    /// Nodes at twice that spacing, all exact.
    coarse: Nodes,
}

/// Distance and its gradient.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Distance {
    /// Signed distance, negative inside, radii.
    pub(crate) value: f64,
    /// Gradient of the interpolated distance.
    pub(crate) gradient: Vector3<f64>,
}

/// Values on a cubic grid.
#[derive(Debug, Clone)]
struct Nodes {
    /// Position of the first node, radii.
    low: Vector3<f64>,
    /// Spacing, radii.
    spacing: f64,
    /// Number of nodes along each axis.
    size: [usize; 3],
    /// Values at the nodes, radii; z fastest.
    values: Vec<f64>,
}

impl DistanceGrid {
    /// Samples the exact distance (in m, divided by `radius`).
    pub(crate) fn new(exact: &SignedDistance, bounds: &BoundingBox, radius: f64) -> Self {
        let extent = bounds.size() / radius;
        let coarsest = (extent.product() / MOST_NODES).cbrt();
        let fine_enough = (extent.product() / MOST_NODES_FOR_THIN).cbrt();
        let spacing = SPACING
            .min((extent.min() / FEWEST_CELLS).max(fine_enough))
            .max(coarsest);
        let low = bounds.low / radius;
        let high = bounds.high / radius;
        let mut guess = 0;
        let mut measure = |node: &Vector3<f64>| {
            let found = exact.nearest_from(&(node * radius), guess);
            guess = found.triangle;
            found.distance / radius
        };
        let coarse = Nodes::new(&low, &high, 2.0 * spacing, &mut measure);
        // A distance changes by at most the way gone, so the interpolated value is off by at
        // most half the diagonal of a coarse cell.
        let margin = 3.0_f64.sqrt() * spacing;
        let fine = Nodes::new(&low, &high, spacing, |node| {
            let rough = coarse.at(node).value;
            if rough > BAND[0] - margin && rough < BAND[1] + margin {
                measure(node)
            } else {
                rough
            }
        });
        Self { fine, coarse }
    }

    /// Distance and gradient at a point; outside the grid, the nearest cell is extended.
    pub(crate) fn at(&self, point: &Vector3<f64>) -> Distance {
        self.fine.at(point)
    }

    /// Coarse nodes whose distance is at most `level` (radii).
    pub(crate) fn nodes_below(&self, level: f64) -> Vec<Vector3<f64>> {
        let [_, sy, sz] = self.coarse.size;
        let below = self.coarse.values.iter().enumerate();
        below
            .filter(|(_, value)| **value <= level)
            .map(|(index, _)| {
                let cell = [index / (sy * sz), index / sz % sy, index % sz];
                self.coarse.position(cell)
            })
            .collect()
    }

    /// Corners of the box that the grid covers, radii.
    pub(crate) fn corners(&self) -> [Vector3<f64>; 2] {
        let [x, y, z] = self.fine.size;
        [self.fine.low, self.fine.position([x - 1, y - 1, z - 1])]
    }
}

impl Nodes {
    /// Asks for the value at every node of a grid that covers a box.
    fn new(
        low: &Vector3<f64>,
        high: &Vector3<f64>,
        spacing: f64,
        mut measure: impl FnMut(&Vector3<f64>) -> f64,
    ) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and bounded by the largest number of nodes"
        )]
        let size = [0, 1, 2].map(|k| ((high[k] - low[k]) / spacing).ceil() as usize + 3);
        let mut nodes = Self {
            low: low - Vector3::repeat(spacing),
            spacing,
            size,
            values: Vec::with_capacity(size.iter().product()),
        };
        for i in 0..size[0] {
            for j in 0..size[1] {
                for k in 0..size[2] {
                    // There and back again, so that each node is next to the one before.
                    let back = (i * size[1] + j) % 2 == 1;
                    let k = if back { size[2] - 1 - k } else { k };
                    nodes.values.push(measure(&nodes.position([i, j, k])));
                }
                if (i * size[1] + j) % 2 == 1 {
                    let row = nodes.values.len() - size[2];
                    nodes.values[row..].reverse();
                }
            }
        }
        nodes
    }

    /// Position of a node, radii.
    fn position(&self, cell: [usize; 3]) -> Vector3<f64> {
        self.low + Vector3::from_fn(|k, _| cell[k] as f64) * self.spacing
    }

    /// Interpolates value and gradient.
    fn at(&self, point: &Vector3<f64>) -> Distance {
        let mut cell = [0_usize; 3];
        let mut part = [0.0; 3];
        for k in 0..3 {
            let scaled = (point[k] - self.low[k]) / self.spacing;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the grid; a float cast saturates"
            )]
            let index = (scaled.max(0.0) as usize).min(self.size[k] - 2);
            cell[k] = index;
            part[k] = scaled - index as f64;
        }
        let [_, sy, sz] = self.size;
        let base = (cell[0] * sy + cell[1]) * sz + cell[2];
        let v = |offset: usize| self.values[base + offset];
        let (dx, dy) = (sy * sz, sz);
        let [u, w, t] = part;
        let mix = |a: f64, b: f64, s: f64| a + (b - a) * s;
        let (c00, c01) = (mix(v(0), v(dx), u), mix(v(1), v(dx + 1), u));
        let (c10, c11) = (mix(v(dy), v(dx + dy), u), mix(v(dy + 1), v(dx + dy + 1), u));
        let (c0, c1) = (mix(c00, c10, w), mix(c01, c11, w));
        let gx = mix(
            mix(v(dx) - v(0), v(dx + dy) - v(dy), w),
            mix(v(dx + 1) - v(1), v(dx + dy + 1) - v(dy + 1), w),
            t,
        );
        let gy = mix(c10 - c00, c11 - c01, t);
        Distance {
            value: mix(c0, c1, t),
            gradient: Vector3::new(gx, gy, c1 - c0) / self.spacing,
        }
    }
}
