//! The fewest overlapping spheres that follow the surface.

use crate::greedy::Greedy;
use crate::surface_fit::SurfaceFit;
use crate::touching::touching_sphere;
use crate::union_moments::union_moments;
use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use trimesh::SurfaceSample;

/// Surface points at which the gap is measured.
const SAMPLES: usize = 6000;

/// Surface points at which touching spheres are tried.
const TRIED: usize = 1500;

/// Spheres when neither a count nor a target is given.
const USUAL: usize = 50;

/// Spheres that are taken out and put back elsewhere, at effort 1.
const EXCHANGES: f64 = 40.0;

/// Overlapping spheres of several radii, fitted to the surface by least squares.
///
/// # Method
///
/// A start is chosen as by [`crate::Smooth`] from inscribed spheres that touch the surface. Then
/// centres and radii are fitted: the sum of squared gaps over 6000 surface points is lowered by
/// Gauss-Newton steps, each point belonging to the sphere whose surface is nearest. The sphere
/// that is missed least is moved to where it gains most, and the move kept if the refitted sum
/// is less. Spheres may stand out of the surface by as much as they fall short of it. At last all
/// radii are changed by one length so that the union has the volume of the body.
///
/// The radius of the settings bounds the radii from below. Without a count there are 50 spheres.
#[derive(Debug, Clone, Copy)]
pub struct Surface;

impl Place for Surface {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let samples = body.mesh.surface_samples(SAMPLES);
        let candidates: Vec<Sphere> = samples
            .iter()
            .step_by(SAMPLES / TRIED)
            .filter_map(|sample| touching_sphere(body, sample, settings.radius))
            .collect();
        let count = settings.count.unwrap_or(USUAL);
        let start = first_spheres(body, &samples, &candidates, count);
        let reached = start.len();
        if reached < count && settings.count.is_some() {
            return Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked: count,
                reached,
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            });
        }
        if start.is_empty() {
            return Ok(start);
        }
        let mut fit = SurfaceFit::new(body, &samples, &candidates, start, settings.radius);
        fit.improve(settings.effort * EXCHANGES);
        Ok(with_volume(
            fit.into_spheres(),
            body.moments.volume,
            settings.radius,
        ))
    }
}

/// Chooses the start from the candidates.
fn first_spheres(
    body: &Body<'_>,
    samples: &[SurfaceSample],
    candidates: &[Sphere],
    count: usize,
) -> Vec<Sphere> {
    let mut greedy = Greedy::new(samples, candidates.to_vec(), body.inscribed_radius);
    while greedy.chosen.len() < count && greedy.take_best() {}
    greedy.chosen
}

/// Changes all radii by one length until the union has a volume; the least radius is kept.
fn with_volume(mut spheres: Vec<Sphere>, volume: f64, least: f64) -> Vec<Sphere> {
    for _ in 0..4 {
        let found = union_moments(&spheres).volume;
        let step = 1e-3 * least;
        let wider: Vec<Sphere> = spheres.iter().map(|s| grown(s, step, least)).collect();
        let slope = (union_moments(&wider).volume - found) / step;
        if slope <= 0.0 || (found / volume - 1.0).abs() < 1e-5 {
            break;
        }
        let change = ((volume - found) / slope).clamp(-least, least);
        for sphere in &mut spheres {
            *sphere = grown(sphere, change, least);
        }
    }
    spheres
}

/// A sphere with its radius changed, but not below the least.
fn grown(sphere: &Sphere, change: f64, least: f64) -> Sphere {
    Sphere {
        radius: (sphere.radius + change).max(least),
        ..*sphere
    }
}
