//! The runs at the estimate: what the check says, and what it looks like.

use super::Page;
use crate::Error;
use crate::measurement_rows::{place, role_name, rows};
use crate::numbers::{DASH, observable, signed, with_error};
use crate::pictures::beds::{Bed, beds};
use crate::pictures::run_charts::{check_runs, curve_chart, series_of};
use crate::run_details::RunDetails;
use report::{Column, SphereViewer, Table};
use std::collections::BTreeMap;

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    if rows(page.input).iter().all(|row| row.after.is_none()) {
        return Ok(());
    }
    page.report
        .section("Runs at the estimate")
        .paragraph("Fresh runs with seeds of their own; no surface and no fit has seen those of role check and show.");
    table(page)?;
    let beds: BTreeMap<usize, Bed> = beds(page.input).into_iter().collect();
    for (number, (model, records)) in check_runs(page.input).into_iter().enumerate() {
        let at = place(&model.scene, &model.condition);
        let mut frames = records.iter().filter_map(|r| RunDetails::last_frame_of(r));
        if let Some(frame) = frames.next() {
            let words = format!("Last frame of a check run: {at}");
            page.report.picture(&frame, &words, &format!("{words}."))?;
        }
        if let Some(bed) = beds.get(&number) {
            let viewer = SphereViewer {
                kinds: &bed.kinds,
                bodies: &bed.bodies,
                picture: &bed.picture()?,
                description: &format!("The seeds of a check run in space: {at}"),
            };
            let caption = format!("The same seeds in space: {at}; turn them with the mouse.");
            page.report.viewer(&viewer, &caption)?;
        }
        page.chart(
            records.first().and_then(|record| series_of(record)).as_ref(),
            &format!(
                "{at}: direction of the centre of mass over time, the part behind the start-up (band), and the \
                 moments of the frames (dots)."
            ),
        )?;
    }
    for curve in page.input.curves {
        page.chart(
            curve_chart(page.input, curve).as_ref(),
            &format!(
                "{}, {}: measured (points) and simulated by the runs at the estimate (lines).",
                curve.model, curve.name
            ),
        )?;
    }
    Ok(())
}

/// Measurements beside the runs.
fn table(page: &mut Page<'_>) -> Result<(), Error> {
    let mut table = Table::new(
        "Measurements beside the runs at the estimate, ± standard errors. The third number is the standard error that \
         the uncertainty of the parameters alone gives the prediction.",
        vec![
            Column::text("measurement"),
            Column::text("role"),
            Column::number("measured"),
            Column::number("simulated"),
            Column::number("from parameters"),
            Column::number("difference"),
            Column::number("z"),
            Column::text("runs, by how they ended"),
        ],
    )?;
    for row in rows(page.input) {
        let Some(c) = row.after else { continue };
        let (words, unit) = observable(&c.observable);
        let se = row.measured_se().hypot(c.simulated.se);
        let difference = c.measured.mean - c.simulated.mean;
        table.row([
            format!("{}: {words}", place(&c.scene, &c.condition)),
            role_name(c.role).to_owned(),
            with_error(c.measured.mean, Some(row.measured_se()), unit),
            with_error(c.simulated.mean, Some(c.simulated.se), unit),
            c.parameter_se
                .map_or_else(|| DASH.to_owned(), |se| with_error(se, None, unit)),
            with_error(difference, Some(se), unit),
            signed(c.z, 2),
            regimes(c.simulated.n_runs, &c.regimes),
        ])?;
    }
    page.table(&table);
    Ok(())
}

/// Number of runs, and how they ended.
fn regimes(n_runs: usize, regimes: &BTreeMap<String, usize>) -> String {
    if regimes.is_empty() {
        return n_runs.to_string();
    }
    let each: Vec<String> = regimes
        .iter()
        .map(|(name, n)| format!("{n} {name}"))
        .collect();
    format!("{n_runs}: {}", each.join(", "))
}
