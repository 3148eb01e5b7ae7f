//! The runs of a residual study and their means.

use super::scatter::Scatter;
use super::worker::{Ran, Worker};
use super::{ResidualPlan, StudyCondition};
use crate::Error;
use campaign::RunRequest;
use campaign::run_store::Record;
use std::collections::BTreeMap;

/// A point in parameters and amplitudes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    /// Declared parameters, in the order of the plan.
    pub(super) parameters: Vec<f64>,
    /// Amplitudes of its effects; 0 of one that is off.
    pub(super) effects: Vec<f64>,
}

/// Means of the observables, (conditions, observables).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Means {
    /// Means over the runs; empty rows if none were done.
    pub(super) values: Vec<Vec<f64>>,
    /// Number of runs behind the means of each condition; 0 if none were done.
    pub(super) n: Vec<usize>,
    /// How the runs scatter about these means.
    pub(super) scatter: Scatter,
}

impl Setting {
    /// A point without effects.
    pub(super) fn declared(plan: &ResidualPlan, values: &[f64]) -> Self {
        Self {
            parameters: values.to_vec(),
            effects: vec![0.0; plan.effects.len()],
        }
    }

    /// The same with another amplitude of an effect.
    pub(super) fn with_amplitude(mut self, effect: usize, amplitude: f64) -> Self {
        self.effects[effect] = amplitude;
        self
    }

    pub(super) fn by_name(&self, plan: &ResidualPlan) -> BTreeMap<String, f64> {
        let names = plan.parameters.iter().map(|d| d.symbol.clone());
        names.zip(self.parameters.iter().copied()).collect()
    }

    /// The run of one condition; `block` and `replicate` choose a seed that no other block uses.
    fn request(
        &self,
        plan: &ResidualPlan,
        condition: &StudyCondition,
        block: u64,
        replicate: usize,
    ) -> RunRequest {
        let mut request = plan.base.clone();
        match &condition.model {
            Some(model) => request.model.clone_from(model),
            None => request.condition.extend(condition.condition.clone()),
        }
        let own = plan.parameters.iter().zip(&self.parameters);
        let own = own.filter(|(d, _)| condition.depends_on(&d.symbol));
        let own = own.map(|(d, x)| (d.symbol.clone(), *x));
        request.parameters.extend(own);
        let on = plan.effects.iter().zip(&self.effects);
        let on = on.filter(|(e, amplitude)| **amplitude != 0.0 && e.acts_on(condition));
        request
            .effects
            .extend(on.map(|(e, x)| (e.name.clone(), *x)));
        request.with_seed(plan.base.seed + 1000 * block + replicate as u64)
    }
}

/// Which conditions are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
    /// Those that the fit uses; the rows of the others stay empty.
    Used,
    /// Those kept for the check; the rows of the others stay empty.
    Kept,
}

/// Means at a setting, with the seeds of a block.
///
/// # Errors
///
/// [`Error::Cell`] where failed runs leave a condition without a mean.
pub(super) fn means(
    worker: &Worker<'_>,
    plan: &ResidualPlan,
    setting: &Setting,
    block: u64,
    at: At,
) -> Result<Means, Error> {
    let requests = requests(plan, setting, block, at);
    let results = readable(plan, at, worker.each(&requests)?);
    match worker.borne(&requests, &results, plan.replicates) {
        Ok(records) => means_of(plan, &records, at),
        Err(short) => Err(short.error(plan, &numbers(plan, at))),
    }
}

/// Means at the used conditions for several settings, each with the seeds of its own block, in one list so
/// that no core waits; the reason for a setting that cannot be run.
pub(super) fn means_of_each(
    worker: &Worker<'_>,
    plan: &ResidualPlan,
    settings: &[(Setting, u64)],
) -> Result<Vec<Result<Means, String>>, Error> {
    let lists = settings
        .iter()
        .map(|(setting, block)| requests(plan, setting, *block, At::Used));
    let lists: Vec<_> = lists.collect();
    let results = readable(plan, At::Used, worker.each(&lists.concat())?);
    let mut left = &results[..];
    lists
        .iter()
        .map(|list| {
            let (own, others) = left.split_at(list.len());
            left = others;
            match worker.borne(list, own, plan.replicates) {
                Ok(records) => means_of(plan, &records, At::Used).map(Ok),
                Err(short) => Ok(Err(short.reason)),
            }
        })
        .collect()
}

/// Result of runs of settings at the used or the kept conditions; a run without an observable that is read there has
/// failed: of a bed that shows its surface in one frame alone no fluctuation is known.
pub(super) fn readable(plan: &ResidualPlan, at: At, results: Vec<Ran>) -> Vec<Ran> {
    let conditions = numbers(plan, at);
    let of = |i: usize| &plan.conditions[conditions[i / plan.replicates % conditions.len()]];
    let read = |(i, result): (usize, Ran)| {
        let record = result?;
        match row(plan, of(i), &record) {
            Ok(_) => Ok(record),
            Err(lacking) => Err(lacking.to_string()),
        }
    };
    results.into_iter().enumerate().map(read).collect()
}

/// Numbers of the used or the kept conditions.
pub(super) fn numbers(plan: &ResidualPlan, at: At) -> Vec<usize> {
    let all = plan.conditions.iter().enumerate();
    all.filter(|(_, c)| c.used == (at == At::Used))
        .map(|(number, _)| number)
        .collect()
}

/// Runs of a setting at the used or the kept conditions, with replicates.
pub(super) fn requests(
    plan: &ResidualPlan,
    setting: &Setting,
    block: u64,
    at: At,
) -> Vec<RunRequest> {
    let used = at == At::Used;
    let conditions = plan.conditions.iter().filter(|c| c.used == used);
    conditions
        .flat_map(|c| (0..plan.replicates).map(move |k| setting.request(plan, c, block, k)))
        .collect()
}

/// Means of the runs of a setting; `None` for a run that is left out.
pub(super) fn means_of(
    plan: &ResidualPlan,
    records: &[Option<&Record>],
    at: At,
) -> Result<Means, Error> {
    let rows = rows_of(plan, records, at)?;
    Ok(Means::of(&rows, plan.replicates).spread_over(plan, at == At::Used))
}

/// Observables of a run, in the order of the plan; `None` if the run is left out.
pub(super) type Row = Option<Vec<f64>>;

/// Observables of the runs of a setting at the used or the kept conditions, in the order of the plan.
pub(super) fn rows_of(
    plan: &ResidualPlan,
    records: &[Option<&Record>],
    at: At,
) -> Result<Vec<Row>, Error> {
    let used = at == At::Used;
    let conditions = plan.conditions.iter().filter(|c| c.used == used);
    let each = conditions.flat_map(|c| std::iter::repeat_n(c, plan.replicates));
    each.zip(records)
        .map(|(condition, record)| {
            record
                .map(|record| row(plan, condition, record))
                .transpose()
        })
        .collect()
}

/// Observables of a record, in the order of the plan; not a number where one is not read at the condition.
fn row(
    plan: &ResidualPlan,
    condition: &StudyCondition,
    record: &Record,
) -> Result<Vec<f64>, Error> {
    let each = plan.observables.iter().map(|name| condition.name_of(name));
    each.map(|name| name.map_or(Ok(f64::NAN), |name| value(record, name)))
        .collect()
}

fn value(record: &Record, observable: &str) -> Result<f64, Error> {
    record
        .observable(observable)
        .map(|o| o.mean)
        .ok_or_else(|| Error::NoObservable {
            run: record.key().to_owned(),
            name: observable.to_owned(),
            given: record
                .observables()
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(", "),
        })
}

/// Whether two groups hold different runs.
pub(super) fn differ(a: &[Option<&Record>], b: &[Option<&Record>]) -> bool {
    let mut pairs = a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    pairs.any(|(a, b)| a.key() != b.key())
}

/// Mean of rows; 0 for what was not read, which nobody asks for.
fn mean_row(rows: &[Vec<f64>]) -> Vec<f64> {
    let n = rows.len().max(1) as f64;
    let width = rows.first().map_or(0, Vec::len);
    let mean = |k: usize| rows.iter().map(|r| r[k]).sum::<f64>() / n;
    let each = (0..width).map(mean);
    each.map(|mean| if mean.is_nan() { 0.0 } else { mean })
        .collect()
}

impl Means {
    /// Means and scatter of groups of `r` rows.
    pub(super) fn of(rows: &[Row], r: usize) -> Self {
        let groups = rows.chunks(r);
        let groups: Vec<Vec<_>> = groups
            .map(|group| group.iter().flatten().cloned().collect())
            .collect();
        let values: Vec<Vec<f64>> = groups.iter().map(|group| mean_row(group)).collect();
        Self {
            scatter: Scatter::of(groups.iter().map(Vec::as_slice), &values),
            n: groups.iter().map(Vec::len).collect(),
            values,
        }
    }

    /// The least number of runs behind the means of a condition.
    pub(super) fn least_n(&self) -> usize {
        let done = self.n.iter().filter(|n| **n > 0);
        done.min().copied().unwrap_or(1)
    }

    /// These means of the used conditions, with those of the kept ones put in.
    pub(super) fn with_kept(mut self, kept: Self) -> Self {
        let own = self.values.iter_mut().zip(&mut self.n);
        for ((row, n), (other, more)) in own.zip(kept.values.into_iter().zip(kept.n)) {
            if row.is_empty() {
                (*row, *n) = (other, more);
            }
        }
        self.scatter.add(&kept.scatter);
        self
    }

    /// Means of the used or the kept conditions only, with empty rows put in for the others.
    pub(super) fn spread_over(self, plan: &ResidualPlan, used: bool) -> Self {
        let mut rows = self.values.into_iter().zip(self.n);
        let row = |c: &StudyCondition| {
            if c.used == used { rows.next() } else { None }
        };
        let all = plan.conditions.iter().map(row);
        let (values, n) = all.map(Option::unwrap_or_default).unzip();
        Self {
            values,
            n,
            scatter: self
                .scatter
                .spread_over(plan.conditions.iter().map(|c| c.used == used)),
        }
    }
}
