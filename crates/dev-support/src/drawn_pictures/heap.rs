//! Drawn pictures of heaps whose flanks are known.

use crate::drawn_pictures::camera::{taken, to_f32};
use image::GrayImage;
use probability::random_stream::Stream;
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
    /// Part of the height, from below, in which the foot spreads: there the flanks fall by half of their slope.
    pub spread: f64,
    /// By how much the camera leans, so that the base rises to the right in the picture, rad.
    pub lean: f64,
    /// How far above the base the camera looks down, rad; needs flanks steeper than that.
    pub elevation: f64,
    /// Number of specks of the tone of the bed in the air.
    pub specks: u32,
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
            spread: 0.0,
            lean: 0.0,
            elevation: 0.0,
            specks: 0,
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
            let (x, y) = self.level((k % columns) as f64, (k / columns) as f64);
            let bump: f64 = waves.iter().map(|[a, k, p]| a * (k * x + p).cos()).sum();
            let surface = self.depth_at(x) + bump;
            let in_bed = (0.5 + y - surface).clamp(0.0, 1.0);
            let in_table = (0.5 + y - self.lower_edge(x)).clamp(0.0, 1.0);
            let above = air + (bed - air) * in_bed;
            *value = to_f32(above + (table - above) * in_table);
        }
        for _ in 0..self.specks {
            let middle = [
                random.between(0.0, w),
                random.between(0.0, self.apex[1] * w),
            ];
            let size = random.between(1.0, 0.006 * w);
            for (k, value) in gray.iter_mut().enumerate() {
                let (x, y) = ((k % columns) as f64, (k / columns) as f64);
                if (x - middle[0]).hypot(y - middle[1]) <= size {
                    *value = to_f32(bed);
                }
            }
        }
        taken(&gray, columns, (self.blur, self.noise), &mut random)
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

    /// A place of the picture as a level camera would have it, px: turned back about the middle.
    fn level(&self, x: f64, y: f64) -> (f64, f64) {
        let w = f64::from(self.width.max(3));
        let (sin, cos) = self.lean.sin_cos();
        let (x, y) = (x - 0.5 * w, y - self.table * w);
        (
            x * cos - y * sin + 0.5 * w,
            x * sin + y * cos + self.table * w,
        )
    }

    /// Slope of the outline of a flank as the camera sees it.
    fn slope(&self, flank: usize) -> f64 {
        let (sin, cos) = self.elevation.sin_cos();
        let slope = self.flanks[flank].tan();
        ((slope * cos).powi(2) - sin * sin).max(0.0).sqrt()
    }

    /// Half of the width of the round base that the camera sees from its elevation, px; the flank of that side counts.
    fn base_radius(&self, off: f64) -> f64 {
        let slope = self.flanks[usize::from(off >= 0.0)].tan();
        (self.table - self.apex[1]) * f64::from(self.width.max(3)) / (self.elevation.cos() * slope)
    }

    /// How far the edge of the round base lies above and below its middle in a column, px.
    fn base_edge(&self, off: f64) -> f64 {
        let inside = (1.0 - (off / self.base_radius(off)).powi(2)).max(0.0);
        self.base_radius(off) * self.elevation.sin() * inside.sqrt()
    }

    /// Distance of the lower edge of the heap, or of the table beside it, from the upper border in a column, px: the front of
    /// the base hangs below its middle.
    fn lower_edge(&self, x: f64) -> f64 {
        let w = f64::from(self.width.max(3));
        self.table * w + self.base_edge(x - self.apex[0] * w)
    }

    /// Distance of the smooth surface from the upper border in a column, px.
    fn depth_at(&self, x: f64) -> f64 {
        let w = f64::from(self.width.max(3));
        let off = x - self.apex[0] * w;
        let fall = self.slope(usize::from(off >= 0.0)) * off.hypot(self.rounding * w);
        let spread = (1.0 - self.spread) * (self.table - self.apex[1]) * w;
        let beyond = (fall - spread).max(0.0);
        let flank = self.apex[1] * w + fall - if self.spread > 0.0 { 0.5 * beyond } else { 0.0 };
        // Outside the outline of the cone the back of the base shows.
        let touch = self.elevation.tan() / self.flanks[usize::from(off >= 0.0)].tan();
        if self.elevation > 0.0
            && off.abs() > self.base_radius(off) * (1.0 - touch * touch).max(0.0).sqrt()
        {
            return self.table * w - self.base_edge(off);
        }
        flank
    }
}
