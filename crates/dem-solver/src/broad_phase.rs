//! Pairs of bodies whose bounding spheres are near, found on a grid of cells.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::lanes::{LANES, set_bits, squares};
use crate::periodic::Period;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x16};
use nalgebra::Vector3;
use std::ops::Range;

/// Buffers of the grid, kept between calls.
#[derive(Debug, Clone, Default)]
pub(crate) struct BodyGrid {
    /// Cell of each body.
    cell_of: Vec<u32>,
    /// First entry of each cell in `order`.
    start: Vec<u32>,
    /// Bodies sorted by cell, rising index within a cell.
    order: Vec<u32>,
    /// Next free entry of each cell in `order`, while it is filled.
    next: Vec<u32>,
    /// x, y, z of the bodies in `order` against the lower corner of all, m, and room for one
    /// more group at the end.
    sorted: [Vec<f32>; 3],
    /// Positions between the periodic sides, by body, m.
    positions: Vec<Vector3<f64>>,
    /// Periodic sides.
    period: Period,
    /// Lower and upper corner of all positions, m.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Largest radius, m.
    largest: f64,
    /// Margin, m.
    margin: f64,
    /// Size of a cell, m.
    size: f64,
    /// Number of cells along each axis.
    counts: [usize; 3],
}

/// Most cells of a grid for each body; beyond it the cells grow. A packed bed needs about one, a
/// loose one ten; with twice the number a body that flies away costs twice the memory.
const MOST_CELLS_PER_BODY: usize = 64;

impl BodyGrid {
    /// Sorts the bodies into cells; positions in m, finite; `radii` by body, m.
    pub(crate) fn sort(
        &mut self,
        positions: &[Vector3<f64>],
        radii: &[f64],
        margin: f64,
        period: Period,
    ) {
        self.period = period;
        let mut inside = std::mem::take(&mut self.positions);
        inside.clear();
        inside.extend(positions.iter().map(|p| period.inside(p)));
        let positions = inside.as_slice();
        self.largest = radii.iter().copied().fold(0.0, f64::max);
        self.low = fold(positions, f64::INFINITY, f64::min);
        self.high = fold(positions, f64::NEG_INFINITY, f64::max);
        self.margin = margin;
        let most = MOST_CELLS_PER_BODY
            .saturating_mul(positions.len())
            .clamp(1 << 12, 1 << 28);
        self.size = 2.0 * self.largest + margin;
        // A body that flies away stretches the box of all: the cells grow with it, and the memory does not.
        loop {
            let extent = self.high - self.low;
            self.counts = std::array::from_fn(|k| cell(extent[k], self.size) + 1);
            let total = self
                .counts
                .iter()
                .fold(1_usize, |n, &c| n.saturating_mul(c));
            if total <= most {
                break;
            }
            self.size *= 2.0;
        }
        self.fill_cells(positions);
        self.positions = inside;
    }

    /// Calls `found` with each body i of a range and its partners j < i, in rising order: the
    /// bodies closer than the sum of both radii and the margin, in any image. Radii as in [`Self::sort`].
    pub(crate) fn for_each_body(
        &self,
        level: Level,
        range: Range<usize>,
        radii: &[f64],
        partners: &mut Vec<u32>,
        mut found: impl FnMut(usize, &[u32]),
    ) {
        // Single precision finds those that may be near; each of them is then looked at again.
        let rounding = 1e-6 * ((self.high - self.low).amax() + self.size);
        for i in range {
            partners.clear();
            let reach = radii[i] + self.margin;
            let farthest = reach + self.largest + rounding;
            let near = single_square(farthest);
            for p in self.period.images(self.positions[i], farthest) {
                let centre = single(&(p - self.low));
                // A cell is as wide as the largest body and the margin together, so that partners are in the 27 cells about it.
                for_each_row(self.cell_of_point(&p), self.counts, |first, last| {
                    let range = self.start[first] as usize..self.start[last + 1] as usize;
                    dispatch!(level, simd => self.near(simd, range, &centre, near, |j| {
                        let other = j as usize;
                        let limit = reach + radii[other];
                        if other < i && (self.positions[other] - p).norm_squared() < limit * limit {
                            partners.push(j);
                        }
                    }));
                });
            }
            partners.sort_unstable();
            // Two images of a body may be near.
            partners.dedup();
            found(i, partners);
        }
    }

    /// Coordinates of the cell of a point.
    fn cell_of_point(&self, p: &Vector3<f64>) -> [usize; 3] {
        std::array::from_fn(|k| cell(p[k] - self.low[k], self.size).min(self.counts[k] - 1))
    }

    /// Calls `found` with the bodies of a range of `order` closer to a point than a limit (m²).
    #[inline(always)]
    fn near<S: Simd>(
        &self,
        simd: S,
        range: Range<usize>,
        centre: &[f32; 3],
        limit: f32,
        mut found: impl FnMut(u32),
    ) {
        for first in range.clone().step_by(LANES) {
            let block = |axis: usize| &self.sorted[axis][first..first + LANES];
            let between = [
                f32x16::from_slice(simd, block(0)) - centre[0],
                f32x16::from_slice(simd, block(1)) - centre[1],
                f32x16::from_slice(simd, block(2)) - centre[2],
            ];
            let used = (1_u64 << (range.end - first).min(LANES)) - 1;
            // What is not a number counts as near: the caller looks again in double precision.
            for lane in set_bits(!squares(&between).simd_gt(limit).to_bitmask() & used) {
                found(self.order[first + lane]);
            }
        }
    }

    /// Sorts the bodies by cell (counting sort).
    fn fill_cells(&mut self, positions: &[Vector3<f64>]) {
        let total = self.counts.iter().product::<usize>();
        self.cell_of.clear();
        self.start.clear();
        self.start.resize(total + 1, 0);
        for p in positions {
            let index = flat(self.cell_of_point(p), self.counts);
            self.cell_of.push(u32::try_from(index).unwrap_or(u32::MAX));
            self.start[index + 1] += 1;
        }
        for k in 0..total {
            self.start[k + 1] += self.start[k];
        }
        self.order.clear();
        self.order.resize(positions.len(), 0);
        self.next.clone_from(&self.start);
        for axis in &mut self.sorted {
            axis.clear();
            axis.resize(positions.len() + LANES, 0.0);
        }
        for (i, &index) in self.cell_of.iter().enumerate() {
            let place = &mut self.next[index as usize];
            self.order[*place as usize] = u32::try_from(i).unwrap_or(u32::MAX);
            let centre = single(&(positions[i] - self.low));
            for (axis, coordinate) in self.sorted.iter_mut().zip(centre) {
                axis[*place as usize] = coordinate;
            }
            *place += 1;
        }
    }
}

/// Component-wise extreme of the positions.
fn fold(positions: &[Vector3<f64>], start: f64, pick: fn(f64, f64) -> f64) -> Vector3<f64> {
    positions
        .iter()
        .fold(Vector3::repeat(start), |a, p| a.zip_map(p, pick))
}

/// Number of whole cells in a length; a negative or undefined length gives 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is clamped to the range of the index first"
)]
fn cell(length: f64, size: f64) -> usize {
    (length / size).clamp(0.0, 1e9) as usize
}

/// Index of a cell.
fn flat(c: [usize; 3], counts: [usize; 3]) -> usize {
    (c[0] * counts[1] + c[1]) * counts[2] + c[2]
}

/// Calls `visit` with the first and the last index of each row of cells about `c`: up to nine
/// rows of up to three cells, which lie one after the other.
fn for_each_row(c: [usize; 3], counts: [usize; 3], mut visit: impl FnMut(usize, usize)) {
    let range = |k: usize| c[k].saturating_sub(1)..=(c[k] + 1).min(counts[k] - 1);
    for x in range(0) {
        for y in range(1) {
            let row = |z: usize| flat([x, y, z], counts);
            visit(row(*range(2).start()), row(*range(2).end()));
        }
    }
}

/// A vector in single precision.
#[expect(
    clippy::cast_possible_truncation,
    reason = "covered by the rounding that is added to the reach"
)]
fn single(v: &Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// The square of a length in single precision.
#[expect(
    clippy::cast_possible_truncation,
    reason = "covered by the rounding that is added to the reach"
)]
fn single_square(length: f64) -> f32 {
    (length * length) as f32
}

#[cfg(test)]
mod tests {
    use super::BodyGrid;
    use crate::periodic::Period;
    use fearless_simd::Level;
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    /// All pairs within a margin of 0.02.
    fn pairs(
        grid: &mut BodyGrid,
        positions: &[Vector3<f64>],
        radii: &[f64],
        period: Period,
    ) -> Vec<(usize, usize)> {
        let mut found = Vec::new();
        grid.sort(positions, radii, 0.02, period);
        let (level, all) = (Level::new(), 0..positions.len());
        grid.for_each_body(level, all, radii, &mut Vec::new(), |i, partners| {
            found.extend(partners.iter().map(|&j| (j as usize, i)));
        });
        found
    }

    /// The grid finds exactly the pairs that a double loop finds, for mixed sizes; between periodic sides, in the nearest of all images, wherever
    /// the bodies have gone.
    #[test]
    fn grid_finds_the_pairs_of_a_double_loop() {
        let mut stream = Stream::new(1, "grid");
        let radii: Vec<f64> = (0..300).map(|_| stream.between(0.01, 0.06)).collect();
        for (period, spread) in [
            (Period::default(), 1.0),
            (Period::between(0.1, 0.36, 0.24).unwrap(), 2.0),
        ] {
            let positions: Vec<_> = (0..300)
                .map(|_| {
                    Vector3::from_fn(|k, _| stream.uniform() * if k == 2 { spread } else { 1.0 })
                })
                .collect();
            let found = pairs(&mut BodyGrid::default(), &positions, &radii, period);
            let mut expected = Vec::new();
            for j in 0..300 {
                for i in 0..j {
                    let images = (-9..=9).map(|k| {
                        let shift = if period.is_some() {
                            0.26 * f64::from(k)
                        } else {
                            0.0
                        };
                        (positions[i] - positions[j] + Vector3::z() * shift).norm()
                    });
                    if images.fold(f64::INFINITY, f64::min) < radii[i] + radii[j] + 0.02 {
                        expected.push((i, j));
                    }
                }
            }
            assert!(
                expected.len() > 100,
                "the test has too few pairs to mean anything"
            );
            assert_eq!(found, expected);
        }
    }

    /// One body at any finite distance neither fills the memory nor stops the search, and the
    /// pair of those that stayed is still found.
    #[test]
    fn body_far_away_costs_no_memory() {
        for far in [1e3, 1e12, 1e155, 1e308] {
            let mut grid = BodyGrid::default();
            let positions = [
                Vector3::repeat(-far),
                Vector3::zeros(),
                Vector3::x() * 0.1,
                Vector3::new(far, -far, 0.0),
            ];
            let found = pairs(&mut grid, &positions, &[0.06; 4], Period::default());
            assert_eq!(found, [(1, 2)], "at {far} m");
            assert!(
                grid.start.len() < 1 << 13,
                "{} cells at {far} m",
                grid.start.len()
            );
        }
    }

    #[test]
    fn grid_of_no_body_has_no_pair() {
        assert_eq!(
            pairs(&mut BodyGrid::default(), &[], &[], Period::default()),
            []
        );
    }
}
