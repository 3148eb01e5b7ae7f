//! Residuals and the influence of single observations.

use serde::{Deserialize, Serialize};

use super::anova::Sums;
use super::matrix::Matrix;
use super::ratio;
use crate::Observations;
use crate::fit::least_squares::LeastSquares;

/// Below this a 1 - leverage is rounding: the observation is fitted exactly.
const FITTED_EXACTLY: f64 = 1e-10;

/// An observation with its residual and influence.
///
/// # Formula
/// w weight, e residual, h leverage, s^2 mse, p coefficients: internal r = e sqrt(w) /
/// (s sqrt(1-h)); external: the same with s of the fit without the observation; Cook's
/// D = r^2 h / (p (1-h)); DFFITS = external sqrt(h / (1-h)).
///
/// # Source
/// `[Cook1977]`; `[Belsley1980, section 2.1]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Number of the observation, from 1.
    pub run: usize,
    /// Coded settings of the factors.
    pub coded: Vec<f64>,
    /// Weight in the fit; the weights have mean 1.
    pub weight: f64,
    /// Observed mean, unit of the response.
    pub actual: f64,
    /// Fitted value, unit of the response.
    pub fitted: f64,
    /// Observed minus fitted, unit of the response.
    pub residual: f64,
    /// Diagonal of the hat matrix.
    pub leverage: f64,
    /// Residual over its standard error; none at leverage 1 or without degrees of freedom.
    pub studentized_internal: Option<f64>,
    /// The same with the error estimated without this observation.
    pub studentized_external: Option<f64>,
    /// Cook's distance.
    pub cooks_d: Option<f64>,
    /// Change of the fitted value without this observation over its standard error.
    pub dffits: Option<f64>,
}

/// All cases in the order of the observations.
pub(crate) fn cases(
    data: &Observations,
    matrix: &Matrix,
    solved: &LeastSquares,
    sums: &Sums,
    df_resid: usize,
) -> Vec<Case> {
    let p = matrix.names.len() as f64;
    let df = df_resid as f64;
    let case = |i: usize| {
        let (h, w) = (solved.leverages[i], matrix.weights[i]);
        let residual = sums.residuals[i];
        let fitted = matrix.response[i] - residual;
        let free = Some(1.0 - h).filter(|free| *free > FITTED_EXACTLY);
        let scaled = |variance: f64| {
            let free = free?;
            ratio(residual * w.sqrt(), (variance * free).sqrt())
        };
        let without = free.map(|free| (sums.sse - w * residual * residual / free) / (df - 1.0));
        let internal = (df_resid > 0).then(|| scaled(sums.sse / df)).flatten();
        let external = without
            .filter(|variance| df_resid > 1 && *variance > 1e-14 * sums.sse / df)
            .and_then(scaled);
        Case {
            run: i + 1,
            coded: data.cells()[i].coded.clone(),
            weight: w,
            actual: matrix.response[i],
            fitted,
            residual,
            leverage: h,
            studentized_internal: internal,
            studentized_external: external,
            cooks_d: internal.zip(free).map(|(r, free)| r * r * h / (free * p)),
            dffits: external.zip(free).map(|(t, free)| t * (h / free).sqrt()),
        }
    };
    (0..matrix.rows.len()).map(case).collect()
}

/// Sum of squares of the residuals that each observation would have if it were left out; none if
/// one of them is fitted exactly.
///
/// # Source
/// `[Allen1974]`.
pub(crate) fn press(cases: &[Case], weights: &[f64]) -> Option<f64> {
    let deleted = |(case, w): (&Case, &f64)| {
        let free = Some(1.0 - case.leverage).filter(|free| *free > FITTED_EXACTLY)?;
        Some(w * (case.residual / free).powi(2))
    };
    cases.iter().zip(weights).map(deleted).sum()
}

/// Range of the fitted values over their mean standard error.
///
/// # Formula
/// (max - min of the fitted values) / sqrt(p mse / n) `[Box1973]`.
pub(crate) fn adequate_precision(cases: &[Case], p: usize, mse: f64) -> Option<f64> {
    let fitted = cases.iter().map(|case| case.fitted);
    let (low, high) = fitted.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    ratio(high - low, (p as f64 * mse / cases.len() as f64).sqrt())
}
