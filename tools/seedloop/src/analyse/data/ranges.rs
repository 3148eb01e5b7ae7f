//! The factors of a table: their ranges, and whether its columns are coded or natural.

use super::{Coding, extremes, factor_file};
use crate::analyse::Arguments;
use anyhow::{Context as _, bail, ensure};
use experiment_design::Factor;
use experiment_design::table::{Table, check_natural, factors_from_table, split_unit};
use response_surface::Model;

/// Farthest coded value of a natural column: axial points of the largest designs lie at 4.
const FARTHEST: f64 = 5.0;
/// Least spread of a natural column, in widths of the range of its factor: a table of a design covers the whole of it.
const NARROWEST: f64 = 0.01;

/// The factors, as given or as the table shows them; about zero where a model in natural units has no intercept.
pub(super) fn factors(
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

/// The factor over a range whose middle is zero and that holds its own, so that coded zero is its zero.
fn about_zero(factor: &Factor) -> Result<Factor, experiment_design::Error> {
    let end = factor.low().abs().max(factor.high().abs());
    Factor::new(factor.symbol(), factor.name(), factor.unit(), -end, end)
}

/// Symbols in the order given, with the factor where its range is given too.
pub(super) fn given_factors(argument: &str) -> anyhow::Result<Vec<(String, Option<Factor>)>> {
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

/// What the columns hold: as the flags say; coded if each has its natural values beside it, as in a file of `design`; coded
/// if all values lie in -1..+1 and every column reaches both ends, as the columns of a design do.
pub(super) fn coding(
    arguments: &Arguments,
    table: &Table,
    columns: &[usize],
) -> anyhow::Result<Coding> {
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
pub(super) fn check_naturals(
    table: &Table,
    columns: &[usize],
    factors: &[Factor],
) -> anyhow::Result<()> {
    for row in table.rows() {
        for (factor, &column) in factors.iter().zip(columns) {
            check_natural(table, row, factor, table.number(row, column)?)?;
        }
    }
    Ok(())
}

/// Name of the column of natural values beside that of a factor.
pub(in crate::analyse) fn natural_name(symbol: &str) -> String {
    format!("{symbol}_natural")
}

/// Refuses values so far outside the given range that the column can hardly be natural, or so close together that their unit can
/// hardly be that of the range, unless a flag says so.
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
