//! Ellipses, grey values and random numbers of drawn pictures.

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

/// Grey value as it is stored.
pub(super) fn to_f32(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "grey levels are f32")]
    let value = value as f32;
    value
}

/// Random numbers of a drawn picture: the splittable counter hash of `[Steele2014]`.
pub(super) struct PixelStream {
    /// Counter of the hash.
    state: u64,
}

impl PixelStream {
    /// The stream of a seed.
    pub(super) fn new(seed: u64) -> Self {
        Self {
            state: seed.wrapping_mul(0xD134_2543_DE82_EF95),
        }
    }

    /// A number in [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [low, high).
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A standard normal number.
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
