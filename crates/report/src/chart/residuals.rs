//! Residuals by condition, before and after a change, against the noise.

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
    /// Measured minus predicted before the change, one a condition, in the unit of the
    /// observable; none where it was not measured.
    pub before: Vec<Option<f64>>,
    /// The same after the change; empty where there was none.
    pub after: Vec<Option<f64>>,
    /// Half width of the noise band, one a condition, in the unit of the observable.
    pub noise: Vec<f64>,
}

/// Panels of residuals: a row an observable, before on the left and, where something was changed, after
/// on the right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Heading of the left column, such as "declared model".
    pub before_title: String,
    /// Heading of the right column, such as "with wall adhesion"; none where nothing was changed.
    pub after_title: Option<String>,
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
    /// [`Error`] without a condition or a panel, for lists that do not match the conditions, a
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
        for (title, plot) in self.titles().zip(&rows[0]) {
            draw_panel_title(&mut canvas, &plot.area, title);
        }
        for (panel, plots) in self.panels.iter().zip(&rows) {
            for (residuals, plot) in [&panel.before, &panel.after].into_iter().zip(plots) {
                self.draw_panel(&mut canvas, plot, residuals, &panel.noise);
            }
        }
        let titles: Vec<&str> = self.titles().collect();
        canvas.finish(
            CHART,
            &format!("Residuals by condition: {}", titles.join("; ")),
        )
    }

    /// Headings of the columns.
    fn titles(&self) -> impl Iterator<Item = &str> {
        let before = std::iter::once(self.before_title.as_str());
        before.chain(self.after_title.as_deref())
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        let count = self.conditions.len();
        Field::new(CHART, "conditions").at_least(1, count)?;
        Field::new(CHART, "panels").at_least(1, self.panels.len())?;
        for panel in &self.panels {
            Field::new(CHART, "before").length(count, "condition", panel.before.len())?;
            let count_after = if self.after_title.is_some() { count } else { 0 };
            Field::new(CHART, "after").length(count_after, "condition", panel.after.len())?;
            Field::new(CHART, "noise").length(count, "condition", panel.noise.len())?;
            Field::new(CHART, "before").finite(panel.before.iter().map(|r| r.unwrap_or(0.0)))?;
            Field::new(CHART, "after").finite(panel.after.iter().map(|r| r.unwrap_or(0.0)))?;
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
        let residuals = panel.before.iter().chain(&panel.after).flatten().copied();
        let band = panel.noise.iter().flat_map(|&noise| [-noise, noise]);
        let domain = Domain::around(residuals.chain(band).chain([0.0]));
        let numbers = AxisPlan::numbers(&panel.observable, domain, 5.0);
        // Labels on the right would repeat those on the left; the left edge of both columns must
        // not depend on the width of the labels, so that rows stand one below the other.
        let bare = AxisPlan {
            title: AxisTitle::default(),
            ..numbers.clone()
        };
        let widest = self.widest_label();
        let shift = widest - numbers.ticks.width(SMALL_TEXT);
        let bottom = top + PANEL;
        let half = 0.5 * (WIDTH + 8.0 + 26.0);
        let two = self.after_title.is_some();
        let left = Outside {
            left: 8.0 + shift,
            top,
            right: if two { half - 4.0 } else { WIDTH - 12.0 },
            bottom,
        };
        let right = Outside {
            left: half + 4.0 + shift,
            top,
            right: WIDTH - 12.0,
            bottom,
        };
        let columns = [(left, numbers), (right, bare)].into_iter();
        columns
            .take(if two { 2 } else { 1 })
            .map(|(place, values)| Plot::new(place, self.condition_axis(names), values))
            .map(|plot| plot.with_bottom(bottom))
            .collect()
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
                let residuals = panel.before.iter().chain(&panel.after).flatten().copied();
                let band = panel.noise.iter().flat_map(|&noise| [-noise, noise]);
                let domain = Domain::around(residuals.chain(band).chain([0.0]));
                let numbers = AxisPlan::numbers(&panel.observable, domain, 5.0);
                numbers.ticks.width(SMALL_TEXT)
            })
            .fold(0.0, f64::max)
    }

    /// Draws the residuals of one observable at one time.
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
