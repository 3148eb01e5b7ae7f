//! Inscribed spheres that touch random points of the surface.

use crate::touching::touching_sphere;
use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use probability::random_stream::Stream;

/// Surface points, in random order.
const SAMPLES: usize = 4000;

/// Most spheres, when neither a count nor a limit is given.
const MOST: usize = 400;

/// Overlapping inscribed spheres at random surface points, until the surface is covered.
///
/// # Method
///
/// At a random surface point that no sphere covers yet, the largest inscribed sphere that touches
/// there is placed (if its radius is at least the one asked for). A point is covered when a
/// sphere comes as near as the tolerance: the roughness asked for, or radius / 20. It ends at the
/// count, or when all points are covered.
///
/// # Source
///
/// `[Ferellec2010]`: there a vertex of the mesh is drawn and its sphere grown in steps; here the
/// points share the area evenly and the sphere is found at once by the shrinking ball.
#[derive(Debug, Clone, Copy)]
pub struct Ferellec;

impl Place for Ferellec {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let mut samples = body.mesh.surface_samples(SAMPLES);
        Stream::new(settings.seed, "sphere filling at random surface points").shuffle(&mut samples);
        let tolerance = settings.roughness.unwrap_or(settings.radius / 20.0);
        let most = settings.count_or(MOST);
        let mut covered = vec![false; samples.len()];
        let mut spheres = Vec::new();
        // With a count, a second round takes points that are covered already.
        let rounds = if settings.count.is_some() { 2 } else { 1 };
        for round in 0..rounds {
            for index in 0..samples.len() {
                if spheres.len() == most {
                    return Ok(spheres);
                }
                if covered[index] && round == 0 {
                    continue;
                }
                let Some(sphere) = touching_sphere(body, &samples[index], settings.radius) else {
                    continue;
                };
                if round == 1 && spheres.contains(&sphere) {
                    continue;
                }
                for (is_covered, sample) in covered.iter_mut().zip(&samples) {
                    let gap = (sample.point - sphere.centre).norm() - sphere.radius;
                    *is_covered |= gap <= tolerance;
                }
                spheres.push(sphere);
            }
        }
        match settings.count {
            Some(asked) if spheres.len() < asked => Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked,
                reached: spheres.len(),
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            }),
            _ => Ok(spheres),
        }
    }
}
