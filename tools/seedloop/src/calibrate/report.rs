//! The report of a calibration: what the loop holds, handed to the page.

use anyhow::Context as _;
use scene::FillingLibrary;
use std::path::Path;
use study::{Study, StudyResult, StudySimulator};
use study_report::{ComparedValue, CurvePoints, ReportInput};

/// Writes the report into the result folder.
///
/// # Errors
/// A picture that cannot be drawn, a file that cannot be written.
pub(crate) fn write(
    folder: &Path,
    study: &Study,
    simulator: &StudySimulator,
    result: &StudyResult,
) -> anyhow::Result<()> {
    let compare: Vec<ComparedValue> = result
        .compare
        .iter()
        .map(|row| ComparedValue {
            result: row.result.clone(),
            found: row.found,
            se: row.se,
            value: row.published,
            sd: row.published_sd,
            source: row.source.clone(),
        })
        .collect();
    let defaults = result.defaults.iter();
    let defaults: Vec<String> = defaults
        .map(|d| format!("{} = {}: {}", d.key, d.value, d.why))
        .collect();
    let curves = study
        .curves()
        .map(|(model, name, [along, column], repeats)| CurvePoints {
            model: model.into(),
            name: name.into(),
            along: along.into(),
            column: column.into(),
            repeats,
        });
    let curves: Vec<CurvePoints> = curves.collect();
    let none = FillingLibrary::default();
    let input = ReportInput {
        name: &result.name,
        profile: result.profile.as_deref().unwrap_or("as the file stands"),
        version: &result.version,
        seed: result.seed,
        inputs: &result.inputs,
        problem: &study.problem,
        calibration: &result.calibration,
        compare: &compare,
        defaults: &defaults,
        scenes: &study.models,
        fillings: simulator.fillings().unwrap_or(&none),
        records: &result.records,
        curves: &curves,
        spent: result.spent,
    };
    study_report::write(folder, &input)
        .with_context(|| format!("cannot write the report into {}", folder.display()))
}
