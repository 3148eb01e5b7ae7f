//! Sums of squares of Type I, II and III.

use serde::{Deserialize, Serialize};

use super::matrix::Matrix;
use super::{TermRow, ratio};
use crate::fit::least_squares::{LeastSquares, last_adds};
use crate::{Model, NamedValues, Term};
use probability::f_upper_tail;

/// A sum of squares of one degree of freedom with its test against the residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TypedSum {
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Over the mean square of the residuals.
    pub f: Option<f64>,
    /// Upper tail of F.
    pub p: Option<f64>,
}

/// The three types of one term.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TypedRow {
    /// After the terms that enter before it ([`Model::entry`]).
    pub type_i: TypedSum,
    /// After all terms that do not contain it: A is contained in AB and in A^2.
    pub type_ii: TypedSum,
    /// After all other terms; the columns are products of coded values.
    pub type_iii: TypedSum,
}

/// The rows of all terms but the intercept and blocks, in the order in which they enter.
///
/// # Source
/// `[Yates1934]` for the types; reduction on the triangle of the full model `[Golub2013]`.
pub(crate) fn rows(
    matrix: &Matrix,
    model: &Model,
    solved: &LeastSquares,
    entering: &[(usize, f64)],
    terms: &NamedValues<TermRow>,
    mse: Option<f64>,
    df_resid: usize,
) -> NamedValues<TypedRow> {
    let sum = |ss: f64| {
        let f = mse.and_then(|mse| ratio(ss, mse));
        TypedSum {
            ss,
            f,
            p: f.and_then(|f| f_upper_tail(f, 1.0, df_resid as f64)),
        }
    };
    let first = matrix.intercept + matrix.n_blocks;
    let row = |&(j, added): &(usize, f64)| {
        let term = &model.terms()[j - matrix.n_blocks];
        let partial = terms.get(&matrix.names[j]).and_then(|row| row.ss_partial);
        let name = matrix.names[j].clone();
        let row = TypedRow {
            type_i: sum(added),
            type_ii: sum(type_two(matrix, model, solved, term, j)),
            type_iii: sum(partial.unwrap_or(0.0)),
        };
        (name, row)
    };
    let own = entering.iter().filter(|(j, _)| *j >= first);
    own.map(row).collect()
}

/// Sum of squares of column `j` after all columns whose terms do not contain `term`.
fn type_two(matrix: &Matrix, model: &Model, solved: &LeastSquares, term: &Term, j: usize) -> f64 {
    let beside = |i: &usize| {
        let of_term = *i < matrix.intercept || *i >= matrix.intercept + matrix.n_blocks;
        let place = if *i < matrix.intercept {
            *i
        } else {
            i.saturating_sub(matrix.n_blocks)
        };
        *i != j && !(of_term && model.terms()[place].contains(term))
    };
    let chosen = (0..matrix.names.len()).filter(beside).chain([j]);
    let columns = chosen.map(|i| solved.triangle[i].clone()).collect();
    last_adds(columns, solved.rotated.clone())
}
