//! Ellipses and grey values.

use crate::drawn_pictures::camera::to_f32;

/// An ellipse in the picture.
pub(crate) struct Ellipse {
    /// Horizontal coordinate of the centre, px.
    pub(crate) x: f64,
    /// Vertical coordinate of the centre, px.
    pub(crate) y: f64,
    /// Semi-axes, px.
    pub(crate) half: [f64; 2],
    /// Direction of the first axis, rad.
    pub(crate) turn: f64,
}

impl Ellipse {
    pub(crate) fn circle(x: f64, y: f64, radius: f64) -> Self {
        Self {
            x,
            y,
            half: [radius, radius],
            turn: 0.0,
        }
    }

    /// Paints the pixels inside with the tone for (x, y, squared distance in semi-axes).
    pub(crate) fn paint(
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
