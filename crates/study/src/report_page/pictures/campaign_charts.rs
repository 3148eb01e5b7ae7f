//! Charts of a campaign over several conditions.

use super::NamedPicture;
use crate::Error;
use crate::report_page::campaign::{condition_name, residual_se, role};
use crate::report_page::numbers::observable;
use calibration::{AddedEffect, ResidualStudy, StudyCondition};
use report::{
    AxisTitle, Comparison, PredictedAgainstMeasured, ResidualCondition, ResidualPanel, Residuals,
};

/// Predicted against measured for each observable, before and after, and the residuals.
pub(crate) fn charts(name: &str, study: &ResidualStudy) -> Result<Vec<NamedPicture>, Error> {
    let mut charts = Vec::new();
    let after = study.after.as_ref().map(|a| &a.simulated);
    for (k, quantity) in study.plan.observables.iter().enumerate() {
        let stages = [("before", Some(&study.simulated_before)), ("after", after)];
        for (stage, simulated) in stages {
            if let Some(simulated) = simulated {
                let (words, unit) = observable(quantity);
                let chart = PredictedAgainstMeasured {
                    observable: AxisTitle::new(words, unit),
                    comparisons: comparisons(study, simulated, k),
                };
                let name = format!("{name}-predicted-{}-{stage}", super::plain_name(quantity));
                charts.push(NamedPicture::chart(name, chart.draw()?));
            }
        }
    }
    let residuals = residuals(study).draw()?;
    charts.push(NamedPicture::chart(format!("{name}-residuals"), residuals));
    Ok(charts)
}

/// The points of one observable with twice their standard errors.
fn comparisons(study: &ResidualStudy, simulated: &[Vec<f64>], k: usize) -> Vec<Comparison> {
    let runs = study.plan.replicates.max(1) as f64;
    let run_sd = study
        .run_sd
        .get(&study.plan.observables[k])
        .copied()
        .unwrap_or(0.0);
    let conditions = study.plan.conditions.iter().enumerate();
    let comparison = |(c, condition): (usize, &StudyCondition)| {
        Some(Comparison {
            name: condition_name(condition),
            measured: study.observed.values[c][k]?,
            measured_error: 2.0 * study.observed.standard_error(c, k),
            predicted: simulated[c][k],
            predicted_error: 2.0 * run_sd / runs.sqrt(),
            role: role(condition),
        })
    };
    conditions.filter_map(comparison).collect()
}

/// Residuals by condition before and with what was added, against twice their standard error.
fn residuals(study: &ResidualStudy) -> Residuals {
    let conditions = study.plan.conditions.iter();
    let left = |simulated: &[Vec<f64>], k: usize| -> Vec<Option<f64>> {
        let rows = study.observed.values.iter().zip(simulated);
        rows.map(|(o, s)| o[k].map(|y| y - s[k])).collect()
    };
    let added = || study.after.iter().chain(&study.rivals);
    let simulated: Vec<_> = std::iter::once(&study.simulated_before)
        .chain(added().map(|model| &model.simulated))
        .collect();
    let n = study.plan.conditions.len();
    let panels = study
        .plan
        .observables
        .iter()
        .enumerate()
        .map(|(k, quantity)| {
            let (words, unit) = observable(quantity);
            let residuals = simulated.iter().map(|simulated| left(simulated, k));
            ResidualPanel {
                observable: AxisTitle::new(words, unit),
                residuals: residuals.collect(),
                noise: (0..n).map(|c| 2.0 * residual_se(study, c, k)).collect(),
            }
        });
    let names = |model: &AddedEffect| {
        let names: Vec<&str> = model.effects.keys().map(String::as_str).collect();
        format!("with {}", names.join(", "))
    };
    let titles = std::iter::once("declared model, fitted".into()).chain(added().map(names));
    Residuals {
        models: titles.collect(),
        noise_name: "± 2 standard errors".into(),
        panels: panels.collect(),
        conditions: conditions
            .map(|c| ResidualCondition {
                name: condition_name(c),
                role: role(c),
            })
            .collect(),
    }
}
