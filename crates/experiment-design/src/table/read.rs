//! Tables of text fields, from CSV text or from the cells of a sheet.

use std::borrow::Cow;

use super::dialect;
use super::records::{MOST_FIELDS, Records};
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
    /// The sheet of a workbook with the table; `None` for text.
    sheet: Option<Sheet>,
}

/// Place of a table in a workbook.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Sheet {
    /// Name of the sheet.
    name: String,
    /// Column of the sheet that holds the first column of the table, from 0.
    first_column: usize,
}

/// A row of a table. The fields are kept in one text: one text per field would take many times the size of a file of numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Line in the text or row of the sheet, from 1.
    line: usize,
    /// The fields without their quotes, one behind the other.
    text: Box<str>,
    /// Where each field ends in the text, bytes.
    ends: Box<[u32]>,
}

impl Row {
    /// A row of fields.
    fn new<T: AsRef<str>>(line: usize, fields: impl IntoIterator<Item = T>) -> Self {
        let (mut text, mut ends) = (String::new(), Vec::new());
        for field in fields {
            text.push_str(field.as_ref());
            // Tables of more bytes are not read.
            ends.push(u32::try_from(text.len()).unwrap_or(u32::MAX));
        }
        Self {
            line,
            text: text.into(),
            ends: ends.into(),
        }
    }

    /// Number of fields.
    fn len(&self) -> usize {
        self.ends.len()
    }

    /// An unchanged field; empty beyond the last.
    fn field(&self, column: usize) -> &str {
        let end = |i: usize| self.ends.get(i).map(|end| *end as usize);
        let start = column.checked_sub(1).map_or(Some(0), end);
        let range = start.zip(end(column)).map(|(start, end)| start..end);
        range.and_then(|range| self.text.get(range)).unwrap_or("")
    }

    /// The fields in their order.
    fn fields(&self) -> impl Iterator<Item = &str> {
        (0..self.len()).map(|column| self.field(column))
    }

    /// Line in the text or row of the sheet, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The field in a column, trimmed; empty beyond the last column.
    pub fn text(&self, column: usize) -> &str {
        self.field(column).trim()
    }
}

impl Table {
    /// Reads a table from CSV text, separated by commas, or by semicolons or tabs if the header line has them; a first
    /// line `sep=;` names another separator. Without commas as separators, numbers may have decimal commas, unless any number
    /// of the table has a point. Lines without any text in their fields are skipped: spreadsheets write them for empty rows.
    ///
    /// # Errors
    /// [`Error::NotText`], [`Error::TooLarge`], [`Error::EmptyTable`], [`Error::FieldCount`], [`Error::OpenQuote`],
    /// [`Error::SummaryRow`].
    pub fn parse(text: &str) -> Result<Self, Error> {
        if text.contains('\0') {
            return Err(Error::NotText);
        }
        let ends = |end: u8| text.bytes().filter(|byte| *byte == end).count();
        let lines = ends(b'\n').max(ends(b'\r'));
        if lines > MOST_LINES {
            return Err(Error::TooLarge {
                what: "lines",
                given: lines,
                most: MOST_LINES,
            });
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
            if fields.len() > MOST_FIELDS {
                return Err(Error::TooLarge {
                    what: "columns",
                    given: fields.len(),
                    most: MOST_FIELDS,
                });
            }
            if fields.iter().any(|field| !field.trim().is_empty()) {
                let fields = fields.iter().map(|field| dialect::as_meant(field));
                rows.push(Row::new(line_number, fields));
            }
        }
        let pointed = |row: &Row| row.fields().any(dialect::has_decimal_point);
        if separator.is_some_and(|c| c != ',') && !rows.iter().skip(1).any(pointed) {
            for row in rows.iter_mut().skip(1) {
                let point = |field| match dialect::with_decimal_point(field) {
                    Some(number) => Cow::Owned(number),
                    None => Cow::Borrowed(field),
                };
                *row = Row::new(row.line, row.fields().map(point));
            }
        }
        Self::of_rows(rows, None)
    }

    /// A table from the rows of a sheet, the first of them the column names: each row with its number in the sheet, from 1,
    /// and its cells as text. `first_column` is the column of the sheet, from 0, in which they begin.
    ///
    /// # Errors
    /// [`Error::EmptyTable`], [`Error::FieldCount`], [`Error::SummaryRow`].
    pub fn of_cells(
        sheet: &str,
        first_column: usize,
        rows: impl IntoIterator<Item = (usize, Vec<String>)>,
    ) -> Result<Self, Error> {
        let rows = rows
            .into_iter()
            .map(|(line, fields)| Row::new(line, fields));
        let sheet = Sheet {
            name: sheet.to_owned(),
            first_column,
        };
        Self::of_rows(rows.collect(), Some(sheet))
    }

    /// A table from its rows, the first of them the column names. A first column that only counts the rows is omitted.
    fn of_rows(mut rows: Vec<Row>, mut sheet: Option<Sheet>) -> Result<Self, Error> {
        if rows.is_empty() {
            return Err(Error::EmptyTable { what: "header" });
        }
        let first = rows.remove(0);
        let header_line = first.line;
        let words = |name: &str| name.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut header: Vec<String> = first.fields().map(words).collect();
        if rows.is_empty() {
            return Err(Error::EmptyTable { what: "rows" });
        }
        if let Some(row) = rows.iter().find(|row| row.len() != header.len()) {
            return Err(Error::FieldCount {
                line: row.line,
                expected: header.len(),
                given: row.len(),
            });
        }
        let unnamed = ["", "Unnamed: 0"].contains(&header[0].as_str());
        if unnamed && header.len() > 1 && is_row_index(rows.iter().map(|row| row.text(0))) {
            header.remove(0);
            for row in &mut rows {
                *row = Row::new(row.line, row.fields().skip(1));
            }
            if let Some(sheet) = &mut sheet {
                sheet.first_column += 1;
            }
        }
        let table = Self {
            header_line,
            header,
            rows,
            sheet,
        };
        table.check_summaries()?;
        Ok(table)
    }

    /// Refuses a row of totals or means: one with a word such as `total` in a column that otherwise contains numbers or nothing.
    fn check_summaries(&self) -> Result<(), Error> {
        for column in 0..self.header.len() {
            let mut rows = self.rows.iter();
            let Some(row) = rows.find(|row| is_summary(row.text(column))) else {
                continue;
            };
            let others = self.rows.iter().map(|row| row.text(column));
            let mut others = others.filter(|text| !is_summary(text)).peekable();
            let is_number = |text: &str| text.is_empty() || text.parse::<f64>().is_ok();
            if others.peek().is_some() && others.all(is_number) {
                return Err(Error::SummaryRow {
                    place: self.place(row, column),
                    text: row.text(column).to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Place of a field, as text: its line and column, or its sheet and cell.
    pub fn place(&self, row: &Row, column: usize) -> String {
        format!(
            "{}, {}",
            self.place_of_row(row),
            self.place_in_row(row, column)
        )
    }

    /// Place of a row, as text.
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

    /// Index of the column with this name; if there is none, of the only column that has the name and a unit after it
    /// (`theta` finds `theta_deg`, `theta (deg)` and `theta [deg]`).
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
            if split_unit(column).is_some_and(|(own, _)| own == name) {
                return true;
            }
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

    /// The error of a field that should be a number.
    fn bad_number(&self, row: &Row, column: usize) -> Error {
        Error::BadNumber {
            place: self.place(row, column),
            text: row.text(column).to_owned(),
        }
    }
}

/// A column name with its unit in brackets behind it, `Temp (deg C)` or `Temp [deg C]`, as both; `None` for any other name.
pub fn split_unit(column: &str) -> Option<(&str, &str)> {
    let brackets = [('(', ')'), ('[', ']')].into_iter();
    let mut parts = brackets.filter_map(|(open, close)| {
        let (name, unit) = column.strip_suffix(close)?.split_once(open)?;
        let (name, unit) = (name.trim(), unit.trim());
        (!name.is_empty() && !unit.is_empty()).then_some((name, unit))
    });
    parts.next()
}

/// Whether the texts of a column are whole numbers, each once: the numbers of the rows, which programs write without a name
/// before the columns of a table.
pub fn is_row_index<'a>(texts: impl Iterator<Item = &'a str>) -> bool {
    let numbers: Option<Vec<u64>> = texts.map(|text| text.trim().parse().ok()).collect();
    numbers.is_some_and(|mut numbers| {
        let count = numbers.len();
        numbers.sort_unstable();
        numbers.dedup();
        numbers.len() == count
    })
}

/// Words for rows of sums or means below a table.
const SUMMARIES: [&str; 18] = [
    "total",
    "totals",
    "sum",
    "mean",
    "average",
    "avg",
    "median",
    "sd",
    "std",
    "stdev",
    "std dev",
    "std. dev.",
    "standard deviation",
    "min",
    "max",
    "count",
    "summe",
    "mittelwert",
];

/// Whether a text is a word for such a row.
fn is_summary(text: &str) -> bool {
    let longest = 20;
    text.len() <= longest && {
        let word = text.trim_end_matches(':').trim().to_lowercase();
        SUMMARIES.contains(&word.as_str())
    }
}

/// Most lines of a text, comments included: the rows of a sheet of a workbook.
const MOST_LINES: usize = 1_048_576;

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

    /// The row numbers that pandas writes before a table are not read as a column, whatever the order of the rows and the
    /// name that it gives them when it reads its own file; other numbers without a name stay.
    #[test]
    fn a_first_column_that_counts_the_rows_is_left_out() {
        for text in [
            ",B,y\n0,1,36\n1,-1,35\n",
            ",B,y\n1,1,36\n2,-1,35\n",
            ",B,y\n7,1,36\n3,-1,35\n",
            "Unnamed: 0,B,y\n0,1,36\n1,-1,35\n",
        ] {
            let table = Table::parse(text).unwrap();
            assert_eq!(table.header(), ["B", "y"], "{text}");
            assert_eq!(table.rows()[1].text(0), "-1");
            assert_eq!(table.number(&table.rows()[1], 1), Ok(35.0));
        }
        for text in [
            ",B\n0,1\n0,2\n",
            ",B\n0.5,1\n1,2\n",
            ",B\na,1\nb,2\n",
            "n,B\n0,1\n1,2\n",
        ] {
            assert_eq!(Table::parse(text).unwrap().header().len(), 2, "{text}");
        }
    }

    /// A mean below the runs is not read as a run, even if it is one more number in the column of the response.
    #[test]
    fn a_row_of_totals_is_refused_with_its_place() {
        for (text, place) in [
            (
                "run,B,y\n1,-1,35\n2,1,37\nMean:,0,36\n",
                "line 4, column 'run': 'Mean:'",
            ),
            ("run,B,y\n1,-1,35\n2,1,37\nmean,0,36\nSD,1,1\n", "line 4"),
            (
                "B,y,remark\n-1,35,\n1,37,\n0,72,Total\n",
                "line 4, column 'remark': 'Total'",
            ),
        ] {
            let told = Table::parse(text).unwrap_err().to_string();
            assert!(told.contains(place) && told.contains('#'), "{told}");
        }
        // Names of levels, and remarks, may be such words.
        for text in [
            "end,y\nmin,1\nmax,2\n",
            "y,remark\n1,mean load\n2,total\n3,new belt\n",
        ] {
            assert!(Table::parse(text).is_ok(), "{text}");
        }
    }

    /// Units in brackets behind a name, blanks and line breaks within it.
    #[test]
    fn names_of_columns_are_found_as_people_write_them() {
        let table = Table::parse("Temp (deg C),\"Extraction\n  Yield [%]\",n\n1,2,3\n").unwrap();
        assert_eq!(table.column("Temp"), Ok(0));
        assert_eq!(table.column("Temp (deg C)"), Ok(0));
        assert_eq!(table.column("Extraction Yield"), Ok(1));
        assert_eq!(table.column("Extraction Yield [%]"), Ok(1));
    }

    /// A file of line ends, or of separators, is refused before its fields are made.
    #[test]
    fn tables_beyond_the_size_of_a_sheet_are_refused() {
        for (text, what) in [
            ("1\n".repeat(1_048_577), "lines"),
            (",".repeat(1_000_000), "columns"),
        ] {
            assert!(
                matches!(Table::parse(&text), Err(Error::TooLarge { what: told, .. }) if told == what)
            );
        }
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
