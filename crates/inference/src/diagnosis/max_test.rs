//! The test of the largest score among collinear candidates.

use nalgebra::{DMatrix, DVector};
use probability::random_stream::Stream;

use crate::diagnosis::problem_file::Sign;

/// Most draws for one that holds all parameters at their limits: 12 unrelated ones are missed in 1 of 60 cases.
const MOST_TRIES: usize = 8192;

/// The null distribution of the largest statistic, by simulation.
///
/// # Formula
///
/// z ~ N(0, rho) with rho_jk = u_j'u_k / (|u_j||u_k|), exact whatever the collinearity; the
/// statistic of a sign-constrained candidate is 0 on the wrong side. Where parameters are held at their limits, the draws
/// are those that hold them there: what remains points along each outward direction. With a covariance estimated
/// with nu degrees of freedom z is divided by sqrt(chi2_nu / nu). p = (1 + draws at least as
/// large) / (1 + draws), which is a valid p-value for any number of draws
/// `[DavisonHinkley1997, section 4.2]`.
#[derive(Debug, Clone)]
pub(crate) struct MaxTest {
    /// Largest statistic of each draw, ascending.
    maxima: Vec<f64>,
}

impl MaxTest {
    /// Simulates the largest statistic of candidates with these unit directions and signs, given that what remains
    /// points along the `outward` directions.
    pub(crate) fn simulate(
        directions: &[&DVector<f64>],
        signs: &[Sign],
        outward: &[DVector<f64>],
        covariance_dof: Option<f64>,
        draws: usize,
        stream: &mut Stream,
    ) -> Self {
        let m = directions.len();
        let all: Vec<&DVector<f64>> = directions.iter().copied().chain(outward).collect();
        let n = all.len();
        let correlation = DMatrix::from_fn(n, n, |i, j| all[i].dot(all[j]));
        let factor = root(correlation);
        let (mut normals, mut z) = (DVector::zeros(n), DVector::zeros(n));
        let mut maxima: Vec<f64> = (0..draws)
            .map(|_| {
                for _ in 0..MOST_TRIES {
                    normals.iter_mut().for_each(|x| *x = stream.normal());
                    factor.mul_to(&normals, &mut z);
                    // A draw and its mirror image are equally likely.
                    let outside = |sign: f64| z.iter().skip(m).all(|z| z * sign >= 0.0);
                    if outside(1.0) {
                        break;
                    }
                    if outside(-1.0) {
                        z.neg_mut();
                        break;
                    }
                }
                let scale = covariance_dof
                    .map_or(1.0, |dof| (chi_squared(dof, stream) / dof).sqrt().recip());
                z.iter()
                    .zip(signs)
                    .map(|(z, sign)| sign.statistic(z * scale))
                    .fold(0.0, f64::max)
            })
            .collect();
        maxima.sort_by(f64::total_cmp);
        Self { maxima }
    }

    /// Chance that the largest statistic is at least this under the null hypothesis.
    pub(crate) fn p(&self, statistic: f64) -> f64 {
        let below = self.maxima.partition_point(|&m| m < statistic);
        (1 + self.maxima.len() - below) as f64 / (1 + self.maxima.len()) as f64
    }

    /// The statistic that is exceeded with chance `alpha`; infinite when there are too few draws.
    pub(crate) fn critical(&self, alpha: f64) -> f64 {
        let first = self.maxima.partition_point(|&m| self.p(m) > alpha);
        self.maxima.get(first).copied().unwrap_or(f64::INFINITY)
    }
}

/// A factor F with F F' = a correlation or covariance, which may be singular.
pub(crate) fn root(correlation: DMatrix<f64>) -> DMatrix<f64> {
    if correlation.is_empty() {
        return correlation;
    }
    let eigen = correlation.symmetric_eigen();
    let mut factor = eigen.eigenvectors;
    for (mut column, value) in factor.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(0.0).sqrt();
    }
    factor
}

/// Draws from chi2 with any number of degrees of freedom `[MarsagliaTsang2000]`.
pub(crate) fn chi_squared(dof: f64, stream: &mut Stream) -> f64 {
    let shape = dof / 2.0;
    if shape < 1.0 {
        // Their boost: Gamma(a) = Gamma(a + 1) U^(1/a).
        let boost = (1.0 - stream.uniform()).powf(1.0 / shape);
        return chi_squared(dof + 2.0, stream) * boost;
    }
    let d = shape - 1.0 / 3.0;
    let c = (9.0 * d).sqrt().recip();
    loop {
        let x = stream.normal();
        let v = (1.0 + c * x).powi(3);
        let u = 1.0 - stream.uniform();
        if v > 0.0 && u.ln() < 0.5 * x * x + d - d * v + d * v.ln() {
            return 2.0 * d * v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{MaxTest, chi_squared};
    use crate::diagnosis::problem_file::Sign;
    use nalgebra::dvector;
    use probability::random_stream::Stream;

    /// Two orthogonal candidates: P(max |z| < c) = P(|z| < c)^2. Identical ones count once. One
    /// sign allowed: half the tail. Tolerance: four standard errors of 100 000 draws.
    #[test]
    fn largest_score_follows_its_exact_law_in_the_limits_of_collinearity() {
        let (e1, e2) = (dvector![1.0, 0.0], dvector![0.0, 1.0]);
        let tail = 0.05_f64; // two-sided tail at 1.959964
        let p = |directions: &[_], sign| {
            MaxTest::simulate(
                directions,
                &[sign; 2],
                &[],
                None,
                100_000,
                &mut Stream::new(1, "max"),
            )
            .p(1.959_964)
        };
        let error = 4.0 * (0.1 * 0.9_f64 / 1e5).sqrt();
        let orthogonal = p(&[&e1, &e2], Sign::Any);
        assert!((orthogonal - (1.0 - 0.95_f64.powi(2))).abs() < error);
        assert!((p(&[&e1, &e1], Sign::Any) - tail).abs() < error);
        assert!((p(&[&e1, &e1], Sign::Positive) - tail / 2.0).abs() < error);
    }

    /// With nu = 4 the score is Student's t: two-sided 5 % point 2.776445.
    #[test]
    fn score_with_an_estimated_covariance_is_students_t() {
        let e1 = dvector![1.0];
        let mut stream = Stream::new(1, "t");
        let test = MaxTest::simulate(&[&e1], &[Sign::Any], &[], Some(4.0), 100_000, &mut stream);
        let p = test.p(2.776_445);
        assert!(
            (p - 0.05).abs() < 4.0 * (0.05 * 0.95_f64 / 1e5).sqrt(),
            "{p}"
        );
        assert!((test.critical(0.05) - 2.776).abs() < 0.05);
    }

    /// Mean nu and variance 2 nu within four standard errors; nu = 1.5 takes the boost.
    #[test]
    fn chi_squared_draws_have_their_mean() {
        for dof in [1.5, 7.0] {
            let mut stream = Stream::new(2, "chi");
            let n = 100_000;
            let sum: f64 = (0..n).map(|_| chi_squared(dof, &mut stream)).sum();
            let mean = sum / f64::from(n);
            assert!((mean - dof).abs() < 4.0 * (2.0 * dof / f64::from(n)).sqrt());
        }
    }
}
