//! Tables of a report.

use std::fmt::Write as _;

use crate::Error;
use crate::check::Field;
use crate::escape::escaped;

/// On which side the entries of a column stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// Texts.
    Left,
    /// Numbers; digits of equal width stand one below the other.
    Right,
}

/// One column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Heading with the unit of the entries.
    pub heading: String,
    /// On which side the entries stand.
    pub alignment: Alignment,
}

impl Column {
    /// A column of texts.
    pub fn text(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            alignment: Alignment::Left,
        }
    }

    /// A column of numbers; put their unit into the heading.
    pub fn number(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            alignment: Alignment::Right,
        }
    }
}

/// A table in which every row has one entry for each column.
///
/// ```
/// use report::{Column, Report, Table};
/// let columns = vec![Column::text("parameter"), Column::number("value")];
/// let mut table = Table::new("Estimate", columns)?;
/// table.row(["friction", "0.41 +- 0.02"])?;
/// let mut report = Report::new("Drum");
/// report.section("Result").table(&table);
/// assert!(report.html().contains("0.41 +- 0.02"));
/// # Ok::<(), report::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What the table shows, plain text.
    caption: String,
    columns: Vec<Column>,
    /// The rows, plain text.
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    ///
    /// # Errors
    /// [`Error::TooFew`] without a column.
    pub fn new(caption: impl Into<String>, columns: Vec<Column>) -> Result<Self, Error> {
        Field::new("table", "columns").at_least(1, columns.len())?;
        Ok(Self {
            caption: caption.into(),
            columns,
            rows: Vec::new(),
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`Error::Length`] for a row that has not one entry for each column.
    pub fn row<Entry: Into<String>>(
        &mut self,
        entries: impl IntoIterator<Item = Entry>,
    ) -> Result<&mut Self, Error> {
        let entries: Vec<String> = entries.into_iter().map(Into::into).collect();
        Field::new("table", "row").length(self.columns.len(), "column", entries.len())?;
        self.rows.push(entries);
        Ok(self)
    }

    /// The table as markup with its number.
    pub(crate) fn markup(&self, number: usize) -> String {
        let mut markup = format!(
            "<div class=\"table\"><table>\n<caption><b>Table {number}.</b> {}</caption>\n<thead><tr>",
            escaped(&self.caption)
        );
        for column in &self.columns {
            let class = class(column.alignment);
            let heading = escaped(&column.heading);
            write!(markup, "<th scope=\"col\"{class}>{heading}</th>")
                .expect("a String takes any text");
        }
        markup.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            markup.push_str("<tr>");
            for (entry, column) in row.iter().zip(&self.columns) {
                let class = class(column.alignment);
                write!(markup, "<td{class}>{}</td>", escaped(entry))
                    .expect("a String takes any text");
            }
            markup.push_str("</tr>\n");
        }
        markup.push_str("</tbody></table></div>");
        markup
    }
}

/// Attribute for the side of a column.
fn class(alignment: Alignment) -> &'static str {
    match alignment {
        Alignment::Left => "",
        Alignment::Right => " class=\"right\"",
    }
}
