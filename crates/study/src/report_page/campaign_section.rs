//! The campaigns on measured-like data, with and without a hidden effect.

use super::Page;
use super::numbers::{counted, digits, digits_or_dash, fixed, listed, observable};
use super::pictures::plain_name;
use super::{campaign, residual_parts};
use crate::{Error, HiddenCampaign};
use report::{Column, Table, Verdict};

/// Adds both sections.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let result = page.result;
    page.report.section("Campaign with something hidden").paragraph(
        "Data were made by the simulator as a laboratory would give them: means of a few runs with \
         seeds of their own, plus noise of reading. They hold something that the fit is not told \
         of. The fit starts from other parameters and sees the used conditions only. What was \
         hidden stands in the last paragraph of this section.",
    );
    body(page, "hidden", &result.hidden)?;
    revealed(page, &result.hidden);
    page.report.section("The same with nothing hidden").paragraph(
        "The same conditions, parameters and noise, with data made by the declared model itself. A \
         method that finds something here finds it everywhere.",
    );
    body(page, "nothing-hidden", &result.nothing_hidden)?;
    revealed(page, &result.nothing_hidden);
    Ok(())
}

/// Everything that can be said without knowing what was hidden.
fn body(page: &mut Page<'_>, name: &str, hidden: &HiddenCampaign) -> Result<(), Error> {
    let study = &hidden.study;
    let count = |used: bool| {
        study
            .plan
            .conditions
            .iter()
            .filter(|c| c.used == used)
            .count()
    };
    page.report.paragraph(&format!(
        "{} used, {} kept; {} each: {}. {} simulated for each mean; noise of a run with {} degrees \
         of freedom.",
        counted(count(true), "condition", "conditions"),
        count(false),
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
        study.noise_dof,
    ));
    residual_parts::verdict(&mut page.report, study);
    residual_parts::parameters(&mut page.report, study)?;
    residual_parts::candidates(&mut page.report, study)?;
    page.report.paragraph(&match residual_parts::added(study) {
        Some(effect) => format!("Added to the model and fitted again: {effect}."),
        None => "No effect is added, because the diagnosis names none.".to_owned(),
    });
    residual_parts::errors(&mut page.report, study)?;
    page.report.paragraph(&kept_errors(hidden));
    page.chart(
        &format!("{name}-residuals"),
        "Residuals by condition, observed minus simulated, by real runs; the band is twice the \
         standard error of observation and simulation.",
    );
    for quantity in &study.plan.observables {
        let words = observable(quantity).0;
        for (stage, is_there, model) in [
            ("before", true, "declared model, fitted"),
            (
                "after",
                study.after.is_some(),
                "with the added effect, fitted again",
            ),
        ] {
            if is_there {
                page.chart(
                    &format!("{name}-predicted-{}-{stage}", plain_name(quantity)),
                    &format!(
                        "Predicted against measured {words}: {model}. Bars: 2 standard errors."
                    ),
                );
            }
        }
    }
    conditions(page, hidden)
}

/// The error on the kept conditions, before and after, in words.
fn kept_errors(hidden: &HiddenCampaign) -> String {
    let stages = campaign::stages(&hidden.study);
    let whitened: Vec<Option<f64>> = stages
        .iter()
        .map(|s| s.kept.map(|e| e.whitened_mse))
        .collect();
    match whitened.as_slice() {
        [Some(before), Some(after), ..] => format!(
            "On the kept conditions the whitened mean square of real runs goes from {} to {} ({} %).",
            fixed(*before, 2),
            fixed(*after, 2),
            super::numbers::signed(100.0 * (after / before - 1.0), 0),
        ),
        [Some(before), ..] => {
            format!(
                "On the kept conditions the whitened mean square of real runs is {}.",
                fixed(*before, 2)
            )
        }
        _ => "No condition is kept for the check.".into(),
    }
}

/// Observed and simulated values.
fn conditions(page: &mut Page<'_>, hidden: &HiddenCampaign) -> Result<(), Error> {
    let study = &hidden.study;
    let mut columns = vec![Column::text("condition"), Column::text("role")];
    for quantity in &study.plan.observables {
        let (words, unit) = observable(quantity);
        let unit = if unit.is_empty() { "1" } else { unit };
        columns.push(Column::number(format!("{words}: observed ± se ({unit})")));
        columns.push(Column::number(format!("before ({unit})")));
        columns.push(Column::number(format!("after ({unit})")));
    }
    let mut table = Table::new("Observed and simulated means by condition.", columns)?;
    for (c, condition) in study.plan.conditions.iter().enumerate() {
        let role = if condition.used { "used" } else { "kept" };
        let mut row = vec![campaign::condition_name(condition), role.to_owned()];
        for k in 0..study.plan.observables.len() {
            let se = study.observed.covariance[k][k].sqrt();
            row.push(format!(
                "{} ± {}",
                digits(study.observed.values[c][k]),
                digits(se)
            ));
            row.push(digits(study.simulated_before[c][k]));
            row.push(digits_or_dash(
                study.after.as_ref().map(|a| a.simulated[c][k]),
            ));
        }
        table.row(row)?;
    }
    page.report.table(&table);
    Ok(())
}

/// What was hidden, and whether it was found; the last words of a section.
fn revealed(page: &mut Page<'_>, hidden: &HiddenCampaign) {
    let truth: Vec<String> = hidden
        .true_parameters
        .iter()
        .map(|(name, value)| {
            let fitted = hidden.study.fitted.get(name).copied();
            let after = hidden
                .study
                .after
                .as_ref()
                .and_then(|a| a.fitted.get(name).copied());
            format!(
                "{name} = {} (fitted before {}, after {})",
                digits(*value),
                digits_or_dash(fitted),
                digits_or_dash(after)
            )
        })
        .collect();
    let made = match &hidden.hidden_effect {
        Some(effect) => {
            let found = hidden
                .study
                .after
                .as_ref()
                .and_then(|a| a.effects.get(effect).copied());
            format!(
                "Hidden was {effect} with amplitude {}; the fit with real runs gives {}.",
                digits(hidden.hidden_amplitude),
                digits_or_dash(found)
            )
        }
        None => "Nothing was hidden.".to_owned(),
    };
    let (colour, headline) = if hidden.verdict_is_right {
        (Verdict::Good, "Revealed: the verdict is right")
    } else {
        (
            Verdict::Bad,
            "Revealed: the verdict is not what made the data",
        )
    };
    let text = format!("{made} The data were made with {}.", truth.join("; "));
    page.report.verdict(colour, headline, &text);
}
