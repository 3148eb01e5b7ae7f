//! The screening.

use super::Page;
use super::numbers::{DASH, counted, fixed, fixed_or_dash, listed, p_value, signed};
use super::published_surface::PublishedSurface;
use crate::Error;
use report::{Column, Table};

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let result = page.result;
    let screening = &result.screening.screening;
    let n_runs: usize = result
        .screening
        .cells
        .iter()
        .map(|c| c.responses.len())
        .sum();
    let n_dummies = result
        .screening
        .columns
        .len()
        .saturating_sub(screening.factors.len());
    page.report.section("Screening (Plackett-Burman)").paragraph(&format!(
        "{} cells, {}, {} as dummy columns. An effect is the mean angle at the high level minus \
         that at the low level.",
        result.screening.cells.len(),
        counted(n_runs, "run", "runs"),
        n_dummies,
    ));
    errors(page);
    page.chart(
        "screening-pareto",
        "Pareto chart of the factors. Bars beyond the limit differ from the dummy columns.",
    );
    page.chart(
        "screening-half-normal",
        "Half-normal plot of all columns. The line has the slope of Lenth's pseudo standard \
         error; columns beyond his margin of error are named.",
    );
    table(page)?;
    verdict(page);
    Ok(())
}

/// Which error the effects are held against.
fn errors(page: &mut Page<'_>) {
    let fit = &page.result.screening.screening.main_effects;
    let dummies = match fit.root_mse {
        Some(sd) => format!(
            "The dummy columns give a standard deviation of a cell of {}° with {} degrees of \
             freedom.",
            fixed(sd, 3),
            fit.df_resid
        ),
        None => "There are no dummy columns: nothing can be tested against them.".into(),
    };
    let replicates = match &fit.replicates {
        Some(r) => format!(
            "The replicates give a standard deviation of one run of {}° with {} degrees of freedom.",
            fixed(r.pooled_within_sd, 3),
            r.df
        ),
        None => "There is one run in each cell: tests against replicates are undefined.".into(),
    };
    page.report.paragraph(&format!("{dummies} {replicates}"));
}

/// The effects.
fn table(page: &mut Page<'_>) -> Result<(), Error> {
    let published = PublishedSurface::of(page.study);
    let mut table = Table::new(
        "Effects by falling size; the last column is Table 4 of the study.",
        vec![
            Column::text("factor"),
            Column::number("effect (°)"),
            Column::number("share of sum of squares (%)"),
            Column::number("p, dummies"),
            Column::number("p, replicates"),
            Column::text("kept"),
            Column::number("published effect (°)"),
        ],
    )?;
    for f in &page.result.screening.screening.factors {
        let name = page
            .study
            .factor(&f.factor)
            .map_or(DASH, |entry| entry.name.as_str());
        let kept = page.result.kept_factors.contains(&f.factor);
        let theirs = published.and_then(|p| p.effect_deg(&f.factor));
        table.row([
            format!("{} {name}", f.factor),
            signed(f.effect, 2),
            fixed_or_dash(f.contribution_pct, 1),
            p_value(f.p_dummies),
            p_value(f.p_replicates),
            if kept { "yes" } else { "no" }.to_owned(),
            theirs.map_or_else(|| DASH.to_owned(), |e| signed(e, 2)),
        ])?;
    }
    page.report.table(&table);
    Ok(())
}

/// What each error says, and what was kept.
fn verdict(page: &mut Page<'_>) {
    let rule = &page.study.screening;
    let factors = &page.result.screening.screening.factors;
    let significant = |p: fn(&response_surface::FactorSignificance) -> Option<f64>| {
        if factors.iter().all(|f| p(f).is_none()) {
            return "undefined".to_owned();
        }
        let names: Vec<String> = factors
            .iter()
            .filter(|f| p(f).is_some_and(|p| p < rule.alpha))
            .map(|f| f.factor.clone())
            .collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            listed(&names)
        }
    };
    let text = format!(
        "Significant at {}: {} against the dummies; {} against the replicates. Kept: {}. The rule \
         keeps every significant factor (against replicates where there are any, against dummies \
         otherwise), and the {} largest in any case, because the next design needs them.",
        rule.alpha,
        significant(|f| f.p_dummies),
        significant(|f| f.p_replicates),
        listed(&page.result.kept_factors),
        rule.least_factors,
    );
    page.report.paragraph(&text);
}
