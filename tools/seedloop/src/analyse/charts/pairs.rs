//! Charts over pairs of factors.

use command_line::significant;
use report::{
    AxisTitle, Contour, Cube, CubeEdge, DesignRun, LineSeries, Series, SeriesPoint, Surface, Svg,
};
use response_surface::fit::Case;
use response_surface::{ErrorSource, Fit};

use super::{LINE, Named};

/// Points along each axis of a contour or surface.
const GRID: usize = 31;

/// Coded values along a range.
pub(super) fn along(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 2.0 * i as f64 / (count - 1) as f64 - 1.0)
}

/// Contour, surface and interaction of every pair of factors, the others in the middle.
pub(super) fn draw(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
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
                    runs: runs_of(fit, [i, j]),
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

/// The rows of the data in the plane of two factors.
fn runs_of(fit: &Fit, [i, j]: [usize; 2]) -> Vec<DesignRun> {
    let run = |case: &Case| {
        let natural = fit.natural(&case.coded);
        let settings = fit.factors.iter().zip(&natural);
        let settings: Vec<String> = settings
            .map(|(f, x)| format!("{} = {}", f.symbol(), significant(*x, 4)))
            .collect();
        DesignRun {
            name: format!("Run {}: {}", case.run, settings.join(", ")),
            x: natural[i],
            y: natural[j],
            link: String::new(),
        }
    };
    fit.cases.iter().map(run).collect()
}

/// The response at the corners of every three factors, the others in the middle.
pub(super) fn cubes(fit: &Fit, response: &str, charts: &mut Vec<Named>) -> anyhow::Result<()> {
    let k = fit.factors.len();
    let edge = |j: usize| {
        let factor = &fit.factors[j];
        CubeEdge {
            title: AxisTitle::new(factor.symbol(), factor.unit().trim_start_matches('1')),
            low: factor.low(),
            high: factor.high(),
        }
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
                let chart = Cube {
                    edges: [a, b, c].map(edge),
                    response: AxisTitle::new(response, ""),
                    values: std::array::from_fn(value),
                };
                let name = [a, b, c].map(|j| fit.factors[j].symbol()).join("-");
                charts.push((format!("cube-{name}"), chart.draw()?));
            }
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
