//! Variances that are estimates themselves: effective degrees of freedom, and the growth of the covariance by them.

use crate::diagnosis::Whitener;
use crate::information::spread_added;
use crate::joint_fit::{JointFit, Minimum, Target};
use nalgebra::DMatrix;

/// Effective degrees of freedom of the variance of each parameter.
pub(super) fn effective(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    scaled: &DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> Vec<f64> {
    let at = fit.natural(&best.coded);
    let n = fit.targets.len();
    // Gains of the parameters from the measured values: C J' V^-1, block by block.
    let whitened_gain = covariance * scaled.rows(0, n).transpose();
    let gain = whitening.unwhiten_gains(&whitened_gain);
    let mut squares = vec![0.0; fit.parameters.len()];
    for (first, block) in fit.blocks() {
        for part in estimated_parts(fit, block, &at) {
            for (j, squares) in squares.iter_mut().enumerate() {
                let g = gain.row(j).columns(first, block.len()).transpose();
                *squares += (&part.covariance * &g).dot(&g).powi(2) / part.degrees_of_freedom;
            }
        }
    }
    // What priors add is known: it has all degrees of freedom.
    let information = scaled.tr_mul(scaled);
    let spread = spread_added(&information);
    let of_spread = covariance * spread * covariance;
    let each = squares.iter().enumerate();
    each.map(|(j, squares)| {
        if *squares > 0.0 {
            (covariance[(j, j)] - of_spread[(j, j)]).powi(2) / squares
        } else {
            f64::INFINITY
        }
    })
    .collect()
}

/// A covariance that was estimated: part of V of one block.
struct EstimatedPart {
    /// The covariance, over the targets of the block.
    covariance: DMatrix<f64>,
    degrees_of_freedom: f64,
    /// Share by which its correlations were shrunk.
    shrinkage: f64,
}

/// What V of a block is made of: the covariance of the surface, and one of each group of measured means that go together. Means
/// that do were read from the same frames: of their degrees of freedom the fewest count.
fn estimated_parts(fit: &JointFit<'_>, block: &[Target], at: &[f64]) -> Vec<EstimatedPart> {
    let measured = fit.measured_covariance(block, at);
    let mut parts = vec![EstimatedPart {
        covariance: fit.surface_covariance(block, at),
        degrees_of_freedom: fit.surfaces[block[0].surface].degrees_of_freedom,
        shrinkage: fit.surfaces[block[0].surface].shrinkage,
    }];
    let mut grouped = vec![false; block.len()];
    for first in 0..block.len() {
        if grouped[first] {
            continue;
        }
        grouped[first] = true;
        let mut group = vec![first];
        let mut next = 0;
        while let Some(&a) = group.get(next) {
            for b in 0..block.len() {
                if !grouped[b] && measured[(a, b)] != 0.0 {
                    grouped[b] = true;
                    group.push(b);
                }
            }
            next += 1;
        }
        let inside = |k: usize| f64::from(u8::from(group.contains(&k)));
        let (n, each) = (block.len(), group.iter());
        let degrees = each.map(|&k| block[k].degrees_of_freedom);
        parts.push(EstimatedPart {
            covariance: DMatrix::from_fn(n, n, |a, b| measured[(a, b)] * inside(a) * inside(b)),
            degrees_of_freedom: degrees.fold(f64::INFINITY, f64::min),
            shrinkage: 0.0,
        });
    }
    parts
}

/// The covariance of the parameters where the weights are estimates.
pub(super) fn with_estimated_weights(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    scaled: &DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> DMatrix<f64> {
    let at = fit.natural(&best.coded);
    let k = fit.parameters.len();
    let mut sum = DMatrix::zeros(k, k);
    for (number, (first, block)) in fit.blocks().into_iter().enumerate() {
        let n = block.len();
        let slopes = scaled.rows(first, n);
        let left = DMatrix::identity(n, n) - slopes * covariance * slopes.transpose();
        for part in estimated_parts(fit, block, &at) {
            let turned = |covariance: &DMatrix<f64>| {
                let m = whitening.whiten_block(number, covariance);
                &m * &left * &m + &m * (&left * &m).trace()
            };
            let mut whole = turned(&part.covariance) * (1.0 - part.shrinkage);
            if part.shrinkage > 0.0 {
                for k in 0..n {
                    let mut alone = DMatrix::zeros(n, n);
                    alone[(k, k)] = part.covariance[(k, k)];
                    whole += turned(&alone) * part.shrinkage;
                }
            }
            sum += slopes.transpose() * whole * slopes * (2.0 / part.degrees_of_freedom);
        }
    }
    covariance + covariance * sum * covariance
}

/// Degrees of freedom of the variance of each target: measured mean and surface together.
pub(super) fn variance_dof(fit: &JointFit<'_>, best: &Minimum) -> Vec<f64> {
    let at = fit.natural(&best.coded);
    let mut all = Vec::new();
    for (_, block) in fit.blocks() {
        let surface = fit.surface_covariance(block, &at);
        let dof = fit.surfaces[block[0].surface].degrees_of_freedom;
        for (k, target) in block.iter().enumerate() {
            let (a, b) = (fit.measured_variance(target, &at), surface[(k, k)]);
            let squares = a * a / target.degrees_of_freedom + b * b / dof;
            all.push((a + b).powi(2) / squares.max(f64::MIN_POSITIVE));
        }
    }
    all
}
