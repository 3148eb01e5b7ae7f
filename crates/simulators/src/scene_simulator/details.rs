//! What a record of a run keeps beside its observables.

use crate::scene_simulator::{BodyDetails, Effort, Error};
use campaign::run_store::Record;
use image::RgbImage;
use image::codecs::png::PngEncoder;
use scene::{
    Curve, Doubt, Ending, FrameReading, PhaseTimes, RunResult, Scene, error_of_mean, frame_picture,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use surface_profile::summarise;

/// Details of a run besides the observables and the regime. A record of another version may have more of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunDetails {
    /// Whether the start-up was found to be over, or the seeds came to rest; `None` if the apparatus has no such
    /// state (a bench test).
    pub steady: Option<bool>,
    /// Why the bed is not steady; `None` if it is.
    #[serde(default)]
    pub doubt: Option<Doubt>,
    /// Time of rotation before the steady state, s; none without a series.
    pub start_up_s: Option<f64>,
    /// Time of one swing of the bed, s; none without a series.
    #[serde(default)]
    pub swing_s: Option<f64>,
    /// Form of the motion of the bed (sliding, surging, slumping, rolling, cascading, cataracting, centrifuging); none
    /// if nothing turns.
    pub motion: Option<String>,
    /// R w^2 / g with the radius R and the angular speed w of the drum and gravity g; `None` if nothing turns.
    pub froude_number: Option<f64>,
    /// Why no frame of a drum shows a surface, so that there is no angle; `None` if one does, and elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_surface: Option<String>,
    /// Remarks about the files that a program left; empty if none was read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// Readings of the single frames.
    pub frames: FrameDetails,
    /// The bed over time.
    pub series: SeriesDetails,
    /// The curve of an apparatus that gives one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveDetails>,
    /// Steps and times.
    pub timing: TimingDetails,
    /// The last frame, as PNG in base 64; none of a bench test, which has no bed.
    pub last_frame_png_base64: Option<String>,
    /// The seeds in the last frame; `None` if there is no frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_bodies: Option<BodyDetails>,
}

/// Readings of the single frames; the lists of angles leave out frames that could not be measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameDetails {
    /// Times of all frames, s.
    pub times_s: Vec<f64>,
    /// Angles of the surface by the picture, deg.
    pub angles_deg: Vec<f64>,
    /// Angles of the surface by the positions of the spheres, deg.
    pub angles_by_position_deg: Vec<f64>,
    /// Filling angles of the metering device, deg; empty elsewhere.
    pub filling_angles_deg: Vec<f64>,
    /// Number of frames in which the surface could not be measured.
    pub refused: usize,
    /// Why no frame gives a speed of the surface, as its first frame says it; `None` if one does, or no pairs of pictures
    /// are taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_surface_speed: Option<String>,
    /// Standard error of the mean angle by the picture over the time of this run, deg; `None` if it cannot be estimated.
    #[serde(default)]
    pub standard_error_deg: Option<f64>,
    /// Number of independent frames that the measured ones are worth; `None` if it cannot be estimated.
    pub effective_number: Option<f64>,
}

/// The bed over time; all lists have the same length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesDetails {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Direction of the centre of mass, deg.
    pub centre_of_mass_deg: Vec<f64>,
}

/// A curve of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveDetails {
    /// Name.
    pub name: String,
    /// Columns of the same length by name, with the unit at its end.
    pub columns: BTreeMap<String, Vec<f64>>,
}

impl CurveDetails {
    fn of(curve: &Curve) -> Self {
        let names = std::iter::once(&curve.kind.along).chain(curve.kind.values);
        let column = |place: usize| curve.rows.iter().map(|row| row[place]).collect();
        Self {
            name: curve.kind.name.into(),
            columns: (0..)
                .zip(names)
                .map(|(k, n)| ((*n).into(), column(k)))
                .collect(),
        }
    }
}

/// Cost of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimingDetails {
    /// Time step while the drive ran, s.
    pub time_step_s: f64,
    /// Time step while the seeds settled, s.
    pub settling_time_step_s: f64,
    /// Number of steps.
    pub steps: u64,
    /// Number of bodies.
    pub bodies: usize,
    /// Number of spheres, hidden ones included.
    pub spheres: usize,
    /// Threads that the steps were spread over.
    pub threads: usize,
    /// Time by the clock, s; without the filling of the meshes where that is stated.
    pub wall_s: f64,
    /// Time that the processors worked, s; `None` if it was not measured.
    pub cpu_s: Option<f64>,
    /// Time of filling the meshes, s; `None` if it was not measured.
    pub filling_s: Option<f64>,
    /// Time of a step, us; `None` if the run was continued, since its times are those of the last part alone, and where
    /// attempts broke off, whose time counts.
    pub us_per_step: Option<f64>,
    /// Spheres times steps over the time; likewise.
    pub sphere_steps_per_s: Option<f64>,
    /// Where that time went, by the clock; of the last attempt, and none if another program ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<PhaseTimes>,
    /// Whether the run went on from a state that an earlier process had left.
    pub continued: bool,
    /// Whether the seeds had moved before, and the time is that of the pictures alone.
    pub only_seen: bool,
    /// Why earlier attempts with longer time steps broke off, each with half the step of the one before; `None` if the first
    /// came to its end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub retried: Vec<String>,
}

impl RunDetails {
    /// Reads the details of a record.
    ///
    /// # Errors
    ///
    /// [`Error::Details`] when the record is not that of a run of a scene.
    pub fn of(record: &Record) -> Result<Self, Error> {
        Self::deserialize(record.details()).map_err(|source| Error::Details {
            key: record.key().to_owned(),
            source,
        })
    }

    /// The details of a run; angles of the surface by picture and by position, deg.
    pub(crate) fn new(
        scene: &Scene,
        result: &RunResult,
        effort: Effort,
        (image, position): (&[f64], &[f64]),
    ) -> Self {
        let filling = result.filling_angles.iter().map(|a| a.to_degrees());
        let turned = match result.ending {
            Ending::Turned(state) => Some(state),
            _ => None,
        };
        let start_up = result.series.get(result.ending.cut());
        let interval = result.series.first().map_or(0.0, |point| point.time_s);
        let swing = turned.map(|state| state.swing as f64 * interval);
        let times: Vec<f64> = result.frames.iter().map(|f| f.time).collect();
        let error = swing.and_then(|swing| error_over_swings(&times, &result.readings, swing));
        let froude = scene.apparatus.froude_number(scene.model.gravity_m_s2);
        Self {
            steady: result.ending.is_steady(),
            doubt: result.ending.doubt(),
            swing_s: swing,
            start_up_s: start_up.map(|p| p.time_s),
            no_surface: no_surface(&result.readings),
            remarks: Vec::new(),
            motion: result
                .motion
                .and_then(crate::scene_simulator::outcome::word),
            froude_number: finite(froude).filter(|_| froude > 0.0),
            frames: FrameDetails {
                times_s: times,
                angles_deg: image.to_vec(),
                angles_by_position_deg: position.to_vec(),
                filling_angles_deg: filling.collect(),
                refused: result
                    .readings
                    .iter()
                    .filter(|r| r.photo.bed().is_none())
                    .count(),
                no_surface_speed: no_surface_speed(&result.readings),
                standard_error_deg: error,
                effective_number: error.and_then(|error| effective_number(image, error)),
            },
            series: SeriesDetails {
                time_s: result.series.iter().map(|p| p.time_s).collect(),
                centre_of_mass_deg: result.series.iter().map(|p| p.centre_of_mass_deg).collect(),
            },
            curve: result.curve.as_ref().map(CurveDetails::of),
            timing: TimingDetails::new(result, effort),
            last_frame_png_base64: picture(scene, result),
            last_bodies: result
                .frames
                .last()
                .map(|frame| BodyDetails::of(frame, &result.bodies)),
        }
    }
}

impl TimingDetails {
    /// Cost of a run.
    fn new(result: &RunResult, effort: Effort) -> Self {
        let Effort { wall_s, .. } = effort;
        let steps = result.n_steps as f64;
        let whole = !effort.continued && result.broken_off.is_empty();
        let rate = |value: f64| whole.then_some(value);
        Self {
            time_step_s: result.time_step,
            settling_time_step_s: result.settling_time_step,
            steps: result.n_steps,
            bodies: result.n_bodies,
            spheres: result.n_spheres,
            threads: result.n_threads,
            wall_s,
            cpu_s: effort.cpu_s,
            filling_s: effort.filling_s,
            us_per_step: rate(wall_s * 1e6 / steps.max(1.0)),
            sphere_steps_per_s: rate(result.n_spheres as f64 * steps / wall_s.max(1e-9)),
            phases: Some(PhaseTimes {
                building_s: result.phases.building_s + effort.filling_s.unwrap_or(0.0),
                ..result.phases
            }),
            continued: effort.continued,
            only_seen: effort.only_seen,
            retried: result.broken_off.clone(),
        }
    }
}

/// Standard error of the mean of the angles read in frames at these times (s), by whole swings of the bed (s) from the last
/// frame back, deg; `None` if the frames span less than two swings, or none in a swing could be measured.
pub fn error_over_swings(times: &[f64], readings: &[FrameReading], swing: f64) -> Option<f64> {
    let (first, last) = (*times.first()?, *times.last()?);
    let interval = (last - first) / (times.len() - 1).max(1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small ratio"
    )]
    let before_last = |time: f64| ((last - time + 0.5 * interval) / swing) as usize;
    let mut swings: Vec<Vec<f64>> = vec![Vec::new(); before_last(first - 0.5 * interval)];
    for (time, reading) in times.iter().zip(readings) {
        if let (Some(angle), Some(values)) =
            (reading.photo.angle(), swings.get_mut(before_last(*time)))
        {
            values.push(angle.line.to_degrees());
        }
    }
    if swings.iter().any(Vec::is_empty) {
        return None;
    }
    let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let means: Vec<f64> = swings.iter().map(mean).collect();
    error_of_mean(&means, 1)
}

/// Why no frame shows a surface, with the reason of the first; `None` if one does, or no frame is read.
pub fn no_surface(readings: &[FrameReading]) -> Option<String> {
    let first = readings.first()?;
    if readings
        .iter()
        .any(|reading| reading.photo.angle().is_some())
    {
        return None;
    }
    let first = first.photo.refused();
    let first = first.map(|refused| format!("; the first says: {}", refused.reason));
    Some(format!(
        "none of the {} frames shows a measurable surface{}",
        readings.len(),
        first.unwrap_or_default()
    ))
}

/// Why a run has no angle, as its record says; `None` if it has one, or was never to have one.
pub fn no_surface_of(record: &Record) -> Option<String> {
    let reason = record.details().get("no_surface")?.as_str()?;
    Some(reason.to_owned())
}

/// Why no frame gives a speed of the surface; `None` if one does, or none is asked for.
fn no_surface_speed(readings: &[FrameReading]) -> Option<String> {
    let mut told = readings.iter().filter_map(|r| r.surface_speed.as_ref());
    let first = told.next()?.as_ref().err()?;
    told.all(Result::is_err).then(|| first.to_string())
}

/// Number of independent values that would fix a mean as well as its error says, 1 to all.
pub fn effective_number(values: &[f64], error: f64) -> Option<f64> {
    let sd = summarise(values).ok()?.sd;
    finite((sd / error).powi(2)).map(|n| n.clamp(1.0, values.len() as f64))
}

/// A number if there is one.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The last frame as PNG in base 64; none of a bench test, and none if it cannot be drawn: no run is lost for its picture.
fn picture(scene: &Scene, result: &RunResult) -> Option<String> {
    let frame = result.frames.last()?;
    let drawn = frame_picture(scene, &result.bodies, frame).ok()??;
    Some(png_in_base64(&drawn))
}

/// A picture as PNG in base 64, the form in which a record keeps it.
///
/// # Panics
///
/// Never: memory takes every picture that was drawn.
pub fn png_in_base64(picture: &RgbImage) -> String {
    use base64::Engine as _;
    let mut bytes = Vec::new();
    picture
        .write_with_encoder(PngEncoder::new(&mut bytes))
        .expect("memory takes every picture that was drawn");
    base64::engine::general_purpose::STANDARD.encode(bytes)
}
