//! Differences from R over the data sets of `fixtures/r`.

use dev_support::fixture_files::fixture;
use experiment_design::Factor;
use experiment_design::table::Table;
use response_surface::fit::{Case, Information, TermRow, TypedRow};
use response_surface::{Cell, Fit, Model, NamedValues, Observations, fit, one_way, spread};
use serde_json::Value;
use std::error::Error;
use std::path::PathBuf;

/// The worst relative difference of each quantity of one data set.
pub(crate) struct Row {
    /// Data set.
    pub(crate) name: String,
    /// Quantity and its worst difference.
    pub(crate) differences: Vec<(&'static str, f64)>,
}

fn folder() -> PathBuf {
    fixture("r")
}

/// The worst difference of two lists, relative to the entry or to a thousandth of the greatest.
fn worst(got: &[f64], expected: &Value) -> f64 {
    let one = [expected.clone()];
    let expected: Vec<f64> = expected
        .as_array()
        .map_or(&one[..], |list| list)
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    if got.len() != expected.len() {
        return f64::INFINITY;
    }
    let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let gap = |(g, e): (&f64, &f64)| (g - e).abs() / e.abs().max(1e-3 * size);
    got.iter().zip(&expected).map(gap).fold(0.0, f64::max)
}

fn strings(value: &Value) -> Vec<String> {
    let list = value.as_array().into_iter().flatten();
    list.filter_map(|text| text.as_str().map(str::to_owned))
        .collect()
}

/// The factors of a table, coded from their least to their greatest value, with its cells.
fn read(name: &str, r: &Value) -> Result<(Vec<Factor>, Vec<Cell>), Box<dyn Error>> {
    let table = Table::parse(&std::fs::read_to_string(
        folder().join(format!("{name}.csv")),
    )?)?;
    let mut factors = Vec::new();
    let mut columns = Vec::new();
    for symbol in strings(&r["factors"]) {
        let place = table.column(&symbol)?;
        let values: Vec<f64> = table
            .rows()
            .iter()
            .map(|row| table.number(row, place))
            .collect::<Result<_, _>>()?;
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        factors.push(Factor::new(&symbol, "", "1", low, high)?);
        columns.push(values);
    }
    let mut cells = Vec::new();
    for (i, row) in table.rows().iter().enumerate() {
        let coded = factors
            .iter()
            .zip(&columns)
            .map(|(f, c)| f.coded(c[i]))
            .collect();
        let n = table.count(row, "n")?.unwrap_or(1);
        let y = table.number(row, table.column("y")?)?;
        cells.push(Cell {
            n,
            ..Cell::single(coded, y)
        });
    }
    Ok((factors, cells))
}

fn or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

/// Coefficients and sums of squares.
fn of_terms(f: &Fit, r: &Value) -> Vec<(&'static str, f64)> {
    let terms = |rows: &NamedValues<TermRow>, value: &dyn Fn(&TermRow) -> f64| -> Vec<f64> {
        rows.values().map(value).collect()
    };
    let sums =
        |value: &dyn Fn(&TypedRow) -> f64| -> Vec<f64> { f.anova.values().map(value).collect() };
    vec![
        (
            "coefficients",
            worst(&terms(&f.terms, &|t| t.coef), &r["coef"]),
        ),
        (
            "standard errors",
            worst(&terms(&f.terms, &|t| or_nan(t.se)), &r["se"]),
        ),
        (
            "p values",
            worst(&terms(&f.terms, &|t| or_nan(t.p)), &r["p"]),
        ),
        (
            "natural coefficients",
            worst(&terms(&f.terms_natural, &|t| t.coef), &r["natural_coef"]),
        ),
        (
            "natural standard errors",
            worst(
                &terms(&f.terms_natural, &|t| or_nan(t.se)),
                &r["natural_se"],
            ),
        ),
        ("Type I", worst(&sums(&|a| a.type_i.ss), &r["type_i"])),
        ("Type II", worst(&sums(&|a| a.type_ii.ss), &r["type_ii"])),
        ("Type III", worst(&sums(&|a| a.type_iii.ss), &r["type_iii"])),
    ]
}

/// Figures of the whole fit.
fn of_fit(f: &Fit, r: &Value) -> Vec<(&'static str, f64)> {
    let information = f.information.as_ref();
    let of = |value: &dyn Fn(&Information) -> Option<f64>| [or_nan(information.and_then(value))];
    let mut differences = vec![
        ("R2", worst(&[or_nan(f.r2)], &r["r2"])),
        ("adjusted R2", worst(&[or_nan(f.adj_r2)], &r["adj_r2"])),
        ("residual sd", worst(&[or_nan(f.root_mse)], &r["sigma"])),
        ("PRESS", worst(&[or_nan(f.press)], &r["press"])),
        ("AIC", worst(&of(&|i| Some(i.aic)), &r["aic"])),
        ("AICc", worst(&of(&|i| i.aicc), &r["aicc"])),
        ("BIC", worst(&of(&|i| Some(i.bic)), &r["bic"])),
    ];
    if let Some(pure) = &f.pure_error {
        differences.push(("pure error", worst(&[pure.ss], &r["pure_error_ss"])));
        differences.push((
            "pure error dof",
            worst(&[pure.df as f64], &r["pure_error_df"]),
        ));
    }
    differences
}

/// Figures of the single rows.
fn of_cases(f: &Fit, r: &Value) -> Vec<(&'static str, f64)> {
    let cases = |value: &dyn Fn(&Case) -> f64| -> Vec<f64> { f.cases.iter().map(value).collect() };
    let dfbetas = f.dfbetas(f.n - 1).unwrap_or_default();
    vec![
        ("leverage", worst(&cases(&|c| c.leverage), &r["leverage"])),
        (
            "internal studentised",
            worst(&cases(&|c| or_nan(c.studentized_internal)), &r["rstandard"]),
        ),
        (
            "external studentised",
            worst(&cases(&|c| or_nan(c.studentized_external)), &r["rstudent"]),
        ),
        (
            "Cook's distance",
            worst(&cases(&|c| or_nan(c.cooks_d)), &r["cooks"]),
        ),
        ("DFFITS", worst(&cases(&|c| or_nan(c.dffits)), &r["dffits"])),
        ("DFBETAS", worst(&dfbetas, &r["dfbetas_of_last_case"])),
    ]
}

/// A model whose terms enter in the order of `Model`, as R was asked for with `keep.order = TRUE`; of a written formula they
/// would enter as `anova(lm(...))` lets them.
fn in_kept_order(formula: &str, factors: &[Factor]) -> Result<Model, Box<dyn Error>> {
    let model = Model::parse(formula, factors)?;
    let places: Vec<usize> = (0..model.terms().len()).collect();
    let mut text = serde_json::to_value(&model)?;
    text["entry"] = serde_json::to_value(places)?;
    Ok(serde_json::from_value(text)?)
}

/// One regression.
fn regression(name: &str, r: &Value) -> Result<Row, Box<dyn Error>> {
    let (factors, cells) = read(name, r)?;
    let data = Observations::from_cells(cells)?;
    let model = in_kept_order(&strings(&r["terms"]).join(" + "), &factors)?;
    let f = fit(&factors, &model, &data)?;
    let differences = [of_terms(&f, r), of_fit(&f, r), of_cases(&f, r)].concat();
    Ok(Row {
        name: name.to_owned(),
        differences,
    })
}

/// One comparison of groups.
fn groups(name: &str, r: &Value) -> Result<Row, Box<dyn Error>> {
    let table = Table::parse(&std::fs::read_to_string(
        folder().join(format!("{name}.csv")),
    )?)?;
    let labels: Vec<String> = table
        .rows()
        .iter()
        .map(|row| row.text(0).to_owned())
        .collect();
    let y: Vec<f64> = table
        .rows()
        .iter()
        .map(|row| table.number(row, 1))
        .collect::<Result<_, _>>()?;
    let got = one_way(&labels, &y)?;
    let mut names = labels.clone();
    names.dedup();
    let place = |label: &String| names.iter().position(|n| n == label).unwrap_or(0) as f64;
    let cells = labels
        .iter()
        .zip(&y)
        .map(|(l, &y)| Cell::single(vec![place(l)], y))
        .collect();
    let spread = spread(&Observations::from_cells(cells)?).ok_or("no groups")?;
    let bartlett = spread.bartlett.ok_or("no scatter")?;
    let levene = spread.levene.ok_or("no scatter")?;
    let differences = vec![
        ("between", worst(&[got.between_ss], &r["between_ss"])),
        ("within", worst(&[got.within_ss], &r["within_ss"])),
        ("F", worst(&[or_nan(got.f)], &r["f"])),
        ("p", worst(&[or_nan(got.p)], &r["p"])),
        ("Bartlett", worst(&[bartlett.stat], &r["bartlett"])),
        ("Bartlett p", worst(&[or_nan(bartlett.p)], &r["bartlett_p"])),
        ("Levene F", worst(&[or_nan(levene.f)], &r["levene_f"])),
        ("Levene p", worst(&[or_nan(levene.p)], &r["levene_p"])),
    ];
    Ok(Row {
        name: name.to_owned(),
        differences,
    })
}

/// All data sets: regressions, then groups.
pub(crate) fn rows() -> Result<Vec<Row>, Box<dyn Error>> {
    let results: Value =
        serde_json::from_str(&std::fs::read_to_string(folder().join("results.json"))?)?;
    let mut rows = Vec::new();
    for (name, r) in results["regression"].as_object().into_iter().flatten() {
        rows.push(regression(name, r)?);
    }
    for (name, r) in results["groups"].as_object().into_iter().flatten() {
        rows.push(groups(name, r)?);
    }
    Ok(rows)
}
