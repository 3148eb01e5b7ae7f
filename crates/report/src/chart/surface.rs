//! A response over two factors, seen from above at an angle.

use serde::{Deserialize, Serialize};

use crate::chart::AxisTitle;
use crate::check::Field;
use crate::geometry::{Point, at};
use crate::style::{AXIS, INK, SMALL_TEXT, TEXT, WIDTH, sequential_colour};
use crate::svg::{Anchor, Canvas, Stroke, TextStyle};
use crate::ticks::{Domain, short};
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "surface chart";
/// Height of the picture, px.
const HEIGHT: f64 = 460.0;
/// Turn of the box about its upright axis, degrees.
const TURN: f64 = 35.0;
/// Height of the eye over the floor, degrees.
const EYE: f64 = 28.0;

/// A surface of responses over a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// First factor.
    pub x: AxisTitle,
    /// Second factor.
    pub y: AxisTitle,
    /// The response.
    pub response: AxisTitle,
    /// Columns of the grid, ascending, in the unit of the first factor.
    pub x_values: Vec<f64>,
    /// Rows of the grid, ascending, in the unit of the second factor.
    pub y_values: Vec<f64>,
    /// Responses, shape (rows, columns) row by row, in the unit of the response.
    pub values: Vec<f64>,
}

impl Surface {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] for fewer than two rows or columns, a wrong number of responses, or a number that
    /// is not finite.
    pub fn draw(&self) -> Result<Svg, Error> {
        Field::new(CHART, "x values").at_least(2, self.x_values.len())?;
        Field::new(CHART, "y values").at_least(2, self.y_values.len())?;
        Field::new(CHART, "x values").ascending(&self.x_values)?;
        Field::new(CHART, "y values").ascending(&self.y_values)?;
        let cells = self.x_values.len() * self.y_values.len();
        Field::new(CHART, "responses").at_least(cells, self.values.len())?;
        Field::new(CHART, "response").finite(self.values.iter().copied())?;
        let view = View {
            x: Domain::tight(self.x_values.iter().copied()),
            y: Domain::tight(self.y_values.iter().copied()),
            z: Domain::around(self.values.iter().copied()),
        };
        let mut canvas = Canvas::new(WIDTH, HEIGHT);
        view.draw_floor(&mut canvas);
        self.draw_patches(&mut canvas, &view);
        self.draw_labels(&mut canvas, &view);
        let description = format!(
            "{} over {} and {}",
            self.response.text(""),
            self.x.text(""),
            self.y.text("")
        );
        canvas.finish(CHART, &description)
    }

    /// The patches from the farthest to the nearest.
    fn draw_patches(&self, canvas: &mut Canvas, view: &View) {
        let columns = self.x_values.len();
        let value = |i: usize, j: usize| self.values[i * columns + j];
        let mut patches: Vec<(usize, usize)> = (0..self.y_values.len() - 1)
            .flat_map(|i| (0..columns - 1).map(move |j| (i, j)))
            .collect();
        patches.sort_by(|a, b| {
            let depth = |p: &(usize, usize)| view.depth(self.x_values[p.1], self.y_values[p.0]);
            depth(b).total_cmp(&depth(a))
        });
        for (i, j) in patches {
            let corner =
                |i: usize, j: usize| view.place(self.x_values[j], self.y_values[i], value(i, j));
            let outline = vec![
                corner(i, j),
                corner(i, j + 1),
                corner(i + 1, j + 1),
                corner(i + 1, j),
            ];
            let mean =
                0.25 * (value(i, j) + value(i, j + 1) + value(i + 1, j) + value(i + 1, j + 1));
            let share = (mean - view.z.low) / (view.z.high - view.z.low);
            let closed: Vec<Point> = outline.iter().chain(&outline[..1]).copied().collect();
            canvas.area(&[outline], &sequential_colour(share), 1.0);
            canvas.polyline(&closed, &Stroke::solid(INK, 0.35));
        }
    }

    /// Titles and the ends of the axes.
    fn draw_labels(&self, canvas: &mut Canvas, view: &View) {
        let (x, y, z) = (view.x, view.y, view.z);
        let middle = |d: Domain| 0.5 * (d.low + d.high);
        let small = |anchor| TextStyle {
            size: SMALL_TEXT,
            ..TextStyle::small(anchor)
        };
        let title = |anchor| TextStyle {
            size: TEXT,
            ..TextStyle::small(anchor)
        };
        let below = |p: Point, dx: f64, dy: f64| at(p.x + dx, p.y + dy);
        let floor = |x: f64, y: f64| view.place(x, y, z.low);
        canvas.text(
            below(floor(middle(x), y.low), -16.0, 34.0),
            &self.x.text(""),
            &title(Anchor::End),
        );
        canvas.text(
            below(floor(x.high, middle(y)), 16.0, 34.0),
            &self.y.text(""),
            &title(Anchor::Start),
        );
        canvas.text(
            below(floor(x.low, y.low), 4.0, 18.0),
            &short(x.low),
            &small(Anchor::Middle),
        );
        canvas.text(
            below(floor(x.high, y.low), -10.0, 18.0),
            &short(x.high),
            &small(Anchor::End),
        );
        canvas.text(
            below(floor(x.high, y.low), 10.0, 18.0),
            &short(y.low),
            &small(Anchor::Start),
        );
        canvas.text(
            below(floor(x.high, y.high), 6.0, 14.0),
            &short(y.high),
            &small(Anchor::Start),
        );
        let upright = |value: f64| below(view.place(x.low, y.low, value), -6.0, 0.0);
        canvas.text(upright(z.low), &short(z.low), &small(Anchor::End));
        canvas.text(upright(z.high), &short(z.high), &small(Anchor::End));
        canvas.text(
            at(12.0, 18.0),
            &self.response.text(""),
            &title(Anchor::Start),
        );
    }
}

/// The box of values and how it is seen.
struct View {
    /// First factor.
    x: Domain,
    /// Second factor.
    y: Domain,
    /// Response.
    z: Domain,
}

impl View {
    /// Outline of the floor and the upright axis.
    fn draw_floor(&self, canvas: &mut Canvas) {
        let stroke = Stroke::solid(AXIS, 1.0);
        let z = self.z.low;
        let corner = |x: f64, y: f64| self.place(x, y, z);
        let (x, y) = (self.x, self.y);
        let corners = [
            corner(x.low, y.low),
            corner(x.high, y.low),
            corner(x.high, y.high),
            corner(x.low, y.high),
            corner(x.low, y.low),
        ];
        canvas.polyline(&corners, &stroke);
        // Upright at the left corner, where nothing can hide it.
        canvas.line(corners[0], self.place(x.low, y.low, self.z.high), &stroke);
    }

    /// Share of a value in a domain, -1/2 to 1/2.
    fn share(domain: Domain, value: f64) -> f64 {
        (value - domain.low) / (domain.high - domain.low) - 0.5
    }

    /// Place on the floor after the turn: to the right, and away from the eye.
    fn turned(&self, x: f64, y: f64) -> (f64, f64) {
        let (a, b) = (Self::share(self.x, x), Self::share(self.y, y));
        let (sine, cosine) = TURN.to_radians().sin_cos();
        (a * cosine + b * sine, b * cosine - a * sine)
    }

    /// Distance from the eye, up to a constant.
    fn depth(&self, x: f64, y: f64) -> f64 {
        self.turned(x, y).1
    }

    /// Place on the paper.
    fn place(&self, x: f64, y: f64, z: f64) -> Point {
        let (right, away) = self.turned(x, y);
        let (sine, cosine) = EYE.to_radians().sin_cos();
        let up = 0.62 * Self::share(self.z, z) * cosine + away * sine;
        at(0.5 * WIDTH + 350.0 * right, 0.5 * HEIGHT - 8.0 - 350.0 * up)
    }
}
