//! Distance to a closed surface, with sign.

use crate::bounding_tree::{BoundingTree, Nearest};
use crate::orientation::Edges;
use crate::{Error, TriMesh};
use geometry::triangle::Feature;
use geometry::triangle::area_vector;
use nalgebra::Vector3;

/// Nearest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, m.
    pub point: Vector3<f64>,
    /// Triangle on which it lies.
    pub triangle: usize,
    /// Signed distance of the asked point: negative inside, positive outside, m.
    pub distance: f64,
    /// Unit vector along which the signed distance grows; where the asked point lies on the
    /// surface, the outward normal there.
    pub outward: Vector3<f64>,
}

/// Answers distance queries to a closed mesh.
///
/// The distance is exact (nearest point of all triangles, found with a tree of boxes). The sign
/// is that of the offset against the pseudo-normal of the feature on which the nearest point
/// lies: face normal, sum of both normals at an edge, and at a vertex the normals weighted by
/// the angle of each triangle, which is right for every closed mesh that does not intersect
/// itself `[Baerentzen2005, theorem 1]`.
#[derive(Debug, Clone)]
pub struct SignedDistance {
    /// Boxes over the triangles.
    tree: BoundingTree,
    /// Unit normals of the triangles.
    face_normals: Vec<Vector3<f64>>,
    /// Triangles beyond the sides of each triangle.
    edges: Edges,
    /// Pseudo-normals of the vertices (not of unit length).
    vertex_normals: Vec<Vector3<f64>>,
    /// Vertex indices of the triangles.
    triangles: Vec<[usize; 3]>,
}

impl SignedDistance {
    /// Prepares the queries.
    ///
    /// # Errors
    ///
    /// A mesh that does not bound exactly one body.
    pub fn new(mesh: &TriMesh) -> Result<Self, Error> {
        mesh.require_closed()?;
        let n = mesh.triangles().len();
        let unit = |v: Vector3<f64>| v.try_normalize(0.0).unwrap_or_default();
        let face_normals: Vec<_> = (0..n)
            .map(|t| unit(area_vector(&mesh.corners(t))))
            .collect();
        let edges = Edges::new(mesh.triangles());
        let mut vertex_normals = vec![Vector3::zeros(); mesh.vertices().len()];
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let corners = mesh.corners(t);
            for k in 0..3 {
                let one = corners[(k + 1) % 3] - corners[k];
                let two = corners[(k + 2) % 3] - corners[k];
                vertex_normals[triangle[k]] += face_normals[t] * one.angle(&two);
            }
        }
        Ok(Self {
            tree: BoundingTree::new(mesh),
            face_normals,
            edges,
            vertex_normals,
            triangles: mesh.triangles().to_vec(),
        })
    }

    /// Signed distance to the surface: negative inside, positive outside, m.
    pub fn distance(&self, point: &Vector3<f64>) -> f64 {
        self.nearest(point).distance
    }

    /// Whether a point lies inside or on the surface.
    pub fn contains(&self, point: &Vector3<f64>) -> bool {
        self.distance(point) <= 0.0
    }

    /// Nearest surface point.
    pub fn nearest(&self, point: &Vector3<f64>) -> SurfacePoint {
        self.nearest_from(point, 0)
    }

    /// Nearest surface point, with a guess of its triangle: the same answer (of equally near
    /// points perhaps another one), sooner if the guess is near.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    pub fn nearest_from(&self, point: &Vector3<f64>, guess: usize) -> SurfacePoint {
        let found = self.tree.nearest(point, guess);
        let offset = point - found.closest.point;
        let normal = self.pseudo_normal(&found);
        let length = found.distance_squared.sqrt();
        let sign = if offset.dot(&normal) < 0.0 { -1.0 } else { 1.0 };
        let outward = (offset * sign)
            .try_normalize(0.0)
            .or_else(|| normal.try_normalize(0.0))
            .unwrap_or_default();
        SurfacePoint {
            point: found.closest.point,
            triangle: found.triangle,
            distance: sign * length,
            outward,
        }
    }

    /// Pseudo-normal of a side (not of unit length): the sum of the normals on both sides of it.
    fn side_normal(&self, triangle: usize, side: usize) -> Vector3<f64> {
        let other = self.edges.beyond(triangle, side);
        let other = other.map(|beyond| self.face_normals[beyond]);
        self.face_normals[triangle] + other.unwrap_or_default()
    }

    /// Pseudo-normal of the feature on which a nearest point lies.
    fn pseudo_normal(&self, found: &Nearest) -> Vector3<f64> {
        match found.closest.feature {
            Feature::Face => self.face_normals[found.triangle],
            Feature::Side(side) => self.side_normal(found.triangle, side),
            Feature::Corner(corner) => self.vertex_normals[self.triangles[found.triangle][corner]],
        }
    }
}
