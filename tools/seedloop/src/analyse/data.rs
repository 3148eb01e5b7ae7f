//! Reading the table of an experiment.

use std::path::PathBuf;

use anyhow::{Context as _, bail, ensure};
use command_line::significant;
use experiment_design::Factor;
use experiment_design::table::{Row, Table, check_natural, factors_from_table, split_unit};
use response_surface::{Categorical, Cell, Model, Observations, Transform};
use serde::Serialize;

use super::Arguments;

/// Farthest coded value of a natural column: axial points of the largest designs lie at 4.
const FARTHEST: f64 = 5.0;
/// Most rows of an analysis (our choice): each takes about a kilobyte, the model matrix, residuals and influence included.
const MOST_ROWS: usize = 100_000;
/// Least spread of a natural column, in widths of the range of its factor: a table of a design covers the whole of it.
const NARROWEST: f64 = 0.01;

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

/// Reads the table.
pub(super) fn read(arguments: &Arguments) -> anyhow::Result<Data> {
    if let Some((_, terms)) = arguments.model.split_once('~') {
        bail!(
            "--model '{}': only the terms stand in a model here, the response in --response; write --model '{}'",
            arguments.model,
            terms.trim()
        );
    }
    let path = &arguments.data;
    let place = || path.display().to_string();
    let table = command_line::table_file::read(path)?;
    ensure!(
        table.rows().len() <= MOST_ROWS,
        "{}: it has {} rows; an analysis takes {MOST_ROWS} at most: average runs of the same settings, with --n and --sd",
        place(),
        table.rows().len()
    );
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
    ensure!(
        cells.sd.is_none() || cells.n.is_some(),
        "--sd needs --n, the column of the number of replicates that the sd was taken over"
    );
    let rows = table.rows().iter();
    let read = rows
        .map(|row| cells.cell(row))
        .collect::<Result<Vec<_>, _>>();
    let read = read.and_then(|read| Ok((cells.spreads(&read)?, read)));
    let (without_spread, mut cells) = read.with_context(place)?;
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

/// The factors, as given or as the table shows them; about zero where a model in natural units has no intercept.
fn factors(
    arguments: &Arguments,
    table: &Table,
    (given, columns): (Vec<(String, Option<Factor>)>, &[usize]),
    coding: Coding,
) -> anyhow::Result<Vec<Factor>> {
    let place = || arguments.data.display().to_string();
    let mut factors = Vec::with_capacity(given.len());
    for ((symbol, known), &column) in given.into_iter().zip(columns) {
        factors.push(match known {
            Some(factor) => {
                if coding == Coding::Natural {
                    check_range(arguments, table, column, &factor).with_context(place)?;
                }
                match split_unit(&table.header()[column]) {
                    // A range in the command line states no unit: the header may.
                    Some((_, unit)) if factor.unit() == "1" => {
                        let [low, high] = [factor.low(), factor.high()];
                        Factor::new(factor.symbol(), factor.name(), unit, low, high)?
                    }
                    _ => factor,
                }
            }
            None => seen_factor(table, &symbol, column, coding).with_context(place)?,
        });
    }
    if coding == Coding::Natural && arguments.categories.is_empty() {
        let model = Model::parse(&arguments.model, &factors)?;
        if !model.has_intercept() {
            // The response is zero where the factors are, not in the middle of their ranges.
            factors = factors.iter().map(about_zero).collect::<Result<_, _>>()?;
        }
    }
    Ok(factors)
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

/// Refuses a factor or a response that never varies, and a response that is a factor.
fn check_columns(table: &Table, factors: &[usize], response: usize) -> anyhow::Result<()> {
    let name = |column: usize| &table.header()[column];
    ensure!(
        !factors.contains(&response),
        "column '{}' is named as a factor and as the response; it can only be one of them",
        name(response)
    );
    let columns = factors.iter().map(|&column| (column, "factor"));
    for (column, what) in columns.chain([(response, "response")]) {
        let (low, high) = extremes(table, column)?;
        let name = name(column);
        ensure!(
            low < high || table.rows().len() == 1,
            "the {what} '{name}' never varies: it is {low} in all rows; leave it out"
        );
    }
    Ok(())
}

/// How far a value may lie beyond those of all other rows, in widths of their range, before it is reported: as far as they
/// reach themselves. The outermost axial runs of a composite come in pairs.
const LONE: f64 = 1.0;
/// How far it may lie before it is refused, in widths of their range and sizes of their values: no factor and no response
/// of an experiment jumps a million times its own size in one row.
const ABSURD: f64 = 1e6;

/// Refuses a factor or a response that one row alone has at an absurd value, and reports factors that one row alone takes far
/// beyond all others, each with its place: a slip of a typist costs terms, and the terms do not say where it stands.
fn lone_values(table: &Table, factors: &[usize], response: usize) -> anyhow::Result<Vec<String>> {
    let mut warnings = Vec::new();
    for &column in factors.iter().chain([&response]) {
        let mut sorted = Vec::with_capacity(table.rows().len());
        for row in table.rows() {
            sorted.push((table.number(row, column)?, row));
        }
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        // With fewer rows no two others could tell what is far.
        let [(low, lowest), (second, _), .., (last, _), (high, highest)] = &sorted[..] else {
            continue;
        };
        for (value, row, [from, to]) in
            [(low, lowest, [second, high]), (high, highest, [low, last])]
        {
            let beyond = (from - value).max(value - to);
            let (spread, size) = (to - from, from.abs().max(to.abs()));
            let place = table.place(row, column);
            let [value, from, to] = [value, from, to].map(|v| significant(*v, 6));
            ensure!(
                beyond <= ABSURD * spread.max(size) || spread.max(size) == 0.0,
                "{place}: {value} lies far outside all other rows, {from} to {to}; correct it, or leave the row out"
            );
            if column != response && spread > 0.0 && beyond > LONE * spread {
                warnings.push(format!(
                    "{place}: {value} lies {} widths outside the range of all other rows, {from} to {to}; the fit depends on \
                     this row, so check it",
                    significant(beyond / spread, 2)
                ));
            }
        }
    }
    Ok(warnings)
}

/// Where the numbers of a row stand.
struct Cells<'a> {
    /// The table.
    table: &'a Table,
    /// Column and factor.
    factors: Vec<(usize, Factor)>,
    /// What the columns of the factors hold.
    coding: Coding,
    /// Columns of the dummies.
    dummies: Vec<usize>,
    /// Column of the mean.
    response: usize,
    /// The function of the mean that is fitted.
    transform: Option<Transform>,
    /// Column of the standard deviation.
    sd: Option<usize>,
    /// Column of the number of replicates.
    n: Option<usize>,
}

impl Cells<'_> {
    /// Checks the standard deviations of the rows, and reports the replicates whose standard deviation is missing.
    fn spreads(&self, cells: &[Cell]) -> anyhow::Result<Option<String>> {
        let Some(column) = self.sd else {
            return Ok(None);
        };
        let rows = || self.table.rows().iter().zip(cells);
        let size = cells.iter().map(|cell| cell.mean.abs()).fold(0.0, f64::max);
        for (row, cell) in rows() {
            let place = self.table.place(row, column);
            let Some(sd) = cell.sd else { continue };
            ensure!(
                Observations::is_plausible_sd(sd, size),
                "{place}: responses up to {size} cannot have the standard deviation {sd:e}; correct it, or write 0 for runs \
                 that are all alike"
            );
            ensure!(
                cell.n > 1 || sd == 0.0,
                "{place}: {sd} is given as the standard deviation of a single run (n = 1), which has none; correct n, or \
                 leave the cell empty"
            );
        }
        let missing = rows().filter(|(_, cell)| cell.n > 1 && cell.sd.is_none());
        let missing: Vec<(&Row, usize)> = missing.map(|(row, cell)| (row, cell.n - 1)).collect();
        if missing.is_empty() {
            return Ok(None);
        }
        let lost: usize = missing.iter().map(|(_, df)| df).sum();
        let all: usize = cells.iter().map(|cell| cell.n - 1).sum();
        let places: Vec<String> = missing
            .iter()
            .map(|(row, _)| self.table.place(row, column))
            .collect();
        Ok(Some(format!(
            "{}: no standard deviation of these replicates: the error of replicates has {} degrees of freedom instead of {all}",
            listed(&places),
            all - lost
        )))
    }

    /// Reads one row.
    fn cell(&self, row: &Row) -> anyhow::Result<Cell> {
        let mut coded = Vec::with_capacity(self.factors.len() + self.dummies.len());
        for (column, factor) in &self.factors {
            let value = self.table.number(row, *column)?;
            coded.push(match self.coding {
                Coding::Coded => value,
                Coding::Natural => plain(factor.coded(value)),
            });
        }
        for &column in &self.dummies {
            coded.push(self.table.number(row, column)?);
        }
        let n = match self.n {
            Some(column) => self.table.count(row, &self.table.header()[column])?,
            None => None,
        };
        if let (Some(n), Some(column)) = (n, self.n) {
            ensure!(
                n <= Observations::MOST_REPLICATES,
                "{}: {n} replicates of one setting; at most {} are believed",
                self.table.place(row, column),
                Observations::MOST_REPLICATES
            );
        }
        let sd = self
            .sd
            .map(|column| self.table.optional_number(row, column))
            .transpose()?;
        let mean = self.table.number(row, self.response)?;
        ensure!(
            mean.abs() <= Observations::LARGEST,
            "{}: {mean:e} is beyond 1e140, and its square overflows; give the response in a larger unit",
            self.table.place(row, self.response)
        );
        let mean = match self.transform {
            None => mean,
            Some(transform) => transform.forward(mean).with_context(|| {
                let place = self.table.place(row, self.response);
                let what = transform.of(&self.table.header()[self.response]);
                let domain = transform.domain();
                format!("{place}: {what} needs values {domain}, this one is {mean}")
            })?,
        };
        Ok(Cell {
            coded,
            mean,
            sd: sd.flatten(),
            n: n.unwrap_or(1),
            block: 1,
        })
    }
}

/// Some places with commas between them, the first few of many.
fn listed(places: &[String]) -> String {
    const MOST: usize = 5;
    let shown = places[..places.len().min(MOST)].join(", ");
    match places.len().checked_sub(MOST) {
        Some(more @ 1..) => format!("{shown} and {more} more"),
        _ => shown,
    }
}

/// Numbers the blocks of the cells by their labels, and gives the names behind the numbers; labels that are whole
/// numbers are taken as they are, and then there are no names.
fn number_blocks(cells: &mut [Cell], labels: &[String]) -> Vec<String> {
    let number = |label: &String| label.parse().ok().filter(|n: &usize| *n >= 1);
    if let Some(numbers) = labels.iter().map(number).collect::<Option<Vec<_>>>() {
        for (cell, number) in cells.iter_mut().zip(numbers) {
            cell.block = number;
        }
        return Vec::new();
    }
    let mut names = labels.to_vec();
    names.sort();
    names.dedup();
    for (cell, label) in cells.iter_mut().zip(labels) {
        cell.block = 1 + names.binary_search(label).unwrap_or(0);
    }
    names
}

/// The factor over a range whose middle is zero and that holds its own, so that coded zero is its zero.
fn about_zero(factor: &Factor) -> Result<Factor, experiment_design::Error> {
    let end = factor.low().abs().max(factor.high().abs());
    Factor::new(factor.symbol(), factor.name(), factor.unit(), -end, end)
}

/// A coded value freed of the rounding of its range: 0.5 rather than 0.5000000000000002.
fn plain(coded: f64) -> f64 {
    let short = (coded * 1e6).round() / 1e6;
    if (short - coded).abs() < 4e-15 {
        short
    } else {
        coded
    }
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

/// Symbols in the order given, with the factor where its range is given too.
fn given_factors(argument: &str) -> anyhow::Result<Vec<(String, Option<Factor>)>> {
    if let Some(path) = factor_file(argument) {
        let place = path.display().to_string();
        let factors = factors_from_table(&command_line::table_file::read(&path)?).context(place)?;
        return Ok(factors
            .into_iter()
            .map(|f| (f.symbol().to_owned(), Some(f)))
            .collect());
    }
    let mut given = Vec::new();
    for part in argument.split(',').map(str::trim) {
        let (column, range) = match part.split_once('=') {
            Some((column, range)) => (column.trim(), Some(range)),
            None => (part, None),
        };
        // A unit behind the name of a column is not part of the symbol, and the symbol finds the column.
        let (symbol, unit) = split_unit(column).unwrap_or((column, "1"));
        ensure!(
            Factor::coded_only(symbol).is_ok() || symbol.is_empty(),
            "the factor '{symbol}' could not stand in a formula, whose symbols are letters, digits, '_' and '.'; rename its \
             column, such as {}",
            suggested_symbol(symbol)
        );
        let Some(range) = range else {
            given.push((symbol.to_owned(), None));
            continue;
        };
        let bounds = range.split_once(':').and_then(|(low, high)| {
            Some((
                low.trim().parse::<f64>().ok()?,
                high.trim().parse::<f64>().ok()?,
            ))
        });
        let Some((low, high)) = bounds else {
            bail!("'{part}' is not a factor with its range; write it as B=0.30:0.42");
        };
        given.push((
            symbol.to_owned(),
            Some(Factor::new(symbol, "", unit, low, high)?),
        ));
    }
    Ok(given)
}

/// A name that may stand in a formula, made of another.
fn suggested_symbol(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let joined = words.join("_");
    if Factor::coded_only(&joined).is_ok() {
        joined
    } else {
        format!("x{joined}")
    }
}

/// What the columns hold: as told; coded if each has its natural values beside it, as in a file of `design`; coded
/// if all values lie in -1..+1 and every column reaches both ends, as the columns of a design do.
fn coding(arguments: &Arguments, table: &Table, columns: &[usize]) -> anyhow::Result<Coding> {
    if arguments.coded {
        return Ok(Coding::Coded);
    }
    if arguments.natural {
        return Ok(Coding::Natural);
    }
    let beside = |&column: &usize| table.column(&natural_name(&table.header()[column])).is_ok();
    if columns.iter().all(beside) {
        return Ok(Coding::Coded);
    }
    for &column in columns {
        let (low, high) = extremes(table, column)?;
        if (low, high) != (-1.0, 1.0) {
            return Ok(Coding::Natural);
        }
    }
    Ok(Coding::Coded)
}

/// Refuses coded values that contradict the natural ones beside them, in the rows that have a value of the factor.
fn check_naturals(table: &Table, columns: &[usize], factors: &[Factor]) -> anyhow::Result<()> {
    for row in table.rows() {
        for (factor, &column) in factors.iter().zip(columns) {
            check_natural(table, row, factor, table.number(row, column)?)?;
        }
    }
    Ok(())
}

/// Name of the column of natural values beside that of a factor.
pub(super) fn natural_name(symbol: &str) -> String {
    format!("{symbol}_natural")
}

/// Refuses values so far outside the given range that the column can hardly be natural, or so close together that their unit can
/// hardly be that of the range, unless told so.
fn check_range(
    arguments: &Arguments,
    table: &Table,
    column: usize,
    factor: &Factor,
) -> anyhow::Result<()> {
    let (least, greatest) = extremes(table, column)?;
    for row in table.rows() {
        let value = table.number(row, column)?;
        ensure!(
            arguments.natural || factor.coded(value).abs() <= FARTHEST,
            "{}: {value} lies far outside the range {} to {} of the factor (the column holds {least} to {greatest}): correct \
             it, or give --coded if the column is coded, --natural if it is meant",
            table.place(row, column),
            factor.low(),
            factor.high()
        );
    }
    let spread = greatest - least;
    ensure!(
        arguments.natural || spread == 0.0 || spread >= NARROWEST * (factor.high() - factor.low()),
        "column '{}' holds {least} to {greatest}, next to nothing of the range {} to {} of the factor: give both in the same \
         unit, or --natural if it is meant",
        table.header()[column],
        factor.low(),
        factor.high()
    );
    Ok(())
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

/// A factor whose range is not given: from the column of natural values beside the coded one, or
/// from the values of the column itself.
fn seen_factor(
    table: &Table,
    symbol: &str,
    column: usize,
    coding: Coding,
) -> anyhow::Result<Factor> {
    if coding == Coding::Natural {
        let (low, high) = extremes(table, column)?;
        let unit = split_unit(&table.header()[column]).map_or("1", |(_, unit)| unit);
        return Ok(Factor::new(symbol, "", unit, low, high)?);
    }
    let Ok(natural) = table.column(&natural_name(symbol)) else {
        return Ok(Factor::coded_only(symbol)?);
    };
    let level = |wanted: f64| -> anyhow::Result<Option<f64>> {
        for row in table.rows() {
            if table.number(row, column)? == wanted {
                return Ok(Some(table.number(row, natural)?));
            }
        }
        Ok(None)
    };
    match (level(-1.0)?, level(1.0)?) {
        (Some(low), Some(high)) => Ok(Factor::new(symbol, "", "1", low, high)?),
        _ => Ok(Factor::coded_only(symbol)?),
    }
}
