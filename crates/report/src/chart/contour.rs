//! A response surface over two factors.

use serde::{Deserialize, Serialize};

use crate::chart::design_runs::{self, DesignRun};
use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Point, Rect, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::marching_squares::{ContourLine, Lattice, area_at_or_above, contour_lines};
use crate::plot::{AxisPlan, GridStyle, Outside, Plot};
use crate::style::{AXIS, INK, PAPER, SMALL_TEXT, TEXT, VERMILION, WIDTH, sequential_colour};
use crate::svg::{Anchor, Canvas, Halo, Shape, Stroke, TextStyle};
use crate::text::text_width;
use crate::ticks::{Domain, Ticks};
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "contour chart";
/// Width of the colour bar, px.
const BAR: f64 = 16.0;

/// A named point of the plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarkedPoint {
    /// What the point is.
    pub name: String,
    /// Place on the horizontal axis, in its unit.
    pub x: f64,
    /// Place on the vertical axis, in its unit.
    pub y: f64,
}

/// Filled contours of a response over two factors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contour {
    /// Horizontal axis.
    pub x: AxisTitle,
    /// Vertical axis.
    pub y: AxisTitle,
    /// The response.
    pub response: AxisTitle,
    /// Columns of the grid, ascending, in the unit of the horizontal axis.
    pub x_values: Vec<f64>,
    /// Rows of the grid, ascending, in the unit of the vertical axis.
    pub y_values: Vec<f64>,
    /// Responses, shape (rows, columns) row by row, in the unit of the response.
    pub values: Vec<f64>,
    /// Contour that is drawn bold, in the unit of the response.
    pub target: Option<Level>,
    /// Name of the shaded region; empty for none.
    pub region_name: String,
    /// The region is where this field is at or above 0; same shape as the responses, empty for
    /// none. Its zero line is interpolated, so give a smooth field where there is one.
    pub region: Vec<f64>,
    /// Named points.
    pub points: Vec<MarkedPoint>,
    /// Runs behind the response; empty for none.
    pub runs: Vec<DesignRun>,
}

impl Contour {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] for a grid of fewer than 2 x 2 values, axes that do not ascend, lists that do not
    /// match the grid, or a number that is not finite.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let range = Domain::tight(self.values.iter().copied());
        let levels = Ticks::of(range, 8.0);
        let entries = self.legend();
        let top = 8.0 + legend_height(&entries, WIDTH - 80.0) + 8.0;
        let bar_room = BAR + 16.0 + levels.width(SMALL_TEXT) + 12.0 + TEXT + 10.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - bar_room,
            bottom: 474.0,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, 480.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 80.0, &entries);
        canvas.begin_clip(&plot.area);
        self.draw_bands(&mut canvas, &plot, &levels, range);
        self.draw_region(&mut canvas, &plot);
        let lines = self.draw_lines(&mut canvas, &plot, &levels);
        let mut names = LabelPlaces::new(plot.area.grown(-2.0));
        for point in &self.points {
            names.reserve_marker(plot.place(point.x, point.y));
        }
        design_runs::reserve(&plot, &mut names, &self.runs);
        self.draw_points(&mut canvas, &plot, &mut names);
        draw_level_names(&mut canvas, &lines, &mut names);
        canvas.end_clip();
        plot.draw_axes(&mut canvas);
        draw_frame(&mut canvas, &plot.area);
        design_runs::draw(&mut canvas, &plot, &self.runs);
        self.draw_bar(&mut canvas, &plot, &levels, range);
        let [z, x, y] = [&self.response, &self.x, &self.y].map(|title| title.text(""));
        canvas.finish(CHART, &format!("Contours of {z} over {x} and {y}"))
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "columns").at_least(2, self.x_values.len())?;
        Field::new(CHART, "rows").at_least(2, self.y_values.len())?;
        Field::new(CHART, "column").ascending(&self.x_values)?;
        Field::new(CHART, "row").ascending(&self.y_values)?;
        let nodes = self.x_values.len() * self.y_values.len();
        Field::new(CHART, "values").length(nodes, "node of the grid", self.values.len())?;
        Field::new(CHART, "value").finite(self.values.iter().copied())?;
        if !self.region.is_empty() {
            Field::new(CHART, "region").length(nodes, "node of the grid", self.region.len())?;
            Field::new(CHART, "region value").finite(self.region.iter().copied())?;
        }
        Field::new(CHART, "target").finite(self.target.iter().map(|target| target.value))?;
        Field::new(CHART, "x of point").finite(self.points.iter().map(|point| point.x))?;
        Field::new(CHART, "y of point").finite(self.points.iter().map(|point| point.y))?;
        Field::new(CHART, "place of a run").finite(self.runs.iter().flat_map(|run| [run.x, run.y]))
    }

    /// What the marks mean.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let mut entries = Vec::new();
        if let Some(target) = &self.target {
            let sample = Sample::Line(Stroke::solid(VERMILION, 3.0));
            entries.push(LegendEntry {
                sample,
                name: &target.name,
            });
        }
        if !self.region.is_empty() {
            let sample = Sample::Patch(REGION.0, 2.0 * REGION.1);
            entries.push(LegendEntry {
                sample,
                name: &self.region_name,
            });
        }
        entries.extend(design_runs::legend_entry(&self.runs));
        entries
    }

    /// Plans the axes: the grid fills the plot, and a point outside of the grid widens it.
    fn plot(&self, outside: Outside) -> Plot {
        let points = |place: fn(&MarkedPoint) -> f64| self.points.iter().map(place);
        let runs = |place: fn(&DesignRun) -> f64| self.runs.iter().map(place);
        let x = widened(&self.x_values, points(|p| p.x).chain(runs(|run| run.x)));
        let y = widened(&self.y_values, points(|p| p.y).chain(runs(|run| run.y)));
        let bare = |plan: AxisPlan| AxisPlan {
            grid: GridStyle::Lines,
            ..plan
        };
        Plot::new(
            outside,
            bare(AxisPlan::numbers(&self.x, x, 6.0)),
            bare(AxisPlan::numbers(&self.y, y, 7.0)),
        )
    }

    /// The responses as a lattice.
    fn lattice<'a>(&'a self, values: &'a [f64]) -> Lattice<'a> {
        Lattice {
            x: &self.x_values,
            y: &self.y_values,
            values,
        }
    }

    /// Fills the plane: the lowest colour first, each higher band over it, so no seams show.
    fn draw_bands(&self, canvas: &mut Canvas, plot: &Plot, levels: &Ticks, range: Domain) {
        let lattice = self.lattice(&self.values);
        // Every value lies above the first level, so the first band is the whole grid.
        let bands = [f64::MIN].into_iter().chain(levels.values.iter().copied());
        for (index, level) in bands.enumerate() {
            let colour = band_colour(index, &levels.values, range);
            let loops = pixels(&area_at_or_above(&lattice, level), plot);
            canvas.area(&loops, &colour, 1.0);
        }
    }

    /// Shades the region and draws its edge.
    fn draw_region(&self, canvas: &mut Canvas, plot: &Plot) {
        if self.region.is_empty() {
            return;
        }
        let lattice = self.lattice(&self.region);
        let loops = pixels(&area_at_or_above(&lattice, 0.0), plot);
        canvas.area(&loops, REGION.0, REGION.1);
        for line in pixels(&contour_lines(&lattice, 0.0), plot) {
            canvas.polyline(&line, &Stroke::dashed(INK, 1.0));
        }
    }

    /// Draws the lines between the bands and the bold one; gives back the former with names.
    fn draw_lines(&self, canvas: &mut Canvas, plot: &Plot, levels: &Ticks) -> Vec<NamedLine> {
        let lattice = self.lattice(&self.values);
        let mut named = Vec::new();
        for (&level, name) in levels.values.iter().zip(&levels.labels) {
            let lines = pixels(&contour_lines(&lattice, level), plot);
            for line in &lines {
                canvas.polyline(line, &Stroke::solid(PAPER, 0.9));
            }
            named.extend(lines.into_iter().map(|points| NamedLine {
                name: name.clone(),
                points,
            }));
        }
        if let Some(target) = &self.target {
            for line in pixels(&contour_lines(&lattice, target.value), plot) {
                canvas.polyline(&line, &Stroke::solid(PAPER, 5.0));
                canvas.polyline(&line, &Stroke::solid(VERMILION, 3.0));
            }
        }
        named
    }

    /// Draws the named points.
    fn draw_points(&self, canvas: &mut Canvas, plot: &Plot, names: &mut LabelPlaces) {
        for point in &self.points {
            let place = plot.place(point.x, point.y);
            names.write(canvas, place, &point.name, INK);
        }
        for point in &self.points {
            canvas.marker(Shape::Circle, plot.place(point.x, point.y), INK, PAPER);
        }
    }

    /// Draws the colour bar with the levels and the name of the response.
    fn draw_bar(&self, canvas: &mut Canvas, plot: &Plot, levels: &Ticks, range: Domain) {
        let left = plot.area.right + 16.0;
        let bar = Rect {
            left,
            right: left + BAR,
            ..plot.area
        };
        let height = |value: f64| {
            let share = (value - range.low) / (range.high - range.low);
            bar.bottom - share * bar.height()
        };
        let mut ends = vec![range.low];
        ends.extend(&levels.values);
        ends.push(range.high);
        for (index, pair) in ends.windows(2).enumerate() {
            let [top, bottom] = [height(pair[1]), height(pair[0])];
            canvas.rect(
                &Rect { top, bottom, ..bar },
                &band_colour(index, &levels.values, range),
                1.0,
            );
        }
        draw_frame(canvas, &bar);
        let stroke = Stroke::solid(AXIS, 1.0);
        for (&value, label) in levels.values.iter().zip(&levels.labels) {
            let y = height(value);
            canvas.line(at(bar.right, y), at(bar.right + 4.0, y), &stroke);
            canvas.text(
                at(bar.right + 8.0, y),
                label,
                &TextStyle::small(Anchor::Start),
            );
        }
        if let Some(target) = &self.target
            && (range.low..=range.high).contains(&target.value)
        {
            let y = height(target.value);
            canvas.line(
                at(bar.left - 3.0, y),
                at(bar.right + 3.0, y),
                &Stroke::solid(VERMILION, 3.0),
            );
        }
        let plan = AxisPlan {
            title: self.response.clone(),
            domain: range,
            ticks: levels.clone(),
            grid: GridStyle::Bare,
        };
        let x = bar.right + 8.0 + levels.width(SMALL_TEXT) + 8.0 + 0.5 * TEXT;
        let style = TextStyle {
            size: TEXT,
            turn: -90.0,
            ..TextStyle::small(Anchor::Middle)
        };
        canvas.text(
            at(x, 0.5 * (bar.top + bar.bottom)),
            &plan.title_text(),
            &style,
        );
    }
}

/// Colour and opacity of the region.
const REGION: (&str, f64) = ("#222222", 0.16);

/// A contour line in pixels and what stands on it.
#[derive(Debug)]
struct NamedLine {
    /// The level as text.
    name: String,
    /// Points, px.
    points: Vec<Point>,
}

/// Lines in pixels.
fn pixels(lines: &[ContourLine], plot: &Plot) -> Vec<Vec<Point>> {
    let place = |point: &[f64; 2]| plot.place(point[0], point[1]);
    lines
        .iter()
        .map(|line| line.points.iter().map(place).collect())
        .collect()
}

/// What the axis shows: the grid, and a margin beyond the points outside of it.
fn widened(grid: &[f64], points: impl Iterator<Item = f64>) -> Domain {
    let edge = Domain::tight(grid.iter().copied());
    let all = Domain::tight(grid.iter().copied().chain(points));
    let room = 0.05 * (all.high - all.low);
    Domain {
        low: if all.low < edge.low {
            all.low - room
        } else {
            edge.low
        },
        high: if all.high > edge.high {
            all.high + room
        } else {
            edge.high
        },
    }
}

/// Colour of the band with a number: that of the middle of the band on the scale.
fn band_colour(index: usize, levels: &[f64], range: Domain) -> String {
    let low = index
        .checked_sub(1)
        .and_then(|below| levels.get(below))
        .copied();
    let high = levels.get(index).copied();
    let middle = 0.5 * (low.unwrap_or(range.low) + high.unwrap_or(range.high));
    sequential_colour((middle - range.low) / (range.high - range.low))
}

/// Draws a thin frame.
fn draw_frame(canvas: &mut Canvas, area: &Rect) {
    let Rect {
        left,
        top,
        right,
        bottom,
    } = *area;
    let corners = [
        at(left, top),
        at(right, top),
        at(right, bottom),
        at(left, bottom),
        at(left, top),
    ];
    canvas.polyline(&corners, &Stroke::solid(AXIS, 1.0));
}

/// Writes each level on its longest line, along the line, where nothing else stands.
fn draw_level_names(canvas: &mut Canvas, lines: &[NamedLine], names: &mut LabelPlaces) {
    for line in lines {
        let width = text_width(&line.name, SMALL_TEXT - 1.0);
        let total = length(&line.points);
        if total < 2.5 * width {
            continue;
        }
        for share in [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88] {
            let ends = [-0.5, 0.5].map(|half| along(&line.points, share * total + half * width));
            let [Some(from), Some(to)] = ends else {
                continue;
            };
            let middle = at(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
            let mut turn = (to.y - from.y).atan2(to.x - from.x).to_degrees();
            if turn.abs() > 90.0 {
                turn -= 180.0 * turn.signum();
            }
            let (sine, cosine) = turn.to_radians().sin_cos();
            let half_width = 0.5 * (width * cosine.abs() + SMALL_TEXT * sine.abs());
            let half_height = 0.5 * (width * sine.abs() + SMALL_TEXT * cosine.abs());
            let wanted = Rect {
                left: middle.x - half_width,
                right: middle.x + half_width,
                top: middle.y - half_height,
                bottom: middle.y + half_height,
            };
            if names.take(wanted) {
                let style = TextStyle {
                    size: SMALL_TEXT - 1.0,
                    turn,
                    halo: Halo::Paper,
                    ..TextStyle::small(Anchor::Middle)
                };
                canvas.text(middle, &line.name, &style);
                break;
            }
        }
    }
}

/// Length of a line, px.
fn length(points: &[Point]) -> f64 {
    points
        .windows(2)
        .map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y))
        .sum()
}

/// Point of a line at a distance from its beginning, px.
fn along(points: &[Point], distance: f64) -> Option<Point> {
    let mut left = distance;
    for pair in points.windows(2) {
        let &[from, to] = pair else { return None };
        let piece = (to.x - from.x).hypot(to.y - from.y);
        if left <= piece && piece > 0.0 {
            let share = left / piece;
            return Some(at(
                from.x + share * (to.x - from.x),
                from.y + share * (to.y - from.y),
            ));
        }
        left -= piece;
    }
    None
}
