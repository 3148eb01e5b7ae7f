//! Series of points with error bars over a common axis.

use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Point, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot, draw_error_bar};
use crate::style::{INK, WIDTH, series_colour};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "line chart";

/// One point of a series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// Place on the horizontal axis, in its unit.
    pub x: f64,
    /// Value, in the unit of the vertical axis.
    pub y: f64,
    /// Half length of the error bar, in the unit of the vertical axis; 0 for none.
    pub error: f64,
}

impl SeriesPoint {
    /// A point with the half length of its error bar (0 for none), in the units of the axes.
    pub fn new(x: f64, y: f64, error: f64) -> Self {
        Self { x, y, error }
    }
}

/// A named series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// What the series is, for the legend.
    pub name: String,
    /// Its points in the order in which they are joined.
    pub points: Vec<SeriesPoint>,
}

/// Series of points with error bars; series differ in colour and in the shape of their marks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineSeries {
    /// Horizontal axis.
    pub x: AxisTitle,
    /// Vertical axis.
    pub y: AxisTitle,
    /// The series.
    pub series: Vec<Series>,
    /// Named lines across the chart, in the unit of the vertical axis.
    pub levels: Vec<Level>,
}

impl LineSeries {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any point or for a number that is not finite or a negative error.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let entries: Vec<LegendEntry<'_>> = self
            .series
            .iter()
            .enumerate()
            .map(|(index, series)| {
                let stroke = Stroke::solid(series_colour(index), 1.8);
                let sample = Sample::LineMarker(stroke, Shape::of_series(index));
                LegendEntry {
                    sample,
                    name: &series.name,
                }
            })
            .collect();
        let top = 8.0 + legend_height(&entries, WIDTH - 80.0) + 8.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - 20.0,
            bottom: 404.0,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, 410.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 80.0, &entries);
        plot.draw_grid(&mut canvas);
        for (index, series) in self.series.iter().enumerate() {
            draw_series(&mut canvas, &plot, series, index);
        }
        plot.draw_axes(&mut canvas);
        self.draw_levels(&mut canvas, &plot);
        let description = format!("{} against {}", self.y.text(""), self.x.text(""));
        canvas.finish(CHART, &description)
    }

    /// All points of all series.
    fn points(&self) -> impl Iterator<Item = &SeriesPoint> {
        self.series.iter().flat_map(|series| &series.points)
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "points").at_least(1, self.points().count())?;
        Field::new(CHART, "x of point").finite(self.points().map(|point| point.x))?;
        Field::new(CHART, "y of point").finite(self.points().map(|point| point.y))?;
        Field::new(CHART, "error of point").not_negative(self.points().map(|point| point.error))?;
        Field::new(CHART, "level").finite(self.levels.iter().map(|level| level.value))
    }

    /// Plans the axes.
    fn plot(&self, outside: Outside) -> Plot {
        let x = Domain::around(self.points().map(|point| point.x));
        let ends = self
            .points()
            .flat_map(|point| [point.y - point.error, point.y + point.error]);
        let y = Domain::around(ends.chain(self.levels.iter().map(|level| level.value)));
        Plot::new(
            outside,
            AxisPlan::numbers(&self.x, x, 7.0),
            AxisPlan::numbers(&self.y, y, 7.0),
        )
    }

    /// Draws the named lines, each name where it covers no series.
    fn draw_levels(&self, canvas: &mut Canvas, plot: &Plot) {
        let mut names = LabelPlaces::new(plot.area);
        for series in &self.series {
            let places = series
                .points
                .iter()
                .map(|point| plot.place(point.x, point.y));
            names.reserve_line(&places.collect::<Vec<_>>());
            for point in &series.points {
                let ends = [point.y - point.error, point.y + point.error];
                names.reserve_line(&ends.map(|y| plot.place(point.x, y)));
                names.reserve_marker(plot.place(point.x, point.y));
            }
        }
        for level in &self.levels {
            let y = plot.y.pixel(level.value);
            names.reserve_line(&[at(plot.area.left, y), at(plot.area.right, y)]);
        }
        for level in &self.levels {
            let y = plot.y.pixel(level.value);
            let (left, right) = (plot.area.left, plot.area.right);
            canvas.line(at(left, y), at(right, y), &Stroke::dashed(INK, 1.2));
            names.write_on_level(canvas, y, &level.name);
        }
    }
}

/// Draws one series: its line, then error bars, then marks.
fn draw_series(canvas: &mut Canvas, plot: &Plot, series: &Series, index: usize) {
    let colour = series_colour(index);
    let places: Vec<Point> = series
        .points
        .iter()
        .map(|point| plot.place(point.x, point.y))
        .collect();
    if places.len() > 1 {
        canvas.polyline(&places, &Stroke::solid(colour, 1.8));
    }
    for point in series.points.iter().filter(|point| point.error > 0.0) {
        let ends = [point.y - point.error, point.y + point.error];
        draw_error_bar(canvas, ends.map(|y| plot.place(point.x, y)), colour);
    }
    for &place in &places {
        canvas.marker(Shape::of_series(index), place, colour, colour);
    }
}
