//! The screenings.

use super::Page;
use crate::Error;
use crate::numbers::{fixed, fixed_or_dash, in_unit, listed, observable, p_value, signed};
use crate::pictures::screening_charts::{half_normal, pareto};
use inference::ModelScreening;
use report::{Column, Table, counted};
use response_surface::Screening;

/// Adds the section; nothing if nothing was screened.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    if found.screening.is_empty() {
        return Ok(());
    }
    page.report.section("Screening").paragraph(&format!(
        "An effect is the mean at the high level minus that at the low level. A parameter is kept if it is significant \
         at {} (against replicates if there are any, against dummy columns otherwise), and the {} largest in any \
         case. A parameter that is not kept stays at its start in this model.",
        found.settings.screening_alpha, found.settings.screening_least
    ));
    for model in &found.screening {
        page.report.subsection(&model.model).paragraph(&format!(
            "{}. Went on: {}. Stay at their start: {}.",
            counted(model.n_runs, "run", "runs"),
            listed(&model.kept),
            listed(&model.dropped)
        ));
        for (quantity, screening) in &model.screenings {
            of_observable(page, quantity, screening)?;
            table(page, model, quantity, screening)?;
        }
    }
    Ok(())
}

/// Charts and errors of one observable.
fn of_observable(page: &mut Page<'_>, quantity: &str, screening: &Screening) -> Result<(), Error> {
    let (words, unit) = observable(quantity);
    let fit = &screening.main_effects;
    let dummies = match fit.root_mse {
        Some(sd) => format!(
            "the dummy columns give a standard deviation of a cell of {} with {}",
            in_unit(&fixed(sd, 3), unit),
            counted(fit.df_resid, "degree of freedom", "degrees of freedom")
        ),
        None => "there are no dummy columns, and nothing can be tested against them".into(),
    };
    let replicates = match &fit.replicates {
        Some(r) => format!(
            "the replicates give a standard deviation of one run of {} with {}",
            in_unit(&fixed(r.pooled_within_sd, 3), unit),
            counted(r.df, "degree of freedom", "degrees of freedom")
        ),
        None => "there is one run in each cell, and tests against replicates are undefined".into(),
    };
    page.report
        .paragraph(&format!("For the {words} {dummies}; {replicates}."));
    page.chart(
        pareto(screening, unit).as_ref(),
        &format!("Pareto chart of the effects on the {words}. Bars beyond the limit differ from the dummy columns."),
    )?;
    page.chart(
        half_normal(screening, unit).as_ref(),
        &format!(
            "Half-normal plot of all columns for the {words}. The line has the slope of Lenth's pseudo standard \
             error; columns beyond his margin of error are named (5 %; the simultaneous margin allows for all columns \
             together)."
        ),
    )
}

/// The effects on one observable.
fn table(
    page: &mut Page<'_>,
    model: &ModelScreening,
    quantity: &str,
    screening: &Screening,
) -> Result<(), Error> {
    let (words, unit) = observable(quantity);
    let unit = if unit.is_empty() { "1" } else { unit };
    let mut table = Table::new(
        format!("Effects on the {words} by falling size."),
        vec![
            Column::text("parameter"),
            Column::number(format!("effect ({unit})")),
            Column::number("share of sum of squares (%)"),
            Column::number("p, dummies"),
            Column::number("p, replicates"),
            Column::text("kept"),
        ],
    )?;
    for f in &screening.factors {
        let all = &page.input.problem.parameters;
        let name = all.iter().find(|p| p.symbol == f.factor);
        let name = name.map_or("", |p| p.name.as_str());
        table.row([
            format!("{} {name}", f.factor),
            signed(f.effect, 3),
            fixed_or_dash(f.contribution_pct, 1),
            p_value(f.p_dummies),
            p_value(f.p_replicates),
            if model.kept.contains(&f.factor) {
                "yes"
            } else {
                "no"
            }
            .to_owned(),
        ])?;
    }
    page.table(&table);
    Ok(())
}
