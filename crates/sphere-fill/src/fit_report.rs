//! How well the spheres stand for the body.

use crate::Body;
use crate::near_pairs::near_pairs;
use crate::surface_gap::{Gaps, gaps_at};
use geometry::clump::Sphere;
use serde::Serialize;
use trimesh::VolumeMoments;

/// Surface points at which the gap is measured: standard errors are then below 1 % of the value.
const SAMPLES: usize = 20_000;

/// How well a union of spheres represents a body.
///
/// The gap g at a surface point is the distance from there to the nearest sphere surface,
/// g = minᵢ(|p − cᵢ| − rᵢ), positive where the spheres fall short of the surface and negative
/// where they stand out; it is taken at 20 000 points that share the area evenly.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FitReport {
    /// Sum of the sphere volumes over the volume of the body.
    pub packing_fraction: f64,
    /// Volume of the union of spheres over the volume of the body.
    pub union_fraction: f64,
    /// Farthest that a sphere stands out of the surface, m; 0 when none does.
    pub max_protrusion: f64,
    /// Largest overlap of two spheres, r₁ + r₂ − distance, m; 0 when none overlap.
    pub max_overlap: f64,
    /// Root mean square of the gap, m.
    pub surface_rms: f64,
    /// Largest gap in either sense, counting protrusion, m.
    pub surface_hausdorff: f64,
    /// Root mean square of the gap about its mean, m: the roughness of the spheres' surface,
    /// free of a uniform shrinkage (as Rq about the mean line `[ISO21920-2]`).
    pub roughness_rms: f64,
    /// Mean gap, m: how much smaller the union is than the body.
    pub mean_gap: f64,
    /// Distance between the centroids of the union and of the body, m.
    pub centroid_offset: f64,
    /// Error of the principal moments of the union (of uniform density and the body's mass)
    /// against those of the body, in rising order, per cent.
    pub inertia_error_percent: [f64; 3],
}

impl FitReport {
    /// Measures a filling.
    pub(crate) fn new(body: &Body<'_>, spheres: &[Sphere], union: &VolumeMoments) -> Self {
        let samples = body.mesh.surface_samples(SAMPLES);
        let values = gaps_at(samples.iter().map(|s| &s.point), spheres);
        let gaps = Gaps { values: &values };
        let volume = body.moments.volume;
        let total: f64 = spheres
            .iter()
            .map(|s| geometry::clump::volume_of_sphere(s.radius))
            .sum();
        let max_protrusion = spheres
            .iter()
            .map(|s| body.distance.distance(&s.centre) + s.radius)
            .fold(0.0, f64::max);
        let (own, other) = (union.principal_moments(), body.moments.principal_moments());
        let error = |k: usize| 100.0 * (own[k] / union.volume / (other[k] / volume) - 1.0);
        Self {
            packing_fraction: total / volume,
            union_fraction: union.volume / volume,
            max_protrusion,
            max_overlap: max_overlap(spheres),
            surface_rms: gaps.rms(),
            surface_hausdorff: gaps.largest().max(max_protrusion),
            roughness_rms: gaps.roughness_rms(),
            mean_gap: gaps.mean(),
            centroid_offset: (union.centroid - body.moments.centroid).norm(),
            inertia_error_percent: [0, 1, 2].map(error),
        }
    }
}

/// Largest overlap of two spheres, m.
fn max_overlap(spheres: &[Sphere]) -> f64 {
    let mut most = 0.0_f64;
    near_pairs(spheres, 0.0, |_, _, gap| most = most.max(-gap));
    most
}
