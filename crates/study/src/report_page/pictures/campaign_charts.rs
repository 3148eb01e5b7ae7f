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
    use calibration::{EffectProbe, Observed, ResidualPlan, StudyCondition, study_residual};
    use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
    use random_stream::Stream;
    use run_store::{Observation, Store};
    use std::collections::BTreeMap;

    /// An angle that two effects bend over the speed in the same way.
    struct Twins;

    impl Simulator for Twins {
        fn version(&self) -> String {
            "twins".into()
        }

        fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
            let bent = request.effect("bend") + request.effect("bow");
            let mut stream = Stream::new(request.seed, &format!("{request}"));
            let angle = Observation {
                mean: 30.0 + bent * request.condition("rpm")? + 0.1 * stream.normal(),
                sd: None,
                n: 1,
                unit: "deg".into(),
            };
            Ok(RunOutcome::default().with_observable("angle_deg", angle))
        }
    }

    /// Two effects that nothing tells apart are two models: the chart of residuals has a column for each and the
    /// table of means rows for each, beside the declared model, which misses 1 degree per rpm. A mean of four runs
    /// has a standard error of 0.05 deg, and the fit adds as much: four times both together are below 0.3 deg.
    #[test]
    fn tied_models_are_in_the_table_of_means_and_in_the_chart() {
        let speeds = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0];
        let probe = |name: &str| EffectProbe {
            name: name.into(),
            probe: 1.0,
            range: [-5.0, 5.0],
        };
        let condition = |rpm: &f64| StudyCondition {
            condition: BTreeMap::from([("rpm".to_owned(), *rpm)]),
            used: *rpm < 30.0,
        };
        let plan = ResidualPlan {
            id: "twins".into(),
            base: RunRequest::new("twins", 1),
            conditions: speeds.iter().map(condition).collect(),
            observables: vec!["angle_deg".into()],
            declared: Vec::new(),
            effects: vec![probe("bend"), probe("bow")],
            replicates: 4,
            seed: 1,
        };
        // Bent by 1 degree per rpm.
        let observed = Observed {
            values: speeds.iter().map(|rpm| vec![Some(30.0 + rpm)]).collect(),
            covariance: vec![vec![vec![0.01]]; speeds.len()],
        };
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 1, &Silent);
        let study = study_residual(&campaign, &Twins, &plan, &observed).unwrap();
        let diagnosis = &study.diagnosis;
        assert_eq!(study.rivals.len(), 2, "{}", diagnosis.summary());
        let names = ["declared model, fitted", "with bend", "with bow"];
        let drawn = residuals(&study);
        assert_eq!(drawn.models[0], names[0]);
        assert!(names.iter().all(|n| drawn.models.iter().any(|m| m == n)));
        let panel = &drawn.panels[0].residuals;
        for (c, rpm) in speeds.iter().enumerate() {
            assert!((panel[0][c].unwrap() - rpm).abs() < 0.3, "{panel:?}");
            assert!(panel[1][c].unwrap().abs() < 0.3, "{panel:?}");
            assert!(panel[2][c].unwrap().abs() < 0.3, "{panel:?}");
        }
        let table = residual_tables::all("twins", &study)
            .into_iter()
            .find(|table| table.file_name() == "twins_models.csv")
            .unwrap()
            .text();
        for (model, bent) in [("before", 0.0), ("with bend", 1.0), ("with bow", 1.0)] {
            let rows: Vec<_> = table.lines().filter(|l| l.starts_with(model)).collect();
            assert_eq!(rows.len(), speeds.len(), "{table}");
            for (row, rpm) in rows.iter().zip(speeds) {
                let mean: f64 = row.rsplit(',').next().unwrap().parse().unwrap();
                assert!((mean - 30.0 - bent * rpm).abs() < 0.3, "{table}");
            }
        }
    }
}
