//! Points that are not joined, with a line to read them against.

use serde::{Deserialize, Serialize};

use crate::chart::contour::MarkedPoint;
use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Point, at};
use crate::label_places::LabelPlaces;
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{BLUE, INK, PAPER, VERMILION, WIDTH};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "scatter chart";

/// Points up to which all have their names, and above which only those beyond all levels.
const MOST_NAMES: usize = 40;
/// Points above which they are small and have no rim.
const MOST_MARKERS: usize = 150;

/// Points over two axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Horizontal axis.
    pub x: AxisTitle,
    /// Vertical axis.
    pub y: AxisTitle,
    /// Places of the points, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// Names of the points, such as numbers of runs, one each; empty for none. Of more than 40 points only those beyond
    /// the levels are named.
    pub names: Vec<String>,
    /// Points that stand out, with their names.
    pub marked: Vec<MarkedPoint>,
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
        Field::new(CHART, "x of point").finite(self.points.iter().map(|p| p[0]))?;
        Field::new(CHART, "y of point").finite(self.points.iter().map(|p| p[1]))?;
        if !self.names.is_empty() {
            let count = self.points.len();
            Field::new(CHART, "names").length(count, "point", self.names.len())?;
        }
        let marked = || self.marked.iter().map(|p| [p.x, p.y]);
        Field::new(CHART, "marked point").finite(marked().flatten())?;
        Field::new(CHART, "line").finite(self.line.iter().flatten().copied())?;
        Field::new(CHART, "level").finite(self.levels.iter().map(|level| level.value))?;
        let all = || self.points.iter().copied().chain(marked());
        let x = Domain::around(all().map(|p| p[0]));
        let levels = self.levels.iter().map(|level| level.value);
        let y = Domain::around(all().map(|p| p[1]).chain(levels));
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
        let places: Vec<Point> = self.points.iter().map(|p| plot.place(p[0], p[1])).collect();
        let mut names = LabelPlaces::new(plot.area);
        if places.len() <= MOST_MARKERS {
            for &place in &places {
                names.reserve_marker(place);
            }
        }
        for level in &self.levels {
            let place = plot.y.pixel(level.value);
            let ends = [at(plot.area.left, place), at(plot.area.right, place)];
            canvas.line(ends[0], ends[1], &Stroke::dashed(VERMILION, 1.2));
            names.write_on_level(&mut canvas, place, &level.name);
        }
        self.draw_points(&mut canvas, &places, &mut names);
        for point in &self.marked {
            let place = plot.place(point.x, point.y);
            canvas.marker(Shape::Diamond, place, INK, PAPER);
            names.write(&mut canvas, place, &point.name, INK);
        }
        canvas.end_clip();
        plot.draw_axes(&mut canvas);
        let description = format!("{} against {}", self.y.text(""), self.x.text(""));
        canvas.finish(CHART, &description)
    }

    /// Draws the points and their names.
    fn draw_points(&self, canvas: &mut Canvas, places: &[Point], names: &mut LabelPlaces) {
        if places.len() > MOST_MARKERS {
            canvas.dots(places, BLUE);
        } else {
            for &place in places {
                canvas.marker(Shape::of_series(0), place, BLUE, PAPER);
            }
        }
        let levels = self.levels.iter().map(|level| level.value);
        let (low, high) = (
            levels.clone().fold(f64::INFINITY, f64::min),
            levels.fold(f64::NEG_INFINITY, f64::max),
        );
        let beyond = |y: f64| low < high && !(low..=high).contains(&y);
        let named = self.points.iter().zip(places).zip(&self.names);
        for (([_, y], &place), name) in named {
            if places.len() <= MOST_NAMES || beyond(*y) {
                names.write(canvas, place, name, INK);
            }
        }
    }
}
