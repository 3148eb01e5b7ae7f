//! What charts, tables and text of a residual study share.

use super::numbers::digits;
use calibration::{AddedEffect, ErrorPair, RealErrors, ResidualStudy, StudyCondition};
use report::Role;

/// A condition in words, short.
pub(crate) fn condition_name(condition: &StudyCondition) -> String {
    let part = |(name, value): (&String, &f64)| match name.as_str() {
        "rpm" => format!("{value} rpm"),
        "seed_count" => format!("{value} seeds"),
        _ => format!("{name} {value}"),
    };
    if condition.condition.is_empty() {
        return "as measured".into();
    }
    condition
        .condition
        .iter()
        .map(part)
        .collect::<Vec<_>>()
        .join(", ")
}

/// What a condition was used for.
pub(crate) fn role(condition: &StudyCondition) -> Role {
    if condition.used {
        Role::Fit
    } else {
        Role::Check
    }
}

/// Standard error of observed minus simulated, unit of the observable: that of the observation,
/// and that of the mean of the simulated runs.
pub(crate) fn residual_se(study: &ResidualStudy, c: usize, k: usize) -> f64 {
    let runs = study.plan.replicates.max(1) as f64;
    let run_sd = study
        .run_sd
        .get(&study.plan.observables[k])
        .copied()
        .unwrap_or(0.0);
    (study.observed.covariance[c][k][k] + run_sd * run_sd / runs).sqrt()
}

/// Errors of real runs with one model.
#[derive(Debug)]
pub(crate) struct StageErrors<'a> {
    /// Before or after an effect was added, or with which of the tied ones.
    pub(crate) name: String,
    /// On the conditions that the fit used.
    pub(crate) used: &'a RealErrors,
    /// On those kept for the check; none if there are none.
    pub(crate) kept: Option<&'a RealErrors>,
}

/// Errors before, and after where an effect was added; with each tied effect where they tie.
pub(crate) fn stages(study: &ResidualStudy) -> Vec<StageErrors<'_>> {
    fn stage(name: String, errors: &ErrorPair) -> StageErrors<'_> {
        StageErrors {
            name,
            used: &errors.used,
            kept: errors.kept.as_ref(),
        }
    }
    let before = stage("before".into(), &study.errors_before);
    let models = models(study).into_iter();
    let others = models.map(|(name, model)| stage(name, &model.errors));
    std::iter::once(before).chain(others).collect()
}

/// The models with effects added, and what to call them.
pub(crate) fn models(study: &ResidualStudy) -> Vec<(String, &AddedEffect)> {
    let after = study.after.iter().map(|a| ("after".to_owned(), a));
    let rivals = study
        .rivals
        .iter()
        .map(|a| (format!("with {}", amplitudes(a)), a));
    after.chain(rivals).collect()
}

/// The effects of a model with their amplitudes.
fn amplitudes(added: &AddedEffect) -> String {
    let one = |(name, amplitude): (&String, &f64)| format!("{name} {}", digits(*amplitude));
    let all: Vec<String> = added.effects.iter().map(one).collect();
    all.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::condition_name;
    use crate::report_page::pictures::campaign_charts::charts;
    use crate::report_page::pictures::chart;
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

    /// Two effects that nothing tells apart are two models: the table of means has the rows of both beside
    /// those of the declared model, and the chart a column for each.
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
        let table = residual_tables::all("twins", &study)
            .into_iter()
            .find(|table| table.file_name() == "twins_models.csv")
            .unwrap()
            .text();
        assert_eq!(table.lines().count(), 1 + 3 * speeds.len(), "{table}");
        let pictures = charts("twins", &study).unwrap();
        let svg = chart(&pictures, "twins-residuals").unwrap().to_string();
        for title in ["declared model, fitted", "with bend", "with bow"] {
            assert!(svg.contains(title), "{title}");
        }
    }

    #[test]
    fn conditions_are_named_with_their_units() {
        let condition = |pairs: &[(&str, f64)]| StudyCondition {
            condition: pairs
                .iter()
                .map(|(n, v)| ((*n).to_owned(), *v))
                .collect::<BTreeMap<_, _>>(),
            used: true,
        };
        let name = condition_name(&condition(&[("rpm", 5.0), ("seed_count", 418.0)]));
        assert_eq!(name, "5 rpm, 418 seeds");
        assert_eq!(condition_name(&condition(&[])), "as measured");
    }
}
