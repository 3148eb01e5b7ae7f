//! The designs are the published study's, run for run.

#![expect(
    clippy::unwrap_used,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::table::Table;
use experiment_design::{Design, Factor, box_behnken, plackett_burman};

/// Coded rows of the named columns of a fixture.
fn rows(text: &str, columns: &[String]) -> Vec<Vec<f64>> {
    let table = Table::parse(text).unwrap();
    let places: Vec<usize> = columns.iter().map(|c| table.column(c).unwrap()).collect();
    let row = |row| {
        places
            .iter()
            .map(|&c| table.number(row, c).unwrap())
            .collect()
    };
    table.rows().iter().map(row).collect()
}

fn factors(symbols: &[&str]) -> Vec<Factor> {
    symbols
        .iter()
        .map(|s| Factor::coded_only(s).unwrap())
        .collect()
}

/// Exact: the tables hold -1, 0 and +1.
fn assert_same(design: &Design, text: &str) {
    assert_eq!(design.coded_rows(), rows(text, &design.columns()));
}

#[test]
fn plackett_burman_of_six_factors_is_table_3_with_its_dummies() {
    let design = plackett_burman(&factors(&["A", "B", "C", "D", "E", "F"])).unwrap();
    assert_eq!(design.dummies(), ["G", "H", "J", "K", "L"]);
    assert_same(
        &design,
        include_str!("../../../fixtures/paper/pb_table3.csv"),
    );
}

#[test]
fn box_behnken_of_three_factors_is_table_5_in_its_order() {
    let design = box_behnken(&factors(&["B", "E", "F"]), 5).unwrap();
    assert_same(
        &design,
        include_str!("../../../fixtures/paper/bbd_table5.csv"),
    );
}
