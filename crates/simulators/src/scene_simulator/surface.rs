//! The surface of a bed as observables, from the readings of its frames.

use crate::scene_simulator::FrameDetails;
use campaign::run_store::Observation;
use input::quantity::significant;
use photo_profile::SelectionBias;
use scene::FrameReading;
use std::collections::BTreeMap;
use surface_profile::{
    Avalanches, CorrelationTime, SeriesSummary, avalanches, correlation_time, longest_unbroken,
    summarise,
};

/// Readings of the surface in the frames that could be measured, deg; curvature and other shapes of the same frames.
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
    /// Shape of degree 4 over the whole surface, drum radii.
    pub shape_4: Vec<f64>,
    /// Shape of degree 5, drum radii.
    pub shape_5: Vec<f64>,
    /// Share of the drum that the bed takes, 1.
    pub fill_level: Vec<f64>,
    /// Toe of the bed at the shell.
    pub toe: Vec<f64>,
    /// Its top.
    pub top: Vec<f64>,
    /// Speed of the surface by pairs of pictures, m/s; of the frames that show it.
    pub surface_speed: Vec<f64>,
    /// Correlation time of the angle by the picture, s; `None` if the frames do not show it.
    pub correlation_time: Option<CorrelationTime>,
    /// Avalanches of that angle, deg and s; `None` if a layer flows all the time, or the frames do not show it.
    pub avalanches: Option<Avalanches>,
}

impl SurfaceReadings {
    /// Takes the readings of all frames together; `interval` is the time between frames (s) where it is known and always the
    /// same.
    pub fn of(readings: &[FrameReading], interval: Option<f64>) -> Self {
        let angles = readings
            .iter()
            .map(|r| Some(r.photo.angle()?.line.to_degrees()));
        let series = longest_unbroken(&angles.collect::<Vec<_>>());
        let photos = || readings.iter().filter_map(|r| r.photo.angle());
        let (mut position, mut difference) = (Vec::new(), Vec::new());
        for reading in readings {
            let by_position = reading.position.map(|a| a.line.to_degrees());
            position.extend(by_position);
            let by_image = reading.photo.angle().map(|a| a.line.to_degrees());
            difference.extend(by_image.zip(by_position).map(|(i, p)| i - p));
        }
        let ends = || readings.iter().filter_map(|r| r.photo.bed()?.bed_ends());
        Self {
            toe: ends().map(|e| e.toe.to_degrees()).collect(),
            top: ends().map(|e| e.top.to_degrees()).collect(),
            image: photos().map(|a| a.line.to_degrees()).collect(),
            position,
            difference,
            curvature: photos().map(|a| a.curvature).collect(),
            s_shape: photos().map(|a| a.s_shape).collect(),
            shape_4: photos().filter_map(|a| Some(a.shape?[2])).collect(),
            shape_5: photos().filter_map(|a| Some(a.shape?[3])).collect(),
            fill_level: readings
                .iter()
                .filter_map(|r| r.photo.bed()?.fill_level)
                .collect(),
            surface_speed: readings
                .iter()
                .filter_map(|r| r.surface_speed.as_ref()?.as_ref().ok().copied())
                .collect(),
            correlation_time: interval.and_then(|interval| correlation_time(&series, interval)),
            avalanches: interval.and_then(|interval| avalanches(&series, interval)),
        }
    }

    /// Means over the frames, the scatter of the angle between them and its correlation time; what no frame shows is left out.
    pub fn observables(&self) -> BTreeMap<String, Observation> {
        let memory: Vec<f64> = self.correlation_time.iter().map(|c| c.time).collect();
        let (sizes, waits) = match &self.avalanches {
            Some(found) => (&found.sizes[..], &found.waiting_times[..]),
            None => (&[][..], &[][..]),
        };
        let means = [
            ("angle_deg", "deg", &self.image[..]),
            ("angle_by_position_deg", "deg", &self.position),
            ("image_minus_position_deg", "deg", &self.difference),
            ("curvature", "1", &self.curvature),
            ("s_shape", "1", &self.s_shape),
            ("shape_4", "1", &self.shape_4),
            ("shape_5", "1", &self.shape_5),
            ("fill_level", "1", &self.fill_level),
            ("toe_position_deg", "deg", &self.toe),
            ("top_position_deg", "deg", &self.top),
            ("surface_speed_m_s", "m/s", &self.surface_speed),
            ("angle_correlation_time_s", "s", &memory),
            ("avalanche_size_deg", "deg", sizes),
            ("avalanche_waiting_time_s", "s", waits),
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

/// What the frames of runs that show no surface may change in the mean of their angle, deg; `None` if all show one, or none does.
pub fn unread_frames<'a>(runs: impl IntoIterator<Item = &'a FrameDetails>) -> Option<String> {
    let (mut angles, mut refused) = (Vec::new(), 0);
    for frames in runs {
        angles.extend_from_slice(&frames.angles_deg);
        refused += frames.refused;
    }
    let bias = SelectionBias::new(&summarise(&angles).ok()?, refused)?;
    let beyond = if bias.is_borne() {
        ""
    } else {
        ", more than its standard error: photos with such a share would be refused"
    };
    let worst = if bias.most.is_finite() {
        format!(
            "if these were the steepest of all, or the flattest, angle_deg of all would lie {} deg higher or lower{beyond}",
            significant(bias.most, 2)
        )
    } else {
        "too many to say what angle_deg of all would be; photos with such a share would be refused"
            .to_owned()
    };
    Some(format!(
        "{} of {} frames show no measurable surface; {worst}",
        bias.left_out, bias.of
    ))
}

#[cfg(test)]
mod tests {
    use super::unread_frames;
    use crate::scene_simulator::FrameDetails;

    /// Angles that alternate by 1 deg about 30 in so many frames.
    fn angles(n: usize) -> Vec<f64> {
        (0..n).map(|k| 29.0 + 2.0 * (k % 2) as f64).collect()
    }

    /// Two runs with 18 frames that were read and two that were not. A tenth lost moves the mean by at most 0.231 standard deviations
    /// of the others; that of the angles is 1.02 deg.
    #[test]
    fn frames_without_a_surface_are_told_with_their_bias() {
        let run = |refused: usize| FrameDetails {
            times_s: Vec::new(),
            angles_deg: angles(9),
            angles_by_position_deg: Vec::new(),
            filling_angles_deg: Vec::new(),
            refused,
            no_surface_speed: None,
            standard_error_deg: None,
            effective_number: None,
        };
        assert_eq!(unread_frames([&run(0), &run(0)]), None);
        let told = unread_frames([&run(2), &run(0)]).unwrap();
        assert!(
            told.contains("2 of 20 frames") && told.contains("0.24 deg"),
            "{told}"
        );
        assert!(!told.contains("refused"), "{told}");
        let told = unread_frames([&run(9), &run(9)]).unwrap();
        assert!(told.contains("too many"), "{told}");
    }
}
