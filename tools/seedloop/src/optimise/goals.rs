//! `seedloop optimise --goal`: one setting for one or several responses.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use command_line::{DONE, Header, NOT_MET};
use experiment_design::Factor;
use response_surface::{Aim, Categorical, Compromise, Fit, Goal, ScatterGoal, compromises};
use serde::{Deserialize, Serialize};

use super::Arguments;
use crate::levels;

/// The answer as it stands in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Symbols of the factors, in the order of all points.
    factors: Vec<String>,
    /// Goals of the responses, in the order of the files.
    goals: Vec<Goal>,
    /// Goals of the scatter that the factors hand on.
    scatter_goals: Vec<ScatterGoal>,
    /// Whether any point of the box is worth something.
    exists: bool,
    /// The settings, best first.
    compromises: Vec<Compromise>,
}

/// What an analysis tells about factors with named levels.
#[derive(Debug, Deserialize)]
struct Named {
    /// The factors; missing in analyses of older versions.
    #[serde(default)]
    categories: Vec<Categorical>,
}

/// Reads an analysis at the levels chosen, with other bounds where given.
pub(super) fn read(path: &Path, arguments: &Arguments) -> anyhow::Result<Fit> {
    let bounds = &arguments.bounds;
    let place = path.display();
    let text = input_file::read_text(path).with_context(|| format!("cannot read {place}"))?;
    let fit: Fit = serde_json::from_str(&text).with_context(|| {
        format!("{place} is no analysis; write one with seedloop analyse --json")
    })?;
    let named: Named = serde_json::from_str(&text).with_context(|| place.to_string())?;
    let fit = at_levels(fit, named.categories, &arguments.level)?;
    if bounds.is_empty() {
        return Ok(fit);
    }
    let mut factors = fit.factors.clone();
    for part in bounds {
        let form = || format!("'{part}' is no bound; write B=0.30:0.36");
        let (symbol, range) = part.split_once('=').with_context(form)?;
        let (low, high) = range.split_once(':').with_context(form)?;
        let number = |text: &str| text.trim().parse::<f64>().ok().with_context(form);
        let symbol = symbol.trim();
        let factor = factors
            .iter_mut()
            .find(|f| f.symbol() == symbol)
            .with_context(|| format!("there is no factor '{symbol}' in {place}"))?;
        *factor = Factor::new(
            symbol,
            factor.name(),
            factor.unit(),
            number(low)?,
            number(high)?,
        )?;
    }
    Ok(fit.within(&factors)?)
}

/// The fit at the levels chosen, one for every factor with named levels.
fn at_levels(fit: Fit, categories: Vec<Categorical>, chosen: &[String]) -> anyhow::Result<Fit> {
    let mut pairs = Vec::new();
    for part in chosen {
        let (symbol, level) = part
            .split_once('=')
            .with_context(|| format!("'{part}' is no level; write wall=steel"))?;
        ensure!(
            categories.iter().any(|c| c.symbol() == symbol),
            "the analysis has no factor '{symbol}' with named levels"
        );
        pairs.push((symbol, level));
    }
    if categories.is_empty() {
        return Ok(fit);
    }
    let mut held = Vec::new();
    for category in categories {
        let symbol = category.symbol();
        let levels = category.levels().join(", ");
        let level = pairs.iter().find(|(s, _)| *s == symbol);
        let (_, level) = level.with_context(|| {
            format!("choose the level of '{symbol}' with --level {symbol}=...; it has {levels}")
        })?;
        held.push((category.clone(), (*level).to_owned()));
    }
    levels::held(&fit, &held)
}

/// Answers for one or several responses.
///
/// # Errors
/// Goals and files that cannot be read, responses over different factors.
pub(super) fn run(arguments: &Arguments, first: Fit) -> anyhow::Result<u8> {
    let text = arguments.goal.as_deref().unwrap_or_default();
    let mut files = vec![arguments.analysis.clone()];
    let mut goals = vec![goal(text, &first)?];
    let mut fits = vec![first];
    let mut scatter = Vec::new();
    for part in &arguments.also {
        let (file, text) = part
            .split_once('=')
            .with_context(|| format!("'{part}' is no further response; write OTHER.json=max"))?;
        if file == "transmitted" {
            scatter.push(scatter_goal(arguments, text, &fits[0])?);
            continue;
        }
        let fit = read(Path::new(file), arguments)?;
        goals.push(goal(text, &fit)?);
        fits.push(fit);
        files.push(PathBuf::from(file));
    }
    ensure!(
        arguments.factor_sd.is_empty() || !scatter.is_empty(),
        "--factor-sd beside --goal needs --also transmitted=min:0:LIMIT"
    );
    let found = compromises(&fits, &goals, &scatter)?;
    let symbols: Vec<String> = fits[0]
        .factors
        .iter()
        .map(|f| f.symbol().to_owned())
        .collect();
    let common = &arguments.common;
    if found.is_empty() {
        common.print(
            "no setting within the bounds is worth anything for all responses; widen the goals",
        )?;
    }
    for compromise in &found {
        let point: Vec<String> = symbols
            .iter()
            .zip(&compromise.natural)
            .map(|(s, v)| format!("{s} = {v:.5}"))
            .collect();
        let values: Vec<String> = compromise
            .predictions
            .iter()
            .map(|p| {
                let interval = p
                    .ci95
                    .map_or_else(String::new, |[a, b]| format!(" ({a:.4} to {b:.4})"));
                format!("{:.4}{interval}", p.mean)
            })
            .collect();
        let handed: Vec<String> = compromise
            .transmitted_sd
            .iter()
            .map(|sd| format!("; transmitted sd {sd:.4}"))
            .collect();
        common.print(format!(
            "desirability {:.4} at {}: {}{}",
            compromise.desirability,
            point.join(", "),
            values.join("; "),
            handed.concat()
        ))?;
    }
    let exists = !found.is_empty();
    common.emit_json(&Report {
        header: Header::new(None, &files)?,
        factors: symbols,
        goals,
        scatter_goals: scatter,
        exists,
        compromises: found,
    })?;
    Ok(if exists { DONE } else { NOT_MET })
}

/// Reads the goal of the scatter that the factors hand on to the first response.
fn scatter_goal(arguments: &Arguments, text: &str, first: &Fit) -> anyhow::Result<ScatterGoal> {
    ensure!(
        !arguments.factor_sd.is_empty(),
        "--also transmitted=... needs --factor-sd, the standard deviations of the factors"
    );
    ensure!(
        text.contains(':'),
        "'transmitted={text}' needs its numbers: transmitted=min:LOW:HIGH"
    );
    let given = super::measured(first, &arguments.factor_sd)?;
    Ok(ScatterGoal {
        response: 0,
        factor_sd: given.iter().map(|m| m.map_or(0.0, |m| m.value)).collect(),
        goal: goal(text, first)?,
    })
}

/// Reads a goal such as `target:30:37.5:45^2*3`. Without bounds, max and min take the least and the
/// greatest value that the surface reaches.
fn goal(text: &str, fit: &Fit) -> anyhow::Result<Goal> {
    let form = || {
        format!(
            "'{text}' is no goal; write max, max:LOW:HIGH, min, min:LOW:HIGH, range:LOW:HIGH or \
             target:LOW:VALUE:HIGH, with ^WEIGHT and *IMPORTANCE behind it where wanted"
        )
    };
    let number = |text: &str| text.trim().parse::<f64>().ok().with_context(form);
    let (rest, importance) = match text.split_once('*') {
        Some((rest, importance)) => (rest, number(importance)?),
        None => (text, 1.0),
    };
    let (rest, weight) = match rest.split_once('^') {
        Some((rest, weight)) => (rest, number(weight)?),
        None => (rest, 1.0),
    };
    let mut words = rest.split(':');
    let kind = words.next().unwrap_or_default().trim();
    let numbers = words.map(number).collect::<anyhow::Result<Vec<f64>>>()?;
    let aim = match (kind, &numbers[..]) {
        ("max" | "maximise", &[low, high]) => Aim::Maximise { low, high },
        ("min" | "minimise", &[low, high]) => Aim::Minimise { low, high },
        ("max" | "maximise", []) => {
            let (low, high) = reach(fit)?;
            Aim::Maximise { low, high }
        }
        ("min" | "minimise", []) => {
            let (low, high) = reach(fit)?;
            Aim::Minimise { low, high }
        }
        ("range", &[low, high]) => Aim::Range { low, high },
        ("target", &[low, value, high]) => Aim::Target { low, value, high },
        _ => anyhow::bail!(form()),
    };
    Ok(Goal {
        aim,
        weight,
        importance,
    })
}

/// Least and greatest value of the surface within the bounds.
fn reach(fit: &Fit) -> anyhow::Result<(f64, f64)> {
    let extremes = fit
        .extremes()
        .context("max and min without numbers need a model of degree two at most")?;
    let (low, high) = (extremes.min.value, extremes.max.value);
    ensure!(
        low < high,
        "the surface is flat; nothing can be raised or lowered"
    );
    Ok((low, high))
}
