//! Grey steps along the radii around a circle.

use crate::PhotoPixels;
use crate::circle::Circle;
use surface_profile::median;

/// Rays from the axis.
pub(crate) const N_RAYS: usize = 360;
/// Each ray is the mean of so many side by side, over [`RAY_WIDTH`].
const N_SIDE: i32 = 5;
/// Width of a ray, rad: 2.5 degrees. It averages noise and grains along the rim.
const RAY_WIDTH: f64 = 0.044;
/// Edges wider than this part of the window count as blurred.
const WIDE: f64 = 0.12;

/// An edge on one radius.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RimPoint {
    /// Horizontal coordinate, px.
    pub(crate) x: f64,
    /// Vertical coordinate, px.
    pub(crate) y: f64,
}

impl RimPoint {
    /// Distance from a circle, positive outside, px.
    pub(crate) fn off(&self, circle: &Circle) -> f64 {
        (self.x - circle.x).hypot(self.y - circle.y) - circle.r
    }
}

/// Grey steps along the radii around a circle.
pub(crate) struct Rays {
    /// The circle, px.
    circle: Circle,
    /// Step along a radius, px.
    step: f64,
    /// Absolute grey step at each place of each ray, from inside out.
    slopes: Vec<Vec<f64>>,
}

impl Rays {
    /// Samples the rays within the window (px) about the circle.
    pub(crate) fn scan(picture: &PhotoPixels, circle: &Circle, window: f64) -> Self {
        let step = (circle.r / 400.0).max(0.5);
        let n = (window / step).ceil();
        let slopes = (0..N_RAYS).map(|ray| {
            let turn = std::f64::consts::TAU * (ray as f64 + 0.5) / N_RAYS as f64;
            let sides: Vec<(f64, f64)> = (0..N_SIDE)
                .map(|k| RAY_WIDTH * ((f64::from(k) + 0.5) / f64::from(N_SIDE) - 0.5))
                .map(|side| (turn + side).sin_cos())
                .collect();
            let mut gray = Vec::new();
            let mut k = -n - 2.0;
            while k <= n + 2.0 {
                let r = circle.r + k * step;
                let sum: f64 = sides
                    .iter()
                    .map(|(sin, cos)| picture.at(circle.x + r * cos, circle.y + r * sin))
                    .sum();
                gray.push(sum / f64::from(N_SIDE));
                k += 1.0;
            }
            gray.windows(5).map(|w| (w[4] - w[0]).abs()).collect()
        });
        Self {
            circle: *circle,
            step,
            slopes: slopes.collect(),
        }
    }

    /// Distance of a place on a ray from the circle, px.
    pub(crate) fn off(&self, ray: usize, place: f64) -> f64 {
        (place - (self.slopes[ray].len() / 2) as f64) * self.step
    }

    /// The largest grey step of each ray, within a distance (px) of the circle.
    pub(crate) fn strongest(&self, within: f64) -> Vec<f64> {
        (0..N_RAYS)
            .map(|ray| {
                let slopes = self.slopes[ray].iter().enumerate();
                slopes
                    .filter(|(place, _)| self.off(ray, *place as f64).abs() <= within)
                    .fold(0.0, |most, (_, slope)| f64::max(most, *slope))
            })
            .collect()
    }

    /// The least grey step that counts as an edge: a quarter of the rim's, and above noise.
    pub(crate) fn weakest(&self, near: f64) -> f64 {
        let mut strengths = self.strongest(near);
        strengths.sort_by(f64::total_cmp);
        let mut all: Vec<f64> = self.slopes.iter().flatten().copied().collect();
        let noise = median(&mut all);
        let typical = strengths[N_RAYS * 3 / 4];
        let length = self.slopes[0].len() as f64 * self.step;
        let noise = if self.edge_width() > WIDE * length {
            // A blur this wide fills the window with slopes that are not noise.
            (4.0 * noise).min(0.5 * typical)
        } else {
            4.0 * noise
        };
        (0.25 * typical).max(noise).max(2.0)
    }

    /// Edges of a ray at least so strong: their distances from the circle, px.
    pub(crate) fn edges(&self, ray: usize, weakest: f64) -> Vec<f64> {
        let slopes = &self.slopes[ray];
        (1..slopes.len().saturating_sub(1))
            .filter(|k| slopes[*k] >= weakest)
            .filter(|k| slopes[*k] >= slopes[k - 1] && slopes[*k] > slopes[k + 1])
            .map(|k| self.off(ray, k as f64))
            .collect()
    }

    /// Median width over which the grey step of a ray stays above half of its largest, px.
    pub(crate) fn edge_width(&self) -> f64 {
        let mut widths: Vec<f64> = self
            .slopes
            .iter()
            .map(|slopes| {
                let best =
                    (0..slopes.len()).fold(0, |b, i| if slopes[i] > slopes[b] { i } else { b });
                let above = |k: &usize| slopes[*k] > 0.5 * slopes[best];
                let before = (0..best).rev().take_while(above).count();
                let after = (best..slopes.len()).take_while(above).count();
                (before + after) as f64 * self.step
            })
            .collect();
        median(&mut widths)
    }

    /// The steepest grey step of each ray, weak ones left out.
    pub(crate) fn steepest(&self) -> Vec<RimPoint> {
        let strengths = self.strongest(f64::INFINITY);
        let mut sorted = strengths.clone();
        sorted.sort_by(f64::total_cmp);
        let weakest = (0.25 * sorted[N_RAYS * 3 / 4]).max(2.0);
        (0..N_RAYS)
            .filter(|ray| strengths[*ray] >= weakest)
            .filter_map(|ray| self.steepest_on(ray))
            .collect()
    }

    /// The steepest grey step of one ray, by the vertex of the parabola about it; none if it
    /// has no top within the window.
    pub(crate) fn steepest_on(&self, ray: usize) -> Option<RimPoint> {
        let slopes = &self.slopes[ray];
        let is_top = |k: &usize| slopes[*k] >= slopes[k - 1] && slopes[*k] > slopes[k + 1];
        let best = (1..slopes.len().saturating_sub(1))
            .filter(is_top)
            .reduce(|b, k| if slopes[k] > slopes[b] { k } else { b })?;
        let (before, after) = (slopes[best - 1], slopes[best + 1]);
        let bend = before - 2.0 * slopes[best] + after;
        let shift = if bend < 0.0 {
            (0.5 * (before - after) / bend).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        let place = best as f64 + shift;
        let turn = std::f64::consts::TAU * (ray as f64 + 0.5) / N_RAYS as f64;
        let r = self.circle.r + self.off(ray, place);
        Some(RimPoint {
            x: self.circle.x + r * turn.cos(),
            y: self.circle.y + r * turn.sin(),
        })
    }
}
