//! The runs of a residual study and their means.

use super::{ResidualPlan, StudyCondition};
use crate::Error;
use crate::cells::value;
use campaign::{Campaign, RunRequest, Simulator};
use std::collections::BTreeMap;

/// A point in parameters and amplitudes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    /// Declared parameters by name.
    pub(super) parameters: BTreeMap<String, f64>,
    /// Amplitudes by effect.
    pub(super) effects: BTreeMap<String, f64>,
}

/// Means of the observables, (conditions, observables).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Means {
    /// Means over the runs.
    pub(super) values: Vec<Vec<f64>>,
    /// Number of runs in each mean.
    pub(super) n: usize,
    /// How the runs scatter about these means.
    pub(super) scatter: Scatter,
}

/// Scatter of runs about the means of their conditions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scatter {
    /// Sums of products of the deviations, (observables, observables).
    products: Vec<Vec<f64>>,
    /// Degrees of freedom.
    pub(super) dof: usize,
}

/// The simulator near the starting point.
#[derive(Debug, Clone)]
pub(super) struct Linearisation {
    /// Means at the start; as in the tables below, the rows of conditions that are kept apart are
    /// empty.
    pub(super) nominal: Means,
    /// d observable / d parameter, (conditions, observables, parameters).
    pub(super) declared: Vec<Vec<Vec<f64>>>,
    /// d observable / d amplitude, (conditions, observables, effects).
    pub(super) library: Vec<Vec<Vec<f64>>>,
    /// Covariance of one run, pooled over conditions and settings, (observables, observables).
    pub(super) run_covariance: Vec<Vec<f64>>,
    /// Its degrees of freedom.
    pub(super) noise_dof: usize,
    /// Scatter of all runs so far.
    scatter: Scatter,
}

impl Setting {
    /// The declared parameters in the order of the plan, no effect.
    pub(super) fn declared(plan: &ResidualPlan, values: &[f64]) -> Self {
        let names = plan.declared.iter().map(|d| d.name.clone());
        Self {
            parameters: names.zip(values.iter().copied()).collect(),
            effects: BTreeMap::new(),
        }
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
        request.condition.extend(condition.condition.clone());
        request.parameters.extend(self.parameters.clone());
        request.effects.extend(self.effects.clone());
        request.with_seed(plan.base.seed + 1000 * block + replicate as u64)
    }
}

/// Means at a setting, with the seeds of a block.
pub(super) fn means(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    plan: &ResidualPlan,
    setting: &Setting,
    block: u64,
) -> Result<Means, Error> {
    let mut requests = Vec::new();
    for condition in &plan.conditions {
        for replicate in 0..plan.replicates {
            requests.push(setting.request(plan, condition, block, replicate));
        }
    }
    let records = campaign.run_all(simulator, &requests)?;
    let rows = records
        .iter()
        .map(|r| row(plan, r))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(Means::of(&rows, plan.replicates))
}

/// Observables of a record, in the order of the plan.
fn row(plan: &ResidualPlan, record: &run_store::Record) -> Result<Vec<f64>, Error> {
    plan.observables
        .iter()
        .map(|name| value(record, name))
        .collect()
}

/// Mean of rows.
fn mean_row(rows: &[Vec<f64>]) -> Vec<f64> {
    let n = rows.len().max(1) as f64;
    let width = rows.first().map_or(0, Vec::len);
    (0..width)
        .map(|k| rows.iter().map(|r| r[k]).sum::<f64>() / n)
        .collect()
}

impl Linearisation {
    /// Runs the start and, for each parameter and each effect, a point beside it, with replicates at
    /// every condition that the fit uses, all in one list so that no core waits.
    ///
    /// Differences are taken against the mean of the replicates: with contacts that come and go,
    /// two runs of one seed part ways within a second, so that a common seed saves no noise.
    pub(super) fn run(
        campaign: &Campaign<'_>,
        simulator: &dyn Simulator,
        plan: &ResidualPlan,
    ) -> Result<Self, Error> {
        let start: Vec<f64> = plan.declared.iter().map(|d| d.start).collect();
        let at_start = Setting::declared(plan, &start);
        let mut settings = Vec::new();
        for declared in &plan.declared {
            let mut moved = at_start.clone();
            moved
                .parameters
                .insert(declared.name.clone(), declared.start + declared.step);
            settings.push((moved, declared.step));
        }
        for effect in &plan.effects {
            let mut on = at_start.clone();
            on.effects.insert(effect.name.clone(), effect.probe);
            settings.push((on, effect.probe));
        }
        let (n, r) = (plan.conditions.len(), plan.replicates);
        let used = || plan.conditions.iter().filter(|c| c.used);
        let points = std::iter::once(&at_start).chain(settings.iter().map(|(point, _)| point));
        let requests: Vec<RunRequest> = points
            .flat_map(|point| used().map(move |condition| (point, condition)))
            .flat_map(|(point, c)| (0..r).map(move |k| point.request(plan, c, 0, k)))
            .collect();
        let records = campaign.run_all(simulator, &requests)?;
        let rows = records
            .iter()
            .map(|r| row(plan, r))
            .collect::<Result<Vec<_>, _>>()?;
        let mut points = rows
            .chunks(used().count() * r)
            .map(|rows| Means::of(rows, r).spread_over(plan));
        let nominal = points.next().unwrap_or_else(|| Means::of(&[], r));
        let probes: Vec<Means> = points.collect();
        let mut scatter = nominal.scatter.clone();
        for probe in &probes {
            scatter.add(&probe.scatter);
        }
        let columns = |first: usize, count: usize| -> Vec<Vec<Vec<f64>>> {
            let slope = |j: usize, c: usize, k: usize| {
                (probes[first + j].values[c][k] - nominal.values[c][k]) / settings[first + j].1
            };
            let of = |c: usize, k: usize| (0..count).map(|j| slope(j, c, k)).collect();
            (0..n)
                .map(|c| (0..nominal.values[c].len()).map(|k| of(c, k)).collect())
                .collect()
        };
        Ok(Self {
            declared: columns(0, plan.declared.len()),
            library: columns(plan.declared.len(), plan.effects.len()),
            run_covariance: scatter.covariance(),
            noise_dof: scatter.dof,
            nominal,
            scatter,
        })
    }

    /// The same with the scatter of further means in the covariance: the noise of a run is taken
    /// to be the same at all settings, and more degrees of freedom make sharper tests.
    pub(super) fn with_scatter(mut self, means: &Means) -> Self {
        self.scatter.add(&means.scatter);
        self.run_covariance = self.scatter.covariance();
        self.noise_dof = self.scatter.dof;
        self
    }
}

impl Scatter {
    /// Takes in the scatter of other runs.
    fn add(&mut self, other: &Self) {
        for (line, more) in self.products.iter_mut().zip(&other.products) {
            for (sum, product) in line.iter_mut().zip(more) {
                *sum += product;
            }
        }
        self.dof += other.dof;
    }

    /// Covariance of one run.
    fn covariance(&self) -> Vec<Vec<f64>> {
        let dof = self.dof.max(1) as f64;
        self.products
            .iter()
            .map(|line| line.iter().map(|x| x / dof).collect())
            .collect()
    }
}

impl Means {
    /// Means and scatter of groups of `r` rows.
    fn of(rows: &[Vec<f64>], r: usize) -> Self {
        let values: Vec<Vec<f64>> = rows.chunks(r).map(mean_row).collect();
        let width = values.first().map_or(0, Vec::len);
        let mut products = vec![vec![0.0; width]; width];
        for (group, mean) in rows.chunks(r).zip(&values) {
            for row in group {
                for a in 0..width {
                    for b in 0..width {
                        products[a][b] += (row[a] - mean[a]) * (row[b] - mean[b]);
                    }
                }
            }
        }
        let dof = values.len() * (r - 1);
        Self {
            values,
            n: r,
            scatter: Scatter { products, dof },
        }
    }

    /// Means of the used conditions only, with empty rows put in for the others.
    fn spread_over(self, plan: &ResidualPlan) -> Self {
        let mut rows = self.values.into_iter();
        let row = |c: &StudyCondition| if c.used { rows.next() } else { None };
        Self {
            values: plan
                .conditions
                .iter()
                .map(row)
                .map(Option::unwrap_or_default)
                .collect(),
            ..self
        }
    }
}
