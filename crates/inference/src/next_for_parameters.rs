//! What to measure next if the measurements leave combinations of parameters open.
//!
//! # Formula
//!
//! Each candidate is run at the estimate and about it. The plane through its runs joins the fit as a measurement of the standard error
//! that the candidate would have, with the value that the plane has at the estimate. Along an open combination v, in widths of the
//! limits, the fit then has the standard error s = sqrt(v'C v). The separation of the candidate is the extent of the set of solutions along v
//! over s: how many standard errors apart it puts the two ends of what agrees with all measurements so far. Candidates are ranked by what
//! they add per minute to the sum of squared separations, each counted up to that which would do.

use crate::calibrate::Estimated;
use crate::confirmation::Confirmed;
use crate::designs::{placed, slope_design};
use crate::diagnosis::SEPARATION_TO_REACH;
use crate::intervals::{Uncertainty, best_of};
use crate::joint::planes;
use crate::joint_fit::JointFit;
use crate::region::Region;
use crate::samples::{Asked, Runner, Samples, Wanted, first_seed, request, wanted};
use crate::surface::Surface;
use crate::{
    CalibrationProblem, Candidate, Error, Estimate, Measurement, Parameter, PlannedStage, Role,
    RunList, most_runs_of_diagnosis,
};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::BTreeMap;

/// Name of the stage.
pub(crate) const NAME: &str = "what to measure next";
/// Stage number: sets the seeds.
const STAGE: u64 = 90;
/// Half width of the box about the estimate, in standard errors of the parameter.
const STANDARD_ERRORS: f64 = 2.0;
/// Its least half width, as a share of half the box of the file: a slope over less is noise.
const LEAST_SHARE: f64 = 0.3;

/// Candidates in the order of what they would say about the open combinations of parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextForParameters {
    /// Smallest separation without any of them, standard errors.
    pub now: f64,
    /// Separation that would do.
    pub needed: f64,
    /// Each alone with what is measured, the most helpful for its minutes first.
    pub ranked: Vec<RankedMeasurement>,
    /// Candidates that could not be run, with the reason.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub left_out: BTreeMap<String, String>,
}

/// A candidate with what it would give.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankedMeasurement {
    /// Its name.
    pub name: String,
    /// Work in the laboratory, min.
    pub minutes: f64,
    /// Smallest separation of the ends of the open combinations with it, standard errors.
    pub separation: f64,
    /// Standard error that each parameter would have with it, unit of the parameter; `None` if it stays open.
    pub standard_errors: BTreeMap<String, Option<f64>>,
    /// Runs that were done at it.
    pub runs: usize,
    /// Keys of their records.
    pub keys: Vec<String>,
}

/// The stage with the runs that it may need; `None` if the problem states no candidates.
pub(crate) fn planned_next(asked: Asked<'_>) -> Result<Option<PlannedStage>, Error> {
    let Some(problem) = with_candidates(asked.problem) else {
        return Ok(None);
    };
    let region = Region::first(&problem.parameters);
    let all = Asked {
        problem: &problem,
        ..asked
    };
    let (list, _) = candidate_runs(all, asked.problem.models.len(), (&region.middle(), &region))?;
    let requests = list.iter().map(|w| request(&problem, w)).collect();
    Ok(Some(PlannedStage {
        stage: NAME.to_owned(),
        certain: Vec::new(),
        further: vec![RunList::once(requests)],
    }))
}

/// Runs the candidates of a problem and ranks them; `None` if it states none or nothing is open.
///
/// # Errors
///
/// A campaign that was stopped, a covariance that is not positive definite.
pub(crate) fn next_for_parameters(
    runner: &Runner<'_>,
    confirmed: &Confirmed,
    estimate: &Estimated,
    spent: usize,
) -> Result<Option<NextForParameters>, Error> {
    let Some(mut problem) = with_candidates(runner.problem) else {
        return Ok(None);
    };
    let found = &confirmed.found;
    let open = Open::of(runner.problem, found.free.as_slice(), estimate);
    if open.directions.is_empty() {
        return Ok(None);
    }
    let first = runner.problem.models.len();
    let region = region_about(runner.problem, &found.best, &estimate.parameters);
    let own = Runner {
        asked: Asked {
            problem: &problem,
            ..runner.asked
        },
        ..*runner
    };
    let (list, n_at) = candidate_runs(own.asked, first, (&found.best, &region))?;
    let now = open.squared(&estimate.uncertainty.covariance);
    let mut next = NextForParameters {
        now: least(&now),
        needed: SEPARATION_TO_REACH,
        ranked: Vec::new(),
        left_out: BTreeMap::new(),
    };
    if let Some(reason) = beyond_budget(runner.asked, spent, list.len()) {
        let names = stated(runner.problem).map(|c| (c.model.name.clone(), reason.clone()));
        next.left_out = names.collect();
        return Ok(Some(next));
    }
    let [at_estimate, about] = own.run_parts(&list, n_at)?;
    let models: Vec<usize> = (first..problem.models.len()).collect();
    let planes = planes(own.asked, &models, &region, &about, &at_estimate);
    for m in &mut problem.measurements[runner.problem.measurements.len()..] {
        let place = planes.get(&m.model).and_then(|s| s.place(&m.observable));
        if let Some((surface, place)) = planes.get(&m.model).zip(place) {
            m.mean = surface.value(place, &found.best);
        }
    }
    let mut gains = Vec::new();
    for (candidate, model) in stated(runner.problem).zip(models) {
        let runs = [&at_estimate, &about].map(|part| part.get(&model));
        let Some(plane) = planes.get(&model) else {
            let name = candidate.model.name.clone();
            next.left_out.insert(name, failure(runs));
            continue;
        };
        let uncertainty = joined(&problem, confirmed, plane)?;
        let squares = open.squared(&uncertainty.covariance);
        let gain = (capped(&squares) - capped(&now)) / candidate.minutes;
        let tuned = runner.problem.tuned();
        let separation = least(&squares);
        gains.push((
            gain,
            ranked((candidate, separation), &uncertainty, tuned, runs),
        ));
    }
    // A stable sort: equal ones stay in the order of the file.
    gains.sort_by(|a, b| b.0.total_cmp(&a.0));
    next.ranked = gains.into_iter().map(|(_, ranked)| ranked).collect();
    Ok(Some(next))
}

/// A candidate with the separation and the errors that the parameters would have with it, and its runs.
fn ranked(
    (candidate, separation): (&Candidate, f64),
    uncertainty: &Uncertainty,
    tuned: &[Parameter],
    runs: [Option<&Samples>; 2],
) -> RankedMeasurement {
    let done = || runs.into_iter().flatten().flat_map(|s| &s.done);
    let errors = tuned.iter().enumerate();
    RankedMeasurement {
        name: candidate.model.name.clone(),
        minutes: candidate.minutes,
        separation,
        standard_errors: errors
            .map(|(j, p)| (p.symbol.clone(), uncertainty.standard_error(j, p)))
            .collect(),
        runs: done().count(),
        keys: done().map(|sample| sample.key.clone()).collect(),
    }
}

/// The candidates that the file names.
fn stated(problem: &CalibrationProblem) -> impl Iterator<Item = &Candidate> {
    problem.candidates.iter().filter(|c| !c.is_suggested)
}

/// The problem with its stated candidates as further models, and a measurement of each of their observables whose value is not known
/// yet; `None` without any.
fn with_candidates(problem: &CalibrationProblem) -> Option<CalibrationProblem> {
    let mut all = problem.clone();
    for candidate in stated(problem) {
        let model = all.models.len();
        all.models.push(candidate.model.clone());
        let errors = candidate.standard_errors.iter();
        all.measurements
            .extend(errors.map(|(observable, se)| Measurement {
                model,
                observable: observable.clone(),
                role: Role::Check,
                mean: 0.0,
                sd: *se,
                n: 1.0,
                is_scatter: false,
            }));
    }
    (all.models.len() > problem.models.len()).then_some(all)
}

/// The box about the estimate: that of the file along parameters that are open.
fn region_about(problem: &CalibrationProblem, at: &[f64], estimates: &[Estimate]) -> Region {
    let half = |(j, p): (usize, &Parameter)| {
        let whole = 0.5 * (p.range[1] - p.range[0]);
        let se = estimates.get(j).and_then(|estimate| estimate.se);
        se.map_or(whole, |se| {
            (STANDARD_ERRORS * se).clamp(LEAST_SHARE * whole, whole)
        })
    };
    let half: Vec<f64> = problem.parameters.iter().enumerate().map(half).collect();
    Region::about(at, &half, &problem.parameters)
}

/// Runs of the models from `first` on at the estimate, and behind them those about it; the number of the former.
fn candidate_runs(
    asked: Asked<'_>,
    first: usize,
    (at, region): (&[f64], &Region),
) -> Result<(Vec<Wanted>, usize), Error> {
    let Asked { problem, settings } = asked;
    let (mut at_estimate, mut about) = (Vec::new(), Vec::new());
    for model in first..problem.models.len() {
        let seed = first_seed(settings, STAGE, model);
        let n = settings.check_runs.max(2);
        at_estimate.extend(wanted(seed, (model, 1.0), &vec![at.to_vec(); n]));
        let active = problem.tuned_of(model);
        if !active.is_empty() {
            let rows = slope_design(&problem.symbols(&active), settings.seed)?;
            let points = placed(&rows, &active, region, &problem.parameters);
            about.extend(wanted(seed + n as u64, (model, 1.0), &points));
        }
    }
    let n_at = at_estimate.len();
    at_estimate.extend(about);
    Ok((at_estimate, n_at))
}

/// Why the budget does not allow so many runs after those that were spent; `None` if it does.
fn beyond_budget(asked: Asked<'_>, spent: usize, runs: usize) -> Option<String> {
    let most = asked.settings.most_runs?;
    let needed = spent + most_runs_of_diagnosis(asked.problem, asked.settings) + runs;
    (needed > most).then(|| {
        format!("the budget of {most} runs does not allow the {runs} runs at the candidates: raise it to {needed}")
    })
}

/// The uncertainty of the fit with a further measured plane.
fn joined(
    problem: &CalibrationProblem,
    confirmed: &Confirmed,
    plane: &Surface,
) -> Result<Uncertainty, Error> {
    let found = &confirmed.found;
    let mut surfaces = found.surfaces.clone();
    surfaces.push(plane.clone());
    let fit = JointFit::new(problem, &found.region, &surfaces, &[Role::Fit, Role::Check]);
    let best = best_of(&found.minima)?;
    let whitening = fit.whitening(&fit.natural(&best.coded))?;
    Ok(Uncertainty::new(&fit, best, &whitening))
}

/// Why a candidate has no plane.
fn failure(runs: [Option<&Samples>; 2]) -> String {
    let failed = runs.into_iter().flatten().flat_map(|s| &s.failed);
    let mut reasons = failed.map(|(_, reason)| reason.clone());
    let reason = reasons.next();
    reason.unwrap_or_else(|| "its runs end up in different regimes".to_owned())
}

/// The combinations of parameters that a fit leaves open.
struct Open {
    /// Directions in widths of the limits, with the extent of the set of solutions along each.
    directions: Vec<(DVector<f64>, f64)>,
    /// Widths of the limits.
    widths: Vec<f64>,
}

impl Open {
    fn of(problem: &CalibrationProblem, free: &[bool], estimate: &Estimated) -> Self {
        let tuned = problem.tuned();
        let widths: Vec<f64> = tuned.iter().map(|p| p.limits[1] - p.limits[0]).collect();
        let open = estimate.uncertainty.open_combinations(tuned, free);
        let directions = open.iter().map(|combination| {
            let weight = |p: &Parameter| combination.weights.get(&p.symbol);
            let weights = tuned.iter().map(|p| weight(p).copied().unwrap_or(0.0));
            let direction = DVector::from_iterator(tuned.len(), weights).normalize();
            let along = |point: &Vec<f64>| -> f64 {
                let each = direction.iter().zip(point.iter().zip(&widths));
                each.map(|(w, (x, width))| w * x / width).sum()
            };
            let ends = estimate.solutions.points.iter().map(along);
            let ends = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            // A set too narrow to be drawn from has no ends to distinguish.
            let extent = (ends[1] - ends[0]).max(0.0);
            (direction, extent)
        });
        Self {
            directions: directions.collect(),
            widths: widths.clone(),
        }
    }

    /// Squared separation of the ends of each combination with a covariance of all parameters.
    fn squared(&self, covariance: &DMatrix<f64>) -> Vec<f64> {
        let n = self.widths.len();
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            covariance[(i, j)] / (self.widths[i] * self.widths[j])
        });
        let each = self.directions.iter();
        each.map(|(v, extent)| extent * extent / v.dot(&(&scaled * v)))
            .collect()
    }
}

/// The smallest separation.
fn least(squares: &[f64]) -> f64 {
    squares.iter().copied().fold(f64::INFINITY, f64::min).sqrt()
}

/// The sum of squared separations, each up to that which would do.
fn capped(squares: &[f64]) -> f64 {
    let most = SEPARATION_TO_REACH * SEPARATION_TO_REACH;
    squares.iter().map(|square| square.min(most)).sum()
}
