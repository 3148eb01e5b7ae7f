//! The frame that lies along the surface.

use crate::{DrumCircle, SurfacePoint};

/// The frame of a surface line: origin on the drum axis, u downhill along the line, v upward
/// along its normal.
///
/// Because u always points downhill, a surface and its mirror have the same coordinates here.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceFrame {
    /// The drum whose axis is the origin, unit of the caller.
    drum: DrumCircle,
    /// Signed inclination of the line in x, y; positive if it rises to the right, rad.
    pub(crate) inclination: f64,
    /// Unit vector of u in (x, y), 1.
    along: (f64, f64),
    /// Unit vector of v in (x, y), 1.
    normal: (f64, f64),
}

impl SurfaceFrame {
    /// The frame of a line with the signed inclination (rad).
    pub(crate) fn new(drum: DrumCircle, inclination: f64) -> Self {
        let (sin, cos) = inclination.sin_cos();
        let downhill = if inclination > 0.0 { -1.0 } else { 1.0 };
        Self {
            drum,
            inclination,
            along: (downhill * cos, downhill * sin),
            normal: (-sin, cos),
        }
    }

    /// Coordinates (u, v) of a point, unit of the caller.
    pub(crate) fn project(&self, point: &SurfacePoint) -> (f64, f64) {
        let (x, y) = (point.x - self.drum.x, point.y - self.drum.y);
        (
            x * self.along.0 + y * self.along.1,
            x * self.normal.0 + y * self.normal.1,
        )
    }

    /// The point with coordinates (u, v), unit of the caller.
    pub(crate) fn place(&self, u: f64, v: f64) -> SurfacePoint {
        SurfacePoint {
            x: self.drum.x + u * self.along.0 + v * self.normal.0,
            y: self.drum.y + u * self.along.1 + v * self.normal.1,
        }
    }
}
