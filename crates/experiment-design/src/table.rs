//! Tables: factors, designs, and measured data, as CSV text or the cells of a sheet.
//!
//! Comma separated, first line the column names, fields quoted with `"` if they contain a comma. Tables that are read may
//! have semicolons or tabs instead, and then decimal commas. Lines that start with `#` and empty lines are skipped.
//! Text that a spreadsheet would run as a formula is written with an apostrophe before it, and read without. Numbers are written with enough
//! digits to be read back bit for bit.

mod dialect;
mod read;
mod records;
mod write;

pub use dialect::text_of_bytes;
pub use read::{Row, Table, cell_name, is_row_index, split_unit};
pub use write::{csv_field, design_to_csv, factors_to_csv};

use crate::{Design, DesignKind, Error, Factor, Run, check_factors};

/// Reads factors from a table with the columns `symbol,name,unit,low,high`; further columns are
/// ignored, `name` and `unit` may be missing.
///
/// # Errors
/// Those of [`Table::parse`], [`Factor::new`] and [`check_factors`]; [`Error::MissingColumn`];
/// [`Error::BadNumber`].
pub fn factors_from_csv(text: &str) -> Result<Vec<Factor>, Error> {
    factors_from_table(&Table::parse(text)?)
}

/// Reads factors from a table as [`factors_from_csv`].
///
/// # Errors
/// Those of [`Factor::new`] and [`check_factors`]; [`Error::MissingColumn`]; [`Error::BadNumber`].
pub fn factors_from_table(table: &Table) -> Result<Vec<Factor>, Error> {
    let symbol = table.column("symbol")?;
    let (low, high) = (table.column("low")?, table.column("high")?);
    let (name, unit) = (table.column("name").ok(), table.column("unit").ok());
    let read = |row: &Row| {
        let word = |column: Option<usize>| column.map_or("", |column| row.text(column));
        let (low, high) = (table.number(row, low)?, table.number(row, high)?);
        Factor::new(row.text(symbol), word(name), word(unit), low, high)
    };
    let factors = table
        .rows()
        .iter()
        .map(read)
        .collect::<Result<Vec<_>, _>>()?;
    check_factors(&factors)?;
    Ok(factors)
}

/// Reads a design as [`design_to_csv`] writes it; only the columns of the factors are needed.
///
/// The columns named by the symbols are coded. If there is a `_natural` column too, it must
/// agree with the range of the factor to 1e-9 of the half-range.
///
/// # Errors
/// Those of [`Table::parse`]; [`Error::MissingColumn`]; [`Error::BadNumber`];
/// [`Error::CodingMismatch`].
pub fn design_from_csv(text: &str, factors: &[Factor]) -> Result<Design, Error> {
    design_from_table(&Table::parse(text)?, factors)
}

/// Reads a design from a table as [`design_from_csv`].
///
/// # Errors
/// [`Error::MissingColumn`]; [`Error::BadNumber`]; [`Error::CodingMismatch`].
pub fn design_from_table(table: &Table, factors: &[Factor]) -> Result<Design, Error> {
    check_factors(factors)?;
    let columns = factors
        .iter()
        .map(|factor| Ok((factor, table.column(factor.symbol())?)))
        .collect::<Result<Vec<_>, Error>>()?;
    let mut runs = Vec::with_capacity(table.rows().len());
    for (i, row) in table.rows().iter().enumerate() {
        let mut coded = Vec::with_capacity(factors.len());
        for &(factor, column) in &columns {
            let x = table.number(row, column)?;
            check_natural(table, row, factor, x)?;
            coded.push(x);
        }
        runs.push(Run {
            cell: table.count(row, "cell")?.unwrap_or(i + 1),
            replicate: table.count(row, "replicate")?.unwrap_or(1),
            block: table.count(row, "block")?.unwrap_or(1),
            coded,
        });
    }
    Design::with_runs(DesignKind::Given, factors, Vec::new(), runs)
}

/// Checks the natural value beside a coded one, if there is such a column: it must agree with the range of the factor to 1e-9
/// of the half-range.
///
/// # Errors
/// [`Error::BadNumber`]; [`Error::CodingMismatch`].
pub fn check_natural(table: &Table, row: &Row, factor: &Factor, coded: f64) -> Result<(), Error> {
    let Ok(column) = table.column(&format!("{}_natural", factor.symbol())) else {
        return Ok(());
    };
    let given = table.number(row, column)?;
    let expected = factor.natural(coded);
    if (given - expected).abs() <= 1e-9 * factor.half_range() {
        return Ok(());
    }
    Err(Error::CodingMismatch {
        place: table.place_of_row(row),
        symbol: factor.symbol().to_owned(),
        expected,
        given,
    })
}

#[cfg(test)]
mod tests {
    use super::{design_from_csv, design_to_csv, factors_from_csv, factors_to_csv};
    use crate::{Error, Factor, box_behnken};

    fn study_factors() -> Vec<Factor> {
        vec![
            Factor::new("B", "static friction, seed-resin", "1", 0.30, 0.42).unwrap(),
            Factor::new("E", "restitution \"seed-seed\"", "1", 0.01, 0.18).unwrap(),
            Factor::new("F", "static friction", "1", 0.0, 0.10).unwrap(),
        ]
    }

    #[test]
    fn factors_and_designs_are_read_back_bit_for_bit() {
        let factors = study_factors();
        assert_eq!(
            factors_from_csv(&factors_to_csv(&factors)).unwrap(),
            factors
        );
        let design = box_behnken(&factors, 2)
            .unwrap()
            .replicated(2)
            .unwrap()
            .randomised(5);
        let read = design_from_csv(&design_to_csv(&design), &factors).unwrap();
        assert_eq!(read.runs(), design.runs());
    }

    #[test]
    fn natural_values_that_contradict_the_coded_ones_are_refused() {
        let text = "run,B,E,F,B_natural\n1,-1,0,0,0.31\n";
        let error = design_from_csv(text, &study_factors()).unwrap_err();
        assert!(
            matches!(&error, Error::CodingMismatch { place, .. } if place == "line 2"),
            "{error}"
        );
    }

    #[test]
    fn bad_tables_are_refused_with_the_place() {
        let factors = study_factors();
        let cases = [
            ("run,B,E\n1,0,0\n", "no column 'F'"),
            ("run,B,E,F\n1,0,0\n", "line 2 has 3 fields"),
            ("run,B,E,F\n1,0,x,0\n", "line 2, column 'E': 'x'"),
            ("run,B,E,F\n1,0,inf,0\n", "not a finite number"),
            ("run,B,E,F\n", "no rows"),
            ("", "no header"),
            ("run,B,B,E,F\n1,0,0,0,0\n", "2 columns are named 'B'"),
            ("run,B,E,F\n1,\"0,0,0\n", "never closed"),
            ("cell,B,E,F\n1.5,0,0,0\n", "'1.5' is not"),
        ];
        for (text, message) in cases {
            let error = design_from_csv(text, &factors).unwrap_err().to_string();
            assert!(error.contains(message), "{text:?} gives: {error}");
        }
    }
}
