//! Whether the picture agrees with the surface that was found in it.

use crate::Refusal;
use crate::tone::BedShare;
use crate::view::{DiscView, REACH};
use surface_profile::{SurfacePoint, SurfaceReading};

/// The step is taken between these distances from the surface, in drum radii.
const STEP_BAND: [f64; 2] = [0.05, 0.12];
/// Places in the band on either side of a surface point.
const N_IN_BAND: i32 = 8;
/// A stretch of the surface whose step is less than this has no surface.
const CLEAR_STEP: f64 = 0.25;
/// Half the length over which a local slope is taken, drum radii.
const SLOPE_REACH: f64 = 0.12;

/// Least step. A sharp or half-blurred surface has 0.9 to 1, a gradient of the light across an
/// empty drum less than 0.65, a lamp's reflection no step over most of the line.
const LEAST_STEP: f64 = 0.65;
/// Least part of the surface with a clear step.
const LEAST_CLEAR: f64 = 0.8;
/// Least contrast. Coarse grains leave 0.9; a ring of bed along the whole wall has 0.73.
const LEAST_CONTRAST: f64 = 0.8;
/// Steepest stretch that is still a slope, rad: 89.5 degrees. Grains of a tenth of the radius
/// reach 88, a cliff 90.
const STEEPEST: f64 = 1.562;
/// A stretch of a bed that is steep as a whole may be steeper than its line by this, rad: 45 degrees. The surface is a height over
/// its own line, and that of a cohesive bed at 60 degrees is one although its steps hang over. The cliff of a crumbled bed stands
/// 53 degrees off its line. Our choice: at 60 such cliffs would be read.
const MOST_OFF_LINE: f64 = std::f64::consts::FRAC_PI_4;

/// How well bed and air lie on their sides of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Agreement {
    /// Drop of the mean bed share across the surface, 1.
    pub(crate) step: f64,
    /// Part of the surface on which the step is clear, 1.
    pub(crate) clear: f64,
    /// Mean bed share below the surface less that above, over the whole disc, 1.
    pub(crate) contrast: f64,
    /// Steepest inclination of a stretch of the surface, rad; beyond pi/2 it overhangs.
    pub(crate) steepest: f64,
    /// Inclination of the line through the whole surface, rad.
    pub(crate) line: f64,
}

impl Agreement {
    /// Refuses a surface that the picture does not bear out.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let unclear = |step, least| Err(Refusal::NoClearSurface { step, least });
        if self.step < LEAST_STEP {
            unclear(self.step, LEAST_STEP)
        } else if self.clear < LEAST_CLEAR {
            Err(Refusal::SurfaceInParts {
                clear: self.clear,
                least: LEAST_CLEAR,
            })
        } else if self.contrast < LEAST_CONTRAST {
            Err(Refusal::BedOnBothSides {
                contrast: self.contrast,
                least: LEAST_CONTRAST,
            })
        } else if self.steepest > STEEPEST.max(self.line + MOST_OFF_LINE) {
            Err(Refusal::Overhang {
                steepest: self.steepest.to_degrees(),
                line: self.line.to_degrees(),
            })
        } else {
            Ok(())
        }
    }
}

/// Compares the bed share with the surface.
pub(crate) fn agreement(
    view: &DiscView,
    bed: &BedShare,
    points: &[SurfacePoint],
    surface: &SurfaceReading,
) -> Agreement {
    let axes = SurfaceAxes::new(surface);
    let steps = steps(view, bed, points, &axes);
    let n = steps.len().max(1) as f64;
    let used: Vec<(f64, f64)> = points
        .iter()
        .zip(&surface.used)
        .filter(|(_, used)| **used)
        .map(|(p, _)| axes.project(p.x, p.y))
        .collect();
    Agreement {
        step: steps.iter().sum::<f64>() / n,
        clear: steps.iter().filter(|s| **s > CLEAR_STEP).count() as f64 / n,
        contrast: contrast(view, bed, points, &axes),
        steepest: steepest(&used, surface.angle.line, SLOPE_REACH * view.radius()),
        line: surface.angle.line,
    }
}

/// The axes along the surface line: u from the high end to the low end, v up from it.
struct SurfaceAxes {
    /// Unit vector of u, 1.
    along: (f64, f64),
    /// Unit vector of v, 1.
    up: (f64, f64),
}

impl SurfaceAxes {
    /// The axes of a surface.
    fn new(surface: &SurfaceReading) -> Self {
        let [high, low] = surface.line_ends;
        let (dx, dy) = (low.x - high.x, low.y - high.y);
        let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
        let along = (dx / length, dy / length);
        let turn = if dx > 0.0 { 1.0 } else { -1.0 };
        Self {
            along,
            up: (-turn * along.1, turn * along.0),
        }
    }

    /// Coordinates (u, v) of a place.
    fn project(&self, x: f64, y: f64) -> (f64, f64) {
        (
            x * self.along.0 + y * self.along.1,
            x * self.up.0 + y * self.up.1,
        )
    }
}

/// Drop of the bed share from below to above each surface point, averaged over the band.
fn steps(view: &DiscView, bed: &BedShare, points: &[SurfacePoint], axes: &SurfaceAxes) -> Vec<f64> {
    let radius = view.radius();
    let (nx, ny) = axes.up;
    let mut steps = Vec::new();
    for p in points {
        let (mut sum, mut n) = (0.0, 0.0);
        for k in 0..N_IN_BAND {
            let part = (f64::from(k) + 0.5) / f64::from(N_IN_BAND);
            let distance = radius * (STEP_BAND[0] + (STEP_BAND[1] - STEP_BAND[0]) * part);
            let [below, above] = [-distance, distance].map(|d| (p.x + d * nx, p.y + d * ny));
            if below.0.hypot(below.1).max(above.0.hypot(above.1)) <= REACH * radius {
                n += 1.0;
                sum += bed.plain_at(view, below.0, below.1) - bed.plain_at(view, above.0, above.1);
            }
        }
        if n > 0.0 {
            steps.push(sum / n);
        }
    }
    steps
}

/// Mean bed share below the surface less that above.
fn contrast(view: &DiscView, bed: &BedShare, points: &[SurfacePoint], axes: &SurfaceAxes) -> f64 {
    let mut curve: Vec<(f64, f64)> = points.iter().map(|p| axes.project(p.x, p.y)).collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sums = [[0.0_f64; 2]; 2];
    for k in (0..view.inside.len()).filter(|k| view.inside[*k]) {
        let (x, y) = view.position(k);
        let (u, v) = axes.project(x, y);
        let next = curve.partition_point(|p| p.0 < u);
        let near = curve.get(next).or(curve.last());
        let side = usize::from(near.is_some_and(|p| v < p.1));
        sums[side][0] += 1.0;
        sums[side][1] += f64::from(bed.plain[k]);
    }
    let mean = |side: [f64; 2]| side[1] / side[0].max(1.0);
    mean(sums[1]) - mean(sums[0])
}

/// Steepest inclination of the line through all points within `reach` of a point, rad.
fn steepest(points: &[(f64, f64)], line: f64, reach: f64) -> f64 {
    let mut steepest = line;
    for (centre, _) in points.iter().step_by(8) {
        let near = points.iter().filter(|p| (p.0 - centre).abs() <= reach);
        let (mut n, mut u, mut v) = (0.0, 0.0, 0.0);
        for p in near.clone() {
            (n, u, v) = (n + 1.0, u + p.0, v + p.1);
        }
        let (mut suu, mut suv) = (0.0, 0.0);
        for p in near {
            suu += (p.0 - u / n).powi(2);
            suv += (p.0 - u / n) * (p.1 - v / n);
        }
        if n >= 5.0 && suu > 0.0 {
            // v falls along u where the surface is steeper than its line.
            steepest = f64::max(steepest, line - (suv / suu).atan());
        }
    }
    steepest
}
