//! Writing the result folder.

use crate::report_page::material::Material;
use crate::report_page::pictures::{NamedPicture, Picture, campaign_charts, pictures};
use crate::tables::CsvTable;
use crate::{DiagnosisResult, Error, StudyFile, StudyResult, report_page, tables};
use std::fs::File;
use std::io::Write as _;
use std::path::Path;

/// Writes the result of a study into its folder, each file whole or not at all.
///
/// - `result.json`: everything, with full precision; what is undefined is null.
/// - `report.html`: the report, one file that opens without a network.
/// - `pictures/`: the pictures of the report as files.
/// - `tables/`: the numbers behind them as CSV.
///
/// Frames and series are read from the records in `folder/runs`; a picture whose record is not
/// there is left out. The seeds are filled once more for their pictures.
///
/// # Errors
///
/// A file that cannot be written, a record that is damaged, a picture that cannot be made.
pub fn write_results(folder: &Path, study: &StudyFile, result: &StudyResult) -> Result<(), Error> {
    let material = Material::collect(folder, study, result)?;
    let pictures = pictures(study, result, &material)?;
    let page = report_page::page(study, result, &material, &pictures)?;
    write_parts(folder, &pictures, &tables::tables(study, result))?;
    write_json(folder, "result.json", result)?;
    write_whole(&folder.join("report.html"), page.as_bytes())
}

/// Writes the result of a diagnosis into its folder, each file whole or not at all.
///
/// - `result.json`, `report.html`, `pictures/`, `tables/`: as those of a study.
/// - `problem.json`: the residual with covariances and sensitivities, for anyone's statistics.
///
/// # Errors
///
/// A file that cannot be written, a chart that cannot be drawn.
pub fn write_diagnosis(folder: &Path, result: &DiagnosisResult) -> Result<(), Error> {
    let pictures = campaign_charts::charts("diagnosis", &result.study)?;
    let page = report_page::diagnosis_page::page(result, &pictures)?;
    let tables = tables::residual_tables::all("diagnosis", &result.study);
    write_parts(folder, &pictures, &tables)?;
    write_json(folder, "problem.json", &result.study.problem)?;
    write_json(folder, "result.json", result)?;
    write_whole(&folder.join("report.html"), page.as_bytes())
}

/// Writes pictures and tables into folders of their own.
fn write_parts(folder: &Path, pictures: &[NamedPicture], tables: &[CsvTable]) -> Result<(), Error> {
    for part in ["pictures", "tables"] {
        make_folder(&folder.join(part))?;
    }
    for named in pictures {
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

/// Writes a result as JSON; numbers that are not finite become null.
fn write_json(folder: &Path, name: &str, result: &impl serde::Serialize) -> Result<(), Error> {
    let mut bytes = serde_json::to_vec_pretty(result).map_err(|source| Error::Text {
        file: name.into(),
        message: source.to_string(),
    })?;
    bytes.push(b'\n');
    write_whole(&folder.join(name), &bytes)
}

/// Makes a folder where it is missing.
fn make_folder(path: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(path).map_err(refused(path))
}

/// Writes a file aside, forces it to the disk, and renames it over its name.
fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let aside = path.with_file_name(format!(".{name}.{}.aside", std::process::id()));
    let written = File::create(&aside)
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
        what: "write",
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
        let folder = std::env::temp_dir().join(format!("study-{name}-{}", std::process::id()));
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
        assert!(matches!(&error, Error::File { what: "write", path: named, .. } if *named == path));
        assert_eq!(
            std::fs::read_dir(&folder).expect("listed").count(),
            1,
            "no aside file"
        );
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
