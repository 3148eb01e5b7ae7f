//! Solutions along one factor, the others held.

use crate::surface::prediction::check_point;
use crate::surface::quadratic::Quadratic;
use crate::{Error, Fit};

/// Natural values of factor `i` (from 0) at which the surface has the value `target` while the
/// other factors keep their values at `natural`; ascending, inside the range of the factor or not.
///
/// # Errors
/// [`Error::DegreeTooHigh`]; [`Error::Length`] for a wrong number of values or no such factor;
/// [`Error::SettingOutOfRange`] for values that are not finite.
pub fn roots_along(fit: &Fit, target: f64, natural: &[f64], i: usize) -> Result<Vec<f64>, Error> {
    check_point(fit, natural)?;
    if !target.is_finite() {
        return Err(Error::SettingOutOfRange {
            what: "the target",
            value: target,
            range: "a finite number",
        });
    }
    let Some(factor) = fit.factors.get(i) else {
        return Err(Error::Length {
            what: "factors",
            expected: i + 1,
            given: fit.factors.len(),
        });
    };
    let roots = coded_roots(&fit.quadratic()?, target, &fit.coded(natural), i);
    Ok(roots.into_iter().map(|x| factor.natural(x)).collect())
}

/// Coded values of coordinate `i` at which the quadratic has the value `target`; ascending.
pub(crate) fn coded_roots(quadratic: &Quadratic, target: f64, point: &[f64], i: usize) -> Vec<f64> {
    let mut base = point.to_vec();
    base[i] = 0.0;
    let slope = quadratic.gradient(&base)[i];
    quadratic_roots(
        0.5 * quadratic.hessian[(i, i)],
        slope,
        quadratic.value(&base) - target,
    )
}

/// Real roots of a x^2 + b x + c, ascending, without cancellation; none if all three are zero.
pub(crate) fn quadratic_roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let mut roots: Vec<f64> = [q / a, c / q]
        .into_iter()
        .filter(|x| x.is_finite())
        .collect();
    roots.sort_by(f64::total_cmp);
    roots.dedup();
    roots
}

#[cfg(test)]
mod tests {
    use super::quadratic_roots;

    /// The small root of x^2 - 2e8 x + 1 is 5e-9; the schoolbook formula gives 0 or 7e-9.
    #[test]
    fn small_roots_keep_their_digits() {
        let roots = quadratic_roots(1.0, -2e8, 1.0);
        assert!((roots[0] / 5e-9 - 1.0).abs() < 1e-14, "{roots:?}");
        assert_eq!(quadratic_roots(0.0, 2.0, -1.0), [0.5]);
        assert!(quadratic_roots(1.0, 0.0, 1.0).is_empty());
        assert_eq!(quadratic_roots(1.0, 0.0, -4.0), [-2.0, 2.0]);
        assert_eq!(quadratic_roots(1.0, -2.0, 0.0), [0.0, 2.0]);
    }
}
