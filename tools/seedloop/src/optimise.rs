//! `seedloop optimise`: where a fitted surface meets a target.

mod goals;

use std::path::PathBuf;

use anyhow::{Context as _, bail, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, NOT_MET};
use experiment_design::Factor;
use response_surface::{
    Confirmation, ErrorSource, Fit, Measured, NamedValues, Prediction, SolutionRequest, Solutions,
    confirm, solutions,
};
use serde::Serialize;

/// Finds where a fitted surface meets a target: the whole set, its region, the nearest solutions
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Analysis written by `seedloop analyse --json FILE`
    #[arg(value_name = "ANALYSIS.json")]
    analysis: PathBuf,

    /// Value that the response should have, unit of the response
    #[arg(long, allow_negative_numbers = true, required_unless_present = "goal")]
    target: Option<f64>,

    /// What the response should be instead: max, max:LOW:HIGH, min, min:LOW:HIGH, range:LOW:HIGH or
    /// target:LOW:VALUE:HIGH, with ^WEIGHT and *IMPORTANCE behind it where wanted
    #[arg(
        long,
        value_name = "GOAL",
        conflicts_with = "target",
        allow_hyphen_values = true
    )]
    goal: Option<String>,

    /// A further response with its goal, OTHER.json=GOAL; may be given several times
    #[arg(long = "also", value_name = "FILE=GOAL", requires = "goal")]
    also: Vec<String>,

    /// Narrower or wider bounds of factors, B=0.30:0.36,E=0.01:0.10
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    bounds: Vec<String>,

    /// Responses of confirmation runs at the point of --at, judged against the prediction interval
    /// of their mean
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        requires = "at",
        allow_negative_numbers = true
    )]
    confirm: Vec<f64>,

    /// Standard deviation of the measured target, unit of the response
    #[arg(long, value_name = "SD", requires = "target_n")]
    target_sd: Option<f64>,

    /// Number of independent measurements behind the target
    #[arg(long, value_name = "N", requires = "target_sd")]
    target_n: Option<usize>,

    /// Measured values that the solution should lie near: B=0.32,E=0.06; with sd and number
    /// B=0.32+-0.05/5
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    near: Vec<String>,

    /// Which error variance the region is made with [default: all repeats, or the residuals]
    #[arg(long, value_enum)]
    error: Option<ErrorKind>,

    /// Predicts at this point as well: B=0.33,E=0.06,F=0.10
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    at: Vec<String>,

    #[command(flatten)]
    common: Common,
}

/// Error variances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ErrorKind {
    /// Residuals of the fit
    Residual,
    /// Rows with the same settings
    RepeatedRows,
    /// Replicates within rows
    Replicates,
    /// Both of them
    AllRepeats,
}

/// The answer as it stands in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Symbols of the factors, in the order of all points.
    factors: Vec<String>,
    /// The solutions.
    #[serde(flatten)]
    solutions: Solutions,
    /// The prediction at the point asked for.
    at: Option<Prediction>,
    /// The verdict on the confirmation runs.
    confirmation: Option<Confirmation>,
}

/// Reads the analysis and answers.
///
/// # Errors
/// Files that cannot be read, a target or measured values that cannot be meant.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let path = &arguments.analysis;
    let fit = goals::read(path, &arguments.bounds)?;
    let Some(target) = arguments.target else {
        return goals::run(arguments, fit);
    };
    let error = arguments.error.map(|kind| match kind {
        ErrorKind::Residual => ErrorSource::Residual,
        ErrorKind::RepeatedRows => ErrorSource::RepeatedRows,
        ErrorKind::Replicates => ErrorSource::Replicates,
        ErrorKind::AllRepeats => ErrorSource::AllRepeats,
    });
    let request = SolutionRequest {
        target,
        target_sd: arguments.target_sd,
        target_n: arguments.target_n,
        near: measured(&fit, &arguments.near)?,
        error,
    };
    let solutions = solutions(&fit, &request)?;
    let at = predicted(&fit, &arguments.at, &solutions)?;
    let confirmation = match (&arguments.confirm[..], &at) {
        ([], _) | (_, None) => None,
        (runs, Some(at)) => Some(confirm(&fit, &at.natural, runs, solutions.error)?),
    };
    let common = &arguments.common;
    describe(common, &fit, &solutions, at.as_ref())?;
    if let Some(confirmation) = &confirmation {
        describe_confirmation(common, confirmation)?;
    }
    let refuted = confirmation.as_ref().and_then(|c| c.confirmed) == Some(false);
    let code = if solutions.exists && !refuted {
        DONE
    } else {
        NOT_MET
    };
    common.emit_json(&Report {
        header: Header::new(None, [path])?,
        factors: fit.factors.iter().map(|f| f.symbol().to_owned()).collect(),
        solutions,
        at,
        confirmation,
    })?;
    Ok(code)
}

/// Prints the verdict on the confirmation runs.
fn describe_confirmation(common: &Common, confirmation: &Confirmation) -> anyhow::Result<()> {
    let Confirmation { n, mean, .. } = confirmation;
    let verdict = match confirmation.confirmed {
        Some(true) => "they confirm it",
        Some(false) => "they do not confirm it",
        None => "no interval: there is no error variance",
    };
    let interval = confirmation
        .pi95_mean
        .map_or_else(String::new, |[low, high]| {
            format!(" (95 % prediction interval of the mean {low:.4} to {high:.4})")
        });
    common.print(format!(
        "{n} confirmation runs, mean {mean:.4}{interval}: {verdict}"
    ))
}

/// Reads `B=0.32+-0.05/5` and the like into the order of the factors.
fn measured(fit: &Fit, list: &[String]) -> anyhow::Result<Vec<Option<Measured>>> {
    let mut near = vec![None; fit.factors.len()];
    for part in list {
        let form = || format!("'{part}' is no measured value; write B=0.32 or B=0.32+-0.05/5");
        let (symbol, text) = part.split_once('=').with_context(form)?;
        let place = fit.factors.iter().position(|f| f.symbol() == symbol.trim());
        let Some(place) = place else {
            let known: Vec<&str> = fit.factors.iter().map(Factor::symbol).collect();
            bail!(
                "there is no factor '{}'; the factors are {}",
                symbol.trim(),
                known.join(", ")
            );
        };
        ensure!(
            near[place].is_none(),
            "the factor '{}' is given twice",
            symbol.trim()
        );
        let text = text.replace('±', "+-");
        let (value, spread) = match text.split_once("+-") {
            Some((value, spread)) => (value, Some(spread)),
            None => (text.as_str(), None),
        };
        let (sd, n) = match spread.map(|spread| spread.split_once('/').unwrap_or((spread, ""))) {
            Some((sd, "")) => (Some(sd), None),
            Some((sd, n)) => (Some(sd), Some(n)),
            None => (None, None),
        };
        let number = |text: &str| text.trim().parse::<f64>().ok().with_context(form);
        near[place] = Some(Measured {
            value: number(value)?,
            sd: sd.map(number).transpose()?,
            n: n.map(|n| n.trim().parse::<usize>().ok().with_context(form))
                .transpose()?,
        });
    }
    Ok(near)
}

/// The prediction at the point asked for, if one is.
fn predicted(
    fit: &Fit,
    list: &[String],
    solutions: &Solutions,
) -> anyhow::Result<Option<Prediction>> {
    if list.is_empty() {
        return Ok(None);
    }
    let mut point = Vec::with_capacity(fit.factors.len());
    for (factor, value) in fit.factors.iter().zip(measured(fit, list)?) {
        let symbol = factor.symbol();
        let value = value.with_context(|| format!("--at needs a value for '{symbol}'"))?;
        point.push(value.value);
    }
    Ok(Some(fit.predict_with(&point, solutions.error)?))
}

/// The answer as text.
fn describe(
    common: &Common,
    fit: &Fit,
    solutions: &Solutions,
    at: Option<&Prediction>,
) -> anyhow::Result<()> {
    let symbols: Vec<&str> = fit.factors.iter().map(Factor::symbol).collect();
    let point = |values: &[f64]| {
        let pairs = symbols.iter().zip(values);
        pairs
            .map(|(s, v)| format!("{s} = {v:.5}"))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let (min, max) = (&solutions.reachable.min, &solutions.reachable.max);
    common.print(format!(
        "surface within the ranges: {:.4} to {:.4}",
        min.value, max.value
    ))?;
    if !solutions.exists {
        let closest = if solutions.target < min.value {
            min
        } else {
            max
        };
        common.print(format!(
            "no solution: the closest value to {} is {:.4} at {}; widen the ranges there",
            solutions.target,
            closest.value,
            point(&closest.natural)
        ))?;
    }
    for (symbol, range) in solutions.factor_ranges.iter().flat_map(NamedValues::iter) {
        let (low, high) = (range.natural.low, range.natural.high);
        common.print(format!(
            "{symbol} on the solution set: {low:.5} to {high:.5}"
        ))?;
    }
    for (metric, nearest) in solutions.nearest.iter() {
        let place = point(&nearest.solution);
        common.print(format!(
            "nearest by {metric}: {place}; distance {:.4}",
            nearest.distance
        ))?;
        for (symbol, given) in nearest.given_others.iter().flat_map(NamedValues::iter) {
            let (low, high) = (given.natural.low, given.natural.high);
            let below = if given.open_below { " (bound)" } else { "" };
            let above = if given.open_above { " (bound)" } else { "" };
            common.print(format!(
                "  {symbol} given the others, 95 %: {low:.5}{below} to {high:.5}{above}"
            ))?;
        }
    }
    if let Some(region) = &solutions.region {
        let percent = 100.0 * region.box_fraction;
        common.print(format!(
            "{percent:.1} % of the box cannot be told from a solution"
        ))?;
    }
    if let Some(at) = at {
        let interval = at
            .ci95
            .map_or_else(String::new, |[a, b]| format!(", 95 % {a:.4} to {b:.4}"));
        common.print(format!(
            "at {}: {:.4}{interval}",
            point(&at.natural),
            at.mean
        ))?;
    }
    Ok(())
}
