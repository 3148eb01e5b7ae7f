//! Predictions at the settings of another table.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, ensure};
use command_line::significant;
use experiment_design::Factor;
use experiment_design::table::{Row, Table};
use response_surface::{Fit, GaussianProcess, Prediction, ProcessPrediction, Transform};
use serde::Serialize;

use super::data::{Coding, Data, natural_name};
use crate::levels::Original;

/// Most points of a table.
const MOST_POINTS: usize = 100_000;

/// What the models say about one row.
#[derive(Debug, Serialize)]
pub(super) struct Predicted {
    /// Line of the table.
    line: usize,
    /// The polynomial, with the residuals as error.
    polynomial: Prediction,
    /// The Gaussian process; null without `--gaussian-process`.
    gaussian_process: Option<ProcessPrediction>,
    /// The polynomial in the unit of the response, where a function of it was fitted.
    original: Option<InUnit>,
    /// The same of the process.
    original_gaussian_process: Option<InUnit>,
}

/// A prediction in the unit of the response.
#[derive(Debug, Serialize)]
struct InUnit {
    /// The median with its 95 % confidence interval.
    #[serde(flatten)]
    median: Original,
    /// 95 % prediction interval of a run.
    pi95: [Option<f64>; 2],
}

/// Predicts at each row of a table, whose columns hold what those of the data held; where natural values stand beside
/// coded ones, the natural ones count.
pub(super) fn predictions(
    path: &Path,
    data: &Data,
    fit: &Fit,
    process: Option<&GaussianProcess>,
    transform: Option<Transform>,
) -> anyhow::Result<Vec<Predicted>> {
    let place = || path.display().to_string();
    let table = command_line::table_file::read(path)?;
    let rows = table.rows();
    ensure!(
        rows.len() <= MOST_POINTS,
        "{}: it has {} rows; predictions are made for {MOST_POINTS} at most",
        place(),
        rows.len()
    );
    let settings = Settings::of(&table, data).with_context(place)?;
    let predict = |row: &Row| -> anyhow::Result<Predicted> {
        let coded = settings.coded(row)?;
        let pairs = fit.factors.iter().zip(&coded);
        let natural: Vec<f64> = pairs.map(|(factor, x)| factor.natural(*x)).collect();
        let polynomial = fit.predict(&natural)?;
        let process = process.map(|process| process.prediction(&coded));
        let in_unit = |mean: f64, ci95: Option<[f64; 2]>, pi95: Option<[f64; 2]>| {
            transform.map(|transform| InUnit {
                median: Original::new(transform, mean, ci95),
                pi95: pi95.map_or([None; 2], |ends| transform.back_interval(ends)),
            })
        };
        Ok(Predicted {
            line: row.line(),
            original: in_unit(polynomial.mean, polynomial.ci95, polynomial.pi95),
            original_gaussian_process: process
                .and_then(|p| in_unit(p.mean, Some(p.ci95), Some(p.pi95))),
            gaussian_process: process,
            polynomial,
        })
    };
    rows.iter()
        .map(predict)
        .collect::<anyhow::Result<_>>()
        .with_context(place)
}

/// Where the settings stand in a table.
struct Settings<'a> {
    table: &'a Table,
    /// The data whose factors are set.
    data: &'a Data,
    /// For each factor with numbers its column, and what it holds.
    numbers: Vec<(usize, Coding, &'a Factor)>,
    /// For each factor of named levels its column.
    levels: Vec<usize>,
}

impl<'a> Settings<'a> {
    /// Finds the columns.
    fn of(table: &'a Table, data: &'a Data) -> anyhow::Result<Self> {
        let of_levels: usize = data.categories.iter().map(|c| c.levels().len() - 1).sum();
        let numbers = &data.factors[..data.factors.len() - of_levels];
        let number = |factor: &'a Factor| -> anyhow::Result<(usize, Coding, &'a Factor)> {
            let symbol = factor.symbol();
            Ok(match table.column(&natural_name(symbol)) {
                Ok(column) => (column, Coding::Natural, factor),
                Err(_) => (table.column(symbol)?, data.coding, factor),
            })
        };
        let level = |c: &response_surface::Categorical| table.column(c.symbol());
        Ok(Self {
            table,
            data,
            numbers: numbers.iter().map(number).collect::<anyhow::Result<_>>()?,
            levels: data
                .categories
                .iter()
                .map(level)
                .collect::<Result<_, _>>()?,
        })
    }

    /// The coded values of all columns of the fit.
    fn coded(&self, row: &Row) -> anyhow::Result<Vec<f64>> {
        let mut coded = Vec::with_capacity(self.data.factors.len());
        for (column, coding, factor) in &self.numbers {
            let value = self.table.number(row, *column)?;
            coded.push(match coding {
                Coding::Coded => value,
                Coding::Natural => factor.coded(value),
            });
        }
        for (column, category) in self.levels.iter().zip(&self.data.categories) {
            let level = row.text(*column);
            let values = category.coded(level).with_context(|| {
                format!(
                    "{}: '{level}' is not a level of '{}' in the data; they are {}",
                    self.table.place(row, *column),
                    category.symbol(),
                    category.levels().join(", ")
                )
            })?;
            coded.extend(values);
        }
        Ok(coded)
    }
}

/// The predictions as text. Writing to a string cannot fail.
pub(super) fn text(predictions: &[Predicted]) -> String {
    let mut text = String::new();
    let between = |ends: Option<[f64; 2]>| {
        ends.map_or_else(
            || "-".to_owned(),
            |[low, high]| format!("{} to {}", significant(low, 6), significant(high, 6)),
        )
    };
    let open = |[low, high]: [Option<f64>; 2]| {
        let end = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| significant(v, 6));
        format!("{} to {}", end(low), end(high))
    };
    for predicted in predictions {
        let p = &predicted.polynomial;
        let outside = if p.extrapolated {
            ", outside what the runs span"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "line {:<5} {:>12}  mean 95 % {}, a run 95 % {}{outside}",
            predicted.line,
            significant(p.mean, 6),
            between(p.ci95),
            between(p.pi95)
        );
        if let Some(p) = &predicted.gaussian_process {
            let _ = writeln!(
                text,
                "  process  {:>12}  mean 95 % {}, a run 95 % {}",
                significant(p.mean, 6),
                between(Some(p.ci95)),
                between(Some(p.pi95))
            );
        }
        let back = [&predicted.original, &predicted.original_gaussian_process];
        for (what, in_unit) in ["", "process, "].into_iter().zip(back) {
            if let Some(in_unit) = in_unit {
                let _ = writeln!(
                    text,
                    "  {what}in the unit of the response: {}, a run {}",
                    in_unit.median.words(),
                    open(in_unit.pi95)
                );
            }
        }
    }
    text
}
