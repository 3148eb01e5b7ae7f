//! What the command says: JSON and text.

use command_line::Header;
use photo_profile::{DrumPixels, PhotoReading, Settings, Verdict};
use serde::Serialize;
use surface_profile::{Definition, HighSide, SeriesSummary};

/// The JSON of one picture.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ImageResult {
    /// The file as given.
    pub(crate) file: String,
    /// Number of the frame in an animated file, from 0; none for a still picture.
    pub(crate) frame: Option<usize>,
    /// SHA-256 of the file.
    pub(crate) sha256: String,
    /// `ok` or `refused`.
    pub(crate) verdict: &'static str,
    /// Why it was refused.
    pub(crate) reason: Option<String>,
    /// Which slope `angle_deg` is.
    pub(crate) definition: Definition,
    /// The angle by the chosen definition, degrees.
    pub(crate) angle_deg: Option<f64>,
    /// Standard error of the least-squares line from this picture, degrees.
    pub(crate) angle_se_deg: Option<f64>,
    /// Least-squares line, degrees.
    pub(crate) line_deg: Option<f64>,
    /// Rim to rim, degrees.
    pub(crate) chord_deg: Option<f64>,
    /// Central fifth of the diameter, degrees.
    pub(crate) mid_deg: Option<f64>,
    /// Quadratic coefficient in half-chords, positive when the ends stand up, 1.
    pub(crate) curvature: Option<f64>,
    /// Cubic coefficient in half-chords, positive when the middle is steeper, 1.
    pub(crate) s_shape: Option<f64>,
    /// Which side stands higher.
    pub(crate) high_side: Option<HighSide>,
    /// The drum circle, px, y down.
    pub(crate) drum: Option<DrumPixels>,
    /// Surface points that count, px, y down.
    pub(crate) surface: Vec<[f64; 2]>,
    /// Surface points set aside, px, y down.
    pub(crate) surface_rejected: Vec<[f64; 2]>,
    /// Whether the points lie in the picture straightened by the corners.
    pub(crate) rectified: bool,
    /// Trust in the reading, 0 to 1.
    pub(crate) quality: f64,
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
    pub(crate) fn new(
        origin: Origin,
        reading: &PhotoReading,
        settings: &Settings,
        rectified: bool,
    ) -> Self {
        let angle = reading.angle.as_ref();
        let degrees = |value: Option<f64>| value.map(f64::to_degrees);
        let (verdict, reason) = match &reading.verdict {
            Verdict::Ok => ("ok", None),
            Verdict::Refused { reason } => ("refused", Some(reason.to_string())),
        };
        let pairs = |points: &[photo_profile::PixelPoint]| -> Vec<[f64; 2]> {
            points.iter().map(|p| [p.x, p.y]).collect()
        };
        Self {
            file: origin.file,
            frame: origin.frame,
            sha256: origin.sha256,
            verdict,
            reason,
            definition: settings.definition,
            angle_deg: degrees(angle.map(|a| a.by(settings.definition))),
            angle_se_deg: degrees(angle.map(|a| a.standard_error)),
            line_deg: degrees(angle.map(|a| a.line)),
            chord_deg: degrees(angle.map(|a| a.chord)),
            mid_deg: degrees(angle.map(|a| a.mid)),
            curvature: angle.map(|a| a.curvature),
            s_shape: angle.map(|a| a.s_shape),
            high_side: angle.map(|a| a.high_side),
            drum: reading.drum,
            surface: pairs(&reading.used),
            surface_rejected: pairs(&reading.rejected),
            rectified,
            quality: reading.quality,
        }
    }

    /// The line for people.
    pub(crate) fn text(&self) -> String {
        let name = match self.frame {
            Some(frame) => format!("{} frame {frame}", self.file),
            None => self.file.clone(),
        };
        match (self.angle_deg, self.angle_se_deg, self.high_side) {
            (Some(angle), Some(error), Some(side)) => {
                let side = match side {
                    HighSide::Left => "left",
                    HighSide::Right => "right",
                };
                format!(
                    "{name}: {angle:.2} deg (se {error:.2}), high on the {side}, quality {:.2}",
                    self.quality
                )
            }
            _ => format!(
                "{name}: refused: {}",
                self.reason.as_deref().unwrap_or("no reason")
            ),
        }
    }
}

/// The JSON of several pictures together.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Summary {
    /// Pictures measured.
    pub(crate) n: usize,
    /// Mean angle, degrees.
    pub(crate) mean_deg: Option<f64>,
    /// Standard deviation between pictures, degrees.
    pub(crate) sd_deg: Option<f64>,
    /// Standard error of the mean, correlation between neighbours counted, degrees.
    pub(crate) se_deg: Option<f64>,
    /// Number of independent pictures that would tell as much.
    pub(crate) n_effective: Option<f64>,
    /// Pictures refused.
    pub(crate) refused: usize,
}

impl Summary {
    /// The summary of the results.
    pub(crate) fn new(images: &[ImageResult]) -> Self {
        let angles: Vec<f64> = images.iter().filter_map(|i| i.angle_deg).collect();
        let series: Option<SeriesSummary> = surface_profile::summarise(&angles).ok();
        let finite = |value: Option<f64>| value.filter(|v| v.is_finite());
        Self {
            n: angles.len(),
            mean_deg: finite(series.map(|s| s.mean)),
            sd_deg: finite(series.map(|s| s.sd)),
            se_deg: finite(series.map(|s| s.standard_error)),
            n_effective: finite(series.map(|s| s.n_effective)),
            refused: images.len() - angles.len(),
        }
    }

    /// The line for people.
    pub(crate) fn text(&self) -> String {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.2}"));
        format!(
            "mean {} deg, sd {}, se {}, {} measured, {} refused",
            number(self.mean_deg),
            number(self.sd_deg),
            number(self.se_deg),
            self.n,
            self.refused
        )
    }
}

/// The whole JSON: the keys of the one picture at the top when there is one, and always `images`.
#[derive(Debug, Serialize)]
pub(crate) struct Output {
    /// Version, seed and inputs.
    #[serde(flatten)]
    pub(crate) header: Header,
    /// The picture, when there is one only.
    #[serde(flatten)]
    pub(crate) single: Option<ImageResult>,
    /// All pictures.
    pub(crate) images: Vec<ImageResult>,
    /// All pictures together.
    pub(crate) summary: Summary,
}
