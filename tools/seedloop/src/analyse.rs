//! `seedloop analyse`: fits a model to the table of an experiment.

mod beside;
mod charts;
mod data;
mod extras;
mod groups;
mod page;
mod predict;
mod text;

use std::path::PathBuf;

use anyhow::{anyhow, ensure};
use beside::beside;
use clap::ValueEnum;
use command_line::{Common, DONE, Header, try_folder, write_new};
use response_surface::{
    BoxCox, Categorical, CategoricalModel, Contrasts, Fit, GroupRow, InteractionStep, Model,
    NamedValues, Observations, Orders, Pareto, RandomBlocks, ReductionRule, ReductionStep, Regime,
    Saturated, Sobol, Spread, Transform, Weighting, aliases, box_cox, contrasts, fit_weighted,
    interaction_search, orders, pareto, reduce, saturated, spread,
};
use serde::Serialize;

use crate::levels::{self, LevelMean};
use data::{Coding, Data, factor_file, read};
use extras::{Comparison, Ridge};
use page::page;
use predict::{Predicted, predictions};
pub(crate) use text::fixed;
use text::{orders_text, summary};

/// Fits a model to the table of an experiment: coefficients, analysis of variance, diagnostics
#[derive(clap::Args, Debug)]
#[command(
    after_help = "Example:\n  seedloop analyse results.xlsx --factors B=0.30:0.42,E=0.01:0.18 --response angle_deg --json analysis.json"
)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct Arguments {
    /// Table of the experiment, one row per run or per cell of replicates: CSV or an Excel workbook (book.xlsx#Runs names a
    /// sheet)
    #[arg(value_name = "DATA.csv")]
    data: PathBuf,

    /// Factors: B,E,F with ranges where known (B=0.30:0.42,E=0.01:0.18), or a file
    /// symbol,name,unit,low,high
    #[arg(long, value_name = "LIST|FILE", required_unless_present = "categories")]
    factors: Option<String>,

    /// Column of the response, with or without its unit (`theta` finds `theta_deg`)
    #[arg(long, value_name = "COLUMN")]
    response: String,

    /// mean, linear, 2fi, quadratic, cubic, or a formula such as "1 + B + B:E + B^2", "B*E" or "(B + E + F)^2"; with "0 +" the
    /// response is 0 where all factors are
    #[arg(long, default_value = "quadratic")]
    model: String,

    /// Fits a function of the response instead, ln, log10, sqrt, inverse or power:P; predictions and intervals are in
    /// the unit of the response as well
    #[arg(long, value_name = "FUNCTION", conflicts_with_all = ["sd", "n", "groups"])]
    transform: Option<Transform>,

    /// Column of the standard deviation of replicates within a row
    #[arg(long, value_name = "COLUMN")]
    sd: Option<String>,

    /// Column of the number of replicates within a row
    #[arg(long, value_name = "COLUMN")]
    n: Option<String>,

    /// Column of the block (numbers or names)
    #[arg(long, value_name = "COLUMN")]
    block: Option<String>,

    /// Columns of factors with named levels (wall,operator), alone or besides --factors
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        conflicts_with_all = ["dummies", "groups"]
    )]
    categories: Vec<String>,

    /// Column of batches drawn at random (numbers or names): adds the fit with two variances
    #[arg(long, value_name = "COLUMN", conflicts_with = "block")]
    batch: Option<String>,

    /// Dummy columns of a screening design: adds the saturated analysis
    #[arg(long, value_name = "G,H,...", value_delimiter = ',')]
    dummies: Vec<String>,

    /// The columns of the factors hold coded values [default: seen from the data]
    #[arg(long, conflicts_with = "natural", requires = "factors")]
    coded: bool,

    /// The columns of the factors hold natural values
    #[arg(long, requires = "factors")]
    natural: bool,

    /// What the weights of the rows are taken from
    #[arg(long, value_enum, default_value_t = Weights::Counts)]
    weights: Weights,

    /// Drops terms that add nothing, but none that a product needs
    #[arg(long, value_enum, value_name = "RULE")]
    reduce: Option<Rule>,

    /// Limit of p for --reduce p, and for the main effects whose interactions are looked for with
    /// --dummies [default: 0.1]
    #[arg(long, value_name = "P")]
    alpha: Option<f64>,

    /// Fits a Gaussian process as well and compares it by leaving cells out
    #[arg(long)]
    gaussian_process: bool,

    /// Predicts at each row of another table, whose columns hold what those of the data hold: mean and a single run with 95 %
    /// intervals, by the polynomial and by the Gaussian process where it is asked for
    #[arg(long, value_name = "POINTS.csv", conflicts_with = "groups")]
    predict: Option<PathBuf>,

    /// Reports which share of the variance of the surface over the ranges each factor makes, alone and in all (Sobol indices)
    #[arg(long, conflicts_with = "groups")]
    sensitivity: bool,

    /// Takes only the rows of this regime for the surface, and fits the boundary to the others
    #[arg(long, value_name = "COLUMN=NAME", value_parser = regime_argument)]
    regime: Option<(String, String)>,

    /// Compares the groups that the one column of --factors names (one-way analysis of variance)
    #[arg(long, requires = "factors", conflicts_with_all = UNREAD_BY_GROUPS)]
    groups: bool,

    /// Writes the charts into this folder as SVG
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,

    /// Writes tables and charts as a page
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    #[command(flatten)]
    common: Common,
}

/// Flags that a comparison of groups has no use for: one that is left unread would be taken for one that was followed.
const UNREAD_BY_GROUPS: [&str; 15] = [
    "model",
    "sd",
    "n",
    "block",
    "batch",
    "dummies",
    "coded",
    "natural",
    "weights",
    "reduce",
    "alpha",
    "gaussian_process",
    "regime",
    "plots",
    "html",
];

/// Limit of p if none is given.
const ALPHA: f64 = 0.1;

/// What the weights are taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Weights {
    /// Number of replicates
    Counts,
    /// All rows alike
    Equal,
    /// n / sd^2; with few replicates this does more harm than good
    InverseVariance,
    /// n over the variance drawn towards the pooled one
    ShrunkVariance,
}

/// What decides whether a term goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Rule {
    /// Least significant first, down to --alpha
    P,
    /// Akaike's corrected criterion
    Aicc,
    /// Schwarz's criterion
    Bic,
}

/// Reads `COLUMN=NAME`.
fn regime_argument(text: &str) -> Result<(String, String), String> {
    let pair = text
        .split_once('=')
        .filter(|(column, name)| !column.is_empty() && !name.is_empty());
    let (column, name) = pair.ok_or("write it as COLUMN=NAME, such as regime=rolling")?;
    Ok((column.to_owned(), name.to_owned()))
}

impl Arguments {
    /// Column of the regime, if one is named.
    fn regime_column(&self) -> Option<&str> {
        self.regime.as_ref().map(|(column, _)| column.as_str())
    }
}

/// The analysis in JSON: the keys of [`Fit`] at the top.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Name of the column of the response, or the function of it that was fitted.
    response: &'a str,
    /// The function of the response that was fitted; null for the response itself.
    transform: Option<Transform>,
    /// What the columns of the factors held.
    columns_hold: Coding,
    #[serde(flatten)]
    fit: &'a Fit,
    /// |t| with its limits.
    pareto: Option<Pareto>,
    /// All columns as effects; null without dummy columns.
    saturated: Option<Saturated>,
    /// Lenth's margins of a model that leaves no degrees of freedom; null for any other.
    contrasts: Option<Contrasts>,
    /// Models of growing order, and the suggested one; null with named levels.
    orders: Option<Orders>,
    /// The factors with named levels.
    categories: Vec<Categorical>,
    /// Tests of the terms as written, all columns of a named factor together; null without such.
    level_tests: Option<NamedValues<GroupRow>>,
    /// Tests that single runs scatter alike; null without repeated rows.
    spread: Option<Spread>,
    /// Power of the response; null where a response is not above zero.
    box_cox: Option<BoxCox>,
    /// Terms that `--reduce` dropped, in that order.
    reduction: Vec<ReductionStep>,
    /// Change of each coefficient when a row is left out, in the order of the terms; null for
    /// more than 1000 rows.
    dfbetas: Option<Vec<Option<Vec<f64>>>>,
    /// Highest and lowest points of the surface at growing distance from the centre; null for
    /// models above degree two.
    ridge: Option<Ridge>,
    /// The fit with batches drawn at random, if asked for.
    random_batches: Option<RandomBlocks>,
    /// What terms left out add to the expected coefficients of those fitted, by term left out; null with named levels.
    aliases: Option<NamedValues<NamedValues<f64>>>,
    /// Predicted response at the levels of the named factors, the others in the middle of their ranges.
    level_means: Vec<LevelMean>,
    /// Two-factor interactions that may stand behind a screening design; null without `--dummies`.
    interaction_search: Option<Vec<InteractionStep>>,
    /// The alternative, if asked for.
    gaussian_process: Option<Comparison>,
    /// What both models say about the rows of the table of `--predict`, in its order; empty without.
    predictions: Vec<Predicted>,
    /// Shares of the variance of the surface; null without `--sensitivity` and for a surface that does not vary.
    sobol: Option<Sobol>,
    /// The boundary of the regime, if asked for.
    regime: Option<Regime>,
    /// The warnings in words.
    warning_texts: Vec<String>,
}

/// Reads, fits, prints.
///
/// # Errors
/// Files that cannot be read or written, columns that are missing, terms that the runs cannot
/// separate.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let (inputs, files) = ([&arguments.data], &arguments.html);
    arguments.common.try_outputs_beside(inputs, files)?;
    arguments.plots.as_deref().map_or(Ok(()), try_folder)?;
    if arguments.groups {
        return groups::run(arguments);
    }
    ensure!(
        arguments.alpha.is_none()
            || arguments.reduce == Some(Rule::P)
            || !arguments.dummies.is_empty(),
        "--alpha is for --reduce p and for --dummies; leave it out"
    );
    let mut data = read(arguments)?;
    let boundary = extras::split_regimes(arguments, &mut data)?;
    let (named, mut model) = asked_model(arguments, &mut data)?;
    let observations = Observations::from_cells(data.cells.clone())?;
    let observations = observations.with_block_names(data.block_names.clone());
    let weighting = match arguments.weights {
        Weights::Counts => Weighting::Counts,
        Weights::Equal => Weighting::Equal,
        Weights::InverseVariance => Weighting::InverseVariance,
        Weights::ShrunkVariance => Weighting::ShrunkVariance,
    };
    let (mut fit, reduction) = fitted(arguments, &data, &model, &observations, weighting)
        .map_err(|e| anyhow!("{}: {e}", arguments.data.display()))?;
    model.clone_from(&fit.formula);
    if named.is_some() {
        // The box of the columns of levels contains no settings.
        (fit.canonical, fit.box_extremes) = (None, None);
    }
    let level_tests = match &named {
        None => None,
        Some(named) => Some(named.tests(&fit, &observations, weighting)?),
    };
    let saturated = match &arguments.dummies[..] {
        [] => None,
        dummies => {
            let symbols = data.factors.iter().map(|f| f.symbol().to_owned());
            let columns: Vec<String> = symbols.chain(dummies.iter().cloned()).collect();
            Some(saturated(&columns, &observations)?)
        }
    };
    let fits = Fits {
        fit: &fit,
        model: &model,
        observations: &observations,
        weighting,
        is_named: named.is_some(),
    };
    let report = Report {
        level_tests,
        saturated,
        reduction,
        regime: boundary,
        ..report(arguments, &data, &fits)?
    };
    tell(arguments, &report)
}

/// A fit with what it was made from.
struct Fits<'a> {
    fit: &'a Fit,
    model: &'a Model,
    observations: &'a Observations,
    /// What its weights were taken from.
    weighting: Weighting,
    /// Whether some of its columns are those of named levels: orders and powers over them mean nothing.
    is_named: bool,
}

/// The report of a fit.
fn report<'a>(
    arguments: &Arguments,
    data: &'a Data,
    fits: &Fits<'a>,
) -> anyhow::Result<Report<'a>> {
    let Fits {
        fit,
        model,
        observations,
        weighting,
        is_named,
    } = *fits;
    let search = || {
        interaction_search(
            &data.factors,
            observations,
            weighting,
            arguments.alpha.unwrap_or(ALPHA),
        )
    };
    let screened = !arguments.dummies.is_empty();
    let unnamed = !is_named;
    let gaussian_process = extras::comparison(arguments, &data.factors, observations, fit)?;
    let process = gaussian_process.as_ref().map(|c| &c.process);
    let predictions = match &arguments.predict {
        None => Vec::new(),
        Some(path) => predictions(path, data, fit, process, arguments.transform)?,
    };
    Ok(Report {
        predictions,
        sobol: extras::shares(arguments, data, fit)?,
        gaussian_process,
        header: Header::new(None, inputs(arguments))?,
        response: &data.response,
        transform: arguments.transform,
        columns_hold: data.coding,
        fit,
        pareto: pareto(fit),
        contrasts: contrasts(fit),
        saturated: None,
        orders: unnamed
            .then(|| orders(&data.factors, observations, weighting))
            .transpose()?,
        categories: data.categories.clone(),
        level_tests: None,
        spread: spread(observations),
        box_cox: box_cox(&data.factors, model, observations, weighting)?,
        reduction: Vec::new(),
        dfbetas: (fit.n <= 1000).then(|| (0..fit.n).map(|i| fit.dfbetas(i)).collect()),
        ridge: unnamed.then(|| Ridge::of(fit)).flatten(),
        aliases: unnamed.then(|| aliases(fit, observations)).transpose()?,
        level_means: levels::means(fit, &data.categories, arguments.transform),
        random_batches: extras::batches(data, model, weighting)?,
        interaction_search: screened.then(search).transpose()?,
        regime: None,
        warning_texts: data
            .warnings
            .iter()
            .cloned()
            .chain(fit.warnings.iter().map(ToString::to_string))
            .collect(),
    })
}

/// Writes the files asked for and prints the analysis.
fn tell(arguments: &Arguments, report: &Report<'_>) -> anyhow::Result<u8> {
    let common = &arguments.common;
    for warning in &report.warning_texts {
        common.log(|| format!("warning: {warning}"));
    }
    let orders = report.orders.as_ref().map(orders_text).unwrap_or_default();
    let mut text = summary(report.fit, report.saturated.as_ref());
    if report.transform.is_some() {
        text.insert_str(0, &format!("response: {}\n", report.response));
    }
    for part in [orders, beside(report), predict::text(&report.predictions)] {
        if !part.is_empty() {
            text = format!("{}\n\n{part}", text.trim_end());
        }
    }
    // Files first: they do not depend on who reads standard output.
    write(arguments, report, &text)?;
    common.emit_json(report)?;
    common.print(text.trim_end())?;
    Ok(DONE)
}

/// The model asked for; with named levels, their columns join the factors of the data.
fn asked_model(
    arguments: &Arguments,
    data: &mut Data,
) -> anyhow::Result<(Option<CategoricalModel>, Model)> {
    if data.categories.is_empty() {
        return Ok((None, Model::parse(&arguments.model, &data.factors)?));
    }
    ensure!(
        arguments.reduce.is_none(),
        "--reduce takes one column at a time and would tear named levels apart; write the smaller \
         model with --model instead"
    );
    let named = CategoricalModel::parse(&arguments.model, &data.factors, &data.categories)?;
    data.factors.clone_from(&named.factors);
    let model = named.model.clone();
    Ok((Some(named), model))
}

/// The fit, reduced where asked for, and the terms that went.
fn fitted(
    arguments: &Arguments,
    data: &Data,
    model: &Model,
    observations: &Observations,
    weighting: Weighting,
) -> Result<(Fit, Vec<ReductionStep>), response_surface::Error> {
    let factors = &data.factors;
    let Some(rule) = arguments.reduce else {
        let fit = fit_weighted(factors, model, observations, weighting)?;
        return Ok((fit, Vec::new()));
    };
    let rule = match rule {
        Rule::P => ReductionRule::PValue(arguments.alpha.unwrap_or(ALPHA)),
        Rule::Aicc => ReductionRule::Aicc,
        Rule::Bic => ReductionRule::Bic,
    };
    reduce(factors, model, observations, weighting, rule)
}

/// Writes page and charts where asked for.
fn write(arguments: &Arguments, report: &Report<'_>, text: &str) -> anyhow::Result<()> {
    let common = &arguments.common;
    if arguments.html.is_none() && arguments.plots.is_none() {
        return Ok(());
    }
    let charts = charts::all(report)?;
    if let Some(file) = &arguments.html {
        let page = page(report, text, &charts)?;
        write_new(file, page.as_bytes(), common.overwrite())?;
    }
    if let Some(folder) = &arguments.plots {
        charts::write(common, folder, &charts)?;
    }
    Ok(())
}

/// The files that the analysis was made from.
fn inputs(arguments: &Arguments) -> Vec<PathBuf> {
    let factors = arguments.factors.as_deref().and_then(factor_file);
    let points = arguments.predict.clone();
    let tables = [arguments.data.clone()]
        .into_iter()
        .chain(factors)
        .chain(points);
    tables
        .map(|table| command_line::table_file::file_of(&table))
        .collect()
}
