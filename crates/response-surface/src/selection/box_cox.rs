//! Would a power of the response fit better?

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::fit::Matrix;
use crate::fit::least_squares::basis;
use crate::{Error, Model, Observations, Weighting};
use probability::chi_squared_quantile;

/// The profile of the power.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoxCox {
    /// Powers tried, -2 to 2.
    pub lambda: Vec<f64>,
    /// ln of the sum of squares of the residuals of the scaled transform, one per power.
    pub ln_sse: Vec<f64>,
    /// The best power.
    pub best: f64,
    /// 95 % interval of the power, cut off at -2 and 2.
    pub interval95: [f64; 2],
    /// Whether the interval holds 1: no transformation is called for.
    pub keeps_the_response: bool,
}

/// Profiles the power of the response; none if a response is zero or negative.
///
/// # Formula
/// `z = (y^lambda - 1) / (lambda g^(lambda - 1))`, `z = g ln y` at 0, g the geometric mean; the
/// interval holds the powers with `n ln(SSE / least SSE) <= chi2(0.95; 1)`.
///
/// # Source
/// `[BoxCox1964]`.
///
/// # Errors
/// Those of [`crate::fit_weighted`].
pub fn box_cox(
    factors: &[Factor],
    model: &Model,
    data: &Observations,
    weighting: Weighting,
) -> Result<Option<BoxCox>, Error> {
    let data = data.first_columns(factors.len());
    let matrix = Matrix::new(model, &data, weighting)?;
    let n = matrix.rows.len();
    if n <= matrix.names.len() || matrix.response.iter().any(|y| *y <= 0.0) {
        return Ok(None);
    }
    let columns = basis(&matrix.rows, &matrix.names, &matrix.weights).columns;
    let logs: Vec<f64> = matrix.response.iter().map(|y| y.ln()).collect();
    let mean_log = logs.iter().sum::<f64>() / n as f64;
    let ln_sse = |lambda: f64| {
        let transform = |ln_y: &f64| {
            // (y/g)^lambda - 1 without cancellation near lambda = 0.
            let t = ln_y - mean_log;
            if lambda == 0.0 {
                t
            } else {
                (lambda * t).exp_m1() / lambda
            }
        };
        let roots = matrix.weights.iter().map(|w| w.sqrt());
        let mut rest: Vec<f64> = logs
            .iter()
            .zip(roots)
            .map(|(y, w)| transform(y) * w)
            .collect();
        for (_, q) in &columns {
            let along: f64 = q.iter().zip(&rest).map(|(a, b)| a * b).sum();
            rest.iter_mut().zip(q).for_each(|(r, q)| *r -= along * q);
        }
        rest.iter().map(|r| r * r).sum::<f64>().ln() + 2.0 * mean_log
    };
    if !matrix.intercept_is_in() || !ln_sse(1.0).is_finite() {
        return Ok(None);
    }
    let lambda: Vec<f64> = (0..=400).map(|i| f64::from(i - 200) / 100.0).collect();
    let values: Vec<f64> = lambda.iter().map(|&l| ln_sse(l)).collect();
    let Some(best) = (0..values.len()).min_by(|&a, &b| values[a].total_cmp(&values[b])) else {
        return Ok(None);
    };
    let limit = values[best] + chi_squared_quantile(0.05, 1.0).unwrap_or(f64::INFINITY) / n as f64;
    let inside = |i: &usize| values[*i] <= limit;
    let low = (0..=best).rev().take_while(inside).last().unwrap_or(best);
    let high = (best..values.len())
        .take_while(inside)
        .last()
        .unwrap_or(best);
    let interval95 = [lambda[low], lambda[high]];
    Ok(Some(BoxCox {
        best: lambda[best],
        keeps_the_response: interval95[0] <= 1.0 && 1.0 <= interval95[1],
        interval95,
        // One value in ten is enough for a picture.
        ln_sse: values.iter().step_by(10).copied().collect(),
        lambda: lambda.into_iter().step_by(10).collect(),
    }))
}
