//! What fitted surfaces say beyond their coefficients, against R (`fixtures/r/make_surfaces.R`).

use std::fs;
use std::iter;

use crate::{assert_code, assert_error, fixture, json, seedloop, text, words_in};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

fn by_r() -> Value {
    let text = fs::read_to_string(fixture("r/results_surfaces.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// A folder with a data set of R as `d.csv`.
fn data(set: &str) -> TempDir {
    let folder = tempdir().unwrap();
    fs::copy(
        fixture(&format!("r/{set}.csv")),
        folder.path().join("d.csv"),
    )
    .unwrap();
    folder
}

fn words_of(list: &Value) -> Vec<&str> {
    list.as_array().map_or_else(
        || vec![list.as_str().unwrap()],
        |all| all.iter().map(|w| w.as_str().unwrap()).collect(),
    )
}

/// Each number of a list as it is written in JSON.
fn words_of_numbers(list: &Value) -> Vec<String> {
    let numbers = list.as_array().expect("a list").iter();
    numbers.map(Value::to_string).collect()
}

/// Shares of four fitted surfaces, one of them over named levels, are those that R finds by Gauss's rule with six nodes a
/// factor, exact for these polynomials (limit: 1e-9, rounding of a fit and a sum over up to 216 nodes).
#[test]
fn shares_of_the_variance_are_those_of_numerical_integration() {
    for (set, case) in by_r()["sobol"].as_object().unwrap() {
        let folder = data(set);
        let symbols = words_of(&case["symbols"]).join(",");
        let columns = if set == "warp" {
            "--categories"
        } else {
            "--factors"
        };
        let model = case["model"].as_str().unwrap();
        let words = [
            "analyse",
            "d.csv",
            columns,
            &symbols,
            "--response",
            "y",
            "--model",
            model,
            "--sensitivity",
            "--json=-",
        ];
        let output = seedloop(folder.path(), &words);
        assert_code(&output, 0);
        let got = &json(&output)["sobol"];
        let near = |got: &Value, expected: &Value, what: &str| {
            let (got, expected) = (got.as_f64().unwrap(), expected.as_f64().unwrap());
            let scale = expected.abs().max(1.0);
            assert!(
                (got - expected).abs() < 1e-9 * scale,
                "{set}, {what}: {got} for {expected}"
            );
        };
        near(&got["variance"], &case["variance"], "variance");
        for part in ["first", "total"] {
            for (symbol, expected) in case[part].as_object().unwrap() {
                near(&got["factors"][symbol][part]["share"], expected, symbol);
            }
        }
        for (pair, expected) in case["pairs"].as_object().unwrap() {
            near(&got["pairs"][pair]["share"], expected, pair);
        }
    }
}

/// The table of shares: the largest first, with what noise would make; a model through zero has no surface over ranges.
#[test]
fn shares_are_printed_largest_first() {
    let folder = data("swiss");
    let words = [
        "analyse",
        "d.csv",
        "--factors",
        "Agriculture,Education,Catholic",
        "--response",
        "y",
        "--sensitivity",
    ];
    let output = seedloop(folder.path(), &[&words[..], &["--model", "2fi"]].concat());
    assert_code(&output, 0);
    let said = text(&output.stdout);
    let after = said.split("shares of the variance").nth(1).unwrap();
    let lines: Vec<&str> = after.lines().skip(1).take(4).collect();
    assert!(
        lines[0].contains("Education") && lines[0].contains(" 83.9 ("),
        "{said}"
    );
    assert!(lines[0].contains(" 91.9 ("), "{said}");
    assert!(
        lines[1].contains("Catholic") && lines[2].contains("Agriculture"),
        "{said}"
    );
    assert!(lines[3].contains("Education:Catholic"), "{said}");
    let output = seedloop(
        folder.path(),
        &[&words[..], &["--model", "0 + Education"]].concat(),
    );
    assert_error(&output, &["--sensitivity", "intercept"]);
}

/// Gaussian processes of two data sets at points inside and outside the data, with the noise of a run fitted: R
/// finds no likelihood that is greater by more than 1e-3 in -2 ln L, which is not evidence (`cars` has a
/// ridge that is flat up to the longest length searched), and mean, standard error and interval of a run agree to 0.5 % of that
/// interval.
#[test]
fn processes_predict_with_their_own_noise_as_r_does() {
    for (set, case) in by_r()["processes"].as_object().unwrap() {
        let folder = data(set);
        let symbols = words_of(&case["symbols"]).join(",");
        let rows = case["at"].as_array().unwrap();
        let points = rows.iter().map(|row| words_of_numbers(row).join(","));
        let points: Vec<String> = iter::once(symbols.clone()).chain(points).collect();
        fs::write(folder.path().join("points.csv"), points.join("\n")).unwrap();
        let words = format!(
            "analyse d.csv --factors {symbols} --response y --model linear --gaussian-process --predict points.csv --json=-"
        );
        let output = words_in(folder.path(), &words);
        assert_code(&output, 0);
        let report = json(&output);
        let process = &report["gaussian_process"]["process"];
        let likelihood = process["minus_2_log_likelihood"].as_f64().unwrap();
        let by_r = case["minus_2_log_likelihood"].as_f64().unwrap();
        assert!(likelihood < by_r + 1e-3, "{set}: {likelihood} for {by_r}");
        let predictions = report["predictions"].as_array().unwrap();
        assert_eq!(predictions.len(), rows.len());
        for (i, predicted) in predictions.iter().enumerate() {
            let got = &predicted["gaussian_process"];
            let of = |key: &str| case[key][i].as_f64().unwrap();
            let width = of("high") - of("low");
            for (value, key) in [
                (&got["mean"], "mean"),
                (&got["se_mean"], "se_mean"),
                (&got["pi95"][0], "low"),
                (&got["pi95"][1], "high"),
            ] {
                let value = value.as_f64().unwrap();
                assert!(
                    (value - of(key)).abs() < 0.005 * width,
                    "{set}, {key}, row {i}: {value} for {}",
                    of(key)
                );
            }
        }
    }
}

/// Levels and columns that the data lack are refused with their place.
#[test]
fn a_table_of_points_that_the_data_lack_is_refused() {
    let folder = data("warp");
    let words = "analyse d.csv --categories wool,tension --response y --model 2fi --predict p.csv";
    for (points, says) in [
        (
            "wool,tension\nA,L\nB,X\n",
            &["p.csv", "line 3", "'X'", "H, L, M"][..],
        ),
        ("wool\nA\n", &["p.csv", "no column 'tension'"]),
    ] {
        fs::write(folder.path().join("p.csv"), points).unwrap();
        assert_error(&words_in(folder.path(), words), says);
    }
}

/// Predictions of the polynomial are those of `optimise --at`, and coded tables of `design` are read by their natural columns.
#[test]
fn a_table_of_points_is_read_as_the_data_are() {
    let folder = data("trees");
    let points = "Girth,Girth_natural,Height\n9,12,75\n";
    fs::write(folder.path().join("p.csv"), points).unwrap();
    let words = "analyse d.csv --factors Girth,Height --response y --predict p.csv --transform ln --json a.json";
    let output = words_in(folder.path(), words);
    assert_code(&output, 0);
    let said = text(&output.stdout);
    assert!(
        said.contains("line 2 ") && said.contains("median"),
        "{said}"
    );
    let analysis = fs::read_to_string(folder.path().join("a.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    let words = "optimise a.json --target 20 --at Girth=12,Height=75 --error residual --json=-";
    let at = &json(&words_in(folder.path(), words))["at"];
    let predicted = &analysis["predictions"][0]["polynomial"];
    for key in ["mean", "se_mean", "se_pred"] {
        let (got, expected) = (predicted[key].as_f64().unwrap(), at[key].as_f64().unwrap());
        assert!(
            (got - expected).abs() < 1e-12,
            "{key}: {got} for {expected}"
        );
    }
}
