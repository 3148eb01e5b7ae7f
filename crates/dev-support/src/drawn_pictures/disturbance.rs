//! What a real picture has besides bed, air and drum.

use crate::drawn_pictures::Scene;
use crate::drawn_pictures::camera::to_f32;
use crate::drawn_pictures::paint::Ellipse;
use probability::random_stream::Stream;

/// Troubles of a drawn picture; the default has none. Places come from the scene's seed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// Part of the light lost at the corners of the picture, growing with the square of the
    /// distance from its middle, 0 to 1.
    pub vignette: f64,
    /// Change of the light across the picture to the right and down, parts of the mean, 1.
    pub light: [f64; 2],
    /// Soft bright bars on the glass, as a window gives.
    pub n_reflections: u32,
    /// Grey levels that a reflection adds.
    pub reflection: f64,
    /// Bolt heads on the rim.
    pub n_bolts: u32,
    /// Part of the way round that an object in front hides the rim, 0 to 1.
    pub hidden: f64,
    /// Grey levels added in a band of 0.04 drum radii above the surface.
    pub halo: f64,
    /// Part of the light lost beside the rim, fading over 0.1 drum radii, 0 to 1.
    pub shadow: f64,
    /// Particles of the tone of the bed stuck to the glass above it.
    pub n_stuck: u32,
    /// Height to which bed climbs the wall over the uphill end of the surface, drum radii.
    pub curl: f64,
    /// Radius of an axle hub on the end plate, drum radii.
    pub hub: f64,
    /// How far the edge on the back wall lies above the front edge, drum radii; the strip
    /// between is half way from bed to air.
    pub back_edge: f64,
    /// Boxes of any tone outside the drum.
    pub n_clutter: u32,
    /// Standard deviation of a blotchy tone of bed and air, grey levels.
    pub blotches: f64,
}

impl Disturbance {
    /// No trouble.
    pub const NONE: Self = Self {
        vignette: 0.0,
        light: [0.0, 0.0],
        n_reflections: 0,
        reflection: 0.0,
        n_bolts: 0,
        hidden: 0.0,
        halo: 0.0,
        shadow: 0.0,
        n_stuck: 0,
        curl: 0.0,
        hub: 0.0,
        back_edge: 0.0,
        n_clutter: 0,
        blotches: 0.0,
    };
}

impl Default for Disturbance {
    fn default() -> Self {
        Self::NONE
    }
}

impl Scene {
    /// Things outside the drum, before the drum is drawn over them.
    pub(crate) fn draw_clutter(&self, gray: &mut [f32], random: &mut Stream) {
        let size = f64::from(self.size);
        let [cx, cy] = self.centre();
        for _ in 0..self.disturbance.n_clutter {
            let (x, y) = (random.uniform() * size, random.uniform() * size);
            let half = [
                random.between(0.02, 0.2) * size,
                random.between(0.02, 0.2) * size,
            ];
            let tone = random.between(0.0, 255.0);
            self.each_pixel(gray, |px, py, old| {
                let beyond =
                    (px - cx).hypot((py - cy) / self.aspect) > self.radius + self.rim_width;
                let hit = (px - x).abs() < half[0] && (py - y).abs() < half[1];
                if beyond && hit { tone } else { old }
            });
        }
    }

    /// Hub, stuck particles, bolts and what hides the rim.
    pub(crate) fn draw_things(&self, gray: &mut [f32], random: &mut Stream) {
        let [cx, cy] = self.centre();
        let width = self.size as usize;
        let d = &self.disturbance;
        let radius = self.radius;
        if d.hub > 0.0 {
            let tone = random.between(0.0, 255.0);
            Ellipse::circle(cx, cy, d.hub * radius).paint(gray, width, |_, _, _| Some(tone));
        }
        for _ in 0..d.n_stuck {
            let (sin, cos) = (std::f64::consts::TAU * random.uniform()).sin_cos();
            let r = radius * random.uniform().sqrt();
            let half = radius * random.between(0.01, 0.035);
            let (x, y) = (cx + r * cos, cy - r * sin * self.aspect);
            let tone = self.bed + 0.1 * (self.air - self.bed) * random.normal();
            Ellipse::circle(x, y, half).paint(gray, width, |px, py, _| {
                let inside = (px - cx).hypot((py - cy) / self.aspect) < radius;
                inside.then_some(tone)
            });
        }
        for k in 0..d.n_bolts {
            let turn = std::f64::consts::TAU * (f64::from(k) + 0.3) / f64::from(d.n_bolts);
            let r = radius * 1.03 + self.rim_width;
            let (x, y) = (cx + r * turn.cos(), cy + r * turn.sin() * self.aspect);
            let tone = random.between(0.0, 255.0);
            Ellipse::circle(x, y, 0.035 * radius).paint(gray, width, |_, _, _| Some(tone));
        }
        if d.hidden > 0.0 {
            self.draw_hiding(gray, random);
        }
    }

    /// A wedge over the rim, from 0.88 radii outwards.
    fn draw_hiding(&self, gray: &mut [f32], random: &mut Stream) {
        let [cx, cy] = self.centre();
        let middle = std::f64::consts::TAU * random.uniform();
        let tone = random.between(0.0, 255.0);
        let half = self.disturbance.hidden * std::f64::consts::PI;
        self.each_pixel(gray, |px, py, old| {
            let (x, y) = (px - cx, (py - cy) / self.aspect);
            let off = (y.atan2(x) - middle).rem_euclid(std::f64::consts::TAU);
            let near = off.min(std::f64::consts::TAU - off) < half;
            if near && x.hypot(y) > 0.88 * self.radius {
                tone
            } else {
                old
            }
        });
    }

    /// Light over the picture and bars of it on the glass.
    pub(crate) fn light(&self, gray: &mut [f32], random: &mut Stream) {
        let d = self.disturbance;
        let half = 0.5 * f64::from(self.size);
        if d.vignette > 0.0 || d.light != [0.0, 0.0] {
            self.each_pixel(gray, |px, py, old| {
                let (x, y) = (px / half - 1.0, py / half - 1.0);
                let slope = 1.0 + 0.5 * (d.light[0] * x + d.light[1] * y);
                old * slope * (1.0 - d.vignette * 0.5 * (x * x + y * y)).max(0.0)
            });
        }
        let [cx, cy] = self.centre();
        for _ in 0..d.n_reflections {
            let (sin, cos) = (std::f64::consts::PI * random.uniform()).sin_cos();
            let (x, y) = (
                cx + self.radius * random.between(-0.7, 0.7),
                cy + self.radius * random.between(-0.7, 0.7),
            );
            let (long, wide) = (
                self.radius * random.between(0.1, 0.4),
                self.radius * random.between(0.03, 0.1),
            );
            let edge = 0.02 * self.radius;
            self.each_pixel(gray, |px, py, old| {
                let (dx, dy) = (px - x, py - y);
                let along = (long - (dx * cos + dy * sin).abs()) / edge;
                let across = (wide - (dy * cos - dx * sin).abs()) / edge;
                let part = along.clamp(0.0, 1.0) * across.clamp(0.0, 1.0);
                old + d.reflection * part
            });
        }
    }

    /// Replaces each pixel by a function of its place and value.
    fn each_pixel(&self, gray: &mut [f32], new: impl Fn(f64, f64, f64) -> f64) {
        let width = self.size as usize;
        for (k, value) in gray.iter_mut().enumerate() {
            let (x, y) = ((k % width) as f64, (k / width) as f64);
            *value = to_f32(new(x, y, f64::from(*value)));
        }
    }
}
