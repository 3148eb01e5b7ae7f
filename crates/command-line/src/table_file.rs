//! Tables as files: CSV text and Excel workbooks, read and written.
//!
//! [`read`] detects the kind from the content, whatever the name of the file: a workbook begins like a ZIP archive.
//! `book.xlsx#Runs` names the sheet `Runs` of a workbook; without it the workbook must have one visible sheet with cells.
//! [`bytes_for`] makes a workbook for a name that ends in `.xlsx`, and leaves CSV text as it is for any other.
//!
//! Invariants: a number has the same bits in both forms; the same table gives the same bytes.

mod error;
mod inflated;
mod names;
mod sheet;
mod workbook;
mod write;

pub use error::Error;
pub use names::{file_of, is_table, is_workbook_name};
pub use write::bytes_for;

use experiment_design::table::{Table, text_of_bytes};
use std::path::Path;

/// Largest file of a table, bytes (128 MiB): our choice, a hundred times the largest table of an experiment that we know. The
/// rows in memory take some two to five times the file.
const MOST_BYTES: u64 = 1 << 27;

/// First bytes of a ZIP archive, which a workbook is.
const ZIP: &[u8] = b"PK\x03\x04";

/// First bytes of a compound file: a workbook of Excel before 2007, or one with a password.
const COMPOUND: &[u8] = &[0xd0, 0xcf, 0x11, 0xe0];

/// Reads the table that a user names: CSV text, or a sheet of an Excel workbook.
///
/// # Errors
/// A file that cannot be read, is damaged or contains no table, with its name; a sheet that must be chosen; an invalid
/// cell, with its place.
pub fn read(path: &Path) -> Result<Table, Error> {
    let (file, sheet) = names::split(path);
    let unread = |source| Error::Read {
        path: file.clone(),
        source,
    };
    let refused = |what: String| Error::Workbook {
        path: file.clone(),
        what,
    };
    // A folder has a size too; the reader says what it is.
    let size = std::fs::metadata(&file).map_err(unread)?;
    if size.is_file() && size.len() > MOST_BYTES {
        return Err(refused(format!(
            "it has {} bytes; at most {MOST_BYTES} are read: remove rows or columns, or average repeats",
            size.len()
        )));
    }
    let bytes = input::file::read(&file).map_err(unread)?;
    if bytes.starts_with(ZIP) {
        return workbook::table(&bytes, &file, sheet.as_deref()).map_err(refused);
    }
    if bytes.starts_with(COMPOUND) {
        return Err(refused(
            "it is a workbook of Excel before 2007 (.xls) or one with a password; save it as .xlsx without a password".to_owned(),
        ));
    }
    if names::is_workbook_name(&file) || sheet.is_some() {
        return Err(refused(
            "it has the extension of a workbook but is not one; save it as .xlsx, or name it .csv if it is text".to_owned(),
        ));
    }
    Table::parse(&text_of_bytes(bytes)).map_err(|source| Error::Table { path: file, source })
}
