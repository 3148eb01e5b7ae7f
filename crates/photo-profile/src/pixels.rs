//! The picture as grey values, and as colours where it has any.

use crate::mask::Hidden;
use crate::{Channel, PixelPoint, PixelRegion};
use image::{DynamicImage, GrayImage, RgbImage};
use std::borrow::Cow;
use std::sync::Arc;

/// A channel tells something of its own where more than this part of the pixels is not grey.
const LEAST_COLOURED: f64 = 1e-3;
/// A pixel is not grey if its channels differ by more than so many levels.
const GREY: u8 = 8;

/// A picture as grey values, 0 to 255, row by row from the top; a colour picture holds its colours besides.
#[derive(Debug, Clone)]
pub struct PhotoPixels {
    /// Pixels along x.
    width: usize,
    /// Pixels along y.
    height: usize,
    /// Grey levels 0 to 255, shape (height, width).
    values: Vec<f32>,
    /// The same picture in colour; none if it is grey.
    colour: Option<Arc<RgbImage>>,
    /// Places that show neither bed nor air.
    hidden: Option<Hidden>,
}

impl PhotoPixels {
    /// Takes a grey picture, for example a rendered frame.
    pub fn from_gray(picture: &GrayImage) -> Self {
        Self {
            width: picture.width() as usize,
            height: picture.height() as usize,
            values: picture.as_raw().iter().map(|v| f32::from(*v)).collect(),
            colour: None,
            hidden: None,
        }
    }

    /// Takes any picture by its luminance (weights of ITU-R BT.709 on the stored values), and its colours.
    pub fn from_picture(picture: &DynamicImage) -> Self {
        let colour = picture.color().has_color().then(|| picture.to_rgb8());
        let coloured = colour.filter(|rgb| {
            let grey = |p: &&image::Rgb<u8>| {
                let [r, g, b] = p.0;
                r.max(g).max(b) - r.min(g).min(b) <= GREY
            };
            let all = f64::from(rgb.width()) * f64::from(rgb.height());
            let coloured = all - rgb.pixels().filter(grey).count() as f64;
            coloured > LEAST_COLOURED * all
        });
        Self {
            colour: coloured.map(Arc::new),
            ..Self::from_gray(&picture.to_luma8())
        }
    }

    /// Whether the picture has colours.
    pub(crate) fn has_colour(&self) -> bool {
        self.colour.is_some()
    }

    /// The picture by one channel; by its luminance where it has no colours.
    pub(crate) fn channel(&self, channel: Channel) -> Cow<'_, Self> {
        match &self.colour {
            Some(colour) if channel != Channel::Luma => {
                let level = |p: &image::Rgb<u8>| to_f32(channel.of(p.0.map(f64::from)));
                let values = colour.pixels().map(level).collect();
                Cow::Owned(Self::from_values(self.width, values))
            }
            _ => Cow::Borrowed(self),
        }
    }

    /// The picture with a change made to the grey values, and to those of each colour.
    pub(crate) fn map_channels(mut self, change: impl Fn(&mut [f32])) -> Self {
        change(&mut self.values);
        if let Some(colour) = &mut self.colour {
            let colour = Arc::make_mut(colour);
            for channel in 0..3 {
                let mut values: Vec<f32> =
                    colour.pixels().map(|p| f32::from(p.0[channel])).collect();
                change(&mut values);
                for (pixel, value) in colour.pixels_mut().zip(values) {
                    pixel.0[channel] = to_level(f64::from(value));
                }
            }
        }
        self
    }

    /// The picture that knows its hidden places.
    pub(crate) fn knowing(self, hidden: Hidden) -> Self {
        Self {
            hidden: Some(hidden),
            ..self
        }
    }

    /// Whether a place of the picture, or one within `reach` (px) of it, is hidden.
    pub(crate) fn is_hidden_near(&self, place: PixelPoint, reach: f64) -> bool {
        let hidden = self.hidden.as_ref();
        hidden.is_some_and(|hidden| hidden.is_near(place, reach))
    }

    /// A part of the picture, which holds it.
    pub(crate) fn part(&self, region: PixelRegion) -> Self {
        let PixelRegion {
            left,
            top,
            width,
            height,
        } = region;
        let colour = self.colour.as_ref().map(|colour| {
            let part = image::imageops::crop_imm(&**colour, left, top, width, height);
            Arc::new(part.to_image())
        });
        let [left, top, width, height] = [left, top, width, height].map(|v| v as usize);
        let rows = self.values.chunks_exact(self.width.max(1));
        let rows = rows.skip(top).take(height);
        Self {
            colour,
            hidden: self
                .hidden
                .as_ref()
                .map(|h| h.part([left, top, width, height])),
            ..Self::from_values(
                width,
                rows.flat_map(|row| &row[left..][..width])
                    .copied()
                    .collect(),
            )
        }
    }

    /// Takes grey values of any range, row by row.
    pub(crate) fn from_values(width: usize, values: Vec<f32>) -> Self {
        let height = values.len().checked_div(width).unwrap_or(0);
        Self {
            width,
            height,
            values,
            colour: None,
            hidden: None,
        }
    }

    /// Pixels along x.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels along y.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Grey levels row by row, shape (height, width).
    pub(crate) fn values(&self) -> &[f32] {
        &self.values
    }

    /// Grey level by bilinear interpolation, the border carried on outside.
    #[inline]
    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        let (last_column, last_row) = (self.width - 1, self.height - 1);
        let x = x.max(0.0).min(last_column as f64);
        let y = y.max(0.0).min(last_row as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the picture"
        )]
        let (i, j) = (x as usize, y as usize);
        let (a, b) = (x - i as f64, y - j as f64);
        let along = |j: usize| {
            let row = &self.values[j * self.width..][..self.width];
            f64::from(row[i]) * (1.0 - a) + f64::from(row[(i + 1).min(last_column)]) * a
        };
        along(j) * (1.0 - b) + along((j + 1).min(last_row)) * b
    }

    /// The picture with blocks of `factor` by `factor` pixels averaged; a rest is cut off.
    pub(crate) fn shrunk(&self, factor: usize) -> Self {
        if factor <= 1 {
            return Self::from_values(self.width, self.values.clone());
        }
        let (width, height) = (self.width / factor, self.height / factor);
        let mut values = vec![0.0_f32; width * height];
        for j in 0..height * factor {
            let row = &self.values[j * self.width..][..width * factor];
            let to = &mut values[(j / factor) * width..][..width];
            for (sum, block) in to.iter_mut().zip(row.chunks_exact(factor)) {
                *sum += block.iter().sum::<f32>();
            }
        }
        let scale = 1.0 / (factor * factor) as f32;
        for value in &mut values {
            *value *= scale;
        }
        Self {
            width,
            height,
            values,
            colour: None,
            hidden: None,
        }
    }

    /// The picture smoothed by three running means each way, together of the standard deviation
    /// `sd` (px); outside counts as the border carried on.
    ///
    /// # Formula
    /// Each mean takes 2k + 1 pixels in full and one more on either side with the weight a. Three of
    /// them have the variance `3 (k (k + 1) (2k + 1) / 3 + 2 a (k + 1)^2) / (2k + 1 + 2a)`; k is the
    /// largest whole number with `k (k + 1) <= sd^2`, and a makes up the rest.
    ///
    /// # Source
    /// `[Gwosdek2011]`, extended box filter.
    pub(crate) fn blurred(&self, sd: f64) -> Self {
        let k = ((0.25 + sd * sd).sqrt() - 0.5).floor().max(0.0);
        let rest = sd * sd - k * (k + 1.0);
        let edge = (2.0 * k + 1.0) * rest / (6.0 * (k + 1.0).powi(2) - 2.0 * sd * sd);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a smoothing length is positive and far below the picture size"
        )]
        let reach = k as usize;
        let mut picture = self.transposed();
        for last_way in [false, true] {
            for _ in 0..3 {
                picture.average_columns(reach, edge);
            }
            if !last_way {
                picture = picture.transposed();
            }
        }
        picture
    }

    /// Replaces each pixel by the mean of its column within `reach` pixels either way, and of one more
    /// on either side with the weight `edge`.
    ///
    /// The running sums of all columns move down together, so that they lie in vector registers.
    fn average_columns(&mut self, reach: usize, edge: f64) {
        let (width, height) = (self.width, self.height);
        if width == 0 || height == 0 {
            return;
        }
        let scale = 1.0 / ((2 * reach + 1) as f64 + 2.0 * edge);
        let row = |j: usize| &self.values[j.min(height - 1) * width..][..width];
        let mut sums: Vec<f64> = row(0)
            .iter()
            .map(|v| f64::from(*v) * reach as f64)
            .collect();
        let mut first = vec![0.0; width];
        for j in 0..=reach {
            add(&mut first, row(j));
        }
        for (sum, first) in sums.iter_mut().zip(&first) {
            *sum += first;
        }
        let mut values = vec![0.0_f32; width * height];
        for (j, to) in values.chunks_exact_mut(width).enumerate() {
            let next = row(j + reach + 1);
            let before = row(j.saturating_sub(reach + 1));
            let last = row(j.saturating_sub(reach));
            for i in 0..width {
                let (next, before) = (f64::from(next[i]), f64::from(before[i]));
                to[i] = to_f32((sums[i] + edge * (before + next)) * scale);
                sums[i] += next - f64::from(last[i]);
            }
        }
        self.values = values;
    }

    /// The picture with rows and columns exchanged.
    fn transposed(&self) -> Self {
        let mut values = vec![0.0_f32; self.values.len()];
        for (j, row) in self.values.chunks_exact(self.width.max(1)).enumerate() {
            for (i, value) in row.iter().enumerate() {
                values[i * self.height + j] = *value;
            }
        }
        Self {
            width: self.height,
            height: self.width,
            values,
            colour: None,
            hidden: None,
        }
    }
}

fn add(sums: &mut [f64], row: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(row) {
        *sum += f64::from(*value);
    }
}

/// The grey level nearest to a value, 0 to 255.
pub(crate) fn to_level(value: f64) -> u8 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to 0..=255"
    )]
    let level = value.round().clamp(0.0, 255.0) as u8;
    level
}

/// A grey level or a share as pictures hold it.
pub(crate) fn to_f32(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "a picture holds f32")]
    let value = value as f32;
    value
}

#[cfg(test)]
mod tests {
    use super::PhotoPixels;

    /// A point spreads to a spot of weight 1 whose variance along x is the square of what was asked
    /// for, whole or not; 1e-3 is the rounding of f32 over 121 columns.
    #[test]
    fn a_blur_has_the_standard_deviation_that_was_asked_for() {
        let (n, middle) = (121_usize, 60_usize);
        for sd in [0.6_f64, 1.4, 3.3, 6.0, 9.7] {
            let mut point = vec![0.0; n * n];
            point[middle * n + middle] = 1.0;
            let spot = PhotoPixels::from_values(n, point).blurred(sd);
            let (mut weight, mut square) = (0.0, 0.0);
            for (k, value) in spot.values().iter().enumerate() {
                let off = (k % n) as f64 - middle as f64;
                weight += f64::from(*value);
                square += f64::from(*value) * off * off;
            }
            assert!((weight - 1.0).abs() < 1e-3, "weight {weight}");
            assert!((square.sqrt() / sd - 1.0).abs() < 1e-3, "{square} for {sd}");
        }
    }
}
