//! The nearest sphere behind every pixel.

/// No sphere.
const NOBODY: u32 = u32::MAX;

/// Outline of a sphere in a picture; all lengths in pixels from the middle of the picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Footprint {
    /// Centre to the right of the middle, pixels.
    pub(crate) right: f64,
    /// Centre below the middle, pixels.
    pub(crate) down: f64,
    /// Centre toward the camera, pixels.
    pub(crate) near: f64,
    /// Radius, pixels.
    pub(crate) radius: f64,
}

/// The nearest surface at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// Position of the sphere in its list.
    pub(crate) index: usize,
    /// Distance of the surface toward the camera, pixels.
    pub(crate) near: f64,
}

/// Square depth buffer for parallel rays.
#[derive(Debug)]
pub(crate) struct DepthBuffer {
    /// Width and height, pixels.
    pixels: usize,
    /// Column and row of the middle, pixels.
    middle: f64,
    /// Distance of the nearest surface toward the camera, pixels; row by row.
    near: Vec<f64>,
    /// Which sphere it belongs to.
    owner: Vec<u32>,
}

impl DepthBuffer {
    /// An empty buffer.
    pub(crate) fn new(pixels: u32) -> Self {
        let side = pixels as usize;
        Self {
            pixels: side,
            middle: f64::from(pixels - 1) / 2.0,
            near: vec![f64::NEG_INFINITY; side * side],
            owner: vec![NOBODY; side * side],
        }
    }

    /// Draws the sphere with number `index` at the pixels at which it is the nearest.
    pub(crate) fn add(&mut self, index: u32, sphere: &Footprint) {
        let Some(rows) = self.range(sphere.down, sphere.radius) else {
            return;
        };
        let Some(columns) = self.range(sphere.right, sphere.radius) else {
            return;
        };
        let radius_squared = sphere.radius * sphere.radius;
        let foremost = sphere.near + sphere.radius;
        for row in rows.first..=rows.last {
            let below = (row as f64 - self.middle) - sphere.down;
            let left_over = radius_squared - below * below;
            let start = row * self.pixels;
            let nears = &mut self.near[start + columns.first..=start + columns.last];
            let owners = &mut self.owner[start + columns.first..=start + columns.last];
            for (step, (near, owner)) in nears.iter_mut().zip(owners).enumerate() {
                let right = ((columns.first + step) as f64 - self.middle) - sphere.right;
                let height_squared = left_over - right * right;
                if height_squared < 0.0 || foremost <= *near {
                    continue;
                }
                let surface = sphere.near + height_squared.sqrt();
                if surface > *near {
                    *near = surface;
                    *owner = index;
                }
            }
        }
    }

    /// The surface seen at a pixel, if any.
    pub(crate) fn hit(&self, column: u32, row: u32) -> Option<Hit> {
        let place = row as usize * self.pixels + column as usize;
        let owner = *self.owner.get(place)?;
        let near = *self.near.get(place)?;
        (owner != NOBODY).then_some(Hit {
            index: owner as usize,
            near,
        })
    }

    /// Rows or columns that a sphere can touch, or none when it lies outside of the picture.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the picture just before"
    )]
    fn range(&self, offset: f64, radius: f64) -> Option<Range> {
        let last_pixel = (self.pixels - 1) as f64;
        let first = (self.middle + offset - radius).floor().max(0.0);
        let last = (self.middle + offset + radius).ceil().min(last_pixel);
        (first <= last).then_some(Range {
            first: first as usize,
            last: last as usize,
        })
    }
}

/// First and last row or column.
#[derive(Debug, Clone, Copy)]
struct Range {
    /// First, counted from 0.
    first: usize,
    /// Last, counted from 0.
    last: usize,
}
