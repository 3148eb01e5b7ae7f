//! Analysis of a saturated two-level design without an error estimate.

use serde::{Deserialize, Serialize};

use crate::fit::ratio;
use crate::{Error, Fit, NamedValues, Observations};
use probability::{median, normal_quantile, t_two_sided_quantile};

/// All columns of a saturated design as effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Saturated {
    /// Mean at +1 minus mean at -1, unit of the response.
    pub effects: NamedValues<f64>,
    /// Sums of squares, n effect^2 / 4, squared unit of the response.
    pub ss: NamedValues<f64>,
    /// 100 ss / sum of all ss, %.
    pub contribution_pct: NamedValues<f64>,
    /// Lenth's margins.
    pub lenth: Lenth,
    /// Effects by size with their half-normal quantiles.
    pub half_normal: Vec<HalfNormalPoint>,
}

/// Lenth's pseudo standard error and the margins made of it.
///
/// # Formula
/// s0 = 1.5 median |e|; PSE = 1.5 median of those |e| below 2.5 s0; df = m/3;
/// ME = t(0.975, df) PSE; SME = t((1 + 0.95^(1/m))/2, df) PSE; m effects e.
///
/// # Source
/// `[Lenth1989]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lenth {
    /// First estimate of the standard error of an effect, unit of the response.
    pub s0: f64,
    /// Pseudo standard error, unit of the response.
    pub pse: f64,
    /// Degrees of freedom, a third of the number of effects.
    pub df: f64,
    /// t(0.975, df).
    pub t_975: Option<f64>,
    /// Margin of error of one effect, unit of the response.
    pub me: Option<f64>,
    /// Margin that holds for all effects at once, unit of the response.
    pub sme: Option<f64>,
    /// The t of the simultaneous margin.
    pub t_sme: Option<f64>,
    /// Effects over the pseudo standard error.
    pub t_ratio: NamedValues<Option<f64>>,
}

/// The contrasts of a saturated model: a fit that leaves no degrees of freedom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contrasts {
    /// Size of the column's share of the response after the columns before it, with the sign of its coefficient, unit of
    /// the response: `sqrt(SS / n)`. For orthogonal two-level columns it is the coefficient.
    pub contrasts: NamedValues<f64>,
    /// Whether the columns are orthogonal; otherwise the contrasts depend on the order of the model.
    pub orthogonal: bool,
    /// Lenth's margins of the contrasts.
    pub lenth: Lenth,
    /// Contrasts by size with their half-normal quantiles.
    pub half_normal: Vec<HalfNormalPoint>,
}

/// Lenth's margins of a saturated fit, from the contrasts that its orthogonal triangle gives, which have one variance and
/// no correlation in any design; none unless the fit has no residual degrees of freedom and three terms or more beside
/// intercept and blocks.
///
/// # Source
/// `[Lenth1989]`; contrasts: `[Golub2013, section 5.3]`.
pub fn contrasts(fit: &Fit) -> Option<Contrasts> {
    let blocks = fit.p - fit.formula.terms().len();
    let columns = fit.ss_sequential.iter().skip(blocks);
    let mut orthogonal = true;
    let mut found = Vec::new();
    for (name, ss) in columns {
        let row = fit.terms.get(name)?;
        let last = row.ss_partial.unwrap_or(*ss);
        orthogonal &= (last - ss).abs() <= 1e-9 * fit.sst;
        found.push((
            name.to_owned(),
            (ss / fit.n as f64).sqrt().copysign(row.coef),
        ));
    }
    if fit.df_resid > 0 || found.len() < 3 {
        return None;
    }
    let (columns, values): (Vec<String>, Vec<f64>) = found.iter().cloned().unzip();
    Some(Contrasts {
        orthogonal,
        lenth: lenth(&columns, &values),
        half_normal: half_normal(&columns, &values),
        contrasts: found.into_iter().collect(),
    })
}

/// A point of the half-normal plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfNormalPoint {
    /// Rank by size, 1 the smallest.
    pub rank: usize,
    /// Name of the column.
    pub factor: String,
    /// Size of the effect, unit of the response.
    pub abs_effect: f64,
    /// Plotting position (rank - 1/2) / m.
    pub p: f64,
    /// Standard normal quantile of (1 + p)/2 `[Daniel1959]`.
    pub quantile: Option<f64>,
}

/// Analyses a two-level design that has one column less than runs, dummies among them.
///
/// # Errors
/// [`Error::Length`] unless there is one name per column; [`Error::NotSaturated`] unless the
/// columns are orthogonal, balanced, and one less than the runs.
pub fn saturated(columns: &[String], data: &Observations) -> Result<Saturated, Error> {
    let cells = data.cells();
    let (n, m) = (cells.len(), columns.len());
    if cells[0].coded.len() != m {
        return Err(Error::Length {
            what: "coded values of an observation",
            expected: m,
            given: cells[0].coded.len(),
        });
    }
    if m + 1 != n || !is_orthogonal_two_level(data) {
        return Err(Error::NotSaturated {
            runs: n,
            columns: m,
        });
    }
    let contrast = |j: usize| {
        cells
            .iter()
            .map(|cell| cell.coded[j] * cell.mean)
            .sum::<f64>()
    };
    let effects: Vec<f64> = (0..m).map(|j| contrast(j) / (n as f64 / 2.0)).collect();
    let squares: Vec<f64> = effects.iter().map(|e| n as f64 * e * e / 4.0).collect();
    let total: f64 = squares.iter().sum();
    let shares = squares
        .iter()
        .map(|ss| ratio(100.0 * ss, total).unwrap_or(0.0));
    let named = |values: Vec<f64>| columns.iter().cloned().zip(values).collect();
    Ok(Saturated {
        contribution_pct: named(shares.collect()),
        ss: named(squares),
        lenth: lenth(columns, &effects),
        half_normal: half_normal(columns, &effects),
        effects: named(effects),
    })
}

/// Whether all columns are -1 and +1, balanced, and orthogonal (whole numbers: exact).
fn is_orthogonal_two_level(data: &Observations) -> bool {
    let cells = data.cells();
    let m = cells[0].coded.len();
    let two_level = cells
        .iter()
        .all(|cell| cell.coded.iter().all(|x| x.abs() == 1.0));
    let sum = |f: &dyn Fn(&[f64]) -> f64| cells.iter().map(|cell| f(&cell.coded)).sum::<f64>();
    let orthogonal =
        |i: usize| sum(&|x| x[i]) == 0.0 && (0..i).all(|j| sum(&|x| x[i] * x[j]) == 0.0);
    two_level && (0..m).all(orthogonal)
}

/// Lenth's margins of a set of effects.
fn lenth(columns: &[String], effects: &[f64]) -> Lenth {
    let sizes: Vec<f64> = effects.iter().map(|e| e.abs()).collect();
    // Without an effect, or where half of them are 0, nothing scatters.
    let scale = |of: &[f64]| if of.is_empty() { 0.0 } else { 1.5 * median(of) };
    let s0 = scale(&sizes);
    let small: Vec<f64> = sizes.into_iter().filter(|e| *e < 2.5 * s0).collect();
    let pse = scale(&small);
    let m = effects.len() as f64;
    let df = m / 3.0;
    let t_975 = t_two_sided_quantile(0.05, df);
    // 1 - 0.95^(1/m) without cancellation.
    let simultaneous = -f64::exp_m1(0.95_f64.ln() / m);
    let t_sme = t_two_sided_quantile(simultaneous, df);
    let ratios = effects.iter().map(|e| ratio(*e, pse));
    Lenth {
        s0,
        pse,
        df,
        t_975,
        me: t_975.map(|t| t * pse),
        sme: t_sme.map(|t| t * pse),
        t_sme,
        t_ratio: columns.iter().cloned().zip(ratios).collect(),
    }
}

/// Effects by size with plotting positions.
fn half_normal(columns: &[String], effects: &[f64]) -> Vec<HalfNormalPoint> {
    let mut sorted: Vec<(&String, f64)> = columns
        .iter()
        .zip(effects.iter().map(|e| e.abs()))
        .collect();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let m = effects.len() as f64;
    let point = |(i, (factor, abs_effect)): (usize, (&String, f64))| {
        let p = (i as f64 + 0.5) / m;
        HalfNormalPoint {
            rank: i + 1,
            factor: factor.clone(),
            abs_effect,
            p,
            quantile: normal_quantile(0.5 * (1.0 + p)),
        }
    };
    sorted.into_iter().enumerate().map(point).collect()
}
