//! Polynomials through the same runs, without the analysis of each.

use nalgebra::{DMatrix, DVector};

use crate::fit::least_squares::{condition, least_squares};
use crate::{Error, Model};

/// Polynomials of several responses over the same runs, by weighted least squares.
///
/// # Formula
/// `B = (X'WX)^-1 X'WY`, as in [`crate::fit_weighted`].
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomials {
    /// The terms.
    pub model: Model,
    /// Coefficients in coded units, (terms, responses).
    pub coefficients: DMatrix<f64>,
    /// `(X'WX)^-1`, (terms, terms): covariance of the coefficients over the variance of a run of weight 1.
    pub inverse: DMatrix<f64>,
    /// `(X'WX)^-1 X'W`, (terms, runs): what turns responses into coefficients.
    pub gain: DMatrix<f64>,
    /// Greatest over least singular value of the columns of `sqrt(W) X`, scaled to unit length.
    pub condition: f64,
}

impl Polynomials {
    /// Fits a model to responses, (runs, responses), at coded points with these weights.
    ///
    /// # Errors
    /// [`Error::TooFewObservations`], [`Error::AliasedTerms`].
    pub fn fit(
        model: &Model,
        coded: &[Vec<f64>],
        responses: &DMatrix<f64>,
        weights: &[f64],
    ) -> Result<Self, Error> {
        let rows: Vec<Vec<f64>> = coded.iter().map(|x| model.row(x)).collect();
        let (n, p) = (rows.len(), model.terms().len());
        if n < p {
            return Err(Error::TooFewObservations {
                observations: n,
                terms: p,
            });
        }
        let solved = least_squares(&rows, &model.names(), &vec![0.0; n], weights)?;
        let inverse = DMatrix::from_fn(p, p, |i, j| solved.xtx_inverse[i][j]);
        let weighted = DMatrix::from_fn(p, n, |t, i| rows[i][t] * weights[i]);
        let gain = &inverse * weighted;
        Ok(Self {
            model: model.clone(),
            coefficients: &gain * responses,
            condition: condition(&solved).unwrap_or(f64::INFINITY),
            inverse,
            gain,
        })
    }

    /// Value of a response at a coded point.
    pub fn value(&self, response: usize, coded: &[f64]) -> f64 {
        let row = DVector::from_vec(self.model.row(coded));
        row.dot(&self.coefficients.column(response))
    }

    /// Covariance of two combinations of the coefficients over the variance of a run of weight 1.
    pub fn covariance(&self, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
        (&self.inverse * a).dot(b)
    }
}

#[cfg(test)]
mod tests {
    use super::Polynomials;
    use crate::{Cell, Model, Observations, fit};
    use experiment_design::{Factor, box_behnken};
    use nalgebra::DMatrix;

    /// One implementation serves both: coefficients and `(X'X)^-1` are those of the fit with its analysis (rounding: 1e-12), and the
    /// slopes of the terms are their differences over 2e-6 (error 1e-6).
    #[test]
    fn polynomials_are_those_of_the_analysis() {
        let factors = ["A", "B", "C"].map(|s| Factor::coded_only(s).unwrap());
        let rows = box_behnken(&factors, 3).unwrap().coded_rows();
        let y =
            |x: &[f64]| 2.0 + x[0] - 0.7 * x[1] * x[2] + 0.4 * (7.0 * (x[0] + x[1] * x[2])).sin();
        let values: Vec<f64> = rows.iter().map(|x| y(x)).collect();
        let model = Model::quadratic(&factors).unwrap();
        let responses = DMatrix::from_column_slice(rows.len(), 1, &values);
        let weights = vec![1.0; rows.len()];
        let fast = Polynomials::fit(&model, &rows, &responses, &weights).unwrap();
        let cells = rows.iter().zip(&values);
        let cells = cells.map(|(x, y)| Cell::single(x.clone(), *y)).collect();
        let whole = fit(&factors, &model, &Observations::from_cells(cells).unwrap()).unwrap();
        for (i, c) in whole.coefficients().iter().enumerate() {
            assert!((fast.coefficients[(i, 0)] - c).abs() < 1e-12);
            for (j, entry) in whole.xtx_inverse[i].iter().enumerate() {
                assert!((fast.inverse[(i, j)] - entry).abs() < 1e-12);
            }
        }
        let at = [0.3, -0.8, 0.5];
        for place in 0..3 {
            let moved = |by: f64| {
                let mut x = at;
                x[place] += by;
                model.row(&x)
            };
            let (ahead, behind) = (moved(1e-6), moved(-1e-6));
            for (t, slope) in model.row_slopes(&at, place).iter().enumerate() {
                assert!((slope - (ahead[t] - behind[t]) / 2e-6).abs() < 1e-6);
            }
        }
    }
}
