//! Writing the files of a report.

use crate::page::{diagnosis_page, study_page};
use crate::pictures::{NamedPicture, Picture, pictures, residual_charts};
use crate::tables::{CsvTable, residual_tables, tables};
use crate::{DiagnosisInput, Error, ReportInput};
use std::fs::File;
use std::io::Write as _;
use std::path::Path;

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
    write_whole(&folder.join("report.html"), page.as_bytes())
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
    write_whole(&folder.join("report.html"), page.as_bytes())
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
            Picture::Chart(svg) => write_whole(&path, svg.as_str().as_bytes())?,
            Picture::Png(bytes) => write_whole(&path, bytes)?,
        }
    }
    for table in tables {
        let path = folder.join("tables").join(table.file_name());
        write_whole(&path, table.text().as_bytes())?;
    }
    Ok(())
}

/// Writes a file aside, forces it to the disk, and renames it over its name: whoever looks finds the file of before or
/// the whole new one.
///
/// # Errors
///
/// [`Error::File`] where the folder is missing or full, or something else stands under the name.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let aside = path.with_file_name(format!(".{name}.{}.aside", std::process::id()));
    // What a process of this number left behind, or a link that somebody planted, is not written through.
    let _ = std::fs::remove_file(&aside);
    let written = File::create_new(&aside)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&aside, path));
    if written.is_err() {
        // The file under its own name is as before; what was written aside is of no use.
        let _ = std::fs::remove_file(&aside);
    }
    written.map_err(refused(path))
}

/// Makes an error of a file that cannot be written.
fn refused(path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    move |source| Error::File {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::write_whole;
    use crate::Error;

    /// A folder of its own under the system's temporary folder.
    fn folder(name: &str) -> std::path::PathBuf {
        let folder =
            std::env::temp_dir().join(format!("study-report-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        folder
    }

    #[test]
    fn a_written_file_replaces_the_old_one_and_leaves_nothing_beside_it() {
        let folder = folder("whole");
        let path = folder.join("result.json");
        for text in ["first, and longer", "second"] {
            write_whole(&path, text.as_bytes()).expect("written");
            assert_eq!(std::fs::read_to_string(&path).expect("read"), text);
        }
        assert_eq!(std::fs::read_dir(&folder).expect("listed").count(), 1);
        std::fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn a_write_that_fails_leaves_no_piece_behind_and_names_the_file() {
        let folder = folder("failing");
        // A folder with content stands under the name: the rename is refused at the last step.
        let path = folder.join("report.html");
        std::fs::create_dir_all(path.join("occupied")).expect("made");
        let error = write_whole(&path, b"text").expect_err("refused");
        assert!(matches!(&error, Error::File { path: named, .. } if *named == path));
        assert_eq!(
            std::fs::read_dir(&folder).expect("listed").count(),
            1,
            "no aside file"
        );
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
