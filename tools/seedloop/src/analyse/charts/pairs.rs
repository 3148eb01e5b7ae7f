//! Charts over pairs of factors.

use command_line::significant;
use report::{AxisTitle, Grid, Plot, PlotPoint, Svg, design_runs, series};
use response_surface::fit::Case;
use response_surface::{DataRegion, ErrorSource, Fit};

use super::solids::{cube, surface};
use super::{LINE, Named};

/// Points along each axis of a contour or surface.
const GRID: usize = 31;

/// Most rows of the data that are marked: more would cover the surface.
const MOST_MARKED: usize = 1000;

/// Longest text about the factors that are held, characters: a title of an axis has room for some sixty.
const MOST_HELD: usize = 36;

/// Coded values along a range.
pub(super) fn along(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 2.0 * i as f64 / (count - 1) as f64 - 1.0)
}

/// Coded values along the range of a factor, and along what the data span beyond it.
fn along_data(fit: &Fit, j: usize) -> Vec<f64> {
    let region = fit.data_region.as_ref();
    let coded = |ends: fn(&DataRegion) -> &[f64]| region.map(|r| fit.factors[j].coded(ends(r)[j]));
    let low = coded(|r| &r.low).map_or(-1.0, |x| x.min(-1.0));
    let high = coded(|r| &r.high).map_or(1.0, |x| x.max(1.0));
    let point = |x: f64| low + (high - low) * (x + 1.0) / 2.0;
    along(GRID).map(point).collect()
}

/// The unit of a factor as an axis shows it: nothing for a number without one.
pub(super) fn shown_unit(factor: &experiment_design::Factor) -> &str {
    if factor.unit() == "1" {
        ""
    } else {
        factor.unit()
    }
}

/// The response with the values at which the factors that are not shown are held.
pub(super) fn response_at(fit: &Fit, response: &str, shown: &[usize]) -> AxisTitle {
    let others = fit.factors.iter().enumerate();
    let others = others.filter(|(j, _)| !shown.contains(j));
    let held: Vec<String> = others
        .map(|(_, f)| {
            let unit = shown_unit(f);
            format!("{} = {} {unit}", f.symbol(), significant(f.mid(), 4))
        })
        .map(|text| text.trim_end().to_owned())
        .collect();
    let words = held.join(", ");
    AxisTitle::new(
        match held.len() {
            0 => response.to_owned(),
            _ if words.chars().count() <= MOST_HELD => format!("{response} at {words}"),
            _ => format!("{response}, the other factors in the middle"),
        },
        "",
    )
}

/// How far each node of a grid lies beyond what the data span, squared half-widths; nothing if all lie within.
fn beyond_data(fit: &Fit, nodes: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let Some(region) = &fit.data_region else {
        return Vec::new();
    };
    let beyond = nodes.map(|coded| region.beyond(&fit.natural(&coded)));
    let beyond: Vec<f64> = beyond.collect();
    if beyond.iter().any(|by| *by > 0.0) {
        beyond
    } else {
        Vec::new()
    }
}

/// Contour, surface and interaction of every pair of factors, the others in the middle.
pub(super) fn draw(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let k = fit.factors.len();
    for i in 0..k {
        for j in i + 1..k {
            let (a, b) = (&fit.factors[i], &fit.factors[j]);
            let title = |f: &experiment_design::Factor| AxisTitle::new(f.symbol(), shown_unit(f));
            let [across, up] = [i, j].map(|j| along_data(fit, j));
            let node = |x: f64, y: f64| {
                let mut coded = vec![0.0; k];
                (coded[i], coded[j]) = (x, y);
                coded
            };
            let nodes = || {
                up.iter()
                    .flat_map(|&y| across.iter().map(move |&x| node(x, y)))
            };
            let values: Vec<f64> = nodes().map(|coded| fit.value(&coded)).collect();
            let x_values: Vec<f64> = across.iter().map(|&x| a.natural(x)).collect();
            let y_values: Vec<f64> = up.iter().map(|&y| b.natural(y)).collect();
            let response = response_at(fit, response, &[i, j]);
            let name = format!("{}-{}", a.symbol(), b.symbol());
            let flat = values.iter().all(|v| *v == values[0]);
            if !flat {
                let grid = Grid {
                    x: title(a),
                    y: title(b),
                    response: response.clone(),
                    x_values,
                    y_values,
                    values,
                };
                let beyond = beyond_data(fit, nodes());
                let mut also = Vec::new();
                if !beyond.is_empty() {
                    also.extend(grid.region("beyond what the runs span", &beyond)?);
                }
                also.extend(design_runs(runs_of(fit, [i, j])));
                charts.push((format!("contour-{name}"), grid.contours(also)?.draw()?));
                charts.push((format!("surface-{name}"), surface(&grid).draw()?));
            }
            charts.push((
                format!("interaction-{name}"),
                interaction(fit, &response, i, j)?,
            ));
        }
    }
    Ok(())
}

/// The settings of the data in the plane of two factors, one mark for all rows of one setting.
fn runs_of(fit: &Fit, [i, j]: [usize; 2]) -> Vec<PlotPoint> {
    if fit.cases.len() > MOST_MARKED {
        return Vec::new();
    }
    let mut groups: Vec<(&Case, Vec<String>)> = Vec::new();
    for case in &fit.cases {
        let run = case.run.to_string();
        match groups
            .iter_mut()
            .find(|(first, _)| first.coded == case.coded)
        {
            Some((_, runs)) => runs.push(run),
            None => groups.push((case, vec![run])),
        }
    }
    let run = |(case, runs): (&Case, Vec<String>)| {
        let natural = fit.natural(&case.coded);
        let settings = fit.factors.iter().zip(&natural);
        let settings: Vec<String> = settings
            .map(|(f, x)| format!("{} = {}", f.symbol(), significant(*x, 4)))
            .collect();
        PlotPoint {
            tip: format!("Run {}: {}", runs.join(", "), settings.join(", ")),
            ..PlotPoint::new(natural[i], natural[j])
        }
    };
    groups.into_iter().map(run).collect()
}

/// The response at the corners of every three factors, the others in the middle.
pub(super) fn cubes(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let k = fit.factors.len();
    let edge = |j: usize| {
        let factor = &fit.factors[j];
        let title = AxisTitle::new(factor.symbol(), shown_unit(factor));
        let [low, high] = [factor.low(), factor.high()].map(|end| significant(end, 3));
        format!("{title}: {low} to {high}")
    };
    for a in 0..k {
        for b in a + 1..k {
            for c in b + 1..k {
                let value = |corner: usize| {
                    let mut coded = vec![0.0; k];
                    for (bit, j) in [a, b, c].into_iter().enumerate() {
                        coded[j] = if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                    }
                    fit.value(&coded)
                };
                let response = response_at(fit, response, &[a, b, c]);
                let chart = cube(&[a, b, c].map(edge), &response, std::array::from_fn(value));
                let name = [a, b, c].map(|j| fit.factors[j].symbol()).join("-");
                charts.push((format!("cube-{name}"), chart.draw()?));
            }
        }
    }
    Ok(())
}

/// The response along one factor at both ends of another, with 95 % intervals.
fn interaction(fit: &Fit, response: &AxisTitle, i: usize, j: usize) -> anyhow::Result<Svg> {
    let (a, b) = (&fit.factors[i], &fit.factors[j]);
    let error = fit
        .error_variance(ErrorSource::AllRepeats)
        .or_else(|| fit.error_variance(ErrorSource::Residual));
    let x = AxisTitle::new(a.symbol(), shown_unit(a));
    let mut chart = Plot::new(x.into(), response.clone().into());
    for (number, end) in [-1.0, 1.0].into_iter().enumerate() {
        let mut points = Vec::new();
        for x in along(LINE) {
            let mut coded = vec![0.0; fit.factors.len()];
            (coded[i], coded[j]) = (x, end);
            let got = fit.predict_with(&fit.natural(&coded), error)?;
            let half = got.ci95.map_or(0.0, |[low, high]| 0.5 * (high - low));
            points.push(PlotPoint::new(a.natural(x), got.mean).with_error(half));
        }
        let name = format!("{} = {}", b.symbol(), b.natural(end));
        chart = chart.with_all(series(number, &name, points));
    }
    Ok(chart.draw()?)
}
