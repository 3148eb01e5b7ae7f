//! Cost and provenance.

use super::Page;
use super::numbers::{digits, fixed};
use report::Fact;

/// Adds both.
pub(super) fn add(page: &mut Page<'_>) {
    let (study, result) = (page.study, page.result);
    let cost = &result.cost;
    page.report.section("Cost").facts(&[
        Fact::new("Different runs in the store", cost.n_runs.to_string()),
        Fact::new(
            "Time of all runs, one core each",
            format!("{} h", digits(cost.run_time_s / 3600.0)),
        ),
        Fact::new(
            "Mean time of a drum run",
            format!("{} s", fixed(cost.drum_run_s, 1)),
        ),
        Fact::new(
            "Steps of a drum run in a second",
            digits(cost.drum_steps_per_s),
        ),
        Fact::new(
            "Runs that profile study needs",
            cost.study_profile_runs.to_string(),
        ),
        Fact::new(
            "What it would cost (estimate)",
            format!("{} core hours", digits(cost.study_profile_core_hours)),
        ),
    ]);
    page.report.paragraph(
        "Times were taken with other runs on the same machine at work. The estimate scales the \
         measured time per step by steps and runs; it is no measurement.",
    );
    let command = format!(
        "seedloop calibrate {} --profile {} --seed {}",
        study.path.display(),
        result.profile,
        result.seed
    );
    page.report.section("How to repeat it").paragraph(&command);
    page.report.paragraph(
        "The same version, inputs and seed give the same numbers. result.json holds all of them in \
         full precision, tables/ as CSV, pictures/ the figures, runs/ a record of every run.",
    );
    let inputs: Vec<String> = result
        .inputs
        .iter()
        .map(|(file, sum)| format!("{file}: SHA-256 {sum}"))
        .collect();
    let lines: Vec<&str> = inputs.iter().map(String::as_str).collect();
    if !lines.is_empty() {
        page.report.paragraph("Inputs:").list(&lines);
    }
    page.report.provenance(&format!(
        "seedloop {}, profile {}, first seed {}.",
        result.version, result.profile, result.seed
    ));
    page.report.provenance(&command);
    for line in &inputs {
        page.report.provenance(line);
    }
}
