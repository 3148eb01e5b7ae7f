//! One flank of a heap: its line and its curvature.

use crate::correlation::correlation_factor;
use crate::heap::FEWEST;
use crate::line::Line;
use crate::line_error::{TAU_PART, widening};
use crate::{Error, SurfacePoint};
use serde::{Deserialize, Serialize};

/// No point nearer to the line than this part of the height is an outlier.
const LEAST_CUT: f64 = 0.02;
/// Largest root mean square distance from the line of a flank, parts of the height.
const MOST_ROUGHNESS: f64 = 0.08;
/// By how much the lower half of a flank may be steeper than the upper one, rad: 13 degrees. The outline of a ball or of a
/// drum has 17.
const MOST_ROUND: f64 = 0.23;
/// By how much the upper half may be steeper, rad: 30 degrees. The foot of a heap of coarse or lively grains spreads, and
/// makes its flanks concave.
const MOST_HOLLOW: f64 = 0.52;
/// Steepest flank, rad: 70 degrees. Cohesive powders reach 60; a steeper flank is a wall.
const STEEPEST: f64 = 1.222;

/// One flank of a heap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeapFlank {
    /// Inclination from the horizontal, 0 to pi/2, rad.
    pub inclination: f64,
    /// Standard error of the inclination; 1.96 of it are half of the 95 % interval, rad.
    pub standard_error: f64,
    /// Inclination of its upper half, rad.
    pub top: f64,
    /// Inclination of its lower half, rad.
    pub toe: f64,
    /// Ends of the fitted line: upper, lower.
    pub ends: [SurfacePoint; 2],
}

/// The line through the members of one flank, from the top down; side is -1 for the left one.
pub(crate) fn flank(
    points: &[SurfacePoint],
    members: Vec<usize>,
    (side, height): (f64, f64),
    used: &mut [bool],
) -> Result<HeapFlank, Error> {
    let no_heap = |what| Err(Error::NoHeap { what });
    let (line, members) = Line::near(points, members, LEAST_CUT * height);
    if members.len() < FEWEST {
        return no_heap("a flank is missing");
    }
    let fall = -side * line.inclination;
    if fall <= 0.0 {
        return no_heap("a flank does not fall outwards");
    }
    if fall > STEEPEST {
        return no_heap("a flank is steeper than 70 degrees, like a wall");
    }
    let (upper, lower) = members.split_at(members.len() / 2);
    let [top, toe] = [upper, lower].map(|half| -side * Line::through(points, half).inclination);
    if toe - top > MOST_ROUND {
        return no_heap(
            "a flank is curved, like the outline of a ball, a drum or a heap seen from above",
        );
    }
    if top - toe > MOST_HOLLOW {
        return no_heap("a flank is curved, like that of a spire");
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
        top,
        toe,
        standard_error: (variance * tau / suu).sqrt() * widening((TAU_PART * freedom).max(3.0)),
        ends: if ends[0].y > ends[1].y {
            ends
        } else {
            [ends[1], ends[0]]
        },
    })
}
