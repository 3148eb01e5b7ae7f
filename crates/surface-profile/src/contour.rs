//! The free surface as the level contour of a field inside the drum.

use crate::cubic::Cubic;
use crate::frame::SurfaceFrame;
use crate::median::median;
use crate::stations::Stations;
use crate::{DrumCircle, Error, Field, SurfacePoint, read_surface};

/// Least and largest part of the drum that the bed may fill and still have a free surface.
const FILL_LIMITS: [f64; 2] = [0.02, 0.98];

/// Cells between the rays that only find the direction of the surface.
const COARSE_SPACING: f64 = 3.0;

/// The level of half of the bulk value of a field.
///
/// The bulk value is the median over the cells in the drum above half of itself, found by
/// repetition from the median over all positive cells. If gaps in the bed lower the field,
/// they lower the level as well. Returns 0 for a field without positive cells in the drum.
pub fn bulk_level(field: &Field, drum: &DrumCircle) -> f64 {
    let inside_drum = |dx: f64, dy: f64| dx * dx + dy * dy <= drum.radius * drum.radius;
    let mut inside: Vec<f64> = field
        .cells()
        .filter(|c| c.2 > 0.0 && inside_drum(c.0 - drum.x, c.1 - drum.y))
        .map(|c| c.2)
        .collect();
    let mut bulk = 0.0;
    for _ in 0..50 {
        inside.retain(|v| *v > 0.5 * bulk);
        let next = median(&mut inside);
        if next == bulk {
            break;
        }
        bulk = next;
    }
    0.5 * bulk
}

/// Points of the free surface: where the field crosses the level, seen along the normal of the
/// surface line.
///
/// The bed is where the field is above the level. Each ray from the air side is cut once,
/// where the cut leaves the fewest samples on the wrong side; a particle in flight and a gap in
/// the bed therefore do not move it. The crossing is interpolated between samples. Rays are a
/// cell apart and reach to `reach` of the drum radius (0 to 1), which excludes the rim. The
/// effect of smoothing on a curved surface is corrected.
///
/// # Formula
/// First normal: from the centroid of the bed to the drum axis, exact for a circular segment;
/// then twice the normal of the line that [`read_surface`] finds.
///
/// A Gaussian of standard deviation s moves the half level of a surface v(u) by
/// `s^2 v'' / (2 (1 + v'^2))` towards the concave side, to first order in the curvature: the median of
/// `Y - v'' X^2 / 2` with X and Y normal. This is subtracted, with the derivatives of the cubic
/// through the surface. The line of an S of 0.25 would be 0.04 degrees too flat without it.
///
/// # Errors
/// [`Error::NoSurface`] if the bed fills almost nothing or all of the drum,
/// [`Error::BadSetting`] for a reach outside 0 to 1, and the errors of [`read_surface`].
pub fn free_surface(
    field: &Field,
    level: f64,
    drum: &DrumCircle,
    reach: f64,
) -> Result<Vec<SurfacePoint>, Error> {
    drum.check()?;
    if !(reach > 0.0 && reach <= 1.0) {
        return Err(Error::BadSetting {
            name: "reach",
            value: reach,
            limit: "above 0, at most 1",
        });
    }
    let mut frame = SurfaceFrame::new(*drum, first_inclination(field, level, drum, reach)?);
    let mut points = Vec::new();
    for pass in 0..3 {
        let spacing = if pass < 2 { COARSE_SPACING } else { 1.0 };
        points = scan(field, level, &frame, [reach * drum.radius, spacing]);
        if pass < 2 {
            let reading = read_surface(&points, drum)?;
            let [high, low] = reading.line_ends;
            frame = SurfaceFrame::new(*drum, ((high.y - low.y) / (high.x - low.x)).atan());
        }
    }
    Ok(unsmoothed(points, field.smoothing(), drum, &frame))
}

/// Corrects the points for a smoothing with the standard deviation `sd`.
fn unsmoothed(
    points: Vec<SurfacePoint>,
    sd: f64,
    drum: &DrumCircle,
    frame: &SurfaceFrame,
) -> Vec<SurfacePoint> {
    let Ok(stations) = Stations::build(&points, drum, frame) else {
        return points;
    };
    let Some(cubic) = Cubic::fit(stations.all.iter().map(|s| (s.along, s.height, 1.0))) else {
        return points;
    };
    let [_, c1, c2, c3] = cubic.coefficients;
    let half_chord = stations.half_chord;
    points
        .iter()
        .map(|p| {
            let (u, v) = frame.project(p);
            let t = u / half_chord;
            let slope = (c1 + 2.0 * c2 * t + 3.0 * c3 * t * t) / half_chord;
            let bend = (2.0 * c2 + 6.0 * c3 * t) / (half_chord * half_chord);
            frame.place(u, v - 0.5 * sd * sd * bend / (1.0 + slope * slope))
        })
        .collect()
}

/// Signed inclination of the surface of a circular segment with the bed's centroid, rad.
fn first_inclination(
    field: &Field,
    level: f64,
    drum: &DrumCircle,
    reach: f64,
) -> Result<f64, Error> {
    let reach_squared = (reach * drum.radius).powi(2);
    let (mut n, mut n_bed, mut x, mut y) = (0.0, 0.0, 0.0, 0.0);
    for (cx, cy, value) in field.cells() {
        let (dx, dy) = (cx - drum.x, cy - drum.y);
        if dx * dx + dy * dy <= reach_squared {
            n += 1.0;
            if value >= level {
                n_bed += 1.0;
                x += dx;
                y += dy;
            }
        }
    }
    let [least, most] = FILL_LIMITS;
    let fraction = if n > 0.0 { n_bed / n } else { 0.0 };
    if !(least..=most).contains(&fraction) {
        return Err(Error::NoSurface {
            fraction,
            least,
            most,
        });
    }
    // The bed lies below: its centroid points down, the normal up.
    Ok((-x / y.min(-f64::MIN_POSITIVE)).atan())
}

/// One pass of parallel rays along the normal of the frame, within a radius (unit of the drum)
/// and a spacing (cells) apart.
fn scan(
    field: &Field,
    level: f64,
    frame: &SurfaceFrame,
    [radius, spacing]: [f64; 2],
) -> Vec<SurfacePoint> {
    let step = field.cell();
    let n_rays = (radius / (spacing * step)).floor();
    let mut values = Vec::new();
    let mut points = Vec::new();
    let mut i_ray = -n_rays;
    while i_ray <= n_rays {
        let u = i_ray * spacing * step;
        let top = (radius * radius - u * u).max(0.0).sqrt();
        values.clear();
        let mut v = top;
        while v >= -top {
            let p = frame.place(u, v);
            values.push(field.at(p.x, p.y));
            v -= step;
        }
        if let Some(depth) = best_cut(&values, level) {
            points.push(frame.place(u, top - depth * step));
        }
        i_ray += 1.0;
    }
    points
}

/// Depth, in samples from the first, of the one cut that leaves the fewest samples wrong.
///
/// Wrong are samples above the cut at or over the level and samples below it under the level.
/// Returns `None` when the best cut is at an end of the ray, so that it meets no surface.
fn best_cut(values: &[f64], level: f64) -> Option<f64> {
    let mut wrong = values.iter().filter(|v| **v < level).count();
    let (mut least, mut cut) = (wrong, 0);
    for (i, value) in values.iter().enumerate() {
        if *value >= level {
            wrong += 1;
        } else {
            wrong -= 1;
        }
        if wrong < least {
            (least, cut) = (wrong, i + 1);
        }
    }
    if cut == 0 || cut >= values.len() {
        return None;
    }
    let (above, below) = (values[cut - 1], values[cut]);
    let part = ((level - above) / (below - above)).clamp(0.0, 1.0);
    Some((cut - 1) as f64 + part)
}
