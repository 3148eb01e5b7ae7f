//! Predictions against measurements and the line on which both agree.

use serde::{Deserialize, Serialize};

use crate::chart::AxisTitle;
use crate::check::Field;
use crate::geometry::at;
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot, draw_error_bar};
use crate::style::{BLUE, INK, PAPER, VERMILION, WIDTH};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "predicted against measured";

/// What a measurement was used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The parameters were fitted to it.
    Fit,
    /// It was kept for the check and not seen by the fit.
    Check,
}

/// One measurement and its prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Condition, written beside the point; empty for none.
    pub name: String,
    /// Measured value, in the unit of the chart.
    pub measured: f64,
    /// Half length of its error bar, in the unit of the chart; 0 for none.
    pub measured_error: f64,
    /// Predicted value, in the unit of the chart.
    pub predicted: f64,
    /// Half length of its error bar, in the unit of the chart; 0 for none.
    pub predicted_error: f64,
    /// What the measurement was used for.
    pub role: Role,
}

/// Points with error bars in both directions on a square chart with the 1:1 line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictedAgainstMeasured {
    /// The observable; "measured" and "predicted" are put before it.
    pub observable: AxisTitle,
    /// The points.
    pub comparisons: Vec<Comparison>,
}

impl PredictedAgainstMeasured {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without any point or for a number that is not finite or a negative error.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let entries = self.legend();
        let legend = legend_height(&entries, 540.0);
        let top = 8.0 + legend + 8.0;
        let plot = self.plot(top);
        let height = top + (plot.area.height()) + 52.0;
        let mut canvas = Canvas::new(WIDTH, height);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), 540.0, &entries);
        plot.draw_grid(&mut canvas);
        let Domain { low, high } = plot.x.domain;
        let ends = [plot.place(low, low), plot.place(high, high)];
        canvas.line(ends[0], ends[1], &Stroke::dashed(INK, 1.2));
        self.draw_points(&mut canvas, &plot);
        plot.draw_axes(&mut canvas);
        canvas.finish(
            CHART,
            &format!("Predicted against measured {}", self.observable.text("")),
        )
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        let points = &self.comparisons;
        Field::new(CHART, "comparisons").at_least(1, points.len())?;
        Field::new(CHART, "measured").finite(points.iter().map(|p| p.measured))?;
        Field::new(CHART, "predicted").finite(points.iter().map(|p| p.predicted))?;
        let errors = points.iter().map(|p| p.measured_error);
        Field::new(CHART, "measured error").not_negative(errors)?;
        let errors = points.iter().map(|p| p.predicted_error);
        Field::new(CHART, "predicted error").not_negative(errors)
    }

    /// What the marks mean.
    fn legend(&self) -> Vec<LegendEntry<'static>> {
        let mut entries = Vec::new();
        for (role, name) in [
            (Role::Fit, "used for the fit"),
            (Role::Check, "kept for the check"),
        ] {
            if self
                .comparisons
                .iter()
                .any(|comparison| comparison.role == role)
            {
                let (shape, fill, rim) = marker_of(role);
                entries.push(LegendEntry {
                    sample: Sample::Marker(shape, fill, rim),
                    name,
                });
            }
        }
        let sample = Sample::Line(Stroke::dashed(INK, 1.2));
        entries.push(LegendEntry {
            sample,
            name: "predicted = measured",
        });
        entries
    }

    /// Plans a square area with the same values on both axes.
    fn plot(&self, top: f64) -> Plot {
        let ends = self.comparisons.iter().flat_map(|p| {
            let measured = [p.measured - p.measured_error, p.measured + p.measured_error];
            let predicted = [
                p.predicted - p.predicted_error,
                p.predicted + p.predicted_error,
            ];
            measured.into_iter().chain(predicted)
        });
        let domain = Domain::around(ends);
        let title = |word: &str| {
            AxisTitle::new(
                format!("{word} {}", self.observable.quantity),
                &self.observable.unit,
            )
        };
        let x = AxisPlan::numbers(&title("Measured"), domain, 6.0);
        let y = AxisPlan::numbers(&title("Predicted"), domain, 6.0);
        let outside = Outside {
            left: 84.0,
            top,
            right: 560.0,
            bottom: 560.0,
        };
        let wide = Plot::new(outside, x.clone(), y.clone());
        // The same height as width: what the axes below take is known from the first plan.
        let bottom = outside.bottom + wide.area.width() - wide.area.height();
        Plot::new(Outside { bottom, ..outside }, x, y)
    }

    /// Draws error bars, marks and names.
    fn draw_points(&self, canvas: &mut Canvas, plot: &Plot) {
        let mut names = LabelPlaces::new(plot.area);
        for p in &self.comparisons {
            names.reserve_marker(plot.place(p.measured, p.predicted));
            let x_ends = [p.measured - p.measured_error, p.measured + p.measured_error];
            let y_ends = [
                p.predicted - p.predicted_error,
                p.predicted + p.predicted_error,
            ];
            names.reserve_line(&x_ends.map(|x| plot.place(x, p.predicted)));
            names.reserve_line(&y_ends.map(|y| plot.place(p.measured, y)));
            let (_, _, colour) = marker_of(p.role);
            if p.measured_error > 0.0 {
                draw_error_bar(canvas, x_ends.map(|x| plot.place(x, p.predicted)), colour);
            }
            if p.predicted_error > 0.0 {
                draw_error_bar(canvas, y_ends.map(|y| plot.place(p.measured, y)), colour);
            }
        }
        for p in self.comparisons.iter().filter(|p| !p.name.is_empty()) {
            names.write(canvas, plot.place(p.measured, p.predicted), &p.name, INK);
        }
        for p in &self.comparisons {
            let (shape, fill, rim) = marker_of(p.role);
            canvas.marker(shape, plot.place(p.measured, p.predicted), fill, rim);
        }
    }
}

/// Shape, fill and rim of the mark: hollow where the fit did not see the measurement.
pub(crate) fn marker_of(role: Role) -> (Shape, &'static str, &'static str) {
    match role {
        Role::Fit => (Shape::Circle, BLUE, BLUE),
        Role::Check => (Shape::Square, PAPER, VERMILION),
    }
}
