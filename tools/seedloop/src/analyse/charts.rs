//! The charts of an analysis.

mod pairs;
mod solids;

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use command_line::{Common, write_new};

use probability::{chi_squared_quantile, normal_quantile, t_two_sided_quantile};
use report::{Axis, AxisTitle, Mark, Plot, PlotPoint, Svg, half_normal, pareto, scatter, series};
use response_surface::fit::{Case, TermRow};
use response_surface::{BoxCox, Categorical, Fit, Lenth, RidgePoint};

use super::Report;
use super::beside::power;
use super::extras::Ridge;
use crate::levels;
use pairs::along;

/// Points along a line.
const LINE: usize = 9;
/// Greatest number of factors for which pairs are drawn.
const MOST_FACTORS: usize = 6;

/// Name of a chart and the chart.
pub(super) type Named = (String, Svg);

/// All charts that the analysis has the numbers for.
pub(super) fn all(report: &Report<'_>) -> anyhow::Result<Vec<Named>> {
    let fit = report.fit;
    let mut charts = Vec::new();
    effects(report, &mut charts)?;
    diagnostics(report, &mut charts)?;
    if let Some(profile) = &report.box_cox {
        charts.push(("box-cox".to_owned(), powers(profile, fit.n).draw()?));
    }
    if report.categories.is_empty() {
        surfaces(fit, report.response, "", &mut charts)?;
    } else if fit.factors.len() > of_levels(&report.categories) {
        for (name, fit) in at_levels(fit, &report.categories)? {
            surfaces(&fit, report.response, &format!("-{name}"), &mut charts)?;
        }
    }
    Ok(charts)
}

/// The profile of the power of the response with the limit of its 95 % interval, the interval there, and the response
/// itself: powers below the limit are not told from the best one `[BoxCox1964]`.
fn powers(profile: &BoxCox, n: usize) -> Plot {
    let points = profile.lambda.iter().zip(&profile.ln_sse);
    let points: Vec<PlotPoint> = points.map(|(x, y)| PlotPoint::new(*x, *y)).collect();
    let least = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let limit = chi_squared_quantile(0.05, 1.0).map(|rise| least + rise / n as f64);
    let [low, high] = profile.interval95.map(|end| power(profile, end));
    let ends = |limit: f64| profile.interval95.map(|x| PlotPoint::new(x, limit)).into();
    let interval = format!("95 % interval, {low} to {high}");
    let itself = points.iter().find(|p| p.x == 1.0).cloned();
    let best = format!("Box-Cox profile, best {}", power(profile, profile.best));
    Plot::new(
        Axis::numbers("power of the response", ""),
        Axis::numbers("ln of the residual sum of squares", ""),
    )
    .with_all(series(0, &best, points))
    .with_all(
        limit
            .into_iter()
            .flat_map(|at| series(1, &interval, ends(at))),
    )
    .with_all(
        itself
            .into_iter()
            .flat_map(|p| series(2, "the response itself", vec![p])),
    )
    .with_all(limit.map(|at| Mark::level("limit, 95 %", at)))
}

/// Charts of the surface; their names end with `suffix`.
fn surfaces(
    fit: &Fit,
    response: &str,
    suffix: &str,
    charts: &mut Vec<Named>,
) -> anyhow::Result<()> {
    let mut own = vec![("perturbation".to_owned(), perturbation(fit, response)?)];
    if let Some(ridge) = Ridge::of(fit) {
        own.push(("ridge".to_owned(), paths(&ridge, response)?));
    }
    if fit.factors.len() <= MOST_FACTORS {
        pairs::draw(fit, response, &mut own)?;
        pairs::cubes(fit, response, &mut own)?;
    }
    let named = own.into_iter().map(|(name, chart)| (name + suffix, chart));
    charts.extend(named);
    Ok(())
}

/// The surface at every combination of named levels, with its name.
fn at_levels(fit: &Fit, categories: &[Categorical]) -> anyhow::Result<Vec<(String, Fit)>> {
    let combinations = levels::combinations(categories);
    let mut found = Vec::with_capacity(combinations.len());
    for chosen in combinations {
        let safe = |text: &str| text.replace(|c: char| !c.is_alphanumeric(), "_");
        let names: Vec<String> = chosen.iter().map(|(_, level)| safe(level)).collect();
        found.push((names.join("-"), levels::held(fit, &chosen)?));
    }
    Ok(found)
}

/// Number of columns that stand for named levels.
fn of_levels(categories: &[Categorical]) -> usize {
    categories.iter().map(|c| c.levels().len() - 1).sum()
}

/// Writes the charts as SVG into a folder.
pub(super) fn write(common: &Common, folder: &Path, charts: &[Named]) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, chart) in charts {
        let file = folder.join(format!("{name}.svg"));
        write_new(&file, chart.as_str().as_bytes(), common.overwrite())?;
    }
    Ok(())
}

/// Pareto and half-normal charts.
fn effects(report: &Report<'_>, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    if let Some(found) = &report.pareto {
        let signed = |(name, t): (&str, &f64)| {
            let sign = found.sign.get(name).copied().unwrap_or(1);
            (report.fit.formula.printed(name), t * f64::from(sign))
        };
        let limits = [
            ("t 5 %", found.t_limit),
            ("Bonferroni 5 %", found.bonferroni_terms),
        ];
        let limits = limits
            .into_iter()
            .filter_map(|(name, at)| Some((name, at?)));
        let effects: Vec<_> = found.t_abs.iter().map(signed).collect();
        let chart = pareto(
            &AxisTitle::new("|t|", ""),
            &effects,
            &limits.collect::<Vec<_>>(),
        );
        charts.push(("pareto".to_owned(), chart.draw()?));
    }
    if let Some(chart) = half_normal_plot(report) {
        charts.push(("half-normal".to_owned(), chart.draw()?));
    }
    Ok(())
}

/// Half-normal plot with its limits: of all columns against Lenth's margins, of the terms as t where the residuals have
/// degrees of freedom, of their coefficients otherwise.
fn half_normal_plot(report: &Report<'_>) -> Option<Plot> {
    let fit = report.fit;
    let lenth = |found: &Lenth| {
        let limits = [
            ("margin of error", found.me),
            ("simultaneous margin of error", found.sme),
        ];
        let limits = limits
            .into_iter()
            .filter_map(|(name, at)| Some((name, at?)));
        (Some(found.pse), limits.collect::<Vec<_>>())
    };
    let terms = || fit.terms.iter().filter(|(_, row)| row.ss_partial.is_some());
    let printed = |name: &str| fit.formula.printed(name);
    let tested = |(name, row): (&str, &TermRow)| Some((printed(name), row.coef / row.se?));
    let (quantity, mut effects, (standard_error, limits)): (&str, Vec<(String, f64)>, _) =
        if let Some(s) = &report.saturated {
            let list = s.effects.iter().map(|(name, e)| (name.to_owned(), *e));
            ("|effect|", list.collect(), lenth(&s.lenth))
        } else if let Some(t) = fit.t_crit_975 {
            let limits = vec![("t, 5 %", t)];
            (
                "|t|",
                terms().filter_map(tested).collect(),
                (Some(1.0), limits),
            )
        } else {
            let list = terms().map(|(name, row)| (printed(name), row.coef));
            ("|coefficient|, coded", list.collect(), (None, Vec::new()))
        };
    effects.retain(|e| e.1.is_finite());
    let se = standard_error.filter(|se| se.is_finite());
    let plot = half_normal(&AxisTitle::new(quantity, ""), &effects, se, &limits);
    (!effects.is_empty()).then_some(plot)
}

/// Most points that all have their names.
const MOST_NAMES: usize = 40;

/// A point for each run with its number, or only beyond the limits if there are many runs.
fn numbered(points: impl Iterator<Item = (usize, [f64; 2])>, limit: Option<f64>) -> Vec<PlotPoint> {
    let points: Vec<(usize, [f64; 2])> = points.collect();
    let all = points.len() <= MOST_NAMES;
    let point = |(run, [x, y]): (usize, [f64; 2])| {
        let named = all || limit.is_some_and(|limit| y.abs() > limit);
        PlotPoint::new(x, y).with_label(if named {
            run.to_string()
        } else {
            String::new()
        })
    };
    points.into_iter().map(point).collect()
}

/// The line y = intercept + slope x over the range of some points.
fn straight(points: &[PlotPoint], intercept: f64, slope: f64) -> Mark {
    let x = || points.iter().map(|p| p.x);
    let ends = [
        x().fold(f64::INFINITY, f64::min),
        x().fold(f64::NEG_INFINITY, f64::max),
    ];
    Mark::dashed("", ends.map(|x| [x, intercept + slope * x]).into())
}

/// Residuals in the usual views.
fn diagnostics(report: &Report<'_>, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let (fit, response) = (report.fit, report.response);
    let studentised: Vec<(&Case, f64)> = fit
        .cases
        .iter()
        .filter_map(|case| Some((case, case.studentized_external?)))
        .collect();
    if studentised.is_empty() {
        return Ok(());
    }
    let residual = AxisTitle::new("external studentised residual", "");
    let limit = outlier_limit(fit);
    let view = |x: AxisTitle, f: &dyn Fn(&Case) -> f64| {
        let points = studentised
            .iter()
            .map(|(case, t)| (case.run, [f(case), *t]));
        let points = numbered(points, limit);
        let zero = straight(&points, 0.0, 0.0);
        let ends = limit.into_iter().flat_map(|t| {
            [
                Mark::level("outlier, 5 % of all runs", t),
                Mark::level("", -t),
            ]
        });
        scatter(x, residual.clone(), points, Vec::new())
            .with(zero)
            .with_all(ends)
            .draw()
    };
    let fitted = AxisTitle::new(format!("fitted {response}"), "");
    charts.push((
        "residuals-fitted".to_owned(),
        view(fitted.clone(), &|c| c.fitted)?,
    ));
    let order = AxisTitle::new("run", "");
    charts.push((
        "residuals-run".to_owned(),
        view(order.clone(), &|c| c.run as f64)?,
    ));
    // The columns of named levels stand behind the other factors.
    let numeric = fit.factors.len() - of_levels(&report.categories);
    for (j, factor) in fit.factors[..numeric].iter().enumerate() {
        let axis = AxisTitle::new(factor.symbol(), pairs::shown_unit(factor));
        let chart = view(axis, &|c| factor.natural(c.coded[j]))?;
        charts.push((format!("residuals-{}", factor.symbol()), chart));
    }
    charts.push(("normal".to_owned(), normal_plot(studentised, residual)?));
    let points = numbered(
        fit.cases.iter().map(|c| (c.run, [c.actual, c.fitted])),
        None,
    );
    let line = straight(&points, 0.0, 1.0);
    let comparison = scatter(AxisTitle::new(response, ""), fitted, points, Vec::new());
    charts.push(("fitted-actual".to_owned(), comparison.with(line).draw()?));
    influence(fit, &order, charts)
}

/// Residuals over the quantiles of the normal distribution that belong to their ranks.
fn normal_plot(mut sorted: Vec<(&Case, f64)>, residual: AxisTitle) -> anyhow::Result<Svg> {
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let n = sorted.len() as f64;
    let quantile = |i: usize| normal_quantile((i as f64 + 0.5) / n).unwrap_or(0.0);
    let ranked = sorted.iter().enumerate();
    let points = numbered(
        ranked.map(|(i, (case, t))| (case.run, [quantile(i), *t])),
        None,
    );
    let line = straight(&points, 0.0, 1.0);
    let quantiles = AxisTitle::new("normal quantile", "");
    Ok(scatter(quantiles, residual, points, Vec::new())
        .with(line)
        .draw()?)
}

/// Limit beyond which the largest of all residuals lies by chance in 5 % of the fits (Bonferroni), none without degrees
/// of freedom `[Belsley1980, section 2.1]`.
fn outlier_limit(fit: &Fit) -> Option<f64> {
    let df = fit.df_resid.saturating_sub(1);
    let limit = (df > 0).then(|| t_two_sided_quantile(0.05 / fit.n as f64, df as f64));
    limit.flatten()
}

/// What single rows do to the fit.
fn influence(fit: &Fit, order: &AxisTitle, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let measures = [
        (
            "cook",
            "Cook's distance",
            (|c: &Case| c.cooks_d) as fn(&Case) -> Option<f64>,
        ),
        ("leverage", "leverage", |c: &Case| Some(c.leverage)),
        ("dffits", "DFFITS", |c: &Case| c.dffits),
    ];
    for (name, title, value) in measures {
        let cases = fit.cases.iter();
        let points = cases.filter_map(|c| Some((c.run, [c.run as f64, value(c)?])));
        let points = numbered(points, None);
        if !points.is_empty() {
            let chart = scatter(order.clone(), AxisTitle::new(title, ""), points, Vec::new());
            charts.push((name.to_owned(), chart.draw()?));
        }
    }
    Ok(())
}

/// The highest and the lowest value on spheres around the middle of the ranges.
fn paths(ridge: &Ridge, response: &str) -> anyhow::Result<Svg> {
    let path = |number: usize, name: &str, points: &[RidgePoint]| {
        let point = |p: &RidgePoint| {
            PlotPoint::new(p.radius_coded, p.value).with_error(p.se_mean.unwrap_or(0.0))
        };
        series(number, name, points.iter().map(point).collect())
    };
    let chart = Plot::new(
        Axis::numbers("coded distance from the middle (bars: standard error)", ""),
        Axis::numbers(response, ""),
    )
    .with_all(path(0, "highest", &ridge.ascent))
    .with_all(path(1, "lowest", &ridge.descent));
    Ok(chart.draw()?)
}

/// The response along each factor from the middle of the ranges.
fn perturbation(fit: &Fit, response: &str) -> anyhow::Result<Svg> {
    let lines = fit.factors.iter().enumerate().flat_map(|(j, factor)| {
        let point = |x: f64| {
            let mut coded = vec![0.0; fit.factors.len()];
            coded[j] = x;
            PlotPoint::new(x, fit.value(&coded))
        };
        series(j, factor.symbol(), along(LINE).map(point).collect())
    });
    let x = "coded distance from the middle, the other factors there";
    let chart = Plot::new(Axis::numbers(x, ""), Axis::numbers(response, ""));
    Ok(chart.with_all(lines).draw()?)
}
