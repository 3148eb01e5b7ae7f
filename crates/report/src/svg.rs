//! A small writer of SVG.
//!
//! Only this file puts numbers and text into markup: numbers are finite or the picture fails as a
//! whole, text is escaped. No `id` is ever used, so that any number of pictures can stand in one
//! page; clipping is done by nested `svg` elements.

use std::fmt::Write as _;

use crate::Error;
use crate::escape::escaped;
use crate::geometry::{Point, Rect, at};
use crate::style::{INK, PAPER, SMALL_TEXT};

/// A finished picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Svg {
    /// The whole `svg` element.
    markup: String,
}

impl Svg {
    /// The picture as one self-contained `svg` element; write it to a file as it is.
    pub fn as_str(&self) -> &str {
        &self.markup
    }
}

impl std::fmt::Display for Svg {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.markup)
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stroke<'a> {
    pub(crate) colour: &'a str,
    /// Width, px.
    pub(crate) width: f64,
    /// Dash pattern such as `5 3`, empty for a full line.
    pub(crate) dash: &'a str,
}

impl<'a> Stroke<'a> {
    /// A full line.
    pub(crate) const fn solid(colour: &'a str, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: "",
        }
    }

    /// A dashed line.
    pub(crate) const fn dashed(colour: &'a str, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: "5 3",
        }
    }
}

/// Which part of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a text is set. The place of a text is the middle of its height.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle<'a> {
    /// Font size, px.
    pub(crate) size: f64,
    /// Which part stands at the place.
    pub(crate) anchor: Anchor,
    pub(crate) colour: &'a str,
    /// Turn about the place, clockwise, degrees as SVG counts them.
    pub(crate) turn: f64,
    /// Weight of the font.
    pub(crate) weight: Weight,
    /// What lies around the letters.
    pub(crate) halo: Halo,
}

/// Weight of a font.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// Normal letters.
    Normal,
    /// Bold letters.
    Bold,
}

/// Rim around letters that stand on a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Halo {
    /// Nothing.
    None,
    /// A rim of paper.
    Paper,
}

impl TextStyle<'_> {
    /// Small text.
    pub(crate) const fn small(anchor: Anchor) -> Self {
        TextStyle {
            size: SMALL_TEXT,
            anchor,
            colour: INK,
            turn: 0.0,
            weight: Weight::Normal,
            halo: Halo::None,
        }
    }
}

/// Shape of a marker, so that series differ in more than colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Circle.
    Circle,
    /// Square.
    Square,
    /// Triangle with a point upward.
    Triangle,
    /// Square on a corner.
    Diamond,
}

impl Shape {
    /// Shape number `index`; shapes repeat after four.
    pub fn of_series(index: usize) -> Self {
        [Self::Circle, Self::Square, Self::Triangle, Self::Diamond][index % 4]
    }
}

/// A picture in the making.
#[derive(Debug)]
pub(crate) struct Canvas {
    /// Width, px.
    width: f64,
    /// Height, px.
    height: f64,
    /// Markup so far.
    body: String,
    /// First number that was not finite, if any.
    broken: Option<f64>,
}

impl Canvas {
    /// White paper of whole pixels.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let (width, height) = (width.ceil(), height.ceil());
        let mut canvas = Self {
            width,
            height,
            body: String::new(),
            broken: None,
        };
        canvas.rect(
            &Rect {
                left: 0.0,
                top: 0.0,
                right: width,
                bottom: height,
            },
            PAPER,
            1.0,
        );
        canvas
    }

    /// The finished picture; `description` is for readers who cannot see it.
    pub(crate) fn finish(self, description: &str) -> Result<Svg, Error> {
        if let Some(value) = self.broken {
            return Err(Error::NonFinite {
                chart: "chart",
                field: "coordinate",
                index: 0,
                value,
            });
        }
        let Self {
            width,
            height,
            body,
            ..
        } = self;
        let description = escaped(description);
        Ok(Svg {
            markup: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" \
                 height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" \
                 font-family=\"sans-serif\"><title>{description}</title>\n{body}</svg>\n"
            ),
        })
    }

    /// A number as SVG wants it, to a hundredth of a pixel.
    fn number(&mut self, value: f64) -> String {
        if !value.is_finite() {
            self.broken.get_or_insert(value);
            return "0".to_owned();
        }
        let text = format!("{value:.2}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" {
            "0".to_owned()
        } else {
            text.to_owned()
        }
    }

    /// Adds markup; writing to a `String` cannot fail.
    fn push(&mut self, markup: std::fmt::Arguments<'_>) {
        self.body
            .write_fmt(markup)
            .expect("a String takes any text");
        self.body.push('\n');
    }

    /// Attributes of a stroke.
    fn stroke(&mut self, stroke: &Stroke<'_>) -> String {
        let width = self.number(stroke.width);
        let colour = stroke.colour;
        if stroke.dash.is_empty() {
            format!("stroke=\"{colour}\" stroke-width=\"{width}\"")
        } else {
            let dash = stroke.dash;
            format!("stroke=\"{colour}\" stroke-width=\"{width}\" stroke-dasharray=\"{dash}\"")
        }
    }

    /// A filled box.
    pub(crate) fn rect(&mut self, area: &Rect, fill: &str, opacity: f64) {
        let [x, y, width, height, opacity] = [
            area.left,
            area.top,
            area.width().max(0.0),
            area.height().max(0.0),
            opacity,
        ]
        .map(|value| self.number(value));
        self.push(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\" \
             fill-opacity=\"{opacity}\"/>"
        ));
    }

    /// A straight line.
    pub(crate) fn line(&mut self, from: Point, to: Point, stroke: &Stroke<'_>) {
        let [x1, y1, x2, y2] = [from.x, from.y, to.x, to.y].map(|value| self.number(value));
        let stroke = self.stroke(stroke);
        self.push(format_args!(
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" {stroke}/>"
        ));
    }

    /// A line through several points.
    pub(crate) fn polyline(&mut self, points: &[Point], stroke: &Stroke<'_>) {
        let path = self.path(points);
        let stroke = self.stroke(stroke);
        self.push(format_args!(
            "<path d=\"{path}\" fill=\"none\" {stroke} stroke-linejoin=\"round\"/>"
        ));
    }

    /// Areas bounded by closed loops; a loop inside of another is a hole.
    pub(crate) fn area(&mut self, loops: &[Vec<Point>], fill: &str, opacity: f64) {
        let mut path = String::new();
        for points in loops {
            path.push_str(&self.path(points));
            path.push('Z');
        }
        if path.is_empty() {
            return;
        }
        let opacity = self.number(opacity);
        self.push(format_args!(
            "<path d=\"{path}\" fill=\"{fill}\" fill-opacity=\"{opacity}\" fill-rule=\"evenodd\"/>"
        ));
    }

    /// Path data through points.
    fn path(&mut self, points: &[Point]) -> String {
        let mut path = String::new();
        for (index, point) in points.iter().enumerate() {
            let [x, y] = [point.x, point.y].map(|value| self.number(value));
            path.push_str(if index == 0 { "M" } else { "L" });
            path.push_str(&x);
            path.push(' ');
            path.push_str(&y);
        }
        path
    }

    /// A marker with a rim in `colour` that is filled with `fill`.
    pub(crate) fn marker(&mut self, shape: Shape, place: Point, fill: &str, colour: &str) {
        let radius = crate::style::MARKER;
        let corners: &[(f64, f64)] = match shape {
            Shape::Circle => {
                let [x, y, radius] = [place.x, place.y, radius].map(|value| self.number(value));
                self.push(format_args!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\" \
                     stroke=\"{colour}\" stroke-width=\"1.5\"/>"
                ));
                return;
            }
            Shape::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Shape::Triangle => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
            Shape::Diamond => &[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)],
        };
        let corners: Vec<Point> = corners
            .iter()
            .map(|&(x, y)| at(place.x + radius * x, place.y + radius * y))
            .collect();
        let path = self.path(&corners);
        self.push(format_args!(
            "<path d=\"{path}Z\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
        ));
    }

    pub(crate) fn text(&mut self, place: Point, text: &str, style: &TextStyle<'_>) {
        // The middle of lower-case and capital letters lies about 0.35 sizes above the baseline.
        let [x, y, drop, size, turn] =
            [place.x, place.y, 0.35 * style.size, style.size, style.turn]
                .map(|value| self.number(value));
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = match style.weight {
            Weight::Normal => "",
            Weight::Bold => " font-weight=\"bold\"",
        };
        let halo = match style.halo {
            Halo::None => "",
            Halo::Paper => {
                " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" \
                             paint-order=\"stroke\""
            }
        };
        let rotation = if style.turn == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({turn} {x} {y})\"")
        };
        let (colour, text) = (style.colour, escaped(text));
        self.push(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{drop}\" font-size=\"{size}\" fill=\"{colour}\" \
             text-anchor=\"{anchor}\"{weight}{halo}{rotation}>{text}</text>"
        ));
    }

    /// Begins what a click on opens `link`, a part of the page; only a group with a name where the link is empty.
    pub(crate) fn begin_link(&mut self, link: &str, name: &str) {
        let (link, name) = (escaped(link), escaped(name));
        if link.is_empty() {
            self.push(format_args!("<g><title>{name}</title>"));
        } else {
            self.push(format_args!("<a href=\"{link}\"><title>{name}</title>"));
        }
    }

    /// Ends what `begin_link` began.
    pub(crate) fn end_link(&mut self, link: &str) {
        self.push(format_args!(
            "</{}>",
            if link.is_empty() { "g" } else { "a" }
        ));
    }

    /// Many small marks in one element.
    pub(crate) fn dots(&mut self, places: &[Point], colour: &str) {
        let mut path = String::new();
        for place in places {
            let [x, y] = [place.x, place.y].map(|value| self.number(value));
            path.extend(["M", x.as_str(), " ", y.as_str(), "h.01"]);
        }
        self.push(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"6\" stroke-linecap=\"round\" \
             stroke-opacity=\"0.55\"/>"
        ));
    }

    /// Begins a part of which only what lies in `area` is seen; coordinates stay the same.
    pub(crate) fn begin_clip(&mut self, area: &Rect) {
        let [x, y, width, height] =
            [area.left, area.top, area.width(), area.height()].map(|value| self.number(value));
        self.push(format_args!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"
        ));
    }

    /// Ends what `begin_clip` began.
    pub(crate) fn end_clip(&mut self) {
        self.push(format_args!("</svg>"));
    }
}
