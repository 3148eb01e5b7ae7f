//! A chart: two axes and the marks over them.

use crate::Error;
use crate::check::Field;
use crate::svg::{Anchor, Shape};

/// Title of an axis: the quantity and its unit.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AxisTitle {
    /// The quantity, such as "Repose angle".
    pub quantity: String,
    /// Its unit, such as "°"; empty for a plain number.
    pub unit: String,
}

impl AxisTitle {
    /// A title; an empty unit for a plain number.
    pub fn new(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            quantity: quantity.into(),
            unit: unit.into(),
        }
    }

    /// Whether both parts are empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.quantity.is_empty() && self.unit.is_empty()
    }

    /// "Quantity (unit)", with a factor such as "×10⁶" before the unit unless it is empty.
    pub(crate) fn text(&self, factor: &str) -> String {
        let unit = match (factor.is_empty(), self.unit.is_empty()) {
            (true, _) => self.unit.clone(),
            (false, true) => factor.to_owned(),
            (false, false) => format!("{factor} {}", self.unit),
        };
        match (self.quantity.is_empty(), unit.is_empty()) {
            (_, true) => self.quantity.clone(),
            (true, false) => format!("({unit})"),
            (false, false) => format!("{} ({unit})", self.quantity),
        }
    }
}

impl std::fmt::Display for AxisTitle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text(""))
    }
}

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq)]
pub enum Axis {
    /// Numbers.
    Numbers {
        /// Its title.
        title: AxisTitle,
        /// First and last value shown; `None` for all points, areas and levels with a margin.
        ends: Option<[f64; 2]>,
    },
    /// Names at 0, 1, 2 and so on; upright axes begin at the top.
    Names(Vec<String>),
    /// Plain coordinates between two ends, over the whole picture; nothing of the axis is drawn.
    Hidden([f64; 2]),
}

impl Axis {
    /// Numbers, over all that the plot shows.
    pub fn numbers(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        AxisTitle::new(quantity, unit).into()
    }
}

impl From<AxisTitle> for Axis {
    fn from(title: AxisTitle) -> Self {
        Self::Numbers { title, ends: None }
    }
}

/// A point of a plot, in the units of the axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlotPoint {
    /// Horizontal place.
    pub x: f64,
    /// Vertical place.
    pub y: f64,
    /// Half length of the horizontal error bar; 0 for none.
    pub x_error: f64,
    /// Half length of the vertical error bar; 0 for none.
    pub y_error: f64,
    /// Name written beside the point if there is room; empty for none.
    pub label: String,
    /// Text shown while the mouse rests on the point. Points with such a text that share a place are drawn side by side.
    pub tip: String,
    /// Part of the page that a click opens, such as `#run-1-3`; empty for none.
    pub link: String,
}

impl PlotPoint {
    /// A point without error bars and texts.
    pub fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            ..Self::default()
        }
    }

    /// The point with a vertical error bar of this half length.
    #[must_use]
    pub fn with_error(self, y_error: f64) -> Self {
        Self { y_error, ..self }
    }

    /// The point with a name beside it.
    #[must_use]
    pub fn with_label(self, label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..self
        }
    }
}

/// Something drawn over the axes. A mark with a name has an entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Points; more than 150 are drawn small.
    Points {
        /// Name in the legend; empty for none.
        name: String,
        /// Shape of each.
        shape: Shape,
        /// Colour of the inside.
        fill: String,
        /// Colour of the rim and of the error bars.
        rim: String,
        /// The points.
        points: Vec<PlotPoint>,
    },
    /// Lines; parts outside of the axes are cut off.
    Line {
        /// Name in the legend; empty for none.
        name: String,
        /// Colour.
        colour: String,
        /// Width, px.
        width: f64,
        /// Whether it is dashed.
        dashed: bool,
        /// Text written along the line if there is room; empty for none.
        label: String,
        /// Pieces, each a chain of places (x, y).
        pieces: Vec<Vec<[f64; 2]>>,
    },
    /// Areas; parts outside of the axes are cut off.
    Area {
        /// Name in the legend; empty for none.
        name: String,
        /// Colour.
        colour: String,
        /// 0 invisible to 1 opaque.
        opacity: f64,
        /// Closed outlines of places (x, y); one inside another is a hole.
        outlines: Vec<Vec<[f64; 2]>>,
    },
    /// A dashed line across the plot with its name on it, or above the plot if it is upright.
    Level {
        /// What it is; empty for none.
        name: String,
        /// Its value on the vertical axis, or on the horizontal one if it is upright.
        value: f64,
        /// Whether it is upright.
        upright: bool,
    },
    /// A text.
    Text {
        /// Place (x, y) in the units of the axes.
        place: [f64; 2],
        /// Shift from there to the right and downwards, px.
        shift: [f64; 2],
        /// The text.
        text: String,
        /// The part of the text at its place.
        anchor: Anchor,
        /// Whether it is bold.
        bold: bool,
        /// Turn, degrees clockwise.
        turn: f64,
    },
}

impl Mark {
    /// Points with a filled shape.
    pub fn points(
        name: impl Into<String>,
        shape: Shape,
        colour: &str,
        points: Vec<PlotPoint>,
    ) -> Self {
        Self::Points {
            name: name.into(),
            shape,
            fill: colour.to_owned(),
            rim: colour.to_owned(),
            points,
        }
    }

    /// Points with an open shape.
    pub fn open_points(
        name: impl Into<String>,
        shape: Shape,
        rim: &str,
        points: Vec<PlotPoint>,
    ) -> Self {
        Self::Points {
            name: name.into(),
            shape,
            fill: colour::PAPER.to_owned(),
            rim: rim.to_owned(),
            points,
        }
    }

    /// Full lines without an entry in the legend.
    pub fn lines(colour: &str, width: f64, pieces: Vec<Vec<[f64; 2]>>) -> Self {
        Self::Line {
            name: String::new(),
            colour: colour.to_owned(),
            width,
            dashed: false,
            label: String::new(),
            pieces,
        }
    }

    /// A full line.
    pub fn line(name: impl Into<String>, colour: &str, points: Vec<[f64; 2]>) -> Self {
        Self::Line {
            name: name.into(),
            colour: colour.to_owned(),
            width: 1.8,
            dashed: false,
            label: String::new(),
            pieces: vec![points],
        }
    }

    /// A thin dashed line.
    pub fn dashed(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self::Line {
            name: name.into(),
            colour: colour::INK.to_owned(),
            width: 1.2,
            dashed: true,
            label: String::new(),
            pieces: vec![points],
        }
    }

    /// An area.
    pub fn area(
        name: impl Into<String>,
        colour: &str,
        opacity: f64,
        outlines: Vec<Vec<[f64; 2]>>,
    ) -> Self {
        Self::Area {
            name: name.into(),
            colour: colour.to_owned(),
            opacity,
            outlines,
        }
    }

    /// Level bars at the numbers of their names on the vertical axis, each from one value to another.
    pub fn bars(name: impl Into<String>, colour: &str, bars: &[(usize, [f64; 2])]) -> Self {
        let outline = |&(row, [from, to]): &(usize, [f64; 2])| {
            let [above, below] = [row as f64 - 0.34, row as f64 + 0.34];
            vec![[from, above], [to, above], [to, below], [from, below]]
        };
        Self::area(name, colour, 0.9, bars.iter().map(outline).collect())
    }

    /// A level line.
    pub fn level(name: impl Into<String>, value: f64) -> Self {
        Self::Level {
            name: name.into(),
            value,
            upright: false,
        }
    }

    /// An upright line.
    pub fn upright(name: impl Into<String>, value: f64) -> Self {
        Self::Level {
            name: name.into(),
            value,
            upright: true,
        }
    }

    /// A text at a place, shifted by px to the right and downwards.
    pub fn text(text: impl Into<String>, place: [f64; 2], shift: [f64; 2], anchor: Anchor) -> Self {
        Self::Text {
            place,
            shift,
            text: text.into(),
            anchor,
            bold: false,
            turn: 0.0,
        }
    }
}

impl Mark {
    /// Its entry in the legend; empty for none.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Points { name, .. } | Self::Line { name, .. } | Self::Area { name, .. } => name,
            Self::Level { .. } | Self::Text { .. } => "",
        }
    }

    /// All places that it has; those of a level have its value twice.
    pub(crate) fn places(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Points { points, .. } => points.iter().map(|p| [p.x, p.y]).collect(),
            Self::Line { pieces, .. } => pieces.concat(),
            Self::Area { outlines, .. } => outlines.concat(),
            Self::Level { value, .. } => vec![[*value; 2]],
            Self::Text { place, .. } => vec![*place],
        }
    }

    /// Values that an axis without ends of its own must show: of points with their error bars, areas, and the levels of this axis.
    pub(crate) fn values(&self, upright: bool) -> Vec<f64> {
        let axis = usize::from(upright);
        match self {
            Self::Points { points, .. } => points
                .iter()
                .flat_map(|p| {
                    let (value, error) = if upright {
                        (p.y, p.y_error)
                    } else {
                        (p.x, p.x_error)
                    };
                    [value - error, value + error]
                })
                .collect(),
            Self::Area { .. } => self.places().iter().map(|place| place[axis]).collect(),
            Self::Level {
                value,
                upright: stands,
                ..
            } if *stands != upright => vec![*value],
            Self::Level { .. } | Self::Line { .. } | Self::Text { .. } => Vec::new(),
        }
    }
}

/// Colours that all charts share.
pub mod colour {
    pub use crate::style::{AXIS, BAND, BLUE, INK, PAPER, VERMILION, sequential, series};
}

/// The scale of colours beside a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourBar {
    /// The quantity.
    pub title: AxisTitle,
    /// First and last value.
    pub ends: [f64; 2],
    /// Values at which the colour changes, ascending, between the ends.
    pub levels: Vec<f64>,
}

impl ColourBar {
    /// Colour of the band with a number, from 0 below the first level: that of its middle.
    pub fn colour(&self, band: usize) -> String {
        let [low, high] = self.ends;
        let below = band.checked_sub(1).and_then(|k| self.levels.get(k));
        let [from, to] = [below, self.levels.get(band)].map(Option::<&f64>::copied);
        let middle = 0.5 * (from.unwrap_or(low) + to.unwrap_or(high));
        colour::sequential((middle - low) / (high - low))
    }
}

/// Shape of the plot area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Format {
    /// As wide as the picture, with this height, px.
    Height(f64),
    /// A square of this side, px.
    Square(f64),
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The marks, the lowest first.
    pub marks: Vec<Mark>,
    /// Scale of colours; `None` without one.
    pub bar: Option<ColourBar>,
    /// Shape of the plot area.
    pub format: Format,
}

impl Plot {
    /// Axes without marks. With names on the vertical axis the height follows from their number.
    pub fn new(x: Axis, y: Axis) -> Self {
        let format = match &y {
            Axis::Names(names) => Format::Height(24.0 * names.len() as f64),
            _ => Format::Height(340.0),
        };
        Self {
            x,
            y,
            marks: Vec::new(),
            bar: None,
            format,
        }
    }

    /// The plot with a mark over those that it has.
    #[must_use]
    pub fn with(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// The plot with marks over those that it has.
    #[must_use]
    pub fn with_all(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }

    /// What the plot shows, for messages and for readers who cannot see it: "angle (°) against friction".
    pub(crate) fn description(&self) -> String {
        let title = |axis: &Axis| match axis {
            Axis::Numbers { title, .. } => title.to_string(),
            Axis::Names(_) | Axis::Hidden(_) => String::new(),
        };
        match (&self.bar, title(&self.y), title(&self.x)) {
            (Some(bar), y, x) => format!("{} over {x} and {y}", bar.title),
            (None, y, x) if y.is_empty() => x,
            (None, y, x) if x.is_empty() => y,
            (None, y, x) => format!("{y} against {x}"),
        }
    }

    /// Refuses what cannot be drawn.
    ///
    /// # Errors
    /// [`Error::TooFew`], [`Error::NonFinite`], [`Error::OutOfRange`].
    pub(crate) fn check(&self) -> Result<(), Error> {
        let of = |field| Field::new("chart", field);
        // Levels, texts and dashed lines are read with what is shown, and show nothing alone.
        let is_aid = |mark: &Mark| {
            matches!(
                mark,
                Mark::Level { .. } | Mark::Text { .. } | Mark::Line { dashed: true, .. }
            )
        };
        let shows = |mark: &&Mark| !is_aid(mark);
        let shown = self.marks.iter().filter(shows);
        of("places").at_least(1, shown.map(|mark| mark.places().len()).sum())?;
        for axis in [&self.x, &self.y] {
            if let Axis::Numbers {
                ends: Some(ends), ..
            }
            | Axis::Hidden(ends) = axis
            {
                of("end of an axis").finite(*ends)?;
            }
        }
        for mark in &self.marks {
            let places = mark.places();
            of("x").finite(places.iter().map(|place| place[0]))?;
            of("y").finite(places.iter().map(|place| place[1]))?;
            if let Mark::Points { points, .. } = mark {
                of("error").not_negative(points.iter().map(|point| point.x_error))?;
                of("error").not_negative(points.iter().map(|point| point.y_error))?;
            }
        }
        Ok(())
    }
}
