//! The cells of a sheet as a table.
//!
//! The first row with cells holds the column names. Empty rows and rows whose first cell begins with `#` are skipped, as in
//! CSV text. Cells are told apart by their content, never by their look: a number keeps all its digits, a date is text.

use crate::workbook::Workbook;
use calamine::{DataRef, Dimensions, ExcelDateTime};
use experiment_design::table::{Table, cell_name};
use std::collections::BTreeMap;

/// Most cells of a table, empty ones included: our choice, 1.2 GB of texts. A few bytes of a file can claim more.
const MOST_CELLS: usize = 50_000_000;

/// The cells of a sheet that hold something, by row and column, from 0.
pub(crate) type Cells = BTreeMap<u32, BTreeMap<u32, String>>;

/// Reads the cells of a sheet that hold something.
pub(crate) fn cells(workbook: &mut Workbook<'_>, name: &str) -> Result<Cells, String> {
    let damaged = |error: calamine::XlsxError| {
        format!("sheet '{name}' cannot be read ({error}); save the workbook again")
    };
    let mut reader = workbook.worksheet_cells_reader(name).map_err(damaged)?;
    let mut cells = Cells::new();
    while let Some(cell) = reader.next_cell_with_formula_metadata().map_err(damaged)? {
        let (row, column) = cell.pos;
        let text = text(&cell.value);
        if cell.formula.is_some() && matches!(cell.value, DataRef::Empty) {
            return Err(format!(
                "sheet '{name}', cell {}: a formula without its value; open the workbook in a spreadsheet program and save it",
                cell_name(row as usize + 1, column as usize)
            ));
        }
        if !text.trim().is_empty() {
            cells.entry(row).or_default().insert(column, text);
        }
    }
    cells.retain(|_, row| {
        let first = row.values().next();
        // `#N/A` and its like are errors of a cell, no comments.
        first.is_none_or(|text| !text.starts_with('#') || is_error(text))
    });
    Ok(cells)
}

/// The table in the cells of a sheet.
pub(crate) fn table(
    workbook: &mut Workbook<'_>,
    name: &str,
    mut cells: Cells,
) -> Result<Table, String> {
    let Some((top, header)) = cells.pop_first() else {
        return Err(format!(
            "sheet '{name}' has no cells; it needs a row of column names and rows of values"
        ));
    };
    let first = header.first_key_value().map_or(0, |(column, _)| *column);
    let last = header.last_key_value().map_or(0, |(column, _)| *column);
    let place = |row: u32, column: u32| {
        format!(
            "sheet '{name}', cell {}",
            cell_name(row as usize + 1, column as usize)
        )
    };
    let bottom = cells.last_key_value().map_or(top, |(row, _)| *row);
    let merged = workbook.merge_cells_by_sheet_name(name);
    let merged = merged.map_err(|error| {
        format!("sheet '{name}' cannot be read ({error}); save the workbook again")
    })?;
    let meets = |area: &&Dimensions| {
        area.start != area.end
            && area.start.0 <= bottom
            && area.end.0 >= top
            && area.start.1 <= last
            && area.end.1 >= first
    };
    if let Some(area) = merged.iter().find(meets) {
        let end = cell_name(area.end.0 as usize + 1, area.end.1 as usize);
        return Err(format!(
            "{}: it is merged with the cells up to {end}; a table has one row of column names and one value in a cell: \
             unmerge them, or begin a row of titles with #",
            place(area.start.0, area.start.1)
        ));
    }
    for (&row, values) in &cells {
        if let Some((&column, text)) = values
            .iter()
            .find(|(column, _)| !header.contains_key(column))
        {
            return Err(format!(
                "{}: '{text}' has no column name above it in row {}; give it one, or move it to another sheet",
                place(row, column),
                top + 1
            ));
        }
    }
    let width = (last - first + 1) as usize;
    let count = width * (cells.len() + 1);
    if count > MOST_CELLS {
        return Err(format!(
            "sheet '{name}' has {count} cells; at most {MOST_CELLS} are read"
        ));
    }
    let rows = [(top, header)].into_iter().chain(cells);
    let rows = rows.map(|(row, mut values)| {
        let fields = (first..=last).map(|column| values.remove(&column).unwrap_or_default());
        (row as usize + 1, fields.collect())
    });
    Table::of_cells(name, first as usize, rows).map_err(|error| format!("sheet '{name}': {error}"))
}

/// The content of a cell as text; a number reads back bit for bit.
fn text(value: &DataRef<'_>) -> String {
    match value {
        DataRef::Empty => String::new(),
        DataRef::Int(value) => value.to_string(),
        DataRef::Float(value) => value.to_string(),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
            text.clone()
        }
        DataRef::SharedString(text) => (*text).to_owned(),
        DataRef::Bool(value) => value.to_string(),
        DataRef::DateTime(value) => date(value),
        DataRef::Error(error) => error.to_string(),
    }
}

/// Whether a text is the error of a cell, such as `#DIV/0!`.
fn is_error(text: &str) -> bool {
    let ends = text.ends_with(['!', '?']) || ["#N/A", "#GETTING_DATA", "#DATA!"].contains(&text);
    ends && !text.contains(' ')
}

/// A date as text, so that no column of numbers takes it for one: ISO 8601, a duration in days with the word behind.
fn date(value: &ExcelDateTime) -> String {
    if value.is_duration() {
        return format!("{} days", value.as_f64());
    }
    let (year, month, day, hour, minute, second, milli) = value.to_ymd_hms_milli();
    let date = format!("{year:04}-{month:02}-{day:02}");
    match (hour, minute, second, milli) {
        (0, 0, 0, 0) => date,
        (_, _, _, 0) => format!("{date}T{hour:02}:{minute:02}:{second:02}"),
        _ => format!("{date}T{hour:02}:{minute:02}:{second:02}.{milli:03}"),
    }
}
