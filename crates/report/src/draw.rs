//! Drawing a plot.

use crate::frame::{BAR, Frame, LEVEL_ROW, title_with_power};
use crate::geometry::{Point, Rect, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample, draw_legend};
use crate::plot::{ColourBar, Mark, Plot, PlotPoint};
use crate::style::{AXIS, BLUE, INK, PAPER, SMALL_TEXT, TEXT, WIDTH};
use crate::svg::{Anchor, Canvas, Halo, Stroke, TextStyle, Weight};
use crate::text::{fitted, text_width};
use crate::ticks::{Domain, Ticks, short};
use crate::{Error, Svg};

/// Number of points above which they are small and without a rim.
const MOST_MARKERS: usize = 150;
/// Points side by side before the next row begins.
const IN_A_ROW: usize = 4;
/// Distance of points that share a place, px.
const STEP: f64 = 10.0;

impl Plot {
    /// Draws the plot.
    ///
    /// # Errors
    /// [`Error`] without any place, for a number that is not finite, or a negative error bar.
    pub fn draw(&self) -> Result<Svg, Error> {
        self.check()?;
        let frame = Frame::new(self);
        let mut canvas = Canvas::new(WIDTH, frame.height);
        let corner = at(frame.area.left, 8.0);
        let width = WIDTH - 20.0 - frame.area.left;
        draw_legend(&mut canvas, corner, width, &self.legend());
        frame.draw_grid(&mut canvas);
        canvas.begin_clip(&frame.area);
        for mark in &self.marks {
            draw_clipped(&mut canvas, &frame, mark);
        }
        canvas.end_clip();
        for mark in &self.marks {
            if let Mark::Points {
                shape,
                fill,
                rim,
                points,
                ..
            } = mark
            {
                draw_error_bars(&mut canvas, &frame, points, rim);
                let places = places(points, &frame);
                if points.len() > MOST_MARKERS {
                    canvas.dots(&places, rim_of_dots(rim, fill));
                    continue;
                }
                for (point, &place) in points.iter().zip(&places) {
                    let opens = !(point.tip.is_empty() && point.link.is_empty());
                    if opens {
                        canvas.begin_link(&point.link, &point.tip);
                    }
                    canvas.marker(*shape, place, fill, rim);
                    if opens {
                        canvas.end_link(&point.link);
                    }
                }
            }
        }
        frame.draw_axes(&mut canvas);
        self.draw_texts(&mut canvas, &frame);
        if let Some(bar) = &self.bar {
            draw_bar(&mut canvas, &frame, bar);
        }
        canvas.finish(&self.description())
    }

    /// An entry for each mark with a name.
    pub(crate) fn legend(&self) -> Vec<LegendEntry<'_>> {
        let sample = |mark| match mark {
            &Mark::Points {
                shape,
                ref fill,
                ref rim,
                ..
            } => Some(Sample::Marker(shape, fill, rim)),
            Mark::Line {
                colour,
                width,
                dashed,
                ..
            } => Some(Sample::Line(stroke(colour, *width, *dashed))),
            &Mark::Area {
                ref colour,
                opacity,
                ..
            } => Some(Sample::Patch(colour, opacity)),
            Mark::Level { .. } | Mark::Text { .. } => None,
        };
        let named = self.marks.iter().filter(|mark| !mark.name().is_empty());
        named
            .filter_map(|mark| {
                Some(LegendEntry {
                    sample: sample(mark)?,
                    name: mark.name(),
                })
            })
            .collect()
    }

    /// Writes all names where they cover nothing: those along lines, of levels, and of points.
    fn draw_texts(&self, canvas: &mut Canvas, frame: &Frame) {
        let mut names = LabelPlaces::new(frame.area);
        for mark in &self.marks {
            reserve(&mut names, frame, mark);
        }
        let mut rows = 0.0;
        for mark in &self.marks {
            match mark {
                Mark::Level {
                    name,
                    value,
                    upright: false,
                } => names.write_on_level(canvas, frame.across(*value, false)[0].y, name),
                Mark::Level { name, value, .. } => {
                    draw_upright_level(canvas, frame, *value, name, rows);
                    rows += 1.0;
                }
                Mark::Line { label, pieces, .. } if !label.is_empty() => {
                    for piece in pieces {
                        let line: Vec<Point> = piece.iter().map(|p| frame.place(*p)).collect();
                        names.write_along(canvas, &line, label);
                    }
                }
                Mark::Text {
                    place,
                    shift: [right, down],
                    text,
                    anchor,
                    bold,
                    turn,
                } => {
                    let Point { x, y } = frame.place(*place);
                    let style = TextStyle {
                        turn: *turn,
                        weight: if *bold { Weight::Bold } else { Weight::Normal },
                        halo: Halo::Paper,
                        ..TextStyle::small(*anchor)
                    };
                    canvas.text(at(x + right, y + down), text, &style);
                }
                Mark::Points { .. } | Mark::Line { .. } | Mark::Area { .. } => {}
            }
        }
        for mark in &self.marks {
            if let Mark::Points { points, .. } = mark {
                for point in points.iter().filter(|point| !point.label.is_empty()) {
                    names.write(canvas, frame.place([point.x, point.y]), &point.label, INK);
                }
            }
        }
    }
}

/// The colour of small points: the rim, unless it is of the colour of the paper.
fn rim_of_dots<'c>(rim: &'c str, fill: &'c str) -> &'c str {
    if rim == PAPER { fill } else { rim }
}

fn stroke(colour: &str, width: f64, dashed: bool) -> Stroke<'_> {
    if dashed {
        Stroke::dashed(colour, width)
    } else {
        Stroke::solid(colour, width)
    }
}

/// Draws what is cut off at the edges of the plot area.
fn draw_clipped(canvas: &mut Canvas, frame: &Frame, mark: &Mark) {
    let chain =
        |places: &Vec<[f64; 2]>| -> Vec<Point> { places.iter().map(|p| frame.place(*p)).collect() };
    match mark {
        Mark::Area {
            colour,
            opacity,
            outlines,
            ..
        } => {
            let loops: Vec<Vec<Point>> = outlines.iter().map(chain).collect();
            canvas.area(&loops, colour, *opacity);
        }
        Mark::Line {
            colour,
            width,
            dashed,
            pieces,
            ..
        } => {
            for piece in pieces.iter().filter(|piece| piece.len() > 1) {
                canvas.polyline(&chain(piece), &stroke(colour, *width, *dashed));
            }
        }
        Mark::Level {
            value,
            upright: false,
            ..
        } => {
            let [from, to] = frame.across(*value, false);
            canvas.line(from, to, &Stroke::dashed(INK, 1.2));
        }
        Mark::Points { .. } | Mark::Level { .. } | Mark::Text { .. } => {}
    }
}

/// Places of points, px. Points with a tip that share a place, since they differ in factors that are not shown, are set side by side
/// around it, shifted inwards at the edge of the plot area.
fn places(points: &[PlotPoint], frame: &Frame) -> Vec<Point> {
    let own = |point: &PlotPoint| frame.place([point.x, point.y]);
    let same = |a: &PlotPoint, b: &PlotPoint| {
        let [a, b] = [own(a), own(b)];
        (a.x - b.x).hypot(a.y - b.y) < 1.0
    };
    let area = &frame.area;
    let inwards = |x: f64, [low, high]: [f64; 2]| if low <= high { x.clamp(low, high) } else { x };
    let place = |(number, point): (usize, &PlotPoint)| {
        if point.tip.is_empty() {
            return own(point);
        }
        let before = points[..number]
            .iter()
            .filter(|other| same(other, point))
            .count();
        let all = points.iter().filter(|other| same(other, point)).count();
        let middle = |count: usize| 0.5 * (count as f64 - 1.0);
        let across = (before % IN_A_ROW) as f64 - middle(all.min(IN_A_ROW));
        let down = (before / IN_A_ROW) as f64 - middle(all.div_ceil(IN_A_ROW));
        // Distance of the outermost points from the middle of all.
        let [wide, high] = [all.min(IN_A_ROW), all.div_ceil(IN_A_ROW)].map(|n| STEP * middle(n));
        let Point { x, y } = own(point);
        at(
            inwards(x, [area.left + wide, area.right - wide]) + STEP * across,
            inwards(y, [area.top + high, area.bottom - high]) + STEP * down,
        )
    };
    points.iter().enumerate().map(place).collect()
}

/// Both error bars of a point, each with its ends; none of length 0.
fn error_bars(point: &PlotPoint, frame: &Frame) -> Vec<[Point; 2]> {
    let PlotPoint {
        x,
        y,
        x_error,
        y_error,
        ..
    } = *point;
    let level = [[x - x_error, y], [x + x_error, y]];
    let upright = [[x, y - y_error], [x, y + y_error]];
    let bars = [(x_error, level), (y_error, upright)].into_iter();
    let bars = bars.filter(|(error, _)| *error > 0.0);
    bars.map(|(_, ends)| ends.map(|end| frame.place(end)))
        .collect()
}

/// Draws the error bars with their caps.
fn draw_error_bars(canvas: &mut Canvas, frame: &Frame, points: &[PlotPoint], colour: &str) {
    let stroke = Stroke::solid(rim_of_dots(colour, BLUE), 1.2);
    for [from, to] in points.iter().flat_map(|point| error_bars(point, frame)) {
        canvas.line(from, to, &stroke);
        let upright = from.x == to.x;
        for end in [from, to] {
            let [wide, high] = if upright { [3.0, 0.0] } else { [0.0, 3.0] };
            canvas.line(
                at(end.x - wide, end.y - high),
                at(end.x + wide, end.y + high),
                &stroke,
            );
        }
    }
}

/// Keeps names off points with their error bars, levels, and full lines that have no name along them.
fn reserve(names: &mut LabelPlaces, frame: &Frame, mark: &Mark) {
    match mark {
        Mark::Points { points, .. } if points.len() <= MOST_MARKERS => {
            for place in places(points, frame) {
                names.reserve_marker(place);
            }
            for bar in points.iter().flat_map(|point| error_bars(point, frame)) {
                names.reserve_line(&bar);
            }
        }
        Mark::Line {
            dashed: false,
            label,
            pieces,
            ..
        } if label.is_empty() => {
            for piece in pieces {
                let line: Vec<Point> = piece.iter().map(|p| frame.place(*p)).collect();
                names.reserve_line(&line);
            }
        }
        Mark::Level {
            value,
            upright: false,
            ..
        } => names.reserve_line(&frame.across(*value, false)),
        _ => {}
    }
}

/// Draws an upright level with its name and value in a row of its own above the plot area.
fn draw_upright_level(canvas: &mut Canvas, frame: &Frame, value: f64, name: &str, row: f64) {
    let [foot, top] = frame.across(value, true);
    let y = top.y - 8.0 - LEVEL_ROW * row;
    canvas.line(at(foot.x, y), foot, &Stroke::dashed(INK, 1.2));
    let text = fitted(
        &format!("{name}: {}", short(value)),
        SMALL_TEXT,
        WIDTH - 60.0,
    );
    let inside = foot.x + 5.0 + text_width(&text, SMALL_TEXT) <= WIDTH - 6.0;
    let (anchor, x) = if inside {
        (Anchor::Start, foot.x + 5.0)
    } else {
        (Anchor::End, foot.x - 5.0)
    };
    let style = TextStyle {
        halo: Halo::Paper,
        ..TextStyle::small(anchor)
    };
    canvas.text(at(x, y), &text, &style);
}

impl ColourBar {
    /// Its levels as ticks.
    pub(crate) fn ticks(&self) -> Ticks {
        Ticks::of(self.domain(), 8.0)
    }

    /// Its values.
    fn domain(&self) -> Domain {
        Domain::tight(self.ends)
    }
}

/// Draws the colour bar with its levels and its title.
fn draw_bar(canvas: &mut Canvas, frame: &Frame, bar: &ColourBar) {
    let left = frame.area.right + 16.0;
    let area = Rect {
        left,
        right: left + BAR,
        ..frame.area
    };
    let domain = bar.domain();
    let height = |value: f64| area.bottom - domain.share(value) * area.height();
    let levels = bar.levels.iter().copied();
    let ends: Vec<f64> = [domain.low]
        .into_iter()
        .chain(levels)
        .chain([domain.high])
        .collect();
    for (band, pair) in ends.windows(2).enumerate() {
        let [top, bottom] = [height(pair[1]), height(pair[0])];
        canvas.rect(
            &Rect {
                top,
                bottom,
                ..area
            },
            &bar.colour(band),
            1.0,
        );
    }
    let ticks = bar.ticks();
    for (&value, label) in ticks.values.iter().zip(&ticks.labels) {
        let y = height(value);
        canvas.line(
            at(area.right, y),
            at(area.right + 4.0, y),
            &Stroke::solid(AXIS, 1.0),
        );
        canvas.text(
            at(area.right + 8.0, y),
            label,
            &TextStyle::small(Anchor::Start),
        );
    }
    let x = area.right + 8.0 + ticks.width(SMALL_TEXT) + 8.0 + 0.5 * TEXT;
    let style = TextStyle {
        size: TEXT,
        turn: -90.0,
        ..TextStyle::small(Anchor::Middle)
    };
    let title = fitted(
        &title_with_power(&bar.title, &ticks),
        TEXT,
        area.height() + 60.0,
    );
    canvas.text(at(x, 0.5 * (area.top + area.bottom)), &title, &style);
}
