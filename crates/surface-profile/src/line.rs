//! The least-squares line.

use crate::SurfacePoint;
use crate::median::median;

/// Points beyond so many robust standard deviations from a line are outliers.
const CUT_IN_SD: f64 = 4.0;
/// Standard deviation of normal values over the median of their sizes.
const NORMAL: f64 = 1.4826;

/// Direction of the line that minimises the sum of squared normal distances.
///
/// # Formula
/// `tan 2 theta = 2 Sxy / (Sxx - Syy)` with sums about the centroid, theta in (-pi/2, pi/2].
/// Normal distances, not vertical ones, make the line turn with the picture and stay the same
/// under a mirror.
///
/// # Source
/// `[Pearson1901]`, principal axis of the points.
///
/// Returns `None` for fewer than two distinct points.
pub(crate) fn direction(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let (mut n, mut x, mut y) = (0.0, 0.0, 0.0);
    for (px, py) in points.clone() {
        n += 1.0;
        x += px;
        y += py;
    }
    let (x, y) = (x / n, y / n);
    let (mut sxx, mut sxy, mut syy) = (0.0, 0.0, 0.0);
    for (px, py) in points {
        sxx += (px - x) * (px - x);
        sxy += (px - x) * (py - y);
        syy += (py - y) * (py - y);
    }
    (sxx + syy > 0.0).then(|| 0.5 * (2.0 * sxy).atan2(sxx - syy))
}

/// A straight line through the centroid of points.
pub(crate) struct Line {
    /// Centroid.
    pub(crate) centre: SurfacePoint,
    /// Inclination, positive when it rises to the right, rad.
    pub(crate) inclination: f64,
}

impl Line {
    /// The principal axis of the members.
    pub(crate) fn through(points: &[SurfacePoint], members: &[usize]) -> Self {
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

    /// The line through the members near it, and these members. A point beyond four robust standard deviations and beyond
    /// `least` (unit of the points) is an outlier and excluded; this is repeated until no outlier is left.
    pub(crate) fn near(
        points: &[SurfacePoint],
        mut members: Vec<usize>,
        least: f64,
    ) -> (Self, Vec<usize>) {
        // Each round leaves out a point or is the last.
        loop {
            let line = Self::through(points, &members);
            let off = |k: &usize| line.off(&points[*k]).abs();
            let typical = median(&mut members.iter().map(off).collect::<Vec<f64>>());
            let cut = (CUT_IN_SD * NORMAL * typical).max(least);
            let before = members.len();
            members.retain(|k| off(k) <= cut);
            if members.len() == before {
                return (line, members);
            }
        }
    }

    /// Distance of a point from the line, positive above.
    pub(crate) fn off(&self, p: &SurfacePoint) -> f64 {
        let (sin, cos) = self.inclination.sin_cos();
        (p.y - self.centre.y) * cos - (p.x - self.centre.x) * sin
    }

    /// Position of a point along the line.
    pub(crate) fn along(&self, p: &SurfacePoint) -> f64 {
        let (sin, cos) = self.inclination.sin_cos();
        (p.x - self.centre.x) * cos + (p.y - self.centre.y) * sin
    }

    /// The point at a position along the line.
    pub(crate) fn place(&self, along: f64) -> SurfacePoint {
        let (sin, cos) = self.inclination.sin_cos();
        SurfacePoint {
            x: self.centre.x + along * cos,
            y: self.centre.y + along * sin,
        }
    }
}
