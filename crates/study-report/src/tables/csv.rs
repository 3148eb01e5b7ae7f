//! A table as comma-separated values [RFC 4180], full precision; an empty field is undefined.

use experiment_design::table::csv_field;

/// One field.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Field {
    /// A text.
    Text(String),
    /// A number.
    Number(f64),
    /// A count.
    Count(usize),
    /// Nothing: not defined or not known.
    Empty,
}

impl From<&str> for Field {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<&String> for Field {
    fn from(text: &String) -> Self {
        Self::Text(text.clone())
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<usize> for Field {
    fn from(value: usize) -> Self {
        Self::Count(value)
    }
}

impl From<Option<f64>> for Field {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Number)
    }
}

impl From<bool> for Field {
    fn from(is: bool) -> Self {
        Self::from(if is { "yes" } else { "no" })
    }
}

impl Field {
    /// The field as it stands in the file. The shortest digits that give the same number back;
    /// what is not finite is empty.
    fn written(&self) -> String {
        match self {
            Self::Text(text) => csv_field(text),
            Self::Number(value) if value.is_finite() => format!("{value:?}"),
            Self::Number(_) | Self::Empty => String::new(),
            Self::Count(value) => value.to_string(),
        }
    }
}

/// A table with named columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CsvTable {
    /// Name without ending.
    name: String,
    /// Names of the columns with their units.
    columns: Vec<String>,
    /// The lines of the file after the first.
    rows: Vec<String>,
}

impl CsvTable {
    /// A table without rows.
    pub(crate) fn new<Name: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = Name>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self {
            name: name.into(),
            columns,
            rows: Vec::new(),
        }
    }

    /// Adds a row; a short one is filled up with empty fields.
    pub(crate) fn row(&mut self, fields: impl IntoIterator<Item = Field>) {
        let mut written: Vec<String> = fields.into_iter().map(|f| f.written()).collect();
        debug_assert!(
            written.len() <= self.columns.len(),
            "a row of {} is too long",
            self.name
        );
        written.resize(self.columns.len(), String::new());
        self.rows.push(written.join(","));
    }

    /// Whether it has no row.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Name of its file.
    pub(crate) fn file_name(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// The whole file.
    pub(crate) fn text(&self) -> String {
        let head: Vec<String> = self.columns.iter().map(|c| csv_field(c)).collect();
        let mut text = head.join(",");
        for row in &self.rows {
            text.push('\n');
            text.push_str(row);
        }
        text.push('\n');
        text
    }
}

#[cfg(test)]
mod tests {
    use super::{CsvTable, Field};

    /// A table of one row.
    fn line(fields: Vec<Field>) -> String {
        let mut table = CsvTable::new("t", vec!["c"; fields.len()]);
        table.row(fields);
        table.text().lines().skip(1).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn texts_stand_as_the_reader_of_tables_takes_them() {
        let texts = ["plain", "a, b", "say \"no\"", "two\nlines", "=A1"];
        let found = line(texts.into_iter().map(Field::from).collect());
        assert_eq!(found, "plain,\"a, b\",\"say \"\"no\"\"\",two lines,'=A1");
    }

    #[test]
    fn numbers_come_back_exactly_and_undefined_ones_are_empty() {
        let value = 0.1 + 0.2;
        let found = line(vec![
            value.into(),
            f64::NAN.into(),
            None::<f64>.into(),
            7_usize.into(),
        ]);
        assert_eq!(found, "0.30000000000000004,,,7");
        let first = found.split(',').next().and_then(|t| t.parse::<f64>().ok());
        assert_eq!(first, Some(value));
    }

    #[test]
    fn every_row_has_as_many_fields_as_the_heading() {
        let mut table = CsvTable::new("t", ["a_deg", "b_1", "c_mm"]);
        table.row([Field::from(1.5)]);
        assert_eq!(table.text(), "a_deg,b_1,c_mm\n1.5,,\n");
        assert_eq!(table.file_name(), "t.csv");
    }
}
