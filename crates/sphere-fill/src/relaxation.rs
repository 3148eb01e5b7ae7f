//! Pushing overlapping spheres apart inside a body.

use crate::distance_grid::{Distance, DistanceGrid};
use crate::neighbours::Neighbours;
use nalgebra::Vector3;
use trimesh::SignedDistance;

/// Steps that the quasi-Newton method remembers; 4 to 12 take about equally long.
const MEMORY: usize = 6;

/// Farthest that a sphere goes in one step, radii: it cannot jump over another.
const LONGEST_STEP: f64 = 0.3;

/// Iterations between two checks for a stall.
const CHECKED_EVERY: usize = 20;

/// Share of the energy that may be left after those iterations.
///
/// A vanishing energy falls geometrically, a stuck one stays; at 0.97 no successful relaxation
/// was seen cut short.
const STALLED: f64 = 0.97;

/// The surface that spheres keep away from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wall<'a> {
    /// Interpolated distance: fast.
    Grid(&'a DistanceGrid),
    /// Exact distance where a sphere may touch.
    Exact {
        /// States which spheres may touch.
        grid: &'a DistanceGrid,
        /// Exact distance, m.
        distance: &'a SignedDistance,
        /// Sphere radius, m.
        radius: f64,
        /// Whether the body is so thin that a sphere may touch two walls that face each other.
        thin: bool,
    },
}

impl Wall<'_> {
    /// Signed distance and its gradient at a point, radii.
    pub(crate) fn at(&self, point: &Vector3<f64>) -> Distance {
        match self {
            Self::Grid(grid) => grid.at(point),
            Self::Exact {
                grid,
                distance,
                radius,
                ..
            } => {
                let rough = grid.at(point);
                // The grid is right to a few per cent near one radius from the wall.
                if rough.value < -1.2 {
                    return rough;
                }
                let found = distance.nearest(&(point * *radius));
                Distance {
                    value: found.distance / radius,
                    gradient: found.outward,
                }
            }
        }
    }
}

impl Wall<'_> {
    /// The wall that faces the nearest one, seen from a point inside a thin body: signed distance to its plane and the
    /// gradient, radii.
    ///
    /// The nearest distance alone has a ridge between two walls, where its gradient jumps: spheres that both walls squeeze
    /// would never leave. With both walls the energy is smooth there, and they slide to where the body is thicker.
    fn facing(&self, point: &Vector3<f64>, nearest: &Distance) -> Option<Distance> {
        let Self::Exact {
            distance,
            radius,
            thin: true,
            ..
        } = self
        else {
            return None;
        };
        if nearest.value >= 0.0 {
            return None;
        }
        let beyond = point - nearest.gradient * DEPTH;
        let found = distance.nearest(&(beyond * *radius));
        Some(Distance {
            value: (point - found.point / *radius).dot(&found.outward),
            gradient: found.outward,
        })
    }

    /// Energy of a centre and its gradient, radii² and radii.
    fn push(&self, centre: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let of = |distance: &Distance| {
            let overlap = (distance.value + DEPTH).max(0.0);
            (overlap * overlap, distance.gradient * (2.0 * overlap))
        };
        let nearest = self.at(centre);
        let (energy, gradient) = of(&nearest);
        let Some((more, slope)) = self.facing(centre, &nearest).as_ref().map(of) else {
            return (energy, gradient);
        };
        (energy + more, gradient + slope)
    }
}

/// What the spheres must keep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room<'a> {
    /// The surface.
    pub(crate) wall: Wall<'a>,
    /// Distance that centres keep from each other, radii.
    pub(crate) spacing: f64,
}

/// Distance that centres keep from the surface: one radius.
pub(crate) const DEPTH: f64 = 1.0;

/// A configuration and how far it is from being free of overlap.
#[derive(Debug, Clone)]
pub(crate) struct Relaxed {
    /// Centres, radii.
    pub(crate) centres: Vec<Vector3<f64>>,
    /// Sum of squared overlaps, radii².
    pub(crate) energy: f64,
    /// Evaluations of energy and gradient that were spent.
    pub(crate) evaluations: usize,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    /// Energy that counts as free of overlap, radii².
    pub(crate) energy: f64,
    /// Most evaluations.
    pub(crate) evaluations: usize,
}

/// Lowers the sum of squared overlaps until it vanishes, stalls, or the budget is spent.
///
/// # Formula
///
/// E = Σ max(0, spacing − |xᵢ − xⱼ|)² + Σ max(0, φ(xᵢ) + 1)² over pairs and spheres, φ the signed distance in
/// radii; minimised by limited-memory BFGS `[Nocedal1980]` with a halving line search.
pub(crate) fn relax(room: &Room<'_>, start: Vec<Vector3<f64>>, stop: Stop) -> Relaxed {
    let mut minimiser = Minimiser::new(room, start);
    let mut checkpoint = minimiser.energy;
    let mut iterations = 0;
    while minimiser.energy > stop.energy && minimiser.evaluations < stop.evaluations {
        if !minimiser.step() {
            break;
        }
        iterations += 1;
        if iterations % CHECKED_EVERY == 0 {
            if minimiser.energy > STALLED * checkpoint {
                break;
            }
            checkpoint = minimiser.energy;
        }
    }
    Relaxed {
        centres: minimiser.centres,
        energy: minimiser.energy,
        evaluations: minimiser.evaluations,
    }
}

/// Energy that each sphere has a part in, radii².
pub(crate) fn energy_of_each(room: &Room<'_>, centres: &[Vector3<f64>]) -> Vec<f64> {
    let wall = |centre| room.wall.push(centre).0;
    let mut energies: Vec<f64> = centres.iter().map(wall).collect();
    let mut neighbours = Neighbours::default();
    for &(i, j) in neighbours.within(centres, room.spacing) {
        let (i, j) = (i as usize, j as usize);
        let overlap = (room.spacing - (centres[i] - centres[j]).norm()).max(0.0);
        energies[i] += overlap * overlap;
        energies[j] += overlap * overlap;
    }
    energies
}

/// A step of the past: how the centres moved and how the gradient changed.
struct Secant {
    /// Step, radii.
    step: Vec<Vector3<f64>>,
    /// Change of the gradient, radii.
    change: Vec<Vector3<f64>>,
    /// 1 / (step · change).
    inverse: f64,
}

/// State of a minimisation.
struct Minimiser<'a> {
    room: &'a Room<'a>,
    neighbours: Neighbours,
    centres: Vec<Vector3<f64>>,
    gradient: Vec<Vector3<f64>>,
    energy: f64,
    evaluations: usize,
    /// Oldest first.
    history: Vec<Secant>,
}

impl<'a> Minimiser<'a> {
    fn new(room: &'a Room<'a>, centres: Vec<Vector3<f64>>) -> Self {
        let mut gradient = vec![Vector3::zeros(); centres.len()];
        let mut neighbours = Neighbours::default();
        let energy = evaluate(room, &mut neighbours, &centres, &mut gradient);
        Self {
            room,
            neighbours,
            centres,
            gradient,
            energy,
            evaluations: 1,
            history: Vec::with_capacity(MEMORY),
        }
    }

    /// Takes one descent step; false at a minimum.
    fn step(&mut self) -> bool {
        let mut direction = self.direction();
        if dot(&direction, &self.gradient) >= 0.0 {
            self.history.clear();
            direction = self.direction();
        }
        let slope = dot(&direction, &self.gradient);
        let longest = direction
            .iter()
            .map(Vector3::norm_squared)
            .fold(0.0, f64::max);
        let mut factor = (LONGEST_STEP / longest.sqrt().max(f64::MIN_POSITIVE)).min(1.0);
        let mut next = vec![Vector3::zeros(); self.centres.len()];
        for _ in 0..8 {
            let mut trial = self.centres.clone();
            add(&mut trial, &direction, factor);
            let energy = evaluate(self.room, &mut self.neighbours, &trial, &mut next);
            self.evaluations += 1;
            if energy <= self.energy + 1e-4 * factor * slope {
                self.remember(&trial, &next);
                self.centres = trial;
                self.gradient = next;
                self.energy = energy;
                return true;
            }
            factor *= 0.5;
        }
        let had_history = !self.history.is_empty();
        self.history.clear();
        had_history
    }

    /// Keeps the step to the trial if the energy curves upward along it.
    fn remember(&mut self, trial: &[Vector3<f64>], gradient: &[Vector3<f64>]) {
        let difference = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            a.iter().zip(b).map(|(a, b)| a - b).collect()
        };
        let step = difference(trial, &self.centres);
        let change = difference(gradient, &self.gradient);
        let product = dot(&step, &change);
        if product > 1e-14 * dot(&change, &change) {
            if self.history.len() == MEMORY {
                self.history.remove(0);
            }
            self.history.push(Secant {
                step,
                change,
                inverse: 1.0 / product,
            });
        }
    }

    /// Descent direction by the two-loop recursion.
    fn direction(&self) -> Vec<Vector3<f64>> {
        let mut direction: Vec<_> = self.gradient.iter().map(|g| -g).collect();
        let mut shares = Vec::with_capacity(MEMORY);
        for past in self.history.iter().rev() {
            let share = past.inverse * dot(&past.step, &direction);
            add(&mut direction, &past.change, -share);
            shares.push(share);
        }
        // Without history: a quarter of the gradient solves a lone contact of two spheres.
        let scale = self.history.last().map_or(0.25, |past| {
            1.0 / (past.inverse * dot(&past.change, &past.change))
        });
        for part in &mut direction {
            *part *= scale;
        }
        for (past, share) in self.history.iter().zip(shares.iter().rev()) {
            let back = past.inverse * dot(&past.change, &direction);
            add(&mut direction, &past.step, share - back);
        }
        direction
    }
}

/// Sum of squared overlaps, and its gradient.
fn evaluate(
    room: &Room<'_>,
    neighbours: &mut Neighbours,
    centres: &[Vector3<f64>],
    gradient: &mut [Vector3<f64>],
) -> f64 {
    let mut energy = 0.0;
    for (centre, slope) in centres.iter().zip(gradient.iter_mut()) {
        let (of_wall, push) = room.wall.push(centre);
        energy += of_wall;
        *slope = push;
    }
    let spacing = room.spacing;
    for &(i, j) in neighbours.within(centres, spacing) {
        let (i, j) = (i as usize, j as usize);
        let offset = centres[i] - centres[j];
        let squared = offset.norm_squared();
        if squared < spacing * spacing {
            // Coinciding centres have no direction to part in; they keep their energy.
            let length = squared.sqrt().max(f64::MIN_POSITIVE);
            let overlap = spacing - length;
            energy += overlap * overlap;
            let push = offset * (2.0 * overlap / length);
            gradient[i] -= push;
            gradient[j] += push;
        }
    }
    energy
}

/// Sum of products over all spheres.
fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn add(a: &mut [Vector3<f64>], b: &[Vector3<f64>], factor: f64) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b * factor);
}
