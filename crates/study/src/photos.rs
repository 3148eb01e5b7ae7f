//! Photos in the place of numbers, read by the ruler that reads the simulated frames.

use crate::file::{MeasuredCorrelation, MeasuredValue, PhotoOptions};
use crate::photo_values::{SPEED, Wanted, take_over};
use campaign::in_full;
use command_line::file_sha256;
use input::quantity::{Angle, Time};
use photo_profile::{
    DrumPixels, MAX_ANGLE_ERROR, Mask, Mode, PhotoPixels, PhotoReading, PictureFiles, PixelPoint,
    PixelRegion, Posture, Settings, measure_photo, one_of, read_frames, rectify, sideways,
    surface_shift,
};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use surface_profile::Definition;

/// The photos of one measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhotoSeries {
    /// The files, in the order in which they were read.
    pub files: Vec<PathBuf>,
    /// The picture that shows what is hidden in each of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// Angle of each frame that was read, deg.
    pub angles_deg: Vec<f64>,
    /// Its standard error from that one frame, deg.
    pub angle_se_deg: Vec<f64>,
    /// Frames that could not be read, and what this may change in each observable, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
    /// Values taken over from them.
    pub values: BTreeMap<String, MeasuredValue>,
    /// Further values in them, not taken over since the file does not name them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub further: BTreeMap<String, MeasuredValue>,
    /// How their means go together, estimated from the frames and shrunk towards 0 where they are few
    /// ([`surface_profile::shrunk_correlations`]); pairs that are not named are not correlated.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<MeasuredCorrelation>,
    /// Remarks for the reader.
    pub remarks: Vec<String>,
}

/// The quantities of one frame, and the standard error of its angle, rad.
pub(crate) struct FrameValues {
    /// Values by observable; not a number if the frame does not show it.
    pub(crate) values: Vec<(&'static str, f64)>,
    /// Standard error of the first, in its unit.
    pub(crate) error: f64,
}

/// What the photos of a measurement show.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown<'a> {
    /// Whether it is a heap, and no drum.
    pub(crate) heap: bool,
    /// Inner radius of the drum, m, if it is known.
    pub(crate) radius: Option<f64>,
    /// Observables that the scene gives.
    pub(crate) observables: &'a [&'a str],
}

/// A remark if files have the bytes of others: a copy of a photo is not another photo.
fn copies(files: &[PathBuf]) -> Option<String> {
    let mut seen: BTreeMap<String, &PathBuf> = BTreeMap::new();
    let mut copies = Vec::new();
    for file in files {
        // The reader reports a file that cannot be read.
        let Ok(hash) = file_sha256(file) else {
            continue;
        };
        match seen.get(&hash) {
            Some(other) => copies.push((file, *other)),
            None => {
                seen.insert(hash, file);
            }
        }
    }
    let (copy, other) = copies.first()?;
    Some(format!(
        "{} of {} photos are copies of others, as '{}' of '{}': they count as further ones; take them out",
        copies.len(),
        files.len(),
        copy.display(),
        other.display()
    ))
}

/// The photos that seem to lie on their side.
fn on_their_side(taken: Vec<(PathBuf, Posture)>) -> Vec<String> {
    let (files, postures): (Vec<PathBuf>, Vec<Posture>) = taken.into_iter().unzip();
    let found = sideways(&postures).into_iter();
    let words = found.map(|(k, why)| {
        format!(
            "photo '{}' may lie on its side: {why}; turn it upright, or take it out",
            files[k].display()
        )
    });
    words.collect()
}

/// Most photos that cannot be read are named; the others are counted.
const NAMED: usize = 5;
/// Likewise where they are the reason why a study is refused.
const NAMED_IN_REFUSAL: usize = 20;

/// Why photos that could be read give no value.
fn no_value(series: &PhotoSeries, shown: Shown<'_>) -> String {
    if series.remarks.is_empty() {
        let given = shown.observables.join(", ");
        format!("show an angle, which this scene does not give; it gives {given}")
    } else {
        format!("give no value: {}", series.remarks.join("; "))
    }
}

/// Remark on the pairs of pictures that do not show their speed beside those that do.
fn without_speed(lost: &[String], shown: usize) -> Option<String> {
    let first = lost.first()?;
    let (lost, all) = (lost.len(), lost.len() + shown);
    Some(format!(
        "{SPEED}: {lost} of {all} pairs of pictures do not show it: {first}"
    ))
}

/// Reads all photos of a measurement. Those that cannot be measured are left out, with what that may change in each observable, as
/// long as the mean of the angle bears it ([`photo_profile::SelectionBias`]); beyond, all are refused.
///
/// From two frames on, the standard deviation is that between the frames and n the effective number of independent ones
/// ([`surface_profile::summarise`]). One frame has no scatter: the standard deviation is then the standard error of its
/// reading with n = 1, which leaves out how the angle changes from frame to frame; the shapes of the surface have no such
/// error and are left out. If the time between frames is known, the angle shows its avalanches and how long it is
/// correlated with itself, and pictures that lie close enough the speed of the surface.
///
/// Files are found in `folder`.
pub(crate) fn read(
    folder: &Path,
    photos: &[PathBuf],
    options: &PhotoOptions,
    shown: Shown<'_>,
) -> Result<PhotoSeries, Vec<String>> {
    let photos: Vec<PathBuf> = photos.iter().map(|p| folder.join(p)).collect();
    let every = options.every.unwrap_or(NonZeroUsize::MIN);
    let mask_file = options.mask.as_ref().map(|mask| folder.join(mask));
    let found = PictureFiles::find(&photos, mask_file.as_deref());
    let mut found = found.map_err(|e| vec![in_full(&e)])?;
    let (files, in_file) = one_of(every, std::mem::take(&mut found.files));
    let mask = mask_file.as_deref().map(Mask::read).transpose();
    let mask =
        mask.map_err(|e| vec![format!("have a mask that cannot be read: {}", in_full(&e))])?;
    let reader = Reader::new(options, shown, mask.as_ref()).read_files(&files, in_file);
    if options.pair_interval.is_some() && !reader.found.pictures.is_multiple_of(2) {
        return Err(vec![format!(
            "are {} pictures, and photo.pair_interval says that they come in pairs: add or take out one, or leave it out",
            reader.found.pictures
        )]);
    }
    let Found {
        frames,
        unread,
        speeds,
        lost,
        postures,
        ..
    } = reader.found;
    if frames.iter().all(Option::is_none) {
        return Err(named(&unread, NAMED_IN_REFUSAL));
    }
    let angle = |f: &FrameValues| f.values.first().map_or(f64::NAN, |(_, v)| *v);
    let mut series = PhotoSeries {
        files,
        mask: mask_file,
        angles_deg: frames.iter().flatten().map(angle).collect(),
        angle_se_deg: frames.iter().flatten().map(|f| f.error).collect(),
        left_out: named(&unread, NAMED),
        values: BTreeMap::new(),
        further: BTreeMap::new(),
        correlations: Vec::new(),
        remarks: Vec::new(),
    };
    series.remarks.extend(found.remark());
    series.remarks.extend(copies(&series.files));
    series.remarks.extend(on_their_side(postures));
    series.remarks.extend(without_speed(&lost, speeds.len()));
    let interval = options.frame_interval.as_ref();
    let wanted = Wanted {
        observables: shown.observables,
        also: &options.also,
        leave_out: &options.leave_out,
        interval: interval.map(|interval| interval.si() * every.get() as f64),
    };
    if let Err(reason) = take_over(&frames, (&speeds, lost.len()), wanted, &mut series) {
        let mut reasons = named(&unread, NAMED_IN_REFUSAL);
        reasons.push(reason);
        return Err(reasons);
    }
    if !series.values.is_empty() {
        return Ok(series);
    }
    Err(vec![no_value(&series, shown)])
}

/// Pictures that could not be read, a sentence each for `most` of them.
fn named(unread: &[String], most: usize) -> Vec<String> {
    let mut named: Vec<String> = unread.iter().take(most).cloned().collect();
    if unread.len() > most {
        named.push(format!("and {} more photos", unread.len() - most));
    }
    named
}

/// Reads one picture behind the other.
struct Reader<'a> {
    /// How they are read.
    options: &'a PhotoOptions,
    /// The same for the ruler.
    settings: Settings,
    /// Radius of the drum over the time between the pictures of a pair, m/s; `None` if no speed is asked for or can be found.
    speed_scale: Option<f64>,
    /// What is hidden in each picture.
    mask: Option<&'a Mask>,
    /// What they gave.
    found: Found,
}

/// What pictures gave.
#[derive(Default)]
struct Found {
    /// Pictures so far.
    pictures: usize,
    /// The last picture that was measured, if the next one may show how far its surface went.
    before: Option<(PhotoPixels, PhotoReading)>,
    /// What was measured; `None` of a picture that could not be.
    frames: Vec<Option<FrameValues>>,
    /// Which pictures could not be measured, and why, a sentence each.
    unread: Vec<String>,
    /// The file of each that was, and how it was taken.
    postures: Vec<(PathBuf, Posture)>,
    /// Speeds of the surface, m/s.
    speeds: Vec<f64>,
    /// Why pairs give no speed.
    lost: Vec<String>,
}

impl<'a> Reader<'a> {
    /// A reader that has read nothing.
    fn new(options: &'a PhotoOptions, shown: Shown<'_>, mask: Option<&'a Mask>) -> Self {
        let asked = shown.observables.contains(&SPEED);
        let every = options.every.map_or(1, NonZeroUsize::get) as f64;
        let frames = options.frame_interval.map(|interval| interval.si() * every);
        let between = options.pair_interval.map(Time::si).or(frames);
        // A mark that shows no horizontal was refused before.
        let (camera_roll, camera_roll_error) = options.roll_rad().unwrap_or_default();
        let scale = between.and_then(|time| Some(shown.radius? / time));
        Self {
            options,
            mask,
            settings: Settings {
                region: options
                    .region
                    .map(|[left, top, width, height]| PixelRegion {
                        left,
                        top,
                        width,
                        height,
                    }),
                drum: options.drum.map(|[cx, cy, r]| DrumPixels { cx, cy, r }),
                camera_roll,
                camera_roll_error,
                definition: Definition::Line,
                mode: if shown.heap { Mode::Heap } else { Mode::Drum },
                foreground: options.foreground,
                max_angle_error: options.max_angle_error.map_or(MAX_ANGLE_ERROR, Angle::si),
                camera_elevation: options.elevation.map(Angle::si),
            },
            speed_scale: scale.filter(|_| asked && !shown.heap),
            found: Found::default(),
        }
    }

    /// Reads every n-th picture of each file, on all cores if no picture is compared with the one before it.
    fn read_files(mut self, files: &[PathBuf], every: usize) -> Self {
        if self.speed_scale.is_some() || self.options.pair_interval.is_some() {
            for file in files {
                self.read_file(file, every);
            }
            return self;
        }
        let read = |file: &PathBuf| {
            let mut own = Self {
                found: Found::default(),
                ..self
            };
            own.read_file(file, every);
            own.found
        };
        let each: Vec<Found> = files.par_iter().map(read).collect();
        for found in each {
            self.found.pictures += found.pictures;
            self.found.frames.extend(found.frames);
            self.found.unread.extend(found.unread);
            self.found.postures.extend(found.postures);
        }
        self
    }

    /// Reads every n-th picture of a file. A file that ends early, or cannot be read, counts as one picture that cannot be read.
    fn read_file(&mut self, file: &Path, every: usize) {
        let frames = match read_frames(file) {
            Ok(frames) => frames,
            Err(error) => {
                self.found.before = None;
                return self.end_picture(file, Err(refused(&error)));
            }
        };
        for frame in frames.step_by(every) {
            let before = self.found.before.take();
            let read = frame.map_err(|e| refused(&e)).and_then(|frame| {
                let size = [frame.width(), frame.height()];
                let pixels = match self.options.corners {
                    Some(corners) => {
                        let corners = corners.map(|[x, y]| PixelPoint { x, y });
                        let flat = rectify(&frame, corners).map_err(|e| refused(&e))?;
                        PhotoPixels::from_picture(&flat)
                    }
                    None => PhotoPixels::from_picture(&frame),
                };
                self.measure(file, size, before, pixels)
            });
            self.end_picture(file, read);
        }
    }

    /// Notes what a picture gave; the second of a pair gives a speed alone.
    fn end_picture(&mut self, file: &Path, read: Result<Option<FrameValues>, String>) {
        self.found.pictures += 1;
        let is_second =
            self.options.pair_interval.is_some() && self.found.pictures.is_multiple_of(2);
        match read {
            Ok(_) if is_second => {}
            Ok(values) => self.found.frames.push(values),
            Err(reason) => {
                self.found
                    .unread
                    .push(format!("photo '{}' {reason}", file.display()));
                if !is_second {
                    self.found.frames.push(None);
                }
            }
        }
    }

    /// Measures a picture of a size (px), or says why it cannot be measured; the second of a pair is only compared with the first.
    fn measure(
        &mut self,
        file: &Path,
        size: [u32; 2],
        before: Option<(PhotoPixels, PhotoReading)>,
        mut pixels: PhotoPixels,
    ) -> Result<Option<FrameValues>, String> {
        if let Some(mask) = self.mask {
            pixels = pixels.hiding(mask).map_err(|e| refused(&e))?;
        }
        self.add_speed(before, &pixels);
        if self.options.pair_interval.is_some() && !self.found.pictures.is_multiple_of(2) {
            return Ok(None);
        }
        let reading = measure_photo(&pixels, &self.settings).map_err(|e| refused(&e))?;
        let values = values_of(&reading)?;
        self.found
            .postures
            .push((file.to_owned(), Posture::new(size, &reading)));
        if self.speed_scale.is_some() {
            self.found.before = Some((pixels, reading));
        }
        Ok(Some(values))
    }

    /// Adds how fast the surface went from the picture before to this one.
    fn add_speed(&mut self, before: Option<(PhotoPixels, PhotoReading)>, pixels: &PhotoPixels) {
        let (Some((first, reading)), Some(scale)) = (before, self.speed_scale) else {
            return;
        };
        match surface_shift(&first, pixels, &reading) {
            Ok(found) => self.found.speeds.push(found.shift * scale),
            Err(reason) => self.found.lost.push(reason.to_string()),
        }
    }
}

/// Why a picture could not be read, as the rest of a sentence.
fn refused(error: &photo_profile::Error) -> String {
    format!("cannot be read: {}", in_full(error))
}

/// What one reading says, or why it says nothing. Toe and top of the bed are left out: angle, shape and fill level give them,
/// and a fit would count the same evidence twice.
fn values_of(reading: &PhotoReading) -> Result<FrameValues, String> {
    match reading {
        PhotoReading::Drum(bed) => Ok(FrameValues {
            values: vec![
                ("angle_deg", bed.angle.line.to_degrees()),
                ("curvature", bed.angle.curvature),
                ("s_shape", bed.angle.s_shape),
                (
                    "shape_4",
                    bed.angle.shape.map_or(f64::NAN, |shape| shape[2]),
                ),
                (
                    "shape_5",
                    bed.angle.shape.map_or(f64::NAN, |shape| shape[3]),
                ),
                ("fill_level", bed.fill_level.unwrap_or(f64::NAN)),
            ],
            error: bed.angle.standard_error.to_degrees(),
        }),
        PhotoReading::Heap(heap) => Ok(FrameValues {
            values: vec![("angle_of_repose_deg", heap.mean.to_degrees())],
            error: heap.standard_error.to_degrees(),
        }),
        PhotoReading::Refused(refused) => Err(format!(
            "shows no surface that can be measured: {}",
            refused.reason
        )),
    }
}
