//! The answer in words.

use std::fmt::Write as _;

use command_line::{Common, significant};
use experiment_design::Factor;
use probability::t_two_sided_quantile;
use response_surface::solutions::{Bootstrap, Region};
use response_surface::{
    Confirmation, ErrorSource, ErrorVariance, Fit, NamedValues, OpenBound, Solutions,
};

use super::{CONFIDENCE, Report};

/// Warning about a prediction outside the range of the data.
pub(super) const BEYOND_DATA: &str = "  beyond what the runs span: the model was not made there";

/// Prints the bounds that a setting lies on although the runs extend beyond them.
pub(super) fn go_on(common: &Common, fit: &Fit, open: &[OpenBound]) -> anyhow::Result<()> {
    for OpenBound {
        symbol,
        bound,
        data,
    } in open
    {
        let factor = fit.factors.iter().find(|f| f.symbol() == symbol);
        let ends = factor.map_or([*bound; 2], |f| [f.low().min(*data), f.high().max(*data)]);
        let [low, high] = ends;
        common.print(format!(
            "  {symbol} is on its bound {}, and the runs extend to {}: to include them, give --bounds {symbol}={low}:{high}",
            value(*bound),
            value(*data)
        ))?;
    }
    Ok(())
}

/// Prints the answer.
pub(super) fn describe(common: &Common, fit: &Fit, report: &Report) -> anyhow::Result<()> {
    let solutions = &report.solutions;
    if let Some(original) = &report.original {
        let [low, high] = original.reachable.map(end);
        common.print(format!(
            "in the unit of the response: target {}, surface within the ranges {low} to {high}; all below is the fitted \
             function of it ({})",
            value(original.target),
            original.transform
        ))?;
    }
    reach(common, fit, solutions)?;
    branches(common, fit, solutions)?;
    nearest(common, fit, report)?;
    if let Some(region) = &solutions.region {
        common.print(error(fit, solutions.error))?;
        common.print(region_text(region))?;
    } else {
        common.print("no region: there is no error variance (no replicates, no residual dof)")?;
    }
    for drawn in &report.bootstrap {
        bootstrapped(common, drawn)?;
    }
    at_point(common, fit, report)?;
    if let Some(at) = report.original.as_ref().and_then(|o| o.at.as_ref()) {
        let [low, high] = at.pi95.map(end);
        let [least, most] = at.tolerance.map(end);
        common.print(format!(
            "  in the unit of the response: {}, prediction {low} to {high}, tolerance {least} to {most}",
            at.median.words()
        ))?;
    }
    match &report.confirmation {
        Some(confirmation) => confirmed(common, confirmation),
        None => Ok(()),
    }
}

/// Degrees of freedom below which an error is called poor: Student's limit is then 3.18 or more, against 1.96.
const FEW: usize = 4;

/// Which error variance the intervals are made with, and whether another is better known.
pub(super) fn error(fit: &Fit, error: Option<ErrorVariance>) -> String {
    let Some(error) = error else {
        return "no error variance: there are no intervals".to_owned();
    };
    let name = |source: ErrorSource| match source {
        ErrorSource::Residual => "the residuals of the fit",
        ErrorSource::RepeatedRows => "repeated settings",
        ErrorSource::Replicates => "replicates within rows",
        ErrorSource::AllRepeats => "all repeats",
    };
    let of_freedom = |df: usize| match df {
        1 => "1 degree of freedom".to_owned(),
        df => format!("{df} degrees of freedom"),
    };
    let sd = significant(error.variance.sqrt(), 4);
    let mut text = format!(
        "error: {}, sd {sd} with {}",
        name(error.source),
        of_freedom(error.df)
    );
    if error.df >= FEW {
        return text;
    }
    let limit = t_two_sided_quantile(0.05, error.df as f64);
    let limit = limit.map_or_else(|| "-".to_owned(), |t| significant(t, 4));
    let _ = write!(
        text,
        "; with so few every interval is wide (Student's t {limit})"
    );
    let residual = fit.error_variance(ErrorSource::Residual);
    if let Some(residual) = residual.filter(|residual| residual.df > error.df) {
        let sd = significant(residual.variance.sqrt(), 4);
        let _ = write!(
            text,
            ": the residuals have {}, sd {sd}; where the model fits, take them with --error residual",
            of_freedom(residual.df)
        );
    }
    text
}

/// A point in natural units.
pub(super) fn point(fit: &Fit, values: &[f64]) -> String {
    let pairs = fit.factors.iter().zip(values);
    let texts: Vec<String> = pairs
        .map(|(f, v)| format!("{} = {}", f.symbol(), significant(*v, 6)))
        .collect();
    texts.join(", ")
}

/// A value of the response or of a factor.
fn value(value: f64) -> String {
    significant(value, 6)
}

/// An end of an interval in the unit of the response, which may be open.
fn end(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| significant(v, 6))
}

/// What the surface reaches, and whether that includes the target.
fn reach(common: &Common, fit: &Fit, solutions: &Solutions) -> anyhow::Result<()> {
    let (min, max) = (&solutions.reachable.min, &solutions.reachable.max);
    common.print(format!(
        "surface within the ranges: {} to {}",
        value(min.value),
        value(max.value)
    ))?;
    if !solutions.exists {
        let closest = if solutions.target < min.value {
            min
        } else {
            max
        };
        common.print(format!(
            "no solution: the closest value to {} is {} at {}; widen the ranges there",
            solutions.target,
            value(closest.value),
            point(fit, &closest.natural)
        ))?;
        go_on(common, fit, &fit.open_bounds(&closest.coded))?;
    }
    if solutions.tangent {
        common.print(
            "the target is an end of what the surface reaches: it touches it and does not cross it",
        )?;
    }
    for (symbol, range) in solutions.factor_ranges.iter().flat_map(NamedValues::iter) {
        let pieces: Vec<String> = range
            .pieces
            .iter()
            .map(|piece| format!("{} to {}", value(piece.low), value(piece.high)))
            .collect();
        common.print(format!(
            "{symbol} on the solution set: {}",
            pieces.join(" and ")
        ))?;
    }
    Ok(())
}

/// The parts of the set, if there are several.
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
            format!("{} {} to {}", f.symbol(), value(*low), value(*high))
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
            "nearest by {metric}: {}; distance {}",
            point(fit, &nearest.solution),
            significant(nearest.distance, 4)
        ))?;
        if fit.is_beyond_data(&nearest.solution) {
            common.print(BEYOND_DATA)?;
        }
        go_on(common, fit, &fit.open_bounds(&fit.coded(&nearest.solution)))?;
        for (symbol, given) in nearest.given_others.iter().flat_map(NamedValues::iter) {
            let (low, high) = (value(given.natural.low), value(given.natural.high));
            let below = if given.open_below { " (bound)" } else { "" };
            let above = if given.open_above { " (bound)" } else { "" };
            common.print(format!(
                "  {symbol} given the others, 95 %: {low}{below} to {high}{above}"
            ))?;
        }
        if let Some(scatter) = report.propagation_nearest.get(metric) {
            common.print(format!(
                "  the scatter of the factors hands on an sd of {}",
                significant(scatter.transmitted_sd, 4)
            ))?;
        }
    }
    if let Some(robust) = &report.most_robust {
        common.print(format!(
            "solution of least transmitted scatter: {}; it hands on an sd of {}",
            point(fit, &robust.solution),
            significant(robust.transmitted_sd, 4)
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
        let [low, high] = factor.quantiles95.map(value);
        let ends = [(factor.at_low, "low"), (factor.at_high, "high")];
        let held = ends.into_iter().filter(|(share, _)| *share > 0.0);
        let bounds: Vec<String> = held
            .map(|(share, name)| format!(", {:.1} % on the {name} bound", 100.0 * share))
            .collect();
        let bounds = bounds.concat();
        common.print(format!(
            "  {symbol}: median {}, 95 % {low} to {high}{bounds}",
            value(factor.median)
        ))?;
    }
    Ok(())
}

/// What is known about the point asked for.
fn at_point(common: &Common, fit: &Fit, report: &Report) -> anyhow::Result<()> {
    let Some(at) = &report.at else {
        return Ok(());
    };
    common.print(format!(
        "at {}: {}",
        point(fit, &at.natural),
        value(at.mean)
    ))?;
    if at.extrapolated {
        common.print(BEYOND_DATA)?;
    }
    if let Some([low, high]) = at.ci95.map(|ends| ends.map(value)) {
        common.print(format!("  95 % confidence of the mean: {low} to {high}"))?;
    }
    if let Some([low, high]) = at.pi95.map(|ends| ends.map(value)) {
        let runs = fit.runs_of_unit_weight();
        let of = if runs > 1.0 {
            format!("mean of {runs:.3} runs")
        } else {
            "run".to_owned()
        };
        common.print(format!("  95 % prediction of a {of}: {low} to {high}"))?;
    }
    if let Some(tolerance) = &report.tolerance {
        let [low, high] = tolerance.interval.map(value);
        common.print(format!(
            "  tolerance, {} % of all runs with {} % confidence: {low} to {high}",
            100.0 * tolerance.content,
            100.0 * CONFIDENCE
        ))?;
    }
    if let Some(scatter) = &report.propagation {
        let total = scatter.total_sd.map_or_else(String::new, |sd| {
            format!(", with that of runs {}", significant(sd, 4))
        });
        common.print(format!(
            "  the scatter of the factors hands on an sd of {}{total}, and shifts the mean by {}",
            significant(scatter.transmitted_sd, 4),
            significant(scatter.shift, 4)
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
            let (low, high) = (value(low), value(high));
            format!(" (95 % prediction interval of the mean {low} to {high})")
        });
    common.print(format!(
        "{n} confirmation runs, mean {}{interval}: {verdict}",
        value(*mean)
    ))
}
