//! Least squares, analysis of variance and solutions against R, NIST, the published study and closed forms.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod analysis;
mod degenerate;
mod nist;
mod published_study;
mod r;
mod r_blocks;
mod r_comparisons;
mod r_levels;
mod simulated_study;
mod solution_answers;
mod solution_set;

use experiment_design::Factor;
use experiment_design::table::Table;
use serde_json::Value;
use std::error::Error;

/// The texts of a list.
fn texts(value: &Value) -> Vec<String> {
    let list = value.as_array().into_iter().flatten();
    list.filter_map(|text| text.as_str().map(str::to_owned))
        .collect()
}

/// The numbers of a column.
fn column(table: &Table, name: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    let place = table.column(name)?;
    let numbers = table.rows().iter().map(|row| table.number(row, place));
    Ok(numbers.collect::<Result<_, _>>()?)
}

/// A column as a factor from its least to its greatest value. The coded values are appended to the rows.
fn code_column(
    table: &Table,
    symbol: &str,
    coded: &mut [Vec<f64>],
) -> Result<Factor, Box<dyn Error>> {
    let values = column(table, symbol)?;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let factor = Factor::new(symbol, "", "1", low, high)?;
    for (row, value) in coded.iter_mut().zip(values) {
        row.push(factor.coded(value));
    }
    Ok(factor)
}
