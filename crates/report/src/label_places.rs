//! Free places for names beside points.

use crate::geometry::{Point, Rect, at};
use crate::style::{AXIS, MARKER, SMALL_TEXT};
use crate::svg::{Anchor, Canvas, Halo, Stroke, TextStyle};
use crate::text::text_width;

/// Remembers what is taken, so that names do not cover points or each other.
#[derive(Debug, Clone)]
pub(crate) struct LabelPlaces {
    /// Where names may stand.
    area: Rect,
    /// What is taken.
    taken: Vec<Rect>,
}

/// Distance of the boxes along a line, px.
const LINE_STEP: f64 = 6.0;
/// Directions that are tried, best first: right and left, then slanted, then above and below.
const DIRECTIONS: [(f64, f64); 8] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.8, -0.75),
    (-0.8, -0.75),
    (0.8, 0.75),
    (-0.8, 0.75),
    (0.0, -1.0),
    (0.0, 1.0),
];
/// Distances that are tried, px; beyond the first a thin line joins name and point.
const DISTANCES: [f64; 4] = [9.0, 20.0, 34.0, 52.0];

impl LabelPlaces {
    /// An area without names.
    pub(crate) fn new(area: Rect) -> Self {
        Self {
            area,
            taken: Vec::new(),
        }
    }

    /// Keeps names away from a box.
    pub(crate) fn reserve(&mut self, area: Rect) {
        self.taken.push(area);
    }

    /// Keeps names away from a marker.
    pub(crate) fn reserve_marker(&mut self, place: Point) {
        let point = Rect {
            left: place.x,
            top: place.y,
            right: place.x,
            bottom: place.y,
        };
        self.reserve(point.grown(MARKER + 1.5));
    }

    /// Keeps names away from a line, by boxes set close along it.
    pub(crate) fn reserve_line(&mut self, points: &[Point]) {
        for pair in points.windows(2) {
            let &[from, to] = pair else { continue };
            let steps = ((to.x - from.x).hypot(to.y - from.y) / LINE_STEP)
                .ceil()
                .clamp(1.0, 500.0);
            let mut step = 0.0;
            while step <= steps {
                let share = step / steps;
                let x = from.x + share * (to.x - from.x);
                let y = from.y + share * (to.y - from.y);
                self.reserve(
                    Rect {
                        left: x,
                        top: y,
                        right: x,
                        bottom: y,
                    }
                    .grown(2.0),
                );
                step += 1.0;
            }
        }
    }

    /// Writes a name along a horizontal line at the height `y`, above or below it, at a place that
    /// is still free; at its right end above it if there is no such place.
    pub(crate) fn write_on_level(&mut self, canvas: &mut Canvas, y: f64, name: &str) {
        let width = text_width(name, SMALL_TEXT);
        let free = self.area.width() - width - 8.0;
        let place = |share: f64, side: f64| {
            let middle = y + side * (0.5 * SMALL_TEXT + 3.0);
            let left = self.area.left + 4.0 + share * free;
            Rect {
                left,
                top: middle - 0.5 * SMALL_TEXT,
                right: left + width,
                bottom: middle + 0.5 * SMALL_TEXT,
            }
        };
        let shares = [1.0, 0.0, 0.75, 0.25, 0.5];
        let wanted: Vec<Rect> = [-1.0, 1.0]
            .iter()
            .flat_map(|&side| shares.map(|share| place(share, side)))
            .collect();
        let chosen = wanted
            .iter()
            .find(|&&area| self.take(area))
            .or(wanted.first());
        if let Some(area) = chosen {
            let style = TextStyle {
                halo: Halo::Paper,
                ..TextStyle::small(Anchor::Start)
            };
            canvas.text(at(area.left, 0.5 * (area.top + area.bottom)), name, &style);
        }
    }

    /// Writes a name along a line at a free place; nothing if there is none.
    pub(crate) fn write_along(&mut self, canvas: &mut Canvas, line: &[Point], name: &str) {
        let size = SMALL_TEXT - 1.0;
        let width = text_width(name, size);
        let total = length(line);
        if total < 2.5 * width {
            return;
        }
        for share in [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88] {
            let ends = [-0.5, 0.5].map(|half| along(line, share * total + half * width));
            let [Some(from), Some(to)] = ends else {
                continue;
            };
            let middle = at(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
            let mut turn = (to.y - from.y).atan2(to.x - from.x).to_degrees();
            if turn.abs() > 90.0 {
                turn -= 180.0 * turn.signum();
            }
            let (sine, cosine) = turn.to_radians().sin_cos();
            let half_width = 0.5 * (width * cosine.abs() + SMALL_TEXT * sine.abs());
            let half_height = 0.5 * (width * sine.abs() + SMALL_TEXT * cosine.abs());
            let wanted = Rect {
                left: middle.x - half_width,
                right: middle.x + half_width,
                top: middle.y - half_height,
                bottom: middle.y + half_height,
            };
            if self.take(wanted) {
                let style = TextStyle {
                    size,
                    turn,
                    halo: Halo::Paper,
                    ..TextStyle::small(Anchor::Middle)
                };
                canvas.text(middle, name, &style);
                return;
            }
        }
    }

    /// Takes a box if it is free.
    pub(crate) fn take(&mut self, wanted: Rect) -> bool {
        let free =
            self.area.holds(&wanted) && !self.taken.iter().any(|box_| box_.overlaps(&wanted));
        if free {
            self.taken.push(wanted);
        }
        free
    }

    /// Writes a name beside a point if there is room; without any room nothing is written.
    pub(crate) fn write(&mut self, canvas: &mut Canvas, point: Point, name: &str, colour: &str) {
        let width = text_width(name, SMALL_TEXT);
        for distance in DISTANCES {
            for (right, down) in DIRECTIONS {
                let place = at(
                    point.x + right * distance,
                    point.y + down * (distance + 2.0),
                );
                let (anchor, left) = if right > 0.0 {
                    (Anchor::Start, place.x)
                } else if right < 0.0 {
                    (Anchor::End, place.x - width)
                } else {
                    (Anchor::Middle, place.x - 0.5 * width)
                };
                let wanted = Rect {
                    left,
                    top: place.y - 0.55 * SMALL_TEXT,
                    right: left + width,
                    bottom: place.y + 0.55 * SMALL_TEXT,
                };
                if self.take(wanted) {
                    if distance > DISTANCES[0] {
                        canvas.line(point, place, &Stroke::solid(AXIS, 0.7));
                    }
                    let style = TextStyle {
                        colour,
                        halo: Halo::Paper,
                        ..TextStyle::small(anchor)
                    };
                    canvas.text(place, name, &style);
                    return;
                }
            }
        }
    }
}

/// Length of a line, px.
fn length(points: &[Point]) -> f64 {
    points
        .windows(2)
        .map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y))
        .sum()
}

/// Point of a line at a distance from its beginning, px.
fn along(points: &[Point], distance: f64) -> Option<Point> {
    let mut left = distance;
    for pair in points.windows(2) {
        let &[from, to] = pair else { return None };
        let piece = (to.x - from.x).hypot(to.y - from.y);
        if left <= piece && piece > 0.0 {
            let share = left / piece;
            return Some(at(
                from.x + share * (to.x - from.x),
                from.y + share * (to.y - from.y),
            ));
        }
        left -= piece;
    }
    None
}
