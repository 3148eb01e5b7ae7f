//! The analyses reproduce the recomputation of the published study, key by key.
//!
//! Tolerance: relative 1e-9, absolute 1e-9 where the expected value is 0. The expected values
//! are exact to double precision; the fits lose about 1e-13, the tails of the incomplete beta
//! function about 1e-12.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::table::{Table, factors_from_csv};
use experiment_design::{Factor, plackett_burman};
use response_surface::{
    Cell, Fit, Model, Observations, Weighting, alias_matrix, fit, fit_weighted, screen,
};
use serde_json::{Value, json};

const PB: &str = include_str!("../../../../fixtures/paper/pb_table3.csv");
const BBD: &str = include_str!("../../../../fixtures/paper/bbd_table5.csv");

fn recomputed() -> Value {
    serde_json::from_str(include_str!("../../../../fixtures/paper/recomputed.json")).unwrap()
}

/// Factors of Table 2 with these symbols.
fn factors(symbols: &[&str]) -> Vec<Factor> {
    let all = factors_from_csv(include_str!(
        "../../../../fixtures/paper/factors_table2.csv"
    ))
    .unwrap();
    all.into_iter()
        .filter(|f| symbols.contains(&f.symbol()))
        .collect()
}

/// Cells of a table with these columns as coded values.
fn cells(text: &str, columns: &[&str]) -> Vec<Cell> {
    let table = Table::parse(text).unwrap();
    let number = |row, name| table.number(row, table.column(name).unwrap()).unwrap();
    let cell = |row| Cell {
        coded: columns.iter().map(|c| number(row, c)).collect(),
        mean: number(row, "theta_deg"),
        sd: Some(number(row, "theta_sd_deg")),
        n: table.count(row, "n_rep").unwrap().unwrap(),
        block: 1,
    };
    table.rows().iter().map(cell).collect()
}

fn bbd(formula: &str) -> Fit {
    let factors = factors(&["B", "E", "F"]);
    let data = Observations::from_cells(cells(BBD, &["B", "E", "F"])).unwrap();
    fit(&factors, &Model::parse(formula, &factors).unwrap(), &data).unwrap()
}

/// Asserts that all of `expected` is in `got`; keys in `skip` are compared elsewhere.
fn assert_within(got: &Value, expected: &Value, place: &str, skip: &[&str]) {
    match expected {
        Value::Object(map) => {
            assert!(!map.is_empty(), "nothing to compare at {place}");
            for (key, value) in map.iter().filter(|(key, _)| !skip.contains(&key.as_str())) {
                let got = got
                    .get(key)
                    .unwrap_or_else(|| panic!("{place}.{key} is missing"));
                assert_within(got, value, &format!("{place}.{key}"), skip);
            }
        }
        Value::Array(list) => {
            let got = got
                .as_array()
                .unwrap_or_else(|| panic!("{place} is not a list"));
            assert_eq!(got.len(), list.len(), "length of {place}");
            for (i, (got, value)) in got.iter().zip(list).enumerate() {
                assert_within(got, value, &format!("{place}[{i}]"), skip);
            }
        }
        Value::Number(number) => {
            let expected = number.as_f64().unwrap();
            let got = got
                .as_f64()
                .unwrap_or_else(|| panic!("{place} is {got}, not {expected}"));
            let error = (got - expected).abs();
            let limit = if expected == 0.0 {
                1e-9
            } else {
                1e-9 * expected.abs()
            };
            assert!(error <= limit, "{place}: got {got}, expected {expected}");
        }
        other => assert_eq!(got, other, "at {place}"),
    }
}

#[test]
fn screening_reproduces_main_effects_saturated_pareto_and_replicate_tests() {
    let expected = recomputed();
    let design = plackett_burman(&factors(&["A", "B", "C", "D", "E", "F"])).unwrap();
    let columns = design.columns();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let data = Observations::from_cells(cells(PB, &columns)).unwrap();
    let screening = screen(&design, &data).unwrap();
    let got = json!(screening);
    assert_within(
        &got["main_effects"],
        &expected["pb_main_effects"],
        "main effects",
        &[],
    );
    assert_within(
        &got["saturated"],
        &expected["pb_saturated"],
        "saturated",
        &["definition"],
    );
    let pareto = json!({
        "t_abs": got["pareto"]["t_abs"],
        "sign": got["pareto"]["sign"],
        "t_limit_df5": got["pareto"]["t_limit"],
        "bonferroni_k6_df5": got["pareto"]["bonferroni_terms"],
        "bonferroni_k11_df5": got["pareto"]["bonferroni_columns"],
    });
    assert_within(&pareto, &expected["pb_pareto"], "pareto", &[]);
    assert_eq!(
        got["pareto"]["order"],
        json!(["F", "B", "E", "D", "A", "C"])
    );
    let replicates = &got["main_effects"]["replicates"];
    assert_within(
        replicates,
        &expected["pb_replicates"],
        "replicates",
        &["tests"],
    );
    let tests = &expected["pb_replicates"]["tests"];
    assert_within(&got["replicate_tests"], tests, "replicate tests", &[]);
    let ranks: Vec<&str> = screening
        .factors
        .iter()
        .map(|f| f.factor.as_str())
        .collect();
    assert_eq!(ranks, ["F", "B", "E", "D", "A", "C"]);
}

#[test]
fn quadratic_of_the_box_behnken_table_is_reproduced_in_full() {
    let got = json!(bbd("quadratic"));
    let skip = ["eigenvectors_columns", "kind"];
    assert_within(&got, &recomputed()["bbd_quadratic"], "quadratic", &skip);
    assert_eq!(got["canonical"]["kind"], "saddle");
    assert_eq!(got["canonical"]["inside_box"], false);
}

/// Eigenvectors are defined up to their sign.
#[test]
fn eigenvectors_are_reproduced_up_to_sign() {
    let canonical = bbd("quadratic").canonical.unwrap();
    let expected = &recomputed()["bbd_quadratic"]["canonical"]["eigenvectors_columns"];
    for column in 0..3 {
        let pairs = (0..3).map(|row| {
            let expected = expected[row][column].as_f64().unwrap();
            canonical.eigenvectors_columns[row][column] * expected
        });
        let cosine: f64 = pairs.sum();
        assert!(
            (cosine.abs() - 1.0).abs() < 1e-9,
            "column {column}: cosine {cosine}"
        );
    }
}

#[test]
fn reduced_model_is_reproduced_in_full() {
    let expected = &recomputed()["bbd_reduced_B_E_F_BF_B2"];
    assert_within(
        &json!(bbd("1 + B + E + F + B:F + B^2")),
        expected,
        "reduced",
        &[],
    );
}

/// Replicates give the variance that the weighted residuals have: five runs a cell with sd 1 or 3, weights by
/// inverse variance. A mean has the variance 1/5 or 9/5, the weights of mean 1 are 9/5 and 1/5, so a mean of weight 1 has
/// the variance 9/25, and a run of the pooled variance 5 is 125/9 times as variable.
#[test]
fn replicates_have_the_scale_of_the_weights() {
    let factors = factors(&["B", "E", "F"]);
    let cells = (0..8).map(|k| {
        let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Cell {
            coded: vec![sign(0), sign(1), sign(2)],
            mean: 10.0 + sign(0) + 0.3 * sign(1) * sign(2),
            sd: Some(if k % 2 == 0 { 1.0 } else { 3.0 }),
            n: 5,
            block: 1,
        }
    });
    let data = Observations::from_cells(cells.collect()).unwrap();
    let model = Model::parse("1 + B + E + F", &factors).unwrap();
    let got = fit_weighted(&factors, &model, &data, Weighting::InverseVariance).unwrap();
    let replicates = got.replicates.as_ref().unwrap();
    assert!((replicates.var_of_run_mean - 0.36).abs() < 1e-12);
    assert!((got.runs_of_unit_weight() - 125.0 / 9.0).abs() < 1e-9);
    let f = replicates
        .lack_of_fit_vs_replicates
        .as_ref()
        .and_then(|test| test.f);
    assert!((f.unwrap() - got.mse.unwrap() / 0.36).abs() < 1e-9);
}

/// The weights here are scaled to mean 1, so the unscaled standard errors and the weighted sum
/// of squares are compared after undoing that scale.
#[test]
fn inverse_variance_weights_are_reproduced() {
    let expected = &recomputed()["bbd_wls"];
    let factors = factors(&["B", "E", "F"]);
    let cells = cells(BBD, &["B", "E", "F"]);
    let scale = cells
        .iter()
        .map(|c| c.n as f64 / c.sd.unwrap().powi(2))
        .sum::<f64>()
        / cells.len() as f64;
    let data = Observations::from_cells(cells).unwrap();
    let model = Model::quadratic(&factors).unwrap();
    let got = fit_weighted(&factors, &model, &data, Weighting::InverseVariance).unwrap();
    for (j, (name, row)) in got.terms.iter().enumerate() {
        let unscaled = (got.xtx_inverse[j][j] / scale).sqrt();
        let got = json!({"coef": row.coef, "se_scaled": row.se, "se_unscaled": unscaled});
        assert_within(&got, &expected["terms"][name], name, &[]);
    }
    let sse = json!({"weighted_sse": got.sse * scale, "scale": got.mse.unwrap() * scale});
    let wanted = json!({"weighted_sse": expected["weighted_sse"], "scale": expected["scale"]});
    assert_within(&sse, &wanted, "weighted", &[]);
}

#[test]
fn predictions_at_the_named_points_are_reproduced() {
    let fit = bbd("quadratic");
    let expected = recomputed();
    for point in expected["predictions"].as_array().unwrap() {
        let natural: Vec<f64> = serde_json::from_value(point["natural"].clone()).unwrap();
        let got = json!(fit.predict(&natural).unwrap());
        assert_within(&got, point, "prediction", &["label"]);
    }
}

/// Both tables together, A, C and D of the Box-Behnken runs at the measured means: a design that
/// is not orthogonal.
#[test]
fn joint_fit_of_both_tables_is_reproduced() {
    let symbols = ["A", "B", "C", "D", "E", "F"];
    let factors = factors(&symbols);
    let mut all = cells(PB, &symbols);
    let measured = [("A", 0.13), ("C", 0.12), ("D", 0.29)];
    for mut cell in cells(BBD, &["B", "E", "F"]) {
        let coded = |symbol: &str| {
            let factor = factors.iter().find(|f| f.symbol() == symbol).unwrap();
            match measured.iter().find(|(s, _)| *s == symbol) {
                Some((_, value)) => factor.coded(*value),
                None => cell.coded[["B", "E", "F"].iter().position(|s| *s == symbol).unwrap()],
            }
        };
        cell.coded = symbols.iter().map(|s| coded(s)).collect();
        all.push(cell);
    }
    let formula = "A + B + C + D + E + F + B:E + B:F + E:F + B^2 + E^2 + F^2";
    let model = Model::parse(formula, &factors).unwrap();
    let got = fit(&factors, &model, &Observations::from_cells(all).unwrap()).unwrap();
    let mut expected = recomputed()["joint_pb_bbd_29_runs"].clone();
    // There the runs are numbered within their table.
    for case in expected["cases"].as_array_mut().unwrap() {
        case.as_object_mut().unwrap().remove("run");
    }
    assert_within(&json!(got), &expected, "joint", &[]);
}

#[test]
fn aliases_of_the_interactions_on_the_screening_columns_are_thirds() {
    let design = plackett_burman(&factors(&["A", "B", "C", "D", "E", "F"])).unwrap();
    let got = json!(alias_matrix(&design).unwrap());
    assert_within(
        &got,
        &recomputed()["pb_alias_on_bbd_interactions"],
        "alias",
        &[],
    );
}

/// A fit written as JSON and read back answers as before, but for the last bit of the decimal
/// numbers: the file is all that `optimise` needs.
#[test]
fn a_fit_is_read_back_from_its_json() {
    let fit = bbd("quadratic");
    let read: Fit = serde_json::from_str(&serde_json::to_string(&fit).unwrap()).unwrap();
    assert_eq!(read.formula, fit.formula);
    let point = [0.31, 0.05, 0.07];
    let (got, expected) = (
        json!(read.predict(&point).unwrap()),
        json!(fit.predict(&point).unwrap()),
    );
    assert_within(&got, &expected, "prediction", &[]);
}
