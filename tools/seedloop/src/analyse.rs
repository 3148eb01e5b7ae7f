//! `seedloop analyse`: fits a model to the table of an experiment.

mod charts;
mod data;
mod extras;
mod groups;
mod page;
mod text;

use std::path::PathBuf;

use anyhow::ensure;
use clap::ValueEnum;
use command_line::{Common, DONE, Header, try_folder, write_new};
use response_surface::{
    BoxCox, Categorical, CategoricalModel, Fit, GroupRow, InteractionStep, Model, NamedValues,
    Observations, Orders, Pareto, RandomBlocks, ReductionRule, ReductionStep, Regime, Saturated,
    Spread, Weighting, box_cox, fit_weighted, interaction_search, orders, pareto, reduce,
    saturated, spread,
};
use serde::Serialize;

use data::{Coding, Data, factor_file, read};
use extras::{Comparison, Ridge};
use page::page;
use text::{orders_text, summary};

/// Fits a model to the table of an experiment: coefficients, analysis of variance, diagnostics
#[derive(clap::Args, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
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

    /// Columns of factors with named levels (wall,operator), besides --factors
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
    #[arg(long, conflicts_with = "natural")]
    coded: bool,

    /// The columns of the factors hold natural values
    #[arg(long)]
    natural: bool,

    /// What the weights of the rows are taken from
    #[arg(long, value_enum, default_value_t = Weights::Counts)]
    weights: Weights,

    /// Drops terms that add nothing, but none that a product needs
    #[arg(long, value_enum, value_name = "RULE")]
    reduce: Option<Rule>,

    /// Limit of p for --reduce p, and for the main effects whose interactions are looked for with
    /// --dummies
    #[arg(long, value_name = "P", default_value_t = 0.1)]
    alpha: f64,

    /// Fits a Gaussian process as well and compares it by leaving cells out
    #[arg(long)]
    gaussian_process: bool,

    /// Takes only the rows of this regime for the surface, and fits the boundary to the others
    #[arg(long, value_name = "COLUMN=NAME", value_parser = regime_argument)]
    regime: Option<(String, String)>,

    /// Compares the groups that the one column of --factors names (one-way analysis of variance)
    #[arg(long)]
    groups: bool,

    /// Writes the charts into this folder as SVG and PNG
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,

    /// Writes tables and charts as a page
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
    /// Two-factor interactions that may stand behind a screening design; null without `--dummies`.
    interaction_search: Option<Vec<InteractionStep>>,
    /// The alternative, if asked for.
    gaussian_process: Option<Comparison>,
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
    arguments.common.try_outputs(&arguments.html)?;
    arguments.plots.as_deref().map_or(Ok(()), try_folder)?;
    if arguments.groups {
        return groups::run(arguments);
    }
    let mut data = read(arguments)?;
    let boundary = extras::split_regimes(arguments, &mut data)?;
    let (named, mut model) = asked_model(arguments, &mut data)?;
    let observations = Observations::from_cells(data.cells.clone())?;
    let weighting = match arguments.weights {
        Weights::Counts => Weighting::Counts,
        Weights::Equal => Weighting::Equal,
        Weights::InverseVariance => Weighting::InverseVariance,
        Weights::ShrunkVariance => Weighting::ShrunkVariance,
    };
    let (mut fit, reduction) = fitted(arguments, &data, &model, &observations, weighting)?;
    model.clone_from(&fit.formula);
    if named.is_some() {
        // The box of the columns of levels is no set of settings.
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
    let common = &arguments.common;
    for warning in &fit.warnings {
        common.log(|| format!("warning: {warning}"));
    }
    let report = Report {
        header: Header::new(None, inputs(arguments))?,
        response: &data.response,
        columns_hold: data.coding,
        fit: &fit,
        pareto: pareto(&fit),
        saturated,
        // Orders over the columns of named levels would have their powers.
        orders: match &named {
            None => Some(orders(&data.factors, &observations, weighting)?),
            Some(_) => None,
        },
        categories: data.categories.clone(),
        level_tests,
        spread: spread(&observations),
        box_cox: box_cox(&data.factors, &model, &observations, weighting)?,
        reduction,
        dfbetas: (fit.n <= 1000).then(|| (0..fit.n).map(|i| fit.dfbetas(i)).collect()),
        ridge: named.is_none().then(|| Ridge::of(&fit)).flatten(),
        random_batches: extras::batches(&data, &model, weighting)?,
        interaction_search: match &arguments.dummies[..] {
            [] => None,
            _ => Some(interaction_search(
                &data.factors,
                &observations,
                weighting,
                arguments.alpha,
            )?),
        },
        gaussian_process: extras::comparison(arguments, &data.factors, &observations, &fit)?,
        regime: boundary,
        warning_texts: fit.warnings.iter().map(ToString::to_string).collect(),
    };
    write(arguments, &report)?;
    common.emit_json(&report)?;
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
) -> anyhow::Result<(Fit, Vec<ReductionStep>)> {
    let factors = &data.factors;
    let Some(rule) = arguments.reduce else {
        let fit = fit_weighted(factors, model, observations, weighting)?;
        return Ok((fit, Vec::new()));
    };
    let rule = match rule {
        Rule::P => ReductionRule::PValue(arguments.alpha),
        Rule::Aicc => ReductionRule::Aicc,
        Rule::Bic => ReductionRule::Bic,
    };
    Ok(reduce(factors, model, observations, weighting, rule)?)
}

/// Prints the analysis, and writes page and charts where asked for.
fn write(arguments: &Arguments, report: &Report<'_>) -> anyhow::Result<()> {
    let common = &arguments.common;
    let orders = report.orders.as_ref().map(orders_text).unwrap_or_default();
    common.print(summary(report.fit, report.saturated.as_ref()).trim_end())?;
    if !orders.is_empty() {
        common.print(format!("\n{}", orders.trim_end()))?;
    }
    extras::print(common, report)?;
    if arguments.html.is_none() && arguments.plots.is_none() {
        return Ok(());
    }
    let charts = charts::all(report)?;
    if let Some(file) = &arguments.html {
        let page = page(report, &orders, &charts);
        write_new(file, page.as_bytes(), common.overwrite())?;
    }
    if let Some(folder) = &arguments.plots {
        charts::write(common, folder, &charts)?;
    }
    Ok(())
}

/// The files that the analysis was made from.
fn inputs(arguments: &Arguments) -> Vec<PathBuf> {
    let mut inputs = vec![arguments.data.clone()];
    inputs.extend(factor_file(&arguments.factors));
    inputs
}
