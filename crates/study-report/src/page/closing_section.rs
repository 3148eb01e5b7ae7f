//! Cost, settings, inputs and provenance.

use super::Page;
use crate::Error;
use crate::numbers::fixed;
use report::{Column, Report, Table};
use scene::TimeSpent;
use serde_json::Value;
use std::collections::BTreeMap;

/// Adds all of them.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    cost(page)?;
    let input = page.input;
    page.report.section("Inputs and settings").paragraph(
        "The same version, inputs and seed give the same numbers. result.json holds all of them in full precision, \
         runs/ a record of every run.",
    );
    settings(page)?;
    defaults(&mut page.report, input.defaults);
    inputs(&mut page.report, input.inputs);
    page.report.provenance(&format!(
        "seedloop {}, study {}, profile {}, first seed {}.",
        input.version, input.name, input.profile, input.seed
    ));
    Ok(())
}

/// What the file left out.
pub(super) fn defaults(report: &mut Report, defaults: &[String]) {
    super::list(
        report,
        "What the study file left out, and what was taken instead:",
        defaults,
    );
}

/// The input files, in the section and at the foot of the page.
pub(super) fn inputs(report: &mut Report, inputs: &BTreeMap<String, String>) {
    let lines: Vec<String> = inputs
        .iter()
        .map(|(file, sum)| format!("{file}: SHA-256 {sum}"))
        .collect();
    super::list(report, "Input files:", &lines);
    for line in &lines {
        report.provenance(line);
    }
}

/// What was spent, in sentences.
pub(super) fn spent(spent: &TimeSpent) -> String {
    let mut sentences = vec![format!(
        "All runs took {} s of one core, and this call {} s.",
        fixed(spent.core_s, 0),
        fixed(spent.wall_s, 0)
    )];
    let total = spent.phases.total_s();
    if total > 0.0 {
        let share =
            |(name, time): (&str, f64)| format!("{name} {} %", fixed(100.0 * time / total, 0));
        let shares = spent.phases.named().map(share).join(", ");
        sentences.push(format!("Of the time of the runs: {shares}."));
    }
    if let Some(waiting) = spent.waiting_s {
        sentences.push(format!(
            "For {} s a thread of this call computed no run: it waited for the last of a stage, or surfaces were fitted.",
            fixed(waiting, 0)
        ));
    }
    sentences.join(" ")
}

/// Runs and time by stage; nothing if no stage is reported.
fn cost(page: &mut Page<'_>) -> Result<(), Error> {
    let cost = &page.input.calibration.cost;
    if cost.is_empty() {
        return Ok(());
    }
    page.report.section("Cost");
    let mut table = Table::new(
        "Different runs that each stage asked for, and its wall time, which is small where records were found again.",
        vec![
            Column::text("stage"),
            Column::number("runs"),
            Column::number("wall time (s)"),
        ],
    )?;
    for stage in cost {
        let row = [
            stage.stage.clone(),
            stage.runs.to_string(),
            fixed(stage.wall_s, 1),
        ];
        table.row(row)?;
    }
    let runs: usize = cost.iter().map(|c| c.runs).sum();
    let wall_s: f64 = cost.iter().map(|c| c.wall_s).sum();
    table.row(["all stages".to_owned(), runs.to_string(), fixed(wall_s, 1)])?;
    page.table(&table);
    page.report.paragraph(&spent(&page.input.spent));
    Ok(())
}

/// The settings of the loop under the names that they have in the study file.
fn settings(page: &mut Page<'_>) -> Result<(), Error> {
    let settings = serde_json::to_value(&page.input.calibration.settings);
    let Ok(Value::Object(settings)) = settings else {
        return Ok(());
    };
    let mut table = Table::new(
        "Settings of the loop, by the names that they have in result.json.",
        vec![Column::text("setting"), Column::text("value")],
    )?;
    for (name, value) in settings {
        let value = match value {
            Value::Null => "no limit".to_owned(),
            Value::String(text) => text,
            other => other.to_string(),
        };
        table.row([name, value])?;
    }
    page.table(&table);
    Ok(())
}
