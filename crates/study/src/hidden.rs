//! The campaign on measured-like data, with and without a hidden effect.

use crate::file::HiddenSettings;
use crate::loop_stages::Loop;
use crate::{Error, HiddenCampaign};
use calibration::{
    DeclaredParameter, EffectProbe, Observed, ResidualPlan, StudyCondition, study_residual,
};
use campaign::RunRequest;
use effect_library::find;
use random_stream::Stream;
use residual_diagnosis::{Sign, Verdict};
use std::collections::BTreeMap;

/// Offset of the seeds that make the data from those of the fit.
const DATA_SEEDS: u64 = 5_000_000;

/// Probes of the effects that a study names.
pub(crate) fn probes(names: &[String]) -> Result<Vec<EffectProbe>, Error> {
    names
        .iter()
        .map(|name| {
            let d = find(name)?.description();
            let sign = if d.range[0] < 0.0 {
                Sign::Any
            } else {
                Sign::Positive
            };
            let largest = d.range[1].max(-d.range[0]);
            Ok(EffectProbe {
                name: name.clone(),
                probe: d.probe,
                largest,
                sign,
            })
        })
        .collect()
}

impl Loop<'_> {
    /// Runs the campaign; the fit never sees how the data were made.
    pub(crate) fn hidden_campaign(&self, with_effect: bool) -> Result<HiddenCampaign, Error> {
        let settings = &self.study.hidden;
        let full = self
            .profile
            .hidden_full_seed_count
            .unwrap_or(settings.full_seed_count);
        let (mut names, mut priors) = (Vec::new(), Vec::new());
        for (symbol, prior) in settings.factors.iter().zip(&settings.bench_prior) {
            let factor = self.study.factor(symbol)?;
            names.push(factor.parameter.clone());
            priors.push(prior.then_some([factor.measured.mean, factor.measured.sd]));
        }
        let declared = names.iter().enumerate().map(|(k, name)| DeclaredParameter {
            name: name.clone(),
            start: settings.starts[k],
            step: settings.steps[k],
            bounds: settings.bounds[k],
            prior: priors[k],
        });
        let conditions = settings.conditions.iter().map(|c| StudyCondition {
            condition: BTreeMap::from([
                ("rpm".to_owned(), c.rpm),
                ("seed_count".to_owned(), (c.fill * full as f64).round()),
            ]),
            used: c.used,
        });
        let plan = ResidualPlan {
            id: if with_effect {
                "hidden effect"
            } else {
                "nothing hidden"
            }
            .into(),
            base: RunRequest::new("hidden", self.settings.seed + 3_000_000),
            conditions: conditions.collect(),
            observables: settings.observables.clone(),
            declared: declared.collect(),
            effects: probes(&settings.effects)?,
            replicates: self.profile.residual_replicates,
            seed: self.settings.seed,
        };
        let truth: BTreeMap<String, f64> = names
            .into_iter()
            .zip(settings.true_values.iter().copied())
            .collect();
        let observed = self.measured_like(&plan, &truth, with_effect, settings)?;
        let study = study_residual(&self.campaign, self.simulator, &plan, &observed)?;
        let d = &study.diagnosis;
        let verdict_is_right = if with_effect {
            d.verdict == Verdict::Named && d.effects == [settings.effect.clone()]
        } else {
            d.verdict == Verdict::None
        };
        Ok(HiddenCampaign {
            hidden_effect: with_effect.then(|| settings.effect.clone()),
            hidden_amplitude: if with_effect { settings.amplitude } else { 0.0 },
            true_parameters: truth,
            study,
            verdict_is_right,
        })
    }

    /// Data as a laboratory would give them: the mean of a few runs, plus noise of reading.
    fn measured_like(
        &self,
        plan: &ResidualPlan,
        truth: &BTreeMap<String, f64>,
        with_effect: bool,
        settings: &HiddenSettings,
    ) -> Result<Observed, Error> {
        let n = settings.measured_runs;
        let mut requests = Vec::new();
        for (c, condition) in plan.conditions.iter().enumerate() {
            for r in 0..n {
                let mut request = plan.base.clone();
                request.condition.clone_from(&condition.condition);
                request.parameters.clone_from(truth);
                if with_effect {
                    request = request.with_effect(&settings.effect, settings.amplitude);
                }
                let number =
                    DATA_SEEDS + (c * n + r) as u64 + if with_effect { 0 } else { 100_000 };
                requests.push(request.with_seed(self.settings.seed + number));
            }
        }
        let records = self.campaign.run_all(self.simulator, &requests)?;
        let width = settings.observables.len();
        let mut rows = Vec::new();
        for record in &records {
            rows.push(self.values(record, &settings.observables)?);
        }
        let purpose = if with_effect {
            "reading noise, effect"
        } else {
            "reading noise, none"
        };
        let mut noise = Stream::new(self.settings.seed, purpose);
        let mut pooled = vec![vec![0.0; width]; width];
        let mut values = Vec::new();
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
            values.push(
                (0..width)
                    .map(|k| Some(mean[k] + settings.reading_sd[k] * noise.normal()))
                    .collect(),
            );
        }
        let dof = (plan.conditions.len() * (n - 1)) as f64;
        let covariance: Vec<Vec<f64>> = (0..width)
            .map(|a| {
                let reading = |b: usize| {
                    if a == b {
                        settings.reading_sd[a].powi(2)
                    } else {
                        0.0
                    }
                };
                (0..width)
                    .map(|b| pooled[a][b] / dof / n as f64 + reading(b))
                    .collect()
            })
            .collect();
        Ok(Observed {
            values,
            covariance: vec![covariance; plan.conditions.len()],
        })
    }
}
