//! Models of growing order side by side, and the order to take.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::fit::least_squares::{Basis, basis};
use crate::fit::{FTest, Matrix, PureError, f_test, pure_error_of, ratio};
use crate::{Error, Model, Observations, Weighting};
use probability::f_upper_tail;

/// Orders in the sequence.
const ORDERS: [&str; 5] = ["mean", "linear", "2fi", "quadratic", "cubic"];
/// Greatest number of observations times squared terms for which an order is tried: a few seconds.
const MOST_WORK: usize = 400_000_000;

/// One order. Sums of squares are in squared units of the response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// `mean`, `linear`, `2fi`, `quadratic` or `cubic`.
    pub order: String,
    /// Number of coefficients that the runs can separate, with intercept and blocks.
    pub p: usize,
    /// Terms of this order that the runs cannot separate from earlier ones, with their relations.
    pub aliased: Vec<String>,
    /// Sum of squares that the order adds to the one before.
    pub added_ss: f64,
    /// Test of what it adds against what it leaves; `None` if it adds nothing.
    pub added: Option<FTest>,
    /// Sum of squares of its residuals.
    pub sse: f64,
    /// Degrees of freedom of its residuals.
    pub df_resid: usize,
    /// Test of its residuals against repeated rows.
    pub lack_of_fit: Option<FTest>,
    /// Root of the mean square of the residuals, unit of the response.
    pub root_mse: Option<f64>,
    /// Share of the sum of squares about the mean.
    pub r2: Option<f64>,
    /// The same with mean squares.
    pub adj_r2: Option<f64>,
    /// The same for observations left out.
    pub pred_r2: Option<f64>,
    /// Sum of squares of the residuals of observations left out.
    pub press: Option<f64>,
    /// Akaike's criterion corrected for few observations.
    pub aicc: Option<f64>,
}

/// All orders that could be fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Orders {
    /// The orders from `mean` on.
    pub orders: Vec<Order>,
    /// The highest order that adds significantly (p < 0.05) and has no aliased term; `mean` if
    /// none does.
    pub suggested: String,
    /// Orders left out because the data are too many for a quick look.
    pub left_out: Vec<String>,
}

/// Fits the orders one after the other.
///
/// One orthogonal basis of the highest order serves all: its leading columns span the lower ones.
///
/// # Errors
/// Those of [`crate::fit_weighted`] for the weights and the factors; aliased terms are not an error
/// here, they are named.
pub fn orders(
    factors: &[Factor],
    data: &Observations,
    weighting: Weighting,
) -> Result<Orders, Error> {
    let n = data.cells().len();
    let models = ORDERS.map(|order| Model::parse(order, factors));
    let mut known = Vec::new();
    let mut left_out = Vec::new();
    for (order, model) in ORDERS.into_iter().zip(models) {
        let model = model?;
        if model.terms().len().pow(2).saturating_mul(n) > MOST_WORK {
            left_out.push(order.to_owned());
        } else {
            known.push((order, model));
        }
    }
    let Some((_, highest)) = known.last() else {
        return Err(Error::TooFewObservations {
            observations: n,
            terms: 1,
        });
    };
    let data = data.first_columns(factors.len());
    let matrix = Matrix::unchecked(highest, &data, weighting)?;
    let sequence = Sequence {
        basis: basis(&matrix.rows, &matrix.names, &matrix.weights),
        pure: pure_error_of(&data, &matrix.weights),
        matrix: &matrix,
    };
    let mut orders: Vec<Order> = Vec::new();
    for (order, model) in &known {
        let columns = model.terms().len() + matrix.n_blocks;
        let next = sequence.order(order, columns, orders.last());
        orders.push(next);
    }
    let adds = |order: &&Order| {
        order.aliased.is_empty()
            && order
                .added
                .as_ref()
                .and_then(|t| t.p)
                .is_some_and(|p| p < 0.05)
    };
    let suggested = orders.iter().rev().find(adds).map_or("mean", |o| &o.order);
    Ok(Orders {
        suggested: suggested.to_owned(),
        orders,
        left_out,
    })
}

/// What all orders share.
struct Sequence<'a> {
    /// Basis of the highest order.
    basis: Basis,
    /// Scatter of repeated rows.
    pure: Option<PureError>,
    /// Matrix of the highest order.
    matrix: &'a Matrix,
}

impl Sequence<'_> {
    /// The order that has the first `columns` columns.
    fn order(&self, name: &str, columns: usize, before: Option<&Order>) -> Order {
        let n = self.matrix.rows.len();
        let weights = &self.matrix.weights;
        let mut rest: Vec<f64> = (0..n)
            .map(|i| self.matrix.response[i] * weights[i].sqrt())
            .collect();
        let mut leverages = vec![0.0; n];
        let mut total = None;
        let mut p = 0;
        for (_, q) in self.basis.columns.iter().filter(|(j, _)| *j < columns) {
            let along: f64 = q.iter().zip(&rest).map(|(a, b)| a * b).sum();
            for i in 0..n {
                rest[i] -= along * q[i];
                leverages[i] += q[i] * q[i];
            }
            p += 1;
            total.get_or_insert_with(|| squares(&rest));
        }
        let (sst, sse) = (total.unwrap_or(0.0), squares(&rest));
        let df_resid = n - p;
        let mse = (df_resid > 0).then(|| sse / df_resid as f64);
        let added_ss = before.map_or(0.0, |b| (b.sse - sse).max(0.0));
        let press = press(&rest, &leverages);
        let new = before.map_or(0, |b| p - b.p);
        let first = before.map_or(0, |b| b.p + b.aliased.len());
        let aliased = self.basis.dependent.iter();
        Order {
            order: name.to_owned(),
            p,
            aliased: aliased
                .filter(|(j, _)| *j < columns && *j >= first)
                .map(|(_, relation)| relation.clone())
                .collect(),
            added_ss,
            added: mse
                .filter(|_| new > 0)
                .map(|mse| f_test(added_ss / new as f64, new, mse, df_resid)),
            sse,
            df_resid,
            lack_of_fit: self
                .pure
                .as_ref()
                .and_then(|pure| misfit(sse, df_resid, pure)),
            root_mse: mse.map(f64::sqrt),
            r2: ratio(sst - sse, sst),
            adj_r2: mse
                .and_then(|mse| ratio(mse * (n - 1) as f64, sst))
                .map(|q| 1.0 - q),
            pred_r2: press.and_then(|press| ratio(press, sst)).map(|q| 1.0 - q),
            press,
            aicc: aicc(sse, weights, p),
        }
    }
}

/// Sum of squares.
fn squares(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum()
}

/// Sum of squares of deleted residuals; none if one observation is fitted exactly.
fn press(rest: &[f64], leverages: &[f64]) -> Option<f64> {
    let deleted = |(e, h): (&f64, &f64)| {
        let free = Some(1.0 - h).filter(|free| *free > 1e-10)?;
        Some((e / free).powi(2))
    };
    rest.iter().zip(leverages).map(deleted).sum()
}

/// Test of residuals beyond the pure error.
fn misfit(sse: f64, df_resid: usize, pure: &PureError) -> Option<FTest> {
    let df = df_resid.checked_sub(pure.df).filter(|df| *df > 0)?;
    let f = ratio((sse - pure.ss).max(0.0) / df as f64, pure.ms);
    Some(FTest {
        f,
        df1: df,
        df2: pure.df,
        p: f.and_then(|f| f_upper_tail(f, df as f64, pure.df as f64)),
    })
}

/// As in [`crate::fit::Information`].
fn aicc(sse: f64, weights: &[f64], p: usize) -> Option<f64> {
    let n = weights.len() as f64;
    let logs: f64 = weights.iter().map(|w| w.ln()).sum();
    let base = n * (2.0 * std::f64::consts::PI * sse / n).ln() + n - logs;
    let m = (p + 1) as f64;
    let left = n - m - 1.0;
    (left > 0.0 && base.is_finite()).then(|| base + 2.0 * m + 2.0 * m * (m + 1.0) / left)
}
