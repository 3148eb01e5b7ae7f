//! Coefficients with their tests.

use serde::{Deserialize, Serialize};

use super::anova::Sums;
use super::matrix::Matrix;
use super::{positive_df, ratio};
use crate::NamedValues;
use crate::fit::least_squares::LeastSquares;
use crate::fit::wide::Wide;
use probability::{t_two_sided_quantile, t_two_sided_tail};

/// A coefficient with its test against the residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermRow {
    /// Coefficient, unit of the response per coded (or natural) unit of the factors.
    pub coef: f64,
    /// Standard error, as `coef`; none without residual degrees of freedom.
    pub se: Option<f64>,
    /// coef / se.
    pub t: Option<f64>,
    /// Two-sided tail of t; equal to the tail of F.
    pub p: Option<f64>,
    /// 95 % confidence interval, as `coef`.
    pub ci95: Option<[f64; 2]>,
    /// Sum of squares lost when this term alone is dropped (Type III), squared unit of the
    /// response; none for the intercept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ss_partial: Option<f64>,
    /// `ss_partial` over the mean square of the residuals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub f: Option<f64>,
    /// `100 ss_partial / sst`, %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contribution_pct: Option<f64>,
    /// Mean at high minus mean at low level, 2 coef, unit of the response; main effects of
    /// two-level designs only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<f64>,
}

/// A coefficient and its interval from its variance factor c (variance = c mse).
pub(crate) fn tested(coef: f64, c: f64, mse: Option<f64>, df_resid: usize) -> TermRow {
    let df = positive_df(df_resid);
    let se = mse.map(|mse| (c * mse).sqrt());
    let t = se.and_then(|se| ratio(coef, se));
    let limit = df.and_then(|df| t_two_sided_quantile(0.05, df));
    TermRow {
        coef,
        se,
        t,
        p: t.zip(df).and_then(|(t, df)| t_two_sided_tail(t, df)),
        ci95: se
            .zip(limit)
            .map(|(se, limit)| [coef - limit * se, coef + limit * se]),
        ss_partial: None,
        f: None,
        contribution_pct: None,
        effect: None,
    }
}

/// The tested coefficients of a fit in coded units.
pub(crate) fn rows(
    matrix: &Matrix,
    coefficients: &[Wide],
    solved: &LeastSquares,
    sums: &Sums,
    df_resid: usize,
) -> NamedValues<TermRow> {
    let mse = positive_df(df_resid).map(|df| sums.sse / df);
    let row = |(j, name): (usize, &String)| {
        let (coef, c) = (coefficients[j].rounded(), solved.xtx_inverse[j][j]);
        let mut row = tested(coef, c, mse, df_resid);
        if j >= matrix.intercept {
            let ss = coef * coef / c;
            row.ss_partial = Some(ss);
            row.f = mse.and_then(|mse| ratio(ss, mse));
            row.contribution_pct = ratio(100.0 * ss, sums.sst);
            // A two-level column of degree one takes only the values -1 and +1; so do products,
            // whose effect is defined alike.
            row.effect =
                (matrix.two_level && j >= matrix.intercept + matrix.n_blocks).then_some(2.0 * coef);
        }
        (name.clone(), row)
    };
    matrix.names.iter().enumerate().map(row).collect()
}

/// Variance inflation: variance of a coefficient over what it would be if its column, taken
/// about its mean, were orthogonal to the others.
///
/// # Source
/// `[Marquardt1970]`.
pub(crate) fn variance_inflation(matrix: &Matrix, solved: &LeastSquares) -> NamedValues<f64> {
    let n = matrix.rows.len() as f64;
    let inflation = |j: usize| {
        let column = || {
            matrix
                .rows
                .iter()
                .zip(&matrix.weights)
                .map(|(row, w)| (row[j], w))
        };
        // Without intercept there is no mean to take the column about.
        let mean = column().map(|(x, w)| w * x).sum::<f64>() / n * matrix.intercept as f64;
        let spread: f64 = column().map(|(x, w)| w * (x - mean) * (x - mean)).sum();
        solved.xtx_inverse[j][j] * spread
    };
    let names = matrix.names.iter().enumerate().skip(matrix.intercept);
    names
        .map(|(j, name)| (name.clone(), inflation(j)))
        .collect()
}
