//! Drawn pictures of heaps whose flanks are known.

use super::paint::taken;
use crate::PhotoPixels;
use crate::pixels::to_f32;
use image::GrayImage;
use random_stream::Stream;
use surface_profile::SurfacePoint;

/// A heap on a level table, seen from the side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeapScene {
    /// Width of the picture, px; its height is two thirds of that.
    pub width: u32,
    /// Inclination of the left and the right flank, rad.
    pub flanks: [f64; 2],
    /// Where the lines of the flanks meet, parts of the width from the left and from above.
    pub apex: [f64; 2],
    /// Height of the table, parts of the width from above.
    pub table: f64,
    /// Distance from the apex over which the top is rounded, parts of the width.
    pub rounding: f64,
    /// Grey levels of bed, air and table, 0 to 255.
    pub tones: [f64; 3],
    /// Standard deviation of the blur, px.
    pub blur: f64,
    /// Standard deviation of the grey noise, levels.
    pub noise: f64,
    /// Amplitude of a bumpy surface, parts of the width; its bumps are ten times as long.
    pub bumps: f64,
    /// Number of the random picture.
    pub seed: u64,
}

impl Default for HeapScene {
    /// A dark heap of 32 degrees on a dark table before a bright wall.
    fn default() -> Self {
        Self {
            width: 900,
            flanks: [0.56, 0.56],
            apex: [0.5, 0.2],
            table: 0.48,
            rounding: 0.02,
            tones: [60.0, 210.0, 40.0],
            blur: 1.0,
            noise: 3.0,
            bumps: 0.0,
            seed: 1,
        }
    }
}

impl HeapScene {
    /// Draws the picture; a width of 0 is drawn as 3 px.
    pub fn draw(&self) -> GrayImage {
        let width = self.width.max(3);
        let height = width * 2 / 3;
        let mut random = Stream::new(self.seed, "drawn heap");
        let w = f64::from(width);
        let waves: Vec<[f64; 3]> = (0..6)
            .map(|_| {
                let length = 10.0 * self.bumps * w * random.between(0.7, 1.5);
                let turn = std::f64::consts::TAU;
                [
                    0.58 * self.bumps * w,
                    turn / length.max(1.0),
                    turn * random.uniform(),
                ]
            })
            .collect();
        let [bed, air, table] = self.tones;
        let columns = width as usize;
        let mut gray = vec![0.0_f32; columns * height as usize];
        for (k, value) in gray.iter_mut().enumerate() {
            let (x, y) = ((k % columns) as f64, (k / columns) as f64);
            let bump: f64 = waves.iter().map(|[a, k, p]| a * (k * x + p).cos()).sum();
            let surface = self.depth_at(x) + bump;
            let in_bed = (0.5 + y - surface).clamp(0.0, 1.0);
            let in_table = (0.5 + y - self.table * w).clamp(0.0, 1.0);
            let above = air + (bed - air) * in_bed;
            *value = to_f32(above + (table - above) * in_table);
        }
        let picture = PhotoPixels::from_values(columns, gray);
        taken(picture, self.blur, self.noise, &mut random)
    }

    /// The true outline without bumps, px, y up from the upper border: heap and table.
    pub fn outline(&self) -> Vec<SurfacePoint> {
        let table = self.table * f64::from(self.width.max(3));
        (0..self.width.max(3))
            .map(f64::from)
            .map(|x| SurfacePoint {
                x,
                y: -self.depth_at(x).min(table),
            })
            .collect()
    }

    /// Distance of the smooth surface from the upper border in a column, px.
    fn depth_at(&self, x: f64) -> f64 {
        let w = f64::from(self.width.max(3));
        let off = x - self.apex[0] * w;
        let flank = self.flanks[usize::from(off >= 0.0)];
        self.apex[1] * w + flank.tan() * off.hypot(self.rounding * w)
    }
}
