//! Tests of named levels agree with those of R (`fixtures/r/make_levels.R`).
//!
//! Limit: 1e-9 relative; sums of squares are differences of two residual sums, which costs two of the
//! fourteen digits on these sets.

use crate::{code_column, column, texts};
use dev_support::fixture_files::fixture;
use experiment_design::table::Table;
use response_surface::{
    Categorical, CategoricalModel, Cell, GroupRow, Observations, Weighting, fit_weighted,
};
use serde_json::Value;
use std::error::Error;

fn compare(folder: &std::path::Path, name: &str, r: &Value) -> Result<(), Box<dyn Error>> {
    let table = Table::parse(&std::fs::read_to_string(
        folder.join(format!("{name}.csv")),
    )?)?;
    let mut coded = vec![Vec::new(); table.rows().len()];
    let mut numeric = Vec::new();
    for symbol in texts(&r["numeric"]) {
        numeric.push(code_column(&table, &symbol, &mut coded)?);
    }
    let mut named = Vec::new();
    for symbol in texts(&r["named"]) {
        let place = table.column(&symbol)?;
        let labels: Vec<&str> = table.rows().iter().map(|row| row.text(place)).collect();
        let mut levels: Vec<String> = labels.iter().map(|l| (*l).to_owned()).collect();
        levels.sort();
        levels.dedup();
        let factor = Categorical::new(&symbol, levels)?;
        for (row, label) in coded.iter_mut().zip(labels) {
            row.extend(factor.coded(label).ok_or("no such level")?);
        }
        named.push(factor);
    }
    let y = column(&table, "y")?;
    let cells = coded.into_iter().zip(y).map(|(x, y)| Cell::single(x, y));
    let data = Observations::from_cells(cells.collect())?;
    let formula = texts(&r["terms"]).join(" + ");
    let model = CategoricalModel::parse(&formula, &numeric, &named)?;
    let fit = fit_weighted(&model.factors, &model.model, &data, Weighting::Counts)?;
    let tests = model.tests(&fit, &data, Weighting::Counts)?;
    let close = |what: &str, value: &dyn Fn(&GroupRow) -> f64| {
        let expected = r[what].as_array().into_iter().flatten();
        let expected: Vec<f64> = expected.filter_map(Value::as_f64).collect();
        assert_eq!(tests.len(), expected.len());
        for (row, e) in tests.values().zip(expected) {
            let got = value(row);
            assert!(
                (got / e - 1.0).abs() < 1e-9,
                "{name}, {what}: {got} against {e}"
            );
        }
    };
    let of = |x: Option<f64>| x.unwrap_or(f64::NAN);
    close("df", &|row| row.df as f64);
    close("type_i", &|row| row.type_i.ss);
    close("type_ii", &|row| row.type_ii.ss);
    close("type_iii", &|row| row.type_iii.ss);
    close("f_iii", &|row| {
        of(row.type_iii.test.as_ref().and_then(|t| t.f))
    });
    close("p_iii", &|row| {
        of(row.type_iii.test.as_ref().and_then(|t| t.p))
    });
    let r2 = r["r2"].as_f64().unwrap_or(f64::NAN);
    assert!((of(fit.r2) / r2 - 1.0).abs() < 1e-9);
    Ok(())
}

#[test]
fn all_types_of_sums_of_squares_of_named_levels_agree_with_r() {
    let folder = fixture("r");
    let text = std::fs::read_to_string(folder.join("results_levels.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    let sets = results["levels"].as_object().unwrap();
    assert_eq!(sets.len(), 3);
    for (name, r) in sets {
        compare(&folder, name, r).unwrap();
    }
}
