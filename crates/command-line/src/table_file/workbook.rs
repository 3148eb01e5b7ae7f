//! The sheet of a workbook that is read.

use crate::table_file::{inflated, sheet};
use calamine::{Reader as _, SheetType, SheetVisible, Xlsx};
use experiment_design::table::Table;
use std::io::Cursor;
use std::path::Path;

/// The open workbook.
pub(crate) type Workbook<'a> = Xlsx<Cursor<&'a [u8]>>;

/// The table in a workbook: in the sheet that is named, or in the only visible one with cells.
pub(crate) fn table(bytes: &[u8], file: &Path, named: Option<&str>) -> Result<Table, String> {
    inflated::check(bytes)?;
    let mut workbook: Workbook<'_> = Xlsx::new(Cursor::new(bytes)).map_err(|error| {
        format!("it is an archive, but not a readable Excel workbook ({error}); save it as .xlsx")
    })?;
    let sheets = workbook.sheets_metadata().iter();
    let sheets = sheets.filter(|sheet| sheet.typ == SheetType::WorkSheet);
    // Of all sheets together: many names may lead to one part.
    let mut room = sheet::Room::default();
    let sheets: Vec<(String, bool)> = sheets
        .map(|sheet| (sheet.name.clone(), sheet.visible == SheetVisible::Visible))
        .collect();
    if let Some(named) = named {
        let Some((name, _)) = sheets.iter().find(|(name, _)| name == named) else {
            let names = quoted(sheets.iter().map(|(name, _)| name));
            return Err(format!("it has no sheet '{named}'; its sheets are {names}"));
        };
        let cells = sheet::cells(&mut workbook, name, &mut room)?;
        return sheet::table(&mut workbook, name, cells);
    }
    let mut filled = Vec::new();
    for (name, _) in sheets.into_iter().filter(|(_, visible)| *visible) {
        let cells = sheet::cells(&mut workbook, &name, &mut room)?;
        if !cells.is_empty() {
            filled.push((name, cells));
        }
    }
    match filled.len() {
        0 => Err(
            "no visible sheet has cells; it needs a row of column names and rows of values"
                .to_owned(),
        ),
        1 => {
            let (name, cells) = filled.remove(0);
            sheet::table(&mut workbook, &name, cells)
        }
        n => Err(format!(
            "it has {n} sheets with cells, {}; name one of them, such as '{}#{}'",
            quoted(filled.iter().map(|(name, _)| name)),
            file.display(),
            filled[0].0
        )),
    }
}

/// Names in quotes with commas between them.
fn quoted<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<String> = names.map(|name| format!("'{name}'")).collect();
    names.join(", ")
}
