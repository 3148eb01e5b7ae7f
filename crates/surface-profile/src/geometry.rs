//! Points of the free surface and the circle of the drum.

use crate::Error;
use serde::{Deserialize, Serialize};

/// A point of the free surface; x to the right, y up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfacePoint {
    /// Horizontal coordinate, positive to the right, any unit of length.
    pub x: f64,
    /// Vertical coordinate, positive up, unit of `x`.
    pub y: f64,
}

/// The inner circle of the drum, seen along its axis; x to the right, y up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DrumCircle {
    /// Horizontal coordinate of the axis, any unit of length.
    pub x: f64,
    /// Vertical coordinate of the axis, positive up, unit of `x`.
    pub y: f64,
    /// Inner radius, positive, unit of `x`.
    pub radius: f64,
}

impl DrumCircle {
    /// Refuses an invalid circle.
    ///
    /// # Errors
    /// [`Error::BadDrum`] unless the centre is finite and the radius finite and positive.
    pub fn check(&self) -> Result<(), Error> {
        let finite = self.x.is_finite() && self.y.is_finite() && self.radius.is_finite();
        if finite && self.radius > 0.0 {
            Ok(())
        } else {
            Err(Error::BadDrum {
                x: self.x,
                y: self.y,
                radius: self.radius,
            })
        }
    }
}
