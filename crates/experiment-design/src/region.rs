//! Region of the runs of a design: ranges, levels, and linear constraints on them.

use nalgebra::{DMatrix, DVector};
use probability::random_stream::Stream;

use crate::Error;

/// Largest violation of a constraint through rounding, relative to the sum of |weights|.
const SLACK: f64 = 1e-9;
/// Pivot below which planes count as parallel; weights sum to one or so.
const PARALLEL: f64 = 1e-9;
/// Random starts of the search for a point that keeps all constraints.
const STARTS: usize = 500;
/// Steps of each start; the relaxation ends in a few where the region has an inside.
const STEPS: usize = 500;
/// Most corners whose middles are taken as well.
const MOST_PAIRED: usize = 64;
/// Most sets of bounds whose corner is looked for.
const MOST_CORNERS: usize = 200_000;

/// The values that one coordinate of a run may take, coded.
#[derive(Debug, Clone, PartialEq)]
pub enum Coordinate {
    /// All from -1 to +1.
    Range,
    /// These alone.
    Levels(Vec<f64>),
}

/// A linear constraint on coded values: `sum(weights x) <= bound`.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// A weight for each coordinate.
    pub weights: Vec<f64>,
    /// Greatest value of the sum.
    pub bound: f64,
}

impl Constraint {
    /// Distance to the bound at a point; negative outside.
    fn room(&self, x: &[f64]) -> f64 {
        let sum: f64 = self.weights.iter().zip(x).map(|(w, x)| w * x).sum();
        self.bound - sum
    }

    /// Tolerance for rounding.
    fn slack(&self) -> f64 {
        SLACK * self.weights.iter().map(|w| w.abs()).sum::<f64>()
    }
}

/// The allowed points of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Allowed values of each coordinate.
    coordinates: Vec<Coordinate>,
    /// Constraints on all coordinates together.
    constraints: Vec<Constraint>,
    /// A point of the region.
    inside: Vec<f64>,
}

impl Region {
    /// The whole box from -1 to +1 of `k` factors.
    pub fn cube(k: usize) -> Self {
        Self {
            coordinates: vec![Coordinate::Range; k],
            constraints: Vec::new(),
            inside: vec![0.0; k],
        }
    }

    /// A region of given coordinates and constraints.
    ///
    /// # Errors
    /// [`Error::NoRoom`] if no point is found that keeps all of them; [`Error::BadRun`] for a constraint with another
    /// number of weights, or one that is not finite.
    pub fn new(coordinates: Vec<Coordinate>, constraints: Vec<Constraint>) -> Result<Self, Error> {
        let k = coordinates.len();
        let whole = |c: &Constraint| {
            c.weights.len() == k && c.bound.is_finite() && c.weights.iter().all(|w| w.is_finite())
        };
        if let Some(i) = constraints.iter().position(|c| !whole(c)) {
            return Err(Error::BadRun {
                run: i + 1,
                columns: k,
            });
        }
        let mut region = Self {
            coordinates,
            constraints,
            inside: Vec::new(),
        };
        region.inside = region.search().ok_or(Error::NoRoom)?;
        Ok(region)
    }

    /// Number of coordinates.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Whether there are no coordinates.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// A point of it.
    pub(crate) fn inside(&self) -> &[f64] {
        &self.inside
    }

    /// Whether it is the whole box.
    pub(crate) fn is_cube(&self) -> bool {
        self.constraints.is_empty() && self.coordinates.iter().all(|c| *c == Coordinate::Range)
    }

    /// Whether a point keeps the constraints; its coordinates are taken as allowed one by one.
    pub fn holds(&self, x: &[f64]) -> bool {
        let kept = |c: &Constraint| c.room(x) >= -c.slack();
        self.constraints.iter().all(kept)
    }

    /// Whether a value is one that the coordinate may take.
    pub fn allows(&self, j: usize, value: f64) -> bool {
        match &self.coordinates[j] {
            Coordinate::Range => value.abs() <= 1.0 + SLACK,
            Coordinate::Levels(levels) => levels.iter().any(|l| (l - value).abs() <= SLACK),
        }
    }

    /// The values worth trying for one coordinate, the others as in `x`: its levels; -1, 0 and +1 of a free range; the
    /// quarters of its constrained range, and 0 if the constraints allow it.
    pub(crate) fn values(&self, x: &[f64], j: usize) -> Vec<f64> {
        match &self.coordinates[j] {
            Coordinate::Levels(levels) => {
                let mut at = x.to_vec();
                let mut kept = levels.clone();
                kept.retain(|level| {
                    at[j] = *level;
                    self.holds(&at)
                });
                kept
            }
            Coordinate::Range => {
                let [low, high] = self.interval(x, j);
                let parts = if self.constraints.is_empty() { 2 } else { 4 };
                let value = |i: u32| tidy(low + (high - low) * f64::from(i) / f64::from(parts));
                let mut values: Vec<f64> = (0..=parts).map(value).collect();
                if low < 0.0 && high > 0.0 && !values.contains(&0.0) {
                    values.push(0.0);
                }
                values
            }
        }
    }

    /// Range of one coordinate within the constraints, with the others as in `x`; only its own value if the range is
    /// smaller than rounding.
    fn interval(&self, x: &[f64], j: usize) -> [f64; 2] {
        let mut ends = [-1.0_f64, 1.0];
        for c in self.constraints.iter().filter(|c| c.weights[j] != 0.0) {
            let limit = x[j] + c.room(x) / c.weights[j];
            if c.weights[j] > 0.0 {
                ends[1] = ends[1].min(limit);
            } else {
                ends[0] = ends[0].max(limit);
            }
        }
        if ends[0] <= ends[1] {
            ends
        } else {
            [x[j], x[j]]
        }
    }

    /// Moves each coordinate in turn to a random one of its values, the others held (Gibbs sampling of the region).
    fn step(&self, x: &mut [f64], stream: &mut Stream) {
        for j in 0..x.len() {
            x[j] = match &self.coordinates[j] {
                Coordinate::Range => {
                    let [low, high] = self.interval(x, j);
                    stream.between(low, high)
                }
                Coordinate::Levels(_) => {
                    let values = self.values(x, j);
                    match values.len() {
                        0 => x[j],
                        n => values[stream.below(n)],
                    }
                }
            };
        }
    }

    /// `n` random points, evenly spread over the region in the limit of many.
    ///
    /// # Source
    /// Gibbs sampling: `[Geman1984]`.
    pub fn sample(&self, n: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut stream = Stream::new(seed, "points of the region");
        let mut x = self.inside.clone();
        for _ in 0..100 {
            self.step(&mut x, &mut stream);
        }
        let next = |_| {
            self.step(&mut x, &mut stream);
            x.clone()
        };
        (0..n).map(next).collect()
    }

    /// A point that keeps all constraints: from random points, steps across the planes that they break.
    ///
    /// # Source
    /// Relaxation for linear inequalities: `[Agmon1954]`.
    fn search(&self) -> Option<Vec<f64>> {
        let mut stream = Stream::new(1, "point of the region");
        let free = |j: usize| self.coordinates[j] == Coordinate::Range;
        for start in 0..STARTS {
            let mut x: Vec<f64> = self
                .coordinates
                .iter()
                .map(|coordinate| match coordinate {
                    Coordinate::Range if start == 0 => 0.0,
                    Coordinate::Range => stream.between(-1.0, 1.0),
                    Coordinate::Levels(levels) => levels[stream.below(levels.len())],
                })
                .collect();
            for _ in 0..STEPS {
                let breach = |c: &&Constraint| c.room(&x) < -c.slack();
                let Some(broken) = self.constraints.iter().find(breach) else {
                    return Some(x);
                };
                let moved = (0..x.len()).filter(|j| free(*j));
                let norm: f64 = moved.map(|j| broken.weights[j].powi(2)).sum();
                if norm == 0.0 {
                    break;
                }
                // A little beyond the plane, so that an end is reached where there is an inside.
                let by = 1.5 * broken.room(&x) / norm;
                for j in (0..x.len()).filter(|j| free(*j)) {
                    x[j] = (x[j] + by * broken.weights[j]).clamp(-1.0, 1.0);
                }
            }
        }
        None
    }

    /// Runs worth trying as a whole: the corners, and the middles between any two of them.
    pub(crate) fn candidates(&self) -> Vec<Vec<f64>> {
        let mut candidates = self.corners();
        let corners = candidates.clone();
        if corners.len() > MOST_PAIRED {
            return candidates;
        }
        for (i, a) in corners.iter().enumerate() {
            for b in &corners[..i] {
                let middle = a.iter().zip(b).map(|(a, b)| tidy(a / 2.0 + b / 2.0));
                let middle: Vec<f64> = middle.collect();
                let allowed = (0..middle.len()).all(|j| self.allows(j, middle[j]));
                if allowed && !candidates.contains(&middle) {
                    candidates.push(middle);
                }
            }
        }
        candidates
    }

    /// The corners of the region: points at which as many bounds and constraints as there are coordinates hold with
    /// equality, levels counting as bounds. Empty if there are too many to search, and for the
    /// whole box, whose corners need no search.
    pub(crate) fn corners(&self) -> Vec<Vec<f64>> {
        if self.constraints.is_empty() {
            return Vec::new();
        }
        let choices: Vec<Vec<Option<f64>>> = self
            .coordinates
            .iter()
            .map(|coordinate| match coordinate {
                Coordinate::Range => vec![Some(-1.0), Some(1.0), None],
                Coordinate::Levels(levels) => levels.iter().copied().map(Some).collect(),
            })
            .collect();
        let count = choices
            .iter()
            .try_fold(1_usize, |n, c| n.checked_mul(c.len()))
            .and_then(|n| n.checked_mul(1 << self.constraints.len().min(30)));
        if count.is_none_or(|n| n > MOST_CORNERS) {
            return Vec::new();
        }
        let mut corners: Vec<Vec<f64>> = Vec::new();
        let mut chosen = vec![0_usize; choices.len()];
        loop {
            let at: Vec<Option<f64>> = chosen.iter().zip(&choices).map(|(i, c)| c[*i]).collect();
            for corner in self.completed(&at) {
                let near =
                    |other: &Vec<f64>| other.iter().zip(&corner).all(|(a, b)| (a - b).abs() < 1e-7);
                if !corners.iter().any(near) {
                    corners.push(corner);
                }
            }
            // The next set of choices, as a number with a digit for each coordinate.
            let Some(place) = (0..chosen.len()).find(|j| chosen[*j] + 1 < choices[*j].len()) else {
                return corners;
            };
            chosen[..place].fill(0);
            chosen[place] += 1;
        }
    }

    /// The points of the region whose missing coordinates follow from as many constraints held with equality.
    fn completed(&self, at: &[Option<f64>]) -> Vec<Vec<f64>> {
        let free: Vec<usize> = (0..at.len()).filter(|j| at[*j].is_none()).collect();
        let m = self.constraints.len();
        let sets = (0_usize..1 << m).filter(|set| set.count_ones() as usize == free.len());
        let solve = |set: usize| -> Option<Vec<f64>> {
            let active = (0..m)
                .filter(|i| set >> i & 1 == 1)
                .map(|i| &self.constraints[i]);
            let fixed: Vec<f64> = at.iter().map(|value| value.unwrap_or(0.0)).collect();
            let active: Vec<&Constraint> = active.collect();
            let mut x = fixed;
            for (j, value) in free.iter().zip(meeting(&active, &free, &x)?) {
                x[*j] = tidy(value);
            }
            let inside = free.iter().all(|j| x[*j].abs() <= 1.0 + SLACK) && self.holds(&x);
            inside.then_some(x)
        };
        sets.filter_map(solve).collect()
    }
}

/// A coded value without the last digits, which are rounding: runs at one corner are repeats of each other.
fn tidy(x: f64) -> f64 {
    // Adding zero makes -0 the 0 that it is.
    (x * 1e12).round() / 1e12 + 0.0
}

/// Where the planes of constraints meet, as values of the free coordinates instead of those of `x`, one for each plane;
/// `None` for planes that are parallel within rounding.
fn meeting(active: &[&Constraint], free: &[usize], x: &[f64]) -> Option<Vec<f64>> {
    let n = free.len();
    if n == 0 {
        return Some(Vec::new());
    }
    let lu = DMatrix::from_fn(n, n, |i, j| active[i].weights[free[j]]).lu();
    if lu.u().diagonal().iter().any(|pivot| pivot.abs() < PARALLEL) {
        return None;
    }
    let rooms = active.iter().map(|c| c.room(x));
    let solved = lu.solve(&DVector::from_iterator(n, rooms))?;
    Some(solved.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::{Constraint, Coordinate, Region};
    use crate::Error;

    /// x + y + z <= 0, over the box.
    fn cut_cube() -> Region {
        let constraint = Constraint {
            weights: vec![1.0; 3],
            bound: 0.0,
        };
        Region::new(vec![Coordinate::Range; 3], vec![constraint]).unwrap()
    }

    /// The plane through the middle of a cube cuts it in a hexagon: 4 corners of the cube are left (those with a sum
    /// below zero), and 6 middles of edges come with it.
    #[test]
    fn the_corners_of_a_cut_cube_are_those_of_geometry() {
        let mut corners = cut_cube().corners();
        assert_eq!(corners.len(), 10, "{corners:?}");
        corners.retain(|x| x.contains(&0.0));
        assert_eq!(corners.len(), 6);
        for corner in corners {
            assert!(corner.iter().sum::<f64>().abs() < 1e-12, "{corner:?}");
        }
    }

    /// Half of the cube by symmetry: the mean of x over x + y + z <= 0 is -E|x + y + z| / 3 = -13/48 (the sum of three
    /// uniform numbers on -1..1 has E|s| = 13/16). The standard error of 20 000 correlated points is below 0.01.
    #[test]
    fn points_are_spread_evenly_over_the_region() {
        let region = cut_cube();
        let points = region.sample(20_000, 3);
        assert!(points.iter().all(|x| region.holds(x)));
        for j in 0..3 {
            let mean = points.iter().map(|x| x[j]).sum::<f64>() / 20_000.0;
            assert!((mean + 13.0 / 48.0).abs() < 0.03, "{mean}");
        }
        assert_eq!(points, region.sample(20_000, 3));
    }

    /// Levels stay levels, also where constraints meet them, and a region without a point is refused.
    #[test]
    fn levels_are_kept_and_empty_regions_refused() {
        let levels = Coordinate::Levels(vec![-1.0, 0.2, 1.0]);
        let below = |bound: f64| Constraint {
            weights: vec![1.0, 1.0],
            bound,
        };
        let coordinates = vec![levels, Coordinate::Range];
        let region = Region::new(coordinates.clone(), vec![below(0.0)]).unwrap();
        assert_eq!(region.values(&[0.2, -0.5], 0), [-1.0, 0.2]);
        assert_eq!(
            region.values(&[0.2, -0.5], 1),
            [-1.0, -0.8, -0.6, -0.4, -0.2]
        );
        assert!(region.sample(100, 1).iter().all(|x| region.allows(0, x[0])));
        assert_eq!(
            Region::new(coordinates, vec![below(-2.5)]),
            Err(Error::NoRoom)
        );
    }

    /// A corner that holds a fifth of a millionth of the box (x + y + z + u >= 3.9: 0.1^4 / 4! of 2^4): no random point
    /// finds it, steps across the plane do.
    #[test]
    fn a_region_in_a_far_corner_is_found() {
        let constraint = Constraint {
            weights: vec![-1.0; 4],
            bound: -3.9,
        };
        let region = Region::new(vec![Coordinate::Range; 4], vec![constraint]).unwrap();
        assert!(region.holds(region.inside()));
        assert_eq!(region.corners().len(), 5);
    }
}
