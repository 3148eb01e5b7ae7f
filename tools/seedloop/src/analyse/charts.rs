//! The charts of an analysis.

mod pairs;

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use command_line::{Common, write_new};

use report::{
    AxisTitle, Effect, HalfNormal, Level, LineSeries, Pareto, PngPrinter, Scatter, Series,
    SeriesPoint, Svg,
};
use response_surface::distribution::normal_quantile;
use response_surface::fit::Case;
use response_surface::{Categorical, Fit, RidgePoint};

use super::Report;
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
        let points = profile.lambda.iter().zip(&profile.ln_sse);
        let points = points.map(|(x, y)| SeriesPoint::new(*x, *y, 0.0)).collect();
        let chart = LineSeries {
            x: AxisTitle::new("power of the response", ""),
            y: AxisTitle::new("ln of the residual sum of squares", ""),
            series: vec![Series {
                name: "Box-Cox profile".to_owned(),
                points,
            }],
            levels: Vec::new(),
        };
        charts.push(("box-cox".to_owned(), chart.draw()?));
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
            Effect::new(name, t * f64::from(sign))
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
    let (effects, named_above): (Vec<Effect>, f64) = if let Some(s) = &report.saturated {
        let list = s.effects.iter().map(|(name, e)| Effect::new(name, *e));
        (list.collect(), s.lenth.me.unwrap_or(0.0))
    } else {
        let terms = report.fit.terms.iter();
        let tested = terms.filter(|(_, row)| row.ss_partial.is_some());
        let list = tested.map(|(name, row)| Effect::new(name, row.coef));
        (list.collect(), 0.0)
    };
    if !effects.is_empty() {
        let quantity = if report.saturated.is_some() {
            "|effect|"
        } else {
            "|coefficient|, coded"
        };
        let chart = HalfNormal {
            size: AxisTitle::new(quantity, ""),
            effects,
            standard_error: None,
            named_above,
        };
        charts.push(("half-normal".to_owned(), chart.draw()?));
    }
    Ok(())
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
    let view = |x: AxisTitle, f: &dyn Fn(&Case) -> f64| Scatter {
        x,
        y: residual.clone(),
        points: studentised.iter().map(|(case, t)| [f(case), *t]).collect(),
        line: Some([0.0, 0.0]),
        levels: Vec::new(),
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
        let axis = AxisTitle::new(factor.symbol(), factor.unit().trim_start_matches('1'));
        let chart = view(axis, &|c| factor.natural(c.coded[j]));
        charts.push((format!("residuals-{}", factor.symbol()), chart.draw()?));
    }
    let mut sorted: Vec<f64> = studentised.iter().map(|(_, t)| *t).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let quantile = |i: usize| normal_quantile((i as f64 + 0.5) / n).unwrap_or(0.0);
    let normal = Scatter {
        x: AxisTitle::new("normal quantile", ""),
        y: residual,
        points: sorted
            .iter()
            .enumerate()
            .map(|(i, t)| [quantile(i), *t])
            .collect(),
        line: Some([0.0, 1.0]),
        levels: Vec::new(),
    };
    charts.push(("normal".to_owned(), normal.draw()?));
    let comparison = Scatter {
        x: AxisTitle::new(response, ""),
        y: fitted,
        points: fit.cases.iter().map(|c| [c.actual, c.fitted]).collect(),
        line: Some([0.0, 1.0]),
        levels: Vec::new(),
    };
    charts.push(("fitted-actual".to_owned(), comparison.draw()?));
    influence(fit, &order, charts)
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
        x: AxisTitle::new("coded distance from the middle", ""),
        y: AxisTitle::new(response, ""),
        series: series.collect(),
        levels: Vec::new(),
    };
    Ok(chart.draw()?)
}
