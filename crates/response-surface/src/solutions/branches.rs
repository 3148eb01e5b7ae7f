//! The connected parts of the set of solutions.

use serde::{Deserialize, Serialize};

use crate::Fit;
use crate::surface::quadratic::Quadratic;

/// Greatest number of nodes of the grid; it sets how fine the grid is for many factors.
const MOST_NODES: usize = 60_000;

/// A connected part of the set of solutions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// A solution of this part near its middle, units of the factors.
    pub example: Vec<f64>,
    /// Share of the cells of the grid that this part passes through.
    pub share: f64,
    /// Least and greatest value of each factor on the part, units of the factors, to the width of a
    /// cell.
    pub ranges: Vec<[f64; 2]>,
}

/// The connected parts, largest first; none for more factors than a grid can show (7).
///
/// The box is cut into cells; a cell whose corners lie on both sides of the target is on the set, and
/// cells that share a face belong to one part. Parts closer than a cell count as one, and a part that
/// lies within one cell is not seen.
pub(crate) fn branches(fit: &Fit, quadratic: &Quadratic, target: f64) -> Option<Vec<Branch>> {
    let k = fit.factors.len();
    let nodes = nodes_along(k)?;
    let grid = CellGrid {
        k,
        cells: nodes - 1,
    };
    let value = |x: &[f64]| quadratic.value(x) - target;
    let signs: Vec<bool> = (0..nodes.pow(u32::try_from(k).ok()?))
        .map(|i| value(&grid.point(i, nodes)) > 0.0)
        .collect();
    let crossed: Vec<bool> = (0..grid.count())
        .map(|cell| grid.is_crossed(cell, &signs))
        .collect();
    let mut part = vec![0; crossed.len()];
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let starts: Vec<usize> = (0..crossed.len()).filter(|&cell| crossed[cell]).collect();
    for start in starts {
        if part[start] != 0 {
            continue;
        }
        let mut members = Vec::new();
        let mut open = vec![start];
        part[start] = parts.len() + 1;
        while let Some(cell) = open.pop() {
            members.push(cell);
            for neighbour in grid.neighbours(cell) {
                if crossed[neighbour] && part[neighbour] == 0 {
                    part[neighbour] = parts.len() + 1;
                    open.push(neighbour);
                }
            }
        }
        parts.push(members);
    }
    parts.sort_by_key(|members| std::cmp::Reverse(members.len()));
    let all = grid.count() as f64;
    Some(
        parts
            .iter()
            .map(|members| {
                let coded = grid.ranges(members);
                let natural = |j: usize| coded[j].map(|x| fit.factors[j].natural(x));
                Branch {
                    example: fit.natural(&grid.example(members, &signs, &value)),
                    share: members.len() as f64 / all,
                    ranges: (0..k).map(natural).collect(),
                }
            })
            .collect(),
    )
}

/// Nodes along each factor: as many as the limit allows, at least 4 and at most 401.
fn nodes_along(k: usize) -> Option<usize> {
    let power = u32::try_from(k).ok()?;
    let fits = |n: &usize| n.checked_pow(power).is_some_and(|all| all <= MOST_NODES);
    (4..=401).rev().find(fits)
}

/// Cells of the box, numbered with the first factor fastest.
struct CellGrid {
    /// Number of factors.
    k: usize,
    /// Cells along each factor.
    cells: usize,
}

impl CellGrid {
    /// Number of cells.
    fn count(&self) -> usize {
        (0..self.k).fold(1, |count, _| count * self.cells)
    }

    /// Digits of a number to a base, one per factor.
    fn digits(&self, number: usize, base: usize) -> Vec<usize> {
        let mut rest = number;
        (0..self.k)
            .map(|_| {
                let digit = rest % base;
                rest /= base;
                digit
            })
            .collect()
    }

    /// Coded point of a node.
    fn point(&self, node: usize, nodes: usize) -> Vec<f64> {
        let digits = self.digits(node, nodes);
        digits.into_iter().map(|d| self.edge(d)).collect()
    }

    /// Coded value of the lower edge of cell number `d` along a factor.
    fn edge(&self, d: usize) -> f64 {
        2.0 * d as f64 / self.cells as f64 - 1.0
    }

    /// The nodes at the corners of a cell.
    fn corners(&self, cell: usize) -> impl Iterator<Item = usize> {
        let digits = self.digits(cell, self.cells);
        let nodes = self.cells + 1;
        (0..1_usize << self.k).map(move |bits| {
            let places = digits.iter().enumerate().rev();
            places.fold(0, |node, (j, d)| node * nodes + d + (bits >> j & 1))
        })
    }

    /// Whether corners of a cell lie on both sides.
    fn is_crossed(&self, cell: usize, signs: &[bool]) -> bool {
        let above = self.corners(cell).filter(|&node| signs[node]).count();
        above > 0 && above < 1 << self.k
    }

    /// The cells that share a face with a cell.
    fn neighbours(&self, cell: usize) -> Vec<usize> {
        let digits = self.digits(cell, self.cells);
        let mut step = 1;
        let mut found = Vec::with_capacity(2 * self.k);
        for d in digits {
            if d > 0 {
                found.push(cell - step);
            }
            if d + 1 < self.cells {
                found.push(cell + step);
            }
            step *= self.cells;
        }
        found
    }

    /// Coded ranges of cells.
    fn ranges(&self, members: &[usize]) -> Vec<[f64; 2]> {
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.k];
        for &cell in members {
            for (range, d) in ranges.iter_mut().zip(self.digits(cell, self.cells)) {
                *range = [range[0].min(self.edge(d)), range[1].max(self.edge(d + 1))];
            }
        }
        ranges
    }

    /// A solution in the cell nearest to the mean of all cells: between two corners on either side.
    fn example(
        &self,
        members: &[usize],
        signs: &[bool],
        value: &dyn Fn(&[f64]) -> f64,
    ) -> Vec<f64> {
        let middle = |cell: usize| -> Vec<f64> {
            let digits = self.digits(cell, self.cells);
            digits
                .into_iter()
                .map(|d| 0.5 * (self.edge(d) + self.edge(d + 1)))
                .collect()
        };
        let n = members.len() as f64;
        let mut mean = vec![0.0; self.k];
        for &cell in members {
            for (sum, x) in mean.iter_mut().zip(middle(cell)) {
                *sum += x / n;
            }
        }
        let distance = |cell: &usize| -> f64 {
            let pairs = middle(*cell).into_iter().zip(&mean);
            pairs.map(|(a, b)| (a - b).powi(2)).sum()
        };
        let central = members
            .iter()
            .copied()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0);
        let nodes = self.cells + 1;
        let find = |side: bool| self.corners(central).find(|&node| signs[node] == side);
        let (Some(above), Some(below)) = (find(true), find(false)) else {
            return middle(central);
        };
        let (a, b) = (self.point(above, nodes), self.point(below, nodes));
        let between =
            |s: f64| -> Vec<f64> { a.iter().zip(&b).map(|(a, b)| a + s * (b - a)).collect() };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let s = 0.5 * (low + high);
            if value(&between(s)) > 0.0 {
                low = s;
            } else {
                high = s;
            }
        }
        between(0.5 * (low + high))
    }
}
