//! Plots with every kind of mark, with markup in every text.

use report::{
    Axis, AxisTitle, Error, Format, Grid, Mark, Plot, PlotPoint, Shape, Svg, colour, design_runs,
    half_normal, marked_points, pareto, scatter, series,
};

/// A text that breaks a page if it is not escaped.
pub(crate) const HOSTILE: &str = "</text><b x=\"&'\">";

/// A hostile title.
fn title() -> AxisTitle {
    AxisTitle::new(HOSTILE, HOSTILE)
}

/// Effects of these sizes.
pub(crate) fn effects(values: &[f64]) -> Vec<(String, f64)> {
    values
        .iter()
        .map(|value| (HOSTILE.to_owned(), *value))
        .collect()
}

/// Values at 0, 1, 2 and so on, with error bars in both directions and names.
pub(crate) fn points(values: &[f64]) -> Vec<PlotPoint> {
    let point = |(index, value): (usize, &f64)| PlotPoint {
        x_error: 0.1,
        ..PlotPoint::new(index as f64, *value)
            .with_error(0.1)
            .with_label(HOSTILE)
    };
    values.iter().enumerate().map(point).collect()
}

/// Two series with a level.
pub(crate) fn lines(values: &[f64]) -> Plot {
    Plot::new(title().into(), title().into())
        .with_all(series(0, HOSTILE, points(values)))
        .with_all(series(1, HOSTILE, points(values)))
        .with(Mark::level(HOSTILE, 1.0))
}

/// A square with a dashed diagonal.
pub(crate) fn square(values: &[f64]) -> Plot {
    let mut plot = scatter(title(), title(), points(values), points(values))
        .with(Mark::dashed(HOSTILE, vec![[-1e9, -1e9], [1e9, 1e9]]));
    plot.format = Format::Square(430.0);
    plot
}

/// Level bars by name, with a band and upright limits.
pub(crate) fn bars(values: &[f64]) -> Plot {
    let rows: Vec<(usize, [f64; 2])> = values.iter().map(|x| [0.0, *x]).enumerate().collect();
    let names = values.iter().map(|_| HOSTILE.to_owned()).collect();
    Plot::new(title().into(), Axis::Names(names))
        .with(Mark::bars(HOSTILE, colour::BLUE, &rows))
        .with(Mark::upright(HOSTILE, 2.0))
        .with(Mark::upright("b", 2.1))
}

/// A grid of two columns with these values.
pub(crate) fn grid(values: &[f64]) -> Grid {
    let rows = values.len() / 2;
    Grid {
        x: title(),
        y: title(),
        response: title(),
        x_values: vec![0.0, 1.0],
        y_values: (0..rows).map(|row| row as f64).collect(),
        values: values[..2 * rows].to_vec(),
    }
}

/// Contours of these values with everything that may be shown over them.
pub(crate) fn contours(values: &[f64]) -> Result<Plot, Error> {
    let grid = grid(values);
    let field: Vec<f64> = grid.values.iter().map(|value| value - 1.0).collect();
    let point = || PlotPoint::new(0.5, 0.5).with_label(HOSTILE);
    let run = PlotPoint {
        tip: HOSTILE.into(),
        link: "#section-1".into(),
        ..point()
    };
    let mut also = grid.region(HOSTILE, &field)?.to_vec();
    also.extend(grid.bold_line(HOSTILE, 1.0)?);
    also.push(marked_points(vec![point()]));
    also.extend(design_runs(vec![run.clone(), run]));
    grid.contours(also)
}

/// Every kind of plot of the same values.
pub(crate) fn all(values: &[f64]) -> Vec<(&'static str, Result<Svg, Error>)> {
    let limits = [(HOSTILE, 0.5), ("b", 2.1)];
    let effects = effects(values);
    let hidden = Plot::new(Axis::Hidden([0.0, 8.0]), Axis::Hidden([-20.0, 20.0])).with(
        Mark::points("", Shape::Diamond, colour::INK, points(values)),
    );
    vec![
        ("pareto", pareto(&title(), &effects, &limits).draw()),
        (
            "half-normal",
            half_normal(&title(), &effects, Some(0.4), &limits).draw(),
        ),
        ("bars", bars(values).draw()),
        ("contours", contours(values).and_then(|plot| plot.draw())),
        ("square", square(values).draw()),
        ("lines", lines(values).draw()),
        ("hidden", hidden.draw()),
    ]
}
