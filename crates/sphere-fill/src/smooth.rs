//! Overlapping spheres of several radii that follow the surface.

use crate::surface_gap::Gaps;
use crate::{Body, Error, FillSettings, Place};
use clump::Sphere;
use nalgebra::Vector3;
use trimesh::SurfaceSample;

/// Surface points at which touching spheres are tried and the fit is measured.
const SAMPLES: usize = 3000;

/// Most spheres, when no count is given.
const MOST: usize = 400;

/// Steps of the shrinking ball; most samples take fewer than 10.
const SHRINKING_STEPS: usize = 40;

/// Overlapping inscribed spheres of several radii, chosen to follow the surface.
///
/// # Method
///
/// At each of 3000 surface points the largest inscribed sphere that touches there is found by
/// the shrinking ball `[Ma2012, section 3]`. Of those with at least the radius asked for, spheres
/// are taken one after another, each time the one that lowers the sum of squared gaps between
/// the surface and the spheres the most. The gain of a sphere can only fall as others are
/// taken, so most gains need not be computed anew. It ends at the count, or at the roughness.
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
        let most = settings.count.unwrap_or(MOST);
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

/// Largest inscribed sphere that touches the surface at a sample, if its radius is enough.
///
/// # Formula
///
/// From c = p − r n, the surface point q nearest to c gives the smaller radius
/// r' = |p − q|² / (2 n·(p − q)); repeated until nothing lies nearer than p.
fn touching_sphere(body: &Body<'_>, sample: &SurfaceSample, least: f64) -> Option<Sphere> {
    // A facetted surface touches a sphere a little beside p: 0.1 % of the radius is given in.
    const SLACK: f64 = 1e-3;
    let mut radius = body.inscribed_radius * 1.001;
    let mut guess = sample.triangle;
    for _ in 0..SHRINKING_STEPS {
        let centre = sample.point - sample.normal * radius;
        let nearest = body.distance.nearest_from(&centre, guess);
        guess = nearest.triangle;
        if -nearest.distance >= radius * (1.0 - SLACK) {
            return (radius >= least).then_some(Sphere { centre, radius });
        }
        let chord = sample.point - nearest.point;
        let along = sample.normal.dot(&chord);
        let smaller = chord.norm_squared() / (2.0 * along);
        // A neighbouring facet gives no chord to speak of: shrink by a share instead.
        radius = if along > 0.0 && smaller < radius * (1.0 - SLACK) {
            smaller
        } else {
            radius * (1.0 - SLACK)
        };
        if radius < least {
            return None;
        }
    }
    None
}

/// State of the greedy choice.
struct Greedy<'a> {
    samples: &'a [SurfaceSample],
    candidates: Vec<Sphere>,
    /// Upper bound of the gain of each candidate, m²; negative when taken.
    gains: Vec<f64>,
    /// Gap from each sample to the chosen spheres, m.
    gap: Vec<f64>,
    chosen: Vec<Sphere>,
}

impl<'a> Greedy<'a> {
    /// Without spheres, every gap counts as the radius of the largest inscribed sphere.
    fn new(samples: &'a [SurfaceSample], candidates: Vec<Sphere>, widest: f64) -> Self {
        Self {
            samples,
            gains: vec![f64::INFINITY; candidates.len()],
            candidates,
            gap: vec![widest; samples.len()],
            chosen: Vec::new(),
        }
    }

    /// Gaps between the surface and the spheres chosen so far.
    fn gaps(&self) -> Gaps<'_> {
        Gaps { values: &self.gap }
    }

    /// Fall of the sum of squared gaps if a sphere were added, m².
    fn gain(&self, sphere: &Sphere) -> f64 {
        let each = self.samples.iter().zip(&self.gap).map(|(sample, &gap)| {
            let own = gap_to(sphere, &sample.point);
            if own < gap {
                gap * gap - own * own
            } else {
                0.0
            }
        });
        each.sum()
    }

    /// Takes the sphere of the largest gain; false when none gains anything.
    fn take_best(&mut self) -> bool {
        let mut best: Option<(usize, f64)> = None;
        let mut order: Vec<usize> = (0..self.candidates.len()).collect();
        order.sort_by(|&a, &b| self.gains[b].total_cmp(&self.gains[a]).then(a.cmp(&b)));
        for i in order {
            if self.gains[i] <= best.map_or(0.0, |(_, gain)| gain) {
                break;
            }
            self.gains[i] = self.gain(&self.candidates[i]);
            if self.gains[i] > best.map_or(0.0, |(_, gain)| gain) {
                best = Some((i, self.gains[i]));
            }
        }
        let Some((index, _)) = best else {
            return false;
        };
        let sphere = self.candidates[index];
        for (sample, gap) in self.samples.iter().zip(&mut self.gap) {
            *gap = gap.min(gap_to(&sphere, &sample.point));
        }
        self.gains[index] = -1.0;
        self.chosen.push(sphere);
        true
    }
}

/// Distance from a point to a sphere's surface, 0 within, m.
fn gap_to(sphere: &Sphere, point: &Vector3<f64>) -> f64 {
    ((point - sphere.centre).norm() - sphere.radius).max(0.0)
}
