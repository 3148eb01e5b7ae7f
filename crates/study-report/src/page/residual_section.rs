//! The study of a residual over several conditions: verdict, candidates, errors, charts.

use super::residual_parts;
use crate::Error;
use crate::numbers::{DASH, fixed, listed, observable, signed, with_decimals_of, with_error};
use crate::pictures::residual_charts;
use crate::residual::{self, StageErrors};
use inference::ResidualStudy;
use report::{Column, Report, Table, counted};

/// Adds everything that the study of a residual says.
pub(super) fn add(report: &mut Report, study: &ResidualStudy) -> Result<(), Error> {
    report.paragraph(&format!(
        "{} used, {} kept; {} each: {}. {} simulated for each mean; noise of a run with {} degrees \
         of freedom.",
        counted(study.plan.count(true), "condition", "conditions"),
        study.plan.count(false),
        counted(study.plan.observables.len(), "observable", "observables"),
        listed(
            &study
                .plan
                .observables
                .iter()
                .map(|o| observable(o).0)
                .collect::<Vec<_>>()
        ),
        counted(study.plan.replicates, "run is", "runs are"),
        study.noise_dof.floor(),
    ));
    residual_parts::verdict(report, study);
    residual_parts::parameters(report, study)?;
    residual_parts::candidates(report, study)?;
    residual_parts::support(report, study)?;
    report.paragraph(&match residual_parts::added(study) {
        Some(effect) if study.diagnosis.effects.is_empty() => format!(
            "Tried in the model, fitted again, and taken out because real runs speak against it: \
             {effect}."
        ),
        Some(effect) => format!("Added to the model and fitted again: {effect}."),
        None => residual_parts::not_added(study).to_owned(),
    });
    residual_parts::refits(report, study)?;
    residual_parts::errors(report, study)?;
    report.paragraph(&kept_errors(study));
    for k in 0..study.plan.observables.len() {
        let svg = residual_charts::residuals(study, k).draw()?;
        report.figure(&svg, RESIDUALS);
    }
    predicted(report, study)?;
    conditions(report, study)
}

/// Caption of the charts of residuals.
pub(super) const RESIDUALS: &str = "Residuals by condition, observed minus simulated, by real runs; the band is twice the standard \
                                    error of observation and simulation.";

/// Charts of predicted against measured values, before and after.
fn predicted(report: &mut Report, study: &ResidualStudy) -> Result<(), Error> {
    let after = study.after.as_ref().map(|after| &after.simulated);
    let stages = [
        (Some(&study.simulated_before), "declared model, fitted"),
        (after, "with the added effect, fitted again"),
    ];
    for (k, quantity) in study.plan.observables.iter().enumerate() {
        let words = observable(quantity).0;
        for (simulated, model) in stages {
            let Some(simulated) = simulated else { continue };
            let svg = residual_charts::predicted(study, simulated, k).draw()?;
            report.figure(
                &svg,
                &format!("Predicted against measured {words}: {model}. Bars: 2 standard errors."),
            );
        }
    }
    Ok(())
}

/// The error on the kept conditions, before and after, in words.
fn kept_errors(study: &ResidualStudy) -> String {
    let stages = residual::stages(study);
    let whitened = |stage: &StageErrors<'_>| stage.kept.map(|e| e.whitened_mse);
    let Some((Some(before), others)) = stages.split_first().map(|(s, o)| (whitened(s), o)) else {
        return "No condition is kept for the check.".into();
    };
    let one = |stage: &StageErrors<'_>| {
        let after = whitened(stage)?;
        let change = signed(100.0 * (after / before - 1.0), 0);
        Some(format!(
            "{} it is {} ({change} %)",
            stage.name,
            fixed(after, 2)
        ))
    };
    let after: Vec<String> = others.iter().filter_map(one).collect();
    let said = format!(
        "On the kept conditions the whitened mean square of real runs is {} before",
        fixed(before, 2)
    );
    if after.is_empty() {
        format!("{said}.")
    } else {
        format!("{said}; {}.", after.join("; "))
    }
}

/// Observed and simulated values.
fn conditions(report: &mut Report, study: &ResidualStudy) -> Result<(), Error> {
    let models = residual::models(study);
    let mut columns = vec![Column::text("condition"), Column::text("role")];
    for quantity in &study.plan.observables {
        let (words, unit) = observable(quantity);
        let unit = if unit.is_empty() { "1" } else { unit };
        columns.push(Column::number(format!("{words}: observed ± se ({unit})")));
        columns.push(Column::number(format!("before ({unit})")));
        let names = models.iter().map(|(name, _)| format!("{name} ({unit})"));
        columns.extend(names.map(Column::number));
    }
    let mut table = Table::new("Observed and simulated means by condition.", columns)?;
    for (c, condition) in study.plan.conditions.iter().enumerate() {
        let role = if condition.used { "used" } else { "kept" };
        let mut row = vec![residual::condition_name(condition), role.to_owned()];
        for (k, name) in study.plan.observables.iter().enumerate() {
            if condition.name_of(name).is_none() {
                row.extend(vec![DASH.to_owned(); 2 + models.len()]);
                continue;
            }
            let se = study.plan.standard_error(c, k);
            row.push(match study.plan.conditions[c].values[k] {
                Some(value) => with_error(value, Some(se), ""),
                None => DASH.to_owned(),
            });
            row.push(with_decimals_of(study.simulated_before[c][k], Some(se)));
            row.extend(
                models
                    .iter()
                    .map(|(_, m)| with_decimals_of(m.simulated[c][k], Some(se))),
            );
        }
        table.row(row)?;
    }
    report.table(&table);
    Ok(())
}
