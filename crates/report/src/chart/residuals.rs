//! Residuals by condition, by one model or several, against the noise.

use serde::{Deserialize, Serialize};

use crate::chart::AxisTitle;
use crate::chart::predicted_against_measured::{Role, marker_of};
use crate::check::Field;
use crate::geometry::{Point, Rect, at};
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot, draw_panel_title};
use crate::style::{AXIS, BAND, SMALL_TEXT, WIDTH};
use crate::svg::{Canvas, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "residual chart";
/// Height of a plot area, px.
const PANEL: f64 = 132.0;
/// Space between two rows of panels, px.
const GAP: f64 = 20.0;
/// Left edge and title of the vertical axis, px.
const TITLE: f64 = 34.0;

/// A condition under which something was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResidualCondition {
    /// Name below the panels.
    pub name: String,
    /// What its measurements were used for.
    pub role: Role,
}

/// One observable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualPanel {
    /// The observable, written at the vertical axis.
    pub observable: AxisTitle,
    /// Measured minus predicted, a list for each model, in it one a condition, in the unit of the
    /// observable; none where it was not measured.
    pub residuals: Vec<Vec<Option<f64>>>,
    /// Half width of the noise band, one a condition, in the unit of the observable.
    pub noise: Vec<f64>,
}

impl ResidualPanel {
    /// Values on the vertical axis: all residuals, the band and zero.
    fn domain(&self) -> Domain {
        let residuals = self.residuals.iter().flatten().flatten().copied();
        let band = self.noise.iter().flat_map(|&noise| [-noise, noise]);
        Domain::around(residuals.chain(band).chain([0.0]))
    }
}

/// Panels of residuals: a row an observable, a column a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Headings of the columns, such as "declared model" and "with wall adhesion".
    pub models: Vec<String>,
    /// What the band is, such as "± 2 standard errors".
    pub noise_name: String,
    /// The conditions in order.
    pub conditions: Vec<ResidualCondition>,
    /// The observables.
    pub panels: Vec<ResidualPanel>,
}

impl Residuals {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] without a condition, a model or a panel, for lists that do not match the conditions, a
    /// number that is not finite, or a negative noise.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let entries = self.legend();
        let top = 8.0 + legend_height(&entries, WIDTH - 60.0) + 28.0;
        let last = self.panels.len() - 1;
        let rows: Vec<Vec<Plot>> = self
            .panels
            .iter()
            .enumerate()
            .map(|(row, panel)| {
                let top = top + row as f64 * (PANEL + GAP);
                self.plots(
                    panel,
                    top,
                    if row == last {
                        Names::Shown
                    } else {
                        Names::Hidden
                    },
                )
            })
            .collect();
        let below = rows[last]
            .iter()
            .map(Plot::height_below)
            .fold(0.0, f64::max);
        let bottom = top + (last as f64 + 1.0) * PANEL + last as f64 * GAP;
        let mut canvas = Canvas::new(WIDTH, bottom + below + 8.0);
        draw_legend(
            &mut canvas,
            at(rows[0][0].area.left, 8.0),
            WIDTH - 60.0,
            &entries,
        );
        for (title, plot) in self.models.iter().zip(&rows[0]) {
            draw_panel_title(&mut canvas, &plot.area, title);
        }
        for (panel, plots) in self.panels.iter().zip(&rows) {
            for (residuals, plot) in panel.residuals.iter().zip(plots) {
                self.draw_panel(&mut canvas, plot, residuals, &panel.noise);
            }
        }
        canvas.finish(
            CHART,
            &format!("Residuals by condition: {}", self.models.join("; ")),
        )
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        let count = self.conditions.len();
        Field::new(CHART, "conditions").at_least(1, count)?;
        Field::new(CHART, "models").at_least(1, self.models.len())?;
        Field::new(CHART, "panels").at_least(1, self.panels.len())?;
        for panel in &self.panels {
            let models = self.models.len();
            Field::new(CHART, "residuals").length(models, "model", panel.residuals.len())?;
            for residuals in &panel.residuals {
                Field::new(CHART, "residuals").length(count, "condition", residuals.len())?;
                Field::new(CHART, "residuals").finite(residuals.iter().flatten().copied())?;
            }
            Field::new(CHART, "noise").length(count, "condition", panel.noise.len())?;
            Field::new(CHART, "noise").not_negative(panel.noise.iter().copied())?;
        }
        Ok(())
    }

    /// What the marks mean.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let mut entries = Vec::new();
        for (role, name) in [
            (Role::Fit, "used for the fit"),
            (Role::Check, "kept for the check"),
        ] {
            if self
                .conditions
                .iter()
                .any(|condition| condition.role == role)
            {
                let (shape, fill, rim) = marker_of(role);
                entries.push(LegendEntry {
                    sample: Sample::Marker(shape, fill, rim),
                    name,
                });
            }
        }
        entries.push(LegendEntry {
            sample: Sample::Patch(BAND, 1.0),
            name: &self.noise_name,
        });
        entries
    }

    /// The plots of a row with the same values on their vertical axes.
    fn plots(&self, panel: &ResidualPanel, top: f64, names: Names) -> Vec<Plot> {
        let numbers = AxisPlan::numbers(&panel.observable, panel.domain(), 5.0);
        // Labels on the right would repeat those on the left; the left edges of the columns must
        // not depend on the width of the labels, so that rows stand one below the other.
        let bare = AxisPlan {
            title: AxisTitle::default(),
            ..numbers.clone()
        };
        let widest = self.widest_label();
        let shift = widest - numbers.ticks.width(SMALL_TEXT);
        let bottom = top + PANEL;
        let n = self.models.len();
        let column = (WIDTH - TITLE) / n as f64;
        let plot = |k: usize| {
            let start = TITLE + k as f64 * column;
            let (left, values) = match k {
                0 => (8.0, numbers.clone()),
                _ => (start + 4.0, bare.clone()),
            };
            let right = if k + 1 == n {
                WIDTH - 12.0
            } else {
                start + column - 4.0
            };
            let place = Outside {
                left: left + shift,
                top,
                right,
                bottom,
            };
            Plot::new(place, self.condition_axis(names), values).with_bottom(bottom)
        };
        (0..n).map(plot).collect()
    }

    /// Axis of the conditions; only the lowest row carries their names.
    fn condition_axis(&self, names: Names) -> AxisPlan {
        let names = self.conditions.iter().map(|condition| match names {
            Names::Shown => condition.name.as_str(),
            Names::Hidden => "",
        });
        AxisPlan::names(&AxisTitle::default(), names)
    }

    /// Width of the widest number at a vertical axis, px.
    fn widest_label(&self) -> f64 {
        self.panels
            .iter()
            .map(|panel| {
                let numbers = AxisPlan::numbers(&panel.observable, panel.domain(), 5.0);
                numbers.ticks.width(SMALL_TEXT)
            })
            .fold(0.0, f64::max)
    }

    /// Draws the residuals of one observable by one model.
    fn draw_panel(
        &self,
        canvas: &mut Canvas,
        plot: &Plot,
        residuals: &[Option<f64>],
        noise: &[f64],
    ) {
        // One outline, over the upper steps and back under the lower ones, so that no seam shows.
        let step = |index: usize, half: f64| {
            let centre = index as f64;
            [
                plot.place(centre - 0.5, half),
                plot.place(centre + 0.5, half),
            ]
        };
        let upper = noise
            .iter()
            .enumerate()
            .flat_map(|(index, &half)| step(index, half));
        let lower = noise
            .iter()
            .enumerate()
            .flat_map(|(index, &half)| step(index, -half));
        let mut lower: Vec<Point> = lower.collect();
        lower.reverse();
        canvas.area(&[upper.chain(lower).collect()], BAND, 1.0);
        plot.draw_grid(canvas);
        let zero = plot.y.pixel(0.0);
        let Rect { left, right, .. } = plot.area;
        canvas.line(at(left, zero), at(right, zero), &Stroke::solid(AXIS, 1.0));
        for (index, (residual, condition)) in residuals.iter().zip(&self.conditions).enumerate() {
            let Some(residual) = *residual else { continue };
            let place = plot.place(index as f64, residual);
            let (shape, fill, rim) = marker_of(condition.role);
            canvas.line(at(place.x, zero), place, &Stroke::solid(rim, 1.5));
            canvas.marker(shape, place, fill, rim);
        }
        plot.draw_axes(canvas);
    }
}

/// Whether the names of the conditions stand below a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Names {
    /// They do.
    Shown,
    /// They do not.
    Hidden,
}
