//! A plot area with its two axes.

use crate::chart::AxisTitle;
use crate::geometry::{Point, Rect, at};
use crate::style::{AXIS, GRID, INK, SMALL_TEXT, TEXT};
use crate::svg::{Anchor, Canvas, Stroke, TextStyle, Weight};
use crate::text::fitted;
use crate::ticks::{Domain, Ticks, superscript};

/// Length of a tick mark, px.
const TICK: f64 = 4.0;

/// Straight map from values to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    /// Values shown.
    pub(crate) domain: Domain,
    /// Pixel of the lower end.
    pub(crate) start: f64,
    /// Pixel of the upper end.
    pub(crate) end: f64,
}

impl Scale {
    /// Pixel of a value.
    pub(crate) fn pixel(&self, value: f64) -> f64 {
        let share = (value - self.domain.low) / (self.domain.high - self.domain.low);
        self.start + share * (self.end - self.start)
    }
}

/// What one axis shows.
#[derive(Debug, Clone)]
pub(crate) struct AxisPlan {
    /// Title.
    pub(crate) title: AxisTitle,
    /// Values shown.
    pub(crate) domain: Domain,
    /// Marks.
    pub(crate) ticks: Ticks,
    /// Whether grid lines cross the plot at the marks.
    pub(crate) grid: GridStyle,
}

/// Whether grid lines are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GridStyle {
    /// Lines at every mark.
    Lines,
    /// No lines.
    Bare,
}

impl AxisPlan {
    /// An axis of numbers with about `count` marks.
    pub(crate) fn numbers(title: &AxisTitle, domain: Domain, count: f64) -> Self {
        let ticks = Ticks::of(domain, count);
        Self {
            title: title.clone(),
            domain,
            ticks,
            grid: GridStyle::Lines,
        }
    }

    /// An axis of names, each with the same room.
    pub(crate) fn names<'a>(title: &AxisTitle, names: impl IntoIterator<Item = &'a str>) -> Self {
        let ticks = Ticks::names(names);
        let high = ticks.values.len() as f64 - 0.5;
        let domain = Domain {
            low: -0.5,
            high: high.max(0.5),
        };
        Self {
            title: title.clone(),
            domain,
            ticks,
            grid: GridStyle::Bare,
        }
    }

    /// Title with unit and power of ten.
    pub(crate) fn title_text(&self) -> String {
        self.title.text(&match self.ticks.exponent {
            0 => String::new(),
            exponent => format!("×10{}", superscript(exponent)),
        })
    }
}

/// Room around the plot area that does not follow from the axes, px.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outside {
    /// Left edge of everything.
    pub(crate) left: f64,
    /// Upper edge of the plot area.
    pub(crate) top: f64,
    /// Right edge of the plot area.
    pub(crate) right: f64,
    /// Lower edge of everything.
    pub(crate) bottom: f64,
}

/// A plot area with two axes.
#[derive(Debug, Clone)]
pub(crate) struct Plot {
    /// Where values are drawn.
    pub(crate) area: Rect,
    /// Horizontal map.
    pub(crate) x: Scale,
    /// Vertical map.
    pub(crate) y: Scale,
    /// Horizontal axis.
    x_plan: AxisPlan,
    /// Vertical axis.
    y_plan: AxisPlan,
    /// How labels below the plot are set.
    x_labels: Labels,
}

/// How the labels of the horizontal axis are set.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Labels {
    /// Slope, degrees: 0 side by side, more where there is no room for that.
    slope: f64,
    /// Width to which labels are cut, px.
    width: f64,
    /// Every how many-th label is written.
    every: usize,
}

/// Largest width of a label, px.
const WIDEST_LABEL: f64 = 200.0;
/// Slope of labels that are too long to stand side by side, degrees.
const SLOPE: f64 = 35.0;
/// Largest height of upright labels, px.
const TALLEST_LABEL: f64 = 150.0;
/// Distance that lines of text need, px.
const LINE: f64 = SMALL_TEXT + 2.0;

impl Labels {
    /// Chooses a slope for labels with `room` px each, the first of them at `first` px from the
    /// left edge of what the plot may take of the picture.
    fn new(plan: &AxisPlan, room: f64, first: f64) -> Self {
        let wanted = plan.ticks.width(SMALL_TEXT);
        if plan.grid == GridStyle::Lines || wanted + 6.0 <= room {
            return Self {
                slope: 0.0,
                width: wanted,
                every: 1,
            };
        }
        let (sine, cosine) = SLOPE.to_radians().sin_cos();
        // A slanted label reaches to the left of its mark, but must not reach into a neighbour.
        let reach = ((first - 6.0) / cosine).min(WIDEST_LABEL);
        if room * sine >= LINE && wanted <= reach {
            return Self {
                slope: SLOPE,
                width: wanted,
                every: 1,
            };
        }
        let mut every = 1;
        while every as f64 * room < LINE {
            every += 1;
        }
        Self {
            slope: 90.0,
            width: wanted.min(TALLEST_LABEL),
            every,
        }
    }

    /// Height below the marks, px.
    fn height(&self) -> f64 {
        if self.slope == 0.0 {
            SMALL_TEXT + 4.0
        } else {
            self.width * self.slope.to_radians().sin() + SMALL_TEXT + 2.0
        }
    }
}

impl Plot {
    /// Plans the area so that labels and titles find room.
    pub(crate) fn new(outside: Outside, x_plan: AxisPlan, y_plan: AxisPlan) -> Self {
        let y_width = y_plan.ticks.width(SMALL_TEXT).min(WIDEST_LABEL);
        let y_title = if y_plan.title.is_empty() {
            4.0
        } else {
            TEXT + 12.0
        };
        let left = outside.left + y_title + y_width + TICK + 4.0;
        let room = (outside.right - left) / x_plan.ticks.values.len().max(1) as f64;
        let x_labels = Labels::new(&x_plan, room, left - outside.left + 0.5 * room);
        let label_height = x_labels.height();
        let x_title = if x_plan.title.is_empty() {
            4.0
        } else {
            TEXT + 10.0
        };
        let bottom = outside.bottom - x_title - label_height - TICK;
        let area = Rect {
            left,
            top: outside.top,
            right: outside.right,
            bottom,
        };
        Self {
            area,
            x: Scale {
                domain: x_plan.domain,
                start: area.left,
                end: area.right,
            },
            y: Scale {
                domain: y_plan.domain,
                start: area.bottom,
                end: area.top,
            },
            x_plan,
            y_plan,
            x_labels,
        }
    }

    /// The same plot with its lower edge elsewhere; what stands below moves along.
    pub(crate) fn with_bottom(mut self, bottom: f64) -> Self {
        self.area.bottom = bottom;
        self.y.start = bottom;
        self
    }

    /// Height of marks and labels below the plot, px.
    pub(crate) fn height_below(&self) -> f64 {
        TICK + self.x_labels.height()
    }

    /// Place of a pair of values.
    pub(crate) fn place(&self, x: f64, y: f64) -> Point {
        at(self.x.pixel(x), self.y.pixel(y))
    }

    /// Draws grid lines; done first, so that everything else lies over them.
    pub(crate) fn draw_grid(&self, canvas: &mut Canvas) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.area;
        let stroke = Stroke::solid(GRID, 1.0);
        if self.x_plan.grid == GridStyle::Lines {
            for &value in &self.x_plan.ticks.values {
                let x = self.x.pixel(value);
                canvas.line(at(x, top), at(x, bottom), &stroke);
            }
        }
        if self.y_plan.grid == GridStyle::Lines {
            for &value in &self.y_plan.ticks.values {
                let y = self.y.pixel(value);
                canvas.line(at(left, y), at(right, y), &stroke);
            }
        }
    }

    /// Draws axis lines, marks, labels and titles; done last.
    pub(crate) fn draw_axes(&self, canvas: &mut Canvas) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.area;
        let stroke = Stroke::solid(AXIS, 1.0);
        canvas.line(at(left, bottom), at(right, bottom), &stroke);
        canvas.line(at(left, top), at(left, bottom), &stroke);
        self.draw_x_labels(canvas);
        for (&value, label) in self
            .y_plan
            .ticks
            .values
            .iter()
            .zip(&self.y_plan.ticks.labels)
        {
            let y = self.y.pixel(value);
            canvas.line(at(left - TICK, y), at(left, y), &stroke);
            let label = fitted(label, SMALL_TEXT, WIDEST_LABEL);
            canvas.text(
                at(left - TICK - 4.0, y),
                &label,
                &TextStyle::small(Anchor::End),
            );
        }
        self.draw_titles(canvas);
    }

    /// Draws marks and labels of the horizontal axis.
    fn draw_x_labels(&self, canvas: &mut Canvas) {
        let bottom = self.area.bottom;
        let ticks = &self.x_plan.ticks;
        for (index, (&value, label)) in ticks.values.iter().zip(&ticks.labels).enumerate() {
            let x = self.x.pixel(value);
            canvas.line(
                at(x, bottom),
                at(x, bottom + TICK),
                &Stroke::solid(AXIS, 1.0),
            );
            if index % self.x_labels.every != 0 {
                continue;
            }
            let label = fitted(label, SMALL_TEXT, self.x_labels.width + 1.0);
            let y = bottom + TICK + 0.5 * SMALL_TEXT + 3.0;
            if self.x_labels.slope == 0.0 {
                canvas.text(at(x, y), &label, &TextStyle::small(Anchor::Middle));
            } else {
                let turn = -self.x_labels.slope;
                let style = TextStyle {
                    turn,
                    ..TextStyle::small(Anchor::End)
                };
                let aside = 4.0 * turn.to_radians().cos();
                canvas.text(at(x + aside, y - 4.0 + aside), &label, &style);
            }
        }
    }

    /// Draws the titles of both axes.
    fn draw_titles(&self, canvas: &mut Canvas) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.area;
        let style = TextStyle {
            size: TEXT,
            ..TextStyle::small(Anchor::Middle)
        };
        if !self.x_plan.title.is_empty() {
            let below = TICK + self.x_labels.height();
            let text = fitted(&self.x_plan.title_text(), TEXT, right - left + 60.0);
            canvas.text(
                at(0.5 * (left + right), bottom + below + 0.5 * TEXT + 3.0),
                &text,
                &style,
            );
        }
        if !self.y_plan.title.is_empty() {
            let width = self.y_plan.ticks.width(SMALL_TEXT).min(WIDEST_LABEL);
            let x = left - TICK - 4.0 - width - 0.5 * TEXT - 7.0;
            let text = fitted(&self.y_plan.title_text(), TEXT, bottom - top + 60.0);
            let style = TextStyle {
                turn: -90.0,
                ..style
            };
            canvas.text(at(x, 0.5 * (top + bottom)), &text, &style);
        }
    }
}

/// Draws an upright or level error bar with caps.
pub(crate) fn draw_error_bar(canvas: &mut Canvas, ends: [Point; 2], colour: &str) {
    let stroke = Stroke::solid(colour, 1.2);
    let [from, to] = ends;
    canvas.line(from, to, &stroke);
    let upright = from.x == to.x;
    for end in ends {
        let [one, other] = if upright {
            [at(end.x - 3.0, end.y), at(end.x + 3.0, end.y)]
        } else {
            [at(end.x, end.y - 3.0), at(end.x, end.y + 3.0)]
        };
        canvas.line(one, other, &stroke);
    }
}

/// Draws a heading of a panel, centred over its area.
pub(crate) fn draw_panel_title(canvas: &mut Canvas, area: &Rect, title: &str) {
    let text = fitted(title, TEXT, area.width() + 20.0);
    let style = TextStyle {
        size: TEXT,
        weight: Weight::Bold,
        colour: INK,
        ..TextStyle::small(Anchor::Middle)
    };
    canvas.text(
        at(0.5 * (area.left + area.right), area.top - 12.0),
        &text,
        &style,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domain_fills_the_plot_from_edge_to_edge() {
        let outside = Outside {
            left: 8.0,
            top: 20.0,
            right: 600.0,
            bottom: 400.0,
        };
        let plan =
            |low, high| AxisPlan::numbers(&AxisTitle::new("a", "m"), Domain { low, high }, 5.0);
        let plot = Plot::new(outside, plan(-1.0, 3.0), plan(10.0, 20.0));
        assert_eq!(
            plot.place(-1.0, 10.0),
            Point {
                x: plot.area.left,
                y: plot.area.bottom
            }
        );
        assert_eq!(plot.place(3.0, 20.0), Point { x: 600.0, y: 20.0 });
        let middle = plot.place(1.0, 15.0);
        assert_eq!(middle.x, 0.5 * (plot.area.left + 600.0));
        assert_eq!(middle.y, 0.5 * (plot.area.bottom + 20.0));
        assert!(
            plot.area.left > 30.0 && plot.area.bottom < 370.0,
            "room for labels and titles"
        );
    }

    #[test]
    fn names_that_are_too_long_are_turned_and_too_many_are_thinned_out() {
        let labels = |names: &[&str], room: f64| {
            Labels::new(
                &AxisPlan::names(&AxisTitle::default(), names.iter().copied()),
                room,
                120.0,
            )
        };
        assert_eq!(labels(&["a", "b"], 40.0).slope, 0.0);
        assert_eq!(labels(&["condition 1", "condition 2"], 40.0).slope, SLOPE);
        assert_eq!(labels(&["condition 1", "condition 2"], 16.0).slope, 90.0);
        // 14 px a line: every third of labels that are 6 px apart.
        assert_eq!(labels(&["condition 1", "condition 2"], 6.0).every, 3);
    }
}
