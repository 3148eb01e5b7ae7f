//! Ridge analysis: the best points of a quadratic at growing distance from the centre.

use nalgebra::{DMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};

use crate::surface::quadratic::Quadratic;
use crate::{Error, Fit};

/// The greatest or least value of the surface on a sphere about the centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RidgePoint {
    /// Radius of the sphere, coded units.
    pub radius_coded: f64,
    /// The point, coded.
    pub coded: Vec<f64>,
    /// The point, units of the factors.
    pub natural: Vec<f64>,
    /// Value of the surface, unit of the response.
    pub value: f64,
    /// Standard error of that value, unit of the response; none without an error variance.
    pub se_mean: Option<f64>,
}

/// The path of steepest ascent (`ascend`) or descent of a quadratic: the extreme point on each
/// sphere of the given coded radii. For a linear model it is the straight path along the gradient.
///
/// # Formula
/// `(B - mu I) x = -b / 2` with mu above the greatest eigenvalue of B (below the least) so that
/// `|x| = r`.
///
/// # Source
/// `[Hoerl1959]`; `[Draper1963]`.
///
/// # Errors
/// [`Error::DegreeTooHigh`]; [`Error::SettingOutOfRange`] for a negative radius.
pub fn ridge_path(fit: &Fit, radii: &[f64], ascend: bool) -> Result<Vec<RidgePoint>, Error> {
    let quadratic = fit.quadratic()?;
    let error = fit.best_error_variance();
    let mut path = Vec::with_capacity(radii.len());
    for &radius in radii {
        if !(radius >= 0.0 && radius.is_finite()) {
            return Err(Error::SettingOutOfRange {
                what: "a radius",
                value: radius,
                range: "zero or more",
            });
        }
        let coded = extreme(&quadratic, radius, if ascend { 1.0 } else { -1.0 });
        path.push(RidgePoint {
            radius_coded: radius,
            natural: fit.natural(&coded),
            value: fit.value(&coded),
            se_mean: error.map(|e| (e.variance * fit.leverage(&coded)).sqrt()),
            coded,
        });
    }
    Ok(path)
}

/// The point of a sphere about the origin at which `sign` times the quadratic is greatest.
fn extreme(quadratic: &Quadratic, radius: f64, sign: f64) -> Vec<f64> {
    let k = quadratic.linear.len();
    let matrix: DMatrix<f64> = &quadratic.hessian * (0.5 * sign);
    let eigen = SymmetricEigen::new(matrix);
    let slopes = eigen.eigenvectors.tr_mul(&(&quadratic.linear * sign));
    let top = eigen.eigenvalues.max();
    // In the eigenvectors z_i = b_i / (2 (mu - lambda_i)), falling in mu.
    let at = |mu: f64| -> Vec<f64> {
        let pairs = slopes.iter().zip(eigen.eigenvalues.iter());
        pairs
            .map(|(b, l)| if *b == 0.0 { 0.0 } else { 0.5 * b / (mu - l) })
            .collect()
    };
    let length = |z: &[f64]| z.iter().map(|x| x * x).sum::<f64>().sqrt();
    let size = slopes.norm() + eigen.eigenvalues.amax();
    if radius == 0.0 || size == 0.0 {
        return vec![0.0; k];
    }
    let mut low = 0.0;
    let mut high = slopes.norm() / radius + size * 1e-12;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if length(&at(top + middle)) > radius {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut z = at(top + high);
    // Where the slope along the top eigenvector is zero, the rest of the radius lies along it.
    let missing = radius * radius - length(&z).powi(2);
    let place = eigen.eigenvalues.imax();
    if missing > 1e-9 * radius * radius {
        z[place] += missing.sqrt();
    }
    let point = &eigen.eigenvectors * nalgebra::DVector::from_vec(z);
    point.as_slice().to_vec()
}
