//! What to measure next if the measurements leave combinations of parameters open.
//!
//! # Formula
//!
//! Along an open combination the set of solutions reaches from one end to the other. Each candidate is run at [`STATIONS`] points of the set
//! from end to end, twice each: at t from -1/2 to 1/2. A parabola through the values y of an observable gives its slope dy/dt, of which the
//! least over the set counts, since a candidate that is flat in a part of it leaves that part open:
//!
//! `D² = min over t of the sum over observables of ((dy/dt)² - v) / max(se², s²/n)`
//!
//! se is the standard error that the measured mean would have, s the standard deviation of a single run about the parabola, n the number of
//! repeats (n repeats of a bench whose runs scatter by s are not known better than s/sqrt(n)), and v the variance of the slope. D is the distance of the
//! two ends in standard errors of the candidate if all of the set is as poorly distinguished as its worst part. With the separation N
//! that the ends have now, that with the candidate is sqrt(N² + D²). Candidates are ranked by what they add per minute to the sum of squared
//! separations, each counted up to that which would do.

use crate::calibrate::Estimated;
use crate::confirmation::Confirmed;
use crate::diagnosis::SEPARATION_TO_REACH;
use crate::intervals::SHARE;
use crate::region::Region;
use crate::samples::{
    Asked, Runner, Sample, Samples, Wanted, first_seed, of_regime, request, usual_regime, wanted,
};
use crate::search::Found;
use crate::{
    CalibrationProblem, Candidate, Error, Measurement, Parameter, PlannedStage, Role, RunList,
    most_runs_of_diagnosis,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use serde::Serialize;
use std::collections::BTreeMap;

/// Name of the stage.
pub(crate) const NAME: &str = "what to measure next";
/// Stage number: sets the seeds.
const STAGE: u64 = 90;
/// Points of the set at which a candidate is run: two more than a parabola needs.
const STATIONS: usize = 5;
/// Runs at each: their scatter is that of a single experiment.
const RUNS: usize = 2;
/// Places at which the slope of the parabola is looked at.
const PLACES: usize = 21;

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
    /// Standard error that each parameter would have if the candidate told the place along the open combinations alone, unit of the
    /// parameter; `None` if it stays open.
    pub standard_errors: BTreeMap<String, Option<f64>>,
    /// Runs that were done at it.
    pub runs: usize,
    /// Keys of their records.
    pub keys: Vec<String>,
}

/// The stage with the runs that it may need; `None` if the problem states no candidates.
pub(crate) fn planned_next(asked: Asked<'_>) -> Option<PlannedStage> {
    let problem = with_candidates(asked.problem)?;
    let middle = Region::first(&problem.parameters).middle();
    let all = Asked {
        problem: &problem,
        ..asked
    };
    let stations = [vec![middle; STATIONS]];
    let list = candidate_runs(all, asked.problem.models.len(), &stations);
    let requests = list.iter().map(|w| request(&problem, w)).collect();
    Some(PlannedStage {
        stage: NAME.to_owned(),
        certain: Vec::new(),
        further: vec![RunList::once(requests)],
    })
}

/// Runs the candidates of a problem and ranks them; `None` if it states none or nothing is open.
///
/// # Errors
///
/// A campaign that was stopped.
pub(crate) fn next_for_parameters(
    runner: &Runner<'_>,
    confirmed: &Confirmed,
    estimate: &Estimated,
    spent: usize,
) -> Result<Option<NextForParameters>, Error> {
    let Some(problem) = with_candidates(runner.problem) else {
        return Ok(None);
    };
    let open = Open::of(runner.problem, &confirmed.found, estimate);
    if open.directions.is_empty() {
        return Ok(None);
    }
    let first = runner.problem.models.len();
    let asked = Asked {
        problem: &problem,
        ..runner.asked
    };
    let own = Runner { asked, ..*runner };
    let stations: Vec<_> = open.directions.iter().map(|d| d.stations.clone()).collect();
    let list = candidate_runs(own.asked, first, &stations);
    let now = open.squared(&estimate.uncertainty.covariance);
    let mut next = NextForParameters {
        now: least(&now),
        needed: SEPARATION_TO_REACH,
        ranked: Vec::new(),
        left_out: BTreeMap::new(),
    };
    if let Some(reason) = beyond_budget(runner.asked, spent, list.len()) {
        let named = stated(runner.problem).map(|c| (c.model.name.clone(), reason.clone()));
        next.left_out.extend(named);
        return Ok(Some(next));
    }
    let mut runs = own.run(&list)?;
    let mut gains = Vec::new();
    for (candidate, model) in stated(runner.problem).zip(first..) {
        let samples = runs.remove(&model).unwrap_or_default();
        let regime = usual_regime(&samples.done);
        let (usual, _) = of_regime(&samples.done, &regime);
        let each = open.directions.iter();
        let added: Option<Vec<f64>> = each
            .map(|direction| added_square(candidate, direction, &usual))
            .collect();
        let Some(added) = added else {
            next.left_out
                .insert(candidate.model.name.clone(), failure(&samples));
            continue;
        };
        let squares: Vec<f64> = now.iter().zip(&added).map(|(n, a)| n + a).collect();
        let gain = (capped(&squares) - capped(&now)) / candidate.minutes;
        let covariance = open.with(&estimate.uncertainty.covariance, &added);
        let errors = open.standard_errors(runner.problem.tuned(), &covariance, &squares);
        let ranked = RankedMeasurement {
            name: candidate.model.name.clone(),
            minutes: candidate.minutes,
            separation: least(&squares),
            standard_errors: errors,
            runs: samples.done.len(),
            keys: samples.done.iter().map(|s| s.key.clone()).collect(),
        };
        gains.push((gain, ranked));
    }
    // A stable sort: equal ones stay in the order of the file.
    gains.sort_by(|a, b| b.0.total_cmp(&a.0));
    next.ranked = gains.into_iter().map(|(_, ranked)| ranked).collect();
    Ok(Some(next))
}

/// Square of D of the module's formula, of runs of a candidate along a combination; `None` if too few of them gave values.
fn added_square(candidate: &Candidate, direction: &Direction, runs: &[&Sample]) -> Option<f64> {
    if direction.extent <= 0.0 {
        return Some(0.0);
    }
    let places: Vec<f64> = runs.iter().map(|run| direction.place(&run.at)).collect();
    let errors = candidate.standard_errors.iter();
    let curves: Option<Vec<Curve>> = errors
        .map(|(observable, se)| {
            let values = runs.iter().map(|run| run.values.get(observable).copied());
            let values: Option<Vec<f64>> = values.collect();
            Curve::of(&places, &values?, (*se, candidate.repeats))
        })
        .collect();
    let curves = curves?;
    let at = |k: usize| {
        let t = k as f64 / (PLACES - 1) as f64 - 0.5;
        curves.iter().map(|curve| curve.information(t)).sum::<f64>()
    };
    Some((0..PLACES).map(at).fold(f64::INFINITY, f64::min))
}

/// A parabola through the values of an observable along the set of solutions.
struct Curve {
    /// Coefficients of 1, t, t².
    coefficients: Vector3<f64>,
    /// Their covariance.
    covariance: Matrix3<f64>,
    /// Square of the standard error of the mean that a measurement would give.
    square_error: f64,
}

impl Curve {
    /// Least squares through values at places t; the standard error that a measured mean would have by the file, and its number of repeats.
    /// `None` of fewer than four values, or of fewer than three places.
    fn of(places: &[f64], values: &[f64], (se, repeats): (f64, f64)) -> Option<Self> {
        let row = |t: f64| Vector3::new(1.0, t, t * t);
        let freedom = values.len().checked_sub(3).filter(|d| *d > 0)?;
        let normal: Matrix3<f64> = places.iter().map(|t| row(*t) * row(*t).transpose()).sum();
        let right: Vector3<f64> = places.iter().zip(values).map(|(t, y)| row(*t) * *y).sum();
        let inverse = normal
            .try_inverse()
            .filter(|m| m.iter().all(|x| x.is_finite()))?;
        let coefficients = inverse * right;
        let residual = |(t, y): (&f64, &f64)| y - row(*t).dot(&coefficients);
        let squares = places.iter().zip(values).map(|pair| residual(pair).powi(2));
        let variance = squares.sum::<f64>() / freedom as f64;
        Some(Self {
            coefficients,
            covariance: inverse * variance,
            square_error: (se * se).max(variance / repeats),
        })
    }

    /// Square of the slope at a place without its noise, over that of the error of a measurement.
    fn information(&self, t: f64) -> f64 {
        let row = Vector3::new(0.0, 1.0, 2.0 * t);
        let slope = row.dot(&self.coefficients);
        let variance = row.dot(&(self.covariance * row));
        (slope * slope - variance).max(0.0) / self.square_error
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

/// Runs of the models from `first` on at the stations of each combination.
fn candidate_runs(asked: Asked<'_>, first: usize, stations: &[Vec<Vec<f64>>]) -> Vec<Wanted> {
    let Asked { problem, settings } = asked;
    let mut all = Vec::new();
    for model in first..problem.models.len() {
        let each = stations.iter().flatten();
        let points: Vec<_> = each.flat_map(|at| vec![at.clone(); RUNS]).collect();
        all.extend(wanted(
            first_seed(settings, STAGE, model),
            (model, 1.0),
            &points,
        ));
    }
    all
}

/// Why the budget does not allow so many runs after those that were spent; `None` if it does.
fn beyond_budget(asked: Asked<'_>, spent: usize, runs: usize) -> Option<String> {
    let most = asked.settings.most_runs?;
    let needed = spent + most_runs_of_diagnosis(asked.problem, asked.settings) + runs;
    (needed > most).then(|| {
        format!("the budget of {most} runs does not allow the {runs} runs at the candidates: raise it to {needed}")
    })
}

/// Why a candidate has too few values.
fn failure(samples: &Samples) -> String {
    let reason = samples.failed.first().map(|(_, reason)| reason.clone());
    reason.unwrap_or_else(|| "its runs end up in different regimes".to_owned())
}

/// The combinations of parameters that a fit leaves open.
struct Open {
    directions: Vec<Direction>,
    /// Widths of the limits.
    widths: Vec<f64>,
}

/// A combination, and the set of solutions along it.
struct Direction {
    /// Unit vector in widths of the limits.
    weights: DVector<f64>,
    /// The same over the widths: what a point is multiplied with.
    over_widths: Vec<f64>,
    /// Lower end of the set along it, in widths.
    low: f64,
    /// Distance of its ends, in widths.
    extent: f64,
    /// Points in the middle of the set from one end to the other, values of all parameters.
    stations: Vec<Vec<f64>>,
}

impl Direction {
    /// The set along a unit vector, from points of it.
    fn new(weights: DVector<f64>, widths: &[f64], points: &[Vec<f64>], all: &[f64]) -> Self {
        let over_widths = weights.iter().zip(widths).map(|(w, width)| w / width);
        let mut direction = Self {
            over_widths: over_widths.collect(),
            weights,
            low: 0.0,
            extent: 0.0,
            stations: Vec::new(),
        };
        let places: Vec<f64> = points.iter().map(|p| direction.along(p)).collect();
        let low = places.iter().copied().fold(f64::INFINITY, f64::min);
        let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // A set too narrow to be drawn from has no ends to distinguish.
        if high <= low {
            return direction;
        }
        (direction.low, direction.extent) = (low, high - low);
        for k in 0..STATIONS {
            let ends = [k, k + 1].map(|k| low + (high - low) * k as f64 / STATIONS as f64);
            let of_part = points.iter().zip(&places);
            let of_part = of_part.filter(|(_, u)| (ends[0]..=ends[1]).contains(u));
            let of_part: Vec<_> = of_part.map(|(point, _)| point).collect();
            if of_part.is_empty() {
                continue;
            }
            // The mean of a part of the set lies in its middle. Inputs stay at the estimate.
            let mut station = all.to_vec();
            for (j, value) in station.iter_mut().enumerate().take(widths.len()) {
                *value = of_part.iter().map(|p| p[j]).sum::<f64>() / of_part.len() as f64;
            }
            direction.stations.push(station);
        }
        direction
    }

    /// Place of a point along the combination, in widths.
    fn along(&self, point: &[f64]) -> f64 {
        let each = self.over_widths.iter().zip(point);
        each.map(|(w, x)| w * x).sum()
    }

    /// The same from -1/2 at the lower end to 1/2 at the upper one.
    fn place(&self, point: &[f64]) -> f64 {
        (self.along(point) - self.low) / self.extent - 0.5
    }
}

impl Open {
    fn of(problem: &CalibrationProblem, found: &Found, estimate: &Estimated) -> Self {
        let tuned = problem.tuned();
        let widths: Vec<f64> = tuned.iter().map(|p| p.limits[1] - p.limits[0]).collect();
        let open = estimate
            .uncertainty
            .open_combinations(tuned, found.free.as_slice());
        let directions = open.iter().map(|combination| {
            let weight = |p: &Parameter| combination.weights.get(&p.symbol);
            let weights = tuned.iter().map(|p| weight(p).copied().unwrap_or(0.0));
            let weights = DVector::from_iterator(tuned.len(), weights).normalize();
            Direction::new(weights, &widths, &estimate.solutions.points, &found.best)
        });
        Self {
            directions: directions.collect(),
            widths: widths.clone(),
        }
    }

    /// A covariance in widths of the limits.
    fn scaled(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let n = self.widths.len();
        DMatrix::from_fn(n, n, |i, j| {
            covariance[(i, j)] / (self.widths[i] * self.widths[j])
        })
    }

    /// Squared separation of the ends of each combination with a covariance of all parameters.
    fn squared(&self, covariance: &DMatrix<f64>) -> Vec<f64> {
        let scaled = self.scaled(covariance);
        let each = self.directions.iter();
        each.map(|d| d.extent * d.extent / d.weights.dot(&(&scaled * &d.weights)))
            .collect()
    }

    /// Standard error of each parameter by a covariance; `None` if it takes part in a combination whose squared separation would not do.
    fn standard_errors(
        &self,
        tuned: &[Parameter],
        covariance: &DMatrix<f64>,
        squares: &[f64],
    ) -> BTreeMap<String, Option<f64>> {
        let error = |(j, p): (usize, &Parameter)| {
            let mut all = self.directions.iter().zip(squares);
            let is_open = all.any(|(direction, square)| {
                direction.weights[j].powi(2) > SHARE && square.sqrt() < SEPARATION_TO_REACH
            });
            let se = covariance[(j, j)].max(0.0).sqrt();
            (p.symbol.clone(), (!is_open).then_some(se))
        };
        tuned.iter().enumerate().map(error).collect()
    }

    /// A covariance once the place along each combination, and nothing else, is known to its extent over D, by the squares of D.
    ///
    /// # Formula
    ///
    /// `C - C v v'C / (v'C v + (extent/D)²)` for each combination v.
    fn with(&self, covariance: &DMatrix<f64>, squares: &[f64]) -> DMatrix<f64> {
        let mut scaled = self.scaled(covariance);
        for (direction, square) in self.directions.iter().zip(squares) {
            if *square > 0.0 {
                let column = &scaled * &direction.weights;
                let known = direction.extent * direction.extent / square;
                let whole = direction.weights.dot(&column) + known;
                scaled -= &column * column.transpose() / whole;
            }
        }
        let n = self.widths.len();
        DMatrix::from_fn(n, n, |i, j| {
            scaled[(i, j)] * self.widths[i] * self.widths[j]
        })
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

#[cfg(test)]
mod tests {
    use super::Curve;

    /// By hand: two runs at -0.4, -0.2, 0, 0.2, 0.4 that lie 2 above and 2 below the line 15 t. The variance of a single run is 10 x 4/7 = 40/7, that of
    /// the slope in the middle 40/7/0.8, as the squares of t add up to 0.8. Five repeats are known to 8/7, not to the stated 0.25: the
    /// information is (225 - 50/7) / (8/7). With a stated standard error of 2 that one counts. Three runs show no scatter.
    #[test]
    fn the_scatter_of_single_runs_counts_where_it_is_the_larger_error() {
        let places: Vec<f64> = (-2..=2).flat_map(|k| [0.2 * f64::from(k); 2]).collect();
        let off = [2.0, -2.0].into_iter().cycle();
        let values: Vec<f64> = places
            .iter()
            .zip(off)
            .map(|(t, off)| 15.0 * t + off)
            .collect();
        let of = |se: f64| Curve::of(&places, &values, (se, 5.0)).expect("a curve");
        let close = |found: f64, expected: f64| {
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{found} for {expected}"
            );
        };
        let useful = 225.0 - 50.0 / 7.0;
        close(of(0.5).information(0.0), useful * 7.0 / 8.0);
        close(of(2.0).information(0.0), useful / 4.0);
        assert!(Curve::of(&places[..3], &values[..3], (0.5, 5.0)).is_none());
    }
}
