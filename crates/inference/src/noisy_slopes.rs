//! Information in the slopes of the surfaces beyond their own noise.

use crate::diagnosis::Whitener;
use crate::joint_fit::{JointFit, Minimum, Target};
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use probability::f_upper_tail;
use std::ops::Range;

/// Chance that noise alone stands out, shared among the parameters.
const LEVEL: f64 = 0.05;
/// What is added to the information for its root, over the largest of a parameter: one may act on nothing at all.
const RIDGE: f64 = 1e-10;
/// Fraction of the information on a combination from which the surfaces with the least noise keep it.
const MOST: f64 = 0.5;

/// The noise of the slopes of one surface.
#[derive(Debug)]
struct Noise {
    /// Covariance of the slopes over the variance of a run, (parameters, parameters).
    slopes: DMatrix<f64>,
    /// Covariance of a run over the targets of the surface, whitened.
    of_run: DMatrix<f64>,
    /// Its trace, and that of its square.
    traces: [f64; 2],
    degrees_of_freedom: f64,
}

/// Slopes as far as they stand out of their noise.
#[derive(Debug)]
pub(crate) struct StandingOut {
    /// Whitened slopes, (targets, parameters).
    pub(crate) slopes: DMatrix<f64>,
    /// Whether a combination was dropped along which there were slopes.
    pub(crate) dropped: bool,
    /// By block, what the slopes were multiplied with from the right.
    kept: Vec<DMatrix<f64>>,
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
/// The information of the fit without the checks stays when they are added: the surfaces of both are tested apart first, and the remainder of
/// them together. If there are inputs, what noise adds is taken off [later](without_noise), since it matters beside them.
pub(crate) fn standing_out(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    (slopes, width): (&DMatrix<f64>, &[f64]),
) -> StandingOut {
    let k = slopes.ncols();
    let mut noises = noises(fit, best, whitening, (0..k, width));
    let blocks = fit.blocks();
    let of_check = |(_, block): &(usize, &[Target])| !fit.is_fitted(block[0].surface);
    let reduces = fit.n_tuned() == fit.parameters.len();
    let (mut known, mut rest) = (DMatrix::zeros(slopes.nrows(), k), slopes.clone());
    let mut maps = vec![[DMatrix::zeros(k, k), DMatrix::zeros(k, k)]; blocks.len()];
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
        let (kept, left) = parted(&own, k, reduces);
        for &i in &rows {
            maps[i] = [kept.clone(), left.clone()];
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
        let (kept, left) = parted(&all, k, reduces);
        known += &rest * &kept;
        dropped = left.amax() > 0.0;
        for [first, second] in &mut maps {
            *first += &*second * &kept;
        }
    }
    StandingOut {
        slopes: known,
        dropped,
        kept: maps.into_iter().map(|[kept, _]| kept).collect(),
    }
}

/// What noise of the slopes along tuned parameters adds on average to the information on them, (tuned, tuned), where the inputs are
/// known by their priors only.
///
/// # Formula
///
/// `sum over surfaces of G_s tr((I - h M_ii^-1 h')_s B_s)`, h the whitened slopes along the inputs and `M_ii` the information on them,
/// priors included: what an input explains of a measurement gives no information of the parameters.
pub(crate) fn noise_beside_inputs(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    (known, slopes): (&StandingOut, &DMatrix<f64>),
    (of_inputs, width): (&DMatrix<f64>, &[f64]),
) -> DMatrix<f64> {
    let tuned = fit.n_tuned();
    let noises = noises(fit, best, whitening, (0..tuned, width));
    let mut sum = DMatrix::zeros(tuned, tuned);
    // Each input has a prior, so that it has a root.
    let Some(root) = Cholesky::new(of_inputs.clone()) else {
        return sum;
    };
    let blocks = fit.blocks();
    for (((first, block), noise), map) in blocks.iter().zip(&noises).zip(&known.kept) {
        let along = slopes.view((*first, tuned), (block.len(), of_inputs.nrows()));
        let explained = along * root.solve(&along.transpose());
        let left = noise.traces[0] - (explained * &noise.of_run).trace();
        sum += map.tr_mul(&noise.slopes) * map * left.max(0.0);
    }
    sum
}

/// By how much the variance of each parameter is larger at one standard error from the estimate, over that variance, because the
/// slopes are not known exactly.
///
/// # Formula
///
/// `sum over surfaces of ((g'S g) (c'G c) + sum over targets i of g_i² sum over parameters a of c_a² H_ia) / C_jj²`, g the gains of
/// parameter j from the measured means, S the covariance of a run, c column j of the covariance C, G the covariance of the slopes
/// over the variance of a run, and H the [variance of slopes by what a quadratic leaves out](crate::surface::Surface::hidden_slopes)
/// `[Fieller1954]`.
pub(crate) fn growth_with_distance(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    (known, slopes): (&StandingOut, &DMatrix<f64>),
    (covariance, width): (&DMatrix<f64>, &[f64]),
) -> Vec<f64> {
    let (k, tuned) = (covariance.nrows(), fit.n_tuned());
    let at = fit.natural(&best.coded);
    let noises = noises(fit, best, whitening, (0..k, width));
    let gains = covariance * slopes.rows(0, fit.targets.len()).transpose();
    let gains = whitening.unwhiten_gains(&gains);
    let mut growth = vec![0.0; k];
    let blocks = fit.blocks();
    for (((first, block), noise), map) in blocks.iter().zip(&noises).zip(&known.kept) {
        let surface = &fit.surfaces[block[0].surface];
        let of_run =
            |a: usize, b: usize| surface.covariance[(block[a].observable, block[b].observable)];
        let of_run = DMatrix::from_fn(block.len(), block.len(), of_run);
        let hidden = block
            .iter()
            .map(|t| surface.hidden_slopes(t.observable, &at));
        let hidden: Vec<Vec<f64>> = hidden.collect();
        let mut kept = DMatrix::identity(k, k);
        kept.view_mut((0, 0), (tuned, tuned)).copy_from(map);
        let along = kept * covariance;
        for (j, growth) in growth.iter_mut().enumerate() {
            let gain = gains.row(j).columns(*first, block.len()).transpose();
            let along = along.column(j);
            let by_noise = (&of_run * &gain).dot(&gain) * (&noise.slopes * along).dot(&along);
            let by_hidden = gain.iter().zip(&hidden).map(|(gain, hidden)| {
                let each = surface.parameters.iter().zip(hidden);
                let each = each.map(|(&a, variance)| (width[a] * along[a]).powi(2) * variance);
                gain * gain * each.sum::<f64>()
            });
            *growth += (by_noise + by_hidden.sum::<f64>()) / covariance[(j, j)].powi(2);
        }
    }
    growth
}

/// What slopes are to be multiplied with from the right, so that their information is without what noise adds to it: `K'M K = M - N`
/// along the combinations that make M and N diagonal together, and nothing where N is more.
pub(crate) fn without_noise(information: &DMatrix<f64>, noise: &DMatrix<f64>) -> DMatrix<f64> {
    let ridge = RIDGE * information.diagonal().amax();
    let Some(common) = Common::new(information, noise, ridge) else {
        return DMatrix::identity(information.nrows(), information.nrows());
    };
    let kept = common.shares.map(|share| (1.0 - share).max(0.0).sqrt());
    common.onto(&kept)
}

/// The combinations of parameters that make information and noise diagonal together.
struct Common {
    /// Lower root of the information.
    root: DMatrix<f64>,
    /// Combinations, in the coordinates of the root.
    turned: DMatrix<f64>,
    /// Noise over information along each.
    shares: DVector<f64>,
}

impl Common {
    /// Of an information with a ridge on its diagonal; none if nothing depends on anything.
    fn new(information: &DMatrix<f64>, noise: &DMatrix<f64>, ridge: f64) -> Option<Self> {
        let k = information.nrows();
        let whole = information + DMatrix::from_diagonal_element(k, k, ridge);
        let root = Cholesky::new(whole)?.unpack();
        // The root has a positive diagonal: it can always be solved.
        let half = root.solve_lower_triangular(noise)?;
        let eigen = SymmetricEigen::new(root.solve_lower_triangular(&half.transpose())?);
        Some(Self {
            root,
            turned: eigen.eigenvectors,
            shares: eigen.eigenvalues,
        })
    }

    /// The combination of a number, of unit information.
    fn along(&self, i: usize) -> Option<DVector<f64>> {
        self.root.tr_solve_lower_triangular(&self.turned.column(i))
    }

    /// What slopes are to be multiplied with from the right, so that the combinations have these weights.
    fn onto(&self, weights: &DVector<f64>) -> DMatrix<f64> {
        let diagonal = DMatrix::from_diagonal(weights);
        let turned = &self.turned * diagonal * self.turned.transpose() * self.root.transpose();
        let solved = self.root.tr_solve_lower_triangular(&turned);
        solved.unwrap_or(turned)
    }
}

/// Slopes of one surface with their noise.
struct Row<'a> {
    slopes: DMatrix<f64>,
    noise: &'a Noise,
}

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
/// adds to it if it `reduces`, and to what does not.
fn parted(surfaces: &[Row<'_>], k: usize, reduces: bool) -> (DMatrix<f64>, DMatrix<f64>) {
    let (mut noise, mut whole) = (DMatrix::zeros(k, k), DMatrix::zeros(k, k));
    for surface in surfaces {
        noise += &surface.noise.slopes * surface.noise.traces[0];
        whole += surface.slopes.tr_mul(&surface.slopes);
    }
    let ridge = RIDGE * whole.diagonal().amax();
    let Some(common) = Common::new(&whole, &noise, ridge) else {
        return (DMatrix::identity(k, k), DMatrix::zeros(k, k));
    };
    // The root of the share of the information that is kept along a combination; 0 if it may be noise.
    let kept = |i: usize| {
        let share = common.shares[i];
        if share <= 0.0 {
            return 1.0;
        }
        let Some(along) = common.along(i) else {
            return 0.0;
        };
        // v'(A'A + ridge)v is 1: if the ridge makes most of it, there are no slopes to drop.
        if ridge * along.norm_squared() > 0.5 {
            return 1.0;
        }
        if !stands_out(surfaces, &along, LEVEL / k as f64) {
            0.0
        } else if reduces {
            (1.0 - share).max(0.0).sqrt()
        } else {
            1.0
        }
    };
    let kept = DVector::from_iterator(k, (0..k).map(kept));
    let left = kept.map(|x| if x == 0.0 { 1.0 } else { 0.0 });
    (common.onto(&kept), common.onto(&left))
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

/// What noise adds on average to the information on the inputs, (inputs, inputs), N of [`standing_out`] along them.
pub(crate) fn noise_of_inputs(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    width: &[f64],
) -> DMatrix<f64> {
    let inputs = fit.n_tuned()..fit.parameters.len();
    let zero = DMatrix::zeros(inputs.len(), inputs.len());
    let all = noises(fit, best, whitening, (inputs, width)).into_iter();
    all.fold(zero, |sum, noise| sum + noise.slopes * noise.traces[0])
}

/// The noise of the slopes of each surface along some of the parameters, per width.
fn noises(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    (along, width): (Range<usize>, &[f64]),
) -> Vec<Noise> {
    let at = fit.natural(&best.coded);
    let k = along.len();
    let of_block = |(number, (_, block)): (usize, (usize, &[Target]))| {
        let surface = &fit.surfaces[block[0].surface];
        let of_model = surface.slope_covariance(&at);
        let mut slopes = DMatrix::zeros(k, k);
        let places = surface.parameters.iter().enumerate();
        let places = places.filter(|(_, j)| along.contains(j));
        for (a, &i) in places.clone() {
            for (b, &j) in places.clone() {
                let [row, column] = [i, j].map(|j| j - along.start);
                slopes[(row, column)] = of_model[(a, b)] * width[i] * width[j];
            }
        }
        let of_run =
            |a: usize, b: usize| surface.covariance[(block[a].observable, block[b].observable)];
        let of_run = DMatrix::from_fn(block.len(), block.len(), of_run);
        let whitened = whitening.whiten_block(number, &of_run);
        Noise {
            slopes,
            traces: [whitened.trace(), (&whitened * &whitened).trace()],
            of_run: whitened,
            degrees_of_freedom: surface.degrees_of_freedom,
        }
    };
    fit.blocks().into_iter().enumerate().map(of_block).collect()
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
