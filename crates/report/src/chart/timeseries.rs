//! One observable over time.

use serde::{Deserialize, Serialize};

use crate::chart::{AxisTitle, Level};
use crate::check::Field;
use crate::geometry::{Point, Rect, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend, legend_height};
use crate::plot::{AxisPlan, Outside, Plot};
use crate::style::{BAND, BLUE, INK, VERMILION, WIDTH};
use crate::svg::{Canvas, Shape, Stroke};
use crate::ticks::Domain;
use crate::{Error, Svg};

/// Kind of chart, for messages.
const CHART: &str = "time series";
/// Columns into which a long series is thinned out; each keeps its extremes.
const COLUMNS: usize = 600;

/// Part of the time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeSpan {
    /// Beginning, in the unit of the time axis.
    pub from: f64,
    /// End, in the unit of the time axis.
    pub to: f64,
}

/// An observable over time, with its steady part and the moments at which it was sampled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TimeSeries {
    /// Time axis.
    pub time_title: AxisTitle,
    /// Axis of the observable.
    pub value_title: AxisTitle,
    /// Times in ascending order.
    pub times: Vec<f64>,
    /// Observed values, one a time.
    pub values: Vec<f64>,
    /// The part that counts as steady, if any.
    pub steady: Option<TimeSpan>,
    /// Moments that were sampled; the value is read off the series.
    pub samples: Vec<f64>,
    /// Named lines across the chart, such as the mean or the measured value.
    pub levels: Vec<Level>,
}

impl TimeSeries {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`Error`] for fewer than two times, times that do not ascend, lists that differ in length,
    /// a number that is not finite, or a sample outside of the times.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let entries = self.legend();
        let top = 8.0 + legend_height(&entries, WIDTH - 80.0) + 8.0;
        let outside = Outside {
            left: 8.0,
            top,
            right: WIDTH - 20.0,
            bottom: 354.0,
        };
        let plot = self.plot(outside);
        let mut canvas = Canvas::new(WIDTH, 360.0);
        draw_legend(&mut canvas, at(plot.area.left, 8.0), WIDTH - 80.0, &entries);
        canvas.begin_clip(&plot.area);
        if let Some(span) = self.steady {
            let [left, right] = [span.from, span.to].map(|time| plot.x.pixel(time));
            canvas.rect(
                &Rect {
                    left,
                    right,
                    ..plot.area
                },
                BAND,
                1.0,
            );
        }
        plot.draw_grid(&mut canvas);
        let line: Vec<Point> = thinned(&self.times, &self.values)
            .into_iter()
            .map(|index| plot.place(self.times[index], self.values[index]))
            .collect();
        canvas.polyline(&line, &Stroke::solid(BLUE, 1.4));
        canvas.end_clip();
        for &time in &self.samples {
            let place = plot.place(time, self.value_at(time));
            canvas.marker(Shape::Circle, place, VERMILION, VERMILION);
        }
        plot.draw_axes(&mut canvas);
        self.draw_levels(&mut canvas, &plot, &line);
        canvas.finish(CHART, &format!("{} over time", self.value_title.text("")))
    }

    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "times").at_least(2, self.times.len())?;
        Field::new(CHART, "values").length(self.times.len(), "time", self.values.len())?;
        Field::new(CHART, "time").ascending(&self.times)?;
        Field::new(CHART, "value").finite(self.values.iter().copied())?;
        if let Some(span) = self.steady {
            Field::new(CHART, "end of the steady part").ascending(&[span.from, span.to])?;
        }
        Field::new(CHART, "level").finite(self.levels.iter().map(|level| level.value))?;
        Field::new(CHART, "sampled moment").finite(self.samples.iter().copied())?;
        let ends = [self.times[0], self.times[self.times.len() - 1]];
        for (index, &value) in self.samples.iter().enumerate() {
            if value < ends[0] || value > ends[1] {
                let (chart, field) = (CHART, "sampled moment");
                let requirement = "within the times of the series";
                return Err(Error::OutOfRange {
                    chart,
                    field,
                    index,
                    value,
                    requirement,
                });
            }
        }
        Ok(())
    }

    /// What the marks mean.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let line = Sample::Line(Stroke::solid(BLUE, 1.4));
        let mut entries = vec![LegendEntry {
            sample: line,
            name: &self.value_title.quantity,
        }];
        if self.steady.is_some() {
            entries.push(LegendEntry {
                sample: Sample::Patch(BAND, 1.0),
                name: "steady part",
            });
        }
        if !self.samples.is_empty() {
            let sample = Sample::Marker(Shape::Circle, VERMILION, VERMILION);
            entries.push(LegendEntry {
                sample,
                name: "sampled moments",
            });
        }
        entries
    }

    /// Plans the axes.
    fn plot(&self, outside: Outside) -> Plot {
        let x = Domain::tight(self.times.iter().copied());
        let levels = self.levels.iter().map(|level| level.value);
        let y = Domain::around(self.values.iter().copied().chain(levels));
        Plot::new(
            outside,
            AxisPlan::numbers(&self.time_title, x, 8.0),
            AxisPlan::numbers(&self.value_title, y, 6.0),
        )
    }

    /// Draws the named lines, each name where it does not cover the series.
    fn draw_levels(&self, canvas: &mut Canvas, plot: &Plot, line: &[Point]) {
        let mut names = LabelPlaces::new(plot.area);
        names.reserve_line(line);
        for level in &self.levels {
            let y = plot.y.pixel(level.value);
            let ends = [at(plot.area.left, y), at(plot.area.right, y)];
            canvas.line(ends[0], ends[1], &Stroke::dashed(INK, 1.2));
            names.reserve_line(&ends);
        }
        for level in &self.levels {
            names.write_on_level(canvas, plot.y.pixel(level.value), &level.name);
        }
    }

    /// Value at a time within the series, by linear interpolation.
    fn value_at(&self, time: f64) -> f64 {
        let after = self
            .times
            .partition_point(|&before| before < time)
            .clamp(1, self.times.len() - 1);
        let [t0, t1] = [self.times[after - 1], self.times[after]];
        let [v0, v1] = [self.values[after - 1], self.values[after]];
        v0 + (v1 - v0) * (time - t0) / (t1 - t0)
    }
}

/// Which entries are drawn: all of a short series, the first, last, least and greatest of every
/// column of a long one, so that no spike is lost.
fn thinned(times: &[f64], values: &[f64]) -> Vec<usize> {
    if times.len() <= 4 * COLUMNS {
        return (0..times.len()).collect();
    }
    let mut kept = Vec::with_capacity(4 * COLUMNS);
    for column in 0..COLUMNS {
        let from = column * times.len() / COLUMNS;
        let to = (column + 1) * times.len() / COLUMNS;
        let mut chosen = vec![from, to - 1];
        chosen.extend((from..to).min_by(|&a, &b| values[a].total_cmp(&values[b])));
        chosen.extend((from..to).max_by(|&a, &b| values[a].total_cmp(&values[b])));
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_series_is_thinned_without_losing_a_spike() {
        let times: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut values: Vec<f64> = times.iter().map(|t| (t * 1e-3).sin()).collect();
        values[54_321] = 7.0;
        let kept = thinned(&times, &values);
        assert!(kept.len() <= 4 * COLUMNS, "{}", kept.len());
        assert!(kept.contains(&54_321) && kept.contains(&0) && kept.contains(&99_999));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
