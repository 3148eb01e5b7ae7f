//! Writing the files of a report.

use crate::page::{diagnosis_page, study_page};
use crate::pictures::{NamedPicture, Picture, pictures, residual_charts};
use crate::tables::{CsvTable, residual_tables, tables};
use crate::{DiagnosisInput, Error, ReportInput};
use std::path::Path;

/// Name of the page.
pub(crate) const PAGE: &str = "report.html";

/// Name of everything that belongs to the study of the residual.
pub(crate) const DIAGNOSIS: &str = "diagnosis";

/// Which files a report is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The page alone.
    Page,
    /// The page, and each of its pictures and tables as a file.
    WithParts,
}

impl Extent {
    /// With parts where they are wanted.
    pub fn with_parts(wanted: bool) -> Self {
        if wanted { Self::WithParts } else { Self::Page }
    }
}

/// Writes the report of a calibration into a folder, each file whole or not at all.
///
/// - `report.html`: the report, one file that opens without a network.
/// - with [`Extent::WithParts`] also `pictures/`, the pictures of the report as files, and `tables/`, the numbers behind them as
///   CSV, in full precision.
///
/// # Errors
///
/// A file that cannot be written, a frame that is damaged, a chart that cannot be drawn, a seed that has no body.
pub fn write(folder: &Path, input: &ReportInput<'_>, extent: Extent) -> Result<(), Error> {
    let pictures = pictures(input)?;
    let page = study_page(input, &pictures)?;
    if extent == Extent::WithParts {
        write_parts(folder, &pictures, &tables(input)?)?;
    }
    put(&folder.join(PAGE), page.as_bytes())
}

/// Writes the report of a diagnosis alone into a folder: the same files as those of a calibration.
///
/// # Errors
///
/// A file that cannot be written, a chart that cannot be drawn.
pub fn write_diagnosis(
    folder: &Path,
    input: &DiagnosisInput<'_>,
    extent: Extent,
) -> Result<(), Error> {
    let pictures = residual_charts::charts(DIAGNOSIS, input.study)?;
    let page = diagnosis_page::page(input, &pictures)?;
    if extent == Extent::WithParts {
        let tables = residual_tables::all(DIAGNOSIS, input.study, input.parameters);
        write_parts(folder, &pictures, &tables)?;
    }
    put(&folder.join(PAGE), page.as_bytes())
}

/// Writes pictures and tables into folders of their own.
fn write_parts(folder: &Path, pictures: &[NamedPicture], tables: &[CsvTable]) -> Result<(), Error> {
    for part in ["pictures", "tables"] {
        let path = folder.join(part);
        std::fs::create_dir_all(&path).map_err(refused(&path))?;
    }
    for named in pictures.iter().filter(|named| named.is_file) {
        let path = folder.join("pictures").join(named.file_name());
        match &named.picture {
            Picture::Chart(svg) => put(&path, svg.as_str().as_bytes())?,
            Picture::Png(bytes) => put(&path, bytes)?,
        }
    }
    for table in tables {
        let path = folder.join("tables").join(table.file_name());
        put(&path, table.text().as_bytes())?;
    }
    Ok(())
}

/// Writes a file, whole or not at all.
fn put(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    campaign::run_store::write_whole(path, bytes).map_err(refused(path))
}

/// Makes an error of a file that cannot be written.
fn refused(path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    move |source| Error::File {
        path: path.to_owned(),
        source,
    }
}
