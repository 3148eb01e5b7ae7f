//! Pure error from repeated rows, and the test of the model against it.

use serde::{Deserialize, Serialize};

use super::ratio;
use crate::Observations;
use crate::distribution::f_upper_tail;

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

/// What the residuals hold beyond the pure error.
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

/// Pure error of the rows that have the same settings and block as an earlier one; none if there
/// are none.
pub(crate) fn pure_error(data: &Observations, weights: &[f64]) -> Option<PureError> {
    let cells = data.cells();
    let mut seen = vec![false; cells.len()];
    let (mut ss, mut df) = (0.0, 0);
    for i in 0..cells.len() {
        if seen[i] {
            continue;
        }
        let same =
            |j: &usize| cells[*j].coded == cells[i].coded && cells[*j].block == cells[i].block;
        let group: Vec<usize> = (i..cells.len()).filter(same).collect();
        for &j in &group {
            seen[j] = true;
        }
        let total: f64 = group.iter().map(|&j| weights[j]).sum();
        let mean = group
            .iter()
            .map(|&j| weights[j] * cells[j].mean)
            .sum::<f64>()
            / total;
        ss += group
            .iter()
            .map(|&j| weights[j] * (cells[j].mean - mean).powi(2))
            .sum::<f64>();
        df += group.len() - 1;
    }
    (df > 0).then(|| PureError {
        ss,
        df,
        ms: ss / df as f64,
    })
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
