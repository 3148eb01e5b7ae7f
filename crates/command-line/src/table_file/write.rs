//! Writing a table.

use crate::table_file::Error;
use crate::table_file::names::is_workbook_name;
use experiment_design::table::Table;
use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, XlsxError};
use std::path::Path;

/// The bytes of a table for a file of this name: an Excel workbook if it ends in `.xlsx`, otherwise the unchanged CSV text.
///
/// # Errors
/// A text that is not a table, a table larger than a sheet, or another extension of a workbook.
pub fn bytes_for(path: &Path, csv: &str) -> Result<Vec<u8>, Error> {
    if !is_workbook_name(path) {
        return Ok(csv.as_bytes().to_vec());
    }
    let refused = |what: String| Error::Workbook {
        path: path.to_owned(),
        what,
    };
    let ending = path.extension().unwrap_or_default();
    if !ending.eq_ignore_ascii_case("xlsx") {
        return Err(refused(
            "workbooks are written as .xlsx; give a name with this extension".to_owned(),
        ));
    }
    let table = Table::parse(csv).map_err(|source| Error::Table {
        path: path.to_owned(),
        source,
    })?;
    workbook(&table).map_err(|error| {
        refused(format!(
            "the table cannot be written as a workbook ({error}); write it as .csv"
        ))
    })
}

/// A workbook with one sheet, whose first row stays in view.
fn workbook(table: &Table) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    // The date of the writing would make every copy differ.
    let day = ExcelDateTime::from_ymd(2000, 1, 1)?;
    workbook.set_properties(&DocProperties::new().set_creation_datetime(&day));
    let sheet = workbook.add_worksheet();
    let bold = Format::new().set_bold();
    for (name, column) in table.header().iter().zip(0..) {
        sheet.write_string_with_format(0, column, name, &bold)?;
    }
    for (row, line) in table.rows().iter().zip(1..) {
        for (place, column) in (0..table.header().len()).zip(0..) {
            let text = row.text(place);
            match number(text) {
                Some(number) => sheet.write_number(line, column, number)?,
                None if text.is_empty() => continue,
                None => sheet.write_string(line, column, text)?,
            };
        }
    }
    sheet.set_freeze_panes(1, 0)?;
    sheet.autofit();
    workbook.save_to_buffer()
}

/// The number of a text that is written back as the same text; `None` for 007 or for more digits than a number holds.
fn number(text: &str) -> Option<f64> {
    let number: f64 = text
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())?;
    (text == number.to_string() || text == format!("{number:?}")).then_some(number)
}
