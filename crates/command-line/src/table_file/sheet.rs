//! The cells of a sheet as a table.
//!
//! The first row with cells holds the column names. Empty rows and rows whose first cell begins with `#` are skipped, as in
//! CSV text. The type of a cell follows its content, never its format: a number keeps all its digits, a date is text.

use crate::table_file::workbook::Workbook;
use calamine::{DataRef, Dimensions, ExcelDateTime};
use experiment_design::Error;
use experiment_design::table::{Table, cell_name, is_row_index};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Most cells of a table, empty ones included (our choice): 4 bytes each. A few bytes of a file can claim more.
const MOST_CELLS: usize = 50_000_000;

/// Remaining memory for all cells that are not empty.
#[derive(Debug)]
pub(crate) struct Room {
    /// Number of cells.
    cells: usize,
    /// Bytes of their texts. A text that many cells share is one in the file and many in the table.
    bytes: usize,
}

/// Our choice: a million runs of five columns.
const MOST_FILLED: usize = 5_000_000;
/// Our choice: 25 bytes for each of them, as in the longest numbers.
const MOST_TEXT: usize = 1 << 27;

impl Default for Room {
    fn default() -> Self {
        Self {
            cells: MOST_FILLED,
            bytes: MOST_TEXT,
        }
    }
}

impl Room {
    /// Reserves memory for a cell; `None` if no more is left.
    fn take(&mut self, bytes: usize) -> Option<()> {
        self.cells = self.cells.checked_sub(1)?;
        self.bytes = self.bytes.checked_sub(bytes)?;
        Some(())
    }
}

/// The cells of a row that hold something: columns, from 0 and ascending, and texts.
type Filled = Vec<(u32, String)>;

/// The cells of a sheet that hold something, by row, from 0.
pub(crate) type Cells = BTreeMap<u32, Filled>;

/// Reads the cells of a sheet that hold something.
pub(crate) fn cells(
    workbook: &mut Workbook<'_>,
    name: &str,
    room: &mut Room,
) -> Result<Cells, String> {
    let damaged = |error: calamine::XlsxError| {
        format!("sheet '{name}' cannot be read ({error}); save the workbook again")
    };
    let mut reader = workbook.worksheet_cells_reader(name).map_err(damaged)?;
    let mut cells = Cells::new();
    while let Some(cell) = reader.next_cell_with_formula_metadata().map_err(damaged)? {
        let (row, column) = cell.pos;
        if cell.formula.is_some() && matches!(cell.value, DataRef::Empty) {
            return Err(format!(
                "sheet '{name}', cell {}: a formula without its value; open the workbook in a spreadsheet program and save it",
                cell_name(row as usize + 1, column as usize)
            ));
        }
        let text = text(&cell.value);
        if !text.trim().is_empty() {
            room.take(text.len()).ok_or_else(|| {
                format!(
                    "sheet '{name}', cell {}: here the workbook exceeds {MOST_FILLED} cells or {MOST_TEXT} bytes of text; at \
                     most so many are read",
                    cell_name(row as usize + 1, column as usize)
                )
            })?;
            cells
                .entry(row)
                .or_default()
                .push((column, text.into_owned()));
        }
    }
    for row in cells.values_mut() {
        // A cell that is written twice holds what comes last.
        row.reverse();
        row.sort_by_key(|(column, _)| *column);
        row.dedup_by_key(|(column, _)| *column);
    }
    cells.retain(|_, row| {
        let first = row.first();
        // `#N/A` and its like are errors of a cell, no comments.
        first.is_none_or(|(_, text)| !text.starts_with('#') || is_error(text))
    });
    Ok(cells)
}

/// A cell of a sheet, as messages name it.
fn place(sheet: &str, (row, column): (u32, u32)) -> String {
    let cell = cell_name(row as usize + 1, column as usize);
    format!("sheet '{sheet}', cell {cell}")
}

/// Refuses merged cells in the area of a table.
fn refuse_merged(
    workbook: &mut Workbook<'_>,
    name: &str,
    table: &Dimensions,
) -> Result<(), String> {
    let merged = workbook.merge_cells_by_sheet_name(name);
    let merged = merged.map_err(|error| {
        format!("sheet '{name}' cannot be read ({error}); save the workbook again")
    })?;
    let meets = |area: &&Dimensions| {
        area.start != area.end
            && area.start.0 <= table.end.0
            && area.end.0 >= table.start.0
            && area.start.1 <= table.end.1
            && area.end.1 >= table.start.1
    };
    merged.iter().find(meets).map_or(Ok(()), |area| {
        let end = cell_name(area.end.0 as usize + 1, area.end.1 as usize);
        Err(format!(
            "{}: it is merged with the cells up to {end}; a table has one row of column names and one value in a cell: \
             unmerge them, or begin a row of titles with #",
            place(name, area.start)
        ))
    })
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
    let [mut first, last] = [header.first(), header.last()].map(|cell| cell.map_or(0, |c| c.0));
    // The numbers of the rows that a program writes before a table have no name.
    let leftmost = cells.values().filter_map(|row| Some(row.first()?.0)).min();
    if let Some(left) = leftmost.filter(|left| *left < first) {
        let index = cells.values().map(|row| match row.first() {
            Some((column, text)) if *column == left => text.as_str(),
            _ => "",
        });
        if is_row_index(index) {
            first = left;
        }
    }
    let bottom = cells.last_key_value().map_or(top, |(row, _)| *row);
    refuse_merged(
        workbook,
        name,
        &Dimensions::new((top, first), (bottom, last)),
    )?;
    for (&row, values) in &cells {
        let unnamed = |(column, _): &&(u32, String)| {
            header
                .binary_search_by_key(column, |(own, _)| *own)
                .is_err()
                && !(*column == first && header[0].0 != first)
        };
        if let Some((column, text)) = values.iter().find(unnamed) {
            return Err(format!(
                "{}: '{text}' has no column name above it in row {}; give it one, move it to another sheet, or begin a row \
                 of titles above the names with #",
                place(name, (row, *column)),
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
    let rows = rows.map(|(row, values)| {
        let mut fields = vec![String::new(); width];
        for (column, text) in values {
            fields[(column - first) as usize] = text;
        }
        (row as usize + 1, fields)
    });
    Table::of_cells(name, first as usize, rows).map_err(|error| match error {
        Error::SummaryRow { .. } => error.to_string(),
        error => format!("sheet '{name}': {error}"),
    })
}

/// The content of a cell as text; a number reads back bit for bit.
fn text<'a>(value: &'a DataRef<'_>) -> Cow<'a, str> {
    let owned = match value {
        DataRef::Empty => return Cow::Borrowed(""),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
            return Cow::Borrowed(text);
        }
        DataRef::SharedString(text) => return Cow::Borrowed(text),
        DataRef::Int(value) => value.to_string(),
        DataRef::Float(value) => value.to_string(),
        DataRef::Bool(value) => value.to_string(),
        DataRef::DateTime(value) => date(value),
        DataRef::Error(error) => error.to_string(),
    };
    Cow::Owned(owned)
}

/// Whether a text is the error of a cell, such as `#DIV/0!`.
fn is_error(text: &str) -> bool {
    let ends = text.ends_with(['!', '?']) || ["#N/A", "#GETTING_DATA", "#DATA!"].contains(&text);
    ends && !text.contains(' ')
}

/// A date as text, so that it is not read as a number: ISO 8601, a duration in days with the word behind.
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
