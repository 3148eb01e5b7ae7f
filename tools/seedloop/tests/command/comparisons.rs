//! Transformed responses, pairs of groups, orders and blocks, saturated models, and tables as spreadsheets write them.

use crate::{assert_code, assert_error, fixture, json, seedloop, text};
use serde_json::Value;
use std::fs;
use tempfile::{TempDir, tempdir};

/// Runs the command with words separated by spaces.
fn run(folder: &TempDir, words: &str) -> std::process::Output {
    let words: Vec<&str> = words.split_whitespace().collect();
    seedloop(folder.path(), &words)
}

/// A folder with a table in it.
fn table(content: impl AsRef<[u8]>) -> TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("d.csv"), content).unwrap();
    folder
}

/// The numbers that R gives (`fixtures/r/make_comparisons.R`).
fn by_r() -> Value {
    let text = fs::read_to_string(fixture("r/results_comparisons.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Median, confidence and prediction at 15 mph of `lm(log(dist) ~ speed, cars)` taken back by R's exp (limit: 1e-9). A target of
/// the response is met where its logarithm is.
#[test]
fn a_transformed_response_is_told_in_its_own_unit() {
    let folder = tempdir().unwrap();
    fs::copy(fixture("r/cars.csv"), folder.path().join("d.csv")).unwrap();
    let words =
        "analyse d.csv --factors speed --response y --model linear --transform ln --json a.json";
    let output = run(&folder, words);
    assert_code(&output, 0);
    assert!(text(&output.stdout).starts_with("response: ln(y)\n"));
    let words = "optimise a.json --target 40 --error residual --at speed=15 --json=-";
    let answer = json(&run(&folder, words));
    let at = &answer["original"]["at"];
    let got = [
        &at["median"],
        &at["ci95"][0],
        &at["ci95"][1],
        &at["pi95"][0],
        &at["pi95"][1],
    ];
    for (got, expected) in got.iter().zip(by_r()["logarithm"].as_array().unwrap()) {
        let ratio = got.as_f64().unwrap() / expected.as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 1e-9, "{got} against {expected}");
    }
    assert!((answer["target"].as_f64().unwrap() - 40.0_f64.ln()).abs() < 1e-15);
    let said = run(&folder, "optimise a.json --target 40 --at speed=15");
    let said = text(&said.stdout).to_owned();
    assert!(said.contains("target 40.0000"), "{said}");
    assert_error(
        &run(&folder, "optimise a.json --target -1"),
        &["-1", "ln", "above zero"],
    );
    assert_error(
        &run(&folder, "optimise a.json --goal max"),
        &["--goal", "ln"],
    );
    // dist rises with speed and 1/dist falls: the path up goes to higher speeds.
    let words = "analyse d.csv --factors speed --response y --model linear --transform inverse --json i.json";
    assert_code(&run(&folder, words), 0);
    fs::write(folder.path().join("f.csv"), "symbol,low,high\nspeed,4,25\n").unwrap();
    let words = "design steepest --factors f.csv --analysis i.json --out p.csv --json=-";
    let path = json(&run(&folder, words));
    assert!(
        path["runs"][1]["coded"][0].as_f64().unwrap() > 0.0,
        "{path}"
    );
    let negative = table("x,y\n1,2\n2,-3\n3,4\n");
    let refused = run(
        &negative,
        "analyse d.csv --factors x --response y --model linear --transform sqrt",
    );
    assert_error(&refused, &["line 3", "'y'", "-3", "zero or above"]);
}

/// R's `TukeyHSD` of `PlantGrowth`: trt2 against trt1, p 0.0120064.
#[test]
fn pairs_of_groups_follow_the_one_way_analysis() {
    let folder = tempdir().unwrap();
    fs::copy(fixture("r/plants.csv"), folder.path().join("d.csv")).unwrap();
    let words = "analyse d.csv --groups --factors group --response y --json a.json";
    let output = run(&folder, words);
    assert_code(&output, 0);
    let said = text(&output.stdout);
    assert!(
        said.contains("trt2 - trt1") && said.contains("p 0.0120"),
        "{said}"
    );
    let report: Value =
        serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    let p = report["pairs"][2]["p"].as_f64().unwrap();
    let expected = by_r()["tukey"]["plants"]["p"][2].as_f64().unwrap();
    assert!((p - expected).abs() < 1e-8, "{p} against {expected}");
}

#[test]
fn blocks_and_orders_have_their_tests_and_saturated_models_their_margins() {
    let folder = tempdir().unwrap();
    fs::copy(fixture("r/npk_blocks.csv"), folder.path().join("d.csv")).unwrap();
    let words = "analyse d.csv --factors N,P,K --response y --block block --model (N+P+K)^2";
    let output = run(&folder, words);
    let said = text(&output.stdout);
    // R's anova of the nested models: F 4.447, 6.323, 1.185.
    for (order, f) in [
        ("blocks", "4.447"),
        ("linear", "6.323"),
        ("two-factor", "1.185"),
    ] {
        let line = said
            .lines()
            .find(|line| line.starts_with(&format!("{order}, after")));
        assert!(line.unwrap().contains(f), "{line:?}");
    }
    fs::copy(fixture("r/saturated.csv"), folder.path().join("s.csv")).unwrap();
    let words = "analyse s.csv --coded --factors A,B --response y --model A+B+I(A*B)+I(A^2)+I(B^2)+I(A^2*B) --json=-";
    let report = json(&run(&folder, words));
    let pse = report["contrasts"]["lenth"]["pse"].as_f64().unwrap();
    let expected = by_r()["lenth"]["pse"].as_f64().unwrap();
    assert!(
        (pse / expected - 1.0).abs() < 1e-9,
        "{pse} against {expected}"
    );
}

/// Semicolons, decimal commas and Latin-1 are read as the plain table is: the coefficients agree to the last bit.
#[test]
fn a_table_of_another_country_is_read_alike() {
    let plain =
        "A,wand,y\n-1,röhre,1.5\n-1,glas,2.25\n1,röhre,3.5\n1,glas,4.75\n0,glas,3\n0,röhre,2.6\n";
    let foreign = plain
        .replace(',', ";")
        .replace('.', ",")
        .replace('\n', "\r\n");
    let latin = foreign.chars().map(|c| u8::try_from(u32::from(c)).unwrap());
    let latin: Vec<u8> = latin.collect();
    let words = "analyse d.csv --factors A --categories wand --response y --model A+wand --json=-";
    let analysis = |content: &[u8]| {
        let report = json(&run(&table(content), words));
        (report["terms"].clone(), report["categories"].clone())
    };
    assert_eq!(analysis(plain.as_bytes()), analysis(&latin));
    assert_eq!(analysis(plain.as_bytes()), analysis(foreign.as_bytes()));
}

/// A level that a spreadsheet would run is written with an apostrophe, and read back as it was meant.
#[test]
fn a_level_that_looks_like_a_formula_is_harmless_in_a_table() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("f.csv"), "symbol,low,high\nA,0,1\n").unwrap();
    let words = [
        "design",
        "full",
        "--factors",
        "f.csv",
        "--replicates",
        "2",
        "--category",
        "wall==HYPERLINK(A1):steel",
        "--out",
        "d.csv",
    ];
    assert_code(&seedloop(folder.path(), &words), 0);
    let design = fs::read_to_string(path("d.csv")).unwrap();
    assert!(
        design.contains(",'=HYPERLINK(A1)\n") && !design.contains(",=HYPERLINK"),
        "{design}"
    );
    let line = |(i, line): (usize, &str)| {
        let response = if i == 0 {
            "y".to_owned()
        } else {
            (i * i % 7).to_string()
        };
        format!("{line},{response}\n")
    };
    let with_response: Vec<String> = design.lines().enumerate().map(line).collect();
    fs::write(path("r.csv"), with_response.concat()).unwrap();
    let report = json(&run(
        &folder,
        "analyse r.csv --factors A --categories wall --response y --model A+wall --json=-",
    ));
    assert_eq!(
        report["categories"][0]["levels"],
        serde_json::json!(["=HYPERLINK(A1)", "steel"])
    );
}
