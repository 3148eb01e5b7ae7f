//! The simulator near the starting point: the slopes by its runs there and beside it.

use super::fits::Visited;
use super::runs::{At, Means, Row, Setting, differ, numbers, readable, requests, rows_of};
use super::scatter::Scatter;
use super::slopes::{ConditionSlopes, Points, SlopeError, Slopes};
use super::whitened::difference;
use super::worker::Worker;
use super::{ResidualPlan, StudyCondition, assemble};
use crate::Error;
use crate::diagnosis::CovarianceMatrix;
use campaign::RunRequest;
use campaign::run_store::Record;
use std::collections::{BTreeMap, BTreeSet};

/// The simulator near the starting point.
#[derive(Debug, Clone)]
pub(super) struct Linearisation {
    /// Means at the start; as in the tables below, the rows of conditions that are kept apart are
    /// empty.
    pub(super) nominal: Means,
    /// d observable / d parameter, (conditions, observables, parameters).
    pub(super) declared: Vec<ConditionSlopes>,
    /// Errors of these.
    pub(super) declared_errors: Vec<SlopeError>,
    /// The runs behind them.
    points: Points,
    /// d observable / d amplitude, (conditions, observables, effects).
    pub(super) library: Vec<ConditionSlopes>,
    /// Variance of each column of `library` over that of one run, 1 / (unit of the amplitude)^2.
    pub(super) library_variance: Vec<f64>,
    /// Share of the noise of a run that a run with the effect does not share with the one without it: 1, or
    /// less where the effect leaves the motion alone.
    own_noise: Vec<f64>,
    /// Whether each parameter, and behind them each effect, moves the runs of a condition at all, (columns, conditions).
    pub(super) moves: Vec<Vec<bool>>,
    /// Covariance of one run at each condition, pooled over settings, (conditions, observables, observables).
    pub(super) run_covariance: Vec<CovarianceMatrix>,
    /// Degrees of freedom of the variances of each observable, see [`Scatter::by_condition`].
    pub(super) noise_dof: Vec<f64>,
    /// Scatter of all runs so far.
    scatter: Scatter,
    /// Effects that could not be run at the amplitude that would explain the data.
    pub(super) not_run: BTreeSet<usize>,
}

impl Linearisation {
    /// Runs the start and, for each parameter and each effect, a point beside it, with replicates at
    /// every condition that the fit uses, all in one list so that no core waits.
    ///
    /// All settings have the same seeds. With contacts that come and go, two runs of one seed part ways
    /// within a second, so that this saves no noise; but an effect that leaves the motion alone, such as that
    /// of a camera, has most of the noise of the start, which then leaves its sensitivity.
    ///
    /// An effect that cannot be run, such as one whose bed shows no surface to the camera, is left out;
    /// the second part of the result has the reasons by effect. The tables have no column for it.
    ///
    /// # Errors
    ///
    /// [`Error::Cell`] where failed runs leave the start, or a step in a parameter, without a mean at a condition.
    pub(super) fn run(
        worker: &Worker<'_>,
        plan: &ResidualPlan,
    ) -> Result<(Self, BTreeMap<String, String>), Error> {
        let settings = start_and_steps(plan);
        let points = settings.iter().map(|(point, _)| point);
        let lists: Vec<Vec<RunRequest>> = points
            .map(|point| requests(plan, point, 0, At::Used))
            .collect();
        let results = readable(plan, At::Used, worker.each(&lists.concat())?);
        let mut left = &results[..];
        let (mut beside, mut left_out) = (Beside::default(), BTreeMap::new());
        for (i, list) in lists.iter().enumerate() {
            let (own, others) = left.split_at(list.len());
            left = others;
            let effect = i.checked_sub(1 + plan.parameters.len());
            let records = match (worker.borne(list, own, plan.replicates), effect) {
                (Ok(records), _) => records,
                (Err(short), None) => return Err(short.error(plan, &numbers(plan, At::Used))),
                (Err(short), Some(j)) => {
                    left_out.insert(plan.effects[j].name.clone(), short.reason);
                    continue;
                }
            };
            beside.take(plan, Runs::new(plan, records)?, settings[i].1, effect);
        }
        Ok((Self::of(plan, beside, &settings), left_out))
    }

    /// The slopes by the runs at the start and beside it.
    fn of(plan: &ResidualPlan, beside: Beside<'_>, settings: &[(Setting, f64)]) -> Self {
        let Beside {
            probes,
            own_noise,
            moves,
            ..
        } = beside;
        let mut probes = probes.into_iter();
        let first = probes.next().map(|(means, _)| means);
        let nominal = first.unwrap_or_else(|| Means::of(&[], plan.replicates));
        let probes: Vec<(Means, f64)> = probes.collect();
        let (declared, library) = probes.split_at(plan.parameters.len().min(probes.len()));
        let mut scatter = nominal.scatter.clone();
        let own = library
            .iter()
            .zip(&own_noise)
            .filter(|(_, own)| **own >= 1.0);
        for (probe, _) in declared.iter().chain(own.map(|(probe, _)| probe)) {
            scatter.add(&probe.scatter);
        }
        let slope = |(probe, step): &(Means, f64), c: usize, k: usize| {
            (probe.values[c][k] - nominal.values[c][k]) / step
        };
        let row = |c: usize, k: usize| library.iter().map(|p| slope(p, c, k)).collect();
        let columns = (0..plan.conditions.len())
            .map(|c| (0..nominal.values[c].len()).map(|k| row(c, k)).collect());
        let means = std::iter::once(&nominal).chain(declared.iter().map(|(means, _)| means));
        let at = settings.iter().map(|(setting, _)| setting);
        let points = Points::new(plan, at.zip(means), &moves);
        let Slopes { values, errors } = points.slopes();
        let (run_covariance, noise_dof) = scatter.by_condition(&nominal.scatter);
        // A difference of two means, each of as many runs as the smaller one at least.
        let n = |probe: &Means| probe.least_n().min(nominal.least_n()) as f64;
        Self {
            library: columns.collect(),
            declared: values,
            declared_errors: errors,
            points,
            library_variance: library
                .iter()
                .zip(&own_noise)
                .map(|((probe, step), own)| 2.0 * own / (n(probe) * step * step))
                .collect(),
            own_noise,
            moves,
            run_covariance,
            noise_dof,
            nominal,
            scatter,
            not_run: BTreeSet::new(),
        }
    }

    /// The same with the runs at further points, at which no effect is on, in the slopes and in the scatter.
    pub(super) fn with_points(mut self, visited: &[Visited]) -> Self {
        for point in visited {
            self.points.visit(&point.setting, &point.means);
            self.scatter.add(&point.means.scatter);
        }
        let Slopes { values, errors } = self.points.slopes();
        (self.declared, self.declared_errors) = (values, errors);
        (self.run_covariance, self.noise_dof) = self.scatter.by_condition(&self.nominal.scatter);
        self
    }

    /// Covariance of one run, pooled over all conditions, (observables, observables).
    pub(super) fn pooled_covariance(&self) -> Vec<Vec<f64>> {
        self.scatter.pooled()
    }

    /// Standard deviation of one run by observable, pooled over all conditions.
    pub(super) fn scatter_of_runs(&self, plan: &ResidualPlan) -> BTreeMap<String, f64> {
        let pooled = self.pooled_covariance();
        let sds = (0..pooled.len()).map(|k| pooled[k][k].sqrt());
        plan.observables.iter().cloned().zip(sds).collect()
    }

    /// Whether the runs with an effect have the noise of those without it, as those of a camera have.
    pub(super) fn shares_noise(&self, effect: usize) -> bool {
        self.own_noise[effect] < 1.0
    }

    /// Share of the noise of a run with an effect that a run of the same seed with another amplitude of it does not have.
    pub(super) fn own_noise(&self, effect: usize) -> f64 {
        self.own_noise[effect]
    }

    /// Replaces the column of an effect by the secant from the fitted point to another one, at which the effect is on
    /// and the declared parameters may be others.
    ///
    /// The noise of the fitted point is in the residual already. Of runs that share it, what they do not
    /// share is left of both points. Two points with as much of the effect say nothing of it.
    ///
    /// # Formula
    ///
    /// `(f(on) - f(fit) - S (theta_on - theta_fit)) / (a_on - a_fit)`: the linear model then goes through both points.
    pub(super) fn with_secant(
        mut self,
        effect: usize,
        (fit, at_fit): (&Setting, &Means),
        (setting, on): (&Setting, &Means),
    ) -> Self {
        let amplitude = setting.effects[effect] - fit.effects[effect];
        if amplitude == 0.0 {
            return self;
        }
        self.not_run.remove(&effect);
        let moved = displacement(fit, setting);
        let rows = on.values.iter().zip(&at_fit.values);
        let moves = &self.moves[moved.len() + effect];
        let tables = self.library.iter_mut().zip(&self.declared);
        for (((columns, declared), (on, off)), _) in
            tables.zip(rows).zip(moves).filter(|(_, moves)| **moves)
        {
            let values = on.iter().zip(off).zip(declared);
            for (slopes, ((on, off), declared)) in columns.iter_mut().zip(values) {
                let by_parameters: f64 = declared.iter().zip(&moved).map(|(s, d)| s * d).sum();
                slopes[effect] = (on - off - by_parameters) / amplitude;
            }
        }
        let shares = self.shares_noise(effect);
        let runs = if shares {
            2.0 * self.own_noise[effect]
        } else {
            1.0
        };
        self.library_variance[effect] = runs / (on.least_n() as f64 * amplitude * amplitude);
        if shares { self } else { self.with_scatter(on) }
    }

    /// The same with the slopes of the parameters beside a point, by the means there and a step away in each of them, with the
    /// lengths of the steps. What a parameter does not move at the start it moves nowhere.
    pub(super) fn with_slopes_beside(mut self, at: &Means, steps: &[(Means, f64)]) -> Self {
        for (c, slopes) in self.declared.iter_mut().enumerate() {
            for (k, of_observable) in slopes.iter_mut().enumerate() {
                for (j, (means, length)) in steps.iter().enumerate() {
                    if self.moves[j][c] && *length != 0.0 {
                        of_observable[j] = (means.values[c][k] - at.values[c][k]) / length;
                    }
                }
            }
        }
        self
    }

    /// The means that the slopes promise at a setting, from those of a point.
    pub(super) fn means_at(
        &self,
        effect: usize,
        (point, means): (&Setting, &Means),
        setting: &Setting,
    ) -> Means {
        let further = setting.effects[effect] - point.effects[effect];
        let moved = displacement(point, setting);
        let mut promised = means.clone();
        let tables = self.declared.iter().zip(&self.library);
        for (row, (declared, library)) in promised.values.iter_mut().zip(tables) {
            let slopes = declared.iter().zip(library);
            for (value, (declared, library)) in row.iter_mut().zip(slopes) {
                let by_parameters: f64 = declared.iter().zip(&moved).map(|(s, d)| s * d).sum();
                *value += by_parameters + library[effect] * further;
            }
        }
        promised
    }

    /// The same with slopes that go through two points that were run; `None` if these do not contradict the slopes,
    /// by more than is likely with the noise of the runs.
    ///
    /// # Formula
    ///
    /// For a step `d` in parameters and amplitudes, each over the step of its difference quotient, the slopes `J`
    /// become `J + (f(to) - f(from) - J d) d' / d'd`: the least change that does it `[Broyden1965]`, method 1. The
    /// variance of the bracket is that of two means and of `d'd` slopes, each a difference of two means.
    pub(super) fn contradicted(
        &self,
        plan: &ResidualPlan,
        effects: &[String],
        (from, at_from): (&Setting, &Means),
        (to, at_to): (&Setting, &Means),
    ) -> Result<Option<Self>, Error> {
        let declared = displacement(from, to).into_iter().zip(&plan.parameters);
        let declared: Vec<f64> = declared.map(|(way, d)| way / d.step()).collect();
        let taken = plan.effects.iter().enumerate();
        let way = |j: usize| to.effects[j] - from.effects[j];
        let taken: Vec<(usize, f64)> = taken
            .filter(|(_, e)| effects.contains(&e.name))
            .map(|(j, e)| (j, way(j) / e.probe))
            .collect();
        let steps = declared.iter().chain(taken.iter().map(|(_, d)| d));
        let size: f64 = steps.map(|d| d * d).sum();
        if size == 0.0 {
            return Ok(None);
        }
        let off = |c: usize, k: usize| {
            let slopes = self.declared[c][k].iter().zip(&declared);
            let by_parameters = slopes
                .zip(&plan.parameters)
                .map(|((s, d), p)| s * d * p.step());
            let slopes = &self.library[c][k];
            let effect = |&(j, d): &(usize, f64)| slopes[j] * d * plan.effects[j].probe;
            let linear = by_parameters.sum::<f64>() + taken.iter().map(effect).sum::<f64>();
            at_to.values[c][k] - at_from.values[c][k] - linear
        };
        let runs = |c: usize| {
            let of_means = 1.0 / at_from.n[c] as f64 + 1.0 / at_to.n[c] as f64;
            of_means + size * 2.0 / self.nominal.n[c] as f64
        };
        let contradiction = difference(plan, self, runs, off)?;
        let rows = contradiction.len();
        if contradiction.norm_squared() <= assemble::likely_mean_square(rows) * rows as f64 {
            return Ok(None);
        }
        let mut corrected = self.clone();
        for (c, k) in plan.rows(At::Used) {
            let slopes = corrected.declared[c][k].iter_mut().zip(&declared);
            for ((slope, d), p) in slopes.zip(&plan.parameters) {
                *slope += off(c, k) * d / size / p.step();
            }
            for &(j, d) in &taken {
                corrected.library[c][k][j] += off(c, k) * d / size / plan.effects[j].probe;
            }
        }
        Ok(Some(corrected))
    }

    /// The fewest degrees of freedom of an observable; 0 if no runs show any scatter.
    pub(super) fn least_dof(&self) -> f64 {
        let least = self.noise_dof.iter().copied().fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 0.0 }
    }

    /// The same with the scatter of further means in the covariance: the noise of a run is taken
    /// to be the same at all settings, and more degrees of freedom make sharper tests.
    pub(super) fn with_scatter(mut self, means: &Means) -> Self {
        self.scatter.add(&means.scatter);
        (self.run_covariance, self.noise_dof) = self.scatter.by_condition(&self.nominal.scatter);
        self
    }
}

/// How far each parameter goes from one point to another.
fn displacement(from: &Setting, to: &Setting) -> Vec<f64> {
    let pairs = from.parameters.iter().zip(&to.parameters);
    pairs.map(|(from, to)| to - from).collect()
}

/// The start, a step in each declared parameter, and each effect at its probe; with the size of the step.
pub(super) fn start_and_steps(plan: &ResidualPlan) -> Vec<(Setting, f64)> {
    let start: Vec<f64> = plan.parameters.iter().map(|d| d.start).collect();
    let at_start = Setting::declared(plan, &start);
    let mut settings = vec![(at_start.clone(), 1.0)];
    for (j, declared) in plan.parameters.iter().enumerate() {
        let mut moved = at_start.clone();
        moved.parameters[j] += declared.step();
        settings.push((moved, declared.step()));
    }
    for (j, effect) in plan.effects.iter().enumerate() {
        let on = at_start.clone().with_amplitude(j, effect.probe);
        settings.push((on, effect.probe));
    }
    settings
}

/// The runs at the start and beside it.
#[derive(Debug, Default)]
struct Beside<'a> {
    start: Option<Runs<'a>>,
    /// Means at the start and at each step that could be run, with the size of the step.
    probes: Vec<(Means, f64)>,
    /// Share of the noise that the runs of each effect do not share with those of the start.
    own_noise: Vec<f64>,
    /// Whether each step moves the runs of a condition, (steps, conditions).
    moves: Vec<Vec<bool>>,
}

impl<'a> Beside<'a> {
    /// Takes the next point.
    fn take(&mut self, plan: &ResidualPlan, runs: Runs<'a>, step: f64, effect: Option<usize>) {
        let r = plan.replicates;
        let mut means = Means::of(&runs.rows, r).spread_over(plan, true);
        match &self.start {
            None => self.start = Some(runs),
            Some(start) => {
                let moved = moved(plan, start, &runs, r);
                // What was run already does not scatter once more.
                means.scatter = means.scatter.only(&moved);
                if effect.is_some() {
                    self.own_noise.push(own_noise_of(start, &runs, r));
                }
                self.moves.push(moved);
            }
        }
        self.probes.push((means, step));
    }
}

/// Share of the noise of a run that runs with an effect do not share with the runs of the same seeds
/// without it; 1 where something else moved.
///
/// # Formula
///
/// For each observable the sum of squares of `(on - off) - mean` over that of `on - mean` and `off - mean`,
/// means over the `r` runs of a condition; the largest of all observables, at most 1.
///
/// Conditions at which the effect changes nothing say nothing of it.
fn own_noise_of(off: &Runs<'_>, on: &Runs<'_>, r: usize) -> f64 {
    let (off, on) = (&off.differing_from(on, r), &on.differing_from(off, r));
    if !same_motion(&off.records, &on.records, r) {
        return 1.0;
    }
    let difference = |(on, off): (&Row, &Row)| -> Row {
        let pairs = on.as_ref()?.iter().zip(off.as_ref()?);
        Some(pairs.map(|(a, b)| a - b).collect())
    };
    let differences: Vec<_> = on.rows.iter().zip(&off.rows).map(difference).collect();
    let squares = |rows: &[Row], k: usize| Means::of(rows, r).scatter.sum_of_squares(k);
    let share = |k: usize| {
        let own = squares(&differences, k);
        let both = squares(&on.rows, k) + squares(&off.rows, k);
        if own > 0.0 { own / both } else { 0.0 }
    };
    let width = on.rows.iter().flatten().next().map_or(0, Vec::len);
    (0..width).map(share).fold(0.0, f64::max).min(1.0)
}

/// Whether the same moved in all pairs of runs of one seed: of the observables that vary from run to run
/// half or more agree in all pairs to the last bit. One alone may do so by chance, where it is a count.
fn same_motion(off: &[Option<&Record>], on: &[Option<&Record>], r: usize) -> bool {
    let value = |record: &Record, name: &str| record.observable(name).map(|o| o.mean.to_bits());
    let known = off.iter().flatten();
    let names = known.flat_map(|record| record.observables().keys());
    let (mut varying, mut agreeing) = (0, 0);
    for name in names.collect::<BTreeSet<_>>() {
        let of = |records: &[Option<&Record>]| -> Vec<_> {
            let each = records.iter();
            each.map(|record| record.and_then(|record| value(record, name)))
                .collect()
        };
        let (off, on) = (of(off), of(on));
        let mut groups = off.chunks(r);
        if groups.any(|group| group.iter().any(|v| *v != group[0])) {
            varying += 1;
            agreeing += usize::from(off == on);
        }
    }
    agreeing > 0 && 2 * agreeing >= varying
}

/// Runs with their observables in the order of the plan; `None` if a run is left out.
#[derive(Debug, Clone)]
struct Runs<'a> {
    records: Vec<Option<&'a Record>>,
    rows: Vec<Row>,
}

impl<'a> Runs<'a> {
    /// Takes the observables of a plan from the runs of a setting at the used conditions.
    fn new(plan: &ResidualPlan, records: Vec<Option<&'a Record>>) -> Result<Self, Error> {
        let rows = rows_of(plan, &records, At::Used)?;
        Ok(Self { records, rows })
    }

    /// Those of the conditions at which others of the same seeds are other runs, by groups of `r`; without those whose
    /// partners are left out.
    fn differing_from(&self, other: &Self, r: usize) -> Self {
        let groups = self.records.chunks(r).zip(other.records.chunks(r));
        let differs: Vec<bool> = groups.map(|(a, b)| differ(a, b)).collect();
        let kept = |i: &usize| differs[i / r];
        let paired = |i: usize| other.records[i].is_some();
        let all = || (0..self.records.len()).filter(kept);
        Self {
            records: all()
                .map(|i| self.records[i].filter(|_| paired(i)))
                .collect(),
            rows: all()
                .map(|i| self.rows[i].clone().filter(|_| paired(i)))
                .collect(),
        }
    }
}

/// Whether the runs of each condition differ from those at the start; false if nothing is run.
fn moved(plan: &ResidualPlan, start: &Runs<'_>, runs: &Runs<'_>, r: usize) -> Vec<bool> {
    let groups = start.records.chunks(r).zip(runs.records.chunks(r));
    let mut differs = groups.map(|(a, b)| differ(a, b));
    let of = |c: &StudyCondition| c.used && differs.next().unwrap_or(false);
    plan.conditions.iter().map(of).collect()
}
