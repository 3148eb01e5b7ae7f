//! The report: what came out, how it was found, and how far it can be trusted.

mod closing_section;
mod design_run_section;
pub(crate) mod diagnosis_page;
mod diagnosis_section;
mod explorer_section;
mod knowledge_section;
mod opening_section;
mod residual_parts;
mod residual_section;
mod run_section;
mod screening_section;
mod search_section;
mod seed_section;
mod surface_section;

use crate::{Error, ReportInput};
use report::{Plot, Report, Table};

/// Most bytes of frames in a page: with more it would open slowly.
const MOST_FRAME_BYTES: usize = 6_000_000;

/// The report in the making, with everything that it speaks of.
struct Page<'a> {
    /// The page.
    report: Report,
    /// What is shown.
    input: &'a ReportInput<'a>,
    /// Bytes of frames that the page still has room for.
    room_for_frames: usize,
}

impl Page<'_> {
    /// Adds a chart if there is one.
    fn chart(&mut self, chart: Option<&Plot>, caption: &str) -> Result<(), Error> {
        if let Some(chart) = chart {
            self.report.figure(&chart.draw()?, caption);
        }
        Ok(())
    }

    /// Adds a table.
    fn table(&mut self, table: &Table) {
        self.report.table(table);
    }
}

/// Adds a list of statements under a sentence; nothing without statements.
pub(crate) fn list(report: &mut Report, sentence: &str, lines: &[String]) {
    if !lines.is_empty() {
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        report.paragraph(sentence).list(&lines);
    }
}

/// Makes the page of a calibration as HTML.
pub(crate) fn study_page(input: &ReportInput<'_>) -> Result<String, Error> {
    with_room(input, MOST_FRAME_BYTES)
}

/// The same with room for so many bytes of frames of the runs of designs.
pub(crate) fn with_room(input: &ReportInput<'_>, room_for_frames: usize) -> Result<String, Error> {
    let title = format!("Calibration {}, profile {}", input.name, input.profile);
    let mut page = Page {
        report: Report::new(title),
        input,
        room_for_frames,
    };
    opening_section::add(&mut page)?;
    explorer_section::add(&mut page)?;
    knowledge_section::add(&mut page)?;
    run_section::add(&mut page)?;
    diagnosis_section::add(&mut page)?;
    surface_section::add(&mut page)?;
    screening_section::add(&mut page)?;
    search_section::add(&mut page)?;
    seed_section::add(&mut page)?;
    design_run_section::add(&mut page)?;
    closing_section::add(&mut page)?;
    Ok(page.report.html())
}
