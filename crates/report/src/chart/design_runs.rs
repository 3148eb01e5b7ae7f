//! Runs of a design in a plane of two factors.

use serde::{Deserialize, Serialize};

use crate::geometry::{Point, at};
use crate::label_places::LabelPlaces;
use crate::legend::{LegendEntry, Sample};
use crate::plot::Plot;
use crate::style::{INK, PAPER};
use crate::svg::{Canvas, Shape};

/// Marks side by side before the next row begins.
const IN_A_ROW: usize = 4;
/// Distance of marks that stand for one place, px.
const STEP: f64 = 10.0;

/// A run, or the runs of one point, of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignRun {
    /// Which it is, with its settings; shown where the mouse rests.
    pub name: String,
    /// Place on the horizontal axis, in its unit.
    pub x: f64,
    /// Place on the vertical axis, in its unit.
    pub y: f64,
    /// Part of the page that a click opens, such as `#run-1-3`; empty for none.
    pub link: String,
}

/// What the marks mean; nothing without runs.
pub(crate) fn legend_entry(runs: &[DesignRun]) -> Option<LegendEntry<'static>> {
    (!runs.is_empty()).then_some(LegendEntry {
        sample: Sample::Marker(Shape::Square, PAPER, INK),
        name: "runs of the design",
    })
}

/// Places of the marks, px: those of one place of the plane, which differ in factors that are not shown, stand side by
/// side around it, or are shifted inwards if they would leave the plane and cover the names of an axis.
fn places(runs: &[DesignRun], plot: &Plot) -> Vec<Point> {
    let same = |a: &DesignRun, b: &DesignRun| {
        let [a, b] = [a, b].map(|run| plot.place(run.x, run.y));
        (a.x - b.x).hypot(a.y - b.y) < 1.0
    };
    let place = |(number, run): (usize, &DesignRun)| {
        let before = runs[..number]
            .iter()
            .filter(|other| same(other, run))
            .count();
        let all = runs.iter().filter(|other| same(other, run)).count();
        let middle = |count: usize| 0.5 * (count as f64 - 1.0);
        let across = (before % IN_A_ROW) as f64 - middle(all.min(IN_A_ROW));
        let down = (before / IN_A_ROW) as f64 - middle(all.div_ceil(IN_A_ROW));
        let Point { x, y } = plot.place(run.x, run.y);
        // How far the outermost marks stand from the middle of all.
        let [wide, high] = [all.min(IN_A_ROW), all.div_ceil(IN_A_ROW)].map(|n| STEP * middle(n));
        let area = &plot.area;
        at(
            within(x, [area.left + wide, area.right - wide]) + STEP * across,
            within(y, [area.top + high, area.bottom - high]) + STEP * down,
        )
    };
    runs.iter().enumerate().map(place).collect()
}

/// The nearest number between two ends; the given one if they leave no room.
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    if low <= high { x.clamp(low, high) } else { x }
}

/// Keeps names away from the runs.
pub(crate) fn reserve(plot: &Plot, names: &mut LabelPlaces, runs: &[DesignRun]) {
    for place in places(runs, plot) {
        names.reserve_marker(place);
    }
}

/// Draws the runs; those on the edge of the plane stand whole.
pub(crate) fn draw(canvas: &mut Canvas, plot: &Plot, runs: &[DesignRun]) {
    for (run, place) in runs.iter().zip(places(runs, plot)) {
        canvas.begin_link(&run.link, &run.name);
        canvas.marker(Shape::Square, place, PAPER, INK);
        canvas.end_link(&run.link);
    }
}
