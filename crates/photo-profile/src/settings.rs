//! What a caller may fix beforehand; the default fixes nothing.

use crate::{Error, PixelRegion};
use serde::{Deserialize, Serialize};
use surface_profile::Definition;

/// The drum circle in the picture; y down, the centre of the first pixel is (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DrumPixels {
    /// Horizontal coordinate of the axis, px.
    pub cx: f64,
    /// Vertical coordinate of the axis, positive down, px.
    pub cy: f64,
    /// Inner radius, px.
    pub r: f64,
}

impl DrumPixels {
    /// Whether another circle is the same within 1 % of the radius, by which edges of several channels differ.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let most = 0.01 * self.r;
        let apart = (self.cx - other.cx).hypot(self.cy - other.cy);
        apart <= most && (self.r - other.r).abs() <= most
    }
}

/// Content of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// A drum seen along its axis.
    #[default]
    Drum,
    /// A heap on a level base, seen from the side.
    Heap,
}

/// Which tone the bed has against the air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Foreground {
    /// Found from the picture: darker, brighter, or both.
    #[default]
    Auto,
    /// Only what is darker than the air is bed.
    Dark,
    /// Only what is brighter than the air is bed.
    Light,
}

/// Settings of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The part of the picture that alone is looked at; all of it otherwise. Results are in the pixels of the whole.
    pub region: Option<PixelRegion>,
    /// The drum circle where it is known, px; found in the picture otherwise.
    pub drum: Option<DrumPixels>,
    /// Angle of the true horizontal in the picture, counter-clockwise positive, rad.
    pub camera_roll: f64,
    /// Which slope a caller wants; all three are measured.
    pub definition: Definition,
    /// Content of the picture.
    pub mode: Mode,
    /// Which tone the bed has.
    pub foreground: Foreground,
    /// Standard error of `camera_roll`, rad: 0 if it is known, that of [`crate::mark_error`] if it was read off a mark.
    pub camera_roll_error: f64,
    /// Largest standard error with which the angle of a bed or a heap may be known from one picture, rad: 3 degrees by
    /// default. Coarse beds have larger ones; the mean of many pictures can still be known well.
    pub max_angle_error: f64,
    /// How far above the foot of a heap the camera looks down on it, rad: 0 from the side. `None` takes it from the lower
    /// edge of the heap if that shows.
    pub camera_elevation: Option<f64>,
}

/// Largest standard error of an angle from one picture if nothing else is said, rad.
pub const MAX_ANGLE_ERROR: f64 = 3.0 * std::f64::consts::PI / 180.0;

impl Default for Settings {
    fn default() -> Self {
        Self {
            region: None,
            drum: None,
            camera_roll: 0.0,
            camera_roll_error: 0.0,
            definition: Definition::default(),
            mode: Mode::default(),
            foreground: Foreground::default(),
            max_angle_error: MAX_ANGLE_ERROR,
            camera_elevation: None,
        }
    }
}

impl Settings {
    /// Refuses invalid settings.
    ///
    /// # Errors
    /// [`Error::BadSetting`] for a drum that is not finite or smaller than 16 px in radius, for a roll beyond
    /// 45 degrees, for a largest error outside 0.1 to 30 degrees and for an elevation outside 0 to 30 degrees or without a heap.
    pub fn check(&self) -> Result<(), Error> {
        if let Some(drum) = self.drum {
            if !(drum.r.is_finite() && drum.r >= 16.0) {
                return Err(Error::BadSetting {
                    name: "drum radius",
                    value: drum.r,
                    limit: "at least 16 px",
                });
            }
            for value in [drum.cx, drum.cy] {
                if !value.is_finite() {
                    return Err(Error::BadSetting {
                        name: "drum centre",
                        value,
                        limit: "finite, px",
                    });
                }
            }
        }
        let level = -std::f64::consts::FRAC_PI_4..=std::f64::consts::FRAC_PI_4;
        if !level.contains(&self.camera_roll) {
            return Err(Error::BadSetting {
                name: "camera roll",
                value: self.camera_roll,
                limit: "within 0.785 rad (45 degrees) of level",
            });
        }
        if !(0.1..=30.0).contains(&self.max_angle_error.to_degrees()) {
            return Err(Error::BadSetting {
                name: "largest error of the angle",
                value: self.max_angle_error,
                limit: "0.00175 to 0.524 rad (0.1 to 30 degrees)",
            });
        }
        if !(self.camera_roll_error.is_finite() && self.camera_roll_error >= 0.0) {
            return Err(Error::BadSetting {
                name: "error of the camera roll",
                value: self.camera_roll_error,
                limit: "finite and not negative, rad",
            });
        }
        let elevation = self.camera_elevation.unwrap_or(0.0);
        if !(0.0..=30.0).contains(&elevation.to_degrees()) {
            return Err(Error::BadSetting {
                name: "camera elevation",
                value: elevation,
                limit: "0 to 0.524 rad (30 degrees)",
            });
        }
        if elevation > 0.0 && self.mode != Mode::Heap {
            return Err(Error::BadSetting {
                name: "camera elevation",
                value: elevation,
                limit: "0 but for a heap: a drum is seen along its axis",
            });
        }
        Ok(())
    }
}
