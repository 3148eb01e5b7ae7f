//! What the other code gave: the table that a user fills in.

use crate::Error;
use crate::expected::Expected;
use std::collections::BTreeMap;

/// The header of the table.
pub(crate) const HEADER: &str = "case,quantity,unit,value";

/// The table with an empty column of values.
pub(crate) fn template(rows: &[Expected]) -> String {
    let line = |row: &Expected| format!("{},{},{},\n", row.case, row.quantity, row.unit);
    let header = format!("{HEADER}\n");
    std::iter::once(header)
        .chain(rows.iter().map(line))
        .collect()
}

/// Reads the values in the order of the expected rows.
///
/// Blank lines and lines that start with `#` count for nothing.
///
/// # Errors
///
/// A header, a line, a case, a quantity, a unit or a value that is wrong, a row twice, rows that are missing.
pub fn read_results(text: &str, file: &str, rows: &[Expected]) -> Result<Vec<f64>, Error> {
    let at = |line: usize, what: String| Error::Results {
        file: file.to_owned(),
        line,
        what,
    };
    let mut lines = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let header = lines.next();
    let found: String = header.map_or("", |(_, line)| line).replace(' ', "");
    if found.trim_start_matches('\u{feff}') != HEADER {
        let (line, _) = header.unwrap_or((1, ""));
        return Err(at(
            line,
            format!("the header is '{found}'; it must be '{HEADER}'"),
        ));
    }
    let mut values: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    for (number, line) in lines {
        let (row, value) = read_line(line, rows).map_err(|what| at(number, what))?;
        if let Some((before, _)) = values.insert(row, (number, value)) {
            let name = format!("{} {}", rows[row].case, rows[row].quantity);
            return Err(at(
                number,
                format!("{name} has a value in line {before} already; delete one of the two"),
            ));
        }
    }
    let missing: Vec<String> = (0..rows.len())
        .filter(|row| !values.contains_key(row))
        .map(|row| format!("{} {}", rows[row].case, rows[row].quantity))
        .collect();
    if !missing.is_empty() {
        return Err(Error::Missing {
            file: file.to_owned(),
            rows: missing.join(", "),
        });
    }
    Ok(values.into_values().map(|(_, value)| value).collect())
}

/// The row and the value of a line.
fn read_line(line: &str, rows: &[Expected]) -> Result<(usize, f64), String> {
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    let [case, quantity, unit, value] = cells[..] else {
        return Err(format!(
            "'{line}' has {} cells; write {HEADER}",
            cells.len()
        ));
    };
    if !rows.iter().any(|row| row.case == case) {
        let mut known: Vec<&str> = rows.iter().map(|row| row.case.as_str()).collect();
        known.dedup();
        return Err(format!(
            "unknown case '{case}'; expected one of {}",
            known.join(", ")
        ));
    }
    let of_case = |row: &&Expected| row.case == case;
    let Some(row) = rows
        .iter()
        .position(|row| of_case(&row) && row.quantity == quantity)
    else {
        let known = rows.iter().filter(of_case).map(|row| row.quantity.as_str());
        let known = known.collect::<Vec<_>>().join(", ");
        return Err(format!(
            "case '{case}' has no quantity '{quantity}'; expected one of {known}"
        ));
    };
    let wanted = &rows[row].unit;
    if unit != wanted {
        return Err(format!(
            "{case} {quantity} is in '{unit}'; convert it to {wanted}"
        ));
    }
    if value.is_empty() {
        return Err(format!(
            "{case} {quantity} has no value; run the case and write its result"
        ));
    }
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((row, number)),
        _ => Err(format!(
            "{case} {quantity} is '{value}'; write a finite number"
        )),
    }
}
