//! What a set of whitened directions can absorb, and what it cannot.

use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest, after scaling the columns to length 1, count
/// as 0: finite-difference sensitivities have fewer right digits than this.
const RANK_TOLERANCE: f64 = 1e-10;

/// The column space of a matrix, with what is needed for least squares in it.
///
/// # Formula
///
/// A = U D W' C with C the lengths of the columns; basis U, coefficients C^-1 W D^+ U' y, their
/// covariance C^-1 W D^-2+ W' C^-1 for white y. Columns are scaled first, so that the units of
/// the parameters do not decide the rank. `[Golub2013, section 5.5]`
#[derive(Debug, Clone)]
pub(crate) struct Space {
    /// Orthonormal basis (rows, rank).
    basis: DMatrix<f64>,
    /// Maps basis coordinates to coefficients (columns, rank).
    to_coefficients: DMatrix<f64>,
}

impl Space {
    /// The column space of `matrix`.
    pub(crate) fn of(matrix: &DMatrix<f64>) -> Self {
        let (rows, columns) = matrix.shape();
        let lengths: Vec<f64> = matrix
            .column_iter()
            .map(|column| Some(column.norm()).filter(|&l| l > 0.0).unwrap_or(1.0))
            .collect();
        if rows == 0 || columns == 0 {
            return Self {
                basis: DMatrix::zeros(rows, 0),
                to_coefficients: DMatrix::zeros(columns, 0),
            };
        }
        let mut scaled = matrix.clone();
        for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
            column /= *length;
        }
        let svd = scaled.svd(true, true);
        let u = svd.u.expect("this factor was asked for");
        let v_transposed = svd.v_t.expect("this factor was asked for");
        let largest = svd.singular_values.amax();
        let kept: Vec<usize> = (0..svd.singular_values.len())
            .filter(|&i| largest > 0.0 && svd.singular_values[i] > RANK_TOLERANCE * largest)
            .collect();
        let mut to_coefficients = v_transposed.select_rows(&kept).transpose();
        for (mut column, &i) in to_coefficients.column_iter_mut().zip(&kept) {
            column /= svd.singular_values[i];
        }
        for (mut row, length) in to_coefficients.row_iter_mut().zip(&lengths) {
            row /= *length;
        }
        Self {
            basis: u.select_columns(&kept),
            to_coefficients,
        }
    }

    /// Dimension of the space.
    pub(crate) fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// The part of a vector outside the space; projected twice, which removes the rounding left
    /// by the first time.
    pub(crate) fn outside(&self, vector: &DVector<f64>) -> DVector<f64> {
        let once = vector - &self.basis * self.basis.tr_mul(vector);
        &once - &self.basis * self.basis.tr_mul(&once)
    }

    /// The parts of all columns outside the space.
    pub(crate) fn outside_columns(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let once = matrix - &self.basis * self.basis.tr_mul(matrix);
        &once - &self.basis * self.basis.tr_mul(&once)
    }

    /// Coordinates of a vector in the orthonormal basis.
    pub(crate) fn coordinates(&self, vector: &DVector<f64>) -> DVector<f64> {
        self.basis.tr_mul(vector)
    }

    /// Least-squares coefficients of the columns; of least norm where they are not unique.
    pub(crate) fn coefficients(&self, vector: &DVector<f64>) -> DVector<f64> {
        &self.to_coefficients * self.basis.tr_mul(vector)
    }

    /// Covariance of the coefficients for white noise of variance 1.
    pub(crate) fn coefficient_covariance(&self) -> DMatrix<f64> {
        &self.to_coefficients * self.to_coefficients.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::Space;
    use nalgebra::{dmatrix, dvector};

    /// Scaled by 1e12, the columns of unlike units still count as two directions.
    #[test]
    fn rank_does_not_depend_on_the_units_of_the_columns() {
        let space = Space::of(&dmatrix![1.0, 1e12; 1.0, 2e12; 1.0, 3e12]);
        assert_eq!(space.rank(), 2);
        let fit = space.coefficients(&dvector![3.0, 5.0, 7.0]);
        assert!((fit[0] - 1.0).abs() < 1e-12, "{fit}");
        assert!((fit[1] - 2e-12).abs() < 1e-24, "{fit}");
    }

    #[test]
    fn dependent_and_zero_columns_do_not_raise_the_rank() {
        let space = Space::of(&dmatrix![1.0, 2.0, 0.0; 1.0, 2.0, 0.0; 0.0, 0.0, 0.0]);
        assert_eq!(space.rank(), 1);
        let outside = space.outside(&dvector![1.0, -1.0, 4.0]);
        assert!((outside - dvector![1.0, -1.0, 4.0]).amax() < 1e-15);
    }

    /// Variance of a mean of four values is 1/4.
    #[test]
    fn covariance_of_a_mean_is_one_over_n() {
        let space = Space::of(&dmatrix![1.0; 1.0; 1.0; 1.0]);
        assert!((space.coefficient_covariance()[(0, 0)] - 0.25).abs() < 1e-15);
    }
}
