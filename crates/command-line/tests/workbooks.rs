//! Tables in workbooks as spreadsheet programs write them, and files that are none.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use command_line::table_file::{bytes_for, read};
use experiment_design::table::Table;
use probability::random_stream::Stream;
use rust_xlsxwriter::{ExcelDateTime, Format, Formula, Workbook, Worksheet};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use tempfile::{TempDir, tempdir};

/// A workbook with sheets of these names, filled by the function, in a folder of its own.
fn book(names: &[&str], fill: impl Fn(&str, &mut Worksheet)) -> (TempDir, PathBuf) {
    let mut workbook = Workbook::new();
    for name in names {
        fill(name, workbook.add_worksheet().set_name(*name).unwrap());
    }
    kept(&workbook.save_to_buffer().unwrap())
}

/// Bytes as the file `book.xlsx` in a folder of its own.
fn kept(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    let file = folder.path().join("book.xlsx");
    std::fs::write(&file, bytes).unwrap();
    (folder, file)
}

/// Rows of text, beginning in a row and column of the sheet.
fn put(sheet: &mut Worksheet, row: u32, column: u16, rows: &[&[&str]]) {
    for (fields, row) in rows.iter().zip(row..) {
        for (field, column) in fields.iter().zip(column..) {
            match field.parse::<f64>() {
                Ok(number) => sheet.write_number(row, column, number).unwrap(),
                Err(_) => sheet.write_string(row, column, *field).unwrap(),
            };
        }
    }
}

/// The workbook with one of its parts changed.
fn with_part(bytes: &[u8], name: &str, change: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let mut out = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (own, part) in parts(bytes) {
        out.start_file(&*own, zip::write::SimpleFileOptions::default())
            .unwrap();
        let part = if own == name { change(&part) } else { part };
        out.write_all(&part).unwrap();
    }
    out.finish().unwrap().into_inner()
}

/// The parts of a workbook with their names.
fn parts(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    let mut parts = Vec::new();
    for i in 0..archive.len() {
        let mut file = archive.by_index(i).unwrap();
        let mut part = Vec::new();
        std::io::copy(&mut file, &mut part).unwrap();
        parts.push((file.name().unwrap().into_owned(), part));
    }
    parts
}

/// A part with one to four bytes changed, put in or cut off behind.
fn damaged(part: &[u8], seed: u64) -> Vec<u8> {
    let mut stream = Stream::new(seed, "damage");
    let mut part = part.to_vec();
    for _ in 0..=stream.below(4) {
        if part.is_empty() {
            break;
        }
        let place = stream.below(part.len());
        match stream.below(3) {
            0 => part[place] = u8::try_from(stream.below(256)).unwrap(),
            1 => part.truncate(place),
            _ => part.splice(place..place, *b"9999999999").for_each(drop),
        }
    }
    part
}

/// The refusal of a file.
fn refused(file: &Path) -> String {
    let told = read(file).unwrap_err().to_string();
    assert!(told.contains("book.xlsx"), "the file is named: {told}");
    told
}

/// All fields of a table.
fn fields(table: &Table) -> Vec<Vec<String>> {
    let columns = 0..table.header().len();
    let of = |row| {
        columns
            .clone()
            .map(|c| experiment_design::table::Row::text(row, c).to_owned())
            .collect()
    };
    table.rows().iter().map(of).collect()
}

/// Numbers of every size come back with the same bits, texts as they were, and the same table gives the same bytes. 007 and a
/// whole number of 20 digits are text, because a number would be written otherwise; a text that looks like a formula is text.
#[test]
fn a_table_that_is_written_comes_back_bit_for_bit() {
    let csv = "name,x_mm,note\nseed 1,0.1,\n007,1e-7,\"a, b\"\n18446744073709551615,-123456789.12345679,'=1+1\n\
               tiny,5e-324,x\nlarge,1.7976931348623157e308,\nthird,0.3333333333333333,-\n";
    let bytes = bytes_for(Path::new("book.xlsx"), csv).unwrap();
    assert_eq!(bytes, bytes_for(Path::new("book.xlsx"), csv).unwrap());
    let (_folder, file) = kept(&bytes);
    let (plain, read) = (Table::parse(csv).unwrap(), read(&file).unwrap());
    assert_eq!(read.header(), plain.header());
    for (row, expected) in read.rows().iter().zip(plain.rows()) {
        assert_eq!(row.text(0), expected.text(0));
        assert_eq!(row.text(2), expected.text(2));
        let bits = |table: &Table, row| table.number(row, 1).unwrap().to_bits();
        assert_eq!(bits(&read, row), bits(&plain, expected), "{}", row.text(0));
    }
    assert_eq!(
        bytes_for(Path::new("book.csv"), csv).unwrap(),
        csv.as_bytes()
    );
    assert!(
        bytes_for(Path::new("book.xlsm"), csv)
            .unwrap_err()
            .to_string()
            .contains(".xlsx")
    );
}

/// The table begins in B3, after a comment, with an empty row in it; the place of a wrong cell is that of the sheet.
#[test]
fn a_table_may_begin_anywhere_and_its_cells_keep_their_names() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(sheet, 0, 0, &[&["# drum of 12 October"]]);
        put(
            sheet,
            2,
            1,
            &[
                &["B", "theta_deg"],
                &["1", "36.5"],
                &[],
                &["-1", "about 36"],
            ],
        );
    });
    let table = read(&file).unwrap();
    assert_eq!(fields(&table), [["1", "36.5"], ["-1", "about 36"]]);
    let told = table.number(&table.rows()[1], 1).unwrap_err().to_string();
    assert!(
        told.contains("sheet 'Runs', row 6, cell C6, column 'theta_deg': 'about 36'"),
        "{told}"
    );
}

/// An empty cell is empty and not 0; a date, an error and a truth value are not numbers; a formula is its value.
#[test]
fn cells_are_what_they_hold() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(
            sheet,
            0,
            0,
            &[
                &["day", "x", "sum", "rate", "done"],
                &["", "", "", "", ""],
                &["b"],
            ],
        );
        let day = ExcelDateTime::from_ymd(2026, 11, 25).unwrap();
        let format = Format::new().set_num_format("yyyy-mm-dd");
        sheet
            .write_datetime_with_format(1, 0, &day, &format)
            .unwrap();
        let sum = Formula::new("=0.1+0.2").set_result("0.30000000000000004");
        sheet.write_formula(1, 2, sum).unwrap();
        sheet
            .write_formula(1, 3, Formula::new("=1/0").set_result("#DIV/0!"))
            .unwrap();
        sheet.write_boolean(1, 4, true).unwrap();
    });
    let table = read(&file).unwrap();
    assert_eq!(
        fields(&table)[0],
        ["2026-11-25", "", "0.30000000000000004", "#DIV/0!", "true"]
    );
    for column in [0, 1, 3, 4] {
        let told = table
            .number(&table.rows()[0], column)
            .unwrap_err()
            .to_string();
        let cell = ["A2", "B2", "C2", "D2", "E2"][column];
        assert!(told.contains(cell), "{told}");
    }
    assert_eq!(table.number(&table.rows()[0], 2), Ok(0.1 + 0.2));
}

/// An error in the first cell of a row begins with # as a comment does: the row must not be left out.
#[test]
fn an_error_in_the_first_cell_is_no_comment() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(
            sheet,
            0,
            0,
            &[&["x", "y"], &["#N/A", "1"], &["# a note", ""], &["2", "3"]],
        );
    });
    assert_eq!(fields(&read(&file).unwrap()), [["#N/A", "1"], ["2", "3"]]);
}

/// With two sheets that have cells the user must name one; empty and hidden sheets do not count, but a hidden one can be named.
#[test]
fn the_sheet_is_the_only_one_with_cells_or_named() {
    let fill = |name: &str, sheet: &mut Worksheet| match name {
        "Empty" => {}
        name => {
            put(
                sheet,
                0,
                0,
                &[&["x"], &[if name == "Runs" { "1" } else { "2" }]],
            );
            sheet.set_hidden(name == "Old");
        }
    };
    let (_folder, file) = book(&["Runs", "Empty", "Old"], fill);
    assert_eq!(fields(&read(&file).unwrap()), [["1"]]);
    let sheet = |name: &str| PathBuf::from(format!("{}#{name}", file.display()));
    assert_eq!(fields(&read(&sheet("Old")).unwrap()), [["2"]]);
    let told = refused(&sheet("Rnus"));
    assert!(
        told.contains("no sheet 'Rnus'") && told.contains("'Runs', 'Empty', 'Old'"),
        "{told}"
    );
    let (_folder, file) = book(&["Runs", "Notes"], fill);
    let told = refused(&file);
    assert!(
        told.contains("'Runs', 'Notes'") && told.contains("book.xlsx#Runs'"),
        "{told}"
    );
    let (_folder, file) = book(&["Empty"], fill);
    assert!(refused(&file).contains("no visible sheet has cells"));
}

/// An error in a table names the cell.
#[test]
fn merged_cells_notes_and_formulas_without_value_are_refused_with_their_cell() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(sheet, 1, 0, &[&["B", "E"], &["1", "2"]]);
        sheet
            .merge_range(0, 0, 0, 1, "Factors", &Format::new())
            .unwrap();
    });
    let told = refused(&file);
    assert!(
        told.contains("cell A1") && told.contains("B1") && told.contains("merged"),
        "{told}"
    );
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(sheet, 0, 0, &[&["B", "E"], &["1", "2", "", "slipped"]]);
    });
    let told = refused(&file);
    assert!(told.contains("sheet 'Runs', cell D2: 'slipped'"), "{told}");
}

/// Libraries write formulas without their values, which only a spreadsheet program computes: refused, never taken for an
/// empty cell. A formula whose value is the empty text is an empty cell.
#[test]
fn a_formula_without_its_value_is_refused() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(sheet, 0, 0, &[&["B", "E"], &["1", "2"]]);
        sheet
            .write_formula(1, 1, Formula::new("=A2+1").set_result("2"))
            .unwrap();
    });
    let cell = "<c r=\"B2\"><f>A2+1</f><v>2</v></c>";
    let with = |other: &str| {
        let bytes = std::fs::read(&file).unwrap();
        kept(&with_part(&bytes, "xl/worksheets/sheet1.xml", |xml| {
            let text = String::from_utf8(xml.to_vec()).unwrap();
            assert!(text.contains(cell), "{text}");
            text.replace(cell, other).into_bytes()
        }))
    };
    let (_folder, empty) = with("<c r=\"B2\" t=\"str\"><f>A2+1</f><v></v></c>");
    assert_eq!(fields(&read(&empty).unwrap()), [["1", ""]]);
    let (_folder, unknown) = with("<c r=\"B2\"><f>A2+1</f></c>");
    let told = refused(&unknown);
    assert!(
        told.contains("cell B2") && told.contains("formula without its value"),
        "{told}"
    );
}

/// A column name above and a value far below: the table would have 16 384 columns of 1 048 575 rows, more than any memory.
#[test]
fn a_table_that_would_fill_the_memory_is_refused() {
    let (_folder, file) = book(&["Runs"], |_, sheet| {
        put(sheet, 0, 0, &[&["x"]]);
        put(sheet, 0, 16_383, &[&["y"]]);
        for row in 1..4000 {
            put(sheet, row, 0, &[&["1"]]);
        }
    });
    let told = refused(&file);
    assert!(
        told.contains("65536000 cells") && told.contains("50000000"),
        "{told}"
    );
}

/// Files of other kinds than a workbook, each with its remedy.
#[test]
fn files_that_are_no_workbook_are_told_apart() {
    let (_folder, file) = kept(b"x,y\n1,2\n");
    assert!(refused(&file).contains("name it .csv"));
    let (_folder, file) = kept(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1 and so on");
    assert!(refused(&file).contains("password"));
    let whole = bytes_for(Path::new("book.xlsx"), "x,y\n1,2\n").unwrap();
    for length in [4, 30, whole.len() / 2, whole.len() - 1] {
        let (_folder, file) = kept(&whole[..length]);
        let told = refused(&file);
        assert!(told.contains("damaged"), "{length}: {told}");
    }
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive
        .start_file("a.txt", zip::write::SimpleFileOptions::default())
        .unwrap();
    archive.write_all(b"no workbook").unwrap();
    let (_folder, file) = kept(archive.finish().unwrap().get_ref());
    assert!(refused(&file).contains("save it as .xlsx"));
    // A workbook is known by its content, whatever its name.
    let other = file.with_file_name("book.xlsx.csv");
    std::fs::write(&other, &whole).unwrap();
    assert_eq!(fields(&read(&other).unwrap()), [["1", "2"]]);
}

/// 256 MiB and a byte of zeros are 260 kB in the archive, and no memory is taken to find out.
#[test]
fn an_archive_that_unpacks_to_more_than_a_file_may_have_is_refused() {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive
        .start_file("xl/workbook.xml", zip::write::SimpleFileOptions::default())
        .unwrap();
    let zeros = vec![0; 1 << 20];
    for _ in 0..256 {
        archive.write_all(&zeros).unwrap();
    }
    archive.write_all(&[0]).unwrap();
    let bytes = archive.finish().unwrap().into_inner();
    assert!(bytes.len() < 1 << 23, "{}", bytes.len());
    let (_folder, file) = kept(&bytes);
    let told = refused(&file);
    assert!(told.contains("268435456"), "{told}");
}

/// A few bytes announce 4 000 000 000 texts, for which a reader would take 96 GB before it has read one; with blanks, the other
/// quotes and a sign too.
#[test]
fn a_workbook_that_announces_more_than_it_holds_is_refused() {
    let whole = bytes_for(Path::new("book.xlsx"), "x,y\nsteel,2\n").unwrap();
    for announced in [
        "uniqueCount=\"4000000000\"",
        "uniqueCount \n = '+04000000000'",
        "uniqueCount=\"18446744073709551615\"",
    ] {
        let bytes = with_part(&whole, "xl/sharedStrings.xml", |xml| {
            let text = String::from_utf8(xml.to_vec()).unwrap();
            let changed = text.replace("uniqueCount=\"3\"", announced);
            assert_ne!(changed, text);
            changed.into_bytes()
        });
        let (_folder, file) = kept(&bytes);
        let told = refused(&file);
        assert!(told.contains("announces"), "{told}");
    }
}

/// One text of 32 kB that six thousand cells share is 32 kB in the file, and would be 200 MB in the table.
#[test]
fn a_text_that_many_cells_share_is_counted_for_each() {
    let whole = bytes_for(Path::new("book.xlsx"), "wall\nsteel\n").unwrap();
    let long = with_part(&whole, "xl/sharedStrings.xml", |xml| {
        let text = String::from_utf8(xml.to_vec()).unwrap();
        text.replace("steel", &"steel ".repeat(5400)).into_bytes()
    });
    let bytes = with_part(&long, "xl/worksheets/sheet1.xml", |xml| {
        let text = String::from_utf8(xml.to_vec()).unwrap();
        let row = |row| format!("<row r=\"{row}\"><c r=\"A{row}\" t=\"s\"><v>1</v></c></row>");
        let rows = (3..6000).map(row).collect::<Vec<_>>().concat();
        assert!(text.contains("<c r=\"A2\" t=\"s\"><v>1</v></c>"), "{text}");
        text.replace("</sheetData>", &(rows + "</sheetData>"))
            .into_bytes()
    });
    let (_folder, file) = kept(&bytes);
    let told = refused(&file);
    assert!(
        told.contains("bytes of text") && told.contains("cell A"),
        "{told}"
    );
}

/// pandas writes the numbers of the rows by default, from 0 or 1 or in any order, in a first column without a name. Any
/// other column without a name is refused with its cell.
#[test]
fn a_first_column_of_row_numbers_needs_no_name() {
    for (start, index) in [
        ("A", ["0", "1", "2"]),
        ("A", ["1", "2", "3"]),
        ("C", ["4", "0", "9"]),
    ] {
        let left = if start == "A" { 0 } else { 2 };
        let (_folder, file) = book(&["Sheet1"], |_, sheet| {
            put(sheet, 0, left + 1, &[&["B", "angle (deg)"]]);
            for (i, number) in (1..).zip(index) {
                put(sheet, i, left, &[&[number, "0.5", "36.5"]]);
            }
        });
        let table = read(&file).unwrap();
        assert_eq!(table.header(), ["B", "angle (deg)"]);
        assert_eq!(fields(&table)[2], ["0.5", "36.5"]);
        let cell = if start == "A" { "cell C4" } else { "cell E4" };
        assert!(table.place(&table.rows()[2], 1).contains(cell));
    }
    for other in [
        ["0", "1", "1"],
        ["0", "1.5", "2"],
        ["a", "b", "c"],
        ["0", "", "2"],
    ] {
        let (_folder, file) = book(&["Sheet1"], |_, sheet| {
            put(sheet, 0, 1, &[&["B"]]);
            for (i, text) in (1..).zip(other) {
                put(sheet, i, 0, &[&[text, "0.5"]]);
            }
        });
        let told = refused(&file);
        assert!(
            told.contains("cell A2") && told.contains("no column name"),
            "{told}"
        );
    }
}

/// Workbooks whose sheet is damaged inside an archive that is whole: each is a table or a refusal, never a panic.
#[test]
fn damaged_sheets_never_panic() {
    let whole = bytes_for(Path::new("book.xlsx"), "x,y\n1,2\nsteel,0.5\n").unwrap();
    let names: Vec<String> = parts(&whole).into_iter().map(|(name, _)| name).collect();
    let mut stream = Stream::new(1, "damaged workbooks");
    let mut below = |n: usize| stream.below(n);
    for _ in 0..600 {
        let victim = &names[below(names.len())];
        let seed = below(1 << 30) as u64;
        let bytes = with_part(&whole, victim, |part| damaged(part, seed));
        let (_folder, file) = kept(&bytes);
        let _ = read(&file);
    }
}
