//! `seedloop optimise`: where a fitted surface meets a target.

mod goals;
mod read;
mod scale;
mod words;

use std::path::PathBuf;

use anyhow::{Context as _, bail, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, NOT_MET};
use experiment_design::Factor;
use response_surface::solutions::{Bootstrap, Robust, bootstrap, most_robust};
use response_surface::{
    Confirmation, ErrorSource, Fit, Measured, NamedValues, Prediction, Propagation,
    SolutionRequest, Solutions, Tolerance, confirm, solutions,
};
use scale::{InUnit, Scale};
use serde::Serialize;

/// Confidence of the tolerance interval: as customary.
const CONFIDENCE: f64 = 0.95;

/// Flags that the search for the best setting has no use for: one that is left unread would be taken for one that was
/// followed.
const UNREAD_BY_GOALS: [&str; 8] = [
    "target",
    "target_sd",
    "target_n",
    "near",
    "confirm",
    "content",
    "bootstrap",
    "seed",
];

/// Share of all runs that a tolerance interval holds if none is given: as customary.
const CONTENT: f64 = 0.99;

/// Finds where a fitted surface meets a target: the whole set, its region, the nearest solutions
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop optimise analysis.json --target 36")]
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
        conflicts_with_all = UNREAD_BY_GOALS,
        allow_hyphen_values = true
    )]
    goal: Option<String>,

    /// A further response with its goal, OTHER.json=GOAL; may be given several times. With --factor-sd,
    /// transmitted=min:LOW:HIGH is the scatter that the factors hand on to the first response
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

    /// Level of every factor with named levels: wall=steel,operator=A
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    level: Vec<String>,

    /// Which error variance the region is made with [default: all repeats, or the residuals]
    #[arg(long, value_enum)]
    error: Option<ErrorKind>,

    /// Predicts at this point as well, with --goal also what it is worth: B=0.33,E=0.06,F=0.10
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    at: Vec<String>,

    /// Standard deviations of the factors in use: B=0.01,E=0.005. Reports what they do to the response,
    /// and the solution at which they do least
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    factor_sd: Vec<String>,

    /// Redraws the experiment so often and solves each again: how the nearest solution scatters
    #[arg(long, value_name = "DRAWS")]
    bootstrap: Option<usize>,

    /// Seed of --bootstrap [default: 1]
    #[arg(long, value_name = "N", requires = "bootstrap")]
    seed: Option<u64>,

    /// Share of all runs that the tolerance interval at --at holds, with 95 % confidence [default: 0.99]
    #[arg(long, value_name = "SHARE", requires = "at")]
    content: Option<f64>,

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

impl Arguments {
    /// The error variance asked for.
    fn error(&self) -> Option<ErrorSource> {
        self.error.map(|kind| match kind {
            ErrorKind::Residual => ErrorSource::Residual,
            ErrorKind::RepeatedRows => ErrorSource::RepeatedRows,
            ErrorKind::Replicates => ErrorSource::Replicates,
            ErrorKind::AllRepeats => ErrorSource::AllRepeats,
        })
    }
}

/// The answer in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Symbols of the factors, in the order of all points.
    factors: Vec<String>,
    /// Values in the unit of the response, where a function of it was fitted; all others are those of the function.
    original: Option<InUnit>,
    #[serde(flatten)]
    solutions: Solutions,
    /// The prediction at the point asked for.
    at: Option<Prediction>,
    /// Where a share of all runs at that point lies; null without an error variance.
    tolerance: Option<Tolerance>,
    /// What the scatter of the factors does at that point; null without `--factor-sd`.
    propagation: Option<Propagation>,
    /// The same at the nearest solution of each metric.
    propagation_nearest: NamedValues<Propagation>,
    /// The solution at which that scatter does least; null without `--factor-sd` or solution.
    most_robust: Option<Robust>,
    /// The nearest solutions of redrawn experiments; empty without `--bootstrap`.
    bootstrap: Vec<Bootstrap>,
    /// The verdict on the confirmation runs.
    confirmation: Option<Confirmation>,
    /// What to bear in mind, such as bounds beyond the data.
    warnings: Vec<String>,
}

/// Reads the analysis and answers.
///
/// # Errors
/// Files that cannot be read, a target or measured invalid values.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    arguments.common.try_outputs([])?;
    let read = read::read(&arguments.analysis, arguments)?;
    let Some(target) = arguments.target else {
        return goals::run(arguments, read);
    };
    let (fit, transform, warnings) = (read.fit, read.transform, read.warnings);
    let scale = Scale(transform);
    let request = SolutionRequest {
        target: scale.of("the target", target)?,
        target_sd: scale.sd(target, arguments.target_sd)?,
        target_n: arguments.target_n,
        near: measured(&fit, &arguments.near)?,
        error: arguments.error(),
    };
    let solutions = solutions(&fit, &request)?;
    let at = match point_at(&fit, &arguments.at)? {
        Some(point) => Some(fit.predict_with(&point, solutions.error)?),
        None => None,
    };
    let confirmation = match (&arguments.confirm[..], &at) {
        ([], _) | (_, None) => None,
        (runs, Some(at)) => {
            let runs = runs.iter().map(|y| scale.of("a confirmation run", *y));
            let runs: Vec<f64> = runs.collect::<anyhow::Result<_>>()?;
            Some(confirm(&fit, &at.natural, &runs, solutions.error)?)
        }
    };
    let content = arguments.content.unwrap_or(CONTENT);
    let tolerance = match &at {
        Some(at) => fit.tolerance(&at.natural, solutions.error, content, CONFIDENCE)?,
        None => None,
    };
    let scatter = Scatter::read(&fit, &arguments.factor_sd, &solutions, at.as_ref())?;
    let seed = arguments.seed.unwrap_or(1);
    let draws = arguments.bootstrap;
    let bootstrap = draws.map(|draws| bootstrap(&fit, &request, draws, seed));
    let is_refuted = confirmation.as_ref().and_then(|c| c.confirmed) == Some(false);
    let is_met = solutions.exists && !is_refuted;
    let report = Report {
        header: Header::new(draws.map(|_| seed), [&arguments.analysis])?,
        factors: fit.factors.iter().map(|f| f.symbol().to_owned()).collect(),
        original: transform
            .map(|t| InUnit::new(t, target, &solutions, at.as_ref(), tolerance.as_ref())),
        solutions,
        at,
        tolerance,
        propagation: scatter.at,
        propagation_nearest: scatter.nearest,
        most_robust: scatter.most_robust,
        bootstrap: bootstrap.transpose()?.unwrap_or_default(),
        confirmation,
        warnings,
    };
    let common = &arguments.common;
    common.emit_json(&report)?;
    words::describe(common, &fit, &report)?;
    Ok(if is_met { DONE } else { NOT_MET })
}

/// What the scatter of the factors does.
#[derive(Default)]
struct Scatter {
    /// At the point asked for.
    at: Option<Propagation>,
    /// At the nearest solutions.
    nearest: NamedValues<Propagation>,
    /// Where it does least.
    most_robust: Option<Robust>,
}

impl Scatter {
    /// Reads the standard deviations (none for a factor that is not named) and propagates them.
    fn read(
        fit: &Fit,
        list: &[String],
        solutions: &Solutions,
        at: Option<&Prediction>,
    ) -> anyhow::Result<Self> {
        if list.is_empty() {
            return Ok(Self::default());
        }
        let sd = factor_sds(fit, list)?;
        let propagated = |point: &[f64]| fit.propagation(point, &sd, solutions.error);
        let mut nearest = Vec::new();
        for (metric, found) in solutions.nearest.iter() {
            nearest.push((metric.to_owned(), propagated(&found.solution)?));
        }
        Ok(Self {
            at: at.map(|at| propagated(&at.natural)).transpose()?,
            nearest: nearest.into_iter().collect(),
            most_robust: most_robust(fit, solutions.target, &sd)?,
        })
    }
}

/// Standard deviations of the factors in use; 0 for one that is not named.
fn factor_sds(fit: &Fit, list: &[String]) -> anyhow::Result<Vec<f64>> {
    let given = measured(fit, list)?;
    let value = |measured: Option<Measured>| match measured {
        None => Ok(0.0),
        Some(Measured {
            value,
            sd: None,
            n: None,
        }) => Ok(value),
        Some(_) => bail!("--factor-sd takes standard deviations alone, such as B=0.01"),
    };
    given.into_iter().map(value).collect()
}

/// Reads `B=0.32+-0.05/5` and the like into the order of the factors.
fn measured(fit: &Fit, list: &[String]) -> anyhow::Result<Vec<Option<Measured>>> {
    let mut near = vec![None; fit.factors.len()];
    for part in list {
        let form = || format!("'{part}' is not a measured value; write B=0.32 or B=0.32+-0.05/5");
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

/// The point of `--at` in the units of the factors, if one is given.
fn point_at(fit: &Fit, list: &[String]) -> anyhow::Result<Option<Vec<f64>>> {
    if list.is_empty() {
        return Ok(None);
    }
    let mut point = Vec::with_capacity(fit.factors.len());
    for (factor, value) in fit.factors.iter().zip(measured(fit, list)?) {
        let symbol = factor.symbol();
        let value = value.with_context(|| format!("--at needs a value for '{symbol}'"))?;
        ensure!(
            value.sd.is_none() && value.n.is_none(),
            "--at takes settings without a scatter; give that of '{symbol}' with --factor-sd"
        );
        point.push(value.value);
    }
    Ok(Some(point))
}
