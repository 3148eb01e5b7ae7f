//! Fits with random blocks agree with those of R's `lme4` and `lmerTest`, and factors of tolerance intervals
//! with R's numerical integration (`fixtures/r/make_blocks.R`).
//!
//! Limits: 1e-5 relative for fits; `lme4` stops within about 1e-7 of the best ratio of the variances and
//! `lmerTest` takes its degrees of freedom from numerical derivatives. 1e-8 for factors; the 240 steps of
//! Simpson's rule leave 1e-9.

use crate::{code_column, column, texts};
use dev_support::fixture_files::fixture;
use experiment_design::Factor;
use experiment_design::table::Table;
use response_surface::{
    Cell, Model, Observations, RandomBlockTerm, RandomBlocks, Weighting, random_blocks,
    tolerance_factor,
};
use serde_json::Value;
use std::error::Error;
use std::path::PathBuf;

fn folder() -> PathBuf {
    fixture("r")
}

fn results() -> Result<Value, Box<dyn Error>> {
    let text = std::fs::read_to_string(folder().join("results_blocks.json"))?;
    Ok(serde_json::from_str(&text)?)
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().into_iter().flatten();
    list.filter_map(Value::as_f64).collect()
}

/// Asserts that two lists agree relative to their entries, or to a thousandth of the greatest.
fn close(got: &[f64], expected: &[f64], what: &str) {
    assert_eq!(got.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for (g, e) in got.iter().zip(expected) {
        let gap = (g - e).abs() / e.abs().max(1e-3 * size);
        assert!(gap < 1e-5, "{what}: {g} against {e}");
    }
}

fn compare(name: &str, r: &Value) -> Result<(), Box<dyn Error>> {
    let table = Table::parse(&std::fs::read_to_string(
        folder().join(format!("{name}.csv")),
    )?)?;
    let mut factors = Vec::new();
    let mut coded = vec![Vec::new(); table.rows().len()];
    for symbol in texts(&r["factors"]) {
        factors.push(code_column(&table, &symbol, &mut coded)?);
    }
    if factors.is_empty() {
        factors.push(Factor::coded_only("none")?);
        for row in &mut coded {
            row.push(0.0);
        }
    }
    let batches: Vec<String> = table
        .rows()
        .iter()
        .map(|row| row.text(0).to_owned())
        .collect();
    let mut names = batches.clone();
    names.sort();
    names.dedup();
    let y = column(&table, "y")?;
    let mut cells = Vec::new();
    for (i, row) in table.rows().iter().enumerate() {
        cells.push(Cell {
            n: table.count(row, "n")?.unwrap_or(1),
            block: 1 + names.binary_search(&batches[i]).unwrap_or(0),
            ..Cell::single(coded[i].clone(), y[i])
        });
    }
    let formula = [vec!["1".to_owned()], texts(&r["terms"])].concat();
    let model = Model::parse(&formula.join(" + "), &factors)?;
    let data = Observations::from_cells(cells)?;
    let got = random_blocks(&factors, &model, &data, Weighting::Counts)?;
    agree(name, &got, r);
    Ok(())
}

/// Every figure of a fit against R's.
fn agree(name: &str, got: &RandomBlocks, r: &Value) {
    let terms = |value: &dyn Fn(&RandomBlockTerm) -> f64| -> Vec<f64> {
        got.terms.values().map(value).collect()
    };
    let one = |key: &str| [r[key].as_f64().unwrap_or(f64::NAN)];
    let of = |what: &str| format!("{name}, {what}");
    close(&[got.block_sd], &one("block_sd"), &of("sd of blocks"));
    close(&[got.residual_sd], &one("residual_sd"), &of("residual sd"));
    let likelihood = got.minus_2_restricted_log_likelihood;
    close(
        &[likelihood],
        &one("minus_2_log_likelihood"),
        &of("likelihood"),
    );
    close(
        &terms(&|t| t.coef),
        &numbers(&r["coef"]),
        &of("coefficients"),
    );
    close(
        &terms(&|t| t.se),
        &numbers(&r["se"]),
        &of("standard errors"),
    );
    let df = terms(&|t| t.df.unwrap_or(f64::NAN));
    close(&df, &numbers(&r["df"]), &of("degrees of freedom"));
    // A p of 1e-20 carries the relative error of its t about fifty times over.
    let logs = |list: &[f64]| -> Vec<f64> { list.iter().map(|p| p.ln()).collect() };
    let p = logs(&terms(&|t| t.p.unwrap_or(f64::NAN)));
    close(&p, &logs(&numbers(&r["p"])), &of("ln p"));
    close(
        &got.deviations,
        &numbers(&r["deviations"]),
        &of("deviations"),
    );
}

#[test]
fn random_blocks_agree_with_lme4_and_lmer_test() {
    let results = results().unwrap();
    let fits = results["random_blocks"].as_object().unwrap();
    assert_eq!(fits.len(), 5);
    for (name, r) in fits {
        compare(name, r).unwrap();
    }
}

/// 3.393 for ten runs and 36.519 for two at 95 % and 95 % are also the printed factors of ISO 16269-6.
#[test]
fn tolerance_factors_agree_with_numerical_integration_by_r() {
    let results = results().unwrap();
    let cases = results["tolerance_factors"].as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let case = numbers(case);
        let got = tolerance_factor(case[0], case[1], case[2], case[3]).unwrap();
        assert!((got / case[4] - 1.0).abs() < 1e-8, "{case:?}: {got}");
    }
    assert_eq!(tolerance_factor(0.1, 9.0, 1.0, 0.95), None);
    assert_eq!(tolerance_factor(0.1, 0.0, 0.9, 0.95), None);
    let ten = tolerance_factor(0.1, 9.0, 0.95, 0.95).unwrap();
    assert_eq!(format!("{ten:.3}"), "3.393");
}
