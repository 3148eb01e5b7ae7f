//! What charts, tables and text of a residual study share.

use calibration::{RealErrors, ResidualStudy, StudyCondition};
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
    /// Before or after an effect was added.
    pub(crate) name: &'static str,
    /// On the conditions that the fit used.
    pub(crate) used: &'a RealErrors,
    /// On those kept for the check; none if there are none.
    pub(crate) kept: Option<&'a RealErrors>,
}

/// Errors before, and after where an effect was added.
pub(crate) fn stages(study: &ResidualStudy) -> Vec<StageErrors<'_>> {
    let before = &study.errors_before;
    let mut stages = vec![StageErrors {
        name: "before",
        used: &before.used,
        kept: before.kept.as_ref(),
    }];
    if let Some(after) = &study.after {
        let errors = &after.errors;
        stages.push(StageErrors {
            name: "after",
            used: &errors.used,
            kept: errors.kept.as_ref(),
        });
    }
    stages
}

#[cfg(test)]
mod tests {
    use super::condition_name;
    use calibration::StudyCondition;
    use std::collections::BTreeMap;

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
