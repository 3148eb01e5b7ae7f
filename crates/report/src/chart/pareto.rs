//! Effects sorted by size, against limits.

use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Rect, at};
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{BLUE, INK, SMALL_TEXT, TEXT, VERMILION, WIDTH};
use crate::svg::{Anchor, Canvas, Halo, Stroke, TextStyle};
use crate::text::{fitted, text_width};
use crate::ticks::{Domain, plain, short};
use crate::{Error, FactorEffect, Svg};

/// Kind of chart, for messages.
const CHART: &str = "pareto chart";
/// Height of one bar with its gap, px.
const ROW: f64 = 24.0;

/// Bars of absolute effects or t-values, the largest on top; the sign is shown by colour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pareto {
    /// What the bars show, such as "|t|" without unit.
    pub size: AxisTitle,
    /// Signed effects or t-values.
    pub effects: Vec<FactorEffect>,
    /// Limits such as that of t or of Bonferroni, in the unit of the bars, above 0.
    pub limits: Vec<Level>,
}

impl Pareto {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any effect, for a number that is not finite, or a limit below 0.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let mut sorted: Vec<&FactorEffect> = self.effects.iter().collect();
        sorted.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        let entries = [
            LegendEntry {
                sample: Sample::Patch(BLUE, 1.0),
                name: "raises the response (+)",
            },
            LegendEntry {
                sample: Sample::Patch(VERMILION, 1.0),
                name: "lowers it (−)",
            },
        ];
        let outside = Outside {
            left: 8.0,
            top: 0.0,
            right: WIDTH - 24.0,
            bottom: 0.0,
        };
        let legend = legend_height(&entries, WIDTH - 40.0);
        let top = 10.0 + legend + 4.0 + (SMALL_TEXT + 4.0) * self.limits.len() as f64 + 4.0;
        let bottom = top + ROW * sorted.len() as f64 + 2.0 * TEXT + 20.0;
        let plot = self.plot(
            &sorted,
            Outside {
                top,
                bottom,
                ..outside
            },
        );

        let mut canvas = Canvas::new(WIDTH, bottom + 6.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 40.0, &entries);
        plot.draw_grid(&mut canvas);
        let last = sorted.len() - 1;
        for (index, effect) in sorted.iter().enumerate() {
            draw_bar(&mut canvas, &plot, (last - index) as f64, effect);
        }
        plot.draw_axes(&mut canvas);
        self.draw_limits(&mut canvas, &plot);
        for (index, effect) in sorted.iter().enumerate() {
            let end = plot.place(effect.value.abs(), (last - index) as f64);
            let style = TextStyle {
                halo: Halo::Paper,
                ..TextStyle::small(Anchor::Start)
            };
            let size = like_the_largest(effect.value.abs(), sorted[0].value.abs());
            canvas.text(at(end.x + 5.0, end.y), &size, &style);
        }
        canvas.finish(CHART, &format!("Pareto chart of {}", self.size.text("")))
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "effects").at_least(1, self.effects.len())?;
        Field::new(CHART, "effect").finite(self.effects.iter().map(|effect| effect.value))?;
        Field::new(CHART, "limit").not_negative(self.limits.iter().map(|limit| limit.value))
    }

    /// Plans the axes; room is left for the number behind the longest bar.
    fn plot(&self, sorted: &[&FactorEffect], outside: Outside) -> Plot {
        let sizes = sorted.iter().map(|effect| effect.value.abs());
        let tight = Domain::tight(sizes.chain(self.limits.iter().map(|limit| limit.value)));
        let domain = Domain {
            low: 0.0,
            high: tight.high.max(1e-300) * 1.1,
        };
        let x = AxisPlan::numbers(&self.size, domain, 7.0);
        let names: Vec<&str> = sorted
            .iter()
            .rev()
            .map(|effect| effect.name.as_str())
            .collect();
        Plot::new(outside, x, AxisPlan::names(&AxisTitle::default(), names))
    }

    /// Draws the limits with their names above the plot, each in a row of its own.
    fn draw_limits(&self, canvas: &mut Canvas, plot: &Plot) {
        let mut limits: Vec<&Level> = self.limits.iter().collect();
        limits.sort_by(|a, b| a.value.total_cmp(&b.value));
        let count = limits.len();
        for (index, limit) in limits.into_iter().enumerate() {
            let x = plot.x.pixel(limit.value);
            let y = plot.area.top - 8.0 - (SMALL_TEXT + 4.0) * (count - 1 - index) as f64;
            canvas.line(at(x, y), at(x, plot.area.bottom), &Stroke::dashed(INK, 1.2));
            let text = format!("{}: {}", limit.name, short(limit.value));
            let text = fitted(&text, SMALL_TEXT, WIDTH - 60.0);
            let width = text_width(&text, SMALL_TEXT);
            let (anchor, x) = if x + 5.0 + width <= WIDTH - 6.0 {
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

/// A size with as many decimals as the largest size needs for three digits.
fn like_the_largest(size: f64, largest: f64) -> String {
    let longest = short(largest);
    if longest.contains('×') {
        return short(size);
    }
    plain(
        size,
        longest
            .split_once('.')
            .map_or(0, |(_, decimals)| decimals.len()),
    )
}

/// Draws one bar at the height `row`.
fn draw_bar(canvas: &mut Canvas, plot: &Plot, row: f64, effect: &FactorEffect) {
    let end = plot.place(effect.value.abs(), row);
    let half = 0.34 * ROW;
    let bar = Rect {
        left: plot.area.left,
        top: end.y - half,
        right: end.x,
        bottom: end.y + half,
    };
    canvas.rect(&bar, if effect.value < 0.0 { VERMILION } else { BLUE }, 0.9);
}
