//! A quadratic function of the coded variables, and the faces of the box.

use nalgebra::{DMatrix, DVector};

use crate::{Error, Fit};

/// constant + linear' x + x' hessian x / 2 over coded x.
#[derive(Debug, Clone)]
pub(crate) struct Quadratic {
    /// Value at the centre, unit of the response.
    pub(crate) constant: f64,
    /// Gradient at the centre.
    pub(crate) linear: DVector<f64>,
    /// Second derivatives, symmetric.
    pub(crate) hessian: DMatrix<f64>,
}

/// Which coordinates of a face of the box are fixed, and at what coded value.
pub(crate) type Face = Vec<Option<f64>>;

impl Fit {
    /// The fitted surface as a quadratic.
    ///
    /// # Errors
    /// [`Error::DegreeTooHigh`].
    pub(crate) fn quadratic(&self) -> Result<Quadratic, Error> {
        self.quadratic_of(&self.coefficients())
    }

    /// The surface of other coefficients, in the order of the model, as a quadratic.
    ///
    /// # Errors
    /// [`Error::DegreeTooHigh`].
    pub(crate) fn quadratic_of(&self, coefficients: &[f64]) -> Result<Quadratic, Error> {
        let degree = self.formula.degree();
        if degree > 2 {
            return Err(Error::DegreeTooHigh { degree });
        }
        let k = self.factors.len();
        let mut quadratic = Quadratic {
            constant: 0.0,
            linear: DVector::zeros(k),
            hessian: DMatrix::zeros(k, k),
        };
        for (term, &c) in self.formula.terms().iter().zip(coefficients) {
            let powers = term.powers().iter().enumerate();
            let places: Vec<usize> = powers
                .flat_map(|(j, &power)| std::iter::repeat_n(j, usize::from(power)))
                .collect();
            match places[..] {
                [] => quadratic.constant += c,
                [i] => quadratic.linear[i] += c,
                [i, j] => {
                    quadratic.hessian[(i, j)] += c;
                    quadratic.hessian[(j, i)] += c;
                }
                _ => return Err(Error::DegreeTooHigh { degree }),
            }
        }
        Ok(quadratic)
    }
}

impl Quadratic {
    /// Value at a coded point.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        let x = DVector::from_column_slice(x);
        self.constant + self.linear.dot(&x) + 0.5 * (&self.hessian * &x).dot(&x)
    }

    /// Rounding of a value over the box: 1e-14 of the sum of the sizes of all terms. Two values no farther apart are
    /// taken as equal; the sums of a fit leave about a tenth of it.
    pub(crate) fn rounding(&self) -> f64 {
        let size = |x: &[f64]| x.iter().map(|x| x.abs()).sum::<f64>();
        let terms = size(self.linear.as_slice()) + size(self.hessian.as_slice());
        1e-14 * (self.constant.abs() + terms)
    }

    /// Gradient at a coded point.
    pub(crate) fn gradient(&self, x: &[f64]) -> DVector<f64> {
        &self.linear + &self.hessian * DVector::from_column_slice(x)
    }

    /// The same function on a face, over the free coordinates in their order.
    pub(crate) fn on_face(&self, face: &Face) -> Self {
        let free = free_places(face);
        let base: Vec<f64> = face.iter().map(|x| x.unwrap_or(0.0)).collect();
        let gradient = self.gradient(&base);
        let m = free.len();
        Self {
            constant: self.value(&base),
            linear: DVector::from_fn(m, |i, _| gradient[free[i]]),
            hessian: DMatrix::from_fn(m, m, |i, j| self.hessian[(free[i], free[j])]),
        }
    }
}

/// Indices of the free coordinates of a face.
pub(crate) fn free_places(face: &Face) -> Vec<usize> {
    (0..face.len()).filter(|&j| face[j].is_none()).collect()
}

/// The point of the box that has given free coordinates on a face.
pub(crate) fn point_on_face(face: &Face, free: &[f64]) -> Vec<f64> {
    let mut free = free.iter();
    face.iter()
        .map(|x| x.or_else(|| free.next().copied()).unwrap_or(0.0))
        .collect()
}

/// All faces of the box -1..+1 in k dimensions, from the interior to the 2^k corners.
pub(crate) fn faces(k: usize) -> impl Iterator<Item = Face> {
    let digit =
        |index: usize, j: usize| match index / 3_usize.pow(u32::try_from(j).unwrap_or(0)) % 3 {
            0 => None,
            1 => Some(-1.0),
            _ => Some(1.0),
        };
    let count = 3_usize.pow(u32::try_from(k).unwrap_or(0));
    (0..count).map(move |index| (0..k).map(|j| digit(index, j)).collect())
}
