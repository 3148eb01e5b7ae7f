//! Tables of text fields, from CSV text or from the cells of a sheet.

use super::dialect;
use super::records::Records;
use crate::Error;

/// A table of text fields with named columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Line of the header in the text, from 1.
    header_line: usize,
    /// Column names.
    header: Vec<String>,
    /// Rows, each with as many fields as the header.
    rows: Vec<Row>,
    /// The sheet of a workbook that the table stands in; none for text.
    sheet: Option<Sheet>,
}

/// Where in a workbook a table stands.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Sheet {
    /// Name of the sheet.
    name: String,
    /// Column of the sheet in which the first column of the table stands, from 0.
    first_column: usize,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Line in the text or row of the sheet, from 1.
    line: usize,
    /// The fields without their quotes.
    fields: Vec<String>,
}

impl Row {
    /// Line in the text or row of the sheet, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The field in a column, trimmed; empty beyond the last column.
    pub fn text(&self, column: usize) -> &str {
        self.fields.get(column).map_or("", |field| field.trim())
    }
}

impl Table {
    /// Reads a table from CSV text, separated by commas, or by semicolons or tabs where the header line has them; a first
    /// line `sep=;` names another separator. Without commas as separators, numbers may have decimal commas, unless any number
    /// of the table has a point. Lines without any text in their fields are skipped: spreadsheets write them for empty rows.
    ///
    /// # Errors
    /// [`Error::NotText`], [`Error::EmptyTable`], [`Error::FieldCount`], [`Error::OpenQuote`].
    pub fn parse(text: &str) -> Result<Self, Error> {
        if text.contains('\0') {
            return Err(Error::NotText);
        }
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut rows = Vec::new();
        let mut separator = None;
        let mut records = Records::new(text);
        while let Some((line_number, line)) = records.line() {
            if line.trim().is_empty() || line.starts_with('#') {
                records.skip_line();
                continue;
            }
            if separator.is_none()
                && let Some(named) = dialect::named_separator(line)
            {
                separator = Some(named);
                records.skip_line();
                continue;
            }
            let by = *separator.get_or_insert_with(|| dialect::separator(line));
            let fields = records.take(by);
            let fields = fields.ok_or(Error::OpenQuote { line: line_number })?;
            let fields = fields
                .iter()
                .map(|field| dialect::as_meant(field).to_owned());
            let fields: Vec<String> = fields.collect();
            if fields.iter().any(|field| !field.trim().is_empty()) {
                rows.push(Row {
                    line: line_number,
                    fields,
                });
            }
        }
        let pointed = |row: &Row| {
            row.fields
                .iter()
                .any(|field| dialect::has_decimal_point(field))
        };
        if separator.is_some_and(|c| c != ',') && !rows.iter().skip(1).any(pointed) {
            for field in rows.iter_mut().skip(1).flat_map(|row| &mut row.fields) {
                if let Some(number) = dialect::with_decimal_point(field) {
                    *field = number;
                }
            }
        }
        Self::of_rows(rows, None)
    }

    /// A table from the rows of a sheet, the first of them the column names: each row with its number in the sheet, from 1,
    /// and its cells as text. `first_column` is the column of the sheet, from 0, in which they begin.
    ///
    /// # Errors
    /// [`Error::EmptyTable`], [`Error::FieldCount`].
    pub fn of_cells(
        sheet: &str,
        first_column: usize,
        rows: impl IntoIterator<Item = (usize, Vec<String>)>,
    ) -> Result<Self, Error> {
        let rows = rows.into_iter().map(|(line, fields)| Row { line, fields });
        let sheet = Sheet {
            name: sheet.to_owned(),
            first_column,
        };
        Self::of_rows(rows.collect(), Some(sheet))
    }

    /// A table from its rows, the first of them the column names.
    fn of_rows(mut rows: Vec<Row>, sheet: Option<Sheet>) -> Result<Self, Error> {
        if rows.is_empty() {
            return Err(Error::EmptyTable { what: "header" });
        }
        let first = rows.remove(0);
        let header_line = first.line;
        let names = first.fields.iter();
        let header: Vec<String> = names.map(|name| name.trim().to_owned()).collect();
        if rows.is_empty() {
            return Err(Error::EmptyTable { what: "rows" });
        }
        match rows.iter().find(|row| row.fields.len() != header.len()) {
            Some(row) => Err(Error::FieldCount {
                line: row.line,
                expected: header.len(),
                given: row.fields.len(),
            }),
            None => Ok(Self {
                header_line,
                header,
                rows,
                sheet,
            }),
        }
    }

    /// Where a field stands, in words: its line and column, or its sheet and cell.
    pub fn place(&self, row: &Row, column: usize) -> String {
        format!(
            "{}, {}",
            self.place_of_row(row),
            self.place_in_row(row, column)
        )
    }

    /// Where a row stands, in words.
    pub fn place_of_row(&self, row: &Row) -> String {
        match &self.sheet {
            None => format!("line {}", row.line),
            Some(sheet) => format!("sheet '{}', row {}", sheet.name, row.line),
        }
    }

    /// The place of a field in its row, in words: its column, and its cell in a sheet.
    pub fn place_in_row(&self, row: &Row, column: usize) -> String {
        let name = self.header.get(column).map_or("", String::as_str);
        self.sheet.as_ref().map_or_else(
            || format!("column '{name}'"),
            |sheet| {
                let cell = cell_name(row.line, sheet.first_column + column);
                format!("cell {cell}, column '{name}'")
            },
        )
    }

    /// Line of the header in the text or its row in the sheet, from 1.
    pub fn header_line(&self) -> usize {
        self.header_line
    }

    /// Column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The rows in their order.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Index of the column with this name; where there is none, of the only column that has the
    /// name and a unit after it (`theta` finds `theta_deg`).
    ///
    /// # Errors
    /// [`Error::MissingColumn`], [`Error::DuplicateColumn`] or [`Error::AmbiguousColumn`].
    pub fn column(&self, name: &str) -> Result<usize, Error> {
        let places = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
            let named = self.header.iter().enumerate();
            named
                .filter(|(_, column)| fits(column))
                .map(|(i, _)| i)
                .collect()
        };
        let with_unit = |column: &str| {
            let rest = column
                .strip_prefix(name)
                .and_then(|rest| rest.strip_prefix('_'));
            rest.is_some_and(|unit| {
                !unit.is_empty() && !unit.contains('_') && !["natural", "sd", "n"].contains(&unit)
            })
        };
        let mut found = places(&|column| column == name);
        if found.is_empty() && !name.is_empty() {
            found = places(&with_unit);
        }
        match found[..] {
            [column] => Ok(column),
            [first, second, ..] if self.header[first] == self.header[second] => {
                Err(Error::DuplicateColumn {
                    column: self.header[first].clone(),
                    count: found.len(),
                })
            }
            [] => Err(Error::MissingColumn {
                column: name.to_owned(),
                available: self.header.join(", "),
            }),
            _ => Err(Error::AmbiguousColumn {
                column: name.to_owned(),
                candidates: found
                    .iter()
                    .map(|&i| &*self.header[i])
                    .collect::<Vec<_>>()
                    .join(", "),
            }),
        }
    }

    /// The field of a row as a finite number.
    ///
    /// # Errors
    /// [`Error::BadNumber`].
    pub fn number(&self, row: &Row, column: usize) -> Result<f64, Error> {
        let parsed = row
            .text(column)
            .parse()
            .ok()
            .filter(|x: &f64| x.is_finite());
        parsed.ok_or_else(|| self.bad_number(row, column))
    }

    /// The field of a row as a finite number, or nothing if the field is empty.
    ///
    /// # Errors
    /// [`Error::BadNumber`].
    pub fn optional_number(&self, row: &Row, column: usize) -> Result<Option<f64>, Error> {
        if row.text(column).is_empty() {
            return Ok(None);
        }
        self.number(row, column).map(Some)
    }

    /// The field of a row in the named column as a whole number of at least 1; nothing if there
    /// is no such column.
    ///
    /// # Errors
    /// [`Error::BadNumber`].
    pub fn count(&self, row: &Row, name: &str) -> Result<Option<usize>, Error> {
        let Some(column) = self.header.iter().position(|column| column == name) else {
            return Ok(None);
        };
        let parsed = row.text(column).parse().ok().filter(|&n: &usize| n >= 1);
        parsed.map(Some).ok_or_else(|| self.bad_number(row, column))
    }

    /// The error of a field that is not the number it should be.
    fn bad_number(&self, row: &Row, column: usize) -> Error {
        Error::BadNumber {
            place: self.place(row, column),
            text: row.text(column).to_owned(),
        }
    }
}

/// The name of a cell as spreadsheets show it, B7: `row` from 1, `column` from 0.
pub fn cell_name(row: usize, column: usize) -> String {
    let mut letters = Vec::new();
    let mut rest = column + 1;
    while rest > 0 {
        // Columns count with the 26 letters and no zero: Z is followed by AA.
        let letter = u8::try_from((rest - 1) % 26).unwrap_or_default();
        letters.push(char::from(b'A' + letter));
        rest = (rest - 1) / 26;
    }
    let letters: String = letters.into_iter().rev().collect();
    format!("{letters}{row}")
}

#[cfg(test)]
mod tests {
    use super::{Table, cell_name};
    use crate::Error;

    /// Columns of a spreadsheet are A to Z, AA to ZZ, AAA to XFD, which is the last of 16 384.
    #[test]
    fn cells_have_the_names_of_spreadsheets() {
        for (column, name) in [
            (0, "A7"),
            (25, "Z7"),
            (26, "AA7"),
            (701, "ZZ7"),
            (16_383, "XFD7"),
        ] {
            assert_eq!(cell_name(7, column), name);
        }
    }

    /// The table begins in column C of the sheet: its second column is D.
    #[test]
    fn a_field_of_a_sheet_is_told_with_its_cell() {
        let row = |line, fields: [&str; 2]| (line, fields.map(str::to_owned).to_vec());
        let rows = [row(3, ["B", "theta_deg"]), row(7, ["1", "about 36"])];
        let table = Table::of_cells("Runs", 2, rows).unwrap();
        let told = table.number(&table.rows()[0], 1).unwrap_err().to_string();
        assert!(
            told.contains("sheet 'Runs', row 7, cell D7, column 'theta_deg': 'about 36'"),
            "{told}"
        );
    }

    #[test]
    fn a_name_finds_its_column_with_a_unit_but_not_its_standard_deviation() {
        let table = Table::parse("run,theta_deg,theta_sd_deg,n\n1,36,1.2,5\n").unwrap();
        assert_eq!(table.column("theta"), Ok(1));
        assert_eq!(table.column("theta_sd"), Ok(2));
        assert!(matches!(
            table.column("alpha"),
            Err(Error::MissingColumn { .. })
        ));
        let two = Table::parse("theta_deg,theta_rad\n1,2\n").unwrap();
        assert!(matches!(
            two.column("theta"),
            Err(Error::AmbiguousColumn { .. })
        ));
    }

    #[test]
    fn quotes_comments_and_windows_line_ends_are_understood() {
        let table = Table::parse("# note\r\na,b\r\n\"1, \"\"x\"\"\",2\r\n\r\n").unwrap();
        assert_eq!(table.header_line(), 2);
        assert_eq!(table.rows()[0].text(0), "1, \"x\"");
        assert_eq!(table.number(&table.rows()[0], 1), Ok(2.0));
        assert_eq!(table.rows()[0].line(), 3);
    }
}
