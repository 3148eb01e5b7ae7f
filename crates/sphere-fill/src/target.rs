//! Errors that a filling must keep.

use crate::settings::positive;
use crate::{Body, Error, Filling, FitReport};
use input::quantity::significant;
use serde::{Deserialize, Serialize};

/// Errors that a filling must keep; what is none is not looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Target {
    /// |union volume / body volume − 1|.
    pub volume: Option<f64>,
    /// Largest relative error of a principal moment of inertia.
    pub inertia: Option<f64>,
    /// Root mean square of the gap between surface and spheres, m.
    pub surface: Option<f64>,
}

impl Target {
    /// Refuses errors that are not positive.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let parts = [
            ("the target of the volume", self.volume),
            ("the target of the inertia", self.inertia),
            ("the target of the surface in m", self.surface),
        ];
        for (what, value) in parts {
            positive(what, value.unwrap_or(1.0))?;
        }
        Ok(())
    }

    /// Whether a filling keeps all errors.
    pub fn is_met(&self, report: &FitReport) -> bool {
        let reached = errors_of(report);
        let asked = [self.volume, self.inertia, self.surface];
        let kept =
            |(asked, reached): (&Option<f64>, &f64)| asked.is_none_or(|most| *reached <= most);
        asked.iter().zip(&reached).all(kept)
    }

    /// The refusal of a filling that does not keep them.
    pub(crate) fn not_reached(&self, body: &Body<'_>, filling: &Filling) -> Error {
        let [volume, inertia, surface] = errors_of(&filling.report).map(Some);
        let reached = Self {
            volume,
            inertia,
            surface,
        };
        Error::TargetNotReached {
            mesh: body.mesh.source().to_owned(),
            asked: self.to_string(),
            reached: reached.to_string(),
            spheres: filling.spheres.len(),
        }
    }
}

/// Volume error, largest inertia error, surface error of a filling.
fn errors_of(report: &FitReport) -> [f64; 3] {
    let inertia = report.inertia_error_percent;
    let largest = inertia.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
    [
        (report.union_fraction - 1.0).abs(),
        largest / 100.0,
        report.surface_rms,
    ]
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let percent = |part: f64| format!("{:.3} %", 100.0 * part);
        let parts = [
            self.volume.map(|v| format!("volume {}", percent(v))),
            self.inertia.map(|i| format!("inertia {}", percent(i))),
            self.surface
                .map(|s| format!("surface {} mm", significant(s * 1e3, 4))),
        ];
        let told: Vec<String> = parts.into_iter().flatten().collect();
        f.write_str(&told.join(", "))
    }
}
