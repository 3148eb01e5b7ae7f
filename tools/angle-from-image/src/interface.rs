//! Where the surface lies along the drum, and how it fluctuates there over a series.

use photo_profile::{DrumReading, PixelPoint};
use serde::Serialize;

/// Stations along the drum, from -0.9 to 0.9 radii.
const STATIONS: usize = 19;
/// Step between them, drum radii.
const STEP: f64 = 0.1;
/// Widest gap between two points of a surface that is bridged, drum radii.
const GAP: f64 = 0.1;

/// Height of the surface over the axis at each station, drum radii; none if it does not show.
pub(crate) type Heights = [Option<f64>; STATIONS];

/// Place of a station along the true horizontal, from the axis to the right, drum radii.
fn station(number: usize) -> f64 {
    (number as f64 - (STATIONS / 2) as f64) * STEP
}

/// Where the surface of a drum lies along the true horizontal, which is turned by `roll` (rad) in the picture.
pub(crate) fn heights(bed: &DrumReading, roll: f64) -> Heights {
    let drum = bed.drum;
    let (sin, cos) = roll.sin_cos();
    let level = |p: &PixelPoint| {
        let (right, up) = ((p.x - drum.cx) / drum.r, (drum.cy - p.y) / drum.r);
        (right * cos + up * sin, up * cos - right * sin)
    };
    let mut points: Vec<(f64, f64)> = bed.used.iter().chain(&bed.rejected).map(level).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    std::array::from_fn(|number| {
        let x = station(number);
        let right = points.partition_point(|p| p.0 < x);
        let (a, b) = (points.get(right.checked_sub(1)?)?, points.get(right)?);
        let gap = b.0 - a.0;
        (gap <= GAP).then(|| a.1 + (b.1 - a.1) * if gap > 0.0 { (x - a.0) / gap } else { 0.5 })
    })
}

/// The surface of a series: where it lies on average, and how it fluctuates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Interface {
    /// Pictures that were taken together.
    pub(crate) n: usize,
    /// Places along the true horizontal from the axis to the right, drum radii: those that all pictures show.
    pub(crate) x_radii: Vec<f64>,
    /// Mean height over the axis, drum radii.
    pub(crate) mean_radii: Vec<f64>,
    /// Standard deviation of the height between the pictures, drum radii.
    pub(crate) sd_radii: Vec<f64>,
    /// Mean of these standard deviations, drum radii: what a cohesive index of an instrument is made of.
    pub(crate) fluctuation_radii: f64,
}

impl Interface {
    /// Takes surfaces together; none of fewer than two, and where they have no place in common.
    ///
    /// # Source
    ///
    /// Standard deviation of the position of the surface at each place, averaged along the drum `[Lumay2012]`.
    pub(crate) fn of(surfaces: &[Heights]) -> Option<Self> {
        let n = surfaces.len();
        if n < 2 {
            return None;
        }
        let mut found = Self {
            n,
            x_radii: Vec::new(),
            mean_radii: Vec::new(),
            sd_radii: Vec::new(),
            fluctuation_radii: 0.0,
        };
        for number in 0..STATIONS {
            let heights: Option<Vec<f64>> = surfaces.iter().map(|s| s[number]).collect();
            let Some(heights) = heights else { continue };
            let mean = heights.iter().sum::<f64>() / n as f64;
            let squares: f64 = heights.iter().map(|h| (h - mean).powi(2)).sum();
            found.x_radii.push(station(number));
            found.mean_radii.push(mean);
            found.sd_radii.push((squares / (n - 1) as f64).sqrt());
        }
        if found.sd_radii.is_empty() {
            return None;
        }
        found.fluctuation_radii = found.sd_radii.iter().sum::<f64>() / found.sd_radii.len() as f64;
        Some(found)
    }

    /// The line for people.
    pub(crate) fn text(&self) -> String {
        format!(
            "\nsurface fluctuates by {:.2} % of the drum radius (mean of the standard deviations at {} places)",
            100.0 * self.fluctuation_radii,
            self.x_radii.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{Interface, heights};
    use dev_support::drawn_pictures::Scene;
    use photo_profile::{DrumPixels, Settings, measure_image};

    /// A drawn surface y = h / cos(a) + x tan(a), whose pictures are turned by 0.1 rad: its heights along the true horizontal, to half
    /// a pixel in 180 (0.003), near the rim, where the reading smooths over it, to two (0.01). Two such of other fill: their mean, and their difference over the root of two as the standard deviation, at each
    /// place alike. One alone gives no information.
    #[test]
    fn mean_and_fluctuation_are_those_of_the_surfaces() {
        let (slope, roll) = (0.5_f64, 0.1);
        let of = |height: f64| {
            let scene = Scene {
                size: 400,
                radius: 180.0,
                inclination: slope + roll,
                height,
                blur: 1.0,
                ..Scene::default()
            };
            let settings = Settings {
                drum: Some(DrumPixels {
                    cx: 199.5,
                    cy: 199.5,
                    r: 180.0,
                }),
                ..Settings::default()
            };
            let reading = measure_image(&scene.draw(), &settings).unwrap();
            heights(reading.bed().unwrap(), roll)
        };
        let both = [of(0.0), of(0.1)];
        let found = Interface::of(&both).unwrap();
        assert!(found.x_radii.len() >= 13, "{:?}", found.x_radii);
        for ((x, mean), sd) in found
            .x_radii
            .iter()
            .zip(&found.mean_radii)
            .zip(&found.sd_radii)
        {
            let exact = x * slope.tan() + 0.05 / slope.cos();
            let tolerance = if x.abs() > 0.75 { 0.01 } else { 0.003 };
            assert!(
                (mean - exact).abs() < tolerance,
                "{mean} for {exact} at {x}"
            );
            let apart = 0.1 / slope.cos() / 2.0_f64.sqrt();
            assert!((sd - apart).abs() < tolerance, "{sd} for {apart} at {x}");
        }
        assert!(Interface::of(&both[..1]).is_none());
        assert!(Interface::of(&[both[0], [None; super::STATIONS]]).is_none());
    }
}
