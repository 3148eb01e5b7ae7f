//! The scatter of replicates within cells, and tests against it.

use serde::{Deserialize, Serialize};

use super::{TermRow, ratio};
use crate::{NamedValues, Observations};
use probability::{chi_squared_upper_tail, f_upper_tail};

/// Tests against the pooled variance of replicates within cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replicates {
    /// Sum of (n - 1) sd^2 over sum of (n - 1), squared unit of the response: variance of a run.
    pub pooled_within_var: f64,
    /// Its root, unit of the response.
    pub pooled_within_sd: f64,
    /// Variance of a cell mean of weight 1, squared unit of the response: with weights by counts, of a mean
    /// over cells of mean size.
    pub var_of_run_mean: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Residuals of the fit against the variance of a cell mean.
    pub lack_of_fit_vs_replicates: Option<FTest>,
    /// Whether the cells have one variance; none for fewer than two cells with sd above zero.
    pub bartlett: Option<Bartlett>,
    /// Test of each term.
    pub tests: NamedValues<FTest>,
}

/// A ratio of variances with its tail.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FTest {
    /// Ratio.
    pub f: Option<f64>,
    /// Degrees of freedom of the upper variance.
    pub df1: usize,
    /// Degrees of freedom of the lower variance.
    pub df2: usize,
    /// Upper tail of the ratio.
    pub p: Option<f64>,
}

/// Bartlett's test that cells have one variance `[Bartlett1937]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bartlett {
    /// Chi squared.
    pub stat: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Upper tail.
    pub p: Option<f64>,
}

/// A ratio of variances with its tail.
pub(crate) fn f_test(upper: f64, df1: usize, lower: f64, df2: usize) -> FTest {
    let f = ratio(upper, lower);
    FTest {
        f,
        df1,
        df2,
        p: f.and_then(|f| f_upper_tail(f, df1 as f64, df2 as f64)),
    }
}

/// Tests of the terms and the residuals against replicates; none without replicates.
///
/// # Formula
/// The variance of a cell mean of weight 1 is `sum (n - 1) w sd^2 / n` over `sum (n - 1)`, w the weights of mean 1: it is
/// what the weighted mean square of the residuals estimates too.
pub(crate) fn replicates(
    data: &Observations,
    weights: &[f64],
    terms: &NamedValues<TermRow>,
    sse: f64,
    df_resid: usize,
) -> Option<Replicates> {
    let spreads = spreads(data);
    let df: usize = spreads.iter().map(|s| s.df).sum();
    if df == 0 {
        return None;
    }
    let ss: f64 = spreads.iter().map(|s| s.df as f64 * s.variance).sum();
    let pooled = ss / df as f64;
    let weighted = data
        .cells()
        .iter()
        .zip(weights)
        .filter(|(cell, _)| cell.n > 1);
    let weighted = weighted.filter_map(|(cell, weight)| {
        let runs = cell.n as f64;
        Some((runs - 1.0) * weight * variance_of(cell)? / runs)
    });
    let of_mean = weighted.sum::<f64>() / df as f64;
    let test = |(name, row): (&str, &TermRow)| {
        let ss = row.ss_partial?;
        Some((name.to_owned(), f_test(ss, 1, of_mean, df)))
    };
    Some(Replicates {
        pooled_within_var: pooled,
        pooled_within_sd: pooled.sqrt(),
        var_of_run_mean: of_mean,
        df,
        lack_of_fit_vs_replicates: (df_resid > 0)
            .then(|| f_test(sse / df_resid as f64, df_resid, of_mean, df)),
        bartlett: bartlett(&spreads, pooled),
        tests: terms.iter().filter_map(test).collect(),
    })
}

/// Scatter of runs over the size of their mean, below which it is rounding: they do not scatter.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Variance of the runs of a cell, 0 where it is rounding; `None` if it is not known.
fn variance_of(cell: &crate::Cell) -> Option<f64> {
    let sd = cell.sd?;
    let scatters = sd > ROUNDING * cell.mean.abs();
    Some(if scatters { sd * sd } else { 0.0 })
}

/// Variance within a cell.
#[derive(Debug, Clone, Copy)]
struct Spread {
    /// Degrees of freedom.
    df: usize,
    /// Variance of a run, squared unit of the response.
    variance: f64,
}

/// Variances of the cells that have two runs or more and a known sd.
fn spreads(data: &Observations) -> Vec<Spread> {
    let known = data.cells().iter().filter(|cell| cell.n > 1);
    let spread = |cell: &crate::Cell| {
        Some(Spread {
            df: cell.n - 1,
            variance: variance_of(cell)?,
        })
    };
    known.filter_map(spread).collect()
}

/// Variance of a run, pooled over the cells; none without replicates.
pub(crate) fn pooled_variance(data: &Observations) -> Option<f64> {
    let spreads = spreads(data);
    let df: usize = spreads.iter().map(|s| s.df).sum();
    let ss: f64 = spreads.iter().map(|s| s.df as f64 * s.variance).sum();
    (df > 0).then(|| ss / df as f64)
}

/// Bartlett's test of variances with their degrees of freedom.
pub(crate) fn bartlett_of(variances: &[(usize, f64)]) -> Option<Bartlett> {
    let spreads: Vec<Spread> = variances
        .iter()
        .map(|&(df, variance)| Spread { df, variance })
        .collect();
    let df: usize = spreads.iter().map(|s| s.df).sum();
    let ss: f64 = spreads.iter().map(|s| s.df as f64 * s.variance).sum();
    bartlett(&spreads, ss / df as f64)
}

/// Bartlett's statistic.
///
/// # Formula
/// `[nu ln s^2 - sum nu_i ln s_i^2] / [1 + (sum 1/nu_i - 1/nu) / (3 (m - 1))]`, nu the sum of
/// the m degrees of freedom `nu_i`, `s^2` the pooled variance.
fn bartlett(spreads: &[Spread], pooled: f64) -> Option<Bartlett> {
    let m = spreads.len();
    if m < 2 || spreads.iter().any(|s| s.variance <= 0.0) {
        return None;
    }
    let nu: f64 = spreads.iter().map(|s| s.df as f64).sum();
    let logs: f64 = spreads
        .iter()
        .map(|s| s.df as f64 * (s.variance / pooled).ln())
        .sum();
    let inverses: f64 = spreads.iter().map(|s| 1.0 / s.df as f64).sum();
    let correction = 1.0 + (inverses - 1.0 / nu) / (3.0 * (m - 1) as f64);
    let stat = (-logs / correction).max(0.0);
    Some(Bartlett {
        stat,
        df: m - 1,
        p: chi_squared_upper_tail(stat, (m - 1) as f64),
    })
}
