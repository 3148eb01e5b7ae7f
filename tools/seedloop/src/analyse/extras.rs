//! What an analysis tells beside the fit: ridge paths, the rival surface, regimes.

use anyhow::ensure;
use command_line::{Common, significant};
use experiment_design::Factor;
use response_surface::{
    Contrasts, Fit, GaussianProcess, GroupSum, Model, NamedValues, Observations, RandomBlocks,
    Regime, RidgePoint, Weighting, gaussian_process, random_blocks, regime, ridge_path,
};
use serde::Serialize;

use super::data::Data;
use super::text::{counted, fixed, probability};
use super::{Arguments, Report};

/// Radii of the ridge paths, coded.
const RADII: [f64; 9] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0];
/// Seed of the points at which a regime's share of the box is counted.
const SEED: u64 = 1;

/// The paths of steepest ascent and descent.
#[derive(Debug, Serialize)]
pub(super) struct Ridge {
    /// Highest points.
    pub(super) ascent: Vec<RidgePoint>,
    /// Lowest points.
    pub(super) descent: Vec<RidgePoint>,
}

impl Ridge {
    /// The paths of a fit; none for models above degree two.
    pub(super) fn of(fit: &Fit) -> Option<Self> {
        Some(Self {
            ascent: ridge_path(fit, &RADII, true).ok()?,
            descent: ridge_path(fit, &RADII, false).ok()?,
        })
    }
}

/// A Gaussian process beside the polynomial.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    /// The process.
    process: GaussianProcess,
    /// Root of the mean squared error of rows left out, process, unit of the response.
    process_leave_one_out_rmse: f64,
    /// The same of the polynomial; null where a row is fitted exactly.
    polynomial_leave_one_out_rmse: Option<f64>,
    /// Which of the two predicts left-out rows better. The analysis stays that of the polynomial.
    better: &'static str,
}

/// Fits the model with random batches where a column of them is named.
pub(super) fn batches(
    data: &Data,
    model: &Model,
    weighting: Weighting,
) -> anyhow::Result<Option<RandomBlocks>> {
    if data.batches.is_empty() {
        return Ok(None);
    }
    let mut names = data.batches.clone();
    names.sort();
    names.dedup();
    let mut cells = data.cells.clone();
    for (cell, name) in cells.iter_mut().zip(&data.batches) {
        cell.block = 1 + names.binary_search(name).unwrap_or(0);
    }
    let observations = Observations::from_cells(cells)?;
    let fit = random_blocks(&data.factors, model, &observations, weighting)?;
    Ok(Some(fit))
}

/// Prints the fit with random batches.
fn print_batches(common: &Common, fit: &RandomBlocks) -> anyhow::Result<()> {
    common.print(format!(
        "\n{} batches drawn at random: sd of batches {}, of observations {}",
        fit.blocks,
        significant(fit.block_sd, 5),
        significant(fit.residual_sd, 5)
    ))?;
    common.print(format!(
        "{:<10} {:>12} {:>10} {:>8} {:>9}",
        "term", "coef", "se", "dof", "p"
    ))?;
    for (name, row) in fit.terms.iter() {
        common.print(format!(
            "{name:<10} {:>12} {:>10} {:>8} {:>9}",
            significant(row.coef, 6),
            significant(row.se, 4),
            fixed(row.df, 2),
            probability(row.p)
        ))?;
    }
    Ok(())
}

/// Fits the process if asked for.
pub(super) fn comparison(
    arguments: &Arguments,
    factors: &[Factor],
    data: &Observations,
    fit: &Fit,
) -> anyhow::Result<Option<Comparison>> {
    if !arguments.gaussian_process {
        return Ok(None);
    }
    let process = gaussian_process(factors, data)?;
    // Unweighted, as that of the process.
    let deleted = |case: &response_surface::fit::Case| {
        let free = Some(1.0 - case.leverage).filter(|free| *free > 1e-10)?;
        Some((case.residual / free).powi(2))
    };
    let squares: Option<f64> = fit.cases.iter().map(deleted).sum();
    let polynomial = squares.map(|sum| (sum / fit.n as f64).sqrt());
    let better = match polynomial {
        Some(polynomial) if polynomial <= process.leave_one_out_rmse => "polynomial",
        _ => "gaussian-process",
    };
    Ok(Some(Comparison {
        process_leave_one_out_rmse: process.leave_one_out_rmse,
        polynomial_leave_one_out_rmse: polynomial,
        better,
        process,
    }))
}

/// Keeps the rows of the regime asked for, and fits its boundary to the others.
pub(super) fn split_regimes(
    arguments: &Arguments,
    data: &mut Data,
) -> anyhow::Result<Option<Regime>> {
    let Some((column, name)) = &arguments.regime else {
        return Ok(None);
    };
    let mut labels = data.regimes.clone();
    labels.sort();
    labels.dedup();
    ensure!(
        labels.contains(name),
        "there is no regime '{name}' in column '{column}'; it holds {}",
        labels.join(", ")
    );
    let kept: Vec<bool> = data.regimes.iter().map(|label| label == name).collect();
    let boundary = if labels.len() > 1 {
        let coded: Vec<Vec<f64>> = data.cells.iter().map(|cell| cell.coded.clone()).collect();
        Some(regime(&data.factors, &coded, &data.regimes, name, SEED)?)
    } else {
        None
    };
    let mut places = kept.iter();
    data.cells
        .retain(|_| places.next().copied().unwrap_or(true));
    let mut places = kept.iter();
    data.batches
        .retain(|_| places.next().copied().unwrap_or(true));
    Ok(boundary)
}

/// Prints the contrasts of a saturated model, largest first, against Lenth's margins.
fn print_contrasts(common: &Common, found: &Contrasts) -> anyhow::Result<()> {
    let lenth = &found.lenth;
    let order = if found.orthogonal {
        ""
    } else {
        " (each after the terms before it)"
    };
    common.print(format!(
        "\nsaturated model, contrasts{order}; Lenth: PSE {}, ME {}, SME {}",
        significant(lenth.pse, 4),
        counted(lenth.me, 4),
        counted(lenth.sme, 4)
    ))?;
    for point in found.half_normal.iter().rev() {
        let above = |margin: Option<f64>| margin.is_some_and(|margin| point.abs_effect > margin);
        let verdict = match (above(lenth.sme), above(lenth.me)) {
            (true, _) => "  above SME",
            (_, true) => "  above ME",
            _ => "",
        };
        let value = found.contrasts.get(&point.factor).copied().unwrap_or(0.0);
        let value = significant(value, 5);
        common.print(format!("{:<10} {value:>12}{verdict}", point.factor))?;
    }
    Ok(())
}

/// Least size of an alias coefficient that is printed; all are in the JSON.
const SMALLEST_ALIAS: f64 = 0.05;
/// Most terms left out that are printed behind one term, the largest first.
const MOST_ALIASES: usize = 8;

/// Prints what terms left out add to each term of the fit.
fn print_aliases(common: &Common, report: &Report<'_>) -> anyhow::Result<()> {
    let Some(aliases) = report.aliases.as_ref().filter(|all| !all.is_empty()) else {
        return Ok(());
    };
    let mut lines = Vec::new();
    for term in report.fit.terms.names() {
        let behind = aliases
            .iter()
            .filter_map(|(left_out, parts)| Some((left_out, *parts.get(term)?)));
        let mut behind: Vec<(&str, f64)> = behind
            .filter(|(_, amount)| amount.abs() >= SMALLEST_ALIAS)
            .collect();
        if behind.is_empty() {
            continue;
        }
        behind.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let mut line = term.to_owned();
        for (left_out, amount) in behind.iter().take(MOST_ALIASES) {
            let sign = if *amount < 0.0 { '-' } else { '+' };
            let size = amount.abs();
            let times = if (size - 1.0).abs() < 1e-9 {
                String::new()
            } else {
                format!("{size:.3} ")
            };
            line += &format!(" {sign} {times}{left_out}");
        }
        let more = behind.len().saturating_sub(MOST_ALIASES);
        if more > 0 {
            line += &format!(" and {more} more");
        }
        lines.push(line);
    }
    if lines.is_empty() {
        return Ok(());
    }
    common.print("\naliases: the expected coefficient of a term is the sum of its own and of these left out, coded")?;
    for line in lines {
        common.print(format!("  {line}"))?;
    }
    common.print("")
}

/// Prints what was asked for beside the fit.
pub(super) fn print(common: &Common, report: &Report<'_>) -> anyhow::Result<()> {
    if !report.reduction.is_empty() {
        let dropped: Vec<&str> = report
            .reduction
            .iter()
            .map(|s| s.dropped.as_str())
            .collect();
        common.print(format!("dropped in this order: {}", dropped.join(", ")))?;
    }
    for (name, row) in report.level_tests.iter().flat_map(NamedValues::iter) {
        let text = |sum: &GroupSum| {
            let p = probability(sum.test.as_ref().and_then(|t| t.p));
            format!("SS {} p {p}", significant(sum.ss, 5))
        };
        common.print(format!(
            "{name:<12} dof {:>2}  Type I {}, II {}, III {}",
            row.df,
            text(&row.type_i),
            text(&row.type_ii),
            text(&row.type_iii)
        ))?;
    }
    for level in &report.level_means {
        let interval = level.ci95.map_or_else(String::new, |[low, high]| {
            let [low, high] = [low, high].map(|end| significant(end, 6));
            format!(" (95 % {low} to {high})")
        });
        let (names, mean) = (level.levels.join(", "), significant(level.mean, 6));
        let original = level.original;
        let original =
            original.map_or_else(String::new, |original| format!("; {}", original.words()));
        common.print(format!("at {names}: {mean}{interval}{original}"))?;
    }
    if let Some(found) = &report.contrasts {
        print_contrasts(common, found)?;
    }
    print_aliases(common, report)?;
    if let Some(fit) = &report.random_batches {
        print_batches(common, fit)?;
    }
    for step in report.interaction_search.iter().flatten() {
        let rivals = if step.rivals.is_empty() {
            "no other does as well".to_owned()
        } else {
            format!("cannot be told from {}", step.rivals.join(", "))
        };
        common.print(format!(
            "a hidden interaction may be {} ({}, AICc {:.2} to {:.2}): {rivals}",
            step.added,
            significant(step.coef, 5),
            step.aicc[0],
            step.aicc[1]
        ))?;
    }
    if let Some(b) = &report.box_cox {
        let [low, high] = b.interval95;
        let verdict = if b.keeps_the_response {
            "1 is in it"
        } else {
            "1 is not in it"
        };
        common.print(format!(
            "Box-Cox power {:.2}, 95 % {low:.2} to {high:.2}: {verdict}",
            b.best
        ))?;
    }
    if let Some(spread) = &report.spread {
        let bartlett = spread.bartlett.as_ref().and_then(|b| b.p);
        let levene = spread.levene.as_ref().and_then(|l| l.p);
        let levene = match (spread.levene_groups, spread.groups) {
            (0 | 1, _) => {
                "Levene's test cannot be made: it needs two settings with three runs or more"
                    .to_owned()
            }
            (tested, all) if tested < all => {
                format!(
                    "Levene p {} ({tested} settings, pairs left out)",
                    probability(levene)
                )
            }
            _ => format!("Levene p {}", probability(levene)),
        };
        common.print(format!(
            "equal scatter: Bartlett p {}, {levene}",
            probability(bartlett)
        ))?;
    }
    if let Some(comparison) = &report.gaussian_process {
        let polynomial = comparison.polynomial_leave_one_out_rmse;
        common.print(format!(
            "rows left out are predicted to {} by a Gaussian process and to {} by the \
             polynomial; the {} is better",
            significant(comparison.process_leave_one_out_rmse, 4),
            counted(polynomial, 4),
            comparison.better
        ))?;
    }
    if let Some(regime) = &report.regime {
        common.print(format!(
            "regime '{}': {} rows, {} others left out; {:.0} % of the box; boundary right for \
             {:.0} % of rows left out",
            regime.name,
            regime.inside,
            regime.outside,
            100.0 * regime.box_fraction,
            100.0 * regime.leave_one_out_accuracy
        ))?;
    }
    Ok(())
}
