//! Tables of a residual study.

use super::csv::{CsvTable, Field};
use super::with_unit;
use crate::residual::{models, residual_se, stages};
use inference::{Parameter, ResidualStudy};

/// The unit that the name of a condition's coordinate goes without.
fn coordinate(name: &str) -> String {
    if name == "rpm" {
        "speed_rpm".into()
    } else {
        name.to_owned()
    }
}

/// All tables of a study; `units` are the parameters that it may speak of.
pub(crate) fn all(name: &str, study: &ResidualStudy, units: &[Parameter]) -> Vec<CsvTable> {
    vec![
        conditions(name, study),
        models_of(name, study),
        parameters(name, study, units),
        candidates(name, study),
        errors(name, study),
    ]
}

/// Observed and simulated values by condition, before and after.
fn conditions(name: &str, study: &ResidualStudy) -> CsvTable {
    let names: Vec<&String> = study
        .plan
        .conditions
        .first()
        .map(|c| c.condition.keys().collect())
        .unwrap_or_default();
    let mut columns = vec!["condition".to_owned()];
    columns.extend(names.iter().map(|n| coordinate(n)));
    columns.push("role".into());
    for quantity in &study.plan.observables {
        let q = with_unit(quantity);
        for part in [
            "observed",
            "observed_se",
            "simulated_before",
            "simulated_after",
            "residual_se",
        ] {
            columns.push(format!("{part}_{q}"));
        }
    }
    let mut table = CsvTable::new(format!("{name}_conditions"), columns);
    for (c, condition) in study.plan.conditions.iter().enumerate() {
        let mut row = vec![Field::from(c + 1)];
        row.extend(
            names
                .iter()
                .map(|n| Field::from(condition.condition.get(*n).copied())),
        );
        row.push(if condition.used { "fit" } else { "check" }.into());
        for k in 0..study.plan.observables.len() {
            row.push(study.plan.conditions[c].values[k].into());
            let measured = study.plan.conditions[c].values[k].is_some();
            let se = study.plan.standard_error(c, k);
            row.push(measured.then_some(se).into());
            row.push(study.simulated_before[c][k].into());
            row.push(study.after.as_ref().map(|a| a.simulated[c][k]).into());
            row.push(measured.then(|| residual_se(study, c, k)).into());
        }
        table.row(row);
    }
    table
}

/// Means of real runs by condition with each model: before, and with each effect or tied effect that was added.
fn models_of(name: &str, study: &ResidualStudy) -> CsvTable {
    let mut columns = vec!["model".to_owned(), "condition".to_owned()];
    let quantities = study.plan.observables.iter();
    columns.extend(quantities.map(|q| format!("simulated_{}", with_unit(q))));
    let mut table = CsvTable::new(format!("{name}_models"), columns);
    let before = ("before".to_owned(), &study.simulated_before);
    let added = models(study).into_iter();
    let added = added.map(|(model, added)| (model, &added.simulated));
    for (model, simulated) in std::iter::once(before).chain(added) {
        for (c, means) in simulated.iter().enumerate() {
            let mut row = vec![Field::from(&model), (c + 1).into()];
            row.extend(means.iter().map(|&mean| Field::from(mean)));
            table.row(row);
        }
    }
    table
}

/// Declared parameters, each in its unit: start, prior, fitted without and with the effects.
fn parameters(name: &str, study: &ResidualStudy, units: &[Parameter]) -> CsvTable {
    let columns = [
        "parameter",
        "unit",
        "start",
        "prior_mean",
        "prior_se",
        "low_bound",
        "high_bound",
        "fitted_before",
        "fitted_after",
        "retuning_by_diagnosis",
    ];
    let mut table = CsvTable::new(format!("{name}_parameters"), columns);
    for d in &study.plan.parameters {
        let after = study.after.as_ref();
        let after = after.and_then(|a| a.fitted.get(&d.symbol).copied());
        let unit = units.iter().find(|p| p.symbol == d.symbol);
        table.row([
            (&d.symbol).into(),
            unit.map_or(Field::Empty, |p| (&p.unit).into()),
            d.start.into(),
            d.prior.map(|p| p.mean).into(),
            d.prior.map(|p| p.sd).into(),
            d.limits[0].into(),
            d.limits[1].into(),
            study.fitted.get(&d.symbol).copied().into(),
            after.into(),
            study.diagnosis.retuning.get(&d.symbol).copied().into(),
        ]);
    }
    table
}

/// What each effect of the library would do.
fn candidates(name: &str, study: &ResidualStudy) -> CsvTable {
    let mut table = CsvTable::new(
        format!("{name}_candidates"),
        [
            "effect",
            "named",
            "z_1",
            "amplitude_1",
            "amplitude_se_1",
            "absorbed_fraction_1",
            "t_after_1",
            "p_adequacy_1",
            "p_adequacy_smooth_1",
            "p_max_test_1",
            "ln_bf_unknown_1",
            "smallest_detectable_1",
            "testable",
            "amplitude_after_real_runs_1",
        ],
    );
    for (effect, c) in &study.diagnosis.candidates {
        let after = study.models().find_map(|a| a.effects.get(effect)).copied();
        table.row([
            effect.into(),
            study.diagnosis.effects.contains(effect).into(),
            c.z.into(),
            c.amplitude.into(),
            c.se.into(),
            c.absorbed_fraction.into(),
            c.t_after.into(),
            c.p_adequacy.into(),
            c.p_adequacy_smooth.into(),
            c.p_max_test.into(),
            c.ln_bf_unknown.into(),
            c.smallest_detectable.into(),
            c.testable.into(),
            after.into(),
        ]);
    }
    table
}

/// Errors of real runs, before and after, on used and kept conditions.
fn errors(name: &str, study: &ResidualStudy) -> CsvTable {
    let heads = study
        .plan
        .observables
        .iter()
        .map(|q| format!("rmse_{}", with_unit(q)));
    let columns: Vec<String> = ["stage", "conditions", "n_conditions"]
        .map(String::from)
        .into_iter()
        .chain(heads)
        .chain(["whitened_mean_square_1".to_owned()])
        .collect();
    let mut table = CsvTable::new(format!("{name}_errors"), columns);
    for stage in stages(study) {
        let parts = [
            ("used for the fit", true, Some(stage.used)),
            ("kept for the check", false, stage.kept),
        ];
        for (part, used, errors) in parts {
            let Some(errors) = errors else { continue };
            let n = study.plan.count(used);
            let mut row = vec![Field::from(&stage.name), part.into(), n.into()];
            let rmse = |q: &String| Field::from(errors.rmse.get(q).copied());
            row.extend(study.plan.observables.iter().map(rmse));
            row.push(errors.whitened_mse.into());
            table.row(row);
        }
    }
    table
}
