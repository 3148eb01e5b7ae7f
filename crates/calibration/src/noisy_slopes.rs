//! What the slopes of the surfaces tell beyond their own noise.

use crate::joint_fit::{JointFit, Minimum, Target, Whitening};
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use probability::f_upper_tail;

/// Chance that noise alone stands out, shared among the parameters.
const LEVEL: f64 = 0.05;
/// What is added to the information for its root, over the largest of a parameter: one may act on nothing at all.
const RIDGE: f64 = 1e-10;
/// Share of what is told of a combination from which the surfaces with the least noise keep it.
const MOST: f64 = 0.5;

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

/// Slopes as far as they stand out of their noise.
#[derive(Debug)]
pub(crate) struct StandingOut {
    /// Whitened slopes, (targets, parameters).
    pub(crate) slopes: DMatrix<f64>,
    /// Whether a combination was dropped along which there were slopes.
    pub(crate) dropped: bool,
}

/// Whitened slopes of the targets (rows, parameters) without what may be noise: combinations of parameters along which they do
/// not stand out of it are as if nothing depended on them, and along the others the information is without what noise adds.
///
/// With many targets the squares of many slopes that are noise add up to much: a parameter on which nothing depends would seem
/// to be known well. But what exact bench tests show stays, whatever the noise of the slopes of another experiment is.
///
/// # Formula
///
/// Of a combination v the targets tell `v'A'A v`, A the whitened slopes. Noise alone gives `v'N v` on average, N the sum over the
/// surfaces s of `G_s tr B_s`: `G_s = R (X'X)^-1 R'`, R the derivatives of the terms, and `B_s = L^-1 S L^-T`, S the covariance
/// of a run and L the root of that of the targets. The combinations are those that make `A'A` and N diagonal together. One stands
/// out if its ratio to noise does by a test of all surfaces, or of those with the least noise, as many as there are, of which each
/// number is tested at its part of the level: the ratio is compared with `F(f, d)`: `f = (v'N v)^2 / sum of (v'G_s v)^2 tr B_s^2`
/// and `d = (v'N v)^2 / sum of (v'G_s v tr B_s)^2 / d_s` `[Satterthwaite1946]`. They must tell half of what all tell beyond the noise
/// of the others. A combination that stands out keeps the information `v'A'A v - v'N v` `[Fuller1987]`.
///
/// What the fit tells without the checks stays when they are added: the surfaces of both are tested apart first, and what is left of
/// them together.
pub(crate) fn standing_out(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitening,
    (slopes, width): (&DMatrix<f64>, &[f64]),
) -> StandingOut {
    let k = slopes.ncols();
    let mut noises = noises(fit, best, whitening, width);
    let blocks = fit.blocks();
    let of_check = |(_, block): &(usize, &[Target])| !fit.is_fitted(block[0].surface);
    let (mut known, mut rest) = (DMatrix::zeros(slopes.nrows(), k), slopes.clone());
    let mut dropped = false;
    for group in [false, true] {
        let rows: Vec<usize> = (0..blocks.len())
            .filter(|&i| of_check(&blocks[i]) == group)
            .collect();
        if rows.is_empty() {
            continue;
        }
        let own: Vec<Row<'_>> = rows
            .iter()
            .map(|&i| row(&blocks[i], &noises[i], slopes))
            .collect();
        let (kept, left) = parted(&own, k);
        for &i in &rows {
            let (first, n) = (blocks[i].0, blocks[i].1.len());
            let whole = slopes.rows(first, n);
            known.rows_mut(first, n).copy_from(&(whole * &kept));
            rest.rows_mut(first, n).copy_from(&(whole * &left));
            noises[i].slopes = left.tr_mul(&noises[i].slopes) * &left;
        }
        dropped |= left.amax() > 0.0;
    }
    if dropped {
        let all = blocks.iter().zip(&noises);
        let all: Vec<Row<'_>> = all.map(|(block, noise)| row(block, noise, &rest)).collect();
        let (kept, left) = parted(&all, k);
        known += &rest * kept;
        dropped = left.amax() > 0.0;
    }
    StandingOut {
        slopes: known,
        dropped,
    }
}

/// Slopes of one surface with their noise.
struct Row<'a> {
    slopes: DMatrix<f64>,
    noise: &'a Noise,
}

/// That of a block.
fn row<'a>(
    (first, block): &(usize, &[Target]),
    noise: &'a Noise,
    slopes: &DMatrix<f64>,
) -> Row<'a> {
    Row {
        slopes: slopes.rows(*first, block.len()).into_owned(),
        noise,
    }
}

/// Two matrices, (parameters, parameters), to be multiplied to slopes from the right: to what stands out of noise, less what noise
/// adds to it, and to what does not.
fn parted(surfaces: &[Row<'_>], k: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let all = (DMatrix::identity(k, k), DMatrix::zeros(k, k));
    let (mut noise, mut whole) = (DMatrix::zeros(k, k), DMatrix::zeros(k, k));
    for surface in surfaces {
        noise += &surface.noise.slopes * surface.noise.traces[0];
        whole += surface.slopes.tr_mul(&surface.slopes);
    }
    let ridge = RIDGE * whole.diagonal().amax();
    let Some(root) =
        Cholesky::new(&whole + DMatrix::from_diagonal_element(k, k, ridge)).map(Cholesky::unpack)
    else {
        // Nothing depends on anything.
        return all;
    };
    // The root has a positive diagonal: it can always be solved.
    let half = root.solve_lower_triangular(&noise);
    let share = half.and_then(|half| root.solve_lower_triangular(&half.transpose()));
    let Some(share) = share else {
        return all;
    };
    let eigen = SymmetricEigen::new(share);
    // The root of the share of the information that is kept along a combination; 0 if it may be noise.
    let kept = |i: usize| {
        let share = eigen.eigenvalues[i];
        if share <= 0.0 {
            return 1.0;
        }
        let Some(along) = root.tr_solve_lower_triangular(&eigen.eigenvectors.column(i)) else {
            return 0.0;
        };
        // v'(A'A + ridge)v is 1: if the ridge makes most of it, there are no slopes to drop.
        if ridge * along.norm_squared() > 0.5 {
            return 1.0;
        }
        if stands_out(surfaces, &along, LEVEL / k as f64) {
            (1.0 - share).max(0.0).sqrt()
        } else {
            0.0
        }
    };
    let kept: Vec<f64> = (0..k).map(kept).collect();
    let onto = |of: &dyn Fn(f64) -> f64| {
        let weights = DVector::from_iterator(k, kept.iter().map(|x| of(*x)));
        let turned = &eigen.eigenvectors
            * DMatrix::from_diagonal(&weights)
            * eigen.eigenvectors.transpose()
            * root.transpose();
        root.tr_solve_lower_triangular(&turned).unwrap_or(turned)
    };
    (onto(&|x| x), onto(&|x| if x == 0.0 { 1.0 } else { 0.0 }))
}

/// Whether what surfaces tell of a combination stands out of their noise: of all, or of those with the least noise.
fn stands_out(surfaces: &[Row<'_>], along: &DVector<f64>, level: f64) -> bool {
    // Noise and information of each.
    let each = surfaces.iter().map(|surface| {
        let noise = surface.noise;
        let of_noise = (&noise.slopes * along).dot(along) * noise.traces[0];
        (of_noise, (&surface.slopes * along).norm_squared(), noise)
    });
    let mut each: Vec<(f64, f64, &Noise)> = each.collect();
    each.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = each.iter().map(|s| s.1).sum();
    let level = level / each.len().max(1) as f64;
    (1..=each.len()).any(|n| {
        let (some, others) = each.split_at(n);
        let of_noise: f64 = some.iter().map(|s| s.0).sum();
        let own: f64 = some.iter().map(|s| s.1).sum();
        let of_others: f64 = others.iter().map(|s| s.0).sum();
        let most = own > 0.0 && own >= MOST * (all - of_others);
        let some: Vec<&Noise> = some.iter().map(|s| s.2).collect();
        most && (of_noise <= 0.0 || chance(&some, along, own / of_noise) <= level)
    })
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
fn chance(noises: &[&Noise], along: &DVector<f64>, ratio: f64) -> f64 {
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
