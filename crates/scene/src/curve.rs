//! The curve of a run: what an apparatus shows along a time, a stress or a displacement.

use crate::Scene;
use crate::phases::Seen;

/// What a curve of an apparatus is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurveKind {
    /// Name.
    pub name: &'static str,
    /// Column along which it goes, with its unit at the end.
    pub along: &'static str,
    /// Columns of values, each with its unit at the end.
    pub values: &'static [&'static str],
    /// Whether it keeps its last value beyond its end, as a discharge does that is over.
    pub is_kept: bool,
}

/// A curve of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it is.
    pub kind: CurveKind,
    /// Along which it goes, and its values, in the order of the kind.
    pub rows: Vec<Vec<f64>>,
}

/// What has left through an outlet, by time.
pub(crate) const DISCHARGE: CurveKind = CurveKind {
    name: "discharge",
    along: "time_s",
    values: &["mass_g", "percent"],
    is_kept: true,
};

/// The discharge of passages (time in s, mass in kg) in order of time: mass, and percentage of all seeds of the scene.
pub(crate) fn discharge(seen: &Seen<'_>, passages: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let all = seen.scene.seed_mass();
    let mut sum = 0.0;
    let steps = passages.iter().map(|[time, mass]| {
        sum += mass;
        vec![*time, 1e3 * sum, 100.0 * sum / all]
    });
    let start = vec![0.0; 1 + DISCHARGE.values.len()];
    std::iter::once(start).chain(steps).collect()
}

impl Scene {
    /// The curve that a run gives; `None` if it gives none.
    pub fn curve(&self) -> Option<CurveKind> {
        self.apparatus.device().curve()
    }
}
