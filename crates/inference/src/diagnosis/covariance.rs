//! Covariances in diagonal blocks, and whitening with their Cholesky factors.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::Error;

/// Smallest pivot, relative to its variance, that counts as positive: below it the remaining
/// variance is lost in the rounding of the entries.
const SMALLEST_PIVOT: f64 = 1e-12;

/// A covariance of diagonal blocks that follow each other; a full matrix is one block.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Covariance {
    blocks: Vec<DMatrix<f64>>,
    /// What each block belongs to, for errors; same order.
    labels: Vec<String>,
}

/// The Cholesky factor of a covariance: V = L L'.
#[derive(Debug, Clone)]
pub(crate) struct Whitener {
    /// Lower triangular factors of the blocks.
    factors: Vec<DMatrix<f64>>,
    /// ln det V.
    pub(crate) ln_determinant: f64,
}

impl Covariance {
    pub(crate) fn new(blocks: Vec<DMatrix<f64>>, labels: Vec<String>) -> Self {
        Self { blocks, labels }
    }

    pub(crate) fn rows(&self) -> usize {
        self.blocks.iter().map(DMatrix::nrows).sum()
    }

    /// Variances of the rows.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        self.blocks
            .iter()
            .flat_map(|block| block.diagonal().iter().copied().collect::<Vec<_>>())
            .collect()
    }

    /// Adds `factor` times another covariance of the same rows.
    pub(crate) fn plus_scaled(&self, factor: f64, other: &Self) -> Self {
        let same = self.blocks.len() == other.blocks.len()
            && self
                .blocks
                .iter()
                .zip(&other.blocks)
                .all(|(a, b)| a.shape() == b.shape());
        if same {
            let blocks = self
                .blocks
                .iter()
                .zip(&other.blocks)
                .map(|(a, b)| a + b * factor)
                .collect();
            return Self::new(blocks, self.labels.clone());
        }
        let sum = self.whole() + other.whole() * factor;
        Self::new(vec![sum], vec!["all conditions together".to_owned()])
    }

    /// Keeps the rows of these numbers (ascending); empty blocks vanish.
    pub(crate) fn keep(&self, rows: &[usize]) -> Self {
        let mut kept = Self::new(Vec::new(), Vec::new());
        let mut start = 0;
        for (block, label) in self.blocks.iter().zip(&self.labels) {
            let end = start + block.nrows();
            let inside: Vec<usize> = rows
                .iter()
                .filter(|&&row| (start..end).contains(&row))
                .map(|row| row - start)
                .collect();
            if !inside.is_empty() {
                kept.blocks
                    .push(block.select_rows(&inside).select_columns(&inside));
                kept.labels.push(label.clone());
            }
            start = end;
        }
        kept
    }

    /// Factorises the blocks.
    pub(crate) fn whitener(&self) -> Result<Whitener, Error> {
        let mut factors = Vec::with_capacity(self.blocks.len());
        let mut ln_determinant = 0.0;
        for (block, label) in self.blocks.iter().zip(&self.labels) {
            let factor = cholesky(block, label)?;
            ln_determinant += 2.0 * factor.diagonal().iter().map(|d| d.ln()).sum::<f64>();
            factors.push(factor);
        }
        Ok(Whitener {
            factors,
            ln_determinant,
        })
    }

    /// Gives noise of this covariance from white noise. A variance may be 0: a slope that moves nothing has no noise.
    pub(crate) fn noise_from(&self, white: &DVector<f64>) -> DVector<f64> {
        let mut noise = DVector::zeros(white.len());
        let mut start = 0;
        for (block, label) in self.blocks.iter().zip(&self.labels) {
            let m = block.nrows();
            let root = cholesky(block, label).unwrap_or_else(|_| root_by_eigenvalues(block));
            noise
                .rows_mut(start, m)
                .copy_from(&(root * white.rows(start, m)));
            start += m;
        }
        noise
    }

    pub(crate) fn whole(&self) -> DMatrix<f64> {
        let n = self.rows();
        let mut whole = DMatrix::zeros(n, n);
        let mut start = 0;
        for block in &self.blocks {
            let m = block.nrows();
            whole.view_mut((start, start), (m, m)).copy_from(block);
            start += m;
        }
        whole
    }
}

impl Whitener {
    /// Gives L^-1 times a vector of the same rows.
    pub(crate) fn whiten_vector(&self, vector: &DVector<f64>) -> DVector<f64> {
        let column = DMatrix::from_column_slice(vector.len(), 1, vector.as_slice());
        self.whiten(&column).column(0).into_owned()
    }

    /// Gives L^-1 C L'^-1 for a covariance C of the same rows.
    pub(crate) fn whiten_covariance(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        self.whiten(&self.whiten(covariance).transpose())
    }

    /// Gives L^-1 times a matrix of the same rows.
    pub(crate) fn whiten(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        self.by_block(matrix, |factor, part| factor.solve_lower_triangular(&part))
    }

    /// Gives L^-1 C L'^-1 of one block alone, by its number.
    pub(crate) fn whiten_block(&self, block: usize, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let factors = vec![self.factors[block].clone()];
        let ln_determinant = 0.0;
        let alone = Self {
            factors,
            ln_determinant,
        };
        alone.whiten_covariance(covariance)
    }

    /// Gives G L^-1 for rows of gains from whitened values: the gains from the values themselves.
    pub(crate) fn unwhiten_gains(&self, gains: &DMatrix<f64>) -> DMatrix<f64> {
        // (G L^-1)' = L'^-1 G'.
        let solved = self.by_block(&gains.transpose(), |factor, part| {
            factor.tr_solve_lower_triangular(&part)
        });
        solved.transpose()
    }

    /// Solves something for the rows of each block.
    fn by_block(
        &self,
        matrix: &DMatrix<f64>,
        solve: impl Fn(&DMatrix<f64>, DMatrix<f64>) -> Option<DMatrix<f64>>,
    ) -> DMatrix<f64> {
        let mut result = matrix.clone();
        let mut start = 0;
        for factor in &self.factors {
            let m = factor.nrows();
            let part = matrix.rows(start, m).into_owned();
            let solved = solve(factor, part).expect("the factorisation has refused zero pivots");
            result.rows_mut(start, m).copy_from(&solved);
            start += m;
        }
        result
    }
}

/// A root of a block that is positive semidefinite: V diag(sqrt(max(w, 0))) with its eigenvectors V and eigenvalues w.
fn root_by_eigenvalues(block: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = block.clone().symmetric_eigen();
    let sizes = eigen.eigenvalues.map(|w| w.max(0.0).sqrt());
    eigen.eigenvectors * DMatrix::from_diagonal(&sizes)
}

/// Cholesky factor of one block `[Golub2013, section 4.2]`, which says where it fails.
fn cholesky(block: &DMatrix<f64>, label: &str) -> Result<DMatrix<f64>, Error> {
    let n = block.nrows();
    let mut factor: DMatrix<f64> = DMatrix::zeros(n, n);
    for j in 0..n {
        let left = block[(j, j)] - factor.row(j).columns(0, j).norm_squared();
        let pivot = left / block[(j, j)];
        // The negated comparison also catches a pivot that is not a number.
        if !(block[(j, j)] > 0.0 && pivot > SMALLEST_PIVOT) {
            return Err(Error::NotPositiveDefinite {
                block: label.to_owned(),
                row: j,
                pivot: if block[(j, j)] > 0.0 { pivot } else { 0.0 },
            });
        }
        factor[(j, j)] = left.sqrt();
        for i in j + 1..n {
            let known = factor
                .row(i)
                .columns(0, j)
                .dot(&factor.row(j).columns(0, j));
            factor[(i, j)] = (block[(i, j)] - known) / factor[(j, j)];
        }
    }
    Ok(factor)
}

#[cfg(test)]
mod tests {
    use super::Covariance;
    use crate::diagnosis::Error;
    use nalgebra::{DMatrix, dmatrix};

    fn two_blocks() -> Covariance {
        Covariance::new(
            vec![dmatrix![4.0, 1.0; 1.0, 2.0], dmatrix![9.0]],
            vec!["one".into(), "two".into()],
        )
    }

    /// L^-1 V L'^-1 = I; the tolerance is rounding.
    #[test]
    fn whitened_covariance_is_the_identity() {
        let covariance = two_blocks();
        let whitener = covariance.whitener().unwrap();
        let whole = whitener.whiten_covariance(&covariance.whole());
        assert!((whole - DMatrix::identity(3, 3)).amax() < 1e-15);
        assert!((whitener.ln_determinant - 63.0_f64.ln()).abs() < 1e-14);
    }

    /// The columns of a root, which unit vectors give, have the covariance as the sum of their squares; a block of zeros, one
    /// with one variance of 0 and one of rank 1 included. The tolerance is rounding.
    #[test]
    fn noise_has_its_covariance_where_a_variance_is_zero_too() {
        let covariance = Covariance::new(
            vec![
                dmatrix![4.0, 1.0; 1.0, 2.0],
                dmatrix![0.0, 0.0; 0.0, 0.0],
                dmatrix![0.0, 0.0; 0.0, 9.0],
                dmatrix![1.0, 2.0; 2.0, 4.0],
            ],
            ["one", "two", "three", "four"].map(String::from).to_vec(),
        );
        let n = covariance.rows();
        let column = |k| covariance.noise_from(&DMatrix::identity(n, n).column(k).into_owned());
        let sum = (0..n).map(|k| column(k) * column(k).transpose());
        let sum: DMatrix<f64> = sum.sum();
        assert!((sum - covariance.whole()).amax() < 1e-14);
    }

    #[test]
    fn block_that_is_not_positive_definite_is_named() {
        let covariance = Covariance::new(
            vec![dmatrix![1.0], dmatrix![1.0, 1.0; 1.0, 1.0]],
            vec!["rpm 4".into(), "rpm 8".into()],
        );
        let error = covariance.whitener().unwrap_err();
        assert!(
            matches!(&error, Error::NotPositiveDefinite { block, row: 1, .. } if block == "rpm 8"),
            "{error}"
        );
    }

    #[test]
    fn sum_of_blocks_and_a_full_matrix_is_full() {
        let full = Covariance::new(vec![DMatrix::from_element(3, 3, 0.5)], vec!["all".into()]);
        let sum = two_blocks().plus_scaled(2.0, &full).whole();
        assert_eq!(sum, dmatrix![5.0, 2.0, 1.0; 2.0, 3.0, 1.0; 1.0, 1.0, 10.0]);
    }

    #[test]
    fn kept_rows_keep_their_covariances() {
        let kept = two_blocks().keep(&[1, 2]);
        assert_eq!(kept.whole(), dmatrix![2.0, 0.0; 0.0, 9.0]);
    }
}
