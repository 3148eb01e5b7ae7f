//! The stages of a calibration against one number.

use crate::Error;
use crate::cells::{CalibrationFactor, CellRuns, Question, observations, run_cells, value};
use campaign::{Campaign, RunRequest, Simulator};
use experiment_design::{Factor, box_behnken, plackett_burman};
use response_surface::{Fit, Model, Screening, fit, screen};
use run_store::Record;
use serde::{Deserialize, Serialize};

/// A screening design with its runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScreeningResult {
    /// Names of all columns: factors, then dummies.
    pub columns: Vec<String>,
    /// Runs of each cell.
    pub cells: Vec<CellRuns>,
    /// Analysis.
    pub screening: Screening,
}

/// A response surface with its runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceResult {
    /// The factors.
    pub factors: Vec<CalibrationFactor>,
    /// Runs of each cell.
    pub cells: Vec<CellRuns>,
    /// Analysis.
    pub fit: Fit,
}

/// A point to be run.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// What it is called.
    pub label: String,
    /// The run with its first seed.
    pub request: RunRequest,
    /// The observable that counts.
    pub observable: String,
    /// Number of runs, each with the next seed.
    pub runs: usize,
}

/// Runs at one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointResult {
    /// What was run, without the seed.
    pub label: String,
    /// Mean of the observable over the runs, unit of the observable.
    pub mean: f64,
    /// Standard deviation of the runs; none for one run.
    pub sd: Option<f64>,
    /// Number of runs.
    pub n: usize,
    /// Mean over the runs of the standard deviation over frames; none where not given.
    pub frame_sd: Option<f64>,
    /// Keys of the records.
    pub keys: Vec<String>,
}

/// Runs at the chosen solution against the target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// The runs.
    pub point: PointResult,
    /// Target, unit of the observable.
    pub target: f64,
    /// 100 |mean - target| / target, %.
    pub relative_error_percent: f64,
}

/// Screens factors by a Plackett-Burman design `[Plackett1946]`.
///
/// # Errors
///
/// No such design, runs that failed, an analysis that is not possible.
pub fn screen_factors(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    factors: &[CalibrationFactor],
    question: &Question<'_>,
) -> Result<ScreeningResult, Error> {
    let plain: Vec<Factor> = factors.iter().map(|f| f.factor.clone()).collect();
    let design = plackett_burman(&plain)?;
    let cells = run_cells(campaign, simulator, factors, &design.coded_rows(), question)?;
    let screening = screen(&design, &observations(&cells)?)?;
    Ok(ScreeningResult {
        columns: design.columns(),
        cells,
        screening,
    })
}

/// Symbols of the factors that matter: p below `alpha` against replicates where there are any,
/// otherwise against the dummy columns. At least `least` factors are taken, in order of rank.
pub fn significant_factors(screening: &Screening, alpha: f64, least: usize) -> Vec<String> {
    let matters = |f: &response_surface::FactorSignificance| {
        f.p_replicates.or(f.p_dummies).is_some_and(|p| p < alpha)
    };
    let mut ranked: Vec<_> = screening.factors.iter().collect();
    ranked.sort_by_key(|f| f.rank);
    let taken = ranked.iter().filter(|f| matters(f) || f.rank <= least);
    taken.map(|f| f.factor.clone()).collect()
}

/// Fits a quadratic surface by a Box-Behnken design `[Box1960]`.
///
/// # Errors
///
/// No such design, runs that failed, an analysis that is not possible.
pub fn fit_surface(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    factors: &[CalibrationFactor],
    n_centre: usize,
    question: &Question<'_>,
) -> Result<SurfaceResult, Error> {
    let plain: Vec<Factor> = factors.iter().map(|f| f.factor.clone()).collect();
    let design = box_behnken(&plain, n_centre)?;
    let cells = run_cells(campaign, simulator, factors, &design.coded_rows(), question)?;
    let fit = fit(&plain, &Model::quadratic(&plain)?, &observations(&cells)?)?;
    Ok(SurfaceResult {
        factors: factors.to_vec(),
        cells,
        fit,
    })
}

/// Runs all points in one list, so that no core waits, and gives the means of their observables.
///
/// # Errors
///
/// Runs that failed, an observable that is missing.
pub fn run_points(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    points: &[Point],
) -> Result<Vec<PointResult>, Error> {
    let seeds = |point: &Point| {
        let request = point.request.clone();
        (0..point.runs).map(move |r| request.clone().with_seed(request.seed + r as u64))
    };
    let requests: Vec<_> = points.iter().flat_map(seeds).collect();
    let records = campaign.run_all(simulator, &requests)?;
    let mut left = &records[..];
    points
        .iter()
        .map(|point| {
            let (records, others) = left.split_at(point.runs);
            left = others;
            point_result(point, records)
        })
        .collect()
}

/// The mean over the runs of a point.
fn point_result(point: &Point, records: &[Record]) -> Result<PointResult, Error> {
    let observable = &point.observable;
    let values = records
        .iter()
        .map(|r| value(r, observable))
        .collect::<Result<Vec<_>, _>>()?;
    let frame_sds: Vec<f64> = records
        .iter()
        .filter_map(|r| r.observable(observable).and_then(|o| o.sd))
        .collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    Ok(PointResult {
        label: point.label.clone(),
        mean,
        sd: (values.len() > 1).then(|| (square / (n - 1.0)).sqrt()),
        n: values.len(),
        frame_sd: (!frame_sds.is_empty())
            .then(|| frame_sds.iter().sum::<f64>() / frame_sds.len() as f64),
        keys: records.iter().map(|r| r.key().to_owned()).collect(),
    })
}

impl Validation {
    /// Compares runs at the chosen solution, with seeds of their own, with the target.
    pub fn new(point: PointResult, target: f64) -> Self {
        Self {
            relative_error_percent: 100.0 * (point.mean - target).abs() / target.abs(),
            point,
            target,
        }
    }
}
