//! Overlapping spheres of several radii that follow the surface.

use crate::greedy::Greedy;
use crate::touching::touching_sphere;
use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;

/// Surface points at which touching spheres are tried and the fit is measured.
const SAMPLES: usize = 3000;

/// Most spheres, when neither a count nor a limit is given.
const MOST: usize = 400;

/// Overlapping inscribed spheres of several radii, chosen to follow the surface.
///
/// # Method
///
/// At each of 3000 surface points the largest inscribed sphere that touches there is found by
/// the shrinking ball `[Ma2012, section 3]`. Of those with at least the radius asked for, spheres
/// are taken one after another, each time the one that lowers the sum of squared gaps between
/// the surface and the spheres the most. The gain of a sphere can only fall as others are
/// taken, so most gains need not be computed again. It ends at the count, or at the roughness.
///
/// The roughness falls steadily with the number of spheres, so the same seed can be made with
/// any surface texture; take mass and inertia from the mesh ([`crate::InertiaSource::Mesh`]),
/// because overlaps count twice in the spheres' own sums.
#[derive(Debug, Clone, Copy)]
pub struct Smooth;

impl Place for Smooth {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let samples = body.mesh.surface_samples(SAMPLES);
        let candidates: Vec<Sphere> = samples
            .iter()
            .filter_map(|sample| touching_sphere(body, sample, settings.radius))
            .collect();
        let target = settings.roughness.unwrap_or(settings.radius / 20.0);
        let mut greedy = Greedy::new(&samples, candidates, body.inscribed_radius);
        let most = settings.count_or(MOST);
        while greedy.chosen.len() < most {
            let smooth_enough = settings.count.is_none()
                && !greedy.chosen.is_empty()
                && greedy.gaps().roughness_rms() <= target;
            if smooth_enough || !greedy.take_best() {
                break;
            }
        }
        let file = || body.mesh.source().to_owned();
        let spheres = greedy.chosen.len();
        if let Some(asked) = settings.count.filter(|&asked| spheres < asked) {
            return Err(Error::CountNotReached {
                mesh: file(),
                asked,
                reached: spheres,
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            });
        }
        let reached = greedy.gaps().roughness_rms();
        match settings.roughness {
            Some(asked) if settings.count.is_none() && reached > asked => {
                Err(Error::RoughnessNotReached {
                    mesh: file(),
                    asked_mm: asked * 1e3,
                    reached_mm: reached * 1e3,
                    spheres,
                })
            }
            _ => Ok(greedy.chosen),
        }
    }
}
