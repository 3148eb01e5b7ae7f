//! The search for the largest configuration of equal spheres without overlap.

use crate::distance_grid::DistanceGrid;
use crate::holes::deepest_holes;
use crate::placement::best_lattice;
use crate::relaxation::{Relaxed, Room, Stop, energy_of_each, relax};
use crate::{Body, FillSettings};
use nalgebra::Vector3;
use probability::random_stream::Stream;

/// Sum of squared overlaps (radii²) that counts as none: no overlap is above 1e-4 radii.
pub(crate) const FREE: f64 = 1e-8;

/// Evaluations of one relaxation, at most.
pub(crate) const LONGEST: usize = 2000;

/// Sphere evaluations at effort 1: 30 000 evaluations of 150 spheres.
const WORK: f64 = 4.5e6;

/// Relocations without gain before a new start.
const PATIENCE: usize = 60;

/// State of the search for the largest configuration.
pub(crate) struct Search<'a> {
    pub(crate) room: Room<'a>,
    grid: &'a DistanceGrid,
    /// Places where a sphere may be dropped, radii.
    pub(crate) candidates: Vec<Vector3<f64>>,
    pub(crate) stream: Stream,
    /// Number of spheres that ends the search.
    pub(crate) target: usize,
    /// Spheres of a random start.
    first: usize,
    /// Evaluations left.
    pub(crate) left: usize,
    /// Evaluations for hops, when these are spent.
    further: usize,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        body: &Body<'_>,
        settings: &FillSettings,
        grid: &'a DistanceGrid,
        room: Room<'a>,
    ) -> Self {
        let expected = body.expected_count(settings.radius).max(1.0);
        // Some depth less than one radius is allowed: relaxation moves the sphere inward.
        let mut candidates = grid.nodes_below(-0.9);
        if candidates.is_empty() {
            candidates = grid.nodes_below(-0.5);
        }
        let whole = |count: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive, bounded by the largest number of spheres or the clamp"
            )]
            let count = count as usize;
            count
        };
        let target = settings.count.unwrap_or(usize::MAX);
        Self {
            room,
            grid,
            candidates,
            stream: Stream::new(settings.seed, "sphere packing"),
            target,
            // A start at three quarters of what is expected relaxes almost always.
            first: whole(0.75 * expected).clamp(1, target),
            left: whole((settings.effort.min(1.0) * WORK / expected).max(400.0)),
            further: whole((settings.effort - 1.0).clamp(0.0, 1e6) * WORK / expected),
        }
    }

    /// Searches until the target or the end of the work; gives the largest free configuration.
    pub(crate) fn run(&mut self) -> Vec<Vector3<f64>> {
        let mut best: Vec<Vector3<f64>> = Vec::new();
        let lattice = best_lattice(self.grid, &mut self.stream, 0.25);
        if lattice.len() > 2 * self.first.max(200) || self.candidates.is_empty() {
            best = self.grow(truncated(lattice.clone(), self.target));
        }
        while self.left > 0 && best.len() < self.target && !self.candidates.is_empty() {
            let Some(start) = self.random_start() else {
                continue;
            };
            let grown = self.grow(start);
            if grown.len() > best.len() {
                best = grown;
            }
        }
        if lattice.len() > best.len() {
            best = truncated(lattice, self.target);
        }
        self.left = self.further;
        self.hop(best)
    }

    /// Relaxes random centres; none (and fewer next time) when overlap remains.
    fn random_start(&mut self) -> Option<Vec<Vector3<f64>>> {
        let n = self.candidates.len();
        let mut centres = Vec::with_capacity(self.first);
        for _ in 0..self.first {
            let node = self.candidates[self.stream.below(n)];
            // Off the node, so that no two centres coincide.
            let shift = Vector3::from_fn(|_, _| self.stream.between(-0.1, 0.1));
            centres.push(node + shift);
        }
        let relaxed = self.relax(centres);
        if relaxed.energy > FREE {
            self.first = (self.first * 4 / 5).max(1);
            return None;
        }
        Some(relaxed.centres)
    }

    /// Adds spheres as long as all overlap can be removed.
    fn grow(&mut self, mut free: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
        let mut batch = (free.len() / 20).max(1);
        while self.left > 0 && free.len() < self.target {
            let wanted = batch.min(self.target - free.len());
            let holes = deepest_holes(&self.candidates, &free, 2.0, wanted);
            let mut fuller = free.clone();
            fuller.extend(if holes.is_empty() {
                &self.candidates[..1]
            } else {
                &holes[..]
            });
            let relaxed = self.relax(fuller);
            if relaxed.energy <= FREE {
                free = relaxed.centres;
            } else if batch > 1 {
                batch /= 2;
            } else {
                match self.relocate(relaxed) {
                    Some(found) => free = found,
                    None => break,
                }
            }
        }
        free
    }

    /// Moves squeezed spheres to holes until no overlap is left, or patience is.
    fn relocate(&mut self, mut current: Relaxed) -> Option<Vec<Vector3<f64>>> {
        let mut failures = 0;
        while failures < PATIENCE && self.left > 0 {
            let moved = self.relocate_one(&current.centres);
            let relaxed = self.relax(moved);
            if relaxed.energy <= FREE {
                return Some(relaxed.centres);
            }
            if relaxed.energy < current.energy {
                current = relaxed;
                failures = 0;
            } else {
                failures += 1;
            }
        }
        None
    }

    /// Moves one of the five most squeezed spheres to one of the six deepest holes elsewhere.
    pub(crate) fn relocate_one(&mut self, centres: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let energies = energy_of_each(&self.room, centres);
        let mut order: Vec<usize> = (0..centres.len()).collect();
        order.sort_by(|&a, &b| energies[b].total_cmp(&energies[a]).then(a.cmp(&b)));
        let chosen = order[self.stream.below(order.len().min(5))];
        let mut moved = centres.to_vec();
        let from = moved.swap_remove(chosen);
        let mut holes = deepest_holes(&self.candidates, &moved, 2.0, 7);
        holes.retain(|hole| (hole - from).norm() > 1.0);
        holes.truncate(6);
        let place = if holes.is_empty() {
            self.candidates[self.stream.below(self.candidates.len())]
        } else {
            holes[self.stream.below(holes.len())]
        };
        moved.push(place);
        moved
    }

    /// Relaxes and pays for it.
    pub(crate) fn relax(&mut self, centres: Vec<Vector3<f64>>) -> Relaxed {
        let stop = Stop {
            energy: FREE,
            evaluations: LONGEST,
        };
        let relaxed = relax(&self.room, centres, stop);
        self.left = self.left.saturating_sub(relaxed.evaluations);
        relaxed
    }
}

/// Keeps the first n centres.
fn truncated(mut centres: Vec<Vector3<f64>>, n: usize) -> Vec<Vector3<f64>> {
    centres.truncate(n);
    centres
}
