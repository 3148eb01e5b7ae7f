//! The result in brief, and what the profile reduces.

use super::Page;
use super::numbers::{counted, degrees, fixed, listed};
use crate::{Error, Profile};
use report::{Column, Fact, Table, Verdict};

/// Adds both sections.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    brief(page);
    profile(page)
}

/// Facts, and how they compare with the measurement.
fn brief(page: &mut Page<'_>) {
    let (study, result) = (page.study, page.result);
    let (target, v) = (&study.target, &result.validation);
    let chosen: Vec<String> = result
        .chosen
        .iter()
        .map(|(s, value)| format!("{s} = {}", fixed(*value, 4)))
        .collect();
    page.report.section("Result in brief");
    page.report.facts(&[
        Fact::new(
            "Measured angle",
            degrees(target.value, Some(target.sd), target.n),
        ),
        Fact::new(
            "Angle of the validation runs",
            degrees(v.point.mean, v.point.sd, v.point.n),
        ),
        Fact::new(
            "Difference",
            format!("{} %", fixed(v.relative_error_percent, 2)),
        ),
        Fact::new(
            "Factors kept by the screening",
            listed(&result.kept_factors),
        ),
        Fact::new("Chosen point (all dimensionless)", chosen.join(", ")),
        Fact::new("Runs", result.cost.n_runs.to_string()),
    ]);
    if result.target_reached {
        page.report.verdict(
            Verdict::Good,
            "The surface reaches the measured angle inside the bounds",
            "The chosen point is the solution nearest to the bench means, in units of their \
             standard deviations. It is one of a set.",
        );
    } else {
        page.report.verdict(
            Verdict::Bad,
            "The surface does not reach the measured angle inside the bounds",
            "There is no solution. The validation is run at the point of the bounds that comes \
             nearest; its difference is a finding, not a calibration.",
        );
    }
    let remarks: Vec<&str> = result.remarks.iter().map(String::as_str).collect();
    if !remarks.is_empty() {
        page.report
            .subsection("What to keep in mind")
            .list(&remarks);
    }
}

/// Sizes of the profile beside those of the study.
fn profile(page: &mut Page<'_>) -> Result<(), Error> {
    let ran = &page.material.profile;
    let full = page.study.profile.get("study");
    page.report.section("Size of this run");
    let mut table = Table::new(
        "Sizes of the profile that was run, beside those of the published study.",
        vec![
            Column::text("size"),
            Column::number("this run"),
            Column::number("profile study"),
        ],
    )?;
    let mut reduced = Vec::new();
    for (name, size) in SIZES {
        let other = full.map(size);
        if other.is_some_and(|o| size(ran) < o) {
            reduced.push(name);
        }
        let other = other.map_or_else(|| super::numbers::DASH.to_owned(), |o| o.to_string());
        table.row([name.to_owned(), size(ran).to_string(), other])?;
    }
    page.report.table(&table);
    let text = match reduced.len() {
        0 => "No number of runs is reduced.".to_owned(),
        n => format!(
            "Reduced against the study ({}): {}.",
            counted(n, "size", "sizes"),
            reduced.join("; ")
        ),
    };
    page.report.paragraph(&text);
    for (changes, scenes) in [
        (&ran.scene, "all scenes"),
        (&ran.hidden_scene, "the campaigns only"),
    ] {
        let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
        if !changes.is_empty() {
            page.report
                .paragraph(&format!("Settings that the profile changes in {scenes}:"));
            page.report.list(&changes);
        }
    }
    page.report.paragraph(
        "Unless it is said otherwise, ± is the standard deviation of single runs (of frames for \
         the measured angle), and n is their number. A dash stands for what is not defined.",
    );
    Ok(())
}

/// A size by its name.
type Size = (&'static str, fn(&Profile) -> usize);

/// The sizes of a profile.
const SIZES: [Size; 6] = [
    ("runs in each cell of the screening", |p| {
        p.screening_replicates
    }),
    ("runs in each cell of the surface", |p| p.surface_replicates),
    ("centre points of the surface", |p| p.centre_points),
    ("runs of the validation", |p| p.validation_runs),
    (
        "runs at each point of the sweeps and of the metering device",
        |p| p.point_runs,
    ),
    ("runs for each mean of the residual studies", |p| {
        p.residual_replicates
    }),
];
