//! Plots that several reports show.

use probability::normal_quantile;

use crate::Error;
use crate::check::Field;
use crate::marching_squares::{Lattice, area_at_or_above, contour_lines};
use crate::plot::{Axis, AxisTitle, ColourBar, Format, Mark, Plot, PlotPoint, colour};
use crate::svg::{Anchor, Shape};
use crate::ticks::{Domain, Ticks, plain, short};

/// A named series of points that are joined: a mark for the line and one for the points. Series differ in colour and shape.
pub fn series(number: usize, name: &str, points: Vec<PlotPoint>) -> [Mark; 2] {
    let line = points.iter().map(|p| [p.x, p.y]).collect();
    let colour = colour::series(number);
    [
        Mark::line("", colour, line),
        Mark::points(name, Shape::of_series(number), colour, points),
    ]
}

/// Points over two axes; `marked` ones stand out.
pub fn scatter(x: AxisTitle, y: AxisTitle, points: Vec<PlotPoint>, marked: Vec<PlotPoint>) -> Plot {
    let points_with = |shape, fill: &str, points| Mark::Points {
        name: String::new(),
        shape,
        fill: fill.to_owned(),
        rim: colour::PAPER.to_owned(),
        points,
    };
    Plot::new(x.into(), y.into())
        .with(points_with(Shape::Circle, colour::BLUE, points))
        .with(points_with(Shape::Diamond, colour::INK, marked))
}

/// Signed sizes by name as bars, the largest on top, its sign by colour, with named limits.
pub fn pareto(size: &AxisTitle, effects: &[(String, f64)], limits: &[(&str, f64)]) -> Plot {
    let mut sorted: Vec<&(String, f64)> = effects.iter().collect();
    sorted.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let largest = sorted.first().map_or(0.0, |effect| effect.1.abs());
    let bars = |is_of_sign: fn(f64) -> bool| -> Vec<(usize, [f64; 2])> {
        let rows = sorted.iter().enumerate();
        rows.filter(|(_, effect)| is_of_sign(effect.1))
            .map(|(row, effect)| (row, [0.0, effect.1.abs()]))
            .collect()
    };
    let number = |(row, effect): (usize, &&(String, f64))| {
        let size = effect.1.abs();
        Mark::text(
            like_the_largest(size, largest),
            [size, row as f64],
            [5.0, 0.0],
            Anchor::Start,
        )
    };
    let mut limits = limits.to_vec();
    limits.sort_by(|a, b| b.1.total_cmp(&a.1));
    let farthest = limits.iter().fold(largest, |most, limit| most.max(limit.1));
    let x = Axis::Numbers {
        title: size.clone(),
        // Room for the number behind the longest bar.
        ends: Some([0.0, 1.1 * farthest.max(1e-300)]),
    };
    let names = sorted.iter().map(|effect| effect.0.clone()).collect();
    Plot::new(x, Axis::Names(names))
        .with(Mark::bars(
            "raises the response (+)",
            colour::BLUE,
            &bars(|size| size >= 0.0),
        ))
        .with(Mark::bars(
            "lowers it (−)",
            colour::VERMILION,
            &bars(|size| size < 0.0),
        ))
        .with_all(limits.iter().map(|(name, at)| Mark::upright(*name, *at)))
        .with_all(sorted.iter().enumerate().map(number))
}

/// A size with as many decimals as the largest size needs for three digits.
fn like_the_largest(size: f64, largest: f64) -> String {
    let longest = short(largest);
    if longest.contains('×') {
        return short(size);
    }
    plain(
        size,
        longest
            .split_once('.')
            .map_or(0, |(_, decimals)| decimals.len()),
    )
}

/// Half-normal plot of signed effects by name: those off the line are real.
///
/// `standard_error` is that of an effect: the slope of the line on which effects of pure noise lie. Effects above the first limit
/// are named; all are without limits.
///
/// # Formula
/// The i-th smallest of n absolute effects is drawn at the half-normal quantile of (i - 1/2) / n `[Daniel1959]`.
pub fn half_normal(
    size: &AxisTitle,
    effects: &[(String, f64)],
    standard_error: Option<f64>,
    limits: &[(&str, f64)],
) -> Plot {
    let mut sorted: Vec<&(String, f64)> = effects.iter().collect();
    sorted.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let count = sorted.len() as f64;
    let named_above = limits.first().map_or(0.0, |limit| limit.1);
    let points = |is_shown: &dyn Fn(f64) -> bool| -> Vec<PlotPoint> {
        let all = sorted
            .iter()
            .enumerate()
            .filter(|(_, effect)| is_shown(effect.1));
        all.map(|(rank, (name, effect))| {
            let quantile = half_normal_quantile((rank as f64 + 0.5) / count);
            let point = PlotPoint::new(quantile, effect.abs());
            let label = if effect.abs() > named_above { name } else { "" };
            point.with_label(label)
        })
        .collect()
    };
    let largest = sorted.last().map_or(0.0, |effect| effect.1.abs());
    let highest = limits.iter().fold(largest, |most, limit| most.max(limit.1));
    let right = 1.12 * half_normal_quantile((count - 0.5) / count);
    let between = |title, high| Axis::Numbers {
        title,
        ends: Some([0.0, high]),
    };
    let marks = [
        ("positive", colour::BLUE, points(&|e| e > named_above)),
        ("negative", colour::VERMILION, points(&|e| e < -named_above)),
    ];
    // Also what is not a number, so that the plot is refused.
    let small = points(&|e| e.abs() <= named_above || e.is_nan());
    let noise = Mark::open_points("not above the limit", Shape::Circle, colour::AXIS, small);
    let line =
        standard_error.map(|se| Mark::dashed("noise alone", vec![[0.0, 0.0], [right, right * se]]));
    Plot::new(
        between(AxisTitle::new("Half-normal quantile", ""), right),
        between(
            size.clone(),
            if highest > 0.0 { 1.08 * highest } else { 1.0 },
        ),
    )
    .with_all(line)
    .with_all(limits.iter().map(|(name, at)| Mark::level(*name, *at)))
    .with_all(marks.map(|(name, colour, points)| Mark::points(name, Shape::Circle, colour, points)))
    .with(noise)
}

/// The z with P(|Z| < z) = `probability` of a standard normal Z, for 0 < `probability` < 1; 7.5 beyond that.
fn half_normal_quantile(probability: f64) -> f64 {
    const FARTHEST: f64 = 7.5;
    let quantile = normal_quantile(0.5 * (1.0 + probability));
    quantile.map_or(FARTHEST, |z| z.min(FARTHEST))
}

/// Values on a grid over two factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Title of the horizontal axis.
    pub x: AxisTitle,
    /// Title of the vertical axis.
    pub y: AxisTitle,
    /// Title of the values.
    pub response: AxisTitle,
    /// Columns, ascending, in the unit of the horizontal axis.
    pub x_values: Vec<f64>,
    /// Rows, ascending, in the unit of the vertical axis.
    pub y_values: Vec<f64>,
    /// Values of shape (rows, columns), row by row, in the unit of the response.
    pub values: Vec<f64>,
}

impl Grid {
    /// Filled contours of the values with a bar of their colours. What `also` shows may widen the axes.
    ///
    /// # Errors
    /// [`Error`] for a grid of fewer than 2 x 2 values, axes that do not ascend, or another number of values.
    pub fn contours(&self, also: Vec<Mark>) -> Result<Plot, Error> {
        self.check(&self.values)?;
        let range = Domain::tight(self.values.iter().copied());
        let levels = Ticks::of(range, 8.0);
        let bar = ColourBar {
            title: self.response.clone(),
            ends: [range.low, range.high],
            levels: levels.values.clone(),
        };
        let lattice = self.lattice(&self.values);
        // The lowest colour first, each higher band over it, so that no seam shows; every value is above the first level.
        let bands = [f64::MIN].into_iter().chain(levels.values.iter().copied());
        let bands = bands.enumerate().map(|(band, level)| {
            let outlines = points_of(area_at_or_above(&lattice, level));
            Mark::area("", &bar.colour(band), 1.0, outlines)
        });
        let lines = levels.values.iter().zip(&levels.labels);
        let lines = lines.map(|(level, label)| Mark::Line {
            name: String::new(),
            colour: colour::PAPER.to_owned(),
            width: 0.9,
            dashed: false,
            label: label.clone(),
            pieces: points_of(contour_lines(&lattice, *level)),
        });
        let axis = |title: &AxisTitle, grid: &[f64], upright: bool| Axis::Numbers {
            title: title.clone(),
            ends: Some(widened(
                grid,
                also.iter().flat_map(|mark| mark.values(upright)),
            )),
        };
        let mut plot = Plot::new(
            axis(&self.x, &self.x_values, false),
            axis(&self.y, &self.y_values, true),
        );
        plot.format = Format::Height(400.0);
        let marks: Vec<Mark> = bands.chain(lines).collect();
        plot.bar = Some(bar);
        Ok(plot.with_all(marks).with_all(also))
    }

    /// A bold line through all places at which the response has a value.
    ///
    /// # Errors
    /// As [`Grid::contours`].
    pub fn bold_line(&self, name: &str, value: f64) -> Result<[Mark; 2], Error> {
        self.check(&self.values)?;
        let pieces = points_of(contour_lines(&self.lattice(&self.values), value));
        let line = |name: &str, colour: &str, width| Mark::Line {
            name: name.to_owned(),
            colour: colour.to_owned(),
            width,
            dashed: false,
            label: String::new(),
            pieces: pieces.clone(),
        };
        Ok([
            line("", colour::PAPER, 5.0),
            line(name, colour::VERMILION, 3.0),
        ])
    }

    /// The shaded region in which a field on the same grid is at or above 0, with its edge. The zero line is interpolated: give a
    /// smooth field if there is one.
    ///
    /// # Errors
    /// As [`Grid::contours`], also of the field.
    pub fn region(&self, name: &str, field: &[f64]) -> Result<[Mark; 2], Error> {
        self.check(field)?;
        let lattice = self.lattice(field);
        let outlines = points_of(area_at_or_above(&lattice, 0.0));
        let edge = Mark::Line {
            name: String::new(),
            colour: colour::INK.to_owned(),
            width: 1.0,
            dashed: true,
            label: String::new(),
            pieces: points_of(contour_lines(&lattice, 0.0)),
        };
        Ok([Mark::area(name, colour::INK, 0.16, outlines), edge])
    }

    /// Refuses a grid without area and values that do not match it.
    fn check(&self, values: &[f64]) -> Result<(), Error> {
        let of = |field| Field::new("contours", field);
        of("columns").at_least(2, self.x_values.len())?;
        of("rows").at_least(2, self.y_values.len())?;
        of("column").ascending(&self.x_values)?;
        of("row").ascending(&self.y_values)?;
        let nodes = self.x_values.len() * self.y_values.len();
        of("values").length(nodes, "node of the grid", values.len())?;
        of("value").finite(values.iter().copied())
    }

    /// Values on the grid.
    fn lattice<'a>(&'a self, values: &'a [f64]) -> Lattice<'a> {
        Lattice {
            x: &self.x_values,
            y: &self.y_values,
            values,
        }
    }
}

/// Named points as the contours show them: black, with their names.
pub fn marked_points(points: Vec<PlotPoint>) -> Mark {
    Mark::Points {
        name: String::new(),
        shape: Shape::Circle,
        fill: colour::INK.to_owned(),
        rim: colour::PAPER.to_owned(),
        points,
    }
}

/// Runs of a design as the contours show them: open squares that say which they are.
pub fn design_runs(runs: Vec<PlotPoint>) -> Option<Mark> {
    let name = "runs of the design";
    (!runs.is_empty()).then(|| Mark::open_points(name, Shape::Square, colour::INK, runs))
}

/// The places of lines.
fn points_of(lines: Vec<crate::marching_squares::ContourLine>) -> Vec<Vec<[f64; 2]>> {
    lines.into_iter().map(|line| line.points).collect()
}

/// What an axis shows: the grid, and a margin beyond the values outside of it.
fn widened(grid: &[f64], values: impl Iterator<Item = f64>) -> [f64; 2] {
    let edge = Domain::tight(grid.iter().copied());
    let all = Domain::tight(grid.iter().copied().chain(values));
    let room = 0.05 * (all.high - all.low);
    [
        if all.low < edge.low {
            all.low - room
        } else {
            edge.low
        },
        if all.high > edge.high {
            all.high + room
        } else {
            edge.high
        },
    ]
}
