//! Pure error from repeated rows, and the test of the model against it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::replicates::ROUNDING;
use super::{FTest, Replicates, f_test, ratio};
use crate::Observations;
use probability::f_upper_tail;

/// Scatter of rows with the same settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PureError {
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Mean square.
    pub ms: f64,
}

/// Part of the residuals beyond the pure error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LackOfFit {
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Mean square.
    pub ms: f64,
    /// Mean square over that of the pure error.
    pub f: Option<f64>,
    /// Upper tail of F.
    pub p: Option<f64>,
}

/// Pure error of the rows that have the same settings and block as an earlier one, without what is rounding; none if there
/// are none.
pub(crate) fn pure_error(data: &Observations, weights: &[f64]) -> Option<PureError> {
    let cells = data.cells();
    let (mut ss, mut df) = (0.0, 0);
    for group in same_settings(data) {
        let total: f64 = group.iter().map(|&j| weights[j]).sum();
        let mean = group
            .iter()
            .map(|&j| weights[j] * cells[j].mean)
            .sum::<f64>()
            / total;
        let squares = group.iter();
        let squares = squares.map(|&j| weights[j] * (cells[j].mean - mean).powi(2));
        let squares: f64 = squares.sum();
        if squares > total * (ROUNDING * mean).powi(2) {
            ss += squares;
        }
        df += group.len() - 1;
    }
    (df > 0).then(|| PureError {
        ss,
        df,
        ms: ss / df as f64,
    })
}

/// Places of the cells that share settings and block, in order of first appearance.
pub(crate) fn same_settings(data: &Observations) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut places = BTreeMap::new();
    for (i, cell) in data.cells().iter().enumerate() {
        // Adding 0 makes -0 and 0 the same settings.
        let settings: Vec<u64> = cell.coded.iter().map(|x| (x + 0.0).to_bits()).collect();
        let place = *places.entry((cell.block, settings)).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[place].push(i);
    }
    groups
}

/// Test of the residuals beyond the pure error; none if there is nothing beyond it.
///
/// # Source
/// `[Myers2016, chapter 2]`.
pub(crate) fn lack_of_fit(sse: f64, df_resid: usize, pure: &PureError) -> Option<LackOfFit> {
    let df = df_resid.checked_sub(pure.df).filter(|df| *df > 0)?;
    // Rounding must not make the difference of two equal sums negative.
    let ss = (sse - pure.ss).max(0.0);
    let ms = ss / df as f64;
    let f = ratio(ms, pure.ms);
    let p = f.and_then(|f| f_upper_tail(f, df as f64, pure.df as f64));
    Some(LackOfFit { ss, df, ms, f, p })
}

/// Test of the misfit against replicates within cells and repeated rows together; none without
/// either or without misfit.
pub(crate) fn against_all_repeats(
    sse: f64,
    df_resid: usize,
    pure: Option<&PureError>,
    replicates: Option<&Replicates>,
) -> Option<FTest> {
    let (rows_ss, rows_df) = pure.map_or((0.0, 0), |pure| (pure.ss, pure.df));
    let within = replicates.map_or((0.0, 0), |r| (r.var_of_run_mean * r.df as f64, r.df));
    let df = rows_df + within.1;
    let misfit_df = df_resid
        .checked_sub(rows_df)
        .filter(|misfit| *misfit > 0 && df > 0)?;
    let misfit = (sse - rows_ss).max(0.0) / misfit_df as f64;
    Some(f_test(
        misfit,
        misfit_df,
        (rows_ss + within.0) / df as f64,
        df,
    ))
}
