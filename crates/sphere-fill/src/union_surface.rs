//! The surface of a union of spheres as triangles.

use crate::Error;
use clump::Sphere;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Most nodes of the grid, a byte each.
const MOST_NODES: f64 = 4e8;

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

/// Triangles (m, counter-clockwise from outside) of the surface of a union of spheres, on a grid of
/// cubes of an edge length `cell` (m).
///
/// # Method
///
/// Marching tetrahedra: the nodes of the grid lie inside or outside the union; of each tetrahedron with
/// nodes on both sides, one or two triangles part them. Every edge has one corner at most, so the
/// surface is closed and never meets itself. The corner of an edge lies where the edge leaves the last sphere
/// that holds its inner end: on the surface, but for a detail finer than a cell.
///
/// # Errors
///
/// A cell that is no positive number, or so small that the grid has more nodes than are kept.
pub fn union_surface(spheres: &[Sphere], cell: f64) -> Result<Vec<[Vector3<f64>; 3]>, Error> {
    crate::settings::positive("the cell in m", cell)?;
    let grid = Grid::new(spheres, cell)?;
    let inside = grid.inside(spheres);
    let crossings = grid.crossings(spheres, &inside);
    let mut triangles = Vec::new();
    let [nx, ny, nz] = grid.counts;
    for x in 0..nx - 1 {
        for y in 0..ny - 1 {
            for z in 0..nz - 1 {
                let first = grid.index([x, y, z]);
                let corners: [usize; 8] = std::array::from_fn(|bits| first + grid.offset(bits));
                let count = corners.iter().filter(|&&node| inside[node]).count();
                if count == 0 || count == 8 {
                    continue;
                }
                for way in WAYS {
                    let [a, b, _] = way.map(|axis| 1 << axis);
                    let nodes = [0, a, a | b, 7].map(|bits: usize| corners[bits]);
                    grid.part(nodes, &inside, &crossings, &mut triangles);
                }
            }
        }
    }
    Ok(triangles)
}

/// Where edges leave the union: by inner and outer node, the share of the edge.
type Crossings = HashMap<[usize; 2], f64>;

/// A grid of cubes round spheres.
struct Grid {
    /// Place of the first node, m.
    low: Vector3<f64>,
    /// Edge length of a cube, m.
    cell: f64,
    /// Nodes along each axis.
    counts: [usize; 3],
}

impl Grid {
    fn new(spheres: &[Sphere], cell: f64) -> Result<Self, Error> {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for sphere in spheres {
            low = low.inf(&sphere.centre.add_scalar(-sphere.radius));
            high = high.sup(&sphere.centre.add_scalar(sphere.radius));
        }
        // A node more on each side, and off the symmetry planes of the body.
        let low = low - Vector3::new(1.37, 1.23, 1.41) * cell;
        let steps = (high - low) / cell;
        let nodes = steps.map(|step| step.ceil() + 2.0).product();
        if !nodes.is_finite() || nodes > MOST_NODES {
            return Err(Error::CellTooSmall {
                cell_mm: cell * 1e3,
                least_mm: cell * 1e3 * (nodes / MOST_NODES).cbrt() * 1.05,
            });
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, bounded by the number of nodes"
        )]
        let counts = [0, 1, 2].map(|k| steps[k].ceil() as usize + 2);
        Ok(Self { low, cell, counts })
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.counts[1] + y) * self.counts[2] + z
    }

    /// What leads from the first corner of a cube to the corner whose bits tell the axes.
    fn offset(&self, bits: usize) -> usize {
        self.index([bits & 1, bits >> 1 & 1, bits >> 2])
    }

    /// Place of a node, m.
    fn place(&self, node: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.counts;
        let at = Vector3::new(node / (ny * nz), node / nz % ny, node % nz);
        self.low + at.map(|k| k as f64) * self.cell
    }

    /// Calls with each node inside a sphere, and how deep it lies there, m.
    fn each_inside(&self, sphere: &Sphere, mut found: impl FnMut(usize, f64)) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between the first and the last node"
        )]
        let range = |k: usize| {
            let at =
                |side: f64| (sphere.centre[k] + side * sphere.radius - self.low[k]) / self.cell;
            at(-1.0).ceil() as usize..=at(1.0).floor() as usize
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let node = self.index([x, y, z]);
                    let depth = sphere.radius - (self.place(node) - sphere.centre).norm();
                    if depth > 0.0 {
                        found(node, depth);
                    }
                }
            }
        }
    }

    /// Which nodes lie inside a sphere.
    fn inside(&self, spheres: &[Sphere]) -> Vec<bool> {
        let mut inside = vec![false; self.counts.iter().product()];
        for sphere in spheres {
            self.each_inside(sphere, |node, _| inside[node] = true);
        }
        inside
    }

    /// Where the edges leave the last sphere that holds their inner end.
    fn crossings(&self, spheres: &[Sphere], inside: &[bool]) -> Crossings {
        let mut crossings = Crossings::new();
        let longest = 3.0_f64.sqrt() * self.cell;
        for sphere in spheres {
            self.each_inside(sphere, |node, depth| {
                if depth > longest {
                    return;
                }
                let offsets = (1..8).map(|bits| self.offset(bits));
                let others = offsets.flat_map(|offset| [node + offset, node - offset]);
                for other in others.filter(|&other| !inside[other]) {
                    let share = exit_share(sphere, &self.place(node), &self.place(other));
                    let last = crossings.entry([node, other]).or_insert(0.0);
                    *last = share.max(*last);
                }
            });
        }
        crossings
    }

    /// Adds the triangles that part the inner from the outer nodes of a tetrahedron.
    fn part(
        &self,
        nodes: [usize; 4],
        inside: &[bool],
        crossings: &Crossings,
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
        for (k, second) in middle.iter().enumerate() {
            let third = &edges[k + 2];
            // Seen with the corners in the middle of their edges, the triangle must look outward.
            let halfway = |[a, b]: &[usize; 2]| (self.place(*a) + self.place(*b)) * 0.5;
            let [p, q, r] = [first, second, third].map(halfway);
            let outward = self.place(first[1]) - self.place(first[0]);
            let turned = (q - p).cross(&(r - p)).dot(&outward) < 0.0;
            let corner = |[a, b]: &[usize; 2]| {
                let share = crossings.get(&[*a, *b]).copied().unwrap_or(0.5);
                let (from, to) = (self.place(*a), self.place(*b));
                from + (to - from) * share.clamp(CLEAR, 1.0 - CLEAR)
            };
            let [p, q, r] = [first, second, third].map(corner);
            triangles.push(if turned { [p, r, q] } else { [p, q, r] });
        }
    }
}

/// Share of the way from a point inside a sphere to one outside at which the sphere is left.
fn exit_share(sphere: &Sphere, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let (start, way) = (from - sphere.centre, to - from);
    let (a, b) = (way.norm_squared(), start.dot(&way));
    let c = start.norm_squared() - sphere.radius * sphere.radius;
    ((b * b - a * c).max(0.0).sqrt() - b) / a
}

#[cfg(test)]
mod tests {
    use super::union_surface;
    use clump::Sphere;
    use nalgebra::Vector3;
    use std::f64::consts::PI;
    use trimesh::{LengthUnit, TriMesh};

    fn at(x: f64, y: f64, radius: f64) -> Sphere {
        Sphere {
            centre: Vector3::new(x, y, 0.1) * 1e-3,
            radius: radius * 1e-3,
        }
    }

    /// A ball, two balls that share a lens, and a ring of eight with its hole: closed, one body, nothing
    /// repaired, every edge run through both ways; and the volume of the first two is the closed form within
    /// 0.3 (cell / radius)², the measured deficit of facets whose corners lie on the surface.
    #[test]
    fn the_surface_is_closed_and_has_the_volume_of_the_union() {
        let d: f64 = 1.2;
        let lens = PI * (4.0 + d) * (2.0 - d) * (2.0 - d) / 12.0;
        let ball = 4.0 / 3.0 * PI;
        let ring = (0..8).map(|k| {
            let angle = f64::from(k) * PI / 4.0;
            at(2.0 * angle.cos(), 2.0 * angle.sin(), 1.0)
        });
        let cases = [
            (vec![at(0.0, 0.0, 1.0)], Some(ball)),
            (
                vec![at(0.0, 0.0, 1.0), at(d, 0.0, 1.0)],
                Some(2.0 * ball - lens),
            ),
            (ring.collect(), None),
        ];
        for (spheres, exact) in cases {
            for parts in [5.0, 12.0] {
                let soup = union_surface(&spheres, 1e-3 / parts).unwrap();
                let read = TriMesh::from_triangles(&soup, LengthUnit::Metre, "union").unwrap();
                read.mesh.require_closed().unwrap();
                let report = &read.report;
                assert_eq!((report.triangles, report.triangles_turned), (soup.len(), 0));
                assert_eq!((report.holes_closed, report.degenerate_dropped), (0, 0));
                let topology = read.mesh.topology();
                assert_eq!((topology.crossings, topology.shells), (0, 1));
                let corners = report.vertices + report.triangles;
                // Euler's number: 2 for a ball, 0 for a ring; a closed surface has 3/2 edges a triangle.
                let euler = corners as f64 - 1.5 * report.triangles as f64;
                assert_eq!(euler, if exact.is_some() { 2.0 } else { 0.0 });
                if let Some(exact) = exact {
                    let error = 1.0 - report.volume.unwrap() / (exact * 1e-9);
                    assert!(
                        error > 0.0 && error < 0.3 / (parts * parts),
                        "{parts}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_cell_that_cannot_be_meant_is_refused() {
        let ball = [at(0.0, 0.0, 1.0)];
        for cell in [0.0, -1.0, f64::NAN, 1e-9, 1e-300] {
            assert!(union_surface(&ball, cell).is_err(), "{cell}");
        }
        // A cell larger than the ball finds no surface, or a coarse one; it does not fail.
        assert!(union_surface(&ball, 1.0).is_ok());
    }
}
