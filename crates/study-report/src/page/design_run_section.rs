//! The runs behind the surfaces, each point of a design folded up.

use super::{MOST_FRAME_BYTES, Page};
use crate::Error;
use crate::design_points::{DesignPoint, design_points};
use crate::numbers::{DASH, digits, digits_or_dash, in_unit, observable};
use crate::pictures::run_charts::series_of;
use crate::run_details::RunDetails;
use inference::ModelSurfaces;
use report::{Column, Table, counted};

/// Adds the section; nothing without surfaces.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let surfaces = &page.input.calibration.surfaces;
    if surfaces.iter().all(|s| s.points.is_empty()) {
        return Ok(());
    }
    page.report.section("Runs of the designs").paragraph(
        "Every point of the designs behind the surfaces with its runs: settings, observables, and what their records keep \
         to be seen. The squares in the pictures of the surfaces lead here.",
    );
    for (number, model) in surfaces.iter().enumerate() {
        page.report.subsection(&model.model);
        for point in design_points(model) {
            page.report
                .begin_fold(&point.id(number), &point.name(&model.symbols));
            settings(page, model, &point)?;
            observables(page, model, &point)?;
            for &run in &point.runs {
                pictures(page, model, run)?;
            }
            page.report.end_fold();
        }
    }
    Ok(())
}

/// The parameters at a point.
fn settings(
    page: &mut Page<'_>,
    model: &ModelSurfaces,
    point: &DesignPoint<'_>,
) -> Result<(), Error> {
    let columns = vec![Column::text("parameter"), Column::number("value")];
    let mut table = Table::new("Settings.", columns)?;
    for (symbol, value) in model.symbols.iter().zip(point.settings) {
        let mut all = page.input.calibration.parameters.iter();
        let known = all.find(|p| p.symbol == *symbol);
        let (name, unit) = known.map_or(("", "1"), |p| (p.name.as_str(), p.unit.as_str()));
        table.row([format!("{symbol} {name}"), in_unit(&digits(*value), unit)])?;
    }
    page.table(&table);
    Ok(())
}

/// What each run gave.
fn observables(
    page: &mut Page<'_>,
    model: &ModelSurfaces,
    point: &DesignPoint<'_>,
) -> Result<(), Error> {
    let mut columns = vec![Column::number("run")];
    let of_observable = |name: &String| match observable(name) {
        (words, "") => Column::number(words),
        (words, unit) => Column::number(format!("{words} ({unit})")),
    };
    columns.extend(model.values.keys().map(of_observable));
    columns.extend([
        Column::number("seed"),
        Column::text("ended"),
        Column::text("record"),
    ]);
    let n = counted(point.runs.len(), "run", "runs");
    let mut table = Table::new(format!("What {n} of this point gave."), columns)?;
    for &run in &point.runs {
        let key = model.keys.get(run).map_or("", String::as_str);
        let record = page.input.records.get(key);
        let values = model.values.values();
        let values = values.map(|values| digits_or_dash(values.get(run).copied()));
        let dash = || DASH.to_owned();
        let rest = [
            record.map_or_else(dash, |r| r.seed().to_string()),
            record
                .and_then(|r| r.regime())
                .map_or_else(dash, str::to_owned),
            key.to_owned(),
        ];
        table.row(
            std::iter::once((run + 1).to_string())
                .chain(values)
                .chain(rest),
        )?;
    }
    page.table(&table);
    Ok(())
}

/// Last frame and series of a run, as far as its record keeps them.
fn pictures(page: &mut Page<'_>, model: &ModelSurfaces, run: usize) -> Result<(), Error> {
    let key = model.keys.get(run);
    let Some(record) = key.and_then(|key| page.input.records.get(key)) else {
        return Ok(());
    };
    if let Some(frame) = RunDetails::last_frame_of(record) {
        if frame.len() <= page.room_for_frames {
            page.room_for_frames -= frame.len();
            let words = format!("Last frame of run {}", run + 1);
            page.report.picture(&frame, &words, &format!("{words}."))?;
        } else {
            page.report.paragraph(&format!(
                "The last frame of run {} is kept in its record alone: more than {} MB of frames would make this page slow.",
                run + 1,
                MOST_FRAME_BYTES / 1_000_000
            ));
        }
    }
    page.chart(
        series_of(record).as_ref(),
        &format!(
            "Run {}: direction of the centre of mass over time, the part behind the start-up (band), and the moments of \
             the frames (dots).",
            run + 1
        ),
    )
}
