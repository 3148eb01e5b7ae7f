//! The covariance of an estimate, and which combinations of parameters the data leave open.

use super::student;
use super::weights::{effective, with_estimated_weights};
use crate::diagnosis::Whitener;
use crate::information::{bounded_inverse, by_inputs, with_noisy_inputs, without_inputs};
use crate::joint_fit::{JointFit, Minimum};
use crate::noisy_slopes::{
    StandingOut, growth_with_distance, noise_beside_inputs, noise_of_inputs, standing_out,
    without_noise,
};
use crate::{OpenCombination, Parameter};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::collections::BTreeMap;

/// Half the width of the limits, in widths of them: a combination with such a half interval or a wider one is open.
const OPEN: f64 = 0.5;
/// Share of a parameter (its squared weights) in open combinations from which it counts as open itself.
pub(crate) const SHARE: f64 = 0.1;
/// Most of the variance at an end of an interval that slopes which are not known exactly may make: the interval then doubles. Slopes
/// that are known less are noise, and dropped as such.
const MOST_BEYOND: f64 = 0.75;

/// What the estimate knows of its own error.
#[derive(Debug, Clone)]
pub(crate) struct Uncertainty {
    /// Covariance of the parameters, units of the parameters; along what nothing fixes it is that of an even spread over
    /// the limits.
    pub(crate) covariance: DMatrix<f64>,
    /// Directions in the space of the tuned parameters, in widths of the limits, with the standard error along each.
    directions: Vec<Direction>,
    /// The same from the measurements, with the inputs as they were stated but without any other prior.
    pub(super) by_data: Vec<Direction>,
    /// By how much each tuned parameter moves if an input is one standard deviation larger, (tuned, inputs).
    pub(super) by_inputs: DMatrix<f64>,
    /// Variance of each parameter over what it would be if weights and slopes along inputs were known.
    pub(super) inflation: Vec<f64>,
    /// Factor by which the variance of each parameter is larger at the ends of its interval.
    pub(super) growth: Vec<f64>,
    /// Effective degrees of freedom of each variance.
    degrees_of_freedom: Vec<f64>,
    /// Whether slopes count that the surfaces have: along a combination that was dropped as noise they do not.
    pub(super) of_the_surfaces: bool,
}

/// A combination of parameters, in widths of the limits.
#[derive(Debug, Clone)]
pub(super) struct Direction {
    /// Weights, of unit length.
    weights: DVector<f64>,
    /// Standard error along it, in widths of the limits.
    se: f64,
}

/// Slopes of the fit at its estimate per width of the limits, so that large and small are the same for all parameters.
struct Slopes {
    /// Whitened slopes and the rows of the priors, (targets and priors, parameters); slopes that are noise are 0.
    scaled: DMatrix<f64>,
    known: StandingOut,
    /// Information before the noise of slopes along inputs is taken off.
    by_fit: DMatrix<f64>,
    /// Information of all parameters.
    information: DMatrix<f64>,
    /// Precisions of the inputs by their priors.
    precisions: Vec<f64>,
}

impl Slopes {
    fn new(fit: &JointFit<'_>, best: &Minimum, whitening: &Whitener, width: &[f64]) -> Self {
        let (k, n, tuned) = (fit.parameters.len(), fit.targets.len(), fit.n_tuned());
        let (_, jacobian) = fit.residuals(&best.coded, whitening, &[]);
        let mut scaled = DMatrix::from_fn(jacobian.nrows(), k, |i, j| {
            -jacobian[(i, j)] / fit.region.half(j) * width[j]
        });
        let by_surfaces = scaled.view((0, 0), (n, tuned)).into_owned();
        let known = standing_out(fit, best, whitening, (&by_surfaces, &width[..tuned]));
        scaled.view_mut((0, 0), (n, tuned)).copy_from(&known.slopes);
        let by_fit = scaled.tr_mul(&scaled);
        let noise = noise_of_inputs(fit, best, whitening, width);
        let inputs = fit.parameters[tuned..].iter().zip(&width[tuned..]);
        let precisions: Vec<f64> = inputs
            .filter_map(|(input, width)| Some((width / input.prior?.sd).powi(2)))
            .collect();
        let corrected =
            |scaled: &DMatrix<f64>| with_noisy_inputs(&scaled.tr_mul(scaled), &noise, &precisions);
        let mut information = corrected(&scaled);
        if tuned < k {
            let of_inputs = information.view((tuned, tuned), (k - tuned, k - tuned));
            let noise = noise_beside_inputs(
                fit,
                best,
                whitening,
                (&known, &scaled),
                (&of_inputs.into_owned(), width),
            );
            let kept = without_noise(&without_inputs(&information, tuned), &noise);
            let slopes = scaled.view((0, 0), (n, tuned)) * kept;
            scaled.view_mut((0, 0), (n, tuned)).copy_from(&slopes);
            information = corrected(&scaled);
        }
        Self {
            scaled,
            known,
            by_fit,
            information,
            precisions,
        }
    }
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
pub(super) fn is_open(directions: &[Direction], j: usize, t: f64) -> bool {
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
    /// [their noise adds](with_noisy_inputs) does not distinguish an input from a parameter that acts alike.
    pub(crate) fn new(fit: &JointFit<'_>, best: &Minimum, whitening: &Whitener) -> Self {
        let (k, tuned) = (fit.parameters.len(), fit.n_tuned());
        let limits = fit.parameters.iter().map(|p| p.limits);
        let width: Vec<f64> = limits.map(|[least, most]| most - least).collect();
        let slopes = Slopes::new(fit, best, whitening, &width);
        let Slopes {
            scaled,
            known,
            information,
            ..
        } = &slopes;
        let n = fit.targets.len();
        let of_tuned = scaled.columns(0, tuned).into_owned();
        let priors = of_tuned.rows_range(n..).tr_mul(&of_tuned.rows_range(n..));
        let marginal = without_inputs(information, tuned);
        let covariance = bounded_inverse(information);
        let degrees_of_freedom = effective(fit, best, whitening, scaled, &covariance);
        let grown = with_estimated_weights(fit, best, whitening, scaled, &covariance);
        let by_fit = bounded_inverse(&slopes.by_fit);
        let growth =
            growth_with_distance(fit, best, whitening, (known, scaled), (&covariance, &width));
        let at_the_ends = |(growth, dof): (&f64, &f64)| {
            let beyond = (student(*dof).powi(2) - 1.0).max(0.0) * growth;
            1.0 / (1.0 - beyond.min(MOST_BEYOND))
        };
        let growth = growth.iter().zip(&degrees_of_freedom).map(at_the_ends);
        Self {
            directions: directions(&marginal),
            by_data: directions(&(&marginal - priors)),
            by_inputs: DMatrix::from_diagonal(&DVector::from_column_slice(&width[..tuned]))
                * by_inputs(information, &slopes.precisions),
            inflation: (0..k).map(|j| grown[(j, j)] / by_fit[(j, j)]).collect(),
            covariance: DMatrix::from_fn(k, k, |i, j| grown[(i, j)] * width[i] * width[j]),
            growth: growth.collect(),
            degrees_of_freedom,
            of_the_surfaces: !known.dropped,
        }
    }

    /// Student's quantile for the 95 % interval of a parameter.
    pub(super) fn quantile(&self, j: usize) -> f64 {
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

    /// Standard error of a parameter; `None` if its interval would be as wide as the limits.
    pub(crate) fn standard_error(&self, j: usize, parameter: &Parameter) -> Option<f64> {
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
