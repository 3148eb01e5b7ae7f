//! The angle of repose of a heap: both flanks and the apex.

use crate::correlation::correlation_factor;
use crate::line::direction;
use crate::line_error::{TAU_PART, widening};
use crate::median::median;
use crate::{Error, SurfacePoint};
use serde::{Deserialize, Serialize};

/// A flank is fitted between these parts of the height: the foot spreads, the apex is round.
const FLANK: [f64; 2] = [0.2, 0.8];
/// The same by another choice, as good as the first; the change counts as one standard deviation.
const OTHER_FLANK: [f64; 2] = [0.25, 0.75];
/// A flank ends where the outline first comes below this part of the height.
const FOOT: f64 = 0.1;
/// The apex lies in the middle of what stands above this part of the height.
const CROWN: f64 = 0.9;
/// Fewest points on a flank.
const FEWEST: usize = 12;
/// Least height of a heap, parts of the width of the outline.
const LEAST_HEIGHT: f64 = 0.05;
/// Points beyond so many robust standard deviations from the line of a flank are outliers.
const CUT_IN_SD: f64 = 4.0;
/// No point nearer to the line than this part of the height is an outlier.
const LEAST_CUT: f64 = 0.02;
/// Largest root mean square distance from the line of a flank, parts of the height.
const MOST_ROUGHNESS: f64 = 0.08;

/// Largest difference between the inclinations of the upper and the lower half of a flank, rad:
/// 13 degrees. The outline of a ball or of a drum has 17.
const MOST_BEND: f64 = 0.23;

/// Steepest flank, rad: 70 degrees. Powders that cling stand at 60; beyond is a wall.
const STEEPEST: f64 = 1.222;

/// One flank of a heap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeapFlank {
    /// Inclination from the horizontal, 0 to pi/2, rad.
    pub inclination: f64,
    /// Standard error of the inclination; 1.96 of it are half of the 95 % interval, rad.
    pub standard_error: f64,
    /// Ends of the fitted line: upper, lower.
    pub ends: [SurfacePoint; 2],
}

/// The flanks and the apex of a heap.
#[derive(Debug, Clone, PartialEq)]
pub struct HeapAngle {
    /// The flank at small x.
    pub left: HeapFlank,
    /// The flank at large x.
    pub right: HeapFlank,
    /// Where the lines of the flanks meet.
    pub apex: SurfacePoint,
    /// By how much the heap itself stays below that point, unit of the points.
    pub rounding: f64,
    /// Height of the outline from foot to top, unit of the points.
    pub height: f64,
    /// For each point given, whether it counts.
    pub used: Vec<bool>,
}

impl HeapAngle {
    /// Mean inclination of both flanks, rad.
    pub fn mean(&self) -> f64 {
        0.5 * (self.left.inclination + self.right.inclination)
    }

    /// Standard error of the mean inclination, rad.
    pub fn standard_error(&self) -> f64 {
        0.5 * self.left.standard_error.hypot(self.right.standard_error)
    }
}

/// Measures a heap by its outline, seen from the side.
///
/// # Formula
/// Height H: from the 5 % to the 99 % quantile of the heights. Flank: the points from the apex
/// outwards to where the outline first comes below 0.1 H, of them those between 0.2 H and 0.8 H;
/// principal axis `[Pearson1901]`, outliers beyond 4 robust standard deviations set aside.
/// Standard error: `sqrt(s^2 tau / Suu)` as in [`crate::measure`] with two fitted parameters, and the
/// change of the inclination when the flank ends a twentieth of the height earlier on either side:
/// where a foot and a round top begin is a choice.
///
/// # Errors
/// [`Error::NotFinitePoint`], [`Error::TooFewPoints`], [`Error::NoHeap`] for an outline without
/// height, with a flank that is missing, does not fall outwards, is a wall, is bent, or is too rough to be
/// a line.
pub fn measure_heap(points: &[SurfacePoint]) -> Result<HeapAngle, Error> {
    if let Some(index) = points
        .iter()
        .position(|p| !(p.x.is_finite() && p.y.is_finite()))
    {
        let SurfacePoint { x, y } = points[index];
        return Err(Error::NotFinitePoint { index, x, y });
    }
    let least = 4 * FEWEST;
    if points.len() < least {
        let n = points.len();
        return Err(Error::TooFewPoints { n, least });
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a].x.total_cmp(&points[*b].x));
    let mut heights: Vec<f64> = points.iter().map(|p| p.y).collect();
    heights.sort_by(f64::total_cmp);
    let base = heights[heights.len() / 20];
    let top = heights[heights.len() * 99 / 100];
    let height = top - base;
    let width = points[order[order.len() - 1]].x - points[order[0]].x;
    if height <= LEAST_HEIGHT * width {
        return Err(Error::NoHeap {
            what: "the outline is flat",
        });
    }
    let level = |p: &SurfacePoint| (p.y - base) / height;
    let mut crown: Vec<f64> = points
        .iter()
        .filter(|p| level(p) >= CROWN)
        .map(|p| p.x)
        .collect();
    let middle = median(&mut crown);
    let split = order.partition_point(|k| points[*k].x < middle);
    let outwards = [
        order[..split].iter().rev().copied().collect::<Vec<usize>>(),
        order[split..].to_vec(),
    ];
    let mut used = vec![false; points.len()];
    let mut flanks = Vec::new();
    for (indices, side) in outwards.iter().zip([-1.0, 1.0]) {
        let members: Vec<usize> = indices
            .iter()
            .copied()
            .take_while(|k| level(&points[*k]) >= FOOT)
            .filter(|k| (FLANK[0]..=FLANK[1]).contains(&level(&points[*k])))
            .collect();
        let others = members.iter().copied();
        let others = others
            .filter(|k| (OTHER_FLANK[0]..=OTHER_FLANK[1]).contains(&level(&points[*k])))
            .collect();
        let mut found = flank(points, members, (side, height), &mut used)?;
        let mut aside = vec![false; points.len()];
        if let Ok(other) = flank(points, others, (side, height), &mut aside) {
            let change = other.inclination - found.inclination;
            found.standard_error = found.standard_error.hypot(change);
        }
        flanks.push(found);
    }
    let apex = meeting(&flanks[0], &flanks[1]);
    Ok(HeapAngle {
        left: flanks[0],
        right: flanks[1],
        apex,
        rounding: apex.y - top,
        height,
        used,
    })
}

/// The line through the members of one flank; side is -1 for the left one.
fn flank(
    points: &[SurfacePoint],
    mut members: Vec<usize>,
    (side, height): (f64, f64),
    used: &mut [bool],
) -> Result<HeapFlank, Error> {
    let no_heap = |what| Err(Error::NoHeap { what });
    for _ in 0..10 {
        if members.len() < FEWEST {
            return no_heap("a flank is missing");
        }
        let line = Line::through(points, &members);
        let mut sizes: Vec<f64> = members
            .iter()
            .map(|k| line.off(&points[*k]).abs())
            .collect();
        let cut = (CUT_IN_SD * 1.4826 * median(&mut sizes)).max(LEAST_CUT * height);
        let before = members.len();
        members.retain(|k| line.off(&points[*k]).abs() <= cut);
        if members.len() == before {
            break;
        }
    }
    let (upper, lower) = members.split_at(members.len() / 2);
    let halves = [upper, lower].map(|half| Line::through(points, half).inclination);
    if (halves[0] - halves[1]).abs() > MOST_BEND {
        return no_heap("a flank is bent, as the outline of a ball or a drum is");
    }
    let line = Line::through(points, &members);
    let fall = -side * line.inclination;
    if fall <= 0.0 {
        return no_heap("a flank does not fall outwards");
    }
    if fall > STEEPEST {
        return no_heap("a flank is steeper than 70 degrees, as a wall is");
    }
    let residuals: Vec<f64> = members.iter().map(|k| line.off(&points[*k])).collect();
    let n = residuals.len() as f64;
    let mean_square = residuals.iter().map(|r| r * r).sum::<f64>() / n;
    if mean_square.sqrt() > MOST_ROUGHNESS * height {
        return no_heap("a flank is too rough for a line");
    }
    let along: Vec<f64> = members.iter().map(|k| line.along(&points[*k])).collect();
    let tau = correlation_factor(&residuals, 2.0);
    let freedom = (n / tau - 2.0).max(3.0);
    let variance = mean_square * (n / tau / freedom).max(1.0);
    let suu: f64 = along.iter().map(|u| u * u).sum();
    for k in &members {
        used[*k] = true;
    }
    let (low, high) = along
        .iter()
        .fold((0.0, 0.0), |b: (f64, f64), u| (b.0.min(*u), b.1.max(*u)));
    let ends = [line.place(low), line.place(high)];
    Ok(HeapFlank {
        inclination: fall,
        standard_error: (variance * tau / suu).sqrt() * widening((TAU_PART * freedom).max(3.0)),
        ends: if ends[0].y > ends[1].y {
            ends
        } else {
            [ends[1], ends[0]]
        },
    })
}

/// A straight line through the centroid of points.
struct Line {
    /// Centroid.
    centre: SurfacePoint,
    /// Inclination, positive when it rises to the right, rad.
    inclination: f64,
}

impl Line {
    /// The principal axis of the members.
    fn through(points: &[SurfacePoint], members: &[usize]) -> Self {
        let n = members.len().max(1) as f64;
        let centre = SurfacePoint {
            x: members.iter().map(|k| points[*k].x).sum::<f64>() / n,
            y: members.iter().map(|k| points[*k].y).sum::<f64>() / n,
        };
        let places = members.iter().map(|k| (points[*k].x, points[*k].y));
        Self {
            centre,
            inclination: direction(places).unwrap_or(0.0),
        }
    }

    /// Distance of a point from the line, positive above.
    fn off(&self, p: &SurfacePoint) -> f64 {
        let (sin, cos) = self.inclination.sin_cos();
        (p.y - self.centre.y) * cos - (p.x - self.centre.x) * sin
    }

    /// Place of a point along the line.
    fn along(&self, p: &SurfacePoint) -> f64 {
        let (sin, cos) = self.inclination.sin_cos();
        (p.x - self.centre.x) * cos + (p.y - self.centre.y) * sin
    }

    /// The point at a place along the line.
    fn place(&self, along: f64) -> SurfacePoint {
        let (sin, cos) = self.inclination.sin_cos();
        SurfacePoint {
            x: self.centre.x + along * cos,
            y: self.centre.y + along * sin,
        }
    }
}

/// Where the lines of a left and a right flank meet; both fall outwards, so they do.
fn meeting(left: &HeapFlank, right: &HeapFlank) -> SurfacePoint {
    let (a, b) = (left.inclination.tan(), -right.inclination.tan());
    let (p, q) = (left.ends[0], right.ends[0]);
    let x = (q.y - p.y + a * p.x - b * q.x) / (a - b);
    SurfacePoint {
        x,
        y: p.y + a * (x - p.x),
    }
}

#[cfg(test)]
mod tests {
    use super::measure_heap;
    use crate::{Error, SurfacePoint};

    /// A heap with flanks of 30 and 40 degrees and its apex at (0, 100) on a base at height 0.
    fn outline() -> Vec<SurfacePoint> {
        (-300..=300)
            .map(|k| {
                let x = f64::from(k);
                let slope = if x < 0.0 { 30.0_f64 } else { 40.0 };
                let y = (100.0 - x.abs() * slope.to_radians().tan()).max(0.0);
                SurfacePoint { x, y }
            })
            .collect()
    }

    /// Exact lines come back to rounding.
    #[test]
    fn both_flanks_and_the_apex_of_an_exact_heap_come_back() {
        let heap = measure_heap(&outline()).unwrap();
        assert!(
            (heap.left.inclination.to_degrees() - 30.0).abs() < 1e-9,
            "{heap:?}"
        );
        assert!(
            (heap.right.inclination.to_degrees() - 40.0).abs() < 1e-9,
            "{heap:?}"
        );
        assert!(heap.apex.x.abs() < 1e-9 && (heap.apex.y - 100.0).abs() < 1e-9);
    }

    /// A grain stuck on one flank over a tenth of its length is set aside.
    #[test]
    fn a_stuck_grain_does_not_turn_a_flank() {
        let mut points = outline();
        for p in points.iter_mut().filter(|p| (-90.0..-80.0).contains(&p.x)) {
            p.y += 12.0;
        }
        let heap = measure_heap(&points).unwrap();
        assert!(
            (heap.left.inclination.to_degrees() - 30.0).abs() < 1e-6,
            "{heap:?}"
        );
    }

    /// The upper half of a circle rises to 90 degrees at its ends.
    #[test]
    fn the_outline_of_a_ball_is_no_heap() {
        let ball: Vec<SurfacePoint> = (-300..=300)
            .map(|k| {
                let x = f64::from(k);
                let y = (200.0_f64.powi(2) - x * x).max(0.0).sqrt();
                SurfacePoint { x, y }
            })
            .collect();
        assert!(matches!(measure_heap(&ball), Err(Error::NoHeap { .. })));
    }

    #[test]
    fn what_is_no_heap_is_refused() {
        let flat: Vec<SurfacePoint> = outline()
            .iter()
            .map(|p| SurfacePoint {
                x: p.x,
                y: 0.01 * p.y,
            })
            .collect();
        let half: Vec<SurfacePoint> = outline().into_iter().filter(|p| p.x >= 0.0).collect();
        for points in [flat, half] {
            assert!(matches!(measure_heap(&points), Err(Error::NoHeap { .. })));
        }
        assert!(measure_heap(&outline()[..20]).is_err(), "too few points");
        let mut bad = outline();
        bad[3].y = f64::NAN;
        assert!(measure_heap(&bad).is_err(), "NaN");
    }
}
