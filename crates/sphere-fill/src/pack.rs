//! Dense packing of equal spheres without overlap.

use crate::distance_grid::DistanceGrid;
use crate::holes::deepest_holes;
use crate::lattice::best_lattice;
use crate::neighbours::Neighbours;
use crate::relaxation::{DEPTH, Relaxed, Room, Stop, Wall, energy_of_each, relax};
use crate::{Body, Error, FillSettings, Place};
use clump::Sphere;
use nalgebra::Vector3;
use random_stream::Stream;

/// Sum of squared overlaps (radii²) that counts as none: no overlap is above 1e-4 radii.
const FREE: f64 = 1e-8;

/// The same for the last relaxation against the exact surface.
const FREE_AT_LAST: f64 = 1e-9;

/// Evaluations of one relaxation, at most.
const LONGEST: usize = 2000;

/// Sphere evaluations at effort 1: 30 000 evaluations of 150 spheres.
const WORK: f64 = 4.5e6;

/// Relocations without gain before a new start.
const PATIENCE: usize = 60;

/// Largest overlap of a result, radii: 0.1 %.
const OVERLAP_TOLERANCE: f64 = 1e-3;

/// Largest protrusion of a result, radii: 1 %.
const PROTRUSION_TOLERANCE: f64 = 1e-2;

/// Equal spheres, dense and without overlap, inside the mesh.
///
/// # Method
///
/// Random centres are relaxed ([energy minimisation](crate#packing)); spheres are then dropped
/// into the deepest holes and the whole relaxed again, as long as all overlap can be removed.
/// When it cannot, one of the most squeezed spheres is moved to another deep hole, and the
/// move kept when the energy falls; after 60 moves without gain a new random start is made,
/// until the work is spent. The largest configuration wins; a best-placed lattice is grown the
/// same way when it holds more, as it does for bodies many spheres across. At last the spheres
/// are relaxed against the exact surface and checked.
///
/// With a count N the same search stops at N spheres, and the centres are then spread: their
/// mutual distance is raised as far as N centres can have it while each stays one radius below
/// the surface. Spare room is so shared evenly, and the surface is covered as evenly as N
/// spheres can cover it. A single sphere stands where the body is thickest.
///
/// # Source
///
/// The relocation of squeezed spheres into vacancies is the core of `[Huang2011]` for equal
/// spheres in a sphere; the energy is that of soft-disk packings `[Ohern2003]`.
#[derive(Debug, Clone, Copy)]
pub struct Pack;

impl Place for Pack {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let grid = body.grid(settings);
        let room = Room {
            wall: Wall::Grid(&grid),
            spacing: 2.0,
        };
        let found = if settings.count == Some(1) {
            Vec::new()
        } else {
            Search::new(body, settings, &grid, room).run()
        };
        let spread = match settings.count {
            Some(count) if found.len() == count => spread(room, found),
            _ => Spread {
                centres: found,
                spacing: 2.0,
            },
        };
        let mut centres = finish(body, settings, &grid, spread);
        if centres.len() <= 1 {
            // The radius was checked: one sphere fits where the body is thickest.
            centres = vec![body.inscribed_centre / settings.radius];
        }
        if let Some(asked) = settings.count.filter(|&count| centres.len() < count) {
            return Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked,
                reached: centres.len(),
                radius_mm: settings.radius * 1e3,
            });
        }
        Ok(in_metres(&centres, settings.radius))
    }
}

/// Spheres of centres in radii.
pub(crate) fn in_metres(centres: &[Vector3<f64>], radius: f64) -> Vec<Sphere> {
    let sphere = |centre: &Vector3<f64>| Sphere {
        centre: centre * radius,
        radius,
    };
    centres.iter().map(sphere).collect()
}

/// State of the search for the largest configuration.
struct Search<'a> {
    room: Room<'a>,
    grid: &'a DistanceGrid,
    /// Places where a sphere may be dropped, radii.
    candidates: Vec<Vector3<f64>>,
    stream: Stream,
    /// Number of spheres that ends the search.
    target: usize,
    /// Spheres of a random start.
    first: usize,
    /// Evaluations left.
    left: usize,
}

impl<'a> Search<'a> {
    fn new(
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
            left: whole((settings.effort * WORK / expected).clamp(400.0, 1e7)),
        }
    }

    /// Searches until the target or the end of the work; gives the largest free configuration.
    fn run(&mut self) -> Vec<Vector3<f64>> {
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
            return truncated(lattice, self.target);
        }
        best
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
    fn relocate_one(&mut self, centres: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
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
    fn relax(&mut self, centres: Vec<Vector3<f64>>) -> Relaxed {
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

/// Centres and the distance that they keep, radii.
struct Spread {
    centres: Vec<Vector3<f64>>,
    spacing: f64,
}

/// Raises the distance between centres as far as it goes, to about 0.2 %.
fn spread(room: Room<'_>, centres: Vec<Vector3<f64>>) -> Spread {
    let mut best = Spread {
        centres,
        spacing: room.spacing,
    };
    let stop = Stop {
        energy: FREE,
        evaluations: LONGEST,
    };
    let mut growth = 0.08;
    while growth > 2e-3 {
        let spacing = best.spacing * (1.0 + growth);
        let relaxed = relax(&Room { spacing, ..room }, best.centres.clone(), stop);
        if relaxed.energy <= FREE {
            best.centres = relaxed.centres;
            best.spacing = spacing;
        } else {
            growth *= 0.5;
        }
    }
    best
}

/// Relaxes against the exact surface and drops what is still outside the tolerances.
fn finish(
    body: &Body<'_>,
    settings: &FillSettings,
    grid: &DistanceGrid,
    spread: Spread,
) -> Vec<Vector3<f64>> {
    let exact = Wall::Exact {
        grid,
        distance: &body.distance,
        radius: settings.radius,
    };
    // A spread filling has room to spare: keeping a little less of it makes the end easy.
    let room = Room {
        wall: exact,
        spacing: (spread.spacing * 0.998).max(2.0),
    };
    let stop = Stop {
        energy: FREE_AT_LAST,
        evaluations: LONGEST / 4,
    };
    let centres = relax(&room, spread.centres, stop).centres;
    within_tolerance(&exact, &centres)
}

/// Keeps the centres that stand out by at most the tolerance, and of each pair that overlaps by
/// more than the tolerance the first one.
pub(crate) fn within_tolerance(wall: &Wall<'_>, centres: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let protrudes = |centre| wall.at(centre).value + DEPTH > PROTRUSION_TOLERANCE;
    let mut dropped: Vec<bool> = centres.iter().map(protrudes).collect();
    let mut neighbours = Neighbours::default();
    for &(i, j) in neighbours.within(centres, 2.0) {
        let (i, j) = (i as usize, j as usize);
        let overlap = 2.0 - (centres[i] - centres[j]).norm();
        if overlap > OVERLAP_TOLERANCE && !dropped[i] {
            dropped[j] = true;
        }
    }
    let kept = centres.iter().zip(dropped).filter(|(_, dropped)| !dropped);
    kept.map(|(centre, _)| *centre).collect()
}
