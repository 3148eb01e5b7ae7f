//! Data as a laboratory would give them, made by the simulator with a truth that the fit is not told of.

use crate::residual_study::value;
use crate::{Error, Observed, ResidualPlan};
use campaign::{Campaign, RunRequest, Simulator};
use probability::random_stream::Stream;
use std::collections::BTreeMap;

/// A truth and how it is measured.
#[derive(Debug)]
pub struct Laboratory<'a> {
    /// True values of the declared parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// Amplitudes of the hidden effects by name.
    pub effects: BTreeMap<String, f64>,
    /// Runs at each condition: 2 or more, their scatter gives the covariance.
    pub runs: usize,
    /// Standard deviation of reading an observable, in its unit.
    pub reading_sd: &'a [f64],
    /// Seed of the first run; the others follow.
    pub first_seed: u64,
    /// Where the noise of reading comes from.
    pub reading: Stream,
}

impl Laboratory<'_> {
    /// The runs of [`Self::measure`].
    pub fn requests(&self, plan: &ResidualPlan) -> Vec<RunRequest> {
        let mut requests = Vec::new();
        for condition in &plan.conditions {
            for _ in 0..self.runs {
                let mut request = plan.base.clone();
                request.condition.clone_from(&condition.condition);
                request.parameters.clone_from(&self.parameters);
                request.effects.clone_from(&self.effects);
                requests.push(request.with_seed(self.first_seed + requests.len() as u64));
            }
        }
        requests
    }

    /// Measures at all conditions of a plan: the mean of the runs plus noise of reading.
    ///
    /// The covariance is that of the runs, pooled over the conditions, over their number, with the
    /// variances of reading on its diagonal; it is the same at all conditions.
    ///
    /// # Errors
    ///
    /// Runs that failed, an observable that they do not give.
    pub fn measure(
        mut self,
        campaign: &Campaign<'_>,
        simulator: &dyn Simulator,
        plan: &ResidualPlan,
    ) -> Result<Observed, Error> {
        let n = self.runs;
        let records = campaign.run_all(simulator, &self.requests(plan))?;
        let row = |record| {
            plan.observables
                .iter()
                .map(|name| value(record, name))
                .collect()
        };
        let rows = records
            .iter()
            .map(row)
            .collect::<Result<Vec<Vec<f64>>, Error>>()?;
        let width = plan.observables.len();
        let mut pooled = vec![vec![0.0; width]; width];
        let mut measured = Vec::new();
        for group in rows.chunks(n) {
            let mean: Vec<f64> = (0..width)
                .map(|k| group.iter().map(|r| r[k]).sum::<f64>() / n as f64)
                .collect();
            for row in group {
                for a in 0..width {
                    for b in 0..width {
                        pooled[a][b] += (row[a] - mean[a]) * (row[b] - mean[b]);
                    }
                }
            }
            let read = |k: usize| Some(mean[k] + self.reading_sd[k] * self.reading.normal());
            measured.push((0..width).map(read).collect());
        }
        let dof = (plan.conditions.len() * (n - 1)) as f64;
        for (a, row) in pooled.iter_mut().enumerate() {
            for value in row.iter_mut() {
                *value = *value / dof / n as f64;
            }
            row[a] += self.reading_sd[a].powi(2);
        }
        Ok(Observed {
            values: measured,
            covariance: vec![pooled; plan.conditions.len()],
        })
    }
}
