//! Volume, centroid and inertia of the body that a mesh encloses.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Volume integrals of a body of density 1 kg/m³.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VolumeMoments {
    /// Volume, m³.
    pub volume: f64,
    /// Centroid, m.
    pub centroid: Vector3<f64>,
    /// Inertia tensor about the centroid at unit density, m⁵: times kg/m³ gives kg m².
    pub inertia: Matrix3<f64>,
}

impl VolumeMoments {
    /// Sums exact integrals over the tetrahedra from one point to every triangle.
    ///
    /// # Formula
    ///
    /// With d = a·(b×c) for the corners a, b, c seen from a point within the mesh's box:
    /// V = Σ d/6, ∫x dV = Σ d/24 s, ∫x xᵀ dV = Σ d/120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ), s = a+b+c;
    /// inertia = tr(C) 1 − C with C taken about the centroid.
    ///
    /// # Source
    ///
    /// `[Tonon2005]` gives the tensor of a tetrahedron; the form here is its matrix writing.
    pub(crate) fn of_triangles(
        origin: &Vector3<f64>,
        triangles: impl Iterator<Item = [Vector3<f64>; 3]>,
    ) -> Self {
        let mut volume = 0.0;
        let mut first = Vector3::zeros();
        let mut second = Matrix3::zeros();
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| corner - origin);
            let six_volumes = a.dot(&b.cross(&c));
            let s = a + b + c;
            volume += six_volumes / 6.0;
            first += s * (six_volumes / 24.0);
            second +=
                (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose())
                    * (six_volumes / 120.0);
        }
        let centre = first / volume;
        let about_centroid = second - centre * centre.transpose() * volume;
        Self {
            volume,
            centroid: origin + centre,
            inertia: Matrix3::identity() * about_centroid.trace() - about_centroid,
        }
    }

    /// Principal moments at unit density in rising order, m⁵.
    pub fn principal_moments(&self) -> [f64; 3] {
        let eigen = self.inertia.symmetric_eigenvalues();
        let mut moments = [eigen.x, eigen.y, eigen.z];
        moments.sort_by(f64::total_cmp);
        moments
    }
}
