//! Reading an analysis, at the levels and within the bounds that are asked for.

use std::path::Path;

use anyhow::{Context as _, ensure};
use command_line::significant;
use experiment_design::Factor;
use response_surface::{Categorical, Fit, Transform};
use serde::Deserialize;

use super::Arguments;
use crate::levels;

/// Share of the width of the data by which a bound may lie beyond them without a word: designs that fill their
/// ranges end that near to them.
const BEYOND: f64 = 0.1;

/// An analysis, and what to bear in mind with it.
pub(super) struct Read {
    /// The fit.
    pub(super) fit: Fit,
    /// The function of the response that was fitted.
    pub(super) transform: Option<Transform>,
    /// Warnings in words.
    pub(super) warnings: Vec<String>,
}

/// Factors with named levels of an analysis.
#[derive(Debug, Deserialize)]
struct Named {
    /// The factors; missing in analyses of older versions.
    #[serde(default)]
    categories: Vec<Categorical>,
    /// The function of the response that was fitted; missing in analyses of older versions.
    #[serde(default)]
    transform: Option<Transform>,
}

/// Reads an analysis at the levels chosen, with other bounds where given.
pub(super) fn read(path: &Path, arguments: &Arguments) -> anyhow::Result<Read> {
    let bounds = &arguments.bounds;
    let place = path.display();
    let text = input::file::read_text(path).with_context(|| format!("cannot read {place}"))?;
    let fit: Fit = serde_json::from_str(&text).with_context(|| {
        format!("{place} is not an analysis; write one with seedloop analyse --json")
    })?;
    let named: Named = serde_json::from_str(&text).with_context(|| place.to_string())?;
    let transform = named.transform;
    let fit = at_levels(fit, named.categories, &arguments.level)?;
    let mut factors = fit.factors.clone();
    for part in bounds {
        let form = || format!("'{part}' is not a bound; write B=0.30:0.36");
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
    let fit = if bounds.is_empty() {
        fit
    } else {
        fit.within(&factors)?
    };
    let data = fit.data_region.iter();
    let data = data.flat_map(|region| region.low.iter().zip(&region.high));
    let pairs = fit.factors.iter().zip(data);
    let warnings = pairs.filter_map(|(f, (low, high))| beyond(f, [*low, *high]));
    let warnings: Vec<String> = warnings.collect();
    for warning in &warnings {
        arguments
            .common
            .log(|| format!("warning: {place}: {warning}"));
    }
    Ok(Read {
        fit,
        transform,
        warnings,
    })
}

/// Warns of a range that goes far beyond the data.
fn beyond(factor: &Factor, [low, high]: [f64; 2]) -> Option<String> {
    let width = high - low;
    let reach = (low - factor.low()).max(factor.high() - high);
    (reach > BEYOND * width).then(|| {
        let of = |value: f64| significant(value, 5);
        let symbol = factor.symbol();
        format!(
            "the range of {symbol}, {} to {}, goes beyond the data, {} to {}, by {} of their width: the surface is \
             not known there; --bounds {symbol}={low}:{high} keeps to the data",
            of(factor.low()),
            of(factor.high()),
            of(low),
            of(high),
            of(reach / width)
        )
    })
}

/// The fit at the levels chosen, one for every factor with named levels.
fn at_levels(fit: Fit, categories: Vec<Categorical>, chosen: &[String]) -> anyhow::Result<Fit> {
    let mut pairs = Vec::new();
    for part in chosen {
        let (symbol, level) = part
            .split_once('=')
            .with_context(|| format!("'{part}' is not a level; write wall=steel"))?;
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
    let columns: usize = held.iter().map(|(c, _)| c.levels().len() - 1).sum();
    ensure!(
        columns < fit.factors.len(),
        "the analysis has named levels only, and nothing is left to set: the response at each level is printed by \
         seedloop analyse"
    );
    levels::held(&fit, &held)
}
