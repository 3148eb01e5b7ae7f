//! The restricted likelihood of a model with random blocks.

use nalgebra::{Matrix2, Vector2};

use crate::Error;
use crate::fit::Matrix;
use crate::fit::least_squares::least_squares;

/// Step of numerical derivatives as a share of the variances. With two step widths the error of the
/// formula falls with the fourth power, and rounding of the likelihood (1e-13) costs about 1e-7.
const STEP: f64 = 2e-3;

/// The data with their blocks.
pub(super) struct Likelihood<'a> {
    /// Model matrix without block columns.
    pub(super) matrix: &'a Matrix,
    /// Block of each observation, from 0.
    pub(super) blocks: Vec<usize>,
    /// Number of blocks.
    pub(super) count: usize,
}

/// What follows from one ratio of the variances.
pub(super) struct At {
    pub(super) coefficients: Vec<f64>,
    /// Variances of the coefficients over that of an observation.
    pub(super) covariance: Vec<f64>,
    /// Sum of squares of the whitened residuals.
    squares: f64,
    /// ln|V / s^2| + ln|X'(V / s^2)^-1 X|.
    determinants: f64,
}

impl At {
    /// The most likely variance of an observation.
    pub(super) fn profiled_variance(&self, free: usize) -> f64 {
        self.squares / free as f64
    }

    /// -2 ln of the restricted likelihood at a variance.
    pub(super) fn deviance(&self, variance: f64, free: usize) -> f64 {
        let logs = (2.0 * std::f64::consts::PI * variance).ln();
        free as f64 * logs + self.determinants + self.squares / variance
    }
}

impl Likelihood<'_> {
    /// Sum of the weights in each block.
    fn weights(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        for (&block, w) in self.blocks.iter().zip(&self.matrix.weights) {
            sums[block] += w;
        }
        sums
    }

    /// Solves at a ratio of the variance of blocks to that of observations.
    ///
    /// With rows times sqrt(w) the covariance within a block is `I + theta q q'`, q the roots of the
    /// weights; its inverse root is `I - (1 - 1 / sqrt(1 + theta q'q)) q q' / q'q`.
    pub(super) fn at(&self, theta: f64) -> Result<At, Error> {
        let matrix = self.matrix;
        let sums = self.weights();
        let p = matrix.names.len();
        let roots: Vec<f64> = matrix.weights.iter().map(|w| w.sqrt()).collect();
        let mut rows: Vec<Vec<f64>> = matrix
            .rows
            .iter()
            .zip(&matrix.response)
            .zip(&roots)
            .map(|((row, y), root)| row.iter().chain([y]).map(|x| x * root).collect())
            .collect();
        let mut projections = vec![vec![0.0; p + 1]; self.count];
        for ((row, &block), root) in rows.iter().zip(&self.blocks).zip(&roots) {
            for (sum, x) in projections[block].iter_mut().zip(row) {
                *sum += root * x;
            }
        }
        for ((row, &block), root) in rows.iter_mut().zip(&self.blocks).zip(&roots) {
            let shrink = (1.0 - 1.0 / (1.0 + theta * sums[block]).sqrt()) / sums[block];
            for (x, sum) in row.iter_mut().zip(&projections[block]) {
                *x -= shrink * root * sum;
            }
        }
        let response: Vec<f64> = rows.iter_mut().filter_map(Vec::pop).collect();
        let solved = least_squares(&rows, &matrix.names, &response, &vec![1.0; rows.len()])?;
        let squares = rows.iter().zip(&response).map(|(row, y)| {
            let fitted: f64 = row
                .iter()
                .zip(&solved.coefficients)
                .map(|(x, c)| x * c)
                .sum();
            (y - fitted).powi(2)
        });
        let of_blocks: f64 = sums.iter().map(|s| (theta * s).ln_1p()).sum();
        let of_weights: f64 = matrix.weights.iter().map(|w| w.ln()).sum();
        let of_columns: f64 = (0..p)
            .map(|j| {
                let length: f64 = rows.iter().map(|row| row[j] * row[j]).sum();
                2.0 * solved.triangle[j][j].abs().ln() + length.ln()
            })
            .sum();
        Ok(At {
            squares: squares.sum(),
            determinants: of_blocks - of_weights + of_columns,
            covariance: (0..p).map(|j| solved.xtx_inverse[j][j]).collect(),
            coefficients: solved.coefficients,
        })
    }

    /// Degrees of freedom of each coefficient at the most likely variances.
    pub(super) fn degrees_of_freedom(
        &self,
        between: f64,
        residual: f64,
    ) -> Result<Vec<Option<f64>>, Error> {
        let p = self.matrix.names.len();
        let free = self.matrix.rows.len() - p;
        if between == 0.0 {
            return Ok(vec![Some(free as f64); p]);
        }
        // The widest block sets how small a variance between blocks can be told from none.
        let widest = self.weights().into_iter().fold(0.0, f64::max);
        let steps = [STEP * (between + residual / widest), STEP * residual];
        let deviance = |a: f64, b: f64| -> Result<f64, Error> {
            let (between, residual) = (between + a * steps[0], residual + b * steps[1]);
            Ok(self.at(between / residual)?.deviance(residual, free))
        };
        let variances = |a: f64, b: f64| -> Result<Vec<f64>, Error> {
            let (between, residual) = (between + a * steps[0], residual + b * steps[1]);
            let at = self.at(between / residual)?;
            Ok(at.covariance.iter().map(|c| c * residual).collect())
        };
        // Central differences at one and two steps, extrapolated to none.
        let curvature = |a: f64, b: f64| -> Result<f64, Error> {
            let at = |h: f64| -> Result<f64, Error> {
                let ends = deviance(h * a, h * b)? + deviance(-h * a, -h * b)?;
                Ok((ends - 2.0 * deviance(0.0, 0.0)?) / (h * h))
            };
            Ok((4.0 * at(1.0)? - at(2.0)?) / 3.0)
        };
        let (of_a, of_b, of_both) = (
            curvature(1.0, 0.0)?,
            curvature(0.0, 1.0)?,
            curvature(1.0, 1.0)?,
        );
        let mixed = 0.5 * (of_both - of_a - of_b);
        let Some(covariance) = Matrix2::new(of_a, mixed, mixed, of_b).try_inverse() else {
            return Ok(vec![None; p]);
        };
        let slopes = |a: f64, b: f64| -> Result<Vec<f64>, Error> {
            let at = |h: f64| -> Result<Vec<f64>, Error> {
                let (up, down) = (variances(h * a, h * b)?, variances(-h * a, -h * b)?);
                Ok(up
                    .iter()
                    .zip(&down)
                    .map(|(u, d)| (u - d) / (2.0 * h))
                    .collect())
            };
            let (near, far) = (at(1.0)?, at(2.0)?);
            Ok(near
                .iter()
                .zip(&far)
                .map(|(n, f)| (4.0 * n - f) / 3.0)
                .collect())
        };
        let (by_between, by_residual, here) =
            (slopes(1.0, 0.0)?, slopes(0.0, 1.0)?, variances(0.0, 0.0)?);
        let of_term = |j: usize| {
            let g = Vector2::new(by_between[j], by_residual[j]);
            // The covariance of the variances is twice the inverse of the curvature of -2 ln L.
            let spread = 2.0 * g.dot(&(covariance * g));
            Some(2.0 * here[j] * here[j] / spread).filter(|df| df.is_finite() && *df > 0.0)
        };
        Ok((0..p).map(of_term).collect())
    }

    /// The deviations of the blocks, drawn towards zero by their uncertainty.
    pub(super) fn deviations(&self, at: &At, theta: f64) -> Vec<f64> {
        let matrix = self.matrix;
        let mut sums = vec![0.0; self.count];
        for (i, &block) in self.blocks.iter().enumerate() {
            let row = matrix.rows[i].iter().zip(&at.coefficients);
            let fitted: f64 = row.map(|(x, c)| x * c).sum();
            sums[block] += matrix.weights[i] * (matrix.response[i] - fitted);
        }
        let pairs = sums.iter().zip(self.weights());
        pairs
            .map(|(sum, w)| theta * sum / (1.0 + theta * w))
            .collect()
    }
}
