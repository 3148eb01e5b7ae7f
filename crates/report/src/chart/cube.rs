//! Responses at the corners of three factors, as a cube.

use serde::{Deserialize, Serialize};

use crate::chart::AxisTitle;
use crate::check::Field;
use crate::geometry::{Point, at};
use crate::style::{AXIS, INK, SMALL_TEXT, TEXT, WIDTH, sequential_colour};
use crate::svg::{Anchor, Canvas, Halo, Shape, Stroke, TextStyle, Weight};
use crate::ticks::short;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "cube chart";
/// Height of the picture, px.
const HEIGHT: f64 = 440.0;
/// Side of the front face, px.
const SIDE: f64 = 230.0;
/// How far the back face lies to the right of and above the front face, px.
const DEPTH: Point = at(130.0, -85.0);
/// Left and lower edge of the front face, px.
const ORIGIN: Point = at(140.0, 360.0);

/// A factor of a cube with its two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CubeEdge {
    /// The factor.
    pub title: AxisTitle,
    /// Low end, in the unit of the factor.
    pub low: f64,
    /// High end, in the unit of the factor.
    pub high: f64,
}

/// Responses at the eight corners of a cube.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cube {
    /// Factors to the right, upward, and away from the reader.
    pub edges: [CubeEdge; 3],
    /// The response.
    pub response: AxisTitle,
    /// Responses at the corners, in the unit of the response; the first factor changes fastest, its
    /// low end first.
    pub values: [f64; 8],
}

impl Cube {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] for a number that is not finite.
    pub fn draw(&self) -> Result<Svg, Error> {
        Field::new(CHART, "response").finite(self.values.iter().copied())?;
        let ends = self.edges.iter().flat_map(|edge| [edge.low, edge.high]);
        Field::new(CHART, "end of factor").finite(ends)?;
        let mut canvas = Canvas::new(WIDTH, HEIGHT);
        for corner in 0..8_usize {
            for axis in (0..3).filter(|axis| corner >> axis & 1 == 0) {
                // The three edges at the hidden corner are dashed.
                let hidden = corner == 4 || corner | 1 << axis == 4;
                let stroke = if hidden {
                    Stroke::dashed(AXIS, 1.0)
                } else {
                    Stroke::solid(AXIS, 1.4)
                };
                canvas.line(place(corner), place(corner | 1 << axis), &stroke);
            }
        }
        self.draw_values(&mut canvas);
        self.draw_factors(&mut canvas);
        canvas.text(
            at(12.0, 18.0),
            &self.response.text(""),
            &text(TEXT, Anchor::Start),
        );
        canvas.finish(CHART, &format!("{} at the corners", self.response.text("")))
    }

    /// Marks and numbers at the corners, all with as many decimals as their spread needs.
    fn draw_values(&self, canvas: &mut Canvas) {
        let low = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self
            .values
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let span = high - low;
        let decimals = decimals(span);
        for (corner, &value) in self.values.iter().enumerate() {
            let share = if span > 0.0 {
                (value - low) / span
            } else {
                0.5
            };
            let here = place(corner);
            canvas.marker(Shape::Circle, here, &sequential_colour(share), INK);
            let (right, front) = (corner & 1 == 1, corner & 4 == 0);
            let anchor = if right { Anchor::Start } else { Anchor::End };
            let aside = if right { 9.0 } else { -9.0 };
            let down = if front { 12.0 } else { -12.0 };
            let style = TextStyle {
                weight: Weight::Bold,
                halo: Halo::Paper,
                ..text(TEXT, anchor)
            };
            canvas.text(
                at(here.x + aside, here.y + down),
                &format!("{value:.decimals$}"),
                &style,
            );
        }
    }

    /// Names and ends of the factors along three edges.
    fn draw_factors(&self, canvas: &mut Canvas) {
        let ends = |edge: &CubeEdge| {
            format!(
                "{}: {} to {}",
                edge.title.text(""),
                short(edge.low),
                short(edge.high)
            )
        };
        let [x, y, z] = &self.edges;
        let middle = |a: usize, b: usize| {
            let (a, b) = (place(a), place(b));
            at(0.5 * (a.x + b.x), 0.5 * (a.y + b.y))
        };
        let below = middle(0, 1);
        canvas.text(
            at(below.x, below.y + 34.0),
            &ends(x),
            &text(SMALL_TEXT + 1.0, Anchor::Middle),
        );
        let left = middle(0, 2);
        let upright = TextStyle {
            turn: -90.0,
            ..text(SMALL_TEXT + 1.0, Anchor::Middle)
        };
        canvas.text(at(left.x - 72.0, left.y), &ends(y), &upright);
        let away = middle(1, 5);
        canvas.text(
            at(away.x + 16.0, away.y + 14.0),
            &ends(z),
            &text(SMALL_TEXT + 1.0, Anchor::Start),
        );
    }
}

/// Decimals that show a hundredth of a span, 0 to 6.
fn decimals(span: f64) -> usize {
    let fits = |n: &usize| span * 10.0_f64.powi(i32::try_from(*n).unwrap_or(6)) >= 100.0;
    (0..6).find(fits).unwrap_or(if span > 0.0 { 6 } else { 2 })
}

/// Place of a corner: bit 0 to the right, bit 1 upward, bit 2 away.
fn place(corner: usize) -> Point {
    let bit = |axis: usize| f64::from(u8::from(corner >> axis & 1 == 1));
    at(
        ORIGIN.x + SIDE * bit(0) + DEPTH.x * bit(2),
        ORIGIN.y - SIDE * bit(1) + DEPTH.y * bit(2),
    )
}

/// A text of that size.
fn text(size: f64, anchor: Anchor) -> TextStyle<'static> {
    TextStyle {
        size,
        ..TextStyle::small(anchor)
    }
}
