//! Points that are not joined, with a line to read them against.

use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::at;
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{BLUE, INK, PAPER, VERMILION, WIDTH};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "scatter chart";

/// Points over two axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Horizontal axis.
    pub x: AxisTitle,
    /// Vertical axis.
    pub y: AxisTitle,
    /// Places of the points, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// Intercept and slope of a line to read the points against.
    pub line: Option<[f64; 2]>,
    /// Named lines across the chart, in the unit of the vertical axis.
    pub levels: Vec<Level>,
}

impl Scatter {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any point or for a number that is not finite.
    pub fn draw(&self) -> Result<Svg, Error> {
        Field::new(CHART, "points").at_least(1, self.points.len())?;
        Field::new(CHART, "point").finite(self.points.iter().flatten().copied())?;
        Field::new(CHART, "line").finite(self.line.iter().flatten().copied())?;
        Field::new(CHART, "level").finite(self.levels.iter().map(|level| level.value))?;
        let x = Domain::around(self.points.iter().map(|p| p[0]));
        let levels = self.levels.iter().map(|level| level.value);
        let y = Domain::around(self.points.iter().map(|p| p[1]).chain(levels));
        let outside = Outside {
            left: 8.0,
            top: 16.0,
            right: WIDTH - 20.0,
            bottom: 404.0,
        };
        let plot = Plot::new(
            outside,
            AxisPlan::numbers(&self.x, x, 7.0),
            AxisPlan::numbers(&self.y, y, 7.0),
        );
        let mut canvas = Canvas::new(WIDTH, 410.0);
        plot.draw_grid(&mut canvas);
        canvas.begin_clip(&plot.area);
        if let Some([intercept, slope]) = self.line {
            let end = |x: f64| plot.place(x, intercept + slope * x);
            canvas.line(end(x.low), end(x.high), &Stroke::dashed(INK, 1.2));
        }
        for level in &self.levels {
            let place = plot.y.pixel(level.value);
            let ends = [at(plot.area.left, place), at(plot.area.right, place)];
            canvas.line(ends[0], ends[1], &Stroke::dashed(VERMILION, 1.2));
        }
        for [x, y] in &self.points {
            canvas.marker(Shape::of_series(0), plot.place(*x, *y), BLUE, PAPER);
        }
        canvas.end_clip();
        plot.draw_axes(&mut canvas);
        let description = format!("{} against {}", self.y.text(""), self.x.text(""));
        canvas.finish(CHART, &description)
    }
}
