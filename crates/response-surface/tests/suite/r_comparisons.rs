//! Pairs of groups, tests by order and block, and Lenth's margins agree with R (`fixtures/r/make_comparisons.R`).

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::fixture_files::fixture;
use experiment_design::Factor;
use experiment_design::table::Table;
use response_surface::{Cell, Fit, Model, Observations, contrasts, fit, one_way};
use serde_json::Value;
use std::path::PathBuf;

fn folder() -> PathBuf {
    fixture("r")
}

fn results() -> Value {
    let text = std::fs::read_to_string(folder().join("results_comparisons.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn table(name: &str) -> Table {
    Table::parse(&std::fs::read_to_string(folder().join(name)).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.map(|x| x.as_f64().unwrap()).collect()
}

/// Both integrate numerically, R adaptively to 1e-10; 1e-8 of the tail is asked for, down to tails of 1e-5.
#[test]
fn tails_of_the_studentized_range_agree_with_r() {
    let r = &results()["range"];
    let [q, df, p] = ["q", "df", "p"].map(|name| numbers(&r[name]));
    let k: Vec<usize> = serde_json::from_value(r["k"].clone()).unwrap();
    assert_eq!(p.len(), 96);
    for i in 0..p.len() {
        let got = probability::studentized_range_upper_tail(q[i], k[i], df[i]).unwrap();
        assert!(
            (got / p[i] - 1.0).abs() < 1e-8,
            "q {} k {} df {}: {got} against {}",
            q[i],
            k[i],
            df[i],
            p[i]
        );
    }
}

/// Differences to rounding; intervals to 1e-4 of their width, because R's qtukey stops its iteration at 1e-4; p to
/// 1e-8, which R's ptukey reaches at these degrees of freedom.
#[test]
fn pairs_of_groups_agree_with_r() {
    let r = &results()["tukey"];
    for name in ["insects", "plants", "chicks"] {
        let table = table(&format!("{name}.csv"));
        let (group, y) = (table.column("group").unwrap(), table.column("y").unwrap());
        let mut rows: Vec<(String, f64)> = table
            .rows()
            .iter()
            .map(|row| (row.text(group).to_owned(), table.number(row, y).unwrap()))
            .collect();
        // R takes groups in the order of their names.
        rows.sort_by(|a, b| a.0.cmp(&b.0));
        let (groups, values): (Vec<String>, Vec<f64>) = rows.into_iter().unzip();
        let pairs = one_way(&groups, &values).unwrap().pairs().unwrap();
        let expected = &r[name];
        let names = expected["pairs"].as_array().unwrap();
        assert_eq!(pairs.len(), names.len());
        let [diff, low, high, p] = ["diff", "low", "high", "p"].map(|key| numbers(&expected[key]));
        for (i, pair) in pairs.iter().enumerate() {
            assert_eq!(
                format!("{}-{}", pair.group, pair.less),
                names[i].as_str().unwrap()
            );
            let width = high[i] - low[i];
            assert!((pair.difference - diff[i]).abs() < 1e-12 * width.max(diff[i].abs()));
            let ends = [
                (pair.simultaneous95[0], low[i]),
                (pair.simultaneous95[1], high[i]),
            ];
            assert!(
                ends.iter().all(|(got, e)| (got - e).abs() < 1e-4 * width),
                "{pair:?}"
            );
            assert!((pair.p - p[i]).abs() < 1e-8, "{pair:?} against {}", p[i]);
        }
    }
}

/// A table fitted with the given factors and, if there is one, its column of blocks.
fn fitted(name: &str, symbols: &[&str], formula: &str) -> Fit {
    let table = table(name);
    let y = table.column("y").unwrap();
    let block = table.column("block").ok();
    let mut factors = Vec::new();
    let mut columns = Vec::new();
    for symbol in symbols {
        let place = table.column(symbol).unwrap();
        let values = table
            .rows()
            .iter()
            .map(|row| table.number(row, place).unwrap());
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        factors.push(Factor::new(symbol, "", "1", low, high).unwrap());
        columns.push(place);
    }
    let cell = |row: &experiment_design::table::Row| {
        let coded = factors.iter().zip(&columns);
        let coded = coded.map(|(f, &place)| f.coded(table.number(row, place).unwrap()));
        Cell {
            block: block.map_or(1, |place| row.text(place).parse().unwrap()),
            ..Cell::single(coded.collect(), table.number(row, y).unwrap())
        }
    };
    let data = Observations::from_cells(table.rows().iter().map(cell).collect()).unwrap();
    fit(&factors, &Model::parse(formula, &factors).unwrap(), &data).unwrap()
}

/// Limit: 1e-9 relative, as the other comparisons; the residuals are small differences of large sums.
#[test]
fn tests_by_order_and_block_agree_with_r() {
    let r = &results()["by_order"];
    // N:P:K is confounded with blocks, the other products are not.
    let fit = fitted("npk_blocks.csv", &["N", "P", "K"], "(N + P + K)^2");
    let names: Vec<&str> = fit.by_order.iter().map(|row| row.order.as_str()).collect();
    assert_eq!(names, ["blocks", "linear", "two-factor"]);
    let [ss, df, f, p] = ["ss", "df", "f", "p"].map(|key| numbers(&r[key]));
    for (i, row) in fit.by_order.iter().enumerate() {
        assert_eq!(row.test.df1 as f64, df[i]);
        for (got, expected) in [
            (row.ss, ss[i]),
            (row.test.f.unwrap(), f[i]),
            (row.test.p.unwrap(), p[i]),
        ] {
            assert!(
                (got / expected - 1.0).abs() < 1e-9,
                "{row:?} against {expected}"
            );
        }
    }
}

/// Seven runs and seven terms that are not orthogonal. Limit: 1e-9 relative.
#[test]
fn lenths_margins_of_a_saturated_model_agree_with_r() {
    let r = &results()["lenth"];
    let fit = fitted(
        "saturated.csv",
        &["A", "B"],
        "A + B + I(A*B) + I(A^2) + I(B^2) + I(A^2*B)",
    );
    let got = contrasts(&fit).unwrap();
    assert!(!got.orthogonal);
    for (value, expected) in got.contrasts.values().zip(numbers(&r["contrast"])) {
        assert!((value.abs() / expected - 1.0).abs() < 1e-9, "{got:?}");
    }
    let lenth = &got.lenth;
    for (value, key) in [
        (lenth.pse, "pse"),
        (lenth.me.unwrap(), "me"),
        (lenth.sme.unwrap(), "sme"),
    ] {
        let expected = r[key].as_f64().unwrap();
        assert!(
            (value / expected - 1.0).abs() < 1e-9,
            "{key}: {value} against {expected}"
        );
    }
    let unsaturated = fitted("saturated.csv", &["A", "B"], "A*B");
    assert!(contrasts(&unsaturated).is_none());
}

/// Two correlated factors: coded settings and response.
const CORRELATED: [[f64; 3]; 12] = [
    [0.693, 0.506, 2.8814],
    [0.982, 1.17, 3.881],
    [0.157, 0.118, 0.2487],
    [0.528, 0.4, 2.0667],
    [0.03, 0.253, 0.551],
    [0.441, 0.73, 1.6253],
    [0.5, 0.681, 2.129],
    [0.457, 0.459, 2.8213],
    [0.84, 0.942, 3.4481],
    [0.315, 0.336, 1.2536],
    [0.766, 0.737, 3.1465],
    [0.847, 0.786, 3.8871],
];

/// The order is that of R's `anova(lm(y ~ ...))`: `terms()` puts products of more factors behind, and otherwise leaves the order as
/// written, powers in `I()` among the main effects. `B + A` gives 11.428 and 3.744 there (to the digits printed), `A + B`
/// 15.169 and 0.0034. Each sum is what its term takes off the residuals of the terms before it (rounding: 1e-10).
#[test]
fn type_one_sums_follow_the_order_of_the_formula() {
    let factors = ["A", "B"].map(|s| Factor::coded_only(s).unwrap());
    let cells = CORRELATED.map(|[a, b, y]| Cell::single(vec![a, b], y));
    let data = Observations::from_cells(cells.to_vec()).unwrap();
    let fitted =
        |formula: &str| fit(&factors, &Model::parse(formula, &factors).unwrap(), &data).unwrap();
    let sums = |formula: &str| -> Vec<(String, f64)> {
        let rows = fitted(formula);
        let rows = rows
            .anova
            .iter()
            .map(|(name, row)| (name.to_owned(), row.type_i.ss));
        rows.collect()
    };
    for (formula, expected) in [
        ("B + A", [("B", 11.428), ("A", 3.744)]),
        ("A + B", [("A", 15.169), ("B", 0.0034)]),
    ] {
        for ((name, ss), (wanted, value)) in sums(formula).into_iter().zip(expected) {
            assert_eq!(name, wanted, "{formula}");
            assert!((ss - value).abs() < 5e-4, "{formula}, {name}: {ss}");
        }
    }
    for (formula, order) in [
        ("B*A", &["B", "A", "A:B"][..]),
        ("B + I(B^2) + A", &["B", "B^2", "A"]),
        ("A:B + B + A", &["B", "A", "A:B"]),
        ("B + A + A:B + I(B^2)", &["B", "A", "B^2", "A:B"]),
        ("B + I(A*B) + A", &["B", "A:B", "A"]),
        ("quadratic", &["A", "B", "A:B", "A^2", "B^2"]),
    ] {
        let got = sums(formula);
        let names: Vec<String> = order
            .iter()
            .map(|term| term.replace([':', '^'], ""))
            .collect();
        assert!(
            got.iter().map(|(name, _)| name).eq(&names),
            "{formula}: {got:?}"
        );
        for (i, (name, ss)) in got.iter().enumerate() {
            let up_to = |n: usize| {
                if n == 0 {
                    "mean".to_owned()
                } else {
                    order[..n].join(" + ")
                }
            };
            let taken = fitted(&up_to(i)).sse - fitted(&up_to(i + 1)).sse;
            assert!(
                (ss - taken).abs() < 1e-10,
                "{formula}, {name}: {ss} against {taken}"
            );
        }
    }
}
