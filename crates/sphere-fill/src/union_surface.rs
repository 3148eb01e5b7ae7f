//! The surface of a union of spheres as triangles.

use crate::Error;
use geometry::clump::Sphere;
use nalgebra::Vector3;
use std::collections::HashMap;
use trimesh::CubeGrid;

/// Most nodes of the grid, a byte each.
const MOST_NODES: f64 = 4e8;

/// Triangles (m, counter-clockwise from outside) of the surface of a union of spheres, on a grid of
/// cubes of an edge length `cell` (m).
///
/// # Method
///
/// [`CubeGrid::boundary`] of the nodes inside a sphere. The corner of an edge lies where the edge leaves the last sphere
/// that holds its inner end: on the surface, but for a detail finer than a cell.
///
/// # Errors
///
/// A cell that is not a positive number, or so small that the grid has more nodes than are kept.
pub fn union_surface(spheres: &[Sphere], cell: f64) -> Result<Vec<[Vector3<f64>; 3]>, Error> {
    crate::settings::positive("the cell in m", cell)?;
    let grid = grid_round(spheres, cell)?;
    let inside = inside(&grid, spheres);
    let crossings = crossings(&grid, spheres, &inside);
    let share = |inner, outer| crossings.get(&[inner, outer]).copied().unwrap_or(0.5);
    Ok(grid.boundary(&inside, share))
}

/// Where edges leave the union: by inner and outer node, the share of the edge.
type Crossings = HashMap<[usize; 2], f64>;

fn grid_round(spheres: &[Sphere], cell: f64) -> Result<CubeGrid, Error> {
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for sphere in spheres {
        low = low.inf(&sphere.centre.add_scalar(-sphere.radius));
        high = high.sup(&sphere.centre.add_scalar(sphere.radius));
    }
    CubeGrid::around(low, high, cell, MOST_NODES).map_err(|nodes| Error::CellTooSmall {
        cell_mm: cell * 1e3,
        least_mm: cell * 1e3 * (nodes / MOST_NODES).cbrt() * 1.05,
    })
}

/// Calls with each node inside a sphere, and how deep it lies there, m.
fn each_inside(grid: &CubeGrid, sphere: &Sphere, mut found: impl FnMut(usize, f64)) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between the first and the last node"
    )]
    let range = |k: usize| {
        let at = |side: f64| (sphere.centre[k] + side * sphere.radius - grid.low[k]) / grid.cell[k];
        at(-1.0).ceil() as usize..=at(1.0).floor() as usize
    };
    for x in range(0) {
        for y in range(1) {
            for z in range(2) {
                let node = grid.index([x, y, z]);
                let depth = sphere.radius - (grid.place(node) - sphere.centre).norm();
                if depth > 0.0 {
                    found(node, depth);
                }
            }
        }
    }
}

/// Which nodes lie inside a sphere.
fn inside(grid: &CubeGrid, spheres: &[Sphere]) -> Vec<bool> {
    let mut inside = vec![false; grid.nodes()];
    for sphere in spheres {
        each_inside(grid, sphere, |node, _| inside[node] = true);
    }
    inside
}

/// Where the edges leave the last sphere that holds their inner end.
fn crossings(grid: &CubeGrid, spheres: &[Sphere], inside: &[bool]) -> Crossings {
    let mut crossings = Crossings::new();
    let longest = grid.cell.norm();
    for sphere in spheres {
        each_inside(grid, sphere, |node, depth| {
            if depth > longest {
                return;
            }
            let offsets = (1..8).map(|bits| grid.offset(bits));
            let others = offsets.flat_map(|offset| [node + offset, node - offset]);
            for other in others.filter(|&other| !inside[other]) {
                let share = exit_share(sphere, &grid.place(node), &grid.place(other));
                let last = crossings.entry([node, other]).or_insert(0.0);
                *last = share.max(*last);
            }
        });
    }
    crossings
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
    use geometry::clump::Sphere;
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
