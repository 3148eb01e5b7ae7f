//! The answer in words.

use command_line::Common;
use experiment_design::Factor;
use response_surface::solutions::{Bootstrap, Region};
use response_surface::{Confirmation, Fit, NamedValues, Solutions};

use super::{CONFIDENCE, Report};

/// Prints the answer.
pub(super) fn describe(common: &Common, fit: &Fit, report: &Report) -> anyhow::Result<()> {
    let solutions = &report.solutions;
    reach(common, fit, solutions)?;
    branches(common, fit, solutions)?;
    nearest(common, fit, report)?;
    if let Some(region) = &solutions.region {
        common.print(region_text(region))?;
    } else {
        common.print("no region: there is no error variance (no replicates, no residual dof)")?;
    }
    for drawn in &report.bootstrap {
        bootstrapped(common, drawn)?;
    }
    at_point(common, fit, report)?;
    match &report.confirmation {
        Some(confirmation) => confirmed(common, confirmation),
        None => Ok(()),
    }
}

/// A point in natural units.
fn point(fit: &Fit, values: &[f64]) -> String {
    let pairs = fit.factors.iter().zip(values);
    let texts: Vec<String> = pairs
        .map(|(f, v)| format!("{} = {v:.5}", f.symbol()))
        .collect();
    texts.join(", ")
}

/// What the surface reaches, and whether that includes the target.
fn reach(common: &Common, fit: &Fit, solutions: &Solutions) -> anyhow::Result<()> {
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
            point(fit, &closest.natural)
        ))?;
    }
    for (symbol, range) in solutions.factor_ranges.iter().flat_map(NamedValues::iter) {
        let pieces: Vec<String> = range
            .pieces
            .iter()
            .map(|piece| format!("{:.5} to {:.5}", piece.low, piece.high))
            .collect();
        common.print(format!(
            "{symbol} on the solution set: {}",
            pieces.join(" and ")
        ))?;
    }
    Ok(())
}

/// The parts of the set, where there are several.
fn branches(common: &Common, fit: &Fit, solutions: &Solutions) -> anyhow::Result<()> {
    let parts = solutions.branches.as_deref().unwrap_or_default();
    if parts.len() < 2 {
        return Ok(());
    }
    common.print(format!(
        "{} branches: the solutions form separate parts",
        parts.len()
    ))?;
    for (i, part) in parts.iter().enumerate() {
        let range = |(f, [low, high]): (&Factor, &[f64; 2])| {
            format!("{} {low:.5} to {high:.5}", f.symbol())
        };
        let ranges: Vec<String> = fit.factors.iter().zip(&part.ranges).map(range).collect();
        common.print(format!(
            "  branch {}: {}; for example {}",
            i + 1,
            ranges.join(", "),
            point(fit, &part.example)
        ))?;
    }
    Ok(())
}

/// The nearest solutions and the most robust one.
fn nearest(common: &Common, fit: &Fit, report: &Report) -> anyhow::Result<()> {
    for (metric, nearest) in report.solutions.nearest.iter() {
        common.print(format!(
            "nearest by {metric}: {}; distance {:.4}",
            point(fit, &nearest.solution),
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
        if let Some(scatter) = report.propagation_nearest.get(metric) {
            common.print(format!(
                "  the scatter of the factors hands on an sd of {:.4}",
                scatter.transmitted_sd
            ))?;
        }
    }
    if let Some(robust) = &report.most_robust {
        common.print(format!(
            "solution of least transmitted scatter: {}; it hands on an sd of {:.4}",
            point(fit, &robust.solution),
            robust.transmitted_sd
        ))?;
    }
    Ok(())
}

/// How much of the box cannot be told from a solution, and where that is open.
fn region_text(region: &Region) -> String {
    let percent = 100.0 * region.box_fraction;
    let mut text = format!("{percent:.1} % of the box cannot be told from a solution");
    if region.box_fraction > 0.999 {
        return text + ": the data exclude nothing";
    }
    let side = |(symbol, [low, high]): (&str, &[bool; 2])| {
        let where_open = match (low, high) {
            (true, true) => "at both bounds",
            (true, false) => "at the low bound",
            (false, true) => "at the high bound",
            (false, false) => return None,
        };
        Some(format!("{symbol} {where_open}"))
    };
    let sides: Vec<String> = region.open.iter().filter_map(side).collect();
    text.push_str(if sides.is_empty() {
        "; the region is closed within the box"
    } else {
        "; the region is open: "
    });
    text + &sides.join(", ")
}

/// The scatter of the nearest solution.
fn bootstrapped(common: &Common, drawn: &Bootstrap) -> anyhow::Result<()> {
    common.print(format!(
        "{} redrawn experiments, nearest by {}; {:.1} % without a solution",
        drawn.draws,
        drawn.metric,
        100.0 * drawn.no_solution
    ))?;
    for (symbol, factor) in drawn.factors.iter() {
        let [low, high] = factor.quantiles95;
        let ends = [(factor.at_low, "low"), (factor.at_high, "high")];
        let held = ends.into_iter().filter(|(share, _)| *share > 0.0);
        let bounds: Vec<String> = held
            .map(|(share, name)| format!(", {:.1} % on the {name} bound", 100.0 * share))
            .collect();
        let bounds = bounds.concat();
        common.print(format!(
            "  {symbol}: median {:.5}, 95 % {low:.5} to {high:.5}{bounds}",
            factor.median
        ))?;
    }
    Ok(())
}

/// What is known about the point asked for.
fn at_point(common: &Common, fit: &Fit, report: &Report) -> anyhow::Result<()> {
    let Some(at) = &report.at else {
        return Ok(());
    };
    common.print(format!("at {}: {:.4}", point(fit, &at.natural), at.mean))?;
    if at.extrapolated {
        common.print("  beyond the ranges of the factors: the model was not made there")?;
    }
    if let Some([low, high]) = at.ci95 {
        common.print(format!(
            "  95 % confidence of the mean: {low:.4} to {high:.4}"
        ))?;
    }
    if let Some([low, high]) = at.pi95 {
        let runs = fit.runs_of_unit_weight();
        let of = if runs > 1.0 {
            format!("mean of {runs:.3} runs")
        } else {
            "run".to_owned()
        };
        common.print(format!(
            "  95 % prediction of a {of}: {low:.4} to {high:.4}"
        ))?;
    }
    if let Some(tolerance) = &report.tolerance {
        let [low, high] = tolerance.interval;
        common.print(format!(
            "  tolerance, {} % of all runs with {} % confidence: {low:.4} to {high:.4}",
            100.0 * tolerance.content,
            100.0 * CONFIDENCE
        ))?;
    }
    if let Some(scatter) = &report.propagation {
        let total = scatter
            .total_sd
            .map_or_else(String::new, |sd| format!(", with that of runs {sd:.4}"));
        common.print(format!(
            "  the scatter of the factors hands on an sd of {:.4}{total}, and shifts the mean by {:.4}",
            scatter.transmitted_sd, scatter.shift
        ))?;
    }
    Ok(())
}

/// Prints the verdict on the confirmation runs.
fn confirmed(common: &Common, confirmation: &Confirmation) -> anyhow::Result<()> {
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
