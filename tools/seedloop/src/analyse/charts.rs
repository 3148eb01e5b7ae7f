//! The charts of an analysis.

use report::{
    AxisTitle, Contour, Effect, HalfNormal, Level, LineSeries, Pareto, Scatter, Series,
    SeriesPoint, Surface, Svg,
};
use response_surface::distribution::normal_quantile;
use response_surface::fit::Case;
use response_surface::{ErrorSource, Fit};

use super::Report;

/// Points along each axis of a contour or surface.
const GRID: usize = 31;
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
    diagnostics(fit, report.response, &mut charts)?;
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
    charts.push((
        "perturbation".to_owned(),
        perturbation(fit, report.response)?,
    ));
    if fit.factors.len() <= MOST_FACTORS {
        pairs(fit, report.response, &mut charts)?;
    }
    Ok(charts)
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
fn diagnostics(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
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
    for (j, factor) in fit.factors.iter().enumerate() {
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

/// Coded values along a range.
fn along(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 2.0 * i as f64 / (count - 1) as f64 - 1.0)
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

/// Contour, surface and interaction of every pair of factors, the others in the middle.
fn pairs(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let k = fit.factors.len();
    for i in 0..k {
        for j in i + 1..k {
            let (a, b) = (&fit.factors[i], &fit.factors[j]);
            let title = |f: &experiment_design::Factor| {
                AxisTitle::new(f.symbol(), f.unit().trim_start_matches('1'))
            };
            let at = |x: f64, y: f64| {
                let mut coded = vec![0.0; k];
                (coded[i], coded[j]) = (x, y);
                fit.value(&coded)
            };
            let values: Vec<f64> = along(GRID)
                .flat_map(|y| along(GRID).map(move |x| (x, y)))
                .map(|(x, y)| at(x, y))
                .collect();
            let (x_values, y_values): (Vec<f64>, Vec<f64>) =
                along(GRID).map(|x| (a.natural(x), b.natural(x))).unzip();
            let name = format!("{}-{}", a.symbol(), b.symbol());
            let flat = values.iter().all(|v| *v == values[0]);
            if !flat {
                let contour = Contour {
                    x: title(a),
                    y: title(b),
                    response: AxisTitle::new(response, ""),
                    x_values: x_values.clone(),
                    y_values: y_values.clone(),
                    values: values.clone(),
                    target: None,
                    region_name: String::new(),
                    region: Vec::new(),
                    points: Vec::new(),
                };
                charts.push((format!("contour-{name}"), contour.draw()?));
                let surface = Surface {
                    x: title(a),
                    y: title(b),
                    response: AxisTitle::new(response, ""),
                    x_values,
                    y_values,
                    values,
                };
                charts.push((format!("surface-{name}"), surface.draw()?));
            }
            charts.push((
                format!("interaction-{name}"),
                interaction(fit, response, i, j)?,
            ));
        }
    }
    Ok(())
}

/// The response along one factor at both ends of another, with 95 % intervals.
fn interaction(fit: &Fit, response: &str, i: usize, j: usize) -> anyhow::Result<Svg> {
    let (a, b) = (&fit.factors[i], &fit.factors[j]);
    let error = fit
        .error_variance(ErrorSource::AllRepeats)
        .or_else(|| fit.error_variance(ErrorSource::Residual));
    let mut series = Vec::new();
    for end in [-1.0, 1.0] {
        let mut points = Vec::new();
        for x in along(LINE) {
            let mut coded = vec![0.0; fit.factors.len()];
            (coded[i], coded[j]) = (x, end);
            let got = fit.predict_with(&fit.natural(&coded), error)?;
            let half = got.ci95.map_or(0.0, |[low, high]| 0.5 * (high - low));
            points.push(SeriesPoint::new(a.natural(x), got.mean, half));
        }
        series.push(Series {
            name: format!("{} = {}", b.symbol(), b.natural(end)),
            points,
        });
    }
    let chart = LineSeries {
        x: AxisTitle::new(a.symbol(), a.unit().trim_start_matches('1')),
        y: AxisTitle::new(response, ""),
        series,
        levels: Vec::new(),
    };
    Ok(chart.draw()?)
}
