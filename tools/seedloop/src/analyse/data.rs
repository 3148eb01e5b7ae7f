//! Reading the table of an experiment.

mod cells;
mod plausible;
mod ranges;

use std::path::PathBuf;

use anyhow::{Context as _, bail, ensure};
use experiment_design::Factor;
use experiment_design::table::Table;
use response_surface::{Categorical, Cell};
use serde::Serialize;

use super::Arguments;
use cells::{Cells, number_blocks};
use plausible::{check_columns, lone_values};
pub(super) use ranges::natural_name;
use ranges::{check_naturals, coding, factors, given_factors};

/// Most rows of an analysis (our choice): each takes about a kilobyte, the model matrix, residuals and influence included.
const MOST_ROWS: usize = 100_000;
/// What the columns of the factors hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Coding {
    /// -1 at the low level, +1 at the high level.
    Coded,
    /// Units of the factors.
    Natural,
}

/// The table with the meaning of its columns.
pub(super) struct Data {
    /// The factors with their ranges.
    pub(super) factors: Vec<Factor>,
    /// What the columns hold.
    pub(super) coding: Coding,
    /// Cells with coded values of the factors, then the dummies.
    pub(super) cells: Vec<Cell>,
    /// Name of the column of the response.
    pub(super) response: String,
    /// Labels of the regime of each row, if a column is named.
    pub(super) regimes: Vec<String>,
    /// Factors of named levels; their columns follow those of the factors in each cell.
    pub(super) categories: Vec<Categorical>,
    /// Names of the batch of each row, if a column is named.
    pub(super) batches: Vec<String>,
    /// Names of the blocks 1, 2, ...; empty where they are numbers.
    pub(super) block_names: Vec<String>,
    /// What to bear in mind about single cells, with their places.
    pub(super) warnings: Vec<String>,
}

/// The file of the factors, if the argument is one.
pub(super) fn factor_file(argument: &str) -> Option<PathBuf> {
    command_line::table_file::is_table(argument).then(|| PathBuf::from(argument))
}

/// Reads the file.
fn table(arguments: &Arguments) -> anyhow::Result<Table> {
    if let Some((_, terms)) = arguments.model.split_once('~') {
        bail!(
            "--model '{}': it takes the terms alone, and --response the response; write --model '{}'",
            arguments.model,
            terms.trim()
        );
    }
    let path = &arguments.data;
    let table = command_line::table_file::read(path)?;
    ensure!(
        table.rows().len() <= MOST_ROWS,
        "{}: it has {} rows; an analysis takes {MOST_ROWS} at most: average runs of the same settings, with --n and --sd",
        path.display(),
        table.rows().len()
    );
    Ok(table)
}

/// Reads the table with the meaning of its columns.
pub(super) fn read(arguments: &Arguments) -> anyhow::Result<Data> {
    let place = || arguments.data.display().to_string();
    let table = table(arguments)?;
    let given = match &arguments.factors {
        Some(list) => given_factors(list)?,
        None => Vec::new(),
    };
    let mut columns = Vec::with_capacity(given.len());
    for (symbol, _) in &given {
        columns.push(table.column(symbol).with_context(place)?);
    }
    let response = table.column(&arguments.response).with_context(place)?;
    check_columns(&table, &columns, response).with_context(place)?;
    let warnings = lone_values(&table, &columns, response).with_context(place)?;
    let coding = coding(arguments, &table, &columns).with_context(place)?;
    let factors = factors(arguments, &table, (given, &columns), coding)?;
    if coding == Coding::Coded {
        check_naturals(&table, &columns, &factors).with_context(place)?;
    }
    let cells = Cells {
        table: &table,
        factors: columns.into_iter().zip(factors.clone()).collect(),
        coding,
        dummies: optional_columns(&table, &arguments.dummies).with_context(place)?,
        response,
        transform: arguments.transform,
        sd: named_column(&table, arguments.sd.as_deref()).with_context(place)?,
        n: named_column(&table, arguments.n.as_deref()).with_context(place)?,
    };
    let (mut cells, without_spread) = cells.read().with_context(place)?;
    let warnings = warnings.into_iter().chain(without_spread).collect();
    let labels = |name: Option<&str>, what: &str| labels(&table, name, what).with_context(place);
    let block_names = number_blocks(&mut cells, &labels(arguments.block.as_deref(), "block")?);
    let mut categories = Vec::with_capacity(arguments.categories.len());
    for name in &arguments.categories {
        let given = labels(Some(name), "level")?;
        categories.push(add_category(name, &given, &mut cells).with_context(place)?);
    }
    Ok(Data {
        regimes: labels(arguments.regime_column(), "regime")?,
        batches: labels(arguments.batch.as_deref(), "batch")?,
        block_names,
        warnings,
        factors,
        coding,
        cells,
        categories,
        response: match arguments.transform {
            None => table.header()[response].clone(),
            Some(transform) => transform.of(&table.header()[response]),
        },
    })
}

/// A factor with the levels given for each cell; its columns join those of the cells.
fn add_category(name: &str, given: &[String], cells: &mut [Cell]) -> anyhow::Result<Categorical> {
    let mut levels = given.to_vec();
    levels.sort();
    levels.dedup();
    ensure!(
        levels.len() > 1,
        "the factor '{name}' never varies: it is '{}' in all rows; leave it out",
        levels.concat()
    );
    let category = Categorical::new(name, levels)?;
    for (cell, level) in cells.iter_mut().zip(given) {
        cell.coded.extend(category.coded(level).unwrap_or_default());
    }
    Ok(category)
}

/// Texts of a column, none of them empty; nothing if no column is named.
fn labels(table: &Table, name: Option<&str>, what: &str) -> anyhow::Result<Vec<String>> {
    let Some(name) = name else {
        return Ok(Vec::new());
    };
    let column = table.column(name)?;
    for row in table.rows() {
        ensure!(
            !row.text(column).is_empty(),
            "{}: it names no {what}; fill it, or leave the row out",
            table.place(row, column)
        );
    }
    let texts = table.rows().iter().map(|row| row.text(column).to_owned());
    Ok(texts.collect())
}

/// The column of that name, if one is named.
fn named_column(table: &Table, name: Option<&str>) -> anyhow::Result<Option<usize>> {
    Ok(name.map(|name| table.column(name)).transpose()?)
}

/// The columns of these names.
fn optional_columns(table: &Table, names: &[String]) -> anyhow::Result<Vec<usize>> {
    Ok(names
        .iter()
        .map(|name| table.column(name))
        .collect::<Result<_, _>>()?)
}

/// Least and greatest value of a column.
fn extremes(table: &Table, column: usize) -> anyhow::Result<(f64, f64)> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for row in table.rows() {
        let value = table.number(row, column)?;
        (low, high) = (low.min(value), high.max(value));
    }
    Ok((low, high))
}
