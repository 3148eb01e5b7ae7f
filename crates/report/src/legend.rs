//! The legend above a plot.

use crate::geometry::{Point, Rect, at};
use crate::style::SMALL_TEXT;
use crate::svg::{Anchor, Canvas, Shape, Stroke, TextStyle};
use crate::text::{fitted, text_width};

/// Sample drawn before a name in a legend.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Sample<'a> {
    /// A marker: shape, fill and rim.
    Marker(Shape, &'a str, &'a str),
    /// A piece of line.
    Line(Stroke<'a>),
    /// A filled patch with its opacity.
    Patch(&'a str, f64),
}

#[derive(Debug, Clone)]
pub(crate) struct LegendEntry<'a> {
    /// What is drawn before the name.
    pub(crate) sample: Sample<'a>,
    pub(crate) name: &'a str,
}

/// Width of a sample, px.
const SAMPLE: f64 = 22.0;
/// Height of a legend row, px.
const LEGEND_ROW: f64 = 19.0;

/// Height that a legend takes, px.
pub(crate) fn legend_height(entries: &[LegendEntry<'_>], width: f64) -> f64 {
    legend_places(entries, width)
        .last()
        .map_or(0.0, |place| place.y + LEGEND_ROW)
}

/// Upper left corners of the entries, relative to the legend; rows break where they are full.
fn legend_places(entries: &[LegendEntry<'_>], width: f64) -> Vec<Point> {
    let mut next = at(0.0, 0.0);
    entries
        .iter()
        .map(|entry| {
            let needed =
                SAMPLE + 6.0 + text_width(entry.name, SMALL_TEXT).min(width - SAMPLE - 6.0);
            if next.x > 0.0 && next.x + needed > width {
                next = at(0.0, next.y + LEGEND_ROW);
            }
            let place = next;
            next.x += needed + 14.0;
            place
        })
        .collect()
}

/// Draws a legend with its upper left corner at a place.
pub(crate) fn draw_legend(
    canvas: &mut Canvas,
    corner: Point,
    width: f64,
    entries: &[LegendEntry<'_>],
) {
    for (entry, place) in entries.iter().zip(legend_places(entries, width)) {
        let x = corner.x + place.x;
        let y = corner.y + place.y + 0.5 * LEGEND_ROW;
        draw_sample(canvas, at(x, y), &entry.sample);
        let name = fitted(entry.name, SMALL_TEXT, width - SAMPLE - 6.0);
        canvas.text(
            at(x + SAMPLE + 6.0, y),
            &name,
            &TextStyle::small(Anchor::Start),
        );
    }
}

/// Draws the sample of a legend entry, its left end in the middle of its height at a place.
fn draw_sample(canvas: &mut Canvas, place: Point, sample: &Sample<'_>) {
    let middle = at(place.x + 0.5 * SAMPLE, place.y);
    let end = at(place.x + SAMPLE, place.y);
    match *sample {
        Sample::Marker(shape, fill, rim) => canvas.marker(shape, middle, fill, rim),
        Sample::Line(stroke) => canvas.line(place, end, &stroke),
        Sample::Patch(fill, opacity) => {
            let patch = Rect {
                left: place.x,
                top: place.y,
                right: end.x,
                bottom: place.y,
            };
            let patch = Rect {
                top: patch.top - 5.5,
                bottom: patch.bottom + 5.5,
                ..patch
            };
            canvas.rect(&patch, fill, opacity);
        }
    }
}
