//! Where a plot puts its axes, titles and legend.

use crate::geometry::{Point, Rect, at};
use crate::legend::legend_height;
use crate::plot::{Axis, AxisTitle, Format, Mark, Plot};
use crate::style::{AXIS, GRID, SMALL_TEXT, TEXT, WIDTH};
use crate::svg::{Anchor, Canvas, Stroke, TextStyle};
use crate::text::fitted;
use crate::ticks::{Domain, Ticks, superscript};

/// Length of a tick mark, px.
const TICK: f64 = 4.0;
/// Margin of the picture, px.
const MARGIN: f64 = 8.0;
/// Room right of the plot area, px.
const RIGHT: f64 = 20.0;
/// Height of the row of an upright level above the plot area, px.
pub(crate) const LEVEL_ROW: f64 = SMALL_TEXT + 4.0;
/// Width of the colour bar, px.
pub(crate) const BAR: f64 = 16.0;
/// Largest width of a label, px.
const WIDEST_LABEL: f64 = 200.0;
/// Slope of labels that are too long to stand side by side, degrees.
const SLOPE: f64 = 35.0;
/// Largest height of upright labels, px.
const TALLEST_LABEL: f64 = 150.0;
/// Distance that lines of text need, px.
const LINE: f64 = SMALL_TEXT + 2.0;

/// An axis with its ticks.
#[derive(Debug, Clone)]
pub(crate) struct AxisPlan {
    /// Title; empty for none.
    title: AxisTitle,
    /// Values shown.
    pub(crate) domain: Domain,
    /// Ticks; none of a hidden axis.
    ticks: Ticks,
    /// Whether grid lines cross the plot at the ticks.
    has_grid: bool,
}

impl AxisPlan {
    /// An axis over the marks of a plot, with about `count` ticks.
    fn new(axis: &Axis, marks: &[Mark], upright: bool, count: f64) -> Self {
        match axis {
            Axis::Numbers { title, ends } => {
                let values = || marks.iter().flat_map(|mark| mark.values(upright));
                let domain = match *ends {
                    Some([low, high]) => Domain::tight([low, high]),
                    None => Domain::around(values()),
                };
                Self {
                    title: title.clone(),
                    domain,
                    ticks: Ticks::of(domain, count),
                    has_grid: true,
                }
            }
            Axis::Names(names) => {
                let high = (names.len() as f64 - 0.5).max(0.5);
                Self {
                    title: AxisTitle::default(),
                    // The first name stands on top.
                    domain: if upright {
                        Domain {
                            low: high,
                            high: -0.5,
                        }
                    } else {
                        Domain { low: -0.5, high }
                    },
                    ticks: Ticks::names(names.iter().map(String::as_str)),
                    has_grid: false,
                }
            }
            Axis::Hidden([low, high]) => Self {
                title: AxisTitle::default(),
                domain: Domain {
                    low: *low,
                    high: *high,
                },
                ticks: Ticks::names([]),
                has_grid: false,
            },
        }
    }

    /// Title with unit and power of ten.
    fn title_text(&self) -> String {
        title_with_power(&self.title, &self.ticks)
    }
}

/// A title with its unit and the power of ten of its ticks.
pub(crate) fn title_with_power(title: &AxisTitle, ticks: &Ticks) -> String {
    title.text(&match ticks.exponent {
        0 => String::new(),
        exponent => format!("×10{}", superscript(exponent)),
    })
}

/// How the labels of the horizontal axis are set.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Labels {
    /// Slope, degrees: 0 side by side, more if there is no room for that.
    slope: f64,
    /// Width to which labels are cut, px.
    width: f64,
    /// Every how many-th label is written.
    every: usize,
}

impl Labels {
    /// Chooses a slope for labels with `room` px each, the first of them at `first` px from the left edge of the picture.
    fn new(plan: &AxisPlan, room: f64, first: f64) -> Self {
        let wanted = plan.ticks.width(SMALL_TEXT);
        let labels = |slope, width, every| Self {
            slope,
            width,
            every,
        };
        if plan.has_grid || wanted + 6.0 <= room {
            return labels(0.0, wanted, 1);
        }
        let (sine, cosine) = SLOPE.to_radians().sin_cos();
        // A slanted label reaches to the left of its tick, but must not reach into a neighbour.
        let reach = ((first - 6.0) / cosine).min(WIDEST_LABEL);
        if room * sine >= LINE && wanted <= reach {
            return labels(SLOPE, wanted, 1);
        }
        let mut every = 1;
        while every as f64 * room < LINE {
            every += 1;
        }
        labels(90.0, wanted.min(TALLEST_LABEL), every)
    }

    /// Height below the ticks, px.
    fn height(&self) -> f64 {
        if self.slope == 0.0 {
            SMALL_TEXT + 4.0
        } else {
            self.width * self.slope.to_radians().sin() + SMALL_TEXT + 2.0
        }
    }
}

/// The plot area with its axes.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    /// Where values are drawn.
    pub(crate) area: Rect,
    /// Height of the picture, px.
    pub(crate) height: f64,
    /// Horizontal axis.
    pub(crate) x: AxisPlan,
    /// Vertical axis.
    pub(crate) y: AxisPlan,
    /// How the labels below are set.
    labels: Labels,
    /// Whether the axes are drawn.
    is_shown: bool,
}

impl Frame {
    /// Finds room for the axes, the legend and the colour bar of a plot.
    pub(crate) fn new(plot: &Plot) -> Self {
        let x = AxisPlan::new(&plot.x, &plot.marks, false, 7.0);
        let y = AxisPlan::new(&plot.y, &plot.marks, true, 7.0);
        let (Format::Height(size) | Format::Square(size)) = plot.format;
        let is_shown = !matches!(plot.x, Axis::Hidden(_));
        if !is_shown {
            let area = Rect {
                left: 0.0,
                top: 0.0,
                right: WIDTH,
                bottom: size,
            };
            return Self {
                area,
                height: size,
                labels: Labels::new(&x, WIDTH, 0.0),
                x,
                y,
                is_shown,
            };
        }
        let left = MARGIN + Self::left_of_area(&y);
        let right = match plot.format {
            Format::Square(side) => left + side,
            Format::Height(_) => WIDTH - plot.bar.as_ref().map_or(RIGHT, bar_room),
        };
        let is_upright = |mark: &&Mark| matches!(mark, Mark::Level { upright: true, .. });
        let rows = plot.marks.iter().filter(is_upright).count();
        let legend = legend_height(&plot.legend(), WIDTH - RIGHT - left);
        let top = MARGIN + legend + MARGIN + LEVEL_ROW * rows as f64;
        let bottom = top + size;
        let room = (right - left) / x.ticks.values.len().max(1) as f64;
        let labels = Labels::new(&x, room, left + 0.5 * room);
        let title = if x.title.is_empty() { 0.0 } else { TEXT + 6.0 };
        Self {
            area: Rect {
                left,
                top,
                right,
                bottom,
            },
            height: bottom + TICK + labels.height() + title + MARGIN,
            labels,
            x,
            y,
            is_shown,
        }
    }

    /// Room for the labels and the title of the vertical axis, px.
    fn left_of_area(y: &AxisPlan) -> f64 {
        let title = if y.title.is_empty() { 4.0 } else { TEXT + 12.0 };
        title + y.ticks.width(SMALL_TEXT).min(WIDEST_LABEL) + TICK + 4.0
    }

    /// Place of a pair of values, px.
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> Point {
        at(
            self.area.left + self.x.domain.share(x) * self.area.width(),
            self.area.bottom - self.y.domain.share(y) * self.area.height(),
        )
    }

    /// Both ends of the line across the area at a value.
    pub(crate) fn across(&self, value: f64, upright: bool) -> [Point; 2] {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.area;
        if upright {
            let x = self.place([value, 0.0]).x;
            [at(x, bottom), at(x, top)]
        } else {
            let y = self.place([0.0, value]).y;
            [at(left, y), at(right, y)]
        }
    }

    /// Draws grid lines; first, so that everything else is drawn over them.
    pub(crate) fn draw_grid(&self, canvas: &mut Canvas) {
        for (axis, upright) in [(&self.x, true), (&self.y, false)] {
            for &value in axis.ticks.values.iter().filter(|_| axis.has_grid) {
                let [from, to] = self.across(value, upright);
                canvas.line(from, to, &Stroke::solid(GRID, 1.0));
            }
        }
    }

    /// Draws axis lines, ticks, labels and titles; last.
    pub(crate) fn draw_axes(&self, canvas: &mut Canvas) {
        if !self.is_shown {
            return;
        }
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
        for (&value, label) in self.y.ticks.values.iter().zip(&self.y.ticks.labels) {
            let [from, _] = self.across(value, false);
            canvas.line(at(left - TICK, from.y), from, &stroke);
            let label = fitted(label, SMALL_TEXT, WIDEST_LABEL);
            let place = at(left - TICK - 4.0, from.y);
            canvas.text(place, &label, &TextStyle::small(Anchor::End));
        }
        self.draw_titles(canvas);
    }

    /// Draws ticks and labels of the horizontal axis.
    fn draw_x_labels(&self, canvas: &mut Canvas) {
        let stroke = Stroke::solid(AXIS, 1.0);
        let ticks = self.x.ticks.values.iter().zip(&self.x.ticks.labels);
        for (index, (&value, label)) in ticks.enumerate() {
            let [from, _] = self.across(value, true);
            canvas.line(from, at(from.x, from.y + TICK), &stroke);
            if index % self.labels.every != 0 {
                continue;
            }
            let label = fitted(label, SMALL_TEXT, self.labels.width + 1.0);
            let y = from.y + TICK + 0.5 * SMALL_TEXT + 3.0;
            if self.labels.slope == 0.0 {
                canvas.text(at(from.x, y), &label, &TextStyle::small(Anchor::Middle));
            } else {
                let turn = -self.labels.slope;
                let style = TextStyle {
                    turn,
                    ..TextStyle::small(Anchor::End)
                };
                let aside = 4.0 * turn.to_radians().cos();
                canvas.text(at(from.x + aside, y - 4.0 + aside), &label, &style);
            }
        }
    }

    /// Draws the titles of both axes.
    fn draw_titles(&self, canvas: &mut Canvas) {
        let area = &self.area;
        let style = TextStyle {
            size: TEXT,
            ..TextStyle::small(Anchor::Middle)
        };
        let below = area.bottom + TICK + self.labels.height() + 0.5 * TEXT + 3.0;
        let text = fitted(&self.x.title_text(), TEXT, area.width() + 60.0);
        canvas.text(at(0.5 * (area.left + area.right), below), &text, &style);
        let x = MARGIN + 0.5 * TEXT;
        let text = fitted(&self.y.title_text(), TEXT, area.height() + 60.0);
        let style = TextStyle {
            turn: -90.0,
            ..style
        };
        canvas.text(at(x, 0.5 * (area.top + area.bottom)), &text, &style);
    }
}

/// Room right of the plot area for a colour bar, px.
fn bar_room(bar: &crate::plot::ColourBar) -> f64 {
    BAR + 16.0 + bar.ticks().width(SMALL_TEXT) + 12.0 + TEXT + 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ends of the axes are the corners of the plot area, and a middle is in the middle.
    #[test]
    fn values_fill_the_plot_area_from_edge_to_edge() {
        let axis = |ends| Axis::Numbers {
            title: AxisTitle::new("a", "m"),
            ends: Some(ends),
        };
        let frame = Frame::new(&Plot::new(axis([-1.0, 3.0]), axis([10.0, 20.0])));
        let Rect {
            left,
            top,
            right,
            bottom,
        } = frame.area;
        assert_eq!(frame.place([-1.0, 10.0]), at(left, bottom));
        assert_eq!(frame.place([3.0, 20.0]), at(right, top));
        assert_eq!(
            frame.place([1.0, 15.0]),
            at(0.5 * (left + right), 0.5 * (top + bottom))
        );
        assert!(
            left > 30.0 && bottom < frame.height - 30.0,
            "room for titles"
        );
    }

    #[test]
    fn names_that_are_too_long_are_turned_and_too_many_are_thinned_out() {
        let labels = |names: &[&str], room: f64| {
            let names = names.iter().map(|name| (*name).to_owned()).collect();
            Labels::new(
                &AxisPlan::new(&Axis::Names(names), &[], false, 7.0),
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
