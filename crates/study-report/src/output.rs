//! Writing the page of a report.

use crate::page::{diagnosis_page, study_page};
use crate::{DiagnosisInput, Error, ReportInput};
use std::path::Path;

/// Name of the page.
pub(crate) const PAGE: &str = "report.html";

/// Writes `report.html` of a calibration into a folder, whole or not at all: one file that opens without a network.
///
/// # Errors
///
/// A file that cannot be written, a chart that cannot be drawn, a seed that has no body.
pub fn write(folder: &Path, input: &ReportInput<'_>) -> Result<(), Error> {
    put(folder, &study_page(input)?)
}

/// Writes `report.html` of a diagnosis alone into a folder.
///
/// # Errors
///
/// A file that cannot be written, a chart that cannot be drawn.
pub fn write_diagnosis(folder: &Path, input: &DiagnosisInput<'_>) -> Result<(), Error> {
    put(folder, &diagnosis_page::page(input)?)
}

/// Writes the page, whole or not at all.
fn put(folder: &Path, page: &str) -> Result<(), Error> {
    let path = folder.join(PAGE);
    let written = campaign::run_store::write_whole(&path, page.as_bytes());
    written.map_err(|source| Error::File { path, source })
}
