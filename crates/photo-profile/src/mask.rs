//! Places of a picture that show something else than bed and air: a clamp before the drum, a label, a reflection.

use crate::pixels::to_f32;
use crate::{Error, PhotoPixels, PixelPoint};
use image::GrayImage;
use std::path::Path;
use std::sync::Arc;

/// A mask hides where it is darker than this.
const HALF: u8 = 128;

/// A picture that is black where something else than bed and air shows, white elsewhere.
#[derive(Debug, Clone)]
pub struct Mask(GrayImage);

impl Mask {
    /// Reads a mask from a picture file.
    ///
    /// # Errors
    /// As [`crate::read_photo`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        Ok(Self(crate::read_photo(path)?.into_luma8()))
    }
}

/// Which pixels are hidden, row by row from the top.
#[derive(Debug, Clone)]
pub(crate) struct Hidden {
    /// Pixels along x.
    width: usize,
    /// Whether a pixel is hidden, shape (height, width).
    pixels: Arc<Vec<bool>>,
}

impl Hidden {
    /// Whether a pixel within `reach` (px) of a place is hidden.
    pub(crate) fn is_near(&self, place: PixelPoint, reach: f64) -> bool {
        let height = self.pixels.len() / self.width.max(1);
        let (columns, rows) = (
            span(place.x, reach, self.width),
            span(place.y, reach, height),
        );
        rows.into_iter().any(|j| {
            let row = &self.pixels[j * self.width..][..self.width];
            row[columns.clone()].contains(&true)
        })
    }

    /// The part of a rectangle: first column and row, columns and rows.
    pub(crate) fn part(&self, [left, top, width, height]: [usize; 4]) -> Self {
        let rows = self.pixels.chunks_exact(self.width.max(1));
        let rows = rows.skip(top).take(height);
        Self {
            width,
            pixels: Arc::new(
                rows.flat_map(|row| &row[left..][..width])
                    .copied()
                    .collect(),
            ),
        }
    }
}

/// The pixels within `reach` of a coordinate along a side of n.
fn span(at: f64, reach: f64, n: usize) -> std::ops::Range<usize> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the picture"
    )]
    let pixel = |v: f64| v.clamp(0.0, n as f64) as usize;
    pixel((at - reach).round())..pixel((at + reach).round() + 1.0)
}

impl PhotoPixels {
    /// The picture with the dark places of a mask of the same size hidden: they are filled from around them, and no point of a
    /// surface at or near them counts.
    ///
    /// # Formula
    /// Filled by averages over ever larger blocks of what is seen, read back between the centres of the blocks: the pull-push
    /// of `[Gortler1996, section 3.4]`.
    ///
    /// # Errors
    /// [`Error::BadMask`] for a mask of another size, and one that hides all.
    pub fn hiding(self, mask: &Mask) -> Result<Self, Error> {
        let Mask(mask) = mask;
        let sizes = [mask.width() as usize, mask.height() as usize];
        let pixels: Vec<bool> = mask.as_raw().iter().map(|level| *level < HALF).collect();
        if sizes != [self.width(), self.height()] || !pixels.contains(&false) {
            return Err(Error::BadMask {
                mask: sizes,
                picture: [self.width(), self.height()],
            });
        }
        let width = self.width();
        let filled = self.map_channels(|values| fill(values, &pixels, width));
        Ok(filled.knowing(Hidden {
            width,
            pixels: Arc::new(pixels),
        }))
    }
}

/// Fills the hidden values of a grid from those around them.
fn fill(values: &mut [f32], hidden: &[bool], width: usize) {
    if !hidden.contains(&true) {
        return;
    }
    let weight = |hidden: &bool| f64::from(u8::from(!hidden));
    let seen: Vec<[f64; 2]> = values
        .iter()
        .zip(hidden)
        .map(|(value, hidden)| [weight(hidden) * f64::from(*value), weight(hidden)])
        .collect();
    let filled = pull_push(&seen, width);
    for ((value, hidden), filled) in values.iter_mut().zip(hidden).zip(filled) {
        if *hidden {
            *value = to_f32(filled);
        }
    }
}

/// Values of a grid of (weight times value, weight), those of weight zero from coarser grids.
fn pull_push(seen: &[[f64; 2]], width: usize) -> Vec<f64> {
    let height = seen.len() / width;
    if width == 1 && height == 1 {
        let [sum, weight] = seen[0];
        return vec![if weight > 0.0 { sum / weight } else { 0.0 }];
    }
    let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
    let mut coarse = vec![[0.0; 2]; columns * rows];
    for (k, [sum, weight]) in seen.iter().enumerate() {
        let to = &mut coarse[k / width / 2 * columns + k % width / 2];
        to[0] += sum;
        to[1] += weight;
    }
    // A block counts no more than a pixel, or the nearest values would be lost among far ones.
    for [sum, weight] in &mut coarse {
        let scale = weight.max(1.0);
        *sum /= scale;
        *weight /= scale;
    }
    let below = pull_push(&coarse, columns);
    let between = |i: usize, n: usize| {
        // Pixel i lies a quarter of a block off the centre of its block.
        let (block, other) = (
            i / 2,
            if i.is_multiple_of(2) {
                (i / 2).saturating_sub(1)
            } else {
                (i / 2 + 1).min(n - 1)
            },
        );
        [(block, 0.75), (other, 0.25)]
    };
    let filled = seen.iter().enumerate().map(|(k, pair)| {
        let around: f64 = between(k / width, rows)
            .iter()
            .flat_map(|(j, b)| {
                between(k % width, columns).map(|(i, a)| a * b * below[j * columns + i])
            })
            .sum();
        pair[0] + (1.0 - pair[1]).max(0.0) * around
    });
    filled.collect()
}

#[cfg(test)]
mod tests {
    use super::fill;

    /// A plane is kept where it is seen, and a hole in it filled to within the slope over the hole: a tenth of a level a pixel
    /// and ten pixels.
    #[test]
    fn a_hole_in_a_plane_is_filled_from_around_it() {
        let n = 64;
        let plane = |k: usize| 100.0 + 0.1 * (k % n) as f32 + 0.05 * (k / n) as f32;
        let hidden: Vec<bool> = (0..n * n)
            .map(|k| (20..30).contains(&(k % n)) && (30..40).contains(&(k / n)))
            .collect();
        let mut values: Vec<f32> = (0..n * n).map(plane).collect();
        for (value, hidden) in values.iter_mut().zip(&hidden) {
            if *hidden {
                *value = 255.0;
            }
        }
        fill(&mut values, &hidden, n);
        for (k, value) in values.iter().enumerate() {
            let tolerance = if hidden[k] { 1.0 } else { 0.0 };
            assert!(
                (value - plane(k)).abs() <= tolerance,
                "{k}: {value} for {}",
                plane(k)
            );
        }
    }
}
