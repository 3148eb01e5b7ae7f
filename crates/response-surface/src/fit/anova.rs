//! Sums of squares and the test of the whole model.

use serde::{Deserialize, Serialize};

use super::matrix::Matrix;
use super::{FTest, f_test, positive_df, ratio};
use crate::fit::least_squares::{LeastSquares, each_adds};
use crate::{Model, NamedValues};
use probability::f_upper_tail;

/// A line of an analysis of variance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AnovaRow {
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Mean square; none without degrees of freedom.
    pub ms: Option<f64>,
    /// Mean square over that of the residuals.
    pub f: Option<f64>,
    /// Upper tail of F.
    pub p: Option<f64>,
}

/// Sums of squares added by each group of terms, squared unit of the response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequentialModel {
    /// The intercept.
    pub mean: f64,
    /// Blocks, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<f64>,
    /// Main effects after the mean and blocks.
    pub linear: f64,
    /// Products of two factors after those; none without such terms.
    pub two_fi: Option<f64>,
    /// Squares after those; none without such terms.
    pub quadratic: Option<f64>,
    /// Terms of higher degree, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub higher: Option<f64>,
    /// The residuals.
    pub residual: f64,
}

/// Contribution of a group of terms to those before it, against the residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrderRow {
    /// `blocks`, `linear`, `two-factor`, `quadratic` or `higher`.
    pub order: String,
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Its mean square against that of the residuals of the whole model.
    pub test: FTest,
}

/// The sums that everything else is made of.
#[derive(Debug)]
pub(crate) struct Sums {
    /// Weighted mean of the response.
    pub(crate) mean: f64,
    /// Sum of squares about the mean; about zero without intercept.
    pub(crate) sst: f64,
    /// Degrees of freedom of `sst`.
    pub(crate) df_total: usize,
    /// Sum of squares of the residuals.
    pub(crate) sse: f64,
    /// Observed minus fitted, (n).
    pub(crate) residuals: Vec<f64>,
}

/// Centred sums of squares of a solved problem.
pub(crate) fn sums(matrix: &Matrix, residuals: Vec<f64>) -> Sums {
    let n = matrix.rows.len() as f64;
    let weighted = |f: &dyn Fn(usize) -> f64| -> f64 {
        matrix
            .weights
            .iter()
            .enumerate()
            .map(|(i, w)| w * f(i))
            .sum()
    };
    // The weights sum to n.
    let mean = weighted(&|i| matrix.response[i]) / n;
    // Sums of squares of nothing but rounding are zero: ratios of them mean nothing.
    let size = matrix
        .response
        .iter()
        .fold(0.0_f64, |size, y| size.max(y.abs()));
    let rounding = n * (1e-14 * size).powi(2);
    let clean = |ss: f64| if ss <= rounding { 0.0 } else { ss };
    let origin = if matrix.intercept == 1 { mean } else { 0.0 };
    Sums {
        mean,
        sst: clean(weighted(&|i| (matrix.response[i] - origin).powi(2))),
        df_total: matrix.rows.len() - matrix.intercept,
        sse: clean(weighted(&|i| residuals[i].powi(2))),
        residuals,
    }
}

/// Test of all terms but the intercept together.
pub(crate) fn model_row(sums: &Sums, df_resid: usize) -> AnovaRow {
    let (ss, df) = (sums.sst - sums.sse, sums.df_total - df_resid);
    let ms = positive_df(df).map(|df| ss / df);
    let mse = positive_df(df_resid).map(|df| sums.sse / df);
    let f = ms.zip(mse).and_then(|(ms, mse)| ratio(ms, mse));
    let p = f.and_then(|f| f_upper_tail(f, df as f64, df_resid as f64));
    AnovaRow { ss, df, ms, f, p }
}

/// Sum of squares that each column adds to those that enter before it, with the place of the column: the intercept, blocks, then
/// the terms in the order of entry of the model.
pub(crate) fn entering(matrix: &Matrix, model: &Model, solved: &LeastSquares) -> Vec<(usize, f64)> {
    let after = matrix.n_blocks;
    let column = |&term: &usize| {
        if term < matrix.intercept {
            term
        } else {
            term + after
        }
    };
    let (first, rest): (Vec<usize>, Vec<usize>) = model
        .entry()
        .iter()
        .map(column)
        .partition(|&j| j < matrix.intercept);
    let blocks = matrix.intercept..matrix.first();
    let order: Vec<usize> = first.into_iter().chain(blocks).chain(rest).collect();
    let added = if order.is_sorted() {
        solved.sequential_ss.clone()
    } else {
        let columns = order.iter().map(|&j| solved.triangle[j].clone());
        each_adds(columns.collect(), solved.rotated.clone())
    };
    order.into_iter().zip(added).collect()
}

/// The same by name, without the intercept.
pub(crate) fn sequential(matrix: &Matrix, entering: &[(usize, f64)]) -> NamedValues<f64> {
    let own = entering.iter().filter(|(j, _)| *j >= matrix.intercept);
    own.map(|(j, ss)| (matrix.names[*j].clone(), *ss)).collect()
}

/// Sum of squares that each column adds to those before it in the matrix, summed by kind of term.
pub(crate) fn sequential_by_degree(
    matrix: &Matrix,
    model: &Model,
    solved: &LeastSquares,
    sums: &Sums,
) -> SequentialModel {
    let terms = matrix.model_part(&solved.sequential_ss);
    let group = |keep: &dyn Fn(&[u8]) -> bool| -> Option<f64> {
        let chosen = model
            .terms()
            .iter()
            .zip(&terms)
            .filter(|(term, _)| keep(term.powers()));
        chosen.map(|(_, ss)| *ss).reduce(|a, b| a + b)
    };
    let degree = |powers: &[u8]| powers.iter().map(|&p| usize::from(p)).sum::<usize>();
    let square = |powers: &[u8]| powers.contains(&2);
    let after = matrix.intercept;
    let blocks = &solved.sequential_ss[after..after + matrix.n_blocks];
    SequentialModel {
        mean: group(&|powers| degree(powers) == 0).unwrap_or(0.0),
        blocks: (!blocks.is_empty()).then(|| blocks.iter().sum()),
        linear: group(&|powers| degree(powers) == 1).unwrap_or(0.0),
        two_fi: group(&|powers| degree(powers) == 2 && !square(powers)),
        quadratic: group(&|powers| degree(powers) == 2 && square(powers)),
        higher: group(&|powers| degree(powers) > 2),
        residual: sums.sse,
    }
}

/// The same groups, each of one or more columns, with their tests: blocks, main effects, products of two, squares, higher.
pub(crate) fn by_order(
    matrix: &Matrix,
    model: &Model,
    solved: &LeastSquares,
    sums: &Sums,
    df_resid: usize,
) -> Vec<OrderRow> {
    let order_of = |j: usize| -> usize {
        if j < matrix.first() {
            return 0;
        }
        let powers = model.terms()[j - matrix.n_blocks].powers();
        let degree: u8 = powers.iter().sum();
        match degree {
            0 | 1 => 1,
            2 => 2 + usize::from(powers.contains(&2)),
            _ => 4,
        }
    };
    let names = ["blocks", "linear", "two-factor", "quadratic", "higher"];
    let mse = ratio(sums.sse, df_resid as f64);
    let row = |(order, name): (usize, &str)| {
        let columns = (matrix.intercept..matrix.names.len()).filter(|&j| order_of(j) == order);
        let added: Vec<f64> = columns.map(|j| solved.sequential_ss[j]).collect();
        let (ss, df) = (added.iter().sum::<f64>(), added.len());
        (df > 0).then(|| OrderRow {
            order: name.to_owned(),
            ss,
            test: f_test(ss / df as f64, df, mse.unwrap_or(f64::NAN), df_resid),
        })
    };
    names.into_iter().enumerate().filter_map(row).collect()
}
