//! The charts of an analysis.

mod pairs;

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use command_line::{Common, write_new};

use probability::{chi_squared_quantile, normal_quantile, t_two_sided_quantile};
use report::{
    AxisTitle, FactorEffect, HalfNormal, Level, LineSeries, Pareto, PngPrinter, Scatter, Series,
    SeriesPoint, Svg,
};
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
fn powers(profile: &BoxCox, n: usize) -> LineSeries {
    let points = profile.lambda.iter().zip(&profile.ln_sse);
    let points: Vec<SeriesPoint> = points.map(|(x, y)| SeriesPoint::new(*x, *y, 0.0)).collect();
    let least = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let limit = chi_squared_quantile(0.05, 1.0).map(|rise| least + rise / n as f64);
    let [low, high] = profile.interval95.map(|end| power(profile, end));
    let mut series = vec![Series {
        name: format!("Box-Cox profile, best {}", power(profile, profile.best)),
        points: points.clone(),
    }];
    if let Some(limit) = limit {
        series.push(Series {
            name: format!("95 % interval, {low} to {high}"),
            points: profile
                .interval95
                .map(|x| SeriesPoint::new(x, limit, 0.0))
                .into(),
        });
    }
    let itself = points.iter().find(|p| p.x == 1.0);
    series.extend(itself.map(|p| Series {
        name: "the response itself".to_owned(),
        points: vec![*p],
    }));
    LineSeries {
        x: AxisTitle::new("power of the response", ""),
        y: AxisTitle::new("ln of the residual sum of squares", ""),
        series,
        levels: limit
            .map(|at| Level::new("limit, 95 %", at))
            .into_iter()
            .collect(),
    }
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

/// Writes the charts as SVG and PNG into a folder.
pub(super) fn write(common: &Common, folder: &Path, charts: &[Named]) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let printer = PngPrinter::new();
    if !printer.has_fonts() {
        common
            .log(|| "warning: this machine has no font, so the PNG charts have no text".to_owned());
    }
    for (name, chart) in charts {
        let file = |end: &str| folder.join(format!("{name}.{end}"));
        write_new(&file("svg"), chart.as_str().as_bytes(), common.overwrite())?;
        write_new(&file("png"), &printer.print(chart)?, common.overwrite())?;
    }
    Ok(())
}

/// Pareto and half-normal charts.
fn effects(report: &Report<'_>, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    if let Some(pareto) = &report.pareto {
        let signed = |(name, t): (&str, &f64)| {
            let sign = pareto.sign.get(name).copied().unwrap_or(1);
            FactorEffect::new(report.fit.formula.printed(name), t * f64::from(sign))
        };
        let limit = |name: &str, value: Option<f64>| value.map(|value| Level::new(name, value));
        let limits = [
            limit("t 5 %", pareto.t_limit),
            limit("Bonferroni 5 %", pareto.bonferroni_terms),
        ];
        let chart = Pareto {
            size: AxisTitle::new("|t|", ""),
            effects: pareto.t_abs.iter().map(signed).collect(),
            limits: limits.into_iter().flatten().collect(),
        };
        charts.push(("pareto".to_owned(), chart.draw()?));
    }
    let chart = half_normal(report);
    if !chart.effects.is_empty() {
        charts.push(("half-normal".to_owned(), chart.draw()?));
    }
    Ok(())
}

/// Half-normal plot with its limits: of all columns against Lenth's margins, of the terms as t where the residuals have
/// degrees of freedom, of their coefficients otherwise.
fn half_normal(report: &Report<'_>) -> HalfNormal {
    let fit = report.fit;
    let lenth = |found: &Lenth| {
        let limits = [
            ("margin of error", found.me),
            ("simultaneous margin of error", found.sme),
        ];
        let limit = |(name, at): (&str, Option<f64>)| Some(Level::new(name, at?));
        (
            Some(found.pse),
            limits.into_iter().filter_map(limit).collect::<Vec<_>>(),
        )
    };
    let terms = || fit.terms.iter().filter(|(_, row)| row.ss_partial.is_some());
    let printed = |name: &str| fit.formula.printed(name);
    let tested =
        |(name, row): (&str, &TermRow)| Some(FactorEffect::new(printed(name), row.coef / row.se?));
    let (quantity, effects, (standard_error, limits)): (&str, Vec<FactorEffect>, _) =
        if let Some(s) = &report.saturated {
            let list = s
                .effects
                .iter()
                .map(|(name, e)| FactorEffect::new(name, *e));
            ("|effect|", list.collect(), lenth(&s.lenth))
        } else if let Some(t) = fit.t_crit_975 {
            let limit = Level::new("t, 5 %", t);
            (
                "|t|",
                terms().filter_map(tested).collect(),
                (Some(1.0), vec![limit]),
            )
        } else {
            let list = terms().map(|(name, row)| FactorEffect::new(printed(name), row.coef));
            ("|coefficient|, coded", list.collect(), (None, Vec::new()))
        };
    HalfNormal {
        size: AxisTitle::new(quantity, ""),
        named_above: limits.first().map_or(0.0, |limit| limit.value),
        effects: effects
            .into_iter()
            .filter(|e| e.value.is_finite())
            .collect(),
        standard_error: standard_error.filter(|se| se.is_finite()),
        limits,
    }
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
    let runs = || studentised.iter().map(|(case, _)| case.run.to_string());
    let view = |x: AxisTitle, f: &dyn Fn(&Case) -> f64| Scatter {
        x,
        y: residual.clone(),
        points: studentised.iter().map(|(case, t)| [f(case), *t]).collect(),
        names: runs().collect(),
        marked: Vec::new(),
        line: Some([0.0, 0.0]),
        levels: outlier_limits(fit),
    };
    let fitted = AxisTitle::new(format!("fitted {response}"), "");
    charts.push((
        "residuals-fitted".to_owned(),
        view(fitted.clone(), &|c| c.fitted).draw()?,
    ));
    let order = AxisTitle::new("run", "");
    charts.push((
        "residuals-run".to_owned(),
        view(order.clone(), &|c| c.run as f64).draw()?,
    ));
    // The columns of named levels stand behind the other factors.
    let numeric = fit.factors.len() - of_levels(&report.categories);
    for (j, factor) in fit.factors[..numeric].iter().enumerate() {
        let axis = AxisTitle::new(factor.symbol(), pairs::shown_unit(factor));
        let chart = view(axis, &|c| factor.natural(c.coded[j]));
        charts.push((format!("residuals-{}", factor.symbol()), chart.draw()?));
    }
    let mut sorted: Vec<(&Case, f64)> = studentised.clone();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let n = sorted.len() as f64;
    let quantile = |i: usize| normal_quantile((i as f64 + 0.5) / n).unwrap_or(0.0);
    let normal = Scatter {
        x: AxisTitle::new("normal quantile", ""),
        y: residual,
        points: sorted
            .iter()
            .enumerate()
            .map(|(i, (_, t))| [quantile(i), *t])
            .collect(),
        names: sorted
            .iter()
            .map(|(case, _)| case.run.to_string())
            .collect(),
        marked: Vec::new(),
        line: Some([0.0, 1.0]),
        levels: Vec::new(),
    };
    charts.push(("normal".to_owned(), normal.draw()?));
    let comparison = Scatter {
        x: AxisTitle::new(response, ""),
        y: fitted,
        points: fit.cases.iter().map(|c| [c.actual, c.fitted]).collect(),
        names: fit.cases.iter().map(|c| c.run.to_string()).collect(),
        marked: Vec::new(),
        line: Some([0.0, 1.0]),
        levels: Vec::new(),
    };
    charts.push(("fitted-actual".to_owned(), comparison.draw()?));
    influence(fit, &order, charts)
}

/// Limits beyond which the largest of all residuals lies by chance in 5 % of the fits (Bonferroni), none without degrees
/// of freedom `[Belsley1980, section 2.1]`.
fn outlier_limits(fit: &Fit) -> Vec<Level> {
    let df = fit.df_resid.saturating_sub(1);
    let limit = (df > 0).then(|| t_two_sided_quantile(0.05 / fit.n as f64, df as f64));
    let Some(t) = limit.flatten() else {
        return Vec::new();
    };
    vec![
        Level::new("outlier, 5 % of all runs", t),
        Level::new("", -t),
    ]
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
        let chart = Scatter {
            x: order.clone(),
            y: AxisTitle::new(title, ""),
            points: fit
                .cases
                .iter()
                .filter_map(|c| Some([c.run as f64, value(c)?]))
                .collect(),
            names: fit
                .cases
                .iter()
                .filter(|c| value(c).is_some())
                .map(|c| c.run.to_string())
                .collect(),
            marked: Vec::new(),
            line: None,
            levels: Vec::new(),
        };
        if !chart.points.is_empty() {
            charts.push((name.to_owned(), chart.draw()?));
        }
    }
    Ok(())
}

/// The highest and the lowest value on spheres around the middle of the ranges.
fn paths(ridge: &Ridge, response: &str) -> anyhow::Result<Svg> {
    let series = |name: &str, points: &[RidgePoint]| Series {
        name: name.to_owned(),
        points: points
            .iter()
            .map(|p| SeriesPoint::new(p.radius_coded, p.value, p.se_mean.unwrap_or(0.0)))
            .collect(),
    };
    let chart = LineSeries {
        x: AxisTitle::new("coded distance from the middle (bars: standard error)", ""),
        y: AxisTitle::new(response, ""),
        series: vec![
            series("highest", &ridge.ascent),
            series("lowest", &ridge.descent),
        ],
        levels: Vec::new(),
    };
    Ok(chart.draw()?)
}

/// The response along each factor from the middle of the ranges.
fn perturbation(fit: &Fit, response: &str) -> anyhow::Result<Svg> {
    let series = fit.factors.iter().enumerate().map(|(j, factor)| {
        let point = |x: f64| {
            let mut coded = vec![0.0; fit.factors.len()];
            coded[j] = x;
            SeriesPoint::new(x, fit.value(&coded), 0.0)
        };
        Series {
            name: factor.symbol().to_owned(),
            points: along(LINE).map(point).collect(),
        }
    });
    let chart = LineSeries {
        x: AxisTitle::new(
            "coded distance from the middle, the other factors there",
            "",
        ),
        y: AxisTitle::new(response, ""),
        series: series.collect(),
        levels: Vec::new(),
    };
    Ok(chart.draw()?)
}
