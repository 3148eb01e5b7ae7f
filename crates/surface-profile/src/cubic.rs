//! Weighted least-squares cubic.

use nalgebra::{Matrix4, Vector4};

/// The cubic `c0 + c1 x + c2 x^2 + c3 x^3`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cubic {
    /// Coefficients, constant first; unit of the ordinate over powers of the abscissa.
    pub(crate) coefficients: [f64; 4],
}

impl Cubic {
    /// Fits the cubic to (abscissa, ordinate, weight) by the normal equations.
    ///
    /// The abscissa is expected within about -1 to 1, where the equations are well conditioned.
    /// Returns `None` where they are singular (fewer than four distinct abscissae with weight).
    pub(crate) fn fit(points: impl Iterator<Item = (f64, f64, f64)>) -> Option<Self> {
        let mut matrix = Matrix4::zeros();
        let mut right = Vector4::zeros();
        for (x, y, weight) in points {
            let row = Vector4::new(1.0, x, x * x, x * x * x);
            matrix += weight * row * row.transpose();
            right += weight * y * row;
        }
        let solution = matrix.cholesky()?.solve(&right);
        let coefficients: [f64; 4] = solution.into();
        coefficients
            .iter()
            .all(|c| c.is_finite())
            .then_some(Self { coefficients })
    }

    /// The value at `x`.
    pub(crate) fn at(&self, x: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + x * (c1 + x * (c2 + x * c3))
    }
}
