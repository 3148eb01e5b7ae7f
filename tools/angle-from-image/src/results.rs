//! What the command says: JSON and text.

use crate::advice::advice;
use crate::interface::{Heights, heights};
use crate::summary::Summary;
use command_line::Header;
use photo_profile::{
    DrumPixels, DrumReading, HeapReading, LEAST_PLACES, PhotoReading, Refusal, Settings,
};
use serde::Serialize;
use std::path::Path;
use surface_profile::{Definition, HighSide};

/// Standard errors in half of the 95 % interval.
const HALF_INTERVAL: f64 = 1.96;

/// The JSON of one picture.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct ImageResult {
    /// The file as given.
    pub(crate) file: String,
    /// Number of the frame in an animated file, from 0; none for a still picture.
    pub(crate) frame: Option<usize>,
    /// Time of the picture by its place in the order of all, from 0, s; none without `--fps`.
    pub(crate) time_s: Option<f64>,
    /// SHA-256 of the file; none if it could not be read.
    pub(crate) sha256: Option<String>,
    /// Pixels of the picture along x and y; straightened where corners are given.
    pub(crate) picture_size_px: [u32; 2],
    /// `ok`, `refused`, or `error` for a file that could not be read.
    pub(crate) verdict: &'static str,
    /// Why it was refused or not read.
    pub(crate) reason: Option<String>,
    /// How to continue with a refused picture.
    pub(crate) advice: Option<String>,
    /// The flag to continue with, where one is known.
    pub(crate) advice_flag: Option<String>,
    /// Whether the surface was stated by the caller; left out where it was found in the picture.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) surface_given: bool,
    /// Degrees of freedom of the scatter behind `angle_se_deg` if the surface was stated: the number of its places less four.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) degrees_of_freedom: Option<usize>,
    /// What supports a picture that lies on its side; left out if nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) warning: Option<String>,
    /// Which slope `angle_deg` is.
    pub(crate) definition: Definition,
    /// The angle by the chosen definition, degrees.
    pub(crate) angle_deg: Option<f64>,
    /// Standard error of `angle_deg` from this picture, degrees; 1.96 of it are half of the 95 %
    /// interval.
    pub(crate) angle_se_deg: Option<f64>,
    /// The 95 % interval of `angle_deg`, degrees.
    pub(crate) angle_interval_deg: Option<[f64; 2]>,
    /// Least-squares line of a surface that was refused as too rough, or mean of the flanks of a heap refused as too uncertain,
    /// degrees: what leaving it out does to a mean is in the summary.
    pub(crate) rough_line_deg: Option<f64>,
    /// Least-squares line, degrees.
    pub(crate) line_deg: Option<f64>,
    /// Standard error of `line_deg`, degrees.
    pub(crate) line_se_deg: Option<f64>,
    /// Rim to rim, degrees.
    pub(crate) chord_deg: Option<f64>,
    /// Standard error of `chord_deg`, degrees.
    pub(crate) chord_se_deg: Option<f64>,
    /// Central fifth of the diameter, degrees.
    pub(crate) mid_deg: Option<f64>,
    /// Standard error of `mid_deg`, degrees.
    pub(crate) mid_se_deg: Option<f64>,
    /// Quadratic coefficient in half-chords, positive when the ends stand up, 1.
    pub(crate) curvature: Option<f64>,
    /// Cubic coefficient in half-chords, positive when the middle is steeper, 1.
    pub(crate) s_shape: Option<f64>,
    /// Legendre coefficient of degree 4 over the whole surface, positive when ends and middle stand up, drum radii.
    pub(crate) shape_4: Option<f64>,
    /// Legendre coefficient of degree 5, drum radii.
    pub(crate) shape_5: Option<f64>,
    /// Share of the drum that the bed takes, 0 to 1, within 0.96 of its radius.
    pub(crate) fill_level: Option<f64>,
    /// Inclination of the line through all points, those set aside too, degrees.
    pub(crate) line_through_all_deg: Option<f64>,
    /// Slope of the lowest fifth of the surface, degrees; flatter than the line where the toe turns up.
    pub(crate) toe_slope_deg: Option<f64>,
    /// Where the bed ends at the shell on the lower side, from straight down, positive towards the higher side, degrees.
    pub(crate) toe_position_deg: Option<f64>,
    /// The same on the higher side, degrees.
    pub(crate) top_position_deg: Option<f64>,
    /// Which side stands higher.
    pub(crate) high_side: Option<HighSide>,
    /// The channel in which bed and air were parted: `luma`, `red`, `green`, `blue`, `saturation`, or a sum of channels in
    /// words; none if the picture was not read.
    pub(crate) channel: Option<String>,
    /// The drum circle, px, y down.
    pub(crate) drum: Option<DrumPixels>,
    /// The best circle of a search that found no drum, px, y down.
    pub(crate) drum_candidate: Option<DrumPixels>,
    /// Flanks and apex of a heap; none for a drum.
    pub(crate) heap: Option<HeapResult>,
    /// Points of the surface, with `--points`.
    #[serde(flatten)]
    pub(crate) points: Option<Points>,
    /// Whether the points lie in the picture straightened by the corners.
    pub(crate) rectified: bool,
    /// Where the surface of a measured drum lies along it.
    #[serde(skip)]
    pub(crate) heights: Option<Heights>,
    /// Trust in the reading, 0 to 1.
    pub(crate) quality: f64,
}

/// Points of the surface, px, y down.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Points {
    /// Points that count.
    pub(crate) surface: Vec<[f64; 2]>,
    /// Points set aside.
    pub(crate) surface_rejected: Vec<[f64; 2]>,
    /// Points of the boundary in a refused picture.
    pub(crate) surface_refused: Vec<[f64; 2]>,
}

impl Points {
    /// The points of a reading.
    pub(crate) fn new(reading: &PhotoReading) -> Self {
        let pairs = |points: &[photo_profile::PixelPoint]| -> Vec<[f64; 2]> {
            points.iter().map(|p| [p.x, p.y]).collect()
        };
        let (used, rejected, refused) = match reading {
            PhotoReading::Drum(bed) => (&bed.used[..], &bed.rejected[..], &[][..]),
            PhotoReading::Heap(heap) => (&heap.used[..], &heap.rejected[..], &[][..]),
            PhotoReading::Refused(refused) => (&[][..], &[][..], &refused.boundary[..]),
        };
        Self {
            surface: pairs(used),
            surface_rejected: pairs(rejected),
            surface_refused: pairs(refused),
        }
    }
}

/// Flanks and apex of a heap.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct HeapResult {
    /// Inclination of the left flank, degrees.
    pub(crate) left_deg: f64,
    /// Its standard error, degrees.
    pub(crate) left_se_deg: f64,
    /// Inclination of the right flank, degrees.
    pub(crate) right_deg: f64,
    /// Its standard error, degrees.
    pub(crate) right_se_deg: f64,
    /// Where the lines of the flanks meet, px, y down.
    pub(crate) apex: [f64; 2],
    /// By how much the top of the heap stays below that point, px.
    pub(crate) rounding_px: f64,
    /// Inclination of the upper half of the left flank, degrees.
    pub(crate) left_top_deg: f64,
    /// Of its lower half, degrees.
    pub(crate) left_toe_deg: f64,
    /// Inclination of the upper half of the right flank, degrees.
    pub(crate) right_top_deg: f64,
    /// Of its lower half, degrees.
    pub(crate) right_toe_deg: f64,
    /// Inclination of the base, positive when it rises to the right, degrees; none if it does not show.
    pub(crate) base_deg: Option<f64>,
    /// How far above the foot the camera stands, as stated, or as the lower edge shows it, degrees: taken off from all inclinations.
    pub(crate) camera_elevation_deg: f64,
    /// Mean of both flanks as the picture shows them, before the elevation is taken off, degrees.
    pub(crate) seen_deg: f64,
    /// How far above the foot the camera stands by the lower edge of the heap, or by its feet if that does not show, degrees;
    /// none if these do not show either.
    pub(crate) elevation_seen_deg: Option<f64>,
}

/// How much flatter than the line the toe of a bed is reported in words, degrees: grains of a tenth of the radius make less.
const FLAT_TOE_DEG: f64 = 15.0;

/// Two elevations that differ by no more than rounding are the same, degrees.
const SAME_DEG: f64 = 1e-9;

/// Difference of the halves of a flank that is reported in words, degrees; a fifth of it for the base.
const WORTH_TELLING_DEG: f64 = 5.0;

impl HeapResult {
    /// The result of a reading.
    fn new(heap: &HeapReading) -> Self {
        Self {
            left_deg: heap.left.to_degrees(),
            left_se_deg: heap.left_standard_error.to_degrees(),
            right_deg: heap.right.to_degrees(),
            right_se_deg: heap.right_standard_error.to_degrees(),
            apex: [heap.apex.x, heap.apex.y],
            rounding_px: heap.rounding,
            left_top_deg: heap.tops[0].to_degrees(),
            left_toe_deg: heap.toes[0].to_degrees(),
            right_top_deg: heap.tops[1].to_degrees(),
            right_toe_deg: heap.toes[1].to_degrees(),
            base_deg: heap.base.map(f64::to_degrees),
            camera_elevation_deg: heap.elevation.to_degrees(),
            seen_deg: heap.mean_seen.to_degrees(),
            elevation_seen_deg: heap.elevation_seen.map(f64::to_degrees),
        }
    }
}

impl HeapResult {
    /// Both flanks, and what of bent flanks, base and camera is large enough to ask about.
    fn text(&self) -> String {
        let mut told = vec![format!(
            "left {:.2}, right {:.2}",
            self.left_deg, self.right_deg
        )];
        let bends = [
            ("left", self.left_toe_deg, self.left_top_deg),
            ("right", self.right_toe_deg, self.right_top_deg),
        ];
        for (side, toe, top) in bends {
            if (toe - top).abs() > WORTH_TELLING_DEG {
                let bend =
                    format!("{side} flank bent from {top:.1} at the top to {toe:.1} at the toe");
                told.push(bend);
            }
        }
        let leans = |base: &f64| base.abs() > 0.2 * WORTH_TELLING_DEG;
        if let Some(base) = self.base_deg.filter(leans) {
            told.push(format!(
                "base leaning by {base:.1} (where it is the camera, --camera-roll-deg)"
            ));
        }
        if let Some(seen) = self.elevation_seen_deg {
            let stated = self.camera_elevation_deg;
            if (seen - stated).abs() > WORTH_TELLING_DEG {
                told.push(format!(
                    "looks as from {seen:.0} above, not {stated:.0} (--camera-elevation-deg)"
                ));
            } else if (seen - stated).abs() < SAME_DEG && seen > WORTH_TELLING_DEG {
                told.push(format!(
                    "lower edge as from {seen:.0} above, taken off from {:.2} (or state --camera-elevation-deg)",
                    self.seen_deg
                ));
            }
        }
        told.join(", ")
    }
}

/// Where a picture came from.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    /// The file as given.
    pub(crate) file: String,
    /// Number of the frame in an animated file.
    pub(crate) frame: Option<usize>,
    /// SHA-256 of the file.
    pub(crate) sha256: String,
}

impl ImageResult {
    /// The result of one reading.
    // Long because each key of the output has its line here.
    pub(crate) fn new(
        origin: Origin,
        picture_size_px: [u32; 2],
        reading: &PhotoReading,
        settings: &Settings,
        rectified: bool,
    ) -> Self {
        let (bed, heap, refused) = (reading.bed(), reading.heap(), reading.refused());
        let angle = bed.map(|bed| &bed.angle);
        let ends = bed.and_then(DrumReading::bed_ends);
        let chosen = angle
            .map(|a| a.by(settings.definition))
            .or(heap.map(|h| h.mean));
        let error = angle
            .map(|a| a.error_by(settings.definition))
            .or(heap.map(|h| h.standard_error));
        let degrees = |value: Option<f64>| value.map(f64::to_degrees);
        let advice = advice(reading);
        Self {
            file: origin.file,
            frame: origin.frame,
            time_s: None,
            picture_size_px,
            sha256: Some(origin.sha256),
            verdict: if refused.is_some() { "refused" } else { "ok" },
            reason: refused.map(|refused| refused.reason.to_string()),
            surface_given: false,
            degrees_of_freedom: None,
            warning: None,
            advice_flag: advice.as_ref().and_then(|a| a.flag.clone()),
            advice: advice.map(|a| a.words),
            definition: settings.definition,
            angle_deg: degrees(chosen),
            angle_se_deg: degrees(error),
            angle_interval_deg: chosen
                .zip(error)
                .map(|(a, e)| [a - HALF_INTERVAL * e, a + HALF_INTERVAL * e].map(f64::to_degrees)),
            rough_line_deg: match refused.map(|refused| &refused.reason) {
                Some(Refusal::TooRough { line, .. }) => Some(*line),
                Some(Refusal::HeapUncertain { mean, .. }) => Some(*mean),
                _ => None,
            },
            line_deg: degrees(angle.map(|a| a.line)),
            line_se_deg: degrees(angle.map(|a| a.standard_error)),
            chord_deg: degrees(angle.map(|a| a.chord)),
            chord_se_deg: degrees(angle.map(|a| a.chord_standard_error)),
            mid_deg: degrees(angle.map(|a| a.mid)),
            mid_se_deg: degrees(angle.map(|a| a.mid_standard_error)),
            curvature: angle.map(|a| a.curvature),
            s_shape: angle.map(|a| a.s_shape),
            shape_4: angle.and_then(|a| a.shape).map(|shape| shape[2]),
            shape_5: angle.and_then(|a| a.shape).map(|shape| shape[3]),
            fill_level: bed.and_then(|bed| bed.fill_level),
            toe_slope_deg: degrees(bed.and_then(DrumReading::toe_slope)),
            line_through_all_deg: degrees(bed.and_then(DrumReading::line_through_all)),
            toe_position_deg: degrees(ends.map(|e| e.toe)),
            top_position_deg: degrees(ends.map(|e| e.top)),
            high_side: angle.map(|a| a.high_side),
            channel: Some(reading.channel().to_string()),
            drum: reading.drum(),
            drum_candidate: refused.and_then(|refused| refused.candidate),
            heap: heap.map(HeapResult::new),
            points: None,
            heights: bed.map(|bed| heights(bed, settings.camera_roll)),
            rectified,
            quality: reading.quality(),
        }
    }

    /// Says that the surface was stated by so many places.
    pub(crate) fn state_given_surface(&mut self, places: usize) {
        self.surface_given = true;
        if self.angle_deg.is_some() {
            self.degrees_of_freedom = Some(places + 1 - LEAST_PLACES);
        } else if self.rough_line_deg.is_some() {
            self.advice_flag = None;
            self.advice = Some(format!(
                "point at more places than {places}, between the ones given, or allow for the error with --max-error-deg"
            ));
        }
    }

    /// The result of a file that could not be read.
    pub(crate) fn unread(file: &Path, reason: String, settings: &Settings) -> Self {
        Self {
            file: file.display().to_string(),
            verdict: "error",
            reason: Some(reason),
            definition: settings.definition,
            ..Self::default()
        }
    }

    /// The file, with the frame of an animation.
    pub(crate) fn name(&self) -> String {
        match self.frame {
            Some(frame) => format!("{} frame {frame}", self.file),
            None => self.file.clone(),
        }
    }

    /// The interval of a surface that was stated, for people: a standard error alone says little with few degrees of freedom.
    fn few_places(&self) -> String {
        let stated = self.degrees_of_freedom.zip(self.angle_interval_deg);
        stated.map_or(String::new(), |(freedom, [low, high])| {
            let degrees = if freedom == 1 { "degree" } else { "degrees" };
            format!("; 95 % interval {low:.2} to {high:.2} with {freedom} {degrees} of freedom")
        })
    }

    /// The line for people.
    pub(crate) fn text(&self) -> String {
        let name = self.name();
        let by = self.channel.as_deref().filter(|channel| *channel != "luma");
        let by = by.map_or(String::new(), |channel| format!(", bed given by {channel}"));
        match (self.angle_deg, self.angle_se_deg, self.high_side) {
            (Some(angle), Some(error), Some(side)) => {
                let flat = |toe: &f64| self.line_deg.is_some_and(|l| l - toe > FLAT_TOE_DEG);
                let toe = self
                    .toe_slope_deg
                    .filter(flat)
                    .map_or(String::new(), |toe| {
                        let all = self.line_through_all_deg.unwrap_or(angle);
                        format!(
                            ", toe turned up to {toe:.0} deg (line through all points: {all:.2})"
                        )
                    });
                let side = match side {
                    HighSide::Left => "left",
                    HighSide::Right => "right",
                };
                format!(
                    "{name}: {angle:.2} deg (se {error:.2}{}), high on the {side}{toe}{by}, quality {:.2}",
                    self.few_places(),
                    self.quality
                )
            }
            (Some(angle), Some(error), None) => {
                let flanks = self
                    .heap
                    .as_ref()
                    .map_or(String::new(), |h| format!(", {}", h.text()));
                format!(
                    "{name}: {angle:.2} deg (se {error:.2}){flanks}{by}, quality {:.2}",
                    self.quality
                )
            }
            _ => {
                let advice = self.advice.iter().map(|words| format!("; {words}"));
                format!(
                    "{name}: {}: {}{}",
                    self.verdict,
                    self.reason.as_deref().unwrap_or("no reason"),
                    advice.collect::<String>()
                )
            }
        }
    }
}

/// The whole JSON: the keys of the one picture at the top when there is one, and always `images`.
#[derive(Debug, Serialize)]
pub(crate) struct Output {
    /// Version, seed and inputs.
    #[serde(flatten)]
    pub(crate) header: Header,
    /// Angle of the true horizontal in the pictures, counter-clockwise positive, as stated or by a mark, degrees.
    pub(crate) camera_roll_deg: f64,
    /// The picture, when there is one only.
    #[serde(flatten)]
    pub(crate) single: Option<ImageResult>,
    /// All pictures.
    pub(crate) images: Vec<ImageResult>,
    /// Files that were left out: overlays and the mask, and in folders hidden files and those without the ending of a picture.
    pub(crate) skipped: Vec<String>,
    /// The same for people, with the reasons.
    #[serde(skip)]
    pub(crate) left_out: Option<String>,
    /// All pictures together.
    pub(crate) summary: Summary,
}
