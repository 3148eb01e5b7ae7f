//! Writing CSV text.

use std::fmt::Write as _;

use super::dialect;
use crate::{Design, Factor};

/// Factors as `symbol,name,unit,low,high`.
pub fn factors_to_csv(factors: &[Factor]) -> String {
    let line = |f: &Factor| {
        let (name, unit) = (csv_field(f.name()), csv_field(f.unit()));
        format!("{},{name},{unit},{},{}\n", f.symbol(), f.low(), f.high())
    };
    let lines: String = factors.iter().map(line).collect();
    format!("symbol,name,unit,low,high\n{lines}")
}

/// A design as `run,cell,replicate,block`, the coded columns (factors, dummies) and the natural
/// value of every factor in a column `SYMBOL_natural`, unit of the factor.
pub fn design_to_csv(design: &Design) -> String {
    let naturals = design
        .factors()
        .iter()
        .map(|f| format!("{}_natural", f.symbol()));
    let names: Vec<String> = design.columns().into_iter().chain(naturals).collect();
    let mut text = format!("run,cell,replicate,block,{}\n", names.join(","));
    for (i, run) in design.runs().iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{},{},{},{}",
            i + 1,
            run.cell,
            run.replicate,
            run.block
        );
        for value in run
            .coded
            .iter()
            .copied()
            .chain(design.natural(i).into_iter().map(rounded))
        {
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

/// The shortest decimal number within a few rounding errors of `value`: 0.36 rather than
/// 0.36000000000000004, which the sum of a bound and half a range gives.
fn rounded(value: f64) -> f64 {
    let short: f64 = format!("{value:.14e}").parse().unwrap_or(value);
    if (short - value).abs() <= 4.0 * f64::EPSILON * value.abs() {
        short
    } else {
        value
    }
}

/// A field in CSV text: in quotes if it needs them; line breaks become spaces, and text that a spreadsheet
/// would run as a formula gets an apostrophe before it.
pub fn csv_field(field: &str) -> String {
    let field = dialect::harmless(field.replace(['\n', '\r'], " "));
    if field.contains([',', '"', ';', '\t']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field
    }
}
