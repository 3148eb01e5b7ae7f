//! Position of the camera before the drum, and the exact map between metres and pixels.

use crate::Error;

/// Smallest picture, pixels: below it a drum has no inside.
const LEAST_PIXELS: u32 = 16;
/// Largest picture, pixels: 16384 x 16384 already needs 4 GiB of depth buffer.
const MOST_PIXELS: u32 = 16_384;

/// Kind of camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Camera {
    /// Parallel rays along the drum axis: a camera with a long lens far away.
    #[default]
    Orthographic,
}

/// A drum seen along its axis z through the transparent end cover.
///
/// The camera looks along -z: +z points to it, x right and y up. The picture is square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrumView {
    /// Inner radius of the drum, m.
    pub inner_radius: f64,
    /// Inner width of the drum along its axis, m.
    pub width: f64,
    /// Centre of the drum, halfway between the covers, m.
    pub centre: [f64; 3],
    /// Width and height of the picture, pixels.
    pub pixels: u32,
    /// Angle by which the picture is turned about the optical axis, counter-clockwise as seen, rad.
    pub roll: f64,
    /// Free space beside the drum on each side, as a fraction of the inner radius.
    pub margin: f64,
    /// Thickness of the drum wall as seen, as a fraction of the inner radius.
    pub rim: f64,
    /// Kind of camera.
    pub camera: Camera,
}

impl DrumView {
    /// View of a drum around the origin without roll; lengths in m.
    ///
    /// The drum takes 92.6 % of the picture's width; its rim is 2 % of the radius.
    pub fn new(inner_radius: f64, width: f64, pixels: u32) -> Self {
        Self {
            inner_radius,
            width,
            centre: [0.0; 3],
            pixels,
            roll: 0.0,
            margin: 0.08,
            rim: 0.02,
            camera: Camera::Orthographic,
        }
    }

    /// The map between metres and pixels of this view.
    ///
    /// # Errors
    /// [`Error::InvalidView`] or [`Error::InvalidPixels`] for an invalid setting.
    pub fn projection(&self) -> Result<DrumProjection, Error> {
        self.check()?;
        let half_picture = f64::from(self.pixels) / 2.0;
        Ok(DrumProjection {
            pixels_per_metre: half_picture / (self.inner_radius * (1.0 + self.margin)),
            middle: f64::from(self.pixels - 1) / 2.0,
            centre: [self.centre[0], self.centre[1]],
            cosine: self.roll.cos(),
            sine: self.roll.sin(),
        })
    }

    /// Refuses invalid settings.
    fn check(&self) -> Result<(), Error> {
        if !(LEAST_PIXELS..=MOST_PIXELS).contains(&self.pixels) {
            return Err(Error::InvalidPixels {
                pixels: self.pixels,
                least: LEAST_PIXELS,
                most: MOST_PIXELS,
            });
        }
        require(
            "inner_radius",
            self.inner_radius,
            self.inner_radius > 0.0,
            "above 0 m",
        )?;
        require("width", self.width, self.width > 0.0, "above 0 m")?;
        require(
            "margin",
            self.margin,
            (0.0..=10.0).contains(&self.margin),
            "from 0 to 10 radii",
        )?;
        require(
            "rim",
            self.rim,
            (0.0..=1.0).contains(&self.rim),
            "from 0 to 1 radii",
        )?;
        require("roll", self.roll, true, "a finite angle in rad")?;
        for (field, value) in ["centre x", "centre y", "centre z"]
            .into_iter()
            .zip(self.centre)
        {
            require(field, value, true, "a finite length in m")?;
        }
        Ok(())
    }
}

/// Accepts a setting that is finite and holds its condition.
fn require(
    field: &'static str,
    value: f64,
    holds: bool,
    requirement: &'static str,
) -> Result<(), Error> {
    if value.is_finite() && holds {
        Ok(())
    } else {
        Err(Error::InvalidView {
            field,
            value,
            requirement,
        })
    }
}

/// A place in a picture, pixels; whole numbers are the centres of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelPoint {
    /// Distance to the right of the centre of the leftmost column, pixels.
    pub column: f64,
    /// Distance below the centre of the uppermost row, pixels.
    pub row: f64,
}

/// Map between the drum's x and y in metres and pixel coordinates.
///
/// # Formula
/// With the scale s, the roll a and the middle of the picture m = (pixels - 1) / 2:
/// column = m + s (x cos a - y sin a), row = m - s (x sin a + y cos a),
/// where x and y are measured from the drum axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrumProjection {
    /// Scale, pixels/m.
    pixels_per_metre: f64,
    /// Column and row of the middle of the picture, pixels.
    middle: f64,
    /// Drum axis in x and y, m.
    centre: [f64; 2],
    /// Cosine of the roll.
    cosine: f64,
    /// Sine of the roll.
    sine: f64,
}

impl DrumProjection {
    /// Scale of the picture, pixels/m.
    pub fn pixels_per_metre(&self) -> f64 {
        self.pixels_per_metre
    }

    /// Where the drum axis is seen.
    pub fn axis(&self) -> PixelPoint {
        PixelPoint {
            column: self.middle,
            row: self.middle,
        }
    }

    /// Where a point with x and y in m is seen.
    pub fn pixel_from_metre(&self, point: [f64; 2]) -> PixelPoint {
        let offset = self.offset_from_metre(point);
        PixelPoint {
            column: self.middle + offset.right,
            row: self.middle + offset.down,
        }
    }

    /// x and y in m of what is seen at a place of the picture.
    pub fn metre_from_pixel(&self, pixel: PixelPoint) -> [f64; 2] {
        let right = (pixel.column - self.middle) / self.pixels_per_metre;
        let up = (self.middle - pixel.row) / self.pixels_per_metre;
        [
            self.centre[0] + right * self.cosine + up * self.sine,
            self.centre[1] + up * self.cosine - right * self.sine,
        ]
    }

    /// Offset of a point from the middle of the picture.
    pub(crate) fn offset_from_metre(&self, point: [f64; 2]) -> Offset {
        let x = point[0] - self.centre[0];
        let y = point[1] - self.centre[1];
        Offset {
            right: (x * self.cosine - y * self.sine) * self.pixels_per_metre,
            down: -(x * self.sine + y * self.cosine) * self.pixels_per_metre,
        }
    }
}

/// Distance from the middle of the picture, pixels. Kept apart from [`PixelPoint`] because only
/// an offset changes sign exactly when the scene is mirrored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Offset {
    /// To the right, pixels.
    pub(crate) right: f64,
    /// Downward, pixels.
    pub(crate) down: f64,
}
