//! Photos in the place of numbers, read by the ruler that reads the simulated frames.

use crate::file::{MeasuredCorrelation, MeasuredValue, PhotoOptions};
use crate::photo_values::take_over;
use campaign::in_full;
use photo_profile::{
    DrumPixels, Mode, PhotoPixels, PhotoReading, PixelPoint, Settings, Verdict, measure_photo,
    picture_files, read_frames, rectify,
};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use surface_profile::Definition;

/// The photos of one measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhotoSeries {
    /// The files, in the order in which they were read.
    pub files: Vec<PathBuf>,
    /// Angle of each frame, deg.
    pub angles_deg: Vec<f64>,
    /// Its standard error from that one frame, deg.
    pub angle_se_deg: Vec<f64>,
    /// What was taken over from them.
    pub values: BTreeMap<String, MeasuredValue>,
    /// How their means go together, estimated from the frames and shrunk towards 0 where they are few
    /// ([`surface_profile::shrunk_correlations`]); pairs that are not named are not correlated.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<MeasuredCorrelation>,
    /// What a reader should know.
    pub remarks: Vec<String>,
}

/// The quantities of one frame, and the standard error of its angle, rad.
pub(crate) struct FrameValues {
    /// Values by observable; not a number where the frame does not show it.
    pub(crate) values: Vec<(&'static str, f64)>,
    /// Standard error of the first, in its unit.
    pub(crate) error: f64,
}

/// Reads all photos of a measurement; every one that cannot be measured is told.
///
/// From two frames on, the standard deviation is that between the frames and n the effective number of independent ones
/// ([`surface_profile::summarise`]). One frame tells no scatter: the standard deviation is then the standard error of its
/// reading with n = 1, which leaves out how the angle changes from frame to frame; the shapes of the surface have no such
/// error and are left out. Where the time between frames is known, the angle tells its avalanches, or how long it is
/// correlated with itself.
pub(crate) fn read(
    photos: &[PathBuf],
    options: &PhotoOptions,
    heap: bool,
    observables: &[&str],
) -> Result<PhotoSeries, Vec<String>> {
    let files = picture_files(photos).map_err(|e| vec![in_full(&e)])?;
    let mut series = PhotoSeries {
        files,
        angles_deg: Vec::new(),
        angle_se_deg: Vec::new(),
        values: BTreeMap::new(),
        correlations: Vec::new(),
        remarks: Vec::new(),
    };
    let (mut wrong, mut frames) = (Vec::new(), Vec::new());
    for file in &series.files {
        match read_file(file, options, heap) {
            Ok(of_file) => frames.extend(of_file),
            Err(reason) => wrong.push(format!("photo '{}' {reason}", file.display())),
        }
    }
    if !wrong.is_empty() {
        return Err(wrong);
    }
    let angle = |f: &FrameValues| f.values.first().map_or(f64::NAN, |(_, v)| *v);
    series.angles_deg = frames.iter().map(angle).collect();
    series.angle_se_deg = frames.iter().map(|f| f.error).collect();
    take_over(&frames, observables, options.frame_interval_s, &mut series);
    if series.values.is_empty() {
        return Err(vec![format!(
            "show an angle, which this scene does not give; it gives {}",
            observables.join(", ")
        )]);
    }
    Ok(series)
}

/// The frames of one file, or why one of them cannot be measured.
fn read_file(file: &Path, options: &PhotoOptions, heap: bool) -> Result<Vec<FrameValues>, String> {
    let refused = |e: photo_profile::Error| format!("cannot be read: {}", in_full(&e));
    let settings = Settings {
        drum: options.drum.map(|[cx, cy, r]| DrumPixels { cx, cy, r }),
        camera_roll: options.roll_rad,
        definition: Definition::Line,
        mode: if heap { Mode::Heap } else { Mode::Drum },
        foreground: options.foreground,
    };
    let mut found = Vec::new();
    for frame in read_frames(file).map_err(refused)? {
        let reading = match options.corners {
            Some(corners) => {
                let corners = corners.map(|[x, y]| PixelPoint { x, y });
                let flat = rectify(&frame, corners).map_err(refused)?;
                measure_photo(&PhotoPixels::from_picture(&flat.into()), &settings)
            }
            None => measure_photo(&PhotoPixels::from_picture(&frame), &settings),
        };
        let reading = reading.map_err(refused)?;
        if let Verdict::Refused { reason } = &reading.verdict {
            return Err(format!(
                "shows no surface that can be measured: {reason}; take it out, or say how to read it with photo = \
                 {{ ... }}"
            ));
        }
        found.extend(values_of(&reading));
    }
    Ok(found)
}

/// What one reading says. Toe and top of the bed are left out: angle, shape and fill level give them, and a fit would count
/// the same evidence twice.
fn values_of(reading: &PhotoReading) -> Option<FrameValues> {
    if let Some(angle) = &reading.angle {
        return Some(FrameValues {
            values: vec![
                ("angle_deg", angle.line.to_degrees()),
                ("curvature", angle.curvature),
                ("s_shape", angle.s_shape),
                ("shape_4", angle.shape.map_or(f64::NAN, |shape| shape[2])),
                ("shape_5", angle.shape.map_or(f64::NAN, |shape| shape[3])),
                ("fill_level", reading.fill_level.unwrap_or(f64::NAN)),
            ],
            error: angle.standard_error.to_degrees(),
        });
    }
    let heap = reading.heap.as_ref()?;
    Some(FrameValues {
        values: vec![("angle_of_repose_deg", heap.mean.to_degrees())],
        error: heap.standard_error.to_degrees(),
    })
}
