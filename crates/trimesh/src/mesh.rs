//! The mesh itself: vertices, triangles and the known data of them.

use crate::{Error, Proposal, VolumeMoments};
use geometry::triangle::area_vector;
use nalgebra::Vector3;
use serde::Serialize;

/// Share of the area of folds that are let pass: a fold of 1 % of a ball's area has 0.1 % of its
/// volume.
const MOST_FOLDED: f64 = 0.01;

/// Box along the axes that holds a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundingBox {
    /// Lowest coordinates, m.
    pub low: Vector3<f64>,
    /// Highest coordinates, m.
    pub high: Vector3<f64>,
}

impl BoundingBox {
    /// Smallest box round some points.
    pub fn of<'a>(points: impl Iterator<Item = &'a Vector3<f64>>) -> Self {
        let mut found = Self {
            low: Vector3::repeat(f64::INFINITY),
            high: Vector3::repeat(f64::NEG_INFINITY),
        };
        for point in points {
            found.low = found.low.inf(point);
            found.high = found.high.sup(point);
        }
        found
    }

    /// Edge lengths, m.
    pub fn size(&self) -> Vector3<f64> {
        self.high - self.low
    }

    /// Whether a point lies in the box.
    pub(crate) fn holds(&self, point: &Vector3<f64>) -> bool {
        (0..3).all(|k| self.low[k] <= point[k] && point[k] <= self.high[k])
    }

    /// Whether two boxes have a common point.
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Middle, m.
    pub fn centre(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }
}

/// How the triangles hang together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Topology {
    /// Edges that belong to one triangle only.
    pub open_edges: usize,
    /// Middle of the first open edge, m.
    pub first_open_edge: Option<Vector3<f64>>,
    /// Holes whose rim is a simple loop.
    pub holes: usize,
    /// Diagonal of the box round the widest of them, m.
    pub widest_hole: f64,
    /// Edges that belong to more than two triangles.
    pub non_manifold_edges: usize,
    /// Middle of the first such edge, m.
    pub first_non_manifold_edge: Option<Vector3<f64>>,
    /// Connected surfaces.
    pub shells: usize,
    /// Shells that bound a body from outside; the others bound cavities.
    pub bodies: usize,
    /// Bodies if those that cross each other count as one.
    pub bodies_apart: usize,
    /// Whether the surface has two sides.
    pub orientable: bool,
    /// Pairs of triangles without a common vertex that cross.
    pub crossings: usize,
    /// A point where the first of them cross, m.
    pub first_crossing: Option<Vector3<f64>>,
    /// Share of the area that does not part inside from outside, where triangles cross.
    pub folded_share: f64,
    /// Repair of open edges and of those of more than two triangles; `None` without such edges.
    pub way_out: Option<Proposal>,
}

impl Topology {
    /// Whether every edge joins two triangles and the surface has an inside.
    pub fn watertight(&self) -> bool {
        self.open_edges == 0 && self.non_manifold_edges == 0 && self.orientable
    }
}

/// A triangle mesh in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct TriMesh {
    /// Where it came from, for messages.
    pub(crate) source: String,
    /// Vertices, m.
    pub(crate) vertices: Vec<Vector3<f64>>,
    /// Vertex indices of the corners, counter-clockwise seen from outside.
    pub(crate) triangles: Vec<[usize; 3]>,
    /// How the triangles hang together.
    pub(crate) topology: Topology,
}

impl TriMesh {
    /// File or shape that the mesh was made from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Vertices, m.
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// Vertex indices of the corners, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// How the triangles hang together.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Corners of a triangle, m.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [Vector3<f64>; 3] {
        self.triangles[triangle].map(|i| self.vertices[i])
    }

    /// Box along the axes, m.
    pub fn bounding_box(&self) -> BoundingBox {
        BoundingBox::of(self.vertices.iter())
    }

    /// Surface area, m².
    pub fn area(&self) -> f64 {
        (0..self.triangles.len())
            .map(|t| area_vector(&self.corners(t)).norm())
            .sum()
    }

    /// Volume, centroid and inertia at unit density; meaningful for a closed mesh only.
    pub fn moments(&self) -> VolumeMoments {
        let corners = (0..self.triangles.len()).map(|t| self.corners(t));
        VolumeMoments::of_triangles(&self.bounding_box().centre(), corners)
    }

    /// Refuses a mesh that does not bound exactly one body.
    ///
    /// # Errors
    ///
    /// Open or crowded edges, a one-sided surface, several bodies, a surface that cuts itself and
    /// does not part inside from outside on more than 1 % of its area; each with its place.
    pub fn require_closed(&self) -> Result<(), Error> {
        let (topology, file) = (&self.topology, self.source.clone());
        let way_out = topology
            .way_out
            .unwrap_or_else(|| Proposal::rebuilt(&self.bounding_box()));
        let way_out = Box::new(way_out);
        let in_mm =
            |place: Option<Vector3<f64>>| -> [f64; 3] { (place.unwrap_or_default() * 1e3).into() };
        if topology.open_edges > 0 {
            let [x, y, z] = in_mm(topology.first_open_edge);
            return Err(Error::Open {
                file,
                open_edges: topology.open_edges,
                holes: topology.holes,
                widest_mm: topology.widest_hole * 1e3,
                x,
                y,
                z,
                way_out,
            });
        }
        if topology.non_manifold_edges > 0 {
            let [x, y, z] = in_mm(topology.first_non_manifold_edge);
            return Err(Error::NonManifold {
                file,
                edges: topology.non_manifold_edges,
                x,
                y,
                z,
                way_out,
            });
        }
        if !topology.orientable {
            return Err(Error::NotOrientable { file });
        }
        if topology.bodies != 1 {
            return Err(Error::SeveralBodies {
                file,
                bodies: topology.bodies,
                shells: topology.shells,
                volumes_mm3: self.volumes_told(),
                apart: topology.bodies_apart,
                way_out,
            });
        }
        if topology.folded_share > MOST_FOLDED {
            let [x, y, z] = in_mm(topology.first_crossing);
            return Err(Error::CutsItself {
                file,
                pairs: topology.crossings,
                folded_percent: topology.folded_share * 100.0,
                x,
                y,
                z,
                way_out,
            });
        }
        Ok(())
    }
}
