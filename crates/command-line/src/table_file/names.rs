//! Names of tables.

use std::path::{Path, PathBuf};

/// The file of a table, without the sheet that its name may end with.
pub fn file_of(path: &Path) -> PathBuf {
    split(path).0
}

/// Whether a word of the command line names a table: a CSV file or a workbook.
pub fn is_table(word: &str) -> bool {
    let file = file_of(Path::new(word));
    is_workbook_name(&file) || ends_in(&file, "csv")
}

/// Whether a file is named as a workbook.
pub fn is_workbook_name(file: &Path) -> bool {
    ends_in(file, "xlsx") || ends_in(file, "xlsm")
}

/// Whether a name has an ending, in capitals or not.
fn ends_in(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|end| end.eq_ignore_ascii_case(ending))
}

/// Splits `book.xlsx#Runs` into the file and its sheet, unless a file has the whole name.
pub(crate) fn split(path: &Path) -> (PathBuf, Option<String>) {
    let named = path.to_str().and_then(|text| text.rsplit_once('#'));
    match named {
        Some((file, sheet))
            if is_workbook_name(Path::new(file)) && !sheet.is_empty() && !path.exists() =>
        {
            (PathBuf::from(file), Some(sheet.to_owned()))
        }
        _ => (path.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::{is_table, split};
    use std::path::{Path, PathBuf};

    #[test]
    fn a_sheet_is_named_behind_the_workbook() {
        let cases = [
            ("a/book.xlsx#Runs", "a/book.xlsx", Some("Runs")),
            ("book.XLSX#my runs", "book.XLSX", Some("my runs")),
            ("book.xlsx", "book.xlsx", None),
            ("run#3.csv", "run#3.csv", None),
            ("book.xlsx#", "book.xlsx#", None),
        ];
        for (word, file, sheet) in cases {
            let expected = (PathBuf::from(file), sheet.map(str::to_owned));
            assert_eq!(split(Path::new(word)), expected, "{word}");
        }
        assert!(is_table("F.csv") && is_table("f.xlsx#F") && !is_table("B=0:1,E"));
    }
}
