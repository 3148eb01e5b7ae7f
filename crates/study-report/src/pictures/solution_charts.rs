//! The set of solutions: contours of the joint misfit over two parameters, pairs of parameters otherwise.

use super::surface_charts::{evenly, measured, variance_of_mean};
use crate::numbers::shown_unit;
use crate::{Error, ReportInput};
use inference::{Estimate, Role};
use report::{AxisTitle, Grid, Plot, PlotPoint, marked_points, scatter};
use response_surface::Fit;

/// Nodes of the grid in each direction.
const NODES: usize = 121;
/// Roots of the sum of squares above this are drawn alike, so that the contours show the valley and not its walls.
const WALL: f64 = 9.0;
/// All pairs of parameters, those with the largest correlations first.
pub(crate) fn pairs(input: &ReportInput<'_>) -> Vec<[usize; 2]> {
    let found = input.calibration;
    let n = found.parameters.len();
    let mut all: Vec<[usize; 2]> = (0..n)
        .flat_map(|a| (a + 1..n).map(move |b| [a, b]))
        .collect();
    let size = |[a, b]: &[usize; 2]| {
        let row = found.correlation.get(*a);
        row.and_then(|row| row.get(*b)).map_or(0.0, |r| r.abs())
    };
    all.sort_by(|p, q| size(q).total_cmp(&size(p)));
    all
}

/// Points of the set of solutions in the plane of two parameters; `None` if there are fewer than two.
pub(crate) fn pair(input: &ReportInput<'_>, [a, b]: [usize; 2]) -> Option<Plot> {
    let found = input.calibration;
    let point = |p: &Vec<f64>| Some(PlotPoint::new(*p.get(a)?, *p.get(b)?));
    let points: Vec<PlotPoint> = found.solutions.points.iter().filter_map(point).collect();
    let marked = named_points(input, [a, b]);
    let [x, y] = [a, b].map(|k| title(&found.parameters[k]));
    (points.len() > 1).then(|| scatter(x, y, points, marked))
}

fn title(parameter: &Estimate) -> AxisTitle {
    let text = format!("{}: {}", parameter.symbol, parameter.name);
    AxisTitle::new(text, shown_unit(&parameter.unit))
}

/// A measurement of the fit with the surface that predicts it.
struct Equation<'a> {
    /// The surface.
    fit: &'a Fit,
    /// Number of the parameter behind each factor of the surface.
    parameters: Vec<usize>,
    /// Measured mean, in the unit of the observable.
    mean: f64,
    variance: f64,
}

impl Equation<'_> {
    /// Square of measured minus predicted over its variance.
    fn square(&self, point: &[f64]) -> f64 {
        let natural: Vec<f64> = self.parameters.iter().map(|&j| point[j]).collect();
        let coded = self.fit.coded(&natural);
        let variance = self.variance + variance_of_mean(self.fit, &coded);
        (self.mean - self.fit.value(&coded)).powi(2) / variance
    }
}

/// Contours of the root of the sum of squares over the last box, for two parameters; nothing where they are more or a
/// measurement of the fit has no analysed surface.
pub(crate) fn misfit(input: &ReportInput<'_>) -> Result<Option<Plot>, Error> {
    let found = input.calibration;
    let ([first, second], Some(last)) = (found.parameters.as_slice(), found.boxes.last()) else {
        return Ok(None);
    };
    let Some(equations) = equations(input) else {
        return Ok(None);
    };
    let priors: Vec<_> = input.problem.parameters.iter().map(|p| p.prior).collect();
    let sum = |point: [f64; 2]| {
        let of_data: f64 = equations.iter().map(|e| e.square(&point)).sum();
        let priors = priors.iter().zip(point);
        let of_priors = priors.filter_map(|(p, x)| p.map(|p| ((x - p.mean) / p.sd).powi(2)));
        (of_data + of_priors.sum::<f64>()).sqrt()
    };
    let x_values = evenly(last.low[0], last.high[0], NODES);
    let y_values = evenly(last.low[1], last.high[1], NODES);
    let rows = y_values.iter();
    let values = rows.flat_map(|&y| x_values.iter().map(move |&x| [x, y]));
    let values: Vec<f64> = values.map(sum).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let wall = WALL.max(3.0 * least);
    let grid = Grid {
        x: title(first),
        y: title(second),
        response: AxisTitle::new("root of the sum of squares of z", ""),
        values: values.into_iter().map(|v| v.min(wall)).collect(),
        x_values,
        y_values,
    };
    Ok(Some(
        grid.contours(vec![marked_points(inside_points(input))])?,
    ))
}

/// The measurements of the fit with their surfaces; `None` if one has none.
fn equations<'a>(input: &'a ReportInput<'a>) -> Option<Vec<Equation<'a>>> {
    let (problem, found) = (input.problem, input.calibration);
    let number = |symbol: &str| found.parameters.iter().position(|p| p.symbol == symbol);
    let equation = |i: usize| {
        let m = &problem.measurements[i];
        let model = &problem.models.get(m.model)?.name;
        let surfaces = found.surfaces.iter().find(|s| s.model == *model)?;
        let fit = surfaces.fits.get(&m.observable)?.as_ref()?;
        let m = measured(input, model, &m.observable)?;
        let symbols = fit.factors.iter().map(|f| number(f.symbol()));
        Some(Equation {
            fit,
            parameters: symbols.collect::<Option<_>>()?,
            mean: m.mean,
            variance: m.variance(),
        })
    };
    let numbers = problem.measurements_of(Role::Fit).into_iter();
    numbers.map(equation).collect()
}

/// The estimate and the other separate solutions, with their names.
fn solutions(input: &ReportInput<'_>) -> Vec<(String, Vec<f64>)> {
    let found = input.calibration;
    let estimate = found.parameters.iter().map(|p| p.value).collect();
    let others = found.solutions.separate.iter().enumerate().skip(1);
    let others = others.map(|(k, at)| (format!("solution {}", k + 1), at.clone()));
    std::iter::once(("estimate".into(), estimate))
        .chain(others)
        .collect()
}

/// The same in the plane of two parameters.
fn named_points(input: &ReportInput<'_>, [a, b]: [usize; 2]) -> Vec<PlotPoint> {
    let point = |(name, at): (String, Vec<f64>)| {
        Some(PlotPoint::new(*at.get(a)?, *at.get(b)?).with_label(name))
    };
    solutions(input).into_iter().filter_map(point).collect()
}

/// The estimate, the start and the other separate solutions, where the picture has room for them.
fn inside_points(input: &ReportInput<'_>) -> Vec<PlotPoint> {
    let found = input.calibration;
    let mut points = solutions(input);
    let start = found.parameters.iter().map(|p| p.start).collect();
    points.push(("start".into(), start));
    let Some(last) = found.boxes.last() else {
        return Vec::new();
    };
    let inside = |at: &[f64]| {
        let ends = last.low.iter().zip(&last.high);
        ends.zip(at)
            .all(|((low, high), x)| (low..=high).contains(&x))
    };
    points
        .into_iter()
        .filter(|(_, at)| at.len() == 2 && inside(at))
        .map(|(name, at)| PlotPoint::new(at[0], at[1]).with_label(name))
        .collect()
}
