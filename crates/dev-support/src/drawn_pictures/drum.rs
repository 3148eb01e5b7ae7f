//! Drums.

use crate::drawn_pictures::Disturbance;
use crate::drawn_pictures::camera::{taken, to_f32};
use crate::drawn_pictures::paint::Ellipse;
use image::GrayImage;
use probability::random_stream::Stream;
use surface_profile::{DrumCircle, SurfacePoint};

/// A drum picture to be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Side of the square picture, px.
    pub size: u32,
    /// Inner radius of the drum, px.
    pub radius: f64,
    /// The drum axis relative to the middle of the picture: right, down, px.
    pub shift: [f64; 2],
    /// Signed inclination of the surface, positive when it rises to the right, rad.
    pub inclination: f64,
    /// Height of the surface over the axis along its normal, drum radii; below -1 the drum is
    /// empty, above 1 full.
    pub height: f64,
    /// Quadratic coefficient, height in half-chords, positive when the ends stand up, 1.
    pub curvature: f64,
    /// Cubic coefficient as in [`surface_profile::SurfaceAngle::s_shape`], 1.
    pub s_shape: f64,
    /// Grey level of the bed, 0 to 255.
    pub bed: f64,
    /// Grey level of the air, 0 to 255.
    pub air: f64,
    /// Grey level outside the drum, 0 to 255.
    pub outside: f64,
    /// Grey level of the rim, 0 to 255.
    pub rim: f64,
    /// Width of the rim, px.
    pub rim_width: f64,
    /// Standard deviation of the blur, px; 0 for none.
    pub blur: f64,
    /// Width of the grey ramp of a time average across the surface, px; 0 for none.
    pub ramp: f64,
    /// Standard deviation of the grey noise, levels.
    pub noise: f64,
    /// Semi-axes of the grains, px; 0 for a powder of one tone.
    pub grain: [f64; 2],
    /// Number of dust specks on the glass.
    pub n_dust: u32,
    /// Ratio of the height of the drum to its width: 1 seen along the axis.
    pub aspect: f64,
    /// Further things in the picture.
    pub disturbance: Disturbance,
    /// Number of the random picture.
    pub seed: u64,
}

impl Default for Scene {
    /// A sharp dark powder at half filling against bright air, 35 degrees, 560 px.
    fn default() -> Self {
        Self {
            size: 560,
            radius: 265.0,
            shift: [0.0, 0.0],
            inclination: -0.61,
            height: 0.0,
            curvature: 0.0,
            s_shape: 0.0,
            bed: 40.0,
            air: 200.0,
            outside: 20.0,
            rim: 90.0,
            rim_width: 2.0,
            blur: 0.0,
            ramp: 0.0,
            noise: 0.0,
            grain: [0.0, 0.0],
            n_dust: 0,
            aspect: 1.0,
            disturbance: Disturbance::NONE,
            seed: 1,
        }
    }
}

impl Scene {
    /// Draws the picture.
    ///
    /// A size of 0 is drawn as 1 px.
    pub fn draw(&self) -> GrayImage {
        let size = self.size.max(1);
        let mut random = Stream::new(self.seed, "drawn picture");
        let width = size as usize;
        let mut gray: Vec<f32> = vec![to_f32(self.outside); width * width];
        self.draw_clutter(&mut gray, &mut random);
        let blotches = Blotches::new(self.disturbance.blotches, 0.12 * self.radius, &mut random);
        for (k, value) in gray.iter_mut().enumerate() {
            let (x, y) = ((k % width) as f64, (k / width) as f64);
            let tone = blotches.at(x, y);
            *value = to_f32(self.plain(x, y, tone, f64::from(*value)));
        }
        if self.grain[0] > 0.0 {
            self.draw_grains(&mut gray, &mut random);
        }
        self.draw_things(&mut gray, &mut random);
        self.light(&mut gray, &mut random);
        for _ in 0..self.n_dust {
            let (x, y) = (
                random.uniform() * f64::from(size),
                random.uniform() * f64::from(size),
            );
            let (half, tone) = (1.0 + 2.0 * random.uniform(), 255.0 * random.uniform());
            Ellipse::circle(x, y, half).paint(&mut gray, width, |_, _, _| Some(tone));
        }
        taken(&gray, width, (self.blur, self.noise), &mut random)
    }

    /// The true surface as points about the axis, px, y up.
    pub fn surface(&self) -> Vec<SurfacePoint> {
        let (sin, cos) = self.inclination.sin_cos();
        let half_chord = self.half_chord();
        (-480..=480)
            .map(|k| {
                let u = f64::from(k) / 500.0 * half_chord;
                let v = self.height_at(u);
                SurfacePoint {
                    x: u * cos - v * sin,
                    y: u * sin + v * cos,
                }
            })
            .filter(|p| p.x.hypot(p.y) <= 0.96 * self.radius)
            .collect()
    }

    /// The drum about its axis, px.
    pub fn drum(&self) -> DrumCircle {
        DrumCircle {
            x: 0.0,
            y: 0.0,
            radius: self.radius,
        }
    }

    /// Middle of the drum in the picture, px.
    pub(crate) fn centre(&self) -> [f64; 2] {
        let middle = 0.5 * (f64::from(self.size) - 1.0);
        [middle + self.shift[0], middle + self.shift[1]]
    }

    /// Half the chord of the straight surface, at least a tenth of the radius, px.
    fn half_chord(&self) -> f64 {
        self.radius * (1.0 - self.height * self.height).max(0.01).sqrt()
    }

    /// Height of the surface over the axis at u to the right along its line, px.
    fn height_at(&self, u: f64) -> f64 {
        let half_chord = self.half_chord();
        let downhill = if self.inclination > 0.0 { -1.0 } else { 1.0 };
        let t = downhill * u / half_chord;
        // The cubic has no slope of its own over the chord: its line stays the surface line.
        let shape = self.curvature * (t * t - 1.0 / 3.0) + self.s_shape * (t * t * t - 0.6 * t);
        self.height * self.radius + half_chord * shape
    }

    /// How deep a place about the axis (y up) lies under the surface, along its normal, px.
    fn depth(&self, x: f64, y: f64) -> f64 {
        let (sin, cos) = self.inclination.sin_cos();
        let (u, v) = (x * cos + y * sin, -x * sin + y * cos);
        self.height_at(u) - v
    }

    /// Part of a place about the axis (y up) that is bed: surface, ramp, back edge and curl.
    fn bed_share(&self, x: f64, y: f64) -> f64 {
        let ramp = self.ramp.max(1.0);
        let depth = self.depth(x, y);
        let front = (0.5 + depth / ramp).clamp(0.0, 1.0);
        let back =
            (0.5 + (depth + self.disturbance.back_edge * self.radius) / ramp).clamp(0.0, 1.0);
        let mut share = 0.5 * (front + back);
        if self.disturbance.curl > 0.0 {
            // A layer on the wall whose thickness falls from 0.06 radii to nothing.
            let uphill = if self.inclination > 0.0 { x } else { -x };
            let rise = -depth / (self.disturbance.curl * self.radius);
            let thickness = 0.06 * self.radius * (1.0 - rise).max(0.0);
            let from_wall = self.radius - x.hypot(y);
            if uphill > 0.0 && rise > 0.0 {
                share = share.max((thickness - from_wall + 0.5).clamp(0.0, 1.0));
            }
        }
        share
    }

    /// Grey level of a pixel without grains, blur and noise; `blotch` is added inside the drum,
    /// `behind` shows outside.
    fn plain(&self, x: f64, y: f64, blotch: f64, behind: f64) -> f64 {
        let [cx, cy] = self.centre();
        let (x, y) = (x - cx, (cy - y) / self.aspect);
        let off_rim = x.hypot(y) - self.radius;
        let bed_share = if self.grain[0] > 0.0 {
            0.0
        } else {
            self.bed_share(x, y)
        };
        let mut interior = self.air + (self.bed - self.air) * bed_share + blotch;
        let over = -self.depth(x, y) / self.radius;
        if (0.0..0.04).contains(&over) {
            interior += self.disturbance.halo;
        }
        let from_rim = (-off_rim / (0.1 * self.radius)).clamp(0.0, 1.0);
        interior *= 1.0 - self.disturbance.shadow * (1.0 - from_rim);
        let on_rim =
            (off_rim + 0.5).clamp(0.0, 1.0) * (self.rim_width - off_rim + 0.5).clamp(0.0, 1.0);
        let beyond = (off_rim - self.rim_width + 0.5).clamp(0.0, 1.0);
        interior * (1.0 - on_rim - beyond).max(0.0) + self.rim * on_rim + behind * beyond
    }

    /// Draws shaded ellipses with centres under the surface, three deep at any place.
    fn draw_grains(&self, gray: &mut [f32], random: &mut Stream) {
        let [cx, cy] = self.centre();
        let area = std::f64::consts::PI * self.grain[0] * self.grain[1];
        let n = 3.0 * std::f64::consts::PI * self.radius * self.radius / area;
        let mut k = 0.0;
        while k < n {
            k += 1.0;
            let r = self.radius * random.uniform().sqrt();
            let (sin, cos) = (std::f64::consts::TAU * random.uniform()).sin_cos();
            let (turn, tone) = (std::f64::consts::PI * random.uniform(), random.normal());
            let (x, y) = (r * cos, r * sin);
            if self.depth(x, y) < 0.0 {
                continue;
            }
            let grain = Ellipse {
                x: cx + x,
                y: cy - self.aspect * y,
                half: self.grain,
                turn,
            };
            let base = self.bed + 0.08 * (self.air - self.bed).abs() * tone;
            grain.paint(gray, self.size as usize, |px, py, rim| {
                let inside = (px - cx).hypot((py - cy) / self.aspect) < self.radius;
                inside.then_some(base * (0.6 + 0.4 * (1.0 - rim).sqrt()))
            });
        }
    }
}

/// A blotchy tone: a few plane waves of random direction and phase.
struct Blotches {
    /// Amplitude, grey levels, and wave vector and phase of each wave, rad per px and rad.
    waves: Vec<[f64; 4]>,
}

impl Blotches {
    /// Waves of about the length (px) whose sum has the standard deviation (levels).
    fn new(sd: f64, length: f64, random: &mut Stream) -> Self {
        let n = if sd > 0.0 { 12_u32 } else { 0 };
        let amplitude = sd * (2.0 / f64::from(n.max(1))).sqrt();
        let waves = (0..n).map(|_| {
            let (sin, cos) = (std::f64::consts::TAU * random.uniform()).sin_cos();
            let k = std::f64::consts::TAU / (length * random.between(0.5, 2.0));
            [
                amplitude,
                k * cos,
                k * sin,
                std::f64::consts::TAU * random.uniform(),
            ]
        });
        Self {
            waves: waves.collect(),
        }
    }

    /// The tone at a place, grey levels.
    fn at(&self, x: f64, y: f64) -> f64 {
        self.waves
            .iter()
            .map(|[a, kx, ky, phase]| a * (kx * x + ky * y + phase).cos())
            .sum()
    }
}
