//! Least squares of the gaps between a surface and overlapping spheres.

use crate::Body;
use geometry::clump::Sphere;
use nalgebra::{Matrix4, Vector4};
use trimesh::SurfaceSample;

/// Steps of one fit, at most.
const STEPS: usize = 60;

/// A fit ends when a step lowers the sum by less than this part.
const SMALLEST_GAIN: f64 = 1e-4;

/// Candidates that are looked at for one exchange.
const LOOKED_AT: usize = 150;

/// Least depth of a centre, radii. A sphere of which more stands out would follow the surface from
/// outside, as in the hole of a ring.
const LEAST_DEPTH: f64 = 0.5;

/// Exchanges without gain after which it ends.
const PATIENCE: usize = 12;

/// What belongs to one sample.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    /// Sphere whose surface is nearest.
    sphere: usize,
    /// Signed gap to it, m.
    gap: f64,
    /// Gap to the second nearest, m.
    second: f64,
}

/// Spheres that are fitted to samples of a surface.
#[derive(Debug)]
pub(crate) struct SurfaceFit<'a> {
    body: &'a Body<'a>,
    samples: &'a [SurfaceSample],
    /// Spheres that may be put in.
    candidates: &'a [Sphere],
    spheres: Vec<Sphere>,
    /// Smallest radius, m.
    least: f64,
    nearest: Vec<Nearest>,
    /// Sum of squared gaps, m².
    sum: f64,
}

impl<'a> SurfaceFit<'a> {
    pub(crate) fn new(
        body: &'a Body<'a>,
        samples: &'a [SurfaceSample],
        candidates: &'a [Sphere],
        spheres: Vec<Sphere>,
        least: f64,
    ) -> Self {
        let nearest = nearest_of(samples, &spheres);
        Self {
            body,
            samples,
            candidates,
            sum: sum_of(&nearest),
            nearest,
            spheres,
            least,
        }
    }

    pub(crate) fn into_spheres(self) -> Vec<Sphere> {
        self.spheres
    }

    /// Fits, then moves spheres to better places and fits again, `exchanges` times at most.
    pub(crate) fn improve(&mut self, exchanges: f64) {
        self.fit();
        let mut failures = 0;
        let mut done = 0.0;
        while done < exchanges && failures < PATIENCE && self.spheres.len() > 1 {
            done += 1.0;
            if self.exchange(failures) {
                failures = 0;
            } else {
                failures += 1;
            }
        }
    }

    /// Lowers the sum by damped Gauss-Newton steps of all spheres at once.
    fn fit(&mut self) {
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let trial = self.stepped(damping);
            let nearest = nearest_of(self.samples, &trial);
            let sum = sum_of(&nearest);
            if sum >= self.sum {
                damping *= 8.0;
                if damping > 1e3 {
                    return;
                }
                continue;
            }
            let gain = 1.0 - sum / self.sum;
            (self.spheres, self.nearest, self.sum) = (trial, nearest, sum);
            damping = (damping * 0.3).max(1e-6);
            if gain < SMALLEST_GAIN {
                return;
            }
        }
    }

    /// The spheres after one step.
    ///
    /// # Formula
    ///
    /// The gap g = |p − c| − r has the gradient (−u, −1) in (c, r), u the unit vector from c to
    /// p; each sphere solves (Σ j jᵀ + damping (n + 1) 1) step = −Σ j g over its own n samples.
    fn stepped(&self, damping: f64) -> Vec<Sphere> {
        let mut normal = vec![(Matrix4::zeros(), Vector4::zeros(), 1.0); self.spheres.len()];
        for (sample, nearest) in self.samples.iter().zip(&self.nearest) {
            let offset = sample.point - self.spheres[nearest.sphere].centre;
            let u = offset.try_normalize(0.0).unwrap_or_default();
            let j = Vector4::new(-u.x, -u.y, -u.z, -1.0);
            let (matrix, right, n) = &mut normal[nearest.sphere];
            *matrix += j * j.transpose();
            *right -= j * nearest.gap;
            *n += 1.0;
        }
        let one = |(sphere, (matrix, right, n)): (&Sphere, &(Matrix4<f64>, Vector4<f64>, f64))| {
            let damped = matrix + Matrix4::identity() * (damping * n);
            let step = damped
                .cholesky()
                .map_or(Vector4::zeros(), |c| c.solve(right));
            // Farther than a radius the gap is no longer like its tangent.
            let length = step.norm();
            let step = step * (0.5 * sphere.radius / length.max(f64::MIN_POSITIVE)).min(1.0);
            let moved = Sphere {
                centre: sphere.centre + step.xyz(),
                radius: (sphere.radius + step.w).max(self.least),
            };
            let depth = -self.body.distance.distance(&moved.centre);
            if depth < LEAST_DEPTH * moved.radius {
                return *sphere;
            }
            moved
        };
        self.spheres.iter().zip(&normal).map(one).collect()
    }

    /// Moves the sphere of rank `rank` in loss to the best candidate; keeps it if that is a gain.
    fn exchange(&mut self, rank: usize) -> bool {
        let mut loss = vec![0.0; self.spheres.len()];
        for nearest in &self.nearest {
            loss[nearest.sphere] += nearest.second.powi(2) - nearest.gap.powi(2);
        }
        let mut order: Vec<usize> = (0..loss.len()).collect();
        order.sort_by(|&a, &b| loss[a].total_cmp(&loss[b]).then(a.cmp(&b)));
        let moved = order[rank % order.len()];
        let Some(place) = self.best_candidate() else {
            return false;
        };
        let before = (self.spheres.clone(), self.nearest.clone(), self.sum);
        self.spheres[moved] = place;
        self.nearest = nearest_of(self.samples, &self.spheres);
        self.sum = sum_of(&self.nearest);
        self.fit();
        let better = self.sum < before.2 * (1.0 - SMALLEST_GAIN);
        if !better {
            (self.spheres, self.nearest, self.sum) = before;
        }
        better
    }

    /// The candidate that lowers the sum most as the spheres stand.
    fn best_candidate(&self) -> Option<Sphere> {
        let step = self.candidates.len().div_ceil(LOOKED_AT).max(1);
        let gain = |sphere: &Sphere| -> f64 {
            let each = self
                .samples
                .iter()
                .zip(&self.nearest)
                .map(|(sample, nearest)| {
                    let own = (sample.point - sphere.centre).norm() - sphere.radius;
                    if own < nearest.gap {
                        nearest.gap.powi(2) - own.powi(2)
                    } else {
                        0.0
                    }
                });
            each.sum()
        };
        let gains = self.candidates.iter().step_by(step).map(|s| (gain(s), *s));
        let best = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 > 0.0).then_some(best.1)
    }
}

fn nearest_of(samples: &[SurfaceSample], spheres: &[Sphere]) -> Vec<Nearest> {
    let one = |sample: &SurfaceSample| {
        let mut found = Nearest {
            sphere: 0,
            gap: f64::INFINITY,
            second: f64::INFINITY,
        };
        for (sphere, s) in spheres.iter().enumerate() {
            let gap = (sample.point - s.centre).norm() - s.radius;
            if gap < found.gap {
                found = Nearest {
                    sphere,
                    gap,
                    second: found.gap,
                };
            } else if gap < found.second {
                found.second = gap;
            }
        }
        found
    };
    samples.iter().map(one).collect()
}

/// Sum of the squared gaps, m².
fn sum_of(nearest: &[Nearest]) -> f64 {
    nearest.iter().map(|n| n.gap * n.gap).sum()
}
