//! Response surfaces with what was measured: a curve over one parameter, contours over the two strongest.

use crate::design_points::{DesignPoint, design_points};
use crate::numbers::{observable, shown_unit};
use crate::{Error, ReportInput};
use experiment_design::Factor;
use inference::{Measurement, ModelSurfaces};
use report::{AxisTitle, Grid, Mark, Plot, PlotPoint, design_runs, marked_points, series};
use response_surface::Fit;
use std::collections::BTreeMap;

/// Nodes of the grid of contours in each direction.
const NODES: usize = 81;
const CURVE_POINTS: usize = 11;
/// Half width of a two-sided 95 % interval of a normal distribution, in standard deviations; used where the residuals
/// have no degrees of freedom for Student's t.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// The chart of an observable of the model with a number in the list of surfaces.
pub(crate) fn chart(
    input: &ReportInput<'_>,
    number: usize,
    quantity: &str,
    fit: &Fit,
) -> Result<Plot, Error> {
    let surfaces = &input.calibration.surfaces[number];
    let shown = Shown {
        input,
        fit,
        quantity,
        measured: measured(input, &surfaces.model, quantity),
    };
    match strongest_two(fit) {
        Some(places) => shown.contour(places, runs_of_design(number, surfaces, fit, places)),
        None => Ok(shown.curve(surfaces)),
    }
}

/// What was measured of an observable of a model; `None` if it was not.
pub(crate) fn measured<'a>(
    input: &ReportInput<'a>,
    model: &str,
    quantity: &str,
) -> Option<&'a Measurement> {
    let problem = input.problem;
    let meant = |m: &&Measurement| {
        let name = problem.models.get(m.model).map(|at| at.name.as_str());
        m.observable == quantity && name == Some(model)
    };
    problem.measurements.iter().find(meant)
}

/// The two parameters of the contours: their places in the fit, the stronger first; none for a single one.
pub(crate) fn strongest_two(fit: &Fit) -> Option<[usize; 2]> {
    let size = |k: usize| {
        fit.terms
            .get(fit.factors[k].symbol())
            .map_or(0.0, |row| row.coef.abs())
    };
    let mut places: Vec<usize> = (0..fit.factors.len()).collect();
    places.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    match places.as_slice() {
        [first, second, ..] => Some([*first, *second]),
        _ => None,
    }
}

/// The estimate in the order of the parameters of a fit; the middle of the box for a parameter without one.
pub(crate) fn estimate_of(input: &ReportInput<'_>, fit: &Fit) -> Vec<f64> {
    let value = |f: &Factor| {
        let mut all = input.calibration.parameters.iter();
        all.find(|p| p.symbol == f.symbol())
            .map_or(f.mid(), |p| p.value)
    };
    fit.factors.iter().map(value).collect()
}

/// Evenly spaced values from `low` to `high`, both included.
pub(crate) fn evenly(low: f64, high: f64, n: usize) -> Vec<f64> {
    let share = |k: usize| k as f64 / (n - 1) as f64;
    (0..n).map(|k| low + (high - low) * share(k)).collect()
}

/// Variance of the fitted mean at a coded point, squared unit of the response; 0 without an error variance.
pub(crate) fn variance_of_mean(fit: &Fit, coded: &[f64]) -> f64 {
    fit.best_error_variance()
        .map_or(0.0, |error| error.variance * fit.leverage(coded))
}

/// A fit with what it is held against.
struct Shown<'a> {
    input: &'a ReportInput<'a>,
    fit: &'a Fit,
    /// Name of the observable.
    quantity: &'a str,
    /// The measured value.
    measured: Option<&'a Measurement>,
}

impl Shown<'_> {
    fn response(&self) -> AxisTitle {
        let (words, unit) = observable(self.quantity);
        AxisTitle::new(words, unit)
    }

    /// Half width of a 95 % interval in standard errors.
    fn limit(&self) -> f64 {
        self.fit.t_crit_975.unwrap_or(NORMAL_975)
    }

    /// The fitted curve with its 95 % interval, the means of the runs, and the measured band.
    fn curve(&self, surfaces: &ModelSurfaces) -> Plot {
        let factor = &self.fit.factors[0];
        let point = |at: f64| {
            let coded = self.fit.coded(&[at]);
            let half = self.limit() * variance_of_mean(self.fit, &coded).sqrt();
            PlotPoint::new(at, self.fit.value(&coded)).with_error(half)
        };
        let curve = evenly(factor.low(), factor.high(), CURVE_POINTS);
        let values = surfaces.values.get(self.quantity);
        let runs = values.map_or_else(Vec::new, |v| means_by_level(&surfaces.points, v));
        let band = self.measured.map_or_else(Vec::new, |m| {
            let half = NORMAL_975 * m.variance().sqrt();
            vec![
                Mark::level("measured ± 95 %", m.mean + half),
                Mark::level("", m.mean),
                Mark::level("", m.mean - half),
            ]
        });
        Plot::new(title(factor).into(), self.response().into())
            .with_all(series(
                0,
                "fitted, ± 95 %",
                curve.into_iter().map(point).collect(),
            ))
            .with_all(series(1, "mean of the runs, ± sd", runs))
            .with_all(band)
    }

    /// Contours over two parameters, the others at the estimate.
    fn contour(&self, [across, up]: [usize; 2], runs: Vec<PlotPoint>) -> Result<Plot, Error> {
        let fit = self.fit;
        let [x, y] = [&fit.factors[across], &fit.factors[up]];
        let mut grid = Grid {
            x: title(x),
            y: title(y),
            response: self.response(),
            x_values: evenly(x.low(), x.high(), NODES),
            y_values: evenly(y.low(), y.high(), NODES),
            values: Vec::new(),
        };
        let mut natural = estimate_of(self.input, fit);
        let mut region = Vec::new();
        for at_y in &grid.y_values {
            for at_x in &grid.x_values {
                (natural[across], natural[up]) = (*at_x, *at_y);
                let coded = fit.coded(&natural);
                grid.values.push(fit.value(&coded));
                region.extend(self.inside(&coded));
            }
        }
        let mut also = Vec::new();
        if let Some(m) = self.measured {
            also.extend(grid.region("not told from the measured value (95 %)", &region)?);
            also.extend(grid.bold_line("measured value", m.mean)?);
        }
        also.push(marked_points(inside_points(self.input, [x, y])));
        also.extend(design_runs(runs));
        Ok(grid.contours(also)?)
    }

    /// How far a coded point lies inside the region of points that are not told from the measured value,
    /// t² (s² x'Cx + se²) - (fitted - measured)², in squared units of the response: 0 or above inside.
    fn inside(&self, coded: &[f64]) -> Option<f64> {
        let m = self.measured?;
        let variance = variance_of_mean(self.fit, coded) + m.variance();
        Some(self.limit().powi(2) * variance - (self.fit.value(coded) - m.mean).powi(2))
    }
}

/// Title of the axis of a parameter.
pub(crate) fn title(factor: &Factor) -> AxisTitle {
    let name = match factor.name() {
        "" => factor.symbol().to_owned(),
        name => format!("{}: {name}", factor.symbol()),
    };
    AxisTitle::new(name, shown_unit(factor.unit()))
}

/// The points of the design in the plane of two factors; each opens its runs.
fn runs_of_design(
    number: usize,
    surfaces: &ModelSurfaces,
    fit: &Fit,
    shown: [usize; 2],
) -> Vec<PlotPoint> {
    let place = |k: usize| {
        let symbol = fit.factors[k].symbol();
        surfaces.symbols.iter().position(|known| known == symbol)
    };
    let [Some(x), Some(y)] = shown.map(place) else {
        return Vec::new();
    };
    let run = |point: &DesignPoint<'_>| PlotPoint {
        tip: point.name(&surfaces.symbols),
        link: format!("#{}", point.id(number)),
        ..PlotPoint::new(point.settings[x], point.settings[y])
    };
    design_points(surfaces).iter().map(run).collect()
}

/// Mean and standard deviation (0 for a single run) of the values at each level, in rising order of the level.
fn means_by_level(points: &[Vec<f64>], values: &[f64]) -> Vec<PlotPoint> {
    let mut runs: Vec<(f64, f64)> = points
        .iter()
        .zip(values)
        .filter_map(|(point, value)| Some((*point.first()?, *value)))
        .collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let levels = runs.chunk_by(|a, b| a.0 == b.0);
    let point = |level: &[(f64, f64)]| {
        let n = level.len() as f64;
        let mean = level.iter().map(|(_, y)| y).sum::<f64>() / n;
        let square: f64 = level.iter().map(|(_, y)| (y - mean).powi(2)).sum();
        let sd = if level.len() > 1 {
            (square / (n - 1.0)).sqrt()
        } else {
            0.0
        };
        PlotPoint::new(level[0].0, mean).with_error(sd)
    };
    levels.map(point).collect()
}

/// The estimate and the start where they lie inside the picture.
fn inside_points(input: &ReportInput<'_>, axes: [&Factor; 2]) -> Vec<PlotPoint> {
    let values: BTreeMap<&str, (f64, f64)> = input
        .calibration
        .parameters
        .iter()
        .map(|p| (p.symbol.as_str(), (p.value, p.start)))
        .collect();
    let [x, y] = axes.map(|f| values.get(f.symbol()).copied());
    let (Some(x), Some(y)) = (x, y) else {
        return Vec::new();
    };
    let inside = |f: &Factor, value: f64| (f.low()..=f.high()).contains(&value);
    [("estimate", x.0, y.0), ("start", x.1, y.1)]
        .into_iter()
        .filter(|(_, at_x, at_y)| inside(axes[0], *at_x) && inside(axes[1], *at_y))
        .map(|(name, x, y)| PlotPoint::new(x, y).with_label(name))
        .collect()
}
