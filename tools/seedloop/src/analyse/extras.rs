//! Results of an analysis beside the fit: ridge paths, the rival surface, regimes.

use anyhow::ensure;
use experiment_design::Factor;
use response_surface::{
    Fit, GaussianProcess, Model, Observations, RandomBlocks, Regime, RidgePoint, Sobol, Weighting,
    gaussian_process, random_blocks, regime, ridge_path,
};
use serde::Serialize;

use super::Arguments;
use super::data::Data;

/// Radii of the ridge paths, coded.
const RADII: [f64; 9] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0];
/// Seed of the points at which a regime's share of the box is counted.
const SEED: u64 = 1;

/// The paths of steepest ascent and descent.
#[derive(Debug, Serialize)]
pub(super) struct Ridge {
    /// Highest points.
    pub(super) ascent: Vec<RidgePoint>,
    /// Lowest points.
    pub(super) descent: Vec<RidgePoint>,
}

impl Ridge {
    /// The paths of a fit; none for models above degree two.
    pub(super) fn of(fit: &Fit) -> Option<Self> {
        Some(Self {
            ascent: ridge_path(fit, &RADII, true).ok()?,
            descent: ridge_path(fit, &RADII, false).ok()?,
        })
    }
}

/// A Gaussian process beside the polynomial.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    /// The process.
    pub(super) process: GaussianProcess,
    /// Root of the mean squared error of rows left out, process, unit of the response.
    pub(super) process_leave_one_out_rmse: f64,
    /// The same of the polynomial; null where a row is fitted exactly.
    pub(super) polynomial_leave_one_out_rmse: Option<f64>,
    /// Which of the two predicts left-out rows better. The analysis stays that of the polynomial.
    pub(super) better: &'static str,
}

/// Fits the model with random batches where a column of them is named.
pub(super) fn batches(
    data: &Data,
    model: &Model,
    weighting: Weighting,
) -> anyhow::Result<Option<RandomBlocks>> {
    if data.batches.is_empty() {
        return Ok(None);
    }
    let mut names = data.batches.clone();
    names.sort();
    names.dedup();
    let mut cells = data.cells.clone();
    for (cell, name) in cells.iter_mut().zip(&data.batches) {
        cell.block = 1 + names.binary_search(name).unwrap_or(0);
    }
    let observations = Observations::from_cells(cells)?;
    let fit = random_blocks(&data.factors, model, &observations, weighting)?;
    Ok(Some(fit))
}

/// Fits the process if asked for.
pub(super) fn comparison(
    arguments: &Arguments,
    factors: &[Factor],
    data: &Observations,
    fit: &Fit,
) -> anyhow::Result<Option<Comparison>> {
    if !arguments.gaussian_process {
        return Ok(None);
    }
    let process = gaussian_process(factors, data)?;
    // Unweighted, as that of the process.
    let deleted = |case: &response_surface::fit::Case| {
        let free = Some(1.0 - case.leverage).filter(|free| *free > 1e-10)?;
        Some((case.residual / free).powi(2))
    };
    let squares: Option<f64> = fit.cases.iter().map(deleted).sum();
    let polynomial = squares.map(|sum| (sum / fit.n as f64).sqrt());
    let better = match polynomial {
        Some(polynomial) if polynomial <= process.leave_one_out_rmse => "polynomial",
        _ => "gaussian-process",
    };
    Ok(Some(Comparison {
        process_leave_one_out_rmse: process.leave_one_out_rmse,
        polynomial_leave_one_out_rmse: polynomial,
        better,
        process,
    }))
}

/// The shares of the factors in the variance of the surface, if asked for.
pub(super) fn shares(
    arguments: &Arguments,
    data: &Data,
    fit: &Fit,
) -> anyhow::Result<Option<Sobol>> {
    if !arguments.sensitivity {
        return Ok(None);
    }
    ensure!(
        fit.formula.has_intercept(),
        "--sensitivity needs a model with its intercept: one through zero is not a surface over the ranges"
    );
    Ok(fit.sobol(&data.categories)?)
}

/// Keeps the rows of the regime asked for, and fits its boundary to the others.
pub(super) fn split_regimes(
    arguments: &Arguments,
    data: &mut Data,
) -> anyhow::Result<Option<Regime>> {
    let Some((column, name)) = &arguments.regime else {
        return Ok(None);
    };
    let mut labels = data.regimes.clone();
    labels.sort();
    labels.dedup();
    ensure!(
        labels.contains(name),
        "there is no regime '{name}' in column '{column}'; it holds {}",
        labels.join(", ")
    );
    let kept: Vec<bool> = data.regimes.iter().map(|label| label == name).collect();
    let boundary = if labels.len() > 1 {
        let coded: Vec<Vec<f64>> = data.cells.iter().map(|cell| cell.coded.clone()).collect();
        Some(regime(&data.factors, &coded, &data.regimes, name, SEED)?)
    } else {
        None
    };
    let mut places = kept.iter();
    data.cells
        .retain(|_| places.next().copied().unwrap_or(true));
    let mut places = kept.iter();
    data.batches
        .retain(|_| places.next().copied().unwrap_or(true));
    Ok(boundary)
}
