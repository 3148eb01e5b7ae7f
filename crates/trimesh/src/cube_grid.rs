//! The boundary between inner and outer nodes of a grid of cubes, as triangles.

use nalgebra::Vector3;

/// A corner of a triangle keeps this share of an edge away from both ends, so that no two corners fall
/// together when they are rounded; it moves a corner by at most 2 % of an edge.
const CLEAR: f64 = 0.02;

/// The six tetrahedra of a cube: ways along the axes from its first corner to the one opposite
/// (Freudenthal's subdivision). Neighbouring cubes cut their common face alike.
const WAYS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

/// Nodes of cubes along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeGrid {
    /// Place of the first node, m.
    pub low: Vector3<f64>,
    /// Edge length of a cube along each axis, m.
    pub cell: Vector3<f64>,
    /// Nodes along each axis, at least 2.
    pub counts: [usize; 3],
}

impl CubeGrid {
    /// Cubes round a box (m, its lowest and its highest corner), with a node more on each side, off the symmetry planes of the
    /// box; as an error the number of nodes that is too many.
    ///
    /// # Errors
    ///
    /// More nodes than `most`.
    pub fn around(
        low: Vector3<f64>,
        high: Vector3<f64>,
        cell: f64,
        most: f64,
    ) -> Result<Self, f64> {
        let low = low - Vector3::new(1.37, 1.23, 1.41) * cell;
        let steps = (high - low) / cell;
        let nodes = steps.map(|step| step.ceil() + 2.0).product();
        if !nodes.is_finite() || nodes > most {
            return Err(nodes);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, bounded by the number of nodes"
        )]
        let counts = [0, 1, 2].map(|k| steps[k].ceil() as usize + 2);
        Ok(Self {
            low,
            cell: Vector3::repeat(cell),
            counts,
        })
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.counts.iter().product()
    }

    /// Number of a node by its steps along the axes.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.counts[1] + y) * self.counts[2] + z
    }

    /// Offset from the first corner of a cube to the corner whose bits give the axes.
    pub fn offset(&self, bits: usize) -> usize {
        self.index([bits & 1, bits >> 1 & 1, bits >> 2])
    }

    /// Place of a node, m.
    pub fn place(&self, node: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.counts;
        let at = Vector3::new(node / (ny * nz), node / nz % ny, node % nz);
        self.low + at.map(|k| k as f64).component_mul(&self.cell)
    }

    /// Triangles (m, counter-clockwise from outside) that part inner from outer nodes; `share` tells where the edge from an inner to
    /// an outer node leaves the inside, as a share of the edge, and the same whenever it is asked.
    ///
    /// # Method
    ///
    /// Marching tetrahedra: of each tetrahedron with nodes on both sides, one or two triangles part them. Every edge has one corner
    /// at most, so the surface is closed if no node at the rim of the grid is an inner one, and never meets itself.
    pub fn boundary(
        &self,
        inside: &[bool],
        mut share: impl FnMut(usize, usize) -> f64,
    ) -> Vec<[Vector3<f64>; 3]> {
        let mut triangles = Vec::new();
        let [nx, ny, nz] = self.counts;
        for x in 0..nx - 1 {
            for y in 0..ny - 1 {
                for z in 0..nz - 1 {
                    let first = self.index([x, y, z]);
                    let corners: [usize; 8] = std::array::from_fn(|bits| first + self.offset(bits));
                    let count = corners.iter().filter(|&&node| inside[node]).count();
                    if count == 0 || count == 8 {
                        continue;
                    }
                    for way in WAYS {
                        let [a, b, _] = way.map(|axis| 1 << axis);
                        let nodes = [0, a, a | b, 7].map(|bits: usize| corners[bits]);
                        self.part(nodes, inside, &mut share, &mut triangles);
                    }
                }
            }
        }
        triangles
    }

    /// Adds the triangles that part the inner from the outer nodes of a tetrahedron.
    fn part(
        &self,
        nodes: [usize; 4],
        inside: &[bool],
        share: &mut impl FnMut(usize, usize) -> f64,
        triangles: &mut Vec<[Vector3<f64>; 3]>,
    ) {
        let (inner, outer): (Vec<usize>, Vec<usize>) = nodes.into_iter().partition(|&n| inside[n]);
        let edges: Vec<[usize; 2]> = match (inner[..].as_ref(), outer[..].as_ref()) {
            ([a, b], [c, d]) => vec![[*a, *c], [*a, *d], [*b, *d], [*b, *c]],
            (inner, outer) => inner
                .iter()
                .flat_map(|&a| outer.iter().map(move |&b| [a, b]))
                .collect(),
        };
        let [first, middle @ .., _] = &edges[..] else {
            return;
        };
        let mut corner = |[a, b]: &[usize; 2]| {
            let (from, to) = (self.place(*a), self.place(*b));
            from + (to - from) * share(*a, *b).clamp(CLEAR, 1.0 - CLEAR)
        };
        for (k, second) in middle.iter().enumerate() {
            let third = &edges[k + 2];
            // Seen with the corners in the middle of their edges, the triangle must look outward.
            let halfway = |[a, b]: &[usize; 2]| (self.place(*a) + self.place(*b)) * 0.5;
            let [p, q, r] = [first, second, third].map(halfway);
            let outward = self.place(first[1]) - self.place(first[0]);
            let turned = (q - p).cross(&(r - p)).dot(&outward) < 0.0;
            let [p, q, r] = [first, second, third].map(&mut corner);
            triangles.push(if turned { [p, r, q] } else { [p, q, r] });
        }
    }
}
