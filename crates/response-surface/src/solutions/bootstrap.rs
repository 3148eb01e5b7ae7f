//! How the nearest solution scatters with the data.

use nalgebra::{Cholesky, DMatrix, DVector};
use probability::random_stream::Stream;
use serde::{Deserialize, Serialize};

use super::nearest::{metrics, nearest};
use super::{SolutionRequest, check};
use crate::fit::ErrorVariance;
use crate::{Error, Fit, NamedValues};

/// A point in coded coordinates.
type CodedPoint = Vec<f64>;

/// The nearest solutions of redrawn experiments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bootstrap {
    /// Metric of the nearest solution.
    pub metric: String,
    /// Number of redrawn experiments.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Error variance that the experiments were redrawn with.
    pub error: ErrorVariance,
    /// Share of the redrawn experiments whose surface does not meet the redrawn target in the box.
    pub no_solution: f64,
    /// Each factor at the nearest solutions of the other samples.
    pub factors: NamedValues<BootstrapFactor>,
}

/// A factor over the nearest solutions of redrawn experiments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BootstrapFactor {
    /// Median, unit of the factor.
    pub median: f64,
    /// Quantiles 2.5 % and 97.5 %, unit of the factor; no interval where a bound holds much of the
    /// probability.
    pub quantiles95: [f64; 2],
    /// Share of the solutions that lie on the low bound.
    pub at_low: f64,
    /// Share of the solutions that lie on the high bound.
    pub at_high: f64,
}

/// Redraws the experiment and solves it again, under each metric that the request allows.
///
/// # Formula
/// Coefficients `beta + s L z` with `L L' = (X'WX)^-1` and a target `T + s_T z`: with normal errors of one
/// variance this is the law of the coefficients of a repeated experiment, so the cells themselves
/// need not be redrawn. Resampling five replicates within their cells would shrink the variance to
/// 4/5.
///
/// # Source
/// Parametric bootstrap: `[EfronTibshirani1993, section 6.5]`.
///
/// # Errors
/// As [`super::solutions`]; [`Error::NoErrorVariance`]; [`Error::SettingOutOfRange`] unless 100 to
/// 100 000 draws are asked for.
pub fn bootstrap(
    fit: &Fit,
    request: &SolutionRequest,
    draws: usize,
    seed: u64,
) -> Result<Vec<Bootstrap>, Error> {
    let target_se = check(fit, request)?.unwrap_or(0.0);
    if !(100..=100_000).contains(&draws) {
        return Err(Error::SettingOutOfRange {
            what: "the number of redrawn experiments",
            value: draws as f64,
            range: "100 to 100000",
        });
    }
    fit.quadratic()?;
    let undefined = Error::NoErrorVariance {
        source_of_error: "residual",
        way_out: "add replicates, or fit fewer terms",
    };
    let error = fit
        .chosen_error(request.error)?
        .ok_or_else(|| undefined.clone())?;
    let lower = Cholesky::new(model_covariance(fit)).ok_or(undefined)?.l() * error.variance.sqrt();
    let centre = DVector::from_vec(fit.coefficients());
    let metrics = metrics(fit, request);
    let mut solved: Vec<Vec<CodedPoint>> = vec![Vec::new(); metrics.len()];
    let mut stream = Stream::new(seed, "nearest solution");
    for _ in 0..draws {
        let z = DVector::from_fn(centre.len(), |_, _| stream.normal());
        let drawn = &centre + &lower * z;
        let target = request.target + target_se * stream.normal();
        let quadratic = fit.quadratic_of(drawn.as_slice())?;
        for (metric, list) in metrics.iter().zip(&mut solved) {
            list.extend(
                nearest(fit, &quadratic, target, &metric.near, &metric.scale).map(|n| n.coded),
            );
        }
    }
    let summary = |(metric, list): (&super::nearest::NamedMetric, Vec<CodedPoint>)| Bootstrap {
        metric: metric.name.to_owned(),
        draws,
        seed,
        error,
        no_solution: 1.0 - list.len() as f64 / draws as f64,
        factors: if list.is_empty() {
            NamedValues::default()
        } else {
            let all = fit.factors.iter().enumerate();
            all.map(|(j, f)| (f.symbol().to_owned(), of_factor(f, j, &list)))
                .collect()
        },
    };
    Ok(metrics.iter().zip(solved).map(summary).collect())
}

/// (X'WX)^-1 of the terms of the model, without blocks.
fn model_covariance(fit: &Fit) -> DMatrix<f64> {
    let terms = fit.formula.terms().len();
    let blocks = fit.p - terms;
    let place = |i: usize| if i == 0 { 0 } else { i + blocks };
    DMatrix::from_fn(terms, terms, |i, j| fit.xtx_inverse[place(i)][place(j)])
}

/// Quantiles and bounds of one factor.
fn of_factor(factor: &experiment_design::Factor, j: usize, list: &[Vec<f64>]) -> BootstrapFactor {
    let values: Vec<f64> = list.iter().map(|x| x[j]).collect();
    let n = values.len();
    let share =
        |at: &dyn Fn(f64) -> bool| values.iter().filter(|x| at(**x)).count() as f64 / n as f64;
    let quantile = |p: f64| factor.natural(probability::quantile(&values, p));
    BootstrapFactor {
        median: quantile(0.5),
        quantiles95: [quantile(0.025), quantile(0.975)],
        at_low: share(&|x| x <= -1.0),
        at_high: share(&|x| x >= 1.0),
    }
}
