//! Covariance of many observables over few degrees of freedom.

use nalgebra::DMatrix;

/// A covariance from sums of products, and the share by which its correlations were shrunk.
///
/// With few degrees of freedom for many observables the plain estimate is singular, and weighted least squares leans on
/// combinations whose variance happens to be small.
///
/// # Formula
///
/// The variances are `products / d`. A correlation r becomes `(1 - l) r` with `l = sum var(r) / sum r²` over all pairs, 1 at most,
/// and `var(r) = 1 / d`, that of independent normal values `[SchaeferStrimmer2005, table 1]`. Since r² is 1 at most, l is never
/// less than 1 / d, and the result is positive definite wherever the variances are positive.
pub(super) fn shrunk(products: &DMatrix<f64>, degrees_of_freedom: f64) -> (DMatrix<f64>, f64) {
    let n = products.nrows();
    let root = |k: usize| products[(k, k)].max(0.0).sqrt();
    let correlation = |a: usize, b: usize| {
        let scale = root(a) * root(b);
        if scale > 0.0 {
            products[(a, b)] / scale
        } else {
            0.0
        }
    };
    let pairs = (0..n).flat_map(|a| (0..a).map(move |b| (a, b)));
    let (mut variance, mut square) = (0.0, 0.0);
    for (a, b) in pairs.filter(|&(a, b)| root(a) * root(b) > 0.0) {
        variance += 1.0 / degrees_of_freedom;
        square += correlation(a, b).powi(2);
    }
    let share = if square > variance {
        variance / square
    } else {
        1.0
    };
    let covariance = DMatrix::from_fn(n, n, |a, b| {
        let kept = if a == b { 1.0 } else { 1.0 - share };
        kept * products[(a, b)] / degrees_of_freedom
    });
    (covariance, share)
}

#[cfg(test)]
mod tests {
    use super::shrunk;
    use nalgebra::DMatrix;

    /// Of three observables over 4 degrees of freedom the products are singular; shrunk they are not. By hand: correlations 1, 0.5 and
    /// 0.5, so that l = (3 / 4) / (1 + 0.25 + 0.25) = 0.5.
    #[test]
    fn a_covariance_of_few_runs_is_positive_definite() {
        let products = [4.0, 4.0, 2.0, 4.0, 4.0, 2.0, 2.0, 2.0, 4.0_f64];
        let products = DMatrix::from_row_slice(3, 3, &products);
        assert!(products.determinant().abs() < 1e-12);
        let (covariance, share) = shrunk(&products, 4.0);
        assert!((share - 0.5).abs() < 1e-15, "{share}");
        let expected = [1.0, 0.5, 0.25, 0.5, 1.0, 0.25, 0.25, 0.25, 1.0];
        let expected = DMatrix::from_row_slice(3, 3, &expected);
        assert!((&covariance - expected).amax() < 1e-15, "{covariance}");
        assert!(nalgebra::Cholesky::new(covariance).is_some());
    }
}
