//! Ellipses, grey values and the camera of drawn pictures.

use crate::PhotoPixels;
use crate::pixels::{to_f32, to_level};
use image::GrayImage;
use random_stream::Stream;

/// An ellipse in the picture.
pub(super) struct Ellipse {
    /// Horizontal coordinate of the centre, px.
    pub(super) x: f64,
    /// Vertical coordinate of the centre, px.
    pub(super) y: f64,
    /// Semi-axes, px.
    pub(super) half: [f64; 2],
    /// Direction of the first axis, rad.
    pub(super) turn: f64,
}

impl Ellipse {
    /// A circle.
    pub(super) fn circle(x: f64, y: f64, radius: f64) -> Self {
        Self {
            x,
            y,
            half: [radius, radius],
            turn: 0.0,
        }
    }

    /// Paints the pixels inside with the tone for (x, y, squared distance in semi-axes).
    pub(super) fn paint(
        &self,
        gray: &mut [f32],
        width: usize,
        tone: impl Fn(f64, f64, f64) -> Option<f64>,
    ) {
        let reach = self.half[0].max(self.half[1]).ceil() + 1.0;
        let (sin, cos) = self.turn.sin_cos();
        let mut y = (self.y - reach).floor();
        while y <= self.y + reach {
            let mut x = (self.x - reach).floor();
            while x <= self.x + reach {
                let (dx, dy) = (x - self.x, y - self.y);
                let a = (dx * cos + dy * sin) / self.half[0];
                let b = (dy * cos - dx * sin) / self.half[1];
                let rim = a * a + b * b;
                let last = width as f64 - 1.0;
                if rim <= 1.0 && (0.0..=last).contains(&x) && (0.0..=last).contains(&y) {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "whole numbers inside the picture"
                    )]
                    let k = y as usize * width + x as usize;
                    if let (Some(value), Some(tone)) = (gray.get_mut(k), tone(x, y, rim)) {
                        *value = to_f32(tone);
                    }
                }
                x += 1.0;
            }
            y += 1.0;
        }
    }
}

/// Takes the picture as a camera does: blurs it, adds noise (both standard deviations, px and
/// grey levels; 0 for none) and rounds to whole grey levels.
pub(super) fn taken(
    mut picture: PhotoPixels,
    blur: f64,
    noise: f64,
    random: &mut Stream,
) -> GrayImage {
    if blur > 0.0 {
        picture = picture.blurred(blur);
    }
    let noisy: Vec<u8> = picture
        .values()
        .iter()
        .map(|v| to_level(f64::from(*v) + noise * random.normal()))
        .collect();
    let side = |n: usize| u32::try_from(n).unwrap_or(0);
    GrayImage::from_raw(side(picture.width()), side(picture.height()), noisy).unwrap_or_default()
}
