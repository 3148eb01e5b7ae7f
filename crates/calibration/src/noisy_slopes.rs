//! What the slopes of the surfaces tell beyond their own noise.

use crate::joint_fit::{JointFit, Minimum, Target, Whitening};
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use probability::f_upper_tail;

/// Chance that noise alone stands out, shared among the parameters.
const LEVEL: f64 = 0.05;
/// What is added to the information for its root, over the largest of a parameter: one may act on nothing at all.
const RIDGE: f64 = 1e-10;

/// The noise of the slopes of one surface.
#[derive(Debug)]
struct Noise {
    /// Covariance of the slopes over the variance of a run, (parameters, parameters).
    slopes: DMatrix<f64>,
    /// Trace of the covariance of a run over the targets of the surface, whitened, and that of its square.
    traces: [f64; 2],
    /// Degrees of freedom of that covariance.
    degrees_of_freedom: f64,
}

/// Whitened slopes of the targets (rows, parameters) without what may be noise: combinations of parameters along which they do
/// not stand out of it are as if nothing depended on them.
///
/// With many targets the squares of many slopes that are noise add up to much: a parameter on which nothing depends would seem
/// to be known well.
///
/// # Formula
///
/// Of a combination v the targets tell `v'A'A v`, A the whitened slopes. Noise alone gives `v'N v` on average, N the sum over the
/// surfaces s of `G_s tr B_s`: `G_s = R (X'X)^-1 R'`, R the derivatives of the terms, and `B_s = L^-1 S L^-T`, S the covariance
/// of a run and L the root of that of the targets. Their ratio is compared with `F(f, d)`: `f = (v'N v)^2 / sum of (v'G_s v)^2
/// tr B_s^2` and `d = (v'N v)^2 / sum of (v'G_s v tr B_s)^2 / d_s` `[Satterthwaite1946]`. The combinations are those that make
/// `A'A` and N diagonal together.
pub(crate) fn standing_out(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitening,
    (slopes, width): (&DMatrix<f64>, &[f64]),
) -> DMatrix<f64> {
    let k = slopes.ncols();
    let noises = noises(fit, best, whitening, width);
    let empty = DMatrix::zeros(k, k);
    let all = noises.iter();
    let noise = all.fold(empty, |sum, n| sum + &n.slopes * n.traces[0]);
    let whole = slopes.tr_mul(slopes);
    let ridge = DMatrix::from_diagonal_element(k, k, RIDGE * whole.diagonal().amax());
    let Some(root) = Cholesky::new(&whole + ridge).map(Cholesky::unpack) else {
        // Nothing depends on anything.
        return slopes.clone();
    };
    // The root has a positive diagonal: it can always be solved.
    let Some(half) = root.solve_lower_triangular(&noise) else {
        return slopes.clone();
    };
    let Some(share) = root.solve_lower_triangular(&half.transpose()) else {
        return slopes.clone();
    };
    let eigen = SymmetricEigen::new(share);
    let is_noise = |i: usize| {
        let share = eigen.eigenvalues[i];
        let along = root.tr_solve_lower_triangular(&eigen.eigenvectors.column(i));
        share > 0.0 && along.is_some_and(|v| chance(&noises, &v, 1.0 / share) > LEVEL / k as f64)
    };
    let kept: Vec<usize> = (0..k).filter(|&i| !is_noise(i)).collect();
    if kept.len() == k {
        return slopes.clone();
    }
    let kept = eigen.eigenvectors.select_columns(&kept);
    let onto = &kept * kept.transpose() * root.transpose();
    let onto = root.tr_solve_lower_triangular(&onto).unwrap_or(onto);
    slopes * onto
}

/// The noise of the slopes of each surface, per width.
fn noises(fit: &JointFit<'_>, best: &Minimum, whitening: &Whitening, width: &[f64]) -> Vec<Noise> {
    let at = fit.natural(&best.coded);
    let k = fit.parameters.len();
    let of_block = |(first, block): (usize, &[Target])| {
        let surface = &fit.surfaces[block[0].surface];
        let of_model = surface.slope_covariance(&at);
        let mut slopes = DMatrix::zeros(k, k);
        for (a, &i) in surface.parameters.iter().enumerate() {
            for (b, &j) in surface.parameters.iter().enumerate() {
                slopes[(i, j)] = of_model[(a, b)] * width[i] * width[j];
            }
        }
        let of_run =
            |a: usize, b: usize| surface.covariance[(block[a].observable, block[b].observable)];
        let of_run = DMatrix::from_fn(block.len(), block.len(), of_run);
        let whitened = whitening.whitened(first, &of_run);
        Noise {
            slopes,
            traces: [whitened.trace(), (&whitened * &whitened).trace()],
            degrees_of_freedom: surface.degrees_of_freedom,
        }
    };
    fit.blocks().into_iter().map(of_block).collect()
}

/// Chance that noise alone gives so many times its mean along a combination of parameters.
fn chance(noises: &[Noise], along: &DVector<f64>, ratio: f64) -> f64 {
    let (mut sum, mut squares, mut of_variance) = (0.0, 0.0, 0.0);
    for noise in noises {
        let size = (&noise.slopes * along).dot(along);
        let part = size * noise.traces[0];
        sum += part;
        squares += size * size * noise.traces[1];
        of_variance += part * part / noise.degrees_of_freedom;
    }
    let [f, d] = [squares, of_variance].map(|x| sum * sum / x);
    f_upper_tail(ratio, f, d).unwrap_or(0.0)
}
