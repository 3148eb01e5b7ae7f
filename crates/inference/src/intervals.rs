//! From the least misfit to standard errors, intervals, correlations, and what the data leave open.

use crate::diagnosis::Whitener;
use crate::information::{
    bounded_inverse, by_inputs, spread_added, with_noisy_inputs, without_inputs,
};
use crate::joint_fit::{JointFit, Minimum, Target};
use crate::noisy_slopes::{
    growth_with_distance, noise_beside_inputs, noise_of_inputs, standing_out, without_noise,
};
use crate::{Error, Estimate, FitTest, InputEstimate, OpenCombination, Parameter, Prior};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use probability::{f_upper_tail, normal_quantile, t_two_sided_quantile};
use std::collections::BTreeMap;

/// Chance of the two tails outside an interval.
const TAILS: f64 = 0.05;
/// Beyond so many degrees of freedom Student's quantile is the normal one to five digits.
const MANY: f64 = 1e6;
/// Half the width of the limits, in widths of them: a combination with such a half interval or a wider one is open.
const OPEN: f64 = 0.5;
/// Share of a parameter (its squared weights) in open combinations from which it counts as open itself.
const SHARE: f64 = 0.1;
/// Halvings of the bracket of an end of an interval.
const HALVINGS: usize = 40;
/// Most of the variance at an end of an interval that slopes which are not known exactly may make: the interval then doubles. Slopes
/// that are known less are noise, and dropped as such.
const MOST_BEYOND: f64 = 0.75;
/// Distance from a limit, in widths of the limits, at which an estimate lies on it.
const ON_A_LIMIT: f64 = 1e-6;

/// What the estimate knows of its own error.
#[derive(Debug, Clone)]
pub(crate) struct Uncertainty {
    /// Covariance of the parameters, units of the parameters; along what nothing fixes it is that of an even spread over
    /// the limits.
    pub(crate) covariance: DMatrix<f64>,
    /// Directions in the space of the tuned parameters, in widths of the limits, with the standard error along each.
    directions: Vec<Direction>,
    /// The same from the measurements, with the inputs as they were stated but without any other prior.
    by_data: Vec<Direction>,
    /// By how much each tuned parameter moves if an input is one standard deviation larger, (tuned, inputs).
    by_inputs: DMatrix<f64>,
    /// Variance of each parameter over what it would be if weights and slopes along inputs were known.
    inflation: Vec<f64>,
    /// Factor by which the variance of each parameter is larger at the ends of its interval.
    growth: Vec<f64>,
    /// Effective degrees of freedom of each variance.
    degrees_of_freedom: Vec<f64>,
    /// Whether slopes count that the surfaces have: along a combination that was dropped as noise they do not.
    of_the_surfaces: bool,
}

/// A combination of parameters, in widths of the limits.
#[derive(Debug, Clone)]
struct Direction {
    /// Weights, of unit length.
    weights: DVector<f64>,
    /// Standard error along it, in widths of the limits.
    se: f64,
}

/// Principal directions of an information matrix.
fn directions(information: &DMatrix<f64>) -> Vec<Direction> {
    let eigen = SymmetricEigen::new(information.clone());
    let each = eigen.eigenvalues.iter().enumerate();
    each.map(|(i, value)| Direction {
        weights: eigen.eigenvectors.column(i).into_owned(),
        se: 1.0 / value.max(0.0).sqrt(),
    })
    .collect()
}

/// Whether a parameter takes part in a combination whose interval, `t` standard errors to each side, is as wide as the limits.
fn is_open(directions: &[Direction], j: usize, t: f64) -> bool {
    let open = directions.iter().filter(|d| t * d.se >= OPEN);
    open.map(|d| d.weights[j].powi(2)).sum::<f64>() > SHARE
}

impl Uncertainty {
    /// Of the estimate of a fit.
    ///
    /// # Formula
    ///
    /// Covariance `C = (J'V^-1 J + P)^-1`, J the slopes of the surfaces [as far as they stand out of their
    /// noise](standing_out), P the precisions of the priors. The parameters
    /// are `C J'V^-1 y + ...`, so that the variance of parameter j is a sum of parts, one for each measured mean or group of
    /// correlated ones (n - 1 degrees of freedom) and one for each surface (n - p); what priors and limits add is known. Its
    /// effective degrees of freedom are those of Satterthwaite: `(sum of parts)² / sum of (part² / degrees of freedom)`
    /// `[Satterthwaite1946]`; what an even spread over the limits adds is not measured and counts in neither sum. Because V is
    /// estimated too, C grows to
    /// `C + 2 C sum over parts of (A'(M B M + M tr(B M)) A / d) C`: A the slopes, M the part of V and `B = 1 - A C A'`, all
    /// whitened by V, d the degrees of freedom of the part, an estimated (Wishart) covariance matrix
    /// `[KenwardRoger1997, section 2]`. For independent variances that is `4 (1 - h_i) / d_i` times `j_i j_i'`, measurement by
    /// measurement, `j_i` its row of A and `h_i = j_i' C j_i`. A covariance whose correlations were shrunk by a share l counts as
    /// independent variances by l and as a whole matrix by the rest.
    ///
    /// Inputs are parameters with a prior: what their errors add to the covariance of the tuned ones is in C, across all
    /// measurements. To take a noisy slope along an input for 0 would make the input exact, so that all of them stay; but what
    /// [their noise adds](with_noisy_inputs) does not tell an input from a parameter that acts alike.
    pub(crate) fn new(fit: &JointFit<'_>, best: &Minimum, whitening: &Whitener) -> Self {
        let k = fit.parameters.len();
        let (_, jacobian) = fit.residuals(&best.coded, whitening, &[]);
        let n = fit.targets.len();
        // Slopes per width of the limits: then what is large and small is the same for all parameters.
        let width: Vec<f64> = fit
            .parameters
            .iter()
            .map(|p| p.limits[1] - p.limits[0])
            .collect();
        let mut scaled = DMatrix::from_fn(jacobian.nrows(), k, |i, j| {
            -jacobian[(i, j)] / fit.region.half(j) * width[j]
        });
        let tuned = fit.n_tuned();
        let by_surfaces = scaled.view((0, 0), (n, tuned)).into_owned();
        let known = standing_out(fit, best, whitening, (&by_surfaces, &width[..tuned]));
        scaled.view_mut((0, 0), (n, tuned)).copy_from(&known.slopes);
        let by_fit = scaled.tr_mul(&scaled);
        let noise = noise_of_inputs(fit, best, whitening, &width);
        let inputs = fit.parameters[tuned..].iter().zip(&width[tuned..]);
        let precisions: Vec<f64> = inputs
            .filter_map(|(input, width)| Some((width / input.prior?.sd).powi(2)))
            .collect();
        let corrected =
            |scaled: &DMatrix<f64>| with_noisy_inputs(&scaled.tr_mul(scaled), &noise, &precisions);
        let mut all = corrected(&scaled);
        if tuned < k {
            let of_inputs = all
                .view((tuned, tuned), (k - tuned, k - tuned))
                .into_owned();
            let noise = noise_beside_inputs(
                fit,
                best,
                whitening,
                (&known, &scaled),
                (&of_inputs, &width),
            );
            let kept = without_noise(&without_inputs(&all, tuned), &noise);
            let slopes = scaled.view((0, 0), (n, tuned)) * kept;
            scaled.view_mut((0, 0), (n, tuned)).copy_from(&slopes);
            all = corrected(&scaled);
        }
        let of_tuned = scaled.columns(0, tuned).into_owned();
        let priors = of_tuned.rows_range(n..).tr_mul(&of_tuned.rows_range(n..));
        let marginal = without_inputs(&all, tuned);
        let unscale =
            |m: DMatrix<f64>| DMatrix::from_fn(k, k, |i, j| m[(i, j)] * width[i] * width[j]);
        let covariance = bounded_inverse(&all);
        let degrees_of_freedom = effective(fit, best, whitening, &scaled, &covariance);
        let grown = with_estimated_weights(fit, best, whitening, &scaled, &covariance);
        let by_fit = bounded_inverse(&by_fit);
        let growth = growth_with_distance(
            fit,
            best,
            whitening,
            (&known, &scaled),
            (&covariance, &width),
        );
        let inflation = (0..k).map(|j| grown[(j, j)] / by_fit[(j, j)]).collect();
        let at_the_ends = |(growth, dof): (&f64, &f64)| {
            let beyond = (student(*dof).powi(2) - 1.0).max(0.0) * growth;
            1.0 / (1.0 - beyond.min(MOST_BEYOND))
        };
        let growth = growth
            .iter()
            .zip(&degrees_of_freedom)
            .map(at_the_ends)
            .collect();
        Self {
            directions: directions(&marginal),
            by_data: directions(&(&marginal - priors)),
            by_inputs: DMatrix::from_diagonal(&DVector::from_column_slice(&width[..tuned]))
                * by_inputs(&all, &precisions),
            covariance: unscale(grown),
            inflation,
            growth,
            degrees_of_freedom,
            of_the_surfaces: !known.dropped,
        }
    }

    /// Student's quantile for the 95 % interval of a parameter.
    fn quantile(&self, j: usize) -> f64 {
        student(self.degrees_of_freedom[j])
    }

    /// Correlations, (parameters, parameters); 0 beside a parameter that nothing fixes.
    pub(crate) fn correlation(&self, parameters: &[Parameter]) -> Vec<Vec<f64>> {
        let k = parameters.len();
        let fixed = |j: usize| self.standard_error(j, &parameters[j]).is_some();
        let entry = |i: usize, j: usize| {
            if i == j {
                return 1.0;
            }
            let scale = (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt();
            if fixed(i) && fixed(j) && scale > 0.0 {
                self.covariance[(i, j)] / scale
            } else {
                0.0
            }
        };
        (0..k)
            .map(|i| (0..k).map(|j| entry(i, j)).collect())
            .collect()
    }

    /// Standard error of a parameter; none where its interval would be as wide as the limits.
    fn standard_error(&self, j: usize, parameter: &Parameter) -> Option<f64> {
        let se = self.covariance[(j, j)].sqrt();
        let width = parameter.limits[1] - parameter.limits[0];
        let t = self.quantile(j);
        (t * se < OPEN * width && !is_open(&self.directions, j, t)).then_some(se)
    }

    /// Combinations of parameters whose interval is as wide as the limits, by the data alone.
    pub(crate) fn open_combinations(
        &self,
        parameters: &[Parameter],
        free: &[bool],
    ) -> Vec<OpenCombination> {
        // Of a combination no degrees of freedom are known: those of its parameters, the fewest.
        let free_ones = (0..parameters.len()).filter(|&j| free[j]);
        let t = |d: &Direction| {
            let taking_part = free_ones.clone().filter(|&j| d.weights[j].powi(2) > SHARE);
            taking_part.map(|j| self.quantile(j)).fold(0.0, f64::max)
        };
        let open = self.by_data.iter().filter(|d| t(d) * d.se >= OPEN);
        open.filter_map(|direction| {
            let weights: BTreeMap<String, f64> = direction
                .weights
                .iter()
                .enumerate()
                .filter(|(j, w)| free[*j] && w.abs() > 0.05)
                .map(|(j, w)| (parameters[j].symbol.clone(), *w))
                .collect();
            (!weights.is_empty()).then(|| OpenCombination {
                weights,
                se_in_widths: Some(direction.se).filter(|se| se.is_finite()),
            })
        })
        .collect()
    }
}

pub(crate) fn inputs(
    fit: &JointFit<'_>,
    best: &Minimum,
    uncertainty: &Uncertainty,
) -> Vec<InputEstimate> {
    let at = fit.natural(&best.coded);
    let (tuned, inputs) = fit.parameters.split_at(fit.n_tuned());
    let each = inputs.iter().enumerate().filter_map(|(place, input)| {
        let j = tuned.len() + place;
        let Prior { mean, sd } = input.prior?;
        let moves = tuned.iter().enumerate();
        Some(InputEstimate {
            symbol: input.symbol.clone(),
            name: input.name.clone(),
            unit: input.unit.clone(),
            sets: input.sets.clone(),
            stated: mean,
            sd,
            value: at[j],
            se: uncertainty.covariance[(j, j)].sqrt(),
            moved: (at[j] - mean) / sd,
            moves: moves
                .map(|(k, p)| (p.symbol.clone(), uncertainty.by_inputs[(k, place)]))
                .collect(),
        })
    });
    each.collect()
}

/// Estimates of the tuned parameters with their intervals.
///
/// # Formula
///
/// An end of an interval is where the least Q over all other parameters has risen by t² times the growth of the variance
/// by estimated weights and by `1 / (1 - (t² - 1) h)`, t Student's quantile for the effective degrees of freedom (profile) and h what
/// [the error of the slopes adds at one standard error](growth_with_distance) `[Fieller1954]`, once of which is in the variance; for a
/// plane with exact slopes that is `value +- t se`. If slopes were dropped as noise, the surfaces still have them, and the end is that of the plane. Outside the box
/// the surfaces say nothing: there the end is that of the plane too, at least the edge of the box. Ends are cut at the limits.
pub(crate) fn estimates(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    uncertainty: &Uncertainty,
) -> Vec<Estimate> {
    let at = fit.natural(&best.coded);
    let each = fit.parameters[..fit.n_tuned()].iter().enumerate();
    each.map(|(j, parameter)| {
        let [least, most] = parameter.limits;
        let width = most - least;
        let value = at[j];
        let se = uncertainty.standard_error(j, parameter);
        let interval95 = match se {
            Some(_) if fit.free[j] => {
                let ends =
                    [-1.0, 1.0].map(|side| end(fit, best, whitening, uncertainty, (j, side)));
                [ends[0].max(least), ends[1].min(most)]
            }
            _ => [least, most],
        };
        Estimate {
            symbol: parameter.symbol.clone(),
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            sets: parameter.sets.clone(),
            start: parameter.start,
            value,
            se: se.filter(|_| fit.free[j]),
            interval95,
            fixed_by_data: fit.free[j]
                && !is_open(&uncertainty.by_data, j, uncertainty.quantile(j)),
            at_limit: fit.free[j]
                && ((value - least).abs() < ON_A_LIMIT * width
                    || (most - value).abs() < ON_A_LIMIT * width),
            limits: parameter.limits,
        }
    })
    .collect()
}

/// One end of the interval of parameter j, unit of the parameter.
fn end(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    uncertainty: &Uncertainty,
    (j, side): (usize, f64),
) -> f64 {
    let t = uncertainty.quantile(j);
    let growth = uncertainty.growth[j];
    let half = t * (growth * uncertainty.covariance[(j, j)]).sqrt() / fit.region.half(j);
    if !uncertainty.of_the_surfaces {
        return fit.region.natural(j, best.coded[j] + side * half);
    }
    let limit = best.misfit + t * t * growth * uncertainty.inflation[j];
    if let Some(x) = crossing(fit, best, whitening, (j, side), half, limit) {
        return fit.region.natural(j, x);
    }
    let line = fit.region.natural(j, best.coded[j] + side * half);
    let edge = fit.region.natural(j, side);
    if side > 0.0 {
        line.max(edge)
    } else {
        line.min(edge)
    }
}

/// Where the least Q over all other parameters rises above a limit on the way from a minimum along parameter j, coded; none
/// where it does not do so inside the box. `step` is how far is looked first.
pub(crate) fn crossing(
    fit: &JointFit<'_>,
    from: &Minimum,
    whitening: &Whitener,
    (j, side): (usize, f64),
    step: f64,
    limit: f64,
) -> Option<f64> {
    let mut free = fit.free.clone();
    free[j] = false;
    let profile = |from: &[f64], x: f64| {
        let mut start = from.to_vec();
        start[j] = x;
        fit.minimise(&start, whitening, &free, &[])
    };
    let (mut inside, mut from) = (from.coded[j], from.coded.clone());
    let begin = inside;
    let mut step = step.max(1e-9);
    let mut outside = loop {
        let x = (begin + side * step).clamp(-1.0, 1.0);
        let there = profile(&from, x);
        if there.misfit > limit {
            break x;
        }
        if x.abs() >= 1.0 {
            return None;
        }
        (inside, from) = (x, there.coded);
        step *= 1.5;
    };
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        let there = profile(&from, middle);
        if there.misfit > limit {
            outside = middle;
        } else {
            (inside, from) = (middle, there.coded);
        }
        if (outside - inside).abs() < 1e-9 {
            break;
        }
    }
    Some(0.5 * (inside + outside))
}

/// Effective degrees of freedom of the variance of each parameter.
fn effective(
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
fn with_estimated_weights(
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
fn variance_dof(fit: &JointFit<'_>, best: &Minimum) -> Vec<f64> {
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

/// Two-sided 95 % quantile of Student's distribution, of the normal one for very many degrees of freedom.
pub(crate) fn student(degrees_of_freedom: f64) -> f64 {
    quantile_of(TAILS, degrees_of_freedom)
}

/// The t that |T| exceeds with a chance of `tails`.
pub(crate) fn quantile_of(tails: f64, degrees_of_freedom: f64) -> f64 {
    let student = t_two_sided_quantile(tails, degrees_of_freedom.min(MANY));
    let normal = || normal_quantile(1.0 - 0.5 * tails);
    student.or_else(normal).unwrap_or(f64::INFINITY)
}

/// Whether the fit leaves more than noise.
///
/// # Formula
///
/// Q over its degrees of freedom f = measurements + priors - parameters is compared with F(f, d), d the harmonic mean
/// of the effective degrees of freedom of the variances in V.
pub(crate) fn test(fit: &JointFit<'_>, best: &Minimum) -> FitTest {
    let rows = fit.targets.len() + fit.n_priors();
    let degrees_of_freedom = rows.saturating_sub(fit.n_free());
    let inverse: f64 = variance_dof(fit, best).iter().map(|dof| 1.0 / dof).sum();
    let denominator = (fit.targets.len() as f64 / inverse).min(MANY);
    let f = degrees_of_freedom as f64;
    FitTest {
        misfit: best.misfit,
        degrees_of_freedom,
        p: f_upper_tail(best.misfit / f, f, denominator),
    }
}

/// The error of a fit without a point; it cannot happen with one start or more.
pub(crate) fn best_of(minima: &[Minimum]) -> Result<&Minimum, Error> {
    minima.first().ok_or(Error::Search {
        what: "the estimate",
        reason: "no point was searched".into(),
    })
}
