//! Points spread evenly over a surface.

use crate::TriMesh;
use geometry::triangle::area_vector;
use nalgebra::Vector3;

/// A point of the surface with its outward normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// The point, m.
    pub point: Vector3<f64>,
    /// Outward unit normal of its triangle.
    pub normal: Vector3<f64>,
    /// Its triangle.
    pub triangle: usize,
}

impl TriMesh {
    /// n points, each standing for the same area, always the same ones for the same mesh.
    ///
    /// Point i lies in the triangle that holds the share (i + 1/2)/n of the area, counted in
    /// triangle order; its place within follows a two-dimensional additive sequence of low
    /// discrepancy (steps 1/p and 1/p² with p = 1.32472, the real root of p³ = p + 1), folded
    /// from the square to the triangle. An average over them is an area average.
    pub fn surface_samples(&self, n: usize) -> Vec<SurfaceSample> {
        const P: f64 = 1.324717957244746;
        let areas: Vec<Vector3<f64>> = (0..self.triangles().len())
            .map(|t| area_vector(&self.corners(t)))
            .collect();
        let total: f64 = areas.iter().map(Vector3::norm).sum();
        let mut triangle = 0;
        let mut passed = 0.0;
        (0..n)
            .map(|i| {
                let share = (i as f64 + 0.5) / n as f64 * total;
                while passed + areas[triangle].norm() < share && triangle + 1 < areas.len() {
                    passed += areas[triangle].norm();
                    triangle += 1;
                }
                let (mut u, mut v) = ((i as f64 / P).fract(), (i as f64 / (P * P)).fract());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [a, b, c] = self.corners(triangle);
                SurfaceSample {
                    point: a + (b - a) * u + (c - a) * v,
                    normal: areas[triangle].try_normalize(0.0).unwrap_or_default(),
                    triangle,
                }
            })
            .collect()
    }
}
