//! Criterion that an optimal design minimises, and its value for given runs.

use probability::random_stream::Stream;

use crate::{DesignKind, Region};

/// Added to the diagonal of X'X, relative to the runs, so that a poor start has a finite value.
const RIDGE: f64 = 1e-8;
/// Points of a region at which the moments of the model are taken, unless it is the whole box.
const POINTS: usize = 4096;

/// Criterion that an optimal design minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Determinant of (X'X)^-1: the volume of the confidence region of the coefficients (D).
    Determinant,
    /// Mean over the region of x'(X'X)^-1 x: the variance of the prediction (I).
    MeanVariance,
}

impl Criterion {
    /// The kind of the resulting design.
    pub fn kind(self) -> DesignKind {
        match self {
            Self::Determinant => DesignKind::DOptimal,
            Self::MeanVariance => DesignKind::IOptimal,
        }
    }
}

/// A criterion with its data: the model, the given runs, the moments of the region.
pub(crate) struct Target<'a> {
    /// Terms of the model at a point.
    row: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// X'X of the given runs.
    given: Vec<Vec<f64>>,
    /// Mean of x x' over the region; `None` for the determinant.
    moments: Option<Vec<Vec<f64>>>,
}

impl<'a> Target<'a> {
    /// Makes the target.
    pub(crate) fn new(
        region: &Region,
        criterion: Criterion,
        given: &[Vec<f64>],
        seed: u64,
        row: &'a dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        let terms = row(region.inside()).len();
        let moments = || {
            if region.is_cube() {
                box_moments(region.len(), row, seed)
            } else {
                mean_of(&region.sample(POINTS, seed), row, terms)
            }
        };
        Self {
            given: information(given, row, terms),
            moments: (criterion == Criterion::MeanVariance).then(moments),
            row,
        }
    }

    /// Number of terms of the model.
    pub(crate) fn terms(&self) -> usize {
        self.given.len()
    }

    /// The value of the given runs and these together; smaller is better.
    pub(crate) fn cost(&self, rows: &[Vec<f64>]) -> f64 {
        let mut sum = information(rows, self.row, self.terms());
        for (entry, more) in sum.iter_mut().flatten().zip(self.given.iter().flatten()) {
            *entry += more;
        }
        match &self.moments {
            None => log_determinant_cost(&sum),
            Some(moments) => variance_cost(&sum, moments),
        }
    }
}

/// Mean of x x' over given points.
fn mean_of(rows: &[Vec<f64>], row: &dyn Fn(&[f64]) -> Vec<f64>, terms: usize) -> Vec<Vec<f64>> {
    let mut moments = information(rows, row, terms);
    for entry in moments.iter_mut().flatten() {
        *entry /= rows.len() as f64;
    }
    moments
}

/// X'X with a small ridge term, (terms, terms).
pub(crate) fn information(
    rows: &[Vec<f64>],
    row: &dyn Fn(&[f64]) -> Vec<f64>,
    terms: usize,
) -> Vec<Vec<f64>> {
    let mut sum = vec![vec![0.0; terms]; terms];
    for (i, line) in sum.iter_mut().enumerate() {
        line[i] = RIDGE * rows.len() as f64;
    }
    for x in rows.iter().map(|x| row(x)) {
        for (line, a) in sum.iter_mut().zip(&x) {
            for (entry, b) in line.iter_mut().zip(&x) {
                *entry += a * b;
            }
        }
    }
    sum
}

/// Lower Cholesky factor of a symmetric positive definite matrix.
fn cholesky(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|m| factor[i][m] * factor[j][m]).sum();
            factor[i][j] = if i == j {
                (matrix[i][i] - sum).max(f64::MIN_POSITIVE).sqrt()
            } else {
                (matrix[i][j] - sum) / factor[j][j]
            };
        }
    }
    factor
}

/// ln det (X'X)^-1.
fn log_determinant_cost(information: &[Vec<f64>]) -> f64 {
    let factor = cholesky(information);
    -2.0 * (0..factor.len()).map(|i| factor[i][i].ln()).sum::<f64>()
}

/// Trace of (X'X)^-1 M, M the mean of x x' over the box.
fn variance_cost(information: &[Vec<f64>], moments: &[Vec<f64>]) -> f64 {
    let factor = cholesky(information);
    let n = factor.len();
    // Columns of the inverse factor: (X'X)^-1 = L^-T L^-1.
    let mut inverse = vec![vec![0.0; n]; n];
    for j in 0..n {
        inverse[j][j] = 1.0 / factor[j][j];
        for i in j + 1..n {
            let sum: f64 = (j..i).map(|m| factor[i][m] * inverse[m][j]).sum();
            inverse[i][j] = -sum / factor[i][i];
        }
    }
    let mut trace = 0.0;
    for line in &inverse {
        for (a, moment) in line.iter().zip(moments) {
            trace += a * line.iter().zip(moment).map(|(b, m)| b * m).sum::<f64>();
        }
    }
    trace
}

/// Mean of x x' over the box from a Latin hypercube and its mirror images of signs, exact for
/// odd powers and good to about 1 % for even ones, which is enough to rank designs.
fn box_moments(k: usize, row: &dyn Fn(&[f64]) -> Vec<f64>, seed: u64) -> Vec<Vec<f64>> {
    const POINTS: usize = 512;
    let mut stream = Stream::new(seed, "moments of the box");
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(k);
    for _ in 0..k {
        let middle = |i: usize| 2.0 * (i as f64 + 0.5) / POINTS as f64 - 1.0;
        let mut column: Vec<f64> = (0..POINTS).map(middle).collect();
        stream.shuffle(&mut column);
        columns.push(column);
    }
    let point = |i: usize, sign: f64| columns.iter().map(|c| sign * c[i]).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = (0..POINTS)
        .flat_map(|i| [point(i, 1.0), point(i, -1.0)])
        .collect();
    let terms = row(&vec![0.0; k]).len();
    mean_of(&rows, row, terms)
}
