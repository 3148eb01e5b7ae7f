//! Bars made of parts, one bar a name.

use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Rect, at};
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{INK, SMALL_TEXT, TEXT, WIDTH, series_colour};
use crate::svg::{Anchor, Canvas, Halo, Stroke, TextStyle};
use crate::text::{fitted, text_width};
use crate::ticks::{Domain, short};
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "stacked bars";
/// Height of one bar with its gap, px.
const ROW: f64 = 24.0;

/// Bars of signed parts: those above 0 stand to the right of the axis, those below to the left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StackedBars {
    /// What the bars show.
    pub size: AxisTitle,
    /// Names of the parts, in the order of their colours.
    pub parts: Vec<String>,
    /// The bars, the first on top.
    pub bars: Vec<StackedBar>,
    /// Limits in the unit of the bars.
    pub limits: Vec<Level>,
}

/// One bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StackedBar {
    /// Its name.
    pub name: String,
    /// The sizes of its parts, in their order.
    pub sizes: Vec<f64>,
}

impl StackedBars {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any bar, for a number that is not finite, or a bar with another number of parts.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let entries: Vec<LegendEntry<'_>> = self
            .parts
            .iter()
            .enumerate()
            .map(|(part, name)| LegendEntry {
                sample: Sample::Patch(series_colour(part), 1.0),
                name,
            })
            .collect();
        let legend = legend_height(&entries, WIDTH - 40.0);
        let notes = (SMALL_TEXT + 4.0) * self.limits.len() as f64;
        let top = 10.0 + legend + 4.0 + notes + 4.0;
        let bottom = top + ROW * self.bars.len() as f64 + 2.0 * TEXT + 20.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - 24.0,
            bottom,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, bottom + 6.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 40.0, &entries);
        plot.draw_grid(&mut canvas);
        for (row, bar) in self.bars.iter().rev().enumerate() {
            draw_bar(&mut canvas, &plot, row as f64, bar);
        }
        plot.draw_axes(&mut canvas);
        self.draw_limits(&mut canvas, &plot);
        canvas.finish(CHART, &format!("Stacked bars of {}", self.size.text("")))
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "bars").at_least(1, self.bars.len())?;
        for bar in &self.bars {
            let parts = Field::new(CHART, "sizes of a bar");
            parts.length(self.parts.len(), "part", bar.sizes.len())?;
        }
        let whole = |bar: &StackedBar| bar.sizes.iter().map(|size| size.abs()).sum::<f64>();
        Field::new(CHART, "sum of a bar").finite(self.bars.iter().map(whole))?;
        Field::new(CHART, "limit").finite(self.limits.iter().map(|limit| limit.value))
    }

    /// Plans the axes.
    fn plot(&self, outside: Outside) -> Plot {
        let ends = self.bars.iter().flat_map(|bar| {
            let side = |sign: f64| {
                let sizes = bar.sizes.iter().filter(|size| **size * sign > 0.0);
                sizes.sum::<f64>()
            };
            [side(1.0), side(-1.0)]
        });
        let limits = self.limits.iter().map(|limit| limit.value);
        let x = AxisPlan::numbers(
            &self.size,
            Domain::around(ends.chain(limits)).with_zero(),
            7.0,
        );
        let names = self.bars.iter().rev().map(|bar| bar.name.as_str());
        Plot::new(outside, x, AxisPlan::names(&AxisTitle::default(), names))
    }

    /// Draws the limits with their names above the plot, each in a row of its own.
    fn draw_limits(&self, canvas: &mut Canvas, plot: &Plot) {
        for (index, limit) in self.limits.iter().enumerate() {
            let x = plot.x.pixel(limit.value);
            let above = self.limits.len() - 1 - index;
            let y = plot.area.top - 8.0 - (SMALL_TEXT + 4.0) * above as f64;
            canvas.line(at(x, y), at(x, plot.area.bottom), &Stroke::dashed(INK, 1.2));
            let text = format!("{}: {}", limit.name, short(limit.value));
            let text = fitted(&text, SMALL_TEXT, WIDTH - 60.0);
            let inside = x + 5.0 + text_width(&text, SMALL_TEXT) <= WIDTH - 6.0;
            let (anchor, x) = if inside {
                (Anchor::Start, x + 5.0)
            } else {
                (Anchor::End, x - 5.0)
            };
            let style = TextStyle {
                halo: Halo::Paper,
                ..TextStyle::small(anchor)
            };
            canvas.text(at(x, y), &text, &style);
        }
    }
}

/// Draws one bar at the height `row`.
fn draw_bar(canvas: &mut Canvas, plot: &Plot, row: f64, bar: &StackedBar) {
    let half = 0.34 * ROW;
    let (mut right, mut left) = (0.0, 0.0);
    for (part, &size) in bar.sizes.iter().enumerate() {
        let from: &mut f64 = if size > 0.0 { &mut right } else { &mut left };
        let ends = [*from, *from + size];
        *from += size;
        let [start, end] = ends.map(|value| plot.place(value, row));
        let part_of_bar = Rect {
            left: start.x.min(end.x),
            top: start.y - half,
            right: start.x.max(end.x),
            bottom: start.y + half,
        };
        canvas.rect(&part_of_bar, series_colour(part), 0.9);
    }
}
