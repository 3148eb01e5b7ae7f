//! The sweep over one parameter, and the metering device.

use super::Page;
use super::numbers::{DASH, degrees, fixed, fixed_or_dash};
use super::published_surface::PublishedSurface;
use crate::{Error, SweepPoint};
use report::{Column, Fact, Table, Verdict};

/// Adds both sections.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    sweep(page)?;
    metering(page);
    Ok(())
}

/// A table of a sweep; `published` gives what the study says at a value, deg.
pub(super) fn sweep_table(
    caption: &str,
    quantity: &str,
    points: &[SweepPoint],
    published: Option<&dyn Fn(f64) -> Option<f64>>,
) -> Result<Table, report::Error> {
    let mut columns = vec![
        Column::number(quantity),
        Column::number("angle (°)"),
        Column::number("sd of runs (°)"),
        Column::number("n"),
        Column::number("sd of frames (°)"),
        Column::text("regime"),
        Column::number("slip at the shell"),
    ];
    if published.is_some() {
        columns.push(Column::number("eq. (10) of the study (°)"));
    }
    let mut table = Table::new(caption, columns)?;
    for p in points {
        let mut row = vec![
            p.value.to_string(),
            fixed(p.result.mean, 2),
            fixed_or_dash(p.result.sd, 2),
            p.result.n.to_string(),
            fixed_or_dash(p.result.frame_sd, 2),
            p.regime.clone(),
            fixed(p.shell_slip, 3),
        ];
        if let Some(published) = published {
            row.push(published(p.value).map_or_else(|| DASH.to_owned(), |a| fixed(a, 2)));
        }
        table.row(row)?;
    }
    Ok(table)
}

/// Angle against one parameter.
fn sweep(page: &mut Page<'_>) -> Result<(), Error> {
    let (study, result) = (page.study, page.result);
    let symbol = &study.sweep.symbol;
    let factor = study.factor(symbol)?;
    let rest: Vec<String> = study
        .published_optimum
        .iter()
        .filter(|(name, _)| *name != symbol)
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    page.report.section(&format!("Angle against the {}", factor.name)).paragraph(&format!(
        "{symbol} is varied; {} as at the published optimum, the others at their bench means. Bench \
         mean of {symbol}: {} ± {} (sd, n = {}).",
        rest.join(", "),
        fixed(factor.measured.mean, 2),
        fixed(factor.measured.sd, 2),
        factor.measured.n,
    ));
    page.chart(
        "sweep",
        "Repose angle against the parameter; bars are the sd of runs where there is more than one. \
         Beside it the published regression inside its levels, and the angle that the study \
         reports at its bench measurements, where it saw the bed slide.",
    );
    let theirs = PublishedSurface::of(study).map(|published| {
        move |at: f64| {
            published.angle_deg(&|name: &str| {
                if name == symbol {
                    Some(at)
                } else {
                    study.published_optimum.get(name).copied()
                }
            })
        }
    });
    let theirs = theirs.as_ref().map(|f| f as &dyn Fn(f64) -> Option<f64>);
    let caption = "Sweep; regime and slip are those of the first run of each point.";
    page.report
        .table(&sweep_table(caption, symbol, &result.sweep, theirs)?);
    Ok(())
}

/// The filling angle.
fn metering(page: &mut Page<'_>) {
    let metering = &page.result.metering;
    let (r, [measured, measured_sd], [simulated, simulated_sd]) = (
        &metering.result,
        metering.published_measured_deg,
        metering.published_simulated_deg,
    );
    page.report.section("Metering device").verdict(
        Verdict::Caution,
        "Dimensions assumed",
        "The study gives no dimensions of the device. Diameter, width and place of the board are \
         assumptions, made once and not tuned. The filling angle shows how the model behaves in \
         such a device; it does not test the published value.",
    );
    page.report.facts(&[
        Fact::new(
            "Published measurement",
            format!("{}° ± {}°", fixed(measured, 2), fixed(measured_sd, 2)),
        ),
        Fact::new(
            "Published simulation",
            format!("{}° ± {}°", fixed(simulated, 2), fixed(simulated_sd, 2)),
        ),
        Fact::new("This work", degrees(r.mean, r.sd, r.n)),
        Fact::new(
            "Sd over the frames of a run",
            format!("{}°", fixed_or_dash(r.frame_sd, 2)),
        ),
        Fact::new(
            "Difference from the measurement",
            format!("{} %", fixed(metering.difference_percent, 2)),
        ),
    ]);
    page.chart(
        "filling-angle",
        "Filling angle at the chosen point, with sds; ours with assumed dimensions. A bar without \
         an error bar stands for a single run.",
    );
}
