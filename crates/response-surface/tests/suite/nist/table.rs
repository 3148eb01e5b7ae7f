//! Log relative errors on the reference data sets of NIST (`fixtures/nist`).

use dev_support::fixture_files::fixture;
use experiment_design::Factor;
use experiment_design::table::Table;
use response_surface::{Cell, Model, Observations, fit, one_way, one_way_decimals};
use serde_json::Value;
use std::error::Error;
use std::path::PathBuf;

/// Digits of agreement on one data set; 15 where all agree, the certified values have no more.
pub(crate) struct Row {
    /// Data set.
    pub(crate) name: String,
    /// Least digits over the estimates (regression) or of F (analysis of variance).
    pub(crate) estimate: f64,
    /// Least digits over the standard deviations, or of the sums of squares.
    pub(crate) spread: f64,
    /// Digits of the residual standard deviation.
    pub(crate) residual_sd: f64,
    /// Digits of R2.
    pub(crate) r2: f64,
    /// Analysis of variance: digits of F where the responses are stored as f64 first.
    pub(crate) stored: Option<f64>,
}

/// -log10 of the relative error, at most 15; of the absolute error where the certified value is 0.
fn digits(got: f64, certified: f64) -> f64 {
    let size = if certified == 0.0 {
        1.0
    } else {
        certified.abs()
    };
    let error = (got - certified).abs() / size;
    (-error.max(1e-15).log10()).max(0.0)
}

fn folder() -> PathBuf {
    fixture("nist")
}

/// The certified values.
pub(crate) fn certified() -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&std::fs::read_to_string(
        folder().join("certified.json"),
    )?)?)
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .collect()
}

/// The least digits of agreement in two lists.
fn least_digits(got: impl Iterator<Item = f64>, certified: &Value) -> f64 {
    got.zip(numbers(certified))
        .map(|(g, c)| digits(g, c))
        .fold(15.0, f64::min)
}

/// The factor of a column; of a model through zero its range is symmetric, so that coded 0 is natural 0.
fn factor_of(symbol: &str, x: &[f64], through_zero: bool) -> Result<Factor, Box<dyn Error>> {
    let low = x.iter().copied().fold(f64::INFINITY, f64::min);
    let high = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = if through_zero { -high } else { low };
    Ok(Factor::new(symbol, "", "1", low, high)?)
}

/// One regression set: the factors run from the least to the greatest value, as the command does
/// with a table of natural values.
pub(crate) fn regression(name: &str, certified: &Value) -> Result<Row, Box<dyn Error>> {
    let text = std::fs::read_to_string(folder().join(format!("{name}.csv")))?;
    let table = Table::parse(&text)?;
    let column = |j: usize| -> Result<Vec<f64>, Box<dyn Error>> {
        let numbers = table.rows().iter().map(|row| table.number(row, j));
        Ok(numbers.collect::<Result<_, _>>()?)
    };
    let terms = certified["terms"].as_array().into_iter().flatten();
    let mut terms: Vec<&str> = terms.filter_map(Value::as_str).collect();
    let through_zero = !terms.contains(&"1");
    if through_zero {
        terms.insert(0, "0");
    }
    let y = column(0)?;
    let mut factors = Vec::new();
    let mut coded = vec![Vec::new(); y.len()];
    for (j, symbol) in table.header().iter().enumerate().skip(1) {
        let x = column(j)?;
        let factor = factor_of(symbol, &x, through_zero)?;
        for (row, value) in coded.iter_mut().zip(x) {
            row.push(factor.coded(value));
        }
        factors.push(factor);
    }
    let model = Model::parse(&terms.join(" + "), &factors)?;
    let cells = coded.into_iter().zip(y).map(|(x, y)| Cell::single(x, y));
    let observations = Observations::from_cells(cells.collect())?;
    let fitted = fit(&factors, &model, &observations)?;
    let rows = || fitted.terms_natural.values();
    let or_nan = |x: Option<f64>| x.unwrap_or(f64::NAN);
    let wanted = |key: &str| or_nan(certified[key].as_f64());
    Ok(Row {
        name: name.to_owned(),
        estimate: least_digits(rows().map(|r| r.coef), &certified["estimate"]),
        spread: least_digits(rows().map(|r| or_nan(r.se)), &certified["sd"]),
        residual_sd: digits(or_nan(fitted.root_mse), wanted("residual_sd")),
        r2: digits(or_nan(fitted.r2), wanted("r2")),
        stored: None,
    })
}

/// Groups and responses of a set of the analysis of variance. The nine sets of Simon and Lesage
/// are made by their rule: a group starts with its middle value and alternates about it by 0.1.
fn groups(name: &str) -> Result<(Vec<String>, Vec<String>), Box<dyn Error>> {
    if let Some(number) = name.strip_prefix("smls") {
        let number: usize = number.parse()?;
        let base = ["1", "1000000", "1000000000000"][(number - 1) / 3];
        let count = [21, 201, 2001][(number - 1) % 3];
        let mut lists = (Vec::new(), Vec::new());
        for (group, middle) in [4, 3, 5, 3, 5, 3, 5, 3, 5].into_iter().enumerate() {
            for i in 0..count {
                let tenth = match i {
                    0 => middle,
                    i if i % 2 == 1 => middle - 1,
                    _ => middle + 1,
                };
                lists.0.push((group + 1).to_string());
                lists.1.push(format!("{base}.{tenth}"));
            }
        }
        return Ok(lists);
    }
    let table = Table::parse(&std::fs::read_to_string(
        folder().join(format!("{name}.csv")),
    )?)?;
    let mut lists = (Vec::new(), Vec::new());
    for row in table.rows() {
        lists.0.push(row.text(0).to_owned());
        lists.1.push(row.text(1).to_owned());
    }
    Ok(lists)
}

/// One set of the analysis of variance.
pub(crate) fn variance(name: &str, certified: &Value) -> Result<Row, Box<dyn Error>> {
    let (labels, responses) = groups(name)?;
    let texts: Vec<&str> = responses.iter().map(String::as_str).collect();
    let got = one_way_decimals(&labels, &texts)?;
    let wanted = |key: &str| certified[key].as_f64().unwrap_or(f64::NAN);
    let mut stored = Vec::new();
    for text in texts {
        stored.push(text.parse::<f64>()?);
    }
    let stored = one_way(&labels, &stored)?.f.unwrap_or(f64::NAN);
    Ok(Row {
        name: name.to_owned(),
        stored: Some(digits(stored, wanted("f"))),
        estimate: digits(got.f.unwrap_or(f64::NAN), wanted("f")),
        spread: digits(got.between_ss, wanted("between_ss"))
            .min(digits(got.within_ss, wanted("within_ss"))),
        residual_sd: digits(got.residual_sd.unwrap_or(f64::NAN), wanted("residual_sd")),
        r2: digits(got.r2.unwrap_or(f64::NAN), wanted("r2")),
    })
}

/// A data set of one kind.
type Analysis = fn(&str, &Value) -> Result<Row, Box<dyn Error>>;

/// All rows: regression, then analysis of variance.
pub(crate) fn rows() -> Result<Vec<Row>, Box<dyn Error>> {
    let certified = certified()?;
    let mut rows = Vec::new();
    let kinds: [(&str, Analysis); 2] = [("regression", regression), ("anova", variance)];
    for (kind, analyse) in kinds {
        for (name, values) in certified[kind].as_object().into_iter().flatten() {
            rows.push(analyse(name, values)?);
        }
    }
    Ok(rows)
}
