//! `seedloop analyse`: fits a model to the table of an experiment.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, bail, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, write_new};
use experiment_design::Factor;
use experiment_design::table::{Row, Table, factors_from_csv};
use response_surface::{
    Cell, Fit, Model, NamedValues, Observations, Pareto, Saturated, Weighting, fit_weighted,
    pareto, saturated,
};
use serde::Serialize;

/// Fits a model to the table of an experiment: coefficients, analysis of variance, diagnostics
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Table of the experiment, one row per run or per cell of replicates
    #[arg(value_name = "DATA.csv")]
    data: PathBuf,

    /// Factors: B,E,F with ranges where known (B=0.30:0.42,E=0.01:0.18), or a file
    /// symbol,name,unit,low,high
    #[arg(long, value_name = "LIST|FILE")]
    factors: String,

    /// Column of the response, with or without its unit (`theta` finds `theta_deg`)
    #[arg(long, value_name = "COLUMN")]
    response: String,

    /// linear, 2fi, quadratic, or a formula such as "1 + B + B:E + B^2"
    #[arg(long, default_value = "quadratic")]
    model: String,

    /// Column of the standard deviation of replicates within a row
    #[arg(long, value_name = "COLUMN")]
    sd: Option<String>,

    /// Column of the number of replicates within a row
    #[arg(long, value_name = "COLUMN")]
    n: Option<String>,

    /// Column of the block
    #[arg(long, value_name = "COLUMN")]
    block: Option<String>,

    /// Dummy columns of a screening design: adds the saturated analysis
    #[arg(long, value_name = "G,H,...", value_delimiter = ',')]
    dummies: Vec<String>,

    /// The columns of the factors hold coded values [default: seen from the data]
    #[arg(long, conflicts_with = "natural")]
    coded: bool,

    /// The columns of the factors hold natural values
    #[arg(long)]
    natural: bool,

    /// What the weights of the rows are taken from
    #[arg(long, value_enum, default_value_t = Weights::Counts)]
    weights: Weights,

    /// Writes the tables as a page
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    #[command(flatten)]
    common: Common,
}

/// What the weights are taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Weights {
    /// Number of replicates
    Counts,
    /// All rows alike
    Equal,
    /// n / sd^2; with few replicates this does more harm than good
    InverseVariance,
}

/// What the columns of the factors hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Coding {
    /// -1 at the low level, +1 at the high level.
    Coded,
    /// Units of the factors.
    Natural,
}

/// The analysis as it stands in JSON: the keys of [`Fit`] at the top.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Name of the column of the response.
    response: &'a str,
    /// What the columns of the factors held.
    columns_hold: Coding,
    /// The fit.
    #[serde(flatten)]
    fit: &'a Fit,
    /// |t| with its limits.
    pareto: Option<Pareto>,
    /// All columns as effects; null without dummy columns.
    saturated: Option<Saturated>,
    /// The warnings in words.
    warning_texts: Vec<String>,
}

/// The table with the meaning of its columns.
struct Data {
    /// The factors with their ranges.
    factors: Vec<Factor>,
    /// What the columns hold.
    coding: Coding,
    /// Cells with coded values of the factors, then the dummies.
    cells: Vec<Cell>,
    /// Name of the column of the response.
    response: String,
}

/// Reads, fits, prints.
///
/// # Errors
/// Files that cannot be read or written, columns that are missing, terms that the runs cannot
/// separate.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let data = read(arguments)?;
    let model = Model::parse(&arguments.model, &data.factors)?;
    let observations = Observations::from_cells(data.cells)?;
    let weighting = match arguments.weights {
        Weights::Counts => Weighting::Counts,
        Weights::Equal => Weighting::Equal,
        Weights::InverseVariance => Weighting::InverseVariance,
    };
    let fit = fit_weighted(&data.factors, &model, &observations, weighting)?;
    let saturated = match &arguments.dummies[..] {
        [] => None,
        dummies => {
            let symbols = data.factors.iter().map(|f| f.symbol().to_owned());
            let columns: Vec<String> = symbols.chain(dummies.iter().cloned()).collect();
            Some(saturated(&columns, &observations)?)
        }
    };
    let common = &arguments.common;
    for warning in &fit.warnings {
        common.log(|| format!("warning: {warning}"));
    }
    common.print(summary(&fit, saturated.as_ref()).trim_end())?;
    if let Some(file) = &arguments.html {
        write_new(
            file,
            page(&fit, &data.response).as_bytes(),
            common.overwrite(),
        )?;
    }
    let mut inputs = vec![arguments.data.clone()];
    inputs.extend(factor_file(&arguments.factors));
    common.emit_json(&Report {
        header: Header::new(None, inputs)?,
        response: &data.response,
        columns_hold: data.coding,
        fit: &fit,
        pareto: pareto(&fit),
        saturated,
        warning_texts: fit.warnings.iter().map(ToString::to_string).collect(),
    })?;
    Ok(DONE)
}

/// The file of the factors, if the argument is one.
fn factor_file(argument: &str) -> Option<PathBuf> {
    let path = PathBuf::from(argument);
    path.extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("csv"))
        .then_some(path)
}

/// Reads the table.
fn read(arguments: &Arguments) -> anyhow::Result<Data> {
    let path = &arguments.data;
    let place = || path.display().to_string();
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", place()))?;
    let table = Table::parse(&text).with_context(place)?;
    let given = given_factors(&arguments.factors)?;
    let mut columns = Vec::with_capacity(given.len());
    for (symbol, _) in &given {
        columns.push(table.column(symbol).with_context(place)?);
    }
    let coding = coding(arguments, &table, &columns).with_context(place)?;
    let mut factors = Vec::with_capacity(given.len());
    for ((symbol, known), &column) in given.into_iter().zip(&columns) {
        factors.push(match known {
            Some(factor) => factor,
            None => seen_factor(&table, &symbol, column, coding).with_context(place)?,
        });
    }
    let response = table.column(&arguments.response).with_context(place)?;
    let cells = Cells {
        table: &table,
        factors: columns.into_iter().zip(factors.clone()).collect(),
        coding,
        dummies: optional_columns(&table, &arguments.dummies).with_context(place)?,
        response,
        sd: named_column(&table, arguments.sd.as_deref()).with_context(place)?,
        n: named_column(&table, arguments.n.as_deref()).with_context(place)?,
        block: named_column(&table, arguments.block.as_deref()).with_context(place)?,
    };
    ensure!(
        cells.sd.is_none() || cells.n.is_some(),
        "--sd needs --n, the column of the number of replicates that the sd was taken over"
    );
    let cells = table
        .rows()
        .iter()
        .map(|row| cells.cell(row))
        .collect::<Result<_, _>>();
    Ok(Data {
        factors,
        coding,
        cells: cells.with_context(place)?,
        response: table.header()[response].clone(),
    })
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
    /// Column of the standard deviation.
    sd: Option<usize>,
    /// Column of the number of replicates.
    n: Option<usize>,
    /// Column of the block.
    block: Option<usize>,
}

impl Cells<'_> {
    /// Reads one row.
    fn cell(&self, row: &Row) -> anyhow::Result<Cell> {
        let mut coded = Vec::with_capacity(self.factors.len() + self.dummies.len());
        for (column, factor) in &self.factors {
            let value = self.table.number(row, *column)?;
            coded.push(match self.coding {
                Coding::Coded => value,
                // Rounding of the ranges must not hide that two rows have the same settings.
                Coding::Natural => (factor.coded(value) * 1e12).round() / 1e12,
            });
        }
        for &column in &self.dummies {
            coded.push(self.table.number(row, column)?);
        }
        let count = |column: Option<usize>| match column {
            Some(column) => {
                let name = &self.table.header()[column];
                anyhow::Ok(self.table.count(row, name)?.unwrap_or(1))
            }
            None => Ok(1),
        };
        let sd = self
            .sd
            .map(|column| self.table.optional_number(row, column))
            .transpose()?;
        Ok(Cell {
            coded,
            mean: self.table.number(row, self.response)?,
            sd: sd.flatten(),
            n: count(self.n)?,
            block: count(self.block)?,
        })
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
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {place}"))?;
        let factors = factors_from_csv(&text).context(place)?;
        return Ok(factors
            .into_iter()
            .map(|f| (f.symbol().to_owned(), Some(f)))
            .collect());
    }
    let mut given = Vec::new();
    for part in argument.split(',').map(str::trim) {
        let Some((symbol, range)) = part.split_once('=') else {
            given.push((part.to_owned(), None));
            continue;
        };
        let bounds = range.split_once(':').and_then(|(low, high)| {
            Some((
                low.trim().parse::<f64>().ok()?,
                high.trim().parse::<f64>().ok()?,
            ))
        });
        let Some((low, high)) = bounds else {
            bail!("'{part}' is no factor with its range; write it as B=0.30:0.42");
        };
        let symbol = symbol.trim();
        given.push((
            symbol.to_owned(),
            Some(Factor::new(symbol, "", "1", low, high)?),
        ));
    }
    Ok(given)
}

/// What the columns hold: as told, or coded if all values lie in -1..+1 and every column reaches
/// both ends, as the columns of a design do.
fn coding(arguments: &Arguments, table: &Table, columns: &[usize]) -> anyhow::Result<Coding> {
    if arguments.coded {
        return Ok(Coding::Coded);
    }
    if arguments.natural {
        return Ok(Coding::Natural);
    }
    for &column in columns {
        let (low, high) = extremes(table, column)?;
        if (low, high) != (-1.0, 1.0) {
            return Ok(Coding::Natural);
        }
    }
    Ok(Coding::Coded)
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
        return Ok(Factor::new(symbol, "", "1", low, high)?);
    }
    let Ok(natural) = table.column(&format!("{symbol}_natural")) else {
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

/// The analysis as text.
fn summary(fit: &Fit, saturated: Option<&Saturated>) -> String {
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(text, "model: {}", fit.formula);
    let _ = writeln!(
        text,
        "{:<10} {:>11} {:>10} {:>10} {:>4} {:>10} {:>9} {:>9} {:>7}",
        "term", "coef", "se", "SS", "dof", "F", "p", "p(rep)", "%"
    );
    for (name, row) in fit.terms.iter() {
        let against = |r: &response_surface::fit::Replicates| r.tests.get(name)?.p;
        let _ = writeln!(
            text,
            "{name:<10} {:>11.5} {:>10} {:>10} {:>4} {:>10} {:>9} {:>9} {:>7}",
            row.coef,
            fixed(row.se, 5),
            fixed(row.ss_partial, 4),
            1,
            fixed(row.f, 2),
            probability(row.p),
            probability(fit.replicates.as_ref().and_then(against)),
            fixed(row.contribution_pct, 3),
        );
    }
    for (name, ss, dof, f, p) in sources(fit) {
        let (f, p) = (fixed(f, 2), probability(p));
        let _ = writeln!(text, "{name:<33} {ss:>10.4} {dof:>4} {f:>10} {p:>9}");
    }
    for (name, value) in figures(fit).iter() {
        let _ = writeln!(text, "{name:<20} {value}");
    }
    if let Some(saturated) = saturated {
        let lenth = &saturated.lenth;
        let (me, sme) = (fixed(lenth.me, 4), fixed(lenth.sme, 4));
        let _ = writeln!(text, "Lenth: PSE {:.4}, ME {me}, SME {sme}", lenth.pse);
        for point in saturated.half_normal.iter().rev() {
            let _ = writeln!(
                text,
                "{:<10} |effect| {:.4}",
                point.factor, point.abs_effect
            );
        }
    }
    text
}

/// A line of the analysis of variance: name, sum of squares, dof, F, p.
type Source = (&'static str, f64, usize, Option<f64>, Option<f64>);

/// The lines of the analysis of variance that belong to no single term.
fn sources(fit: &Fit) -> Vec<Source> {
    let mut lines: Vec<Source> = vec![
        (
            "model",
            fit.model.ss,
            fit.model.df,
            fit.model.f,
            fit.model.p,
        ),
        ("residual", fit.sse, fit.df_resid, None, None),
    ];
    if let Some(lack) = &fit.lack_of_fit {
        lines.push(("lack of fit", lack.ss, lack.df, lack.f, lack.p));
    }
    if let Some(pure) = &fit.pure_error {
        lines.push(("pure error", pure.ss, pure.df, None, None));
    }
    if let Some(replicates) = &fit.replicates {
        let (ss, df) = (
            replicates.var_of_run_mean * replicates.df as f64,
            replicates.df,
        );
        let test = replicates.lack_of_fit_vs_replicates.as_ref();
        let (f, p) = (test.and_then(|t| t.f), test.and_then(|t| t.p));
        lines.push(("replicates (F: lack of fit)", ss, df, f, p));
    }
    lines.push(("total", fit.sst, fit.n - 1, None, None));
    lines
}

/// The summary figures by name.
fn figures(fit: &Fit) -> NamedValues<String> {
    let figures = [
        ("R2", fit.r2, 4),
        ("adjusted R2", fit.adj_r2, 4),
        ("predicted R2", fit.pred_r2, 4),
        ("PRESS", fit.press, 4),
        ("CV %", fit.cv_pct, 2),
        ("adequate precision", fit.adeq_precision, 2),
    ];
    figures
        .into_iter()
        .map(|(name, v, digits)| (name.to_owned(), fixed(v, digits)))
        .collect()
}

/// A number with a fixed number of decimals, or `-`.
fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"))
}

/// A p value: four decimals, small ones as a power of ten.
fn probability(value: Option<f64>) -> String {
    match value {
        Some(p) if p < 1e-3 => format!("{p:.1e}"),
        value => fixed(value, 4),
    }
}

/// The tables as a page without scripts.
fn page(fit: &Fit, response: &str) -> String {
    let escaped = |text: &str| {
        text.replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;")
    };
    let response = escaped(response);
    let body = escaped(&summary(fit, None));
    let mut cases = String::new();
    for case in &fit.cases {
        let _ = writeln!(
            cases,
            "<tr><td>{}</td><td>{}</td><td>{:.4}</td><td>{:.4}</td><td>{:.4}</td><td>{}</td>\
             <td>{}</td></tr>",
            case.run,
            case.actual,
            case.fitted,
            case.residual,
            case.leverage,
            fixed(case.studentized_external, 3),
            fixed(case.cooks_d, 4)
        );
    }
    let mut warnings = String::new();
    for warning in &fit.warnings {
        let _ = writeln!(warnings, "<li>{}</li>", escaped(&warning.to_string()));
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{response}</title>\n\
         <style>body{{font-family:sans-serif}}td,th{{padding:0 .7em;text-align:right}}</style>\n\
         <h1>{response}</h1>\n<pre>{body}</pre>\n<ul>{warnings}</ul>\n<table>\n<tr><th>run</th>\
         <th>actual</th><th>fitted</th><th>residual</th><th>leverage</th>\
         <th>external studentised</th><th>Cook's D</th></tr>\n{cases}</table></html>\n"
    )
}
