//! The drum's disc on a grid about its axis, level and with y up.

use crate::pixels::to_f32;
use crate::{DrumPixels, PhotoPixels, PixelPoint, Refusal};
use surface_profile::SurfacePoint;

/// Cells along the drum radius at most: a cell is then 0.35 mm in the drum of 140 mm.
const CELLS_PER_RADIUS: f64 = 200.0;
/// Part of the radius that is looked at; beyond lie the rim and its shadow.
pub(crate) const REACH: f64 = 0.96;
/// Least part of the disc that must lie in the picture.
const LEAST_IN_PICTURE: f64 = 0.8;

/// Grey levels around the drum axis; x to the right along the true horizontal, y up.
#[derive(Debug)]
pub(crate) struct DiscView {
    /// The drum in the picture, px.
    drum: DrumPixels,
    /// Sine of the camera roll, 1.
    sin: f64,
    /// Cosine of the camera roll, 1.
    cos: f64,
    /// Edge of a cell, px.
    pub(crate) cell: f64,
    /// Cells along either side, odd.
    pub(crate) n: usize,
    /// Grey levels, row by row from the lowest, shape (n, n).
    pub(crate) gray: PhotoPixels,
    /// Whether a cell lies in the disc and in the picture, shape (n, n).
    pub(crate) inside: Vec<bool>,
    /// Part of the disc that lies in the picture, 1.
    pub(crate) part_in_picture: f64,
}

impl DiscView {
    /// Resamples the disc by area averages.
    pub(crate) fn new(picture: &PhotoPixels, drum: DrumPixels, camera_roll: f64) -> Self {
        let cell = (drum.r / CELLS_PER_RADIUS).max(1.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most the radius in px or 200"
        )]
        let half = (drum.r / cell).ceil() as usize;
        let n = 2 * half + 1;
        let (sin, cos) = camera_roll.sin_cos();
        let mut view = Self {
            drum,
            sin,
            cos,
            cell,
            n,
            gray: PhotoPixels::from_values(0, Vec::new()),
            inside: vec![false; n * n],
            part_in_picture: 0.0,
        };
        view.resample(picture);
        view
    }

    /// Fills the grid.
    fn resample(&mut self, picture: &PhotoPixels) {
        let offsets = sample_offsets(self.cell);
        let weight = 1.0 / (offsets.len() * offsets.len()) as f64;
        let (right, bottom) = (picture.width() as f64 - 0.5, picture.height() as f64 - 0.5);
        let mut gray = vec![0.0_f32; self.n * self.n];
        let reach_squared = (REACH * self.drum.r + self.cell).powi(2);
        let (mut n_disc, mut n_seen) = (0.0, 0.0);
        for (k, value) in gray.iter_mut().enumerate() {
            let (x, y) = self.position(k);
            if x * x + y * y > reach_squared {
                continue;
            }
            n_disc += 1.0;
            let place = self.to_picture(&SurfacePoint { x, y });
            self.inside[k] =
                (-0.5..=right).contains(&place.x) && (-0.5..=bottom).contains(&place.y);
            n_seen += f64::from(u8::from(self.inside[k]));
            let sum: f64 = offsets
                .iter()
                .flat_map(|dy| offsets.iter().map(move |dx| (dx, dy)))
                .map(|(dx, dy)| picture.at(place.x + dx, place.y + dy))
                .sum();
            *value = to_f32(weight * sum);
        }
        self.gray = PhotoPixels::from_values(self.n, gray);
        self.part_in_picture = n_seen / f64::max(n_disc, 1.0);
    }

    /// Refuses a disc of which too little lies in the picture.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        if self.part_in_picture < LEAST_IN_PICTURE {
            return Err(Refusal::DrumOutside {
                inside: self.part_in_picture,
            });
        }
        Ok(())
    }

    /// Position of a cell about the axis, y up, px.
    pub(crate) fn position(&self, k: usize) -> (f64, f64) {
        let half = (self.n / 2) as f64;
        (
            ((k % self.n) as f64 - half) * self.cell,
            ((k / self.n) as f64 - half) * self.cell,
        )
    }

    /// Half the width of the grid, about the drum radius, px.
    pub(crate) fn radius(&self) -> f64 {
        (self.n / 2) as f64 * self.cell
    }

    /// The point of the view that lies at a place of the picture.
    pub(crate) fn of_picture(&self, place: &PixelPoint) -> SurfacePoint {
        let (right, up) = (place.x - self.drum.cx, self.drum.cy - place.y);
        SurfacePoint {
            x: right * self.cos + up * self.sin,
            y: up * self.cos - right * self.sin,
        }
    }

    /// Where a point of the view lies in the picture.
    pub(crate) fn to_picture(&self, point: &SurfacePoint) -> PixelPoint {
        PixelPoint {
            x: self.drum.cx + point.x * self.cos - point.y * self.sin,
            y: self.drum.cy - point.x * self.sin - point.y * self.cos,
        }
    }
}

/// Evenly spread sample places across a cell, about its centre, px.
fn sample_offsets(cell: f64) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to 1..=16"
    )]
    let n = cell.round().clamp(1.0, 16.0) as usize;
    (0..n)
        .map(|k| cell * ((k as f64 + 0.5) / n as f64 - 0.5))
        .collect()
}
