//! The campaign on measured-like data, with and without a hidden effect.

use crate::loop_stages::Loop;
use crate::{Error, HiddenCampaign};
use calibration::{
    DeclaredParameter, EffectProbe, Laboratory, ResidualPlan, StudyCondition, study_residual,
};
use campaign::RunRequest;
use effect_library::find;
use random_stream::Stream;
use residual_diagnosis::Verdict;
use std::collections::BTreeMap;

/// Offset of the seeds that make the data from those of the fit.
const DATA_SEEDS: u64 = 5_000_000;

/// Probes of the effects that a study names.
///
/// # Errors
///
/// A name that is not in the library.
pub fn probes(names: &[String]) -> Result<Vec<EffectProbe>, Error> {
    names
        .iter()
        .map(|name| {
            let d = find(name)?.description();
            Ok(EffectProbe {
                name: name.clone(),
                probe: d.probe,
                range: d.range,
            })
        })
        .collect()
}

impl Loop<'_> {
    /// Runs the campaign; the fit never sees how the data were made.
    pub(crate) fn hidden_campaign(&self, with_effect: bool) -> Result<HiddenCampaign, Error> {
        let settings = &self.study.hidden;
        let (plan, laboratory) = self.hidden_plan(with_effect)?;
        let true_parameters = laboratory.parameters.clone();
        let observed = laboratory.measure(&self.campaign, self.simulator, &plan)?;
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
            true_parameters,
            study,
            verdict_is_right,
        })
    }

    /// The runs that stand for the measurements of both campaigns; they depend on no other result.
    pub(crate) fn hidden_measurements(&self) -> Result<Vec<RunRequest>, Error> {
        let mut requests = Vec::new();
        for with_effect in [true, false] {
            let (plan, laboratory) = self.hidden_plan(with_effect)?;
            requests.extend(laboratory.requests(&plan));
        }
        Ok(requests)
    }

    /// What the fit is asked, and the truth that it is not told of.
    fn hidden_plan(&self, with_effect: bool) -> Result<(ResidualPlan, Laboratory<'_>), Error> {
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
        let (effects, first_seed, purpose) = if with_effect {
            let hidden = (settings.effect.clone(), settings.amplitude);
            (
                BTreeMap::from([hidden]),
                DATA_SEEDS,
                "reading noise, effect",
            )
        } else {
            (BTreeMap::new(), DATA_SEEDS + 100_000, "reading noise, none")
        };
        let laboratory = Laboratory {
            parameters: truth,
            effects,
            runs: settings.measured_runs,
            reading_sd: &settings.reading_sd,
            first_seed: self.settings.seed + first_seed,
            reading: Stream::new(self.settings.seed, purpose),
        };
        Ok((plan, laboratory))
    }
}
