//! Variants of tables from spreadsheets: encodings, separators, decimal commas, cells that run as formulas.

/// The text of a file: UTF-8, UTF-16 with its byte order mark, or else Latin-1 (ISO 8859-1), in which every sequence of bytes
/// is valid.
pub fn text_of_bytes(bytes: Vec<u8>) -> String {
    let wide = |bytes: &[u8], order: fn([u8; 2]) -> u16| -> String {
        let units = bytes[2..]
            .chunks_exact(2)
            .map(|pair| order([pair[0], pair[1]]));
        let characters = char::decode_utf16(units);
        characters
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect()
    };
    match &bytes[..] {
        [0xff, 0xfe, ..] => wide(&bytes, u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(&bytes, u16::from_be_bytes),
        _ => String::from_utf8(bytes).unwrap_or_else(|error| {
            let bytes = error.into_bytes();
            bytes.iter().map(|&byte| char::from(byte)).collect()
        }),
    }
}

/// The separator of a header line: a semicolon or a tab outside quotes, otherwise a comma.
pub(super) fn separator(header: &str) -> char {
    let mut quoted = false;
    let outside = |c: &char| {
        quoted ^= *c == '"';
        !quoted
    };
    let outside: Vec<char> = header.chars().filter(outside).collect();
    let found = [';', '\t'].into_iter().find(|c| outside.contains(c));
    found.unwrap_or(',')
}

/// The separator that a first line `sep=;` names, as spreadsheets write it.
pub(super) fn named_separator(line: &str) -> Option<char> {
    let mut rest = line.strip_prefix("sep=")?.chars();
    let separator = rest.next()?;
    rest.as_str().trim().is_empty().then_some(separator)
}

/// Whether a field is a number written with a decimal point.
pub(super) fn has_decimal_point(field: &str) -> bool {
    field.contains('.') && field.trim().parse::<f64>().is_ok()
}

/// A number written with a decimal comma, with a point instead; `None` for any other field.
pub(super) fn with_decimal_point(field: &str) -> Option<String> {
    let (whole, rest) = field.split_once(',')?;
    let starts = rest.starts_with(|c: char| c.is_ascii_digit());
    let pointed = format!("{whole}.{rest}");
    let is_number = starts && !whole.contains('.') && pointed.trim().parse::<f64>().is_ok();
    is_number.then_some(pointed)
}

/// A field that no spreadsheet runs as a formula: text that begins with `=`, `+`, `-`, `@`, a tab or a line break gets an
/// apostrophe before it, which spreadsheets do not show. Numbers stay as they are.
///
/// # Source
/// OWASP, "CSV Injection": the characters with which a cell begins a formula.
pub(super) fn harmless(field: String) -> String {
    let runs = field.starts_with(RUNS) && field.trim().parse::<f64>().is_err();
    if runs { format!("'{field}") } else { field }
}

/// A field as it was before [`harmless`].
pub(super) fn as_meant(field: &str) -> &str {
    let inner = field.strip_prefix('\'');
    inner.filter(|rest| rest.starts_with(RUNS)).unwrap_or(field)
}

/// Characters with which spreadsheets begin a formula.
const RUNS: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

#[cfg(test)]
mod tests {
    use super::super::{Table, csv_field};
    use super::text_of_bytes;

    /// The same table as programs of different countries and systems write it.
    #[test]
    fn tables_of_all_spreadsheets_read_alike() {
        let plain = Table::parse("wall,d_µm,y\nröhre,0.5,-1.25e3\nglas,2,3\n").unwrap();
        let semicolons = "wall;d_µm;y\r\nröhre;0,5;-1,25e3\r\nglas;2;3\r\n";
        let latin: Vec<u8> = semicolons
            .chars()
            .map(|c| u8::try_from(u32::from(c)).unwrap())
            .collect();
        let marked = [&[0xef, 0xbb, 0xbf][..], semicolons.as_bytes()].concat();
        let tabs = semicolons.replace(';', "\t");
        let wide = tabs.encode_utf16().flat_map(u16::to_le_bytes);
        let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(wide).collect();
        let named = format!("sep=;\r\n{semicolons}");
        let returns = semicolons.replace("\r\n", "\r");
        let with_empty_rows = format!("{semicolons};;\r\n; ;\r\n");
        for bytes in [
            semicolons.as_bytes(),
            &latin,
            &marked,
            &wide,
            named.as_bytes(),
            returns.as_bytes(),
            with_empty_rows.as_bytes(),
        ] {
            let table = Table::parse(&text_of_bytes(bytes.to_vec())).unwrap();
            assert_eq!(table.header(), plain.header());
            assert_eq!(table.rows().len(), 2);
            for (row, expected) in table.rows().iter().zip(plain.rows()) {
                assert_eq!(row.text(0), expected.text(0));
                for column in 1..3 {
                    assert_eq!(table.number(row, column), plain.number(expected, column));
                }
            }
        }
    }

    /// Other commas than decimal commas are kept: beside points they may separate thousands, which is ambiguous.
    #[test]
    fn ambiguous_commas_are_refused() {
        let table = Table::parse("a;b\n1,234;0.5\n").unwrap();
        assert!(table.number(&table.rows()[0], 0).is_err());
        let table = Table::parse("a;b\n1.234,5;2\n").unwrap();
        assert!(table.number(&table.rows()[0], 0).is_err());
        let table = Table::parse("a;b\n1,5;\"x; y, 2\"\n").unwrap();
        assert_eq!(table.number(&table.rows()[0], 0), Ok(1.5));
        assert_eq!(table.rows()[0].text(1), "x; y, 2");
    }

    /// A picture or another binary file is reported as binary, and not by the first quote in it.
    #[test]
    fn a_file_that_is_no_text_is_refused_as_such() {
        let picture = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\"";
        let found = Table::parse(&text_of_bytes(picture.to_vec()));
        assert_eq!(found, Err(crate::Error::NotText));
    }

    #[test]
    fn cells_that_a_spreadsheet_would_run_are_harmless_and_read_back() {
        for field in ["=cmd|' /C calc'!A0", "@SUM(A1)", "+1+2", "-x"] {
            let written = csv_field(field);
            let cell = written.trim_start_matches('"');
            assert!(cell.starts_with('\''), "{written}");
            let table = Table::parse(&format!("a,b\n{written},1\n")).unwrap();
            assert_eq!(table.rows()[0].text(0), field);
        }
        for field in ["-0.5", "+3", "-1e-7", "steel", "'quoted'", ""] {
            assert_eq!(csv_field(field), field);
        }
    }
}
