//! Values with error bars against one target.

use serde::{Deserialize, Serialize};

use crate::chart::AxisTitle;
use crate::check::Field;
use crate::geometry::{Rect, at};
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, GridStyle, Outside, Plot, draw_error_bar};
use crate::style::{BLUE, INK, PAPER, SMALL_TEXT, VERMILION, WIDTH};
use crate::svg::{Anchor, Canvas, Halo, Stroke, TextStyle};
use crate::text::text_width;
use crate::ticks::{Domain, short};
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "bars with target";
/// Colour of the target's band.
const TARGET_BAND: &str = "#f7d9c4";

/// One bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bar {
    /// Name below the bar.
    pub name: String,
    /// Value, in the unit of the chart.
    pub value: f64,
    /// Half length of the error bar, in the unit of the chart; 0 for none.
    pub error: f64,
}

/// What the bars should reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Name for the legend.
    pub name: String,
    /// Value, in the unit of the chart.
    pub value: f64,
    /// Half width of the band around it, in the unit of the chart; 0 for none.
    pub half_width: f64,
}

/// Bars from zero with error bars, and a target with its band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BarsWithTarget {
    /// What the bars show.
    pub value_title: AxisTitle,
    /// The bars from left to right.
    pub bars: Vec<Bar>,
    /// The target.
    pub target: Target,
}

impl BarsWithTarget {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any bar or for a number that is not finite or a negative error.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let mut entries = vec![LegendEntry {
            sample: Sample::Line(Stroke::solid(VERMILION, 2.0)),
            name: &self.target.name,
        }];
        let band = format!("± {}", short(self.target.half_width));
        if self.target.half_width > 0.0 {
            let sample = Sample::Patch(TARGET_BAND, 1.0);
            entries.push(LegendEntry {
                sample,
                name: &band,
            });
        }
        let top = 8.0 + legend_height(&entries, WIDTH - 80.0) + 10.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - 20.0,
            bottom: 374.0,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, 380.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 80.0, &entries);
        let Target {
            value, half_width, ..
        } = self.target;
        let [top, bottom] = [value + half_width, value - half_width].map(|v| plot.y.pixel(v));
        canvas.rect(
            &Rect {
                top,
                bottom,
                ..plot.area
            },
            TARGET_BAND,
            1.0,
        );
        plot.draw_grid(&mut canvas);
        for (index, bar) in self.bars.iter().enumerate() {
            draw_bar(&mut canvas, &plot, index as f64, bar);
        }
        let y = plot.y.pixel(value);
        let ends = [at(plot.area.left, y), at(plot.area.right, y)];
        canvas.line(ends[0], ends[1], &Stroke::solid(VERMILION, 2.0));
        for (index, bar) in self.bars.iter().enumerate() {
            draw_bar_value(&mut canvas, &plot, index as f64, bar);
        }
        plot.draw_axes(&mut canvas);
        let description = format!("{} against a target", self.value_title.text(""));
        canvas.finish(CHART, &description)
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "bars").at_least(1, self.bars.len())?;
        Field::new(CHART, "bar").finite(self.bars.iter().map(|bar| bar.value))?;
        Field::new(CHART, "error of bar").not_negative(self.bars.iter().map(|bar| bar.error))?;
        Field::new(CHART, "target").finite([self.target.value])?;
        Field::new(CHART, "half width of the target").not_negative([self.target.half_width])
    }

    /// Plans the axes; the bars start at zero.
    fn plot(&self, outside: Outside) -> Plot {
        let ends = self
            .bars
            .iter()
            .flat_map(|bar| [bar.value - bar.error, bar.value + bar.error]);
        let Target {
            value, half_width, ..
        } = self.target;
        let tight = Domain::tight(ends.chain([value - half_width, value + half_width])).with_zero();
        let room = 0.14 * (tight.high - tight.low);
        let domain = Domain {
            low: if tight.low < 0.0 {
                tight.low - room
            } else {
                0.0
            },
            high: if tight.high > 0.0 {
                tight.high + room
            } else {
                0.0
            },
        };
        let names = self.bars.iter().map(|bar| bar.name.as_str());
        let x = AxisPlan {
            grid: GridStyle::Bare,
            ..AxisPlan::names(&AxisTitle::default(), names)
        };
        Plot::new(
            outside,
            x,
            AxisPlan::numbers(&self.value_title, domain, 7.0),
        )
    }
}

/// Draws a bar and its error bar.
fn draw_bar(canvas: &mut Canvas, plot: &Plot, place: f64, bar: &Bar) {
    let [zero, end] = [plot.y.pixel(0.0), plot.y.pixel(bar.value)];
    let half = half_width(plot);
    let x = plot.x.pixel(place);
    let (top, bottom) = (zero.min(end), zero.max(end));
    canvas.rect(
        &Rect {
            left: x - half,
            right: x + half,
            top,
            bottom,
        },
        BLUE,
        0.85,
    );
    if bar.error > 0.0 {
        let ends = [bar.value - bar.error, bar.value + bar.error];
        draw_error_bar(canvas, ends.map(|value| plot.place(place, value)), INK);
    }
}

/// Half the width of a bar, px.
fn half_width(plot: &Plot) -> f64 {
    (0.3 * (plot.x.pixel(1.0) - plot.x.pixel(0.0))).min(36.0)
}

/// Writes the value of a bar at its foot: in the bar, or beyond its end where it is too short.
fn draw_bar_value(canvas: &mut Canvas, plot: &Plot, place: f64, bar: &Bar) {
    let zero = plot.y.pixel(0.0);
    let height = zero - plot.y.pixel(bar.value);
    let (x, up) = (
        plot.x.pixel(place),
        if bar.value < 0.0 { -12.0 } else { 12.0 },
    );
    let text = short(bar.value);
    let fits = height.abs() > 26.0 && text_width(&text, SMALL_TEXT) < 2.0 * half_width(plot);
    if fits {
        let style = TextStyle {
            colour: PAPER,
            ..TextStyle::small(Anchor::Middle)
        };
        canvas.text(at(x, zero - up), &text, &style);
    } else {
        let style = TextStyle {
            halo: Halo::Paper,
            ..TextStyle::small(Anchor::Middle)
        };
        let error = zero - plot.y.pixel(bar.error);
        canvas.text(
            at(x, zero - height - error * up.signum() - up),
            &text,
            &style,
        );
    }
}
