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

use crate::pictures::{self, NamedPicture};
use crate::{Error, ReportInput};
use report::{Report, Table};

/// The report in the making, with everything that it speaks of.
struct Page<'a> {
    /// The page.
    report: Report,
    /// What is shown.
    input: &'a ReportInput<'a>,
    /// The pictures.
    pictures: &'a [NamedPicture],
}

impl Page<'_> {
    /// Adds a chart where it could be drawn.
    fn chart(&mut self, name: &str, caption: &str) {
        chart(&mut self.report, self.pictures, name, caption);
    }

    /// Adds a PNG picture where there is one.
    fn png(&mut self, name: &str, description: &str, caption: &str) -> Result<(), Error> {
        if let Some(bytes) = pictures::png(self.pictures, name) {
            self.report.picture(bytes, description, caption)?;
        }
        Ok(())
    }

    /// Adds a table.
    fn table(&mut self, table: &Table) {
        self.report.table(table);
    }
}

/// Adds a chart where it could be drawn.
fn chart(report: &mut Report, pictures: &[NamedPicture], name: &str, caption: &str) {
    if let Some(svg) = pictures::chart(pictures, name) {
        report.figure(svg, caption);
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
pub(crate) fn study_page(
    input: &ReportInput<'_>,
    pictures: &[NamedPicture],
) -> Result<String, Error> {
    let title = format!("Calibration {}, profile {}", input.name, input.profile);
    let mut page = Page {
        report: Report::new(title),
        input,
        pictures,
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
