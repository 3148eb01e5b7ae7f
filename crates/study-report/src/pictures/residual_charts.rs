//! Charts of the study of a residual.

use super::NamedPicture;
use crate::Error;
use crate::numbers::observable;
use crate::residual::{condition_name, residual_se, role};
use inference::diagnosis::Evidence;
use inference::{AddedEffect, ResidualStudy, StudyCondition};
use report::{
    AxisTitle, Comparison, Level, PredictedAgainstMeasured, ResidualCondition, ResidualPanel,
    Residuals, StackedBar, StackedBars,
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
    if let Some(evidence) = evidence(study) {
        let drawn = evidence.draw()?;
        charts.push(NamedPicture::chart(format!("{name}-evidence"), drawn));
    }
    Ok(charts)
}

/// Most effects in the chart of evidence, the best first.
const MOST_EFFECTS: usize = 10;

/// What each effect takes off the structured residual, by observable; none without candidates.
fn evidence(study: &ResidualStudy) -> Option<StackedBars> {
    let d = &study.diagnosis;
    let mut effects: Vec<_> = d.candidates.iter().collect();
    effects.sort_by(|a, b| a.1.t_after.total_cmp(&b.1.t_after));
    effects.truncate(MOST_EFFECTS);
    let parts = d.evidence.values().next()?;
    let name = |e: &Evidence| match &e.observable {
        Some(name) => observable(name).0,
        None => "priors of the parameters".to_owned(),
    };
    let bar = |name: &String| {
        let evidence = d.evidence.get(name)?;
        Some(StackedBar {
            name: name.clone(),
            sizes: evidence.iter().map(|e| e.drop).collect(),
        })
    };
    let all = d
        .structured_residual
        .t0
        .map(|t0| t0 - d.structured_residual.df as f64);
    Some(StackedBars {
        size: AxisTitle::new("taken off the sum of squares of the residual", ""),
        parts: parts.iter().map(name).collect(),
        bars: effects.iter().filter_map(|(name, _)| bar(name)).collect(),
        limits: all
            .filter(|all| *all > 0.0)
            .map(|all| Level::new("all but noise", all))
            .into_iter()
            .collect(),
    })
    .filter(|chart| !chart.bars.is_empty())
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
            measured: study.plan.conditions[c].values[k]?,
            measured_error: 2.0 * study.plan.standard_error(c, k),
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
        let rows = study.plan.conditions.iter().zip(simulated);
        rows.map(|(c, s)| c.values[k].map(|y| y - s[k])).collect()
    };
    let simulated: Vec<_> = std::iter::once(&study.simulated_before)
        .chain(study.models().map(|model| &model.simulated))
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
    let titles = std::iter::once("declared model, fitted".into()).chain(study.models().map(names));
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

#[cfg(test)]
mod tests {
    use super::residuals;
    use crate::tables::residual_tables;
    use crate::test_residual::{SPEEDS, twins};

    /// Two effects that nothing tells apart are two models: the chart of residuals has a column for each and the
    /// table of means rows for each, beside the declared model, which misses 1 degree per rpm. A mean of four runs
    /// has a standard error of 0.05 deg, and the fit adds as much: four times both together are below 0.3 deg.
    #[test]
    fn tied_models_are_in_the_table_of_means_and_in_the_chart() {
        let study = twins();
        let diagnosis = &study.diagnosis;
        assert_eq!(study.rivals.len(), 2, "{}", diagnosis.summary());
        let names = ["declared model, fitted", "with bend", "with bow"];
        let drawn = residuals(&study);
        assert_eq!(drawn.models[0], names[0]);
        assert!(names.iter().all(|n| drawn.models.iter().any(|m| m == n)));
        let panel = &drawn.panels[0].residuals;
        for (c, rpm) in SPEEDS.iter().enumerate() {
            assert!((panel[0][c].unwrap() - rpm).abs() < 0.3, "{panel:?}");
            assert!(panel[1][c].unwrap().abs() < 0.3, "{panel:?}");
            assert!(panel[2][c].unwrap().abs() < 0.3, "{panel:?}");
        }
        let table = residual_tables::all("twins", &study, &[])
            .into_iter()
            .find(|table| table.file_name() == "twins_models.csv")
            .unwrap()
            .text();
        for (model, bent) in [("before", 0.0), ("with bend", 1.0), ("with bow", 1.0)] {
            let rows: Vec<_> = table.lines().filter(|l| l.starts_with(model)).collect();
            assert_eq!(rows.len(), SPEEDS.len(), "{table}");
            for (row, rpm) in rows.iter().zip(SPEEDS) {
                let mean: f64 = row.rsplit(',').next().unwrap().parse().unwrap();
                assert!((mean - 30.0 - bent * rpm).abs() < 0.3, "{table}");
            }
        }
    }
}
