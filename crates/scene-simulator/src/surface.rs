//! The surface of a bed as observables, from the readings of its frames.

use run_store::Observation;
use scene::FrameReading;
use std::collections::BTreeMap;
use surface_profile::{SeriesSummary, summarise};

/// Readings of the surface in the frames that could be measured, deg; curvature and S shape of the same frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceReadings {
    /// Angle by the picture.
    pub image: Vec<f64>,
    /// Angle by the positions of the spheres.
    pub position: Vec<f64>,
    /// Their difference in frames that have both.
    pub difference: Vec<f64>,
    /// Curvature, 1.
    pub curvature: Vec<f64>,
    /// S shape, 1.
    pub s_shape: Vec<f64>,
    /// Share of the drum that the bed takes, 1.
    pub fill_level: Vec<f64>,
    /// Toe of the bed at the shell.
    pub toe: Vec<f64>,
    /// Its top.
    pub top: Vec<f64>,
}

impl SurfaceReadings {
    /// Takes the readings of all frames together.
    pub fn of(readings: &[FrameReading]) -> Self {
        let photos = || readings.iter().filter_map(|r| r.photo.angle);
        let (mut position, mut difference) = (Vec::new(), Vec::new());
        for reading in readings {
            let by_position = reading.position.map(|a| a.line.to_degrees());
            position.extend(by_position);
            let by_image = reading.photo.angle.map(|a| a.line.to_degrees());
            difference.extend(by_image.zip(by_position).map(|(i, p)| i - p));
        }
        let ends = || readings.iter().filter_map(|r| r.photo.bed_ends());
        Self {
            toe: ends().map(|e| e.toe.to_degrees()).collect(),
            top: ends().map(|e| e.top.to_degrees()).collect(),
            image: photos().map(|a| a.line.to_degrees()).collect(),
            position,
            difference,
            curvature: photos().map(|a| a.curvature).collect(),
            s_shape: photos().map(|a| a.s_shape).collect(),
            fill_level: readings.iter().filter_map(|r| r.photo.fill_level).collect(),
        }
    }

    /// Means over the frames, and the scatter of the angle between them; what no frame shows is left out.
    pub fn observables(&self) -> BTreeMap<String, Observation> {
        let means = [
            ("angle_deg", "deg", &self.image),
            ("angle_by_position_deg", "deg", &self.position),
            ("image_minus_position_deg", "deg", &self.difference),
            ("curvature", "1", &self.curvature),
            ("s_shape", "1", &self.s_shape),
            ("fill_level", "1", &self.fill_level),
            ("toe_position_deg", "deg", &self.toe),
            ("top_position_deg", "deg", &self.top),
        ];
        let mut observables: BTreeMap<String, Observation> = means
            .into_iter()
            .filter_map(|(name, unit, values)| Some((name.to_owned(), over_frames(values, unit)?)))
            .collect();
        observables.extend(scatter_of(&self.image).map(|o| ("fluctuation_deg".to_owned(), o)));
        observables
    }
}

/// The standard deviation of angles over time as an observation, deg; none of fewer than two.
pub fn scatter_of(values: &[f64]) -> Option<Observation> {
    let sd = summarise(values).ok()?.sd;
    sd.is_finite().then(|| Observation {
        mean: sd,
        sd: None,
        n: 1,
        unit: "deg".into(),
    })
}

/// A mean over frames or repeats as an observation; none of nothing.
pub fn over_frames(values: &[f64], unit: &str) -> Option<Observation> {
    let SeriesSummary { mean, sd, n, .. } = summarise(values).ok()?;
    let sd = (n > 1).then_some(sd);
    Some(Observation {
        mean,
        sd,
        n,
        unit: unit.into(),
    })
}
