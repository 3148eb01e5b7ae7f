//! Taking spheres one after another, each time the one that gains most.

use crate::surface_gap::Gaps;
use geometry::clump::Sphere;
use nalgebra::Vector3;
use trimesh::SurfaceSample;

/// State of the greedy choice: each time the sphere that lowers the sum of squared gaps most.
#[derive(Debug)]
pub(crate) struct Greedy<'a> {
    samples: &'a [SurfaceSample],
    candidates: Vec<Sphere>,
    /// Upper bound of the gain of each candidate, m²; negative when taken.
    gains: Vec<f64>,
    /// Gap from each sample to the chosen spheres, m.
    gap: Vec<f64>,
    /// Spheres taken so far.
    pub(crate) chosen: Vec<Sphere>,
}

impl<'a> Greedy<'a> {
    /// Without spheres, every gap counts as the radius of the largest inscribed sphere.
    pub(crate) fn new(samples: &'a [SurfaceSample], candidates: Vec<Sphere>, widest: f64) -> Self {
        Self {
            samples,
            gains: vec![f64::INFINITY; candidates.len()],
            candidates,
            gap: vec![widest; samples.len()],
            chosen: Vec::new(),
        }
    }

    /// Gaps between the surface and the spheres chosen so far.
    pub(crate) fn gaps(&self) -> Gaps<'_> {
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
    pub(crate) fn take_best(&mut self) -> bool {
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
