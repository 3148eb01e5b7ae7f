//! The longer search for one sphere more: hops between jammed configurations.

use crate::holes::deepest_holes;
use crate::pack_search::{FREE, Search};
use crate::relaxation::Relaxed;
use nalgebra::Vector3;

/// Share of the hops that shake a neighbourhood; the others move one squeezed sphere to a hole.
const SHAKEN: f64 = 0.6;

/// Spheres nearer than this to the middle of a shake take part in it, radii.
const NEIGHBOURHOOD: f64 = 3.0;

/// Farthest that a shake moves a sphere along each axis, radii.
const SHAKE: f64 = 0.25;

/// Warmth of the random walk over the lowest energy met.
///
/// On the two cotton seeds one run each at 0.01 and 0.05 ended at 0.5e-3 to 1.2e-3 squared radii with
/// one sphere more than fits, at 0.2 at 0.9e-3 and 1.9e-3: single runs, which tell little more than
/// that it is not a knife's edge.
const WARMTH: f64 = 0.02;

/// Hops without a new lowest energy before the walk goes back to the lowest.
const PATIENCE: u32 = 1000;

impl Search<'_> {
    /// Adds spheres to a free configuration until the target or the end of the work.
    ///
    /// With one sphere more than fits, the squeezed configuration walks from minimum to minimum of
    /// the energy, as at a low temperature, until it comes to one without overlap.
    pub(crate) fn hop(&mut self, mut best: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
        while self.left > 0 && best.len() < self.target && !self.candidates.is_empty() {
            let holes = deepest_holes(&self.candidates, &best, 2.0, 1);
            let added = holes.first().unwrap_or(&self.candidates[0]);
            let fuller = [best.as_slice(), &[*added]].concat();
            let squeezed = self.relax(fuller);
            match self.walk(squeezed) {
                Some(found) => best = found,
                None => break,
            }
        }
        best
    }

    /// Walks until no overlap is left; none when the work is spent.
    fn walk(&mut self, start: Relaxed) -> Option<Vec<Vector3<f64>>> {
        let mut current = start;
        let mut lowest = current.clone();
        let mut since = 0;
        while current.energy > FREE {
            if self.left == 0 {
                return None;
            }
            let moved = if self.stream.uniform() < SHAKEN {
                self.shaken(&current.centres)
            } else {
                self.relocate_one(&current.centres)
            };
            let relaxed = self.relax(moved);
            since += 1;
            // Metropolis' rule: a rise is taken with the probability exp(-rise / warmth).
            let rise = -self.stream.uniform().max(f64::MIN_POSITIVE).ln();
            if relaxed.energy < current.energy + WARMTH * lowest.energy * rise {
                current = relaxed;
            }
            if current.energy < lowest.energy {
                lowest = current.clone();
                since = 0;
            } else if since > PATIENCE {
                current = lowest.clone();
                since = 0;
            }
        }
        Some(current.centres)
    }

    /// Moves the spheres round a random one a little, each at random.
    fn shaken(&mut self, centres: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let middle = centres[self.stream.below(centres.len())];
        let mut moved = centres.to_vec();
        for centre in &mut moved {
            if (*centre - middle).norm() < NEIGHBOURHOOD {
                *centre += Vector3::from_fn(|_, _| self.stream.between(-SHAKE, SHAKE));
            }
        }
        moved
    }
}
