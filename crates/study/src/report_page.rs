//! The report: what was done, what came out, and how far it can be trusted, with pictures.

mod bench_section;
pub(crate) mod campaign;
mod campaign_section;
mod closing_section;
pub(crate) mod diagnosis_page;
pub(crate) mod material;
mod numbers;
mod opening_section;
pub(crate) mod pictures;
mod point_sections;
mod published_surface;
mod residual_parts;
mod residual_section;
mod screening_section;
mod seed_section;
mod surface_section;
mod validation_section;

use crate::{Error, StudyFile, StudyResult};
use material::Material;
use pictures::NamedPicture;
use report::Report;

/// The report in the making, with everything that it speaks of.
struct Page<'a> {
    /// The page.
    report: Report,
    /// The study.
    study: &'a StudyFile,
    /// Its result.
    result: &'a StudyResult,
    /// Bodies and records.
    material: &'a Material,
    /// The pictures.
    pictures: &'a [NamedPicture],
}

impl Page<'_> {
    /// Adds a chart, or says that it is not there.
    fn chart(&mut self, name: &str, caption: &str) {
        chart(&mut self.report, self.pictures, name, caption);
    }

    /// Adds a PNG picture, or says that it is not there.
    fn png(&mut self, name: &str, description: &str, caption: &str) -> Result<(), Error> {
        match pictures::png(self.pictures, name) {
            Some(bytes) => self.report.picture(bytes, description, caption)?,
            None => self.report.paragraph(&missing(name)),
        };
        Ok(())
    }
}

/// Adds a chart, or says that it is not there.
fn chart(report: &mut Report, pictures: &[NamedPicture], name: &str, caption: &str) {
    match pictures::chart(pictures, name) {
        Some(svg) => report.figure(svg, caption),
        None => report.paragraph(&missing(name)),
    };
}

/// What stands for a picture that could not be made.
fn missing(name: &str) -> String {
    format!("Picture {name}: left out, because no run of this study gives what it needs.")
}

/// Makes the page as HTML.
pub(crate) fn page(
    study: &StudyFile,
    result: &StudyResult,
    material: &Material,
    pictures: &[NamedPicture],
) -> Result<String, Error> {
    let title = format!(
        "Calibration study {}, profile {}",
        result.name, result.profile
    );
    let mut page = Page {
        report: Report::new(title),
        study,
        result,
        material,
        pictures,
    };
    opening_section::add(&mut page)?;
    seed_section::add(&mut page)?;
    screening_section::add(&mut page)?;
    surface_section::add(&mut page)?;
    validation_section::add(&mut page)?;
    point_sections::add(&mut page)?;
    bench_section::add(&mut page)?;
    campaign_section::add(&mut page)?;
    closing_section::add(&mut page);
    Ok(page.report.html())
}
