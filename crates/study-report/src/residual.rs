//! What charts, tables and text of a residual study share.

use super::numbers::digits;
use inference::{AddedEffect, ErrorPair, RealErrors, ResidualStudy, StudyCondition};

/// A condition in words, short.
pub(crate) fn condition_name(condition: &StudyCondition) -> String {
    let part = |(name, value): (&String, &f64)| match name.as_str() {
        "rpm" => format!("{value} rpm"),
        "seed_count" => format!("{value} seeds"),
        _ => format!("{name} {value}"),
    };
    if condition.condition.is_empty() {
        let scene = condition.model.clone();
        return scene.unwrap_or_else(|| "as measured".into());
    }
    condition
        .condition
        .iter()
        .map(part)
        .collect::<Vec<_>>()
        .join(", ")
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
    (study.plan.conditions[c].covariance[k][k] + run_sd * run_sd / runs).sqrt()
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
    use inference::StudyCondition;
    use std::collections::BTreeMap;

    #[test]
    fn conditions_are_named_with_their_units() {
        let condition = |model: Option<&str>, pairs: &[(&str, f64)]| StudyCondition {
            model: model.map(str::to_owned),
            condition: pairs
                .iter()
                .map(|(n, v)| ((*n).to_owned(), *v))
                .collect::<BTreeMap<_, _>>(),
            ..StudyCondition::default()
        };
        let name = condition_name(&condition(None, &[("rpm", 5.0), ("seed_count", 418.0)]));
        assert_eq!(name, "5 rpm, 418 seeds");
        assert_eq!(condition_name(&condition(None, &[])), "as measured");
        assert_eq!(condition_name(&condition(Some("heap"), &[])), "heap");
    }
}
