//! Ordered effects against half-normal quantiles.

use probability::normal_quantile;
use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Point, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{AXIS, BLUE, INK, PAPER, VERMILION, WIDTH};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "half-normal plot";

/// A named effect or t-value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorEffect {
    /// Name of the term.
    pub name: String,
    /// Signed size, in the unit of the chart's axis.
    pub value: f64,
}

impl FactorEffect {
    /// A named effect, in the unit of the chart's axis.
    pub fn new(name: impl Into<String>, value: f64) -> Self {
        Self {
            name: name.into(),
            value,
        }
    }
}

/// Half-normal plot of effects: those off the line are real.
///
/// # Formula
/// The i-th smallest of n absolute effects stands at the half-normal quantile of
/// (i - 1/2) / n `[Daniel1959]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfNormal {
    /// What is shown, such as "|effect|" in the unit of the response.
    pub size: AxisTitle,
    /// Signed effects.
    pub effects: Vec<FactorEffect>,
    /// Standard error of an effect, in the unit of the effects: the slope of the line on which
    /// effects of pure noise lie. None where it is not known.
    pub standard_error: Option<f64>,
    /// Absolute effects above this are named, in the unit of the effects.
    pub named_above: f64,
    /// Named limits of absolute effects, in the unit of the effects.
    pub limits: Vec<Level>,
}

impl HalfNormal {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any effect or for a number that is not finite or a negative error.
    pub fn draw(&self) -> Result<Svg, Error> {
        Field::new(CHART, "effects").at_least(1, self.effects.len())?;
        Field::new(CHART, "effect").finite(self.effects.iter().map(|effect| effect.value))?;
        Field::new(CHART, "standard error").not_negative(self.standard_error)?;
        Field::new(CHART, "named_above").not_negative([self.named_above])?;
        Field::new(CHART, "limit").not_negative(self.limits.iter().map(|limit| limit.value))?;
        let entries = self.legend();
        let top = 8.0 + legend_height(&entries, WIDTH - 80.0) + 8.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - 20.0,
            bottom: 424.0,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, 430.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 80.0, &entries);
        plot.draw_grid(&mut canvas);
        if let Some(error) = self.standard_error {
            canvas.begin_clip(&plot.area);
            let far = plot.x.domain.high;
            let ends = [plot.place(0.0, 0.0), plot.place(far, far * error)];
            canvas.line(ends[0], ends[1], &Stroke::dashed(INK, 1.2));
            canvas.end_clip();
        }
        self.draw_effects(&mut canvas, &plot);
        plot.draw_axes(&mut canvas);
        canvas.finish(
            CHART,
            &format!("Half-normal plot of {}", self.size.text("")),
        )
    }

    /// What the marks mean.
    fn legend(&self) -> Vec<LegendEntry<'static>> {
        let marker = |fill, rim| Sample::Marker(Shape::Circle, fill, rim);
        let mut entries = vec![
            LegendEntry {
                sample: marker(BLUE, BLUE),
                name: "positive",
            },
            LegendEntry {
                sample: marker(VERMILION, VERMILION),
                name: "negative",
            },
        ];
        let is_open = |e: &FactorEffect| e.value.abs() <= self.named_above;
        if self.effects.iter().any(is_open) {
            entries.push(LegendEntry {
                sample: marker(PAPER, AXIS),
                name: "not above the limit",
            });
        }
        if self.standard_error.is_some() {
            let sample = Sample::Line(Stroke::dashed(INK, 1.2));
            entries.push(LegendEntry {
                sample,
                name: "noise alone",
            });
        }
        entries
    }

    /// Plans the axes.
    fn plot(&self, outside: Outside) -> Plot {
        let sizes = self.effects.iter().map(|effect| effect.value.abs());
        let limits = self.limits.iter().map(|limit| limit.value);
        let largest = sizes.chain(limits).fold(0.0, f64::max);
        let high = if largest > 0.0 { 1.08 * largest } else { 1.0 };
        let count = self.effects.len() as f64;
        let right = 1.12 * half_normal_quantile((count - 0.5) / count);
        let title = AxisTitle::new("Half-normal quantile", "");
        Plot::new(
            outside,
            AxisPlan::numbers(
                &title,
                Domain {
                    low: 0.0,
                    high: right,
                },
                7.0,
            ),
            AxisPlan::numbers(&self.size, Domain { low: 0.0, high }, 7.0),
        )
    }

    /// Draws points and the names of the large ones.
    fn draw_effects(&self, canvas: &mut Canvas, plot: &Plot) {
        let mut sorted: Vec<&FactorEffect> = self.effects.iter().collect();
        sorted.sort_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let count = sorted.len() as f64;
        let places: Vec<Point> = sorted
            .iter()
            .enumerate()
            .map(|(index, effect)| {
                let quantile = half_normal_quantile((index as f64 + 0.5) / count);
                plot.place(quantile, effect.value.abs())
            })
            .collect();
        let mut names = LabelPlaces::new(plot.area);
        for &place in &places {
            names.reserve_marker(place);
        }
        for limit in &self.limits {
            let y = plot.y.pixel(limit.value);
            let ends = [at(plot.area.left, y), at(plot.area.right, y)];
            canvas.line(ends[0], ends[1], &Stroke::dashed(VERMILION, 1.2));
            names.write_on_level(canvas, y, &limit.name);
        }
        for (effect, &place) in sorted.iter().zip(&places).rev() {
            let colour = if effect.value < 0.0 { VERMILION } else { BLUE };
            if effect.value.abs() > self.named_above {
                canvas.marker(Shape::Circle, place, colour, colour);
                names.write(canvas, place, &effect.name, INK);
            } else {
                canvas.marker(Shape::Circle, place, PAPER, AXIS);
            }
        }
    }
}

/// The z with P(|Z| < z) = `probability` of a standard normal Z, for 0 < `probability` < 1; 7.5 beyond that.
fn half_normal_quantile(probability: f64) -> f64 {
    const FARTHEST: f64 = 7.5;
    let quantile = normal_quantile(0.5 * (1.0 + probability));
    quantile.map_or(FARTHEST, |z| z.min(FARTHEST))
}
